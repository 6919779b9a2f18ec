"""Sobol indices of groups of inputs: the share of each group in the variance of a result.

The first-order index of a group is the share of a result's variance that the group causes alone. Its total index is the
share that would remain if all others were known (A. Saltelli et al., Comput. Phys. Comm. 181, 2010, 259).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from casingfem.chance.points import EDGE
from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray

RESAMPLES = 200  # of the points, for the intervals
TINY = 1e-12  # of the largest square: a resample that does not vary
Results = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Importance:
    """Sobol indices of one group of inputs for one result, each with its interval of 95 %."""

    group: str
    first: float
    first_low: float
    first_high: float
    total: float
    total_low: float
    total_high: float


def importance(
    results: Results, groups: Mapping[str, slice], dimension: int, *, seed: int, size: int = 512
) -> list[list[Importance]]:
    """Indices of each group for each result, from size (groups + 2) evaluations.

    Parameters
    ----------
    results
        Results (points, results) of points in the unit cube (points, dimension).
    groups
        Name of each group and its columns.
    size
        A power of 2.

    Returns
    -------
    list
        For each result, one row for each group; none for a constant result.

    Raises
    ------
    InputError
        If `size` is not a power of 2, or there is no group.

    Examples
    --------
    >>> linear = lambda u: (u @ np.array([2.0, 1.0, 0.0]))[:, None]  # variances 4 to 1 to 0
    >>> (rows,) = importance(linear, {"a": slice(0, 1), "b": slice(1, 3)}, 3, seed=7)
    >>> [(row.group, round(row.first, 2), round(row.total, 2)) for row in rows]
    [('a', 0.8, 0.8), ('b', 0.2, 0.2)]
    """
    if not groups or size < 2 or size & (size - 1):
        raise InputError(
            f"importance: found size {size} and {len(groups)} groups, expected a power of 2 and at least one group"
        )
    parts = [results(own) for own in mixed_designs(groups, dimension, seed=seed, size=size)]
    return [indices(tuple(groups), [part[:, k] for part in parts], seed) for k in range(parts[0].shape[1])]


def mixed_designs(groups: Mapping[str, slice], dimension: int, *, seed: int, size: int) -> list[FloatArray]:
    """Points A and B (size, dimension), and for each group the points A with the group's columns from B."""
    both = qmc.Sobol(2 * dimension, scramble=True, seed=np.random.default_rng([seed, 1 << 20])).random(size)
    both = np.clip(both, EDGE, 1.0 - EDGE)
    found = [both[:, :dimension], both[:, dimension:]]
    for columns in groups.values():
        own = found[0].copy()
        own[:, columns] = found[1][:, columns]
        found.append(own)
    return found


def indices(names: tuple[str, ...], parts: Sequence[FloatArray], seed: int) -> list[Importance]:
    """Indices of one result at the points of `mixed_designs`, (points,) each; empty for a constant result."""
    first, second, *mixed = (np.asarray(part) for part in parts)
    both = np.concatenate([first, second])
    if np.ptp(both) == 0.0:
        return []
    first, second, turned = first - both.mean(), second - both.mean(), np.array(mixed) - both.mean()
    terms = second * (turned - first), 0.5 * (first - turned) ** 2  # of the first-order, of the total index
    square = 0.5 * (first**2 + second**2)
    chosen = np.random.default_rng([seed, RESAMPLES]).integers(0, len(first), (RESAMPLES, len(first)))
    least = TINY * float(square.max())
    columns = []
    for term in terms:
        value = term.mean(axis=1) / square.mean()
        again = term[:, chosen].mean(axis=-1) / np.maximum(square[chosen].mean(axis=-1), least)
        columns += [value, *np.percentile(again, [2.5, 97.5], axis=1)]
    return [Importance(name, *map(float, row)) for name, row in zip(names, np.array(columns).T, strict=True)]
