"""Replace neighbouring lines on which the responses are cubic, within the noise, by four nodes with the same products.

Over b even lines let T (4, b) have the rows sqrt(w_i) sum_k phi_k(x_i) phi_k(l), phi_k the orthonormal polynomials of
degree 0 to 3 on these lines, x_i and w_i the nodes and weights of their Gauss rule (Golub and Welsch, Math. Comput. 23,
1969, 221). T T^H = 1, and T f = sqrt(w_i) f(x_i) for each cubic f. So products of cubics over the lines are those over
the nodes, and white noise remains white of the same variance. A resonance much wider than the lines is cubic on them.

Lines are merged if the part of the responses that T leaves out is only noise: at most twice the energy that third
differences show, var = 20 sigma^2. Other lines are kept.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

NODES = 4
SIZES = 64, 32, 16, 8  # lines that are merged, the larger number where possible
ROUGH = 2.0  # largest energy left out, in that of the noise


class Lines(NamedTuple):
    """Lines and nodes [Hz] (lines,), responses there (lines, channels), and their weights (lines,)."""

    freq: FloatArray
    Y: Array
    along: FloatArray


def merged_lines(freq: FloatArray, Y: Array, along: FloatArray, floor: float = 0.0) -> Lines:
    """Responses Y (lines, channels) at evenly spaced `freq`, with merged lines; only lines of weight 1 are merged.

    A difference below the deviation `floor` is ignored.

    Examples
    --------
    >>> rng, freq = np.random.default_rng(3), 100.0 + 0.01 * np.arange(3200)
    >>> column = 2.0 / (2.0 + 1j * (freq - 116.0))
    >>> Y = 50.0 * column[:, None] + rng.normal(size=(3200, 2)) @ [[1.0], [1j]]
    >>> few = merged_lines(freq, Y, np.ones(3200))
    >>> fitted = few.along * 2.0 / (2.0 + 1j * (few.freq - 116.0))
    >>> len(few.freq), bool(abs(np.vdot(fitted, few.Y) / np.vdot(column, Y) - 1.0) < 1e-6)
    (200, True)
    """
    step, left, parts = float(freq[1] - freq[0]), along == 1.0, list[Lines]()
    kept = np.ones(len(freq), bool)
    for size in SIZES:
        x, weights, T = _rule(size)
        starts, values = _smooth(Y, left, T, floor)
        at = freq[starts][:, None] + step * (x + 0.5 * (size - 1))
        parts.append(Lines(at.ravel(), values.reshape(-1, Y.shape[1]), np.tile(np.sqrt(weights), len(starts))))
        gone = (starts[:, None] + np.arange(size)).ravel()
        left[gone] = kept[gone] = False
    parts.append(Lines(freq[kept], Y[kept], along[kept]))
    whole = Lines(*(np.concatenate(each) for each in zip(*parts, strict=True)))
    order = np.argsort(whole.freq)
    return Lines(*(each[order] for each in whole))


def _smooth(Y: Array, free: BoolArray, T: FloatArray, floor: float) -> tuple[IntArray, Array]:
    """First lines of the blocks that are merged by T, and the responses at their nodes (blocks, nodes, channels)."""
    size = T.shape[1]
    blocks = len(Y) // size
    each = Y[: blocks * size].reshape(blocks, size, Y.shape[1])
    values = np.asarray(T @ each)
    out = np.sum(np.abs(each) ** 2, axis=(1, 2)) - np.sum(np.abs(values) ** 2, axis=(1, 2))
    rough = np.mean(np.abs(np.diff(each, 3, axis=1)) ** 2, axis=1) / 20.0
    noise = (size - NODES) * np.sum(np.maximum(rough, 2.0 * floor**2), axis=1)
    kept = free[: blocks * size].reshape(blocks, size).all(axis=1) & (out <= ROUGH * noise)
    return size * np.flatnonzero(kept), values[kept]


@cache
def _rule(size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes (in lines from the middle), weights, and T (nodes, lines) of polynomials on `size` even lines."""
    k = np.arange(1.0, NODES)
    beside = np.sqrt(k**2 * (size**2 - k**2) / (4.0 * (4.0 * k**2 - 1.0)))
    x, vectors = np.linalg.eigh(np.diag(beside, 1) + np.diag(beside, -1))
    weights = size * vectors[0] ** 2
    lines = np.arange(size) - 0.5 * (size - 1)
    on_lines, at_nodes = (np.polynomial.legendre.legvander(2.0 * at / size, NODES - 1) for at in (lines, x))
    return x, weights, np.sqrt(weights)[:, None] * (at_nodes @ np.linalg.pinv(on_lines))
