"""Pairing of measured and computed modes; a doublet is paired as a whole.

Both sides are sequences in ascending frequency: groups of one row or of two in a doublet, slots of one mode or of two
in a doublet. A group is assigned to a slot or left out, and the order is preserved. It is the optimal assignment on a
line, with each doublet as a unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from casingfem.experiment.correlation.matches import Indices, Match, Pairing
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.assignment import assignment

__all__ = ["ModeSet", "Pairing", "pair"]

Cost: TypeAlias = Callable[[Indices, Indices], float]
SKIPPED = 0.02
"""A computed mode left without a row below a paired one costs as much as 2 % in frequency."""
LEFT_OUT = 3.0
"""A row left out costs as much as this many rows at the end of their reach: pair all that can be."""
TIE = 1e-3
"""Of the members of a doublet, equal in all else, the one alike takes the row."""
SPLIT = 10.0
"""A doublet split by more than so many sigma of a single row has members that the row's angle distinguishes."""
WORST_SHAPE = 0.5
"""Where shapes are given, a row is rather left out than paired for more than this beyond its reach."""


class ModeSet(Protocol):
    """Interface of computed modes for pairing: three arrays, ascending in frequency."""

    @property
    def freq(self) -> FloatArray:
        """Frequencies [Hz], (m,)."""

    @property
    def nodal_diameters(self) -> IntArray:
        """Nodal diameters, -1 if they are not defined, (m,)."""

    @property
    def doublets(self) -> tuple[tuple[int, int], ...]:
        """Index pairs (lower, upper)."""


def pair(modes: ModeSet, table: FrequencyTable, *, reach: float = 0.5, shape_mac: ArrayLike | None = None) -> Pairing:
    """Pair measured rows with computed modes.

    The cost of a row is |log(f_measured/f_computed)|, of a doublet twice that of its root mean square, plus 1 - MAC if
    that is given. Rows labelled n are aligned, in order, with the modes of that n, measured doublets with computed
    doublets; a single row goes to a single mode or to a member of a doublet, by its angle if the two are well apart in
    frequency, else to the nearer. Rows without a label (and, on structures without nodal diameters, all rows) then
    share the remaining modes: in order of frequency, or with shape_mac by the optimal assignment. Two rows in the same
    doublet form one match.

    Parameters
    ----------
    modes : computed, ascending
    table : measured
    reach : largest relative frequency error of a match
    shape_mac : (rows, modes) MAC of measured with computed shapes, as ``mac`` gives it

    Raises
    ------
    ValueError
        Modes that are not ascending, reach <= 0, a shape_mac of another size.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> ring = SimpleNamespace(
    ...     freq=np.array([366.0, 366.0, 381.0, 381.0]),
    ...     nodal_diameters=np.array([8, 8, 7, 7]),
    ...     doublets=((0, 1), (2, 3)),
    ... )
    >>> pair(ring, FrequencyTable.from_arrays(n=[7, 8, 8], freq_hz=[383.0, 367.9, 368.4], sigma_hz=0.2))
    Pairing(2 matches, rms 0.57 %, unpaired: 0 rows, 1 modes)
    row  mode  n  measured [Hz]  computed [Hz]  error [%]  confidence
      2     1  8        367.900        366.000      -0.52        0.99
      3     2  8        368.400        366.000      -0.65        0.99
      1     3  7        383.000        381.000      -0.52        0.99
    """
    cost = _Cost(modes, table, reach, shape_mac)
    slots = _slots(modes)
    found: list[tuple[Indices, Indices]] = []
    unlabelled: list[int] = []
    groups = table.groups()
    for n in sorted({group.n for group in groups}):
        rows = [group.rows for group in groups if group.n == n]
        of_n = [slot for slot in slots if modes.nodal_diameters[slot[0]] == n]
        if n >= 0 and of_n:
            found += align(rows, of_n, cost, left_out=cost.left_out, skipped=[SKIPPED] * len(of_n))
        else:
            unlabelled += [row for group in rows for row in group]
    found = [(rows, cost.members(rows, matched)) for rows, matched in found]
    taken = {mode for _, matched in found for mode in matched}
    rest = [mode for mode in range(len(modes.freq)) if mode not in taken]
    unlabelled.sort(key=lambda row: (table.freq_hz[row], row))
    if cost.shapes is None:
        skipped = [SKIPPED if len(cost.slot_of[mode]) == 1 else 0.0 for mode in rest]
        rows, alone = [(row,) for row in unlabelled], [(mode,) for mode in rest]
        found += align(rows, alone, cost, left_out=cost.left_out, skipped=skipped)
    else:
        found += _assigned(unlabelled, rest, cost, cost.shapes)
    return _pairing(found, slots, cost)


