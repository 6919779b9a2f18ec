"""Probabilities too small for plain draws: subset simulation.

A rare event y >= y* is reached through intermediate events, each with `PART` of the probability of the previous one
(S.-K. Au, J. Beck, Probabilistic Engineering Mechanics 16, 2001, 263). Within each, Markov chains start at the draws of
the last level that are beyond its threshold. They propose normal numbers that are correlated with the last ones, r u +
sqrt(1 - r^2) v (I. Papaioannou et al., Probabilistic Engineering Mechanics 41, 2015, 89). r is adapted to an acceptance
of 0.44.

If chains were as good as independent draws, the coefficient of variation would be -ln(P)/sqrt(runs): 12 % for 1e-5 with
1e4 runs. Therefore half of the runs are importance sampling around the points of the last level
(`importance_sampling`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from casingfem.chance.importance_sampling import density_of, directions_of
from casingfem.errors import InputError, NumericsError
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

PART = 0.1  # of the draws start the next level
ACCEPTED = 0.44
LEVELS = 30
ROUNDS = 10  # in which the chains of a level adapt
SHARES = (0.3, 0.7)  # of importance sampling: the first draws give the density of the others, which are the estimate
FEWEST = 10  # independent points of the last level that a density is fitted to
AGREED = 3.0  # standard deviations by which the logarithm may be below that of the subsets
Response = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class RareEvent:
    """Result of subset simulation.

    Attributes
    ----------
    probability : of y >= y*
    variation : estimated coefficient of variation of it [-]
    thresholds : of the levels; the last is y*
    runs : evaluations of y
    by : "subset", or "importance" if importance sampling has the smaller variation
    subset, subset_variation : probability and variation from subset simulation alone
    """

    probability: float
    variation: float
    thresholds: tuple[float, ...]
    runs: int
    by: Literal["subset", "importance"]
    subset: float
    subset_variation: float


def subset_simulation(
    response: Response, dimension: int, threshold: float, *, seed: int, size: int = 1000, more: int = 5000
) -> RareEvent:
    """Probability that y(u) >= `threshold` for independent standard normal u.

    Parameters
    ----------
    response
        y of points u (points, dimension), vectorised: (points,).
    size
        Evaluations in each level; a level makes the event ten times rarer.
    more
        Evaluations of importance sampling after the last level; 0 for none.

    Raises
    ------
    InputError
        The dimension is 0, a level has fewer than 100 evaluations, or `more` is from 1 to 99.
    NumericsError
        If y is not finite, or the threshold is not reached within 30 levels.

    Examples
    --------
    >>> found = subset_simulation(lambda u: u.sum(axis=1), 4, 6.0, seed=7)  # exactly 1.3e-3
    >>> abs(found.probability / 1.35e-3 - 1.0) < 0.1, found.by, found.runs
    (True, 'importance', 7800)
    """
    if dimension < 1 or size < 100 or not (more == 0 or more >= 100):
        found = f"dimension {dimension}, size {size}, more {more}"
        expected = "at least 1 number, 100 evaluations a level, and 0 or at least 100 more"
        raise InputError(f"subset_simulation: found {found}, expected {expected}")
    rng = np.random.default_rng(seed)
    u = rng.standard_normal((size, dimension))
    y = finite_response(response, u)
    starts, runs = max(int(PART * size), 1), size
    chance, squares, thresholds = 1.0, 0.0, list[float]()
    chains: IntArray = np.arange(size)  # independent at first
    for _ in range(LEVELS):
        order = np.argsort(-y, kind="stable")
        level = float(0.5 * (y[order[starts - 1]] + y[order[starts]]))
        last = level >= threshold
        level = threshold if last else level
        beyond = y >= level
        part = float(beyond.mean())
        squares += relative_square(beyond, chains)
        chance *= part
        thresholds.append(level)
        if last or part == 0.0:
            variation = float(np.sqrt(squares))
            subsets = RareEvent(
                probability=chance, variation=variation, thresholds=tuple(thresholds), runs=runs, by="subset",
                subset=chance, subset_variation=variation,
            )  # fmt: skip
            return sharpened(subsets, response, (u, y, chains), threshold, more, rng)
        kept = rng.permutation(order[:starts])
        u, y, chains = next_level(response, u[kept], y[kept], level, size, rng)
        runs += size - starts
    found = f"y = {thresholds[-1]:g} after {LEVELS} levels"
    raise NumericsError(f"subset_simulation: found {found}, expected {threshold:g}: the event may be impossible")


def sharpened(
    subsets: RareEvent, response: Response, level: tuple[FloatArray, FloatArray, IntArray], threshold: float,
    more: int, rng: np.random.Generator,
) -> RareEvent:  # fmt: skip
    """The probability by importance sampling, if it is not below that of subset simulation and is more certain.

    `level` has the points, the responses and the chains of the last level.
    """
    u, y, chains = level
    found, independent = u[y >= threshold], len(np.unique(chains[y >= threshold]))
    if not more or independent < FEWEST:
        return subsets
    directions = directions_of(u, y, independent)
    if directions is None:
        return subsets
    runs, variation, mean = subsets.runs, float("inf"), 0.0
    for share in SHARES:
        density = density_of(found, directions, independent, rng)
        u = density.drawn(int(share * more), rng)
        weight = np.where(finite_response(response, u) >= threshold, np.exp(density.log_weights(u)), 0.0)
        mean, runs = float(weight.mean()), runs + len(u)
        if not mean > 0.0:
            return replace(subsets, runs=runs)
        variation = float(weight.std(ddof=1)) / (mean * np.sqrt(len(u)))
        part = weight / weight.sum()
        independent = max(int(1.0 / np.sum(part**2)), 1)
        found = u[rng.choice(len(u), len(u), p=part)]
    less = np.log(subsets.subset / mean)  # a part of the event may have no kernel
    if not variation < subsets.variation or less > AGREED * np.hypot(subsets.variation, variation):
        return replace(subsets, runs=runs)
    return replace(subsets, probability=mean, variation=variation, runs=runs, by="importance")


def next_level(
    response: Response, u: FloatArray, y: FloatArray, level: float, size: int, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray, IntArray]:
    """`size` draws beyond a threshold by Markov chains from draws that are beyond it, and the chain of each draw."""
    starts, deviation = len(u), 0.6
    all_u, all_y, chain = [u], [y], np.arange(starts)
    step = 0
    while len(all_u) * starts < size:
        step += 1
        count = min(starts, size - len(all_u) * starts)
        keep = np.sqrt(1.0 - deviation**2)
        proposed = keep * u[:count] + deviation * rng.standard_normal((count, u.shape[1]))
        there = finite_response(response, proposed)
        accepted = there >= level
        u, y = np.where(accepted[:, None], proposed, u[:count]), np.where(accepted, there, y[:count])
        all_u.append(u)
        all_y.append(y)
        if step <= ROUNDS:
            factor = np.exp((float(accepted.mean()) - ACCEPTED) / np.sqrt(step))
            deviation = float(np.clip(deviation * factor, 0.05, 0.999))
    of = np.concatenate([chain[: len(part)] for part in all_u])
    return np.concatenate(all_u), np.concatenate(all_y), of


def relative_square(beyond: BoolArray, chains: IntArray) -> float:
    """Squared coefficient of variation of a level's fraction; chains count as independent of each other."""
    share, counts = float(beyond.mean()), np.bincount(chains, weights=beyond)
    lengths = np.bincount(chains)
    if share == 0.0:
        return float("inf")
    return float(np.sum((counts - share * lengths) ** 2)) / (share * len(beyond)) ** 2


def finite_response(response: Response, u: FloatArray) -> FloatArray:
    """Responses; raises NumericsError if one is not finite."""
    y = np.asarray(response(u), dtype=float)
    if y.shape != (len(u),) or not np.all(np.isfinite(y)):
        raise NumericsError(f"subset_simulation: found responses {y.shape} or not finite, expected ({len(u)},) finite")
    return y
