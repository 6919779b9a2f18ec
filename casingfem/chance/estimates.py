"""Probabilities and quantiles of draws, each with its interval."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.stats import beta, binom, norm, t

from casingfem.chance.points import REPLICATES
from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray, IntArray

LEVEL = 0.95


class Estimate(NamedTuple):
    """A number estimated from draws, and the interval that contains the true value with the stated probability."""

    value: float
    low: float
    high: float


def clopper_pearson(hits: float, draws: float, *, level: float = LEVEL) -> Estimate:
    """A probability from independent draws, with the exact interval (C. Clopper, E. Pearson, Biometrika 26, 1934, 404).

    Raises
    ------
    InputError
        There are no draws, more hits than draws, or the level is outside (0, 1).

    Examples
    --------
    >>> [round(part, 4) for part in clopper_pearson(0, 100)], [round(part, 3) for part in clopper_pearson(5, 50)]
    ([0.0, 0.0, 0.0362], [0.1, 0.033, 0.218])
    """
    if not (0.0 <= hits <= draws and draws > 0.0 and 0.0 < level < 1.0):
        found = f"{hits:g} hits, {draws:g} draws, level {level:g}"
        raise InputError(f"probability: found {found}, expected 0 <= hits <= draws, draws > 0, 0 < level < 1")
    tail = 0.5 * (1.0 - level)
    low = 0.0 if hits == 0.0 else float(beta.ppf(tail, hits, draws - hits + 1.0))
    high = 1.0 if hits == draws else float(beta.ppf(1.0 - tail, hits + 1.0, draws - hits))
    return Estimate(hits / draws, low, high)


@cache
def mid_p(hits: int, draws: int, level: float = LEVEL) -> Estimate:
    """A probability from few draws, not all of them hits, with the mid-P interval.

    Source: G. Berry, P. Armitage, Statistician 44, 1995. Draws are independent.

    At each end of the interval, the probability of numbers of hits beyond the one found, plus half of the probability
    of this number, is (1 - level)/2. Over all probabilities its coverage is near the level on average; Clopper's and
    Pearson's interval is never below it, and of 16 draws 98 % on average.

    Examples
    --------
    >>> [round(part, 4) for part in mid_p(3, 16)]
    [0.1875, 0.05, 0.4301]
    """
    tail = 0.5 * (1.0 - level)

    def above(p: float) -> float:
        return float(binom.sf(hits, draws, p) + 0.5 * binom.pmf(hits, draws, p))

    low = 0.0 if hits == 0 else float(brentq(lambda p: above(p) - tail, 0.0, 1.0))
    return Estimate(hits / draws, low, float(brentq(lambda p: above(p) - 1.0 + tail, 0.0, 1.0)))


def probability(hit: ArrayLike, *, level: float = LEVEL) -> Estimate:
    """Probability of an event from the draws of `points`, with its interval.

    Draws of one sequence are not independent, those of two sequences are. The variance s^2/R of the mean of R sequences
    gives the equivalent number n = p (1 - p) R/s^2 of independent draws. With (z/t)^2 n instead, the interval of
    Clopper and Pearson also includes the uncertainty of s (E. Korn, B. Graubard, Survey Methodology 24, 1998, 193).
    Without hits, or with only hits, n is the number of draws.

    An even sequence of m draws often has c or c + 1 hits, and no other number. If this holds for all R sequences, m p =
    c + q, with q the share of those with c + 1. The mid-P interval of q gives that of p. If all have c hits, the
    interval of q extends as far below zero as above. The rule is not used for rare events, with c = 0, which are not
    even.

    Parameters
    ----------
    hit
        Whether the event happens, in the order of the draws, (draws,).

    Examples
    --------
    >>> from casingfem.chance.points import points
    >>> below = points(7, range(4096), 2).sum(axis=1) < 0.2  # a triangle of area 0.02
    >>> found = probability(below)
    >>> found.low < 0.02 < found.high, found.high - found.low < 0.004
    (True, True)
    """
    own = np.asarray(hit, dtype=bool)
    draws, hits = own.size, int(np.count_nonzero(own))
    if draws < 2 * REPLICATES or hits in (0, draws):
        return clopper_pearson(hits, draws, level=level)
    counts = np.array([np.count_nonzero(own[k::REPLICATES]) for k in range(REPLICATES)])
    whole = draws % REPLICATES == 0 and 0 < counts.min() and counts.max() < draws // REPLICATES
    if whole and np.ptp(counts) <= 1:
        return _neighbours(counts, draws // REPLICATES, level)
    means = np.array([own[k::REPLICATES].mean() for k in range(REPLICATES)])
    spread, mean = float(means.var(ddof=1)), hits / draws
    if spread == 0.0:
        return clopper_pearson(hits, draws, level=level)
    half = 0.5 * (1.0 + level)
    worth = mean * (1.0 - mean) * REPLICATES / spread * float((norm.ppf(half) / t.ppf(half, REPLICATES - 1)) ** 2)
    return Estimate(mean, *clopper_pearson(mean * worth, worth, level=level)[1:])


def _neighbours(counts: IntArray, size: int, level: float) -> Estimate:
    """Probability from numbers of hits that are c or c + 1, in sequences of `size` draws."""
    fewest = int(counts.min())
    more = mid_p(int(np.count_nonzero(counts > fewest)), REPLICATES, level)
    low = fewest + (more.low if more.value else -more.high)
    return Estimate((fewest + more.value) / size, max(low / size, 0.0), min((fewest + more.high) / size, 1.0))


def quantile(values: FloatArray, at: float, *, level: float = LEVEL) -> Estimate:
    """A quantile with the interval between the order statistics that independent draws would have.

    Raises
    ------
    InputError
        No values, or a quantile outside of (0, 1).

    Examples
    --------
    >>> found = quantile(np.arange(1001.0), 0.5)
    >>> found.value, found.low, found.high
    (500.0, 469.0, 531.0)
    """
    ascending = np.sort(values)
    if not (ascending.size and 0.0 < at < 1.0):
        raise InputError(f"quantile: found {at:g} of {ascending.size} values, expected 0 < q < 1 and at least one")
    tail, size = 0.5 * (1.0 - level), ascending.size
    low, high = binom.ppf([tail, 1.0 - tail], size, at)
    ends = np.clip([low - 1.0, high], 0, size - 1).astype(int)
    return Estimate(float(np.quantile(ascending, at)), *(float(end) for end in ascending[ends]))
