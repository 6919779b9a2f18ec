"""The smallest set of many possible changes that explains a table: matching pursuit with re-linearisation.

Each round tries one more bounded Gauss-Newton step for every candidate in addition to the active ones (orthogonal
matching pursuit: Pati, Rezaiifar and Krishnaprasad, Asilomar 1993), refits the best few on the full model, and accepts
the best if its gain is significant: F = (chi^2 before - chi^2 after)/s^2 above the quantile of F(1, dof) at
level/candidates, s^2 = max(1, chi^2/dof). Two changes are sought among all pairs (`best_pair`); with more changes, each
active one is compared with all others, since the first choice used a linear model for changes that move modes by tens
of per cent.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear
from scipy.special import chdtri, stdtrit

from casingfem.io.arrays import FloatArray
from casingfem.locate.misfit import Point

ROUNDS = 8  # Gauss-Newton steps of a fit
SETTLED = 2e-3  # of the range of a change: a smaller step ends a fit
HALVINGS = 4
TRIED, WIDELY = 4, 8  # candidates refitted on the full model in each round, and where noise explains nothing
PLAUSIBLE = 0.05  # residuals that noise leaves more often than this need no further explanation
UNLIKELY = 1e-3  # residuals that noise leaves less often than this
PATIENCE = 1  # further steps tried after one without significance
REFITTED = 12  # pairs

Evaluate = Callable[[FloatArray], Point]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Bounds:
    """Least and largest value of every change, (changes,) each."""

    lower: FloatArray
    upper: FloatArray

    @property
    def span(self) -> FloatArray:
        """Range of each change."""
        return self.upper - self.lower


def fitted(evaluate: Evaluate, start: Point, active: Sequence[int], bounds: Bounds) -> Point:
    """Bounded Gauss-Newton over the active changes, all others at zero; each step is halved until it reduces chi^2."""
    on = list(active)
    x = np.zeros(len(start.x))
    x[on] = start.x[on]
    best = start if np.array_equal(x, start.x) else evaluate(x)
    for _ in range(ROUNDS):
        low, high = bounds.lower[on] - best.x[on], bounds.upper[on] - best.x[on]
        step = bounded_step(best, on, low, high)
        if step is None:
            break
        for half in range(HALVINGS):
            x = best.x.copy()
            x[on] += 0.5**half * step
            there = evaluate(x)
            if there.chi2 < best.chi2:
                break
        else:
            break
        moved = np.abs(there.x[on] - best.x[on]) / bounds.span[on]
        best = there
        if moved.max() < SETTLED:
            break
    return best


def bounded_step(at: Point, on: list[int], low: FloatArray, high: FloatArray) -> FloatArray | None:
    """The least-squares step of some changes within their bounds; None if the data do not depend on them."""
    A = at.jacobian[:, on]
    norms = np.linalg.norm(A, axis=0)
    if not np.any(norms):
        return None
    unit = np.where(norms > 0.0, norms, 1.0)
    width = np.maximum(high - low, 1e-300)
    found = lsq_linear(A / unit, -at.values, (unit * low - 1e-12 * unit * width, unit * high + 1e-12 * unit * width))
    return np.asarray(np.clip(found.x / unit, low, high))


def gains(at: Point, active: Sequence[int], bounds: Bounds) -> FloatArray:
    """Expected decrease of chi^2 by each change, (changes,), to first order; -inf for active ones, which stay free."""
    on = list(active)
    J, r = at.jacobian, at.values
    if on and len(r):
        Q, _ = np.linalg.qr(J[:, on])
        J, r = J - Q @ (Q.T @ J), r - Q @ (Q.T @ r)
    square, slope = np.sum(J**2, axis=0), J.T @ r
    seen = square > 1e-12 * np.sum(at.jacobian**2, axis=0).max(initial=0.0)
    step = np.where(seen, -slope / np.where(seen, square, 1.0), 0.0)
    step = np.clip(step, bounds.lower - at.x, bounds.upper - at.x)
    promised = -(2.0 * step * slope + step**2 * square)
    return np.where(seen, promised, -np.inf)


def scale2(point: Point, free: int) -> float:
    """s^2 = max(1, chi^2/dof): ratio of the residuals to their stated sigma, squared."""
    return max(1.0, point.chi2 / max(len(point.values) - free, 1))


def threshold(level: float, candidates: int, rows: int, free: int) -> float:
    """The gain in chi^2/s^2 that one of `candidates` changes reaches by chance with probability `level`."""
    return float(stdtrit(max(rows - free, 1), 0.5 * level / max(candidates, 1)) ** 2)  # F(1, k) is Student's t squared


def search(
    evaluate: Evaluate, bounds: Bounds, *, most: int, level: float, least: float = 0.0
) -> tuple[list[int], Point]:
    """The changes found, for each number of changes, and the casing with them.

    A step that may be chance is kept if the next one makes it significant, since the first of two equal faults may
    explain little alone. Changes smaller than `least` are left out.
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
    if len(active) > 2 and unexplained(best, len(active), UNLIKELY):  # a wrong turn early on: search further
        active, best = exchanged(evaluate, best, active, bounds, tried=WIDELY)
    active, best = pruned(evaluate, best, active, bounds, level)
    while any(abs(best.x[c]) < least for c in active):
        active = [c for c in active if abs(best.x[c]) >= least]
        best = fitted(evaluate, best, active, bounds)
    return active, best


