"""Local maxima of a sampled curve, with their prominence."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices


def maxima(values: Array) -> Indices:
    """Ascending places of local maxima inside a row; of a flat top, the middle, or the left one of two.

    >>> maxima(np.array([0.0, 2.0, 1.0, 3.0, 3.0, 3.0, 2.0, 5.0])).tolist()
    [1, 4]
    """
    first = np.flatnonzero(np.concatenate([[True], values[1:] != values[:-1]]))  # of each stretch of equal values
    last = np.concatenate([first[1:], [values.size]]) - 1
    level = values[first]
    top = 1 + np.flatnonzero((level[1:-1] > level[:-2]) & (level[1:-1] > level[2:]))
    return np.asarray((first[top] + last[top]) // 2)


def prominence(values: Array, places: Indices) -> Array:
    """Height of maxima above the higher one of the lowest values on both sides, up to the next higher value.

    >>> prominence(np.array([0.0, 2.0, 1.0, 3.0, 0.5]), np.array([1, 3])).tolist()
    [1.0, 2.5]
    """
    found = np.empty(len(places))
    for k, place in enumerate(places.tolist()):
        higher: NDArray[np.bool_] = values > values[place]
        left, right = np.flatnonzero(higher[:place]), np.flatnonzero(higher[place:])
        begin = int(left[-1]) + 1 if left.size else 0
        end = place + int(right[0]) if right.size else values.size
        found[k] = values[place] - max(values[begin : place + 1].min(), values[place:end].min())
    return found
