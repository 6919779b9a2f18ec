"""Groups of items that are connected, directly or through others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Indices


def joined_groups(joined: NDArray[np.bool_]) -> tuple[Indices, ...]:
    """Groups of items, by their first item, from which pairs of items are joined, (m, m).

    An item takes the least number of those that it is joined with, and then that of the item with this number, until
    all keep theirs. For hundreds of modes this is quicker than to load a library of graphs.

    >>> joined = np.zeros((5, 5), dtype=bool)
    >>> joined[4, 2] = joined[2, 0] = True
    >>> [group.tolist() for group in joined_groups(joined)]
    [[0, 2, 4], [1], [3]]
    """
    near, label = joined | joined.T, np.arange(len(joined))
    while True:
        least = np.minimum(label, np.where(near, label, len(joined)).min(axis=1, initial=len(joined)))
        least = least[least]
        if np.array_equal(least, label):
            return tuple(np.flatnonzero(label == number) for number in np.unique(label))
        label = least
