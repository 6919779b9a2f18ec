"""Probabilities too small for plain draws: subset simulation.

A rare event y >= y* is reached by way of events that are each `PART` as likely as the one before (S.-K. Au, J. Beck,
Probabilistic Engineering Mechanics 16, 2001, 263). Within each, Markov chains start at the draws of the last level that
are beyond its threshold. They propose normal numbers that are correlated with the last ones, r u + sqrt(1 - r^2) v (I.
Papaioannou et al., Probabilistic Engineering Mechanics 41, 2015, 89). r is adapted to an acceptance of 0.44.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from casingfem.errors import InputError, NumericsError
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

PART = 0.1  # of the draws start the next level
ACCEPTED = 0.44
LEVELS = 30
ROUNDS = 10  # in which the chains of a level adapt
Response = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class RareEvent:
    """Result of subset simulation.

    Attributes
    ----------
    probability : of y >= y*
    variation : estimated coefficient of variation of it [-]
    thresholds : of the levels on the way, the last is y*
    runs : evaluations of y
    """

    probability: float
    variation: float
    thresholds: tuple[float, ...]
    runs: int


def subset_simulation(
    response: Response, dimension: int, threshold: float, *, seed: int, size: int = 2000
) -> RareEvent:
    """Probability that y(u) >= `threshold` for independent standard normal u.

    Parameters
    ----------
    response
        y of points u (points, dimension), vectorised: (points,).
    size
        Evaluations in each level; a level makes the event ten times rarer.

    Raises
    ------
    InputError
        No dimension, or less than 100 evaluations in a level.
    NumericsError
        If y is not finite, or the threshold is not reached within 30 levels.

    Examples
    --------
    >>> found = subset_simulation(lambda u: u.sum(axis=1), 4, 6.0, seed=7)  # exactly 1.3e-3
    >>> 1e-3 < found.probability < 1.8e-3, found.runs
    (True, 5600)
    """
    if dimension < 1 or size < 100:
        found = f"dimension {dimension}, size {size}"
        raise InputError(f"subset_simulation: found {found}, expected at least 1 number and 100 evaluations a level")
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
            return RareEvent(
                probability=chance, variation=float(np.sqrt(squares)), thresholds=tuple(thresholds), runs=runs
            )
        kept = rng.permutation(order[:starts])
        u, y, chains = next_level(response, u[kept], y[kept], level, size, rng)
        runs += size - starts
    found = f"y = {thresholds[-1]:g} after {LEVELS} levels"
    raise NumericsError(f"subset_simulation: found {found}, expected {threshold:g}: the event cannot be reached")


def next_level(
    response: Response, u: FloatArray, y: FloatArray, level: float, size: int, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray, IntArray]:
    """`size` draws beyond a level by chains from draws that are; and the chain of each."""
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
    """Squared coefficient of variation of a level's share, chains taken as independent of each other."""
    share, counts = float(beyond.mean()), np.bincount(chains, weights=beyond)
    lengths = np.bincount(chains)
    if share == 0.0:
        return float("inf")
    return float(np.sum((counts - share * lengths) ** 2)) / (share * len(beyond)) ** 2


def finite_response(response: Response, u: FloatArray) -> FloatArray:
    """Responses, which must be finite."""
    y = np.asarray(response(u), dtype=float)
    if y.shape != (len(u),) or not np.all(np.isfinite(y)):
        raise NumericsError(f"subset_simulation: found responses {y.shape} or not finite, expected ({len(u)},) finite")
    return y


def reliability_index(probability: float) -> float:
    """Distance beta from the origin, P = Phi(-beta).

    >>> round(reliability_index(1e-5), 3)
    4.265
    """
    return float(-norm.ppf(probability))