class _Cost:
    """Cost of pairing rows with modes; inf if the labels or the reach forbid it."""

    def __init__(self, modes: ModeSet, table: FrequencyTable, reach: float, shape_mac: ArrayLike | None) -> None:
        if not reach > 0.0:
            raise ValueError(f"reach must be > 0, not {reach!r}")
        if np.any(np.diff(modes.freq) < 0.0):
            raise ValueError("pair: the computed modes must be in ascending order of frequency")
        self.modes, self.table = modes, table
        self.limit = float(np.log1p(reach))
        self.shapes = None if shape_mac is None else np.asarray(shape_mac, float)
        if self.shapes is not None and self.shapes.shape != (len(table), len(modes.freq)):
            expected = (len(table), len(modes.freq))
            raise ValueError(f"pair: shape_mac must be the MAC matrix {expected}, not {self.shapes.shape}")
        self.worst = self.limit + (0.0 if self.shapes is None else WORST_SHAPE)
        self.left_out = LEFT_OUT * self.limit if self.shapes is None else self.worst
        self.slot_of = {mode: slot for slot in _slots(modes) for mode in slot}

    def __call__(self, rows: Indices, modes: Indices) -> float:
        """Cost of one or two rows on as many modes, or of one row on a member of two."""
        measured, computed = self.table.n[rows[0]], self.modes.nodal_diameters[modes[0]]
        if measured >= 0 and computed >= 0 and measured != computed:
            return float("inf")
        members = self.members(rows, modes)
        freq, target = self.modes.freq[list(members)], self.table.freq_hz[list(rows)]
        if freq.min() <= 0.0:
            return float("inf")
        error = 0.5 * abs(float(np.log(np.sum(target**2) / np.sum(freq**2))))
        return len(rows) * (error + self.unlike(rows, modes)) if error <= self.limit else float("inf")

    def members(self, rows: Indices, modes: Indices) -> Indices:
        """As many modes as rows: for one row and a doublet, the member that the row represents."""
        if len(rows) == len(modes):
            return modes
        return (member_of(modes, self.modes, self.table, rows[0]),)

    def unlike(self, rows: Indices, modes: Indices) -> float:
        """1 - MAC of the spaces: a doublet's members may be rotated, so they are compared together."""
        if self.shapes is None:
            return 0.0
        plane = [mode for slot in {self.slot_of[mode] for mode in modes} for mode in slot]
        return max(1.0 - float(self.shapes[np.ix_(rows, plane)].sum()) / len(rows), 0.0)


def member_of(doublet: Sequence[int], modes: ModeSet, table: FrequencyTable, row: int) -> int:
    """The member of a computed doublet that a single row represents: by its angle if that is clear, else the nearer.

    A row with a wrong frequency may be closer to the other member, 90 deg/n away. Computed angles mean little if the
    split is small.
    """
    first, second = (int(mode) for mode in doublet)
    turned = np.asarray(getattr(modes, "angle_deg", np.full(len(modes.freq), np.nan)), float)[[first, second]]
    n, apart = int(table.n[row]), abs(float(modes.freq[second] - modes.freq[first]))
    if n > 0 and apart > SPLIT * table.sigma_hz[row] and np.isfinite([*turned, table.angle_deg[row]]).all():
        off = np.abs((turned - table.angle_deg[row] + 90.0 / n) % (180.0 / n) - 90.0 / n)
        if 2.0 * off.min() < off.max():
            return (first, second)[int(off.argmin())]
    return min(first, second, key=lambda mode: abs(float(modes.freq[mode]) - float(table.freq_hz[row])))


def _slots(modes: ModeSet) -> list[Indices]:
    """Doublets and single modes in ascending (mean) frequency."""
    paired = {mode for doublet in modes.doublets for mode in doublet}
    singles: list[Indices] = [(mode,) for mode in range(len(modes.freq)) if mode not in paired]
    doublets: list[Indices] = [(int(a), int(b)) for a, b in modes.doublets]
    return sorted(singles + doublets, key=lambda slot: (float(modes.freq[list(slot)].mean()), slot))


def _assigned(
    rows: Sequence[int], modes: Sequence[int], cost: _Cost, shapes: FloatArray
) -> list[tuple[Indices, Indices]]:
    """Assign rows to modes at the least total cost; as many extra columns as rows mean "no mode"."""
    prices = np.full((len(rows), len(modes) + len(rows)), cost.left_out)
    for i, row in enumerate(rows):
        for j, mode in enumerate(modes):
            prices[i, j] = cost((row,), (mode,)) + TIE * (1.0 - shapes[row, mode])
    chosen = zip(*assignment(prices), strict=True)
    return [((rows[i],), (modes[j],)) for i, j in chosen if j < len(modes)]


