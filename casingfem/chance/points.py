"""Quasi-random points by number: draw k is the same in every order, in every process, and with any other draws.

The draws are those of `REPLICATES` Sobol sequences that are scrambled independently of each other (A. B. Owen, J.
Complexity 14, 1998, 466): draw k is number k // REPLICATES of sequence k % REPLICATES. Each sequence fills the unit
cube evenly. The spread of their means gives the uncertainty of the mean of all (`estimates`).
"""

from functools import lru_cache

import numpy as np
from scipy.stats import qmc

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray

REPLICATES = 16
MOST = 21_201  # dimensions of the sequence
EDGE = 2.0**-54  # nearest to 0 and 1: both have no quantile


def points(seed: int, draws: range, dimension: int) -> FloatArray:
    """Points (draws, dimension) in the open unit cube.

    Parameters
    ----------
    seed
        Whole number from 0: the same seed gives the same points.
    draws
        Consecutive numbers of draws, in whole rounds of `REPLICATES` except the last.

    Raises
    ------
    InputError
        There are more dimensions than the sequence has, or the draws do not begin with a round.

    Examples
    --------
    >>> points(7, range(32), 3)[16:].tolist() == points(7, range(16, 32), 3).tolist()
    True
    """
    if not 1 <= dimension <= MOST:
        raise InputError(f"dimension: found {dimension} random numbers for each draw, expected 1 to {MOST}")
    if draws.start % REPLICATES or draws.step != 1:
        raise InputError(f"draws: found {draws}, expected consecutive numbers that begin at a multiple of {REPLICATES}")
    rounds = -(-len(draws) // REPLICATES)
    found = np.empty((rounds, REPLICATES, dimension))
    for own, sequence in enumerate(sequences(seed, dimension)):
        sequence.reset()
        if draws.start:
            sequence.fast_forward(draws.start // REPLICATES)
        found[0, own] = sequence.random(1)  # scipy warns of first numbers that are no power of 2
        found[1:, own] = sequence.random(rounds - 1)
    return np.clip(found.reshape(-1, dimension)[: len(draws)], EDGE, 1.0 - EDGE)


@lru_cache(maxsize=2)
def sequences(seed: int, dimension: int) -> tuple[qmc.Sobol, ...]:
    """The scrambled sequences: scrambling takes far longer than a few points."""
    seeds = (np.random.default_rng([seed, own]) for own in range(REPLICATES))
    return tuple(qmc.Sobol(dimension, scramble=True, seed=each) for each in seeds)
