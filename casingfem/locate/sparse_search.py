"""The fewest of many possible changes that explain a table: matching pursuit with re-linearisation.

Each round offers every candidate one more bounded Gauss-Newton step beside those already taken (orthogonal matching
pursuit: Pati, Rezaiifar and Krishnaprasad, Asilomar 1993), refits the best few on the full model, and keeps the best
if its gain is significant: F = (chi^2 before - chi^2 after)/s^2 above the quantile of F(1, dof) at level/candidates,
s^2 = max(1, chi^2/dof). Two changes are sought among all pairs (`pair_search.py`); of more, each one taken is tried
against all others, since the first choice was made on a linear model of changes that move modes by tens of per cent.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri, stdtrit

from casingfem.locate.misfit import Point
from casingfem.locate.pair_search import best_pair
from casingfem.locate.sparse_fit import Bounds, Evaluate, fitted, gains

TRIED, WIDELY = 4, 8  # candidates refitted on the full model in each round, and where noise explains nothing
PLAUSIBLE = 0.05  # residuals that noise leaves more often than this need no further explanation
UNLIKELY = 1e-3  # residuals that noise leaves less often than this
PATIENCE = 1  # further steps tried after one without significance


def scale2(point: Point, free: int) -> float:
    """s^2 = max(1, chi^2/dof): how much larger the residuals are than their stated sigma."""
    return max(1.0, point.chi2 / max(len(point.values) - free, 1))


def threshold(level: float, candidates: int, rows: int, free: int) -> float:
    """The gain in chi^2/s^2 that one change of `candidates` reaches by chance with probability `level`."""
    return float(stdtrit(max(rows - free, 1), 0.5 * level / max(candidates, 1)) ** 2)  # F(1, k) is Student's t squared


def search(
    evaluate: Evaluate, bounds: Bounds, *, most: int, level: float, least: float = 0.0
) -> tuple[list[int], Point]:
    """The changes found, in order of their number, and the casing with them.

    A step that chance might make is kept if the next one shows that it was none: the first of two equal faults may
    explain little alone. Changes smaller than `least` are not told.
    """
    changes = len(bounds.lower)
    path: list[tuple[list[int], Point]] = [([], evaluate(np.zeros(changes)))]
    accepted = 0
    while keep_searching(len(path) - 1, accepted, most, path[-1][1], level):
        active, at = path[-1]
        if len(active) == 1:
            active, there = best_pair(evaluate, path[0][1], bounds)
        else:
            taken, there = best_addition(evaluate, at, active, bounds)
            if taken is None:
                break
            active = sorted([*active, taken])
        if len(active) > 2 and unexplained(there, len(active), PLAUSIBLE):
            active, there = exchanged(evaluate, there, active, bounds)
        path.append((active, there))
        tried = changes * (changes - 1) // 2 if len(active) == 2 else changes  # the luckiest of all pairs
        if significant(at, there, len(active), level, tried):
            accepted = len(path) - 1
    active, best = path[accepted]
    if len(active) > 2 and unexplained(best, len(active), UNLIKELY):  # a wrong turn early on: look further
        active, best = exchanged(evaluate, best, active, bounds, tried=WIDELY)
    active, best = pruned(evaluate, best, active, bounds, level)
    while any(abs(best.x[c]) < least for c in active):
        active = [c for c in active if abs(best.x[c]) >= least]
        best = fitted(evaluate, best, active, bounds)
    return active, best


def keep_searching(taken: int, accepted: int, most: int, at: Point, level: float) -> bool:
    """Whether to look for one change more: while it may be accepted, and noise alone does not explain the residuals."""
    return taken < most and taken <= accepted + PATIENCE and unexplained(at, taken, PLAUSIBLE)


def unexplained(at: Point, free: int, level: float) -> bool:
    """Whether noise leaves such residuals with less than this probability."""
    return at.chi2 > float(chdtri(max(len(at.values) - free, 1), level))


def significant(before: Point, after: Point, free: int, level: float, candidates: int) -> bool:
    """Whether one change more gains what chance would not."""
    gain = (before.chi2 - after.chi2) / scale2(after, free)
    return gain > threshold(level, candidates, len(after.values), free)


def best_addition(
    evaluate: Evaluate, at: Point, active: Sequence[int], bounds: Bounds, tried: int = TRIED
) -> tuple[int | None, Point]:
    """The change that brings chi^2 lowest beside those active, of the most promising, and the fit with it."""
    promised = gains(at, active, bounds)
    order = [int(c) for c in np.argsort(-promised, kind="stable")[:tried] if promised[c] > 0.0]
    fits = [(c, fitted(evaluate, at, [*active, c], bounds)) for c in order]
    if not fits:
        return None, at
    return min(fits, key=lambda fit: fit[1].chi2)


def exchanged(
    evaluate: Evaluate, at: Point, active: list[int], bounds: Bounds, rounds: int = 2, tried: int = TRIED
) -> tuple[list[int], Point]:
    """Let every active change be replaced by a better one, until none is."""
    for _ in range(rounds if len(active) > 1 else 0):
        before = at.chi2
        for place in range(len(active)):
            others = active[:place] + active[place + 1 :]
            without = fitted(evaluate, at, others, bounds)
            other, there = best_addition(evaluate, without, others, bounds, tried)
            if other is not None and there.chi2 < at.chi2 * (1.0 - 1e-6):
                active, at = [*others, other], there
        if at.chi2 >= before * (1.0 - 1e-6):
            break
    return sorted(active), at


def pruned(evaluate: Evaluate, at: Point, active: list[int], bounds: Bounds, level: float) -> tuple[list[int], Point]:
    """Drop what the others have made needless."""
    for change in list(active):
        others = [c for c in active if c != change]
        without = fitted(evaluate, at, others, bounds)
        if not significant(without, at, len(active), level, len(bounds.lower)):
            active, at = others, without
    return active, at
