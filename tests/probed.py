"""A matrix in a few numbers that any of its entries changes, whatever signs and order a factorisation takes."""

import numpy as np


def probed(matrix) -> np.ndarray:
    """Products with three fixed vectors from both sides, (3, 3): W^T A W, columns of W over their length."""
    rows, columns = (np.cos(np.outer(np.arange(size) ** 2 % 977, [0.7, 1.3, 2.1]) + 0.3) for size in matrix.shape)
    return np.asarray(rows.T @ (matrix @ columns))
