"""Result of pairing: the mode of each row of a frequency table, and its confidence."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

import numpy as np

from casingfem.experiment.frequency_table import FrequencyTable
from contact.io.columns import Column, known, records_of, table_lines
from contact.io.reported import Reported

Indices: TypeAlias = tuple[int, ...]
SHOWN = 12  # named on a line; the document has all


@dataclass(frozen=True, slots=True, kw_only=True)
class Match:
    """Rows of the table and their modes: one and one, or a doublet and a doublet (lower, upper).

    Parameters
    ----------
    rows, modes : indices into the table and the mode set, of equal length
    n : nodal diameters, -1 if neither side states it
    confidence : 1 - (cost of this match)/(cost of the next best), in [0, 1]; 0 if another fits equally well
    measured_hz, computed_hz : frequencies of rows and modes
    """

    rows: Indices
    modes: Indices
    n: int
    confidence: float
    measured_hz: tuple[float, ...]
    computed_hz: tuple[float, ...]


COLUMNS = (
    Column("row", "Row of the frequency table, from 1.", lambda pairs: [pair[0] + 1 for pair in pairs], format="d"),
    Column("mode", "Computed mode, from 1.", lambda pairs: [pair[1] + 1 for pair in pairs], format="d"),
    Column("n", "Nodal diameters, if known from table or model.", lambda pairs: known(pair[2] for pair in pairs),
           format="d"),
    Column("measured_hz", "Measured frequency.", lambda pairs: [pair[3] for pair in pairs], head="measured",
           unit="Hz", format=".3f"),
    Column("computed_hz", "Computed frequency.", lambda pairs: [pair[4] for pair in pairs], head="computed",
           unit="Hz", format=".3f"),
    Column("error_rel", "Computed over measured frequency, minus 1.",
           lambda pairs: [pair[4] / pair[3] - 1.0 for pair in pairs], head="error", unit="%", format=".2f",
           scale=100.0),
    Column("confidence", "Confidence of the pairing, from 0 to 1.", lambda pairs: [pair[5] for pair in pairs],
           format=".2f"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Pairing(Reported):
    """Matches in ascending order, and the unmatched rows and modes (indices).

    >>> Pairing(matches=(), unpaired_rows=(0,), unpaired_modes=(1, 2)).unpaired_modes
    (1, 2)
    """

    COLUMNS: ClassVar = COLUMNS

    matches: tuple[Match, ...]
    unpaired_rows: tuple[int, ...]
    unpaired_modes: tuple[int, ...]

    @property
    def rms(self) -> float:
        """Root mean square of the relative frequency error over the paired rows; nan without pairs."""
        errors = [c / m - 1 for k in self.matches for m, c in zip(k.measured_hz, k.computed_hz, strict=True)]
        return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")

    def __len__(self) -> int:
        return len(self.matches)

    def pairs(self) -> list[tuple[int, int, int, float, float, float]]:
        """Row, mode, n, measured and computed frequency [Hz], confidence of each paired row; rows, modes from 0."""
        return [
            (row, mode, match.n, measured, computed, match.confidence)
            for match in self.matches
            for row, mode, measured, computed in zip(
                match.rows, match.modes, match.measured_hz, match.computed_hz, strict=True
            )
        ]

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each paired row of the table, with rows and modes counted from 1."""
        return records_of(self.COLUMNS, self.pairs())

    def __repr__(self) -> str:
        lines = [
            f"Pairing({len(self)} matches, rms {100 * self.rms:.2f} %,"
            f" unpaired: {len(self.unpaired_rows)} rows, {len(self.unpaired_modes)} modes)",
            *table_lines(self.COLUMNS, self.records()),
        ]
        if self.unpaired_rows:
            lines.append(f"rows without a mode: {', '.join(str(row + 1) for row in self.unpaired_rows)}")
        return "\n".join(lines)


def listed(names: Sequence[object]) -> str:
    """The first names in one line, and the number of further ones."""
    return ", ".join(map(str, names[:SHOWN])) + (f" and {len(names) - SHOWN} more" if len(names) > SHOWN else "")


def modes_of(table: FrequencyTable, rows: Iterable[int]) -> tuple[int, ...]:
    """The mode numbers of a table's rows."""
    return tuple(int(table.mode[row]) for row in rows)


def unpaired_words(modes: Sequence[int], of: str = "table") -> list[str]:
    """The line that names rows without a mode, by their mode numbers; empty if all pair."""
    return [f"no mode pairs with {of} modes {listed(modes)}: they were not used"] if modes else []
