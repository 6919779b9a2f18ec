"""The best two of many changes: every pair judged, the best dozen refitted.

Matching pursuit takes the change that explains most alone; of two equal faults that is often a third place between
them, and exchanging one of two wrong places for another may not help. All pairs are few (276 of 24): each change is
first fitted alone, on the full model; from there every other promises a linear fall of chi^2 with the first left
free. Of the two orders of a pair the better promise counts, and the dozen pairs with the lowest are refitted.
"""

import numpy as np

from casingfem.locate.misfit import Point
from casingfem.locate.sparse_fit import Bounds, Evaluate, fitted, gains

REFITTED = 12  # pairs


def best_pair(evaluate: Evaluate, none: Point, bounds: Bounds) -> tuple[list[int], Point]:
    """The two changes with the least chi^2 and the fit with them, from the casing with none; two candidates or more."""
    count = len(bounds.lower)
    alone = [fitted(evaluate, none, [c], bounds) for c in range(count)]
    left = np.array([at.chi2 - np.maximum(gains(at, [c], bounds), 0.0) for c, at in enumerate(alone)])
    first, second = np.triu_indices(count, 1)
    promised = np.minimum(left[first, second], left[second, first])
    fits = []
    for k in np.argsort(promised, kind="stable")[:REFITTED]:
        pair = [int(first[k]), int(second[k])]
        start = alone[pair[0]] if left[pair[0], pair[1]] <= left[pair[1], pair[0]] else alone[pair[1]]
        fits.append((pair, fitted(evaluate, start, pair, bounds)))
    return min(fits, key=lambda fit: fit[1].chi2)