def keep_searching(taken: int, accepted: int, most: int, at: Point, level: float) -> bool:
    """Whether to search for one more change: while it may be accepted, and noise does not explain the residuals."""
    return taken < most and taken <= accepted + PATIENCE and unexplained(at, taken, PLAUSIBLE)


def unexplained(at: Point, free: int, level: float) -> bool:
    """Whether the probability of such residuals from noise is below a limit."""
    return at.chi2 > float(chdtri(max(len(at.values) - free, 1), level))


def significant(before: Point, after: Point, free: int, level: float, candidates: int) -> bool:
    """Whether one more change improves the fit beyond chance."""
    gain = (before.chi2 - after.chi2) / scale2(after, free)
    return gain > threshold(level, candidates, len(after.values), free)


def best_addition(
    evaluate: Evaluate, at: Point, active: Sequence[int], bounds: Bounds, tried: int = TRIED
) -> tuple[int | None, Point]:
    """The most promising change that lowers chi^2 most in addition to the active ones, and the fit with it."""
    promised = gains(at, active, bounds)
    order = [int(c) for c in np.argsort(-promised, kind="stable")[:tried] if promised[c] > 0.0]
    fits = [(c, fitted(evaluate, at, [*active, c], bounds)) for c in order]
    if not fits:
        return None, at
    return min(fits, key=lambda fit: fit[1].chi2)


def exchanged(
    evaluate: Evaluate, at: Point, active: list[int], bounds: Bounds, rounds: int = 2, tried: int = TRIED
) -> tuple[list[int], Point]:
    """Replace active changes by better ones, until none improves the fit."""
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
    """Drop changes that the others make unnecessary."""
    for change in list(active):
        others = [c for c in active if c != change]
        without = fitted(evaluate, at, others, bounds)
        if not significant(without, at, len(active), level, len(bounds.lower)):
            active, at = others, without
    return active, at


def best_pair(evaluate: Evaluate, none: Point, bounds: Bounds) -> tuple[list[int], Point]:
    """The two changes with the least chi^2 and the fit with them, from the unchanged casing; two or more candidates.

    Matching pursuit takes the change that explains most alone. With two equal faults that is often a third place
    between them, and replacing one of two wrong places may not help. There are few pairs (276 for 24 places), so all
    are tried. Each change is first fitted alone on the full model; from there the linear decrease of chi^2 with every
    other one is computed, with the first left free. The better of the two orders of a pair counts, and the dozen best
    pairs are refitted.
    """
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