def _pairing(found: Sequence[tuple[Indices, Indices]], slots: Sequence[Indices], cost: _Cost) -> Pairing:
    """Join rows that share a doublet, and compute the confidence of each match."""
    row_of = {mode: row for rows, modes in found for row, mode in zip(rows, modes, strict=True)}
    freq, measured = cost.modes.freq, cost.table.freq_hz
    matches = []
    for slot in slots:
        modes = tuple(mode for mode in slot if mode in row_of)
        if not modes:
            continue
        rows = tuple(sorted((row_of[mode] for mode in modes), key=lambda row: (measured[row], row)))
        n = int(cost.modes.nodal_diameters[modes[0]])
        matches.append(
            Match(
                rows=rows,
                modes=modes,
                n=n if n >= 0 else int(cost.table.n[rows[0]]),
                confidence=_confidence(rows, modes, slots, cost),
                measured_hz=tuple(float(measured[row]) for row in rows),
                computed_hz=tuple(float(freq[mode]) for mode in modes),
            )
        )
    return Pairing(
        matches=tuple(matches),
        unpaired_rows=tuple(sorted(set(range(len(measured))) - set(row_of.values()))),
        unpaired_modes=tuple(mode for mode in range(len(freq)) if mode not in row_of),
    )


def _confidence(rows: Indices, modes: Indices, slots: Sequence[Indices], cost: _Cost) -> float:
    """1 - best/second best cost, where leaving the rows out also counts as an alternative."""
    others = [slot for slot in slots if len(slot) >= len(rows) and not set(slot) & set(modes)]
    second = min([cost(rows, slot) for slot in others] + [cost.worst * len(rows)])
    best = cost(rows, modes)
    return max(0.0, 1.0 - best / second) if second > 0.0 else 0.0


def align(
    groups: Sequence[Indices], slots: Sequence[Indices], cost: Cost, *, left_out: float, skipped: Sequence[float]
) -> list[tuple[Indices, Indices]]:
    """The cheapest list of (rows, modes).

    Parameters
    ----------
    groups, slots : row indices and mode indices, one or two each
    cost : of assigning rows to modes, inf if forbidden; one row may be assigned to a slot of two
    left_out : cost of each row without a mode
    skipped : (slots,) cost of each empty slot below the last used one

    Moves beyond one to one: two single rows fill a doublet; a measured doublet takes two
    neighbouring single modes, or assigns one row to one mode and leaves out the other.

    Examples
    --------
    >>> freq = {"rows": [100.0, 101.0, 300.0], "modes": [104.0, 104.0, 210.0, 290.0]}
    >>> def cost(rows, modes):
    ...     return abs(freq["rows"][rows[0]] - freq["modes"][modes[0]]) * len(rows)
    >>> align([(0, 1), (2,)], [(0, 1), (2,), (3,)], cost, left_out=50.0, skipped=[0.0] * 3)
    [((0, 1), (0, 1)), ((2,), (3,))]
    """
    inf = float("inf")
    best = [[inf] * (len(slots) + 1) for _ in range(len(groups) + 1)]
    came: dict[tuple[int, int], tuple[int, int, tuple[Indices, Indices] | None]] = {}
    best[0][0] = 0.0

    def offer(g: int, s: int, from_g: int, from_s: int, price: float, match: tuple[Indices, Indices] | None) -> None:
        total = best[from_g][from_s] + price
        if total < best[g][s]:
            best[g][s], came[g, s] = total, (from_g, from_s, match)

    for g in range(len(groups) + 1):
        for s in range(len(slots) + 1):
            if g and s:
                pair = groups[g - 1], slots[s - 1]
                if len(pair[0]) <= len(pair[1]):
                    offer(g, s, g - 1, s - 1, cost(*pair), pair)
                else:
                    for row in pair[0]:
                        alone = (row,), pair[1]
                        offer(g, s, g - 1, s - 1, cost(*alone) + left_out, alone)
            if g > 1 and s and len(slots[s - 1]) == 2 and len(groups[g - 1]) == len(groups[g - 2]) == 1:
                pair = groups[g - 2] + groups[g - 1], slots[s - 1]
                price = sum(cost((row,), (mode,)) for row, mode in zip(*pair, strict=True))
                offer(g, s, g - 2, s - 1, price, pair)
            if g and s > 1 and len(groups[g - 1]) == 2 and len(slots[s - 1]) == len(slots[s - 2]) == 1:
                pair = groups[g - 1], slots[s - 2] + slots[s - 1]
                offer(g, s, g - 1, s - 2, cost(*pair), pair)
            if s:
                offer(g, s, g, s - 1, skipped[s - 1], None)
            if g:
                offer(g, s, g - 1, s, left_out * len(groups[g - 1]), None)
    matches = []
    g, s = len(groups), min(range(len(slots) + 1), key=lambda k: best[len(groups)][k])
    while (g, s) != (0, 0):
        g, s, match = came[g, s]
        if match is not None:
            matches.append(match)
    return matches[::-1]
