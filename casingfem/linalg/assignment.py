"""Assignment with the least total cost: scipy's solution, imported on first use."""

import numpy as np
from numpy.typing import NDArray

from casingfem.io.arrays import FloatArray

Indices = NDArray[np.intp]


def assignment(cost: FloatArray) -> tuple[Indices, Indices]:
    """Rows and columns of the pairs, as many as the shorter side has, with the least sum of `cost` (rows, columns).

    >>> rows, columns = assignment(np.array([[4.0, 1.0, 3.0], [2.0, 0.0, 5.0]]))
    >>> rows.tolist(), columns.tolist()
    ([0, 1], [1, 0])
    """
    from scipy.optimize import linear_sum_assignment  # loaded with the first pairing, not by every study

    rows, columns = linear_sum_assignment(cost)
    return rows, columns
