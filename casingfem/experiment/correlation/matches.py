"""Result of pairing: the mode of each row of a frequency table, its confidence, and the unit of the rows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NoReturn, TypeAlias

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray
from contact.io.columns import Column, known, records_of, table_lines
from contact.io.reported import Reported

Indices: TypeAlias = tuple[int, ...]
SHOWN = 12  # named on a line; the document has all
UNITS = {"rad/s": 2.0 * math.pi, "kHz": 1e-3, "1/min": 60.0}
ALIKE = 0.2  # relative: models before an update are not better than that


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


def other_unit(table: FrequencyTable, freq: FloatArray, n: IntArray | None) -> str:
    """The unit in which the table agrees with the lowest computed modes; "" if there is none except maybe Hz.

    The lowest row with n nodal diameters is compared with the lowest such mode, the k-th row without n with the k-th
    mode.

    Parameters
    ----------
    freq, n
        Computed frequencies in Hz, ascending, and nodal diameters (modes,); None for modes without labels.
    """
    if freq[0] <= 0.0:
        return ""  # of a part that floats
    order = np.sort(table.freq_hz)
    ratios = order[: len(freq)] / freq[: len(order)]
    if n is not None and np.all(table.n >= 0):
        labels = np.intersect1d(table.n, n)
        ratios = np.array([table.freq_hz[table.n == label].min() / freq[n == label].min() for label in labels])
    for unit, factor in UNITS.items():
        if len(ratios) > 1 and np.all(np.abs(np.log(ratios / factor)) < ALIKE):
            return unit
    return ""


def refuse_unpaired(table: FrequencyTable, freq: FloatArray, n: IntArray | None, reach: float) -> NoReturn:
    """Raise an error that no row pairs with a computed mode, with the reason if the table is in another unit.

    Raises
    ------
    InputError
        Naming the unit, or the frequencies of both sides.
    """
    require_hz(table, freq, n)
    raise InputError(
        f"no row of {table.path} pairs with a computed mode within {reach:.0%}: "
        f"measured {table.freq_hz.min():.1f} to {table.freq_hz.max():.1f} Hz, "
        f"computed {freq[0]:.1f} to {freq[-1]:.1f} Hz"
    )


def require_hz(table: FrequencyTable, freq: FloatArray, n: IntArray | None) -> None:
    """Refuse a table in another unit.

    Raises
    ------
    InputError
        Naming the unit, the first row and the mode beside it.
    """
    if unit := other_unit(table, freq, n):
        raise InputError(
            table.path, column="freq_hz",
            found=f"{table.freq_hz.min():.6g} to {table.freq_hz.max():.6g}, where the lowest computed mode has "
            f"{freq[0]:.6g} Hz: in every row about {UNITS[unit]:.4g} times what is computed, as of {unit}",
            expected="Hz",
        )  # fmt: skip
