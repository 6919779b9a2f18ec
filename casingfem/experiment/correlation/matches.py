"""The outcome of pairing: which rows of a frequency table are which computed modes, and how sure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from casingfem.experiment.correlation.alignment import Indices
from casingfem.experiment.frequency_table import FrequencyTable
from contact.io.reported import Reported

SHOWN = 12  # named on a line; the document has all


@dataclass(frozen=True, slots=True, kw_only=True)
class Match:
    """Rows of the table and the modes they are: one and one, or a doublet and a doublet (lower, upper).

    Parameters
    ----------
    rows, modes : indices into the table and the mode set, of equal length
    n : nodal diameters, -1 where neither side says
    confidence : 1 - (cost of this match)/(cost of the next best), in [0, 1]; 0 when another fits as well
    measured_hz, computed_hz : frequencies of rows and modes
    """

    rows: Indices
    modes: Indices
    n: int
    confidence: float
    measured_hz: tuple[float, ...]
    computed_hz: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Pairing(Reported):
    """Matches in ascending order, and what is left on both sides (indices of rows and of modes)."""

    matches: tuple[Match, ...]
    unpaired_rows: tuple[int, ...]
    unpaired_modes: tuple[int, ...]

    @property
    def rms(self) -> float:
        """Root mean square of the relative frequency error over the paired rows; nan without any."""
        errors = [c / m - 1 for k in self.matches for m, c in zip(k.measured_hz, k.computed_hz, strict=True)]
        return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")

    def __len__(self) -> int:
        return len(self.matches)

    def records(self) -> list[dict[str, object]]:
        """One plain dictionary a paired row of the table, rows and modes counted from 1."""
        return [
            {"row": row + 1, "mode": mode + 1, "n": match.n if match.n >= 0 else None, "measured_hz": measured,
             "computed_hz": computed, "confidence": match.confidence}
            for match in self.matches
            for row, mode, measured, computed in zip(
                match.rows, match.modes, match.measured_hz, match.computed_hz, strict=True
            )
        ]  # fmt: skip

    def __repr__(self) -> str:
        lines = [
            f"Pairing({len(self)} matches, rms {100 * self.rms:.2f} %,"
            f" unpaired: {len(self.unpaired_rows)} rows, {len(self.unpaired_modes)} modes)",
            "   row  mode   n  measured [Hz]  computed [Hz]  error [%]  confidence",
        ]
        for match in self.matches:
            n = "-" if match.n < 0 else str(match.n)
            members = zip(match.rows, match.modes, match.measured_hz, match.computed_hz, strict=True)
            for k, (row, mode, measured, computed) in enumerate(members):
                error = 100 * (computed / measured - 1)
                sure = f"{match.confidence:11.2f}" if k == 0 else ""
                line = f"{row:6d} {mode:5d} {n:>3} {measured:14.3f} {computed:14.3f} {error:10.2f} {sure}"
                lines.append(line.rstrip())
        if self.unpaired_rows:
            lines.append(f"  rows without a mode: {', '.join(map(str, self.unpaired_rows))}")
        return "\n".join(lines)


def listed(names: Sequence[object]) -> str:
    """The first names on a line, and how many more there are."""
    return ", ".join(map(str, names[:SHOWN])) + (f" and {len(names) - SHOWN} more" if len(names) > SHOWN else "")


def modes_of(table: FrequencyTable, rows: Iterable[int]) -> tuple[int, ...]:
    """The mode numbers of a table's rows."""
    return tuple(int(table.mode[row]) for row in rows)


def unpaired_words(modes: Sequence[int], of: str = "table") -> list[str]:
    """The line that names rows that no mode pairs with, by their mode numbers; none where all pair."""
    return [f"no mode pairs with {of} modes {listed(modes)}: they took no part"] if modes else []
