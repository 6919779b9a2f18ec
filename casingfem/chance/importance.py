"""Which input matters: Sobol indices of groups of inputs.

The first-order index of a group is the share of a result's variance that the group causes alone, its total index the
share that would be left if all others were known (A. Saltelli et al., Comput. Phys. Comm. 181, 2010, 259).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc, sobol_indices

from casingfem.chance.points import EDGE
from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray

RESAMPLES = 200
Results = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
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
        For each result, one row a group; results that do not vary have none.

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
        raise InputError(f"importance: found size {size} and {len(groups)} groups, expected a power of 2 and a group")
    both = qmc.Sobol(2 * dimension, scramble=True, seed=np.random.default_rng([seed, 1 << 20])).random(size)
    both = np.clip(both, EDGE, 1.0 - EDGE)
    A, B = both[:, :dimension], both[:, dimension:]
    mixed = []
    for columns in groups.values():
        own = A.copy()
        own[:, columns] = B[:, columns]
        mixed.append(own)
    first, second = results(A), results(B)
    of_mixed = np.array([results(own) for own in mixed])  # (groups, points, results)
    found = []
    for k in range(first.shape[1]):
        given = {"f_A": first[None, :, k], "f_B": second[None, :, k], "f_AB": of_mixed[:, None, :, k]}
        found.append(indices(tuple(groups), given, size, seed))
    return found


def indices(names: tuple[str, ...], given: Mapping[str, FloatArray], size: int, seed: int) -> list[Importance]:
    """Indices of one result; none where it does not vary."""
    if np.ptp(given["f_A"]) == 0.0 and np.ptp(given["f_B"]) == 0.0:
        return []
    found = sobol_indices(func=dict(given), n=size, random_state=np.random.default_rng(seed))
    sure = found.bootstrap(n_resamples=RESAMPLES)
    parts = zip(
        names,
        np.atleast_1d(found.first_order),
        *(np.atleast_1d(end) for end in sure.first_order.confidence_interval),
        np.atleast_1d(found.total_order),
        *(np.atleast_1d(end) for end in sure.total_order.confidence_interval),
        strict=True,
    )
    return [
        Importance(
            group=name, first=float(a), first_low=float(b), first_high=float(c), total=float(d), total_low=float(e),
            total_high=float(f),
        )
        for name, a, b, c, d, e, f in parts
    ]  # fmt: skip
