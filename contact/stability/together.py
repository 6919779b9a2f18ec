"""Roots and maxima of many functions of one variable, all at once: each call evaluates many of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contact.base.arrays import Array, Indices

SECANTS, PARABOLAS = 40, 4  # steps of refinement


def roots(
    function: Callable[[Array, Indices], Array], ends: tuple[Array, Array], values: tuple[Array, Array], within: float
) -> Array:
    """Roots between ends with values of opposite sign, by the Illinois method (Dowell & Jarratt, BIT 11, 1971, 168).

    `function(x, which)` gives the values of the functions `which` at x. A root is found where its value is at most
    `within`; it is nan where a value is.

    >>> squares = np.array([2.0, 9.0])
    >>> found = roots(lambda x, which: x**2 - squares[which], (np.zeros(2), 4.0 * np.ones(2)),
    ...               (-squares, 16.0 - squares), 1e-12)
    >>> found.round(9).tolist()
    [1.414213562, 3.0]
    """
    (low, high), (below, above) = (each.copy() for each in ends), (each.copy() for each in values)
    found, open_ = low.copy(), np.arange(low.size)
    for _ in range(SECANTS):
        if not open_.size:
            break
        found[open_] = (low * above - high * below)[open_] / (above - below)[open_]
        middle = function(found[open_], open_)
        found[open_[np.isnan(middle)]] = np.nan
        far = np.abs(middle) > within
        open_, middle = open_[far], middle[far]
        inside = middle * above[open_] < 0.0  # the root is between the last two places
        low[open_] = np.where(inside, high[open_], low[open_])
        below[open_] = np.where(inside, above[open_], 0.5 * below[open_])
        high[open_], above[open_] = found[open_], middle
    return found


def maxima_between(function: Callable[[Array], Array], x: Array, y: Array) -> Array:
    """Places of maxima, each near the middle one of three places x (3, maxima) with the values y, by parabolas.

    >>> x = np.array([[0.0], [0.5], [1.0]])
    >>> maxima_between(lambda x: -(x - 0.3) ** 2, x, -(x - 0.3) ** 2)
    array([0.3])
    """
    for _ in range(PARABOLAS):
        top = vertex(x, y)
        x, y = np.vstack([x, top]), np.vstack([y, function(top)])
        ascending = np.argsort(x, axis=0, kind="stable")
        x, y = np.take_along_axis(x, ascending, axis=0), np.take_along_axis(y, ascending, axis=0)
        best = np.clip(y.argmax(axis=0), 1, len(x) - 2)
        around = best + np.arange(-1, 2)[:, None]
        x, y = np.take_along_axis(x, around, axis=0), np.take_along_axis(y, around, axis=0)
    return np.asarray(np.take_along_axis(x, y.argmax(axis=0)[None], axis=0)[0])


def vertex(x: Array, y: Array) -> Array:
    """Maxima of parabolas through three points each, (3, maxima); the middle of a side if a parabola has none."""
    left, right = x[1] - x[0], x[2] - x[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (y[1] - y[0]) / left, (y[2] - y[1]) / right
        top = 0.5 * (x[0] + x[1]) - first * 0.5 * (x[2] - x[0]) / (second - first)
    inside = np.isfinite(top) & (top > x[0]) & (top < x[2])
    return np.asarray(np.where(inside, top, np.where(left > right, 0.5 * (x[0] + x[1]), 0.5 * (x[1] + x[2]))))
