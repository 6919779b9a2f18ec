"""Rows of a frequency table that are the two members of one doublet."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray

WIDEST_SPLIT = 0.15
"""Two rows further apart than this, relative to their mean, are not taken for one doublet."""


@dataclass(frozen=True, slots=True)
class Single:
    """A single row: n = 0, unlabelled, or without a measured partner."""

    row: int
    n: int

    @property
    def rows(self) -> tuple[int, ...]:
        """The row as a tuple, as in Doublet."""
        return (self.row,)


@dataclass(frozen=True, slots=True)
class Doublet:
    """Two rows (lower, upper) of the same n that form a split pair."""

    rows: tuple[int, int]
    n: int


Group: TypeAlias = Single | Doublet


def grouped(n: IntArray, freq_hz: FloatArray, angle_deg: FloatArray) -> tuple[Group, ...]:
    """Group rows (rows,) into doublets and singles, ascending in frequency.

    Among the rows of one n >= 1 in ascending order, neighbours closer than 15 % may be a doublet, the closest first,
    each row once. If both orientations are known they must differ by about 90/n deg (modulo 180/n, nearer to that than
    to 0). All other rows, including n = 0 and n = -1 (no label), stay single.

    Examples
    --------
    >>> groups = grouped(np.array([4, 4, 0]), np.array([655.0, 657.0, 1726.0]), np.full(3, np.nan))
    >>> [group.rows for group in groups]
    [(0, 1), (2,)]
    """
    partner: dict[int, int] = {}
    for number in np.unique(n[n >= 1]):
        rows = np.flatnonzero(n == number)
        rows = rows[np.argsort(freq_hz[rows], kind="stable")]
        gap = 2 * np.diff(freq_hz[rows]) / (freq_hz[rows][1:] + freq_hz[rows][:-1])
        for k in np.argsort(gap, kind="stable"):
            i, j = int(rows[k]), int(rows[k + 1])
            free = i not in partner and j not in partner
            if free and gap[k] < WIDEST_SPLIT and _orthogonal(angle_deg[i], angle_deg[j], int(number)):
                partner[i], partner[j] = j, i
    groups: list[Group] = []
    placed: set[int] = set()
    for row in np.argsort(freq_hz, kind="stable").tolist():
        if row in placed:
            continue
        number = int(n[row])
        groups.append(Doublet((row, partner[row]), number) if row in partner else Single(row, number))
        placed.update(groups[-1].rows)
    return tuple(groups)


def _orthogonal(a: float, b: float, n: int) -> bool:
    """Whether two orientations [deg] may belong to a doublet; true if one is unknown."""
    if np.isnan(a) or np.isnan(b):
        return True
    period = 180.0 / n
    distance = abs((a - b + period / 2) % period - period / 2)  # 0 alike, period/2 orthogonal
    return bool(distance > period / 4)
