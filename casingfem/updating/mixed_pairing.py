"""Which mode is which row where faults mix shapes, so that the n with the largest share is a toss-up.

A mode that is half n = 5 and half n = 8 has one name in the test and may have the other in the model. Rows go to modes
by the least total of |log(f/f_m)|/0.05 + 1 - share, share the part of a mode's circumferential energy at the row's n:
a wrong n costs as much as 5 % in frequency, half a wrong n half of that.
"""

import numpy as np

from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.linalg.assignment import assignment
from casingfem.modal.harmonics import quadrature
from casingfem.modal.mode_set import ModeSet

WRONG = 0.05  # relative frequency error that costs as much as another n
QUARTER = 0.5  # least quadrature at n of the members of a doublet


def paired_by_shares(found: ModeSet, table: FrequencyTable, reach: float) -> tuple[list[Match], list[int]]:
    """Matches in ascending order, doublets where both sides have them, and the rows without a mode within reach."""
    assert found.rings is not None
    shares = found.rings.shares()
    known = (table.n >= 0) & (table.n < len(shares))
    like = np.where(known[:, None], shares[np.minimum(np.maximum(table.n, 0), len(shares) - 1)], 0.0)
    error = np.abs(np.log(table.freq_hz[:, None] / np.maximum(found.freq, 1e-9)))
    error[:, : found.rigid] = np.inf
    cost = np.where(error <= np.log1p(reach), error / WRONG + 1.0 - like, 1e3)
    rows, modes = assignment(cost)
    mode_of = {int(row): int(mode) for row, mode in zip(rows, modes, strict=True) if cost[row, mode] < 1e3}
    matches: list[Match] = []
    for group in table.groups():
        there = sorted((row for row in group.rows if row in mode_of), key=lambda row: mode_of[row])
        whole = len(there) == 2 and quadrature(*(found.rings.profile(mode_of[row], group.n) for row in there)) > QUARTER
        ordered = sorted(there, key=lambda row: float(table.freq_hz[row]))
        planes = [(ordered, [mode_of[row] for row in there])] if whole else [([row], [mode_of[row]]) for row in there]
        matches += [match_of(found, table, rows, modes, group.n) for rows, modes in planes]
    return matches, sorted(set(range(len(table))) - set(mode_of))


def match_of(found: ModeSet, table: FrequencyTable, rows: list[int], modes: list[int], n: int) -> Match:
    """A match of rows and modes, each ascending."""
    return Match(
        rows=tuple(rows),
        modes=tuple(modes),
        n=n,
        confidence=float("nan"),
        measured_hz=tuple(float(table.freq_hz[row]) for row in rows),
        computed_hz=tuple(float(found.freq[mode]) for mode in modes),
    )
