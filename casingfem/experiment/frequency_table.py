"""The experimental frequency table: the result of a modal test and the input of an update."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError, warn
from casingfem.experiment.grouping import Doublet, Group, grouped
from casingfem.io.arrays import Array, FloatArray, IntArray, frozen
from casingfem.io.columns import TABLE, named
from casingfem.io.strict_csv import StrictCsv, read
from casingfem.io.together import together
from casingfem.modal import mode_columns
from contact.io.columns import Column, known, records_of, table_lines
from contact.io.outfiles import write_atomic
from contact.io.reported import Reported

TABLE_COLUMNS = (
    Column("mode", "Mode number of the test.", lambda table: table.mode, format="d"),
    Column("n", "Nodal diameters, if known from the test.", lambda table: known(table.n), format="d"),
    Column("freq_hz", "Measured frequency.", lambda table: table.freq_hz, head="freq", unit="Hz", format=".4f"),
    Column("sigma_hz", "Standard uncertainty of the frequency.", lambda table: table.sigma_hz, head="sigma",
           unit="Hz", format=".4f"),
    Column("angle_deg", "Angle of an antinode.", lambda table: table.angle_deg, head="angle", unit="deg", format=".2f"),
    Column("zeta", "Damping ratio.", lambda table: table.zeta, format=".5f"),
)  # fmt: skip
COLUMNS = tuple(column.name for column in TABLE_COLUMNS)
COMPUTED = tuple(column.name for column in mode_columns.COLUMNS if column.name not in COLUMNS)
"""Columns that `casingfem modes --out` writes beside these; they are read over, so that its file is a table too."""
_REQUIRED = {
    "mode": "mode numbers 1, 2, ...",
    "freq_hz": "frequencies in Hz",
    "sigma_hz": "the standard uncertainty of each frequency in Hz; add a column sigma_hz with the test's"
    " repeatability, or half the frequency resolution where that is not known",
}
_BLANK = {"n": -1, "angle_deg": np.nan, "zeta": np.nan}
_EXPECTED = {
    "mode": "mode numbers >= 1, each once",
    "n": "a number of nodal diameters >= 0, or an empty cell",
    "freq_hz": "a frequency > 0",
    "sigma_hz": "0 < sigma_hz < freq_hz",
    "angle_deg": "0 <= angle_deg < 360, or an empty cell",
    "zeta": "a damping ratio in [0, 1), not per cent, or an empty cell",
}
PERCENT = 0.1  # a median damping ratio above it was written in per cent: structures have less


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FrequencyTable(Reported):
    """Measured modes: arrays (rows,), read-only.

    Parameters
    ----------
    mode : mode numbers of the test, each once
    n : nodal diameters, -1 if the test does not state them
    freq_hz, sigma_hz : frequency and its standard uncertainty, Hz
    angle_deg : orientation of an antinode, deg, nan where unknown
    zeta : damping ratio, nan where unknown
    card : comment lines, without the '#'; the first one is marked SYNTHETIC if the data are not measured
    path : the file that was read
    extra : further columns of the file by name, as text: stored and written again, but not used

    Raises
    ------
    InputError
        Values are out of range, mode numbers repeat, arrays differ in length, or there are no rows.

    Examples
    --------
    >>> FrequencyTable.from_arrays(freq_hz=[367.9, 368.4], sigma_hz=0.2, n=[8, 8])
    FrequencyTable(2 modes, 1 doublet)
    mode  n  freq [Hz]  sigma [Hz]  angle [deg]  zeta
       1  8   367.9000      0.2000            -     -
       2  8   368.4000      0.2000            -     -
    """

    mode: IntArray
    n: IntArray
    freq_hz: FloatArray
    sigma_hz: FloatArray
    angle_deg: FloatArray
    zeta: FloatArray
    card: tuple[str, ...] = ()
    path: str = "table"
    extra: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in COLUMNS:
            array = np.asarray(getattr(self, name), np.int64 if name in ("mode", "n") else np.float64)
            object.__setattr__(self, name, frozen(array))
        lines = [line.strip() for text in self.card for line in (text.splitlines() or [""])]
        object.__setattr__(self, "card", tuple(lines))
        shapes = {getattr(self, name).shape for name in COLUMNS}
        if len(shapes) != 1 or self.mode.ndim != 1 or self.mode.size == 0:
            found = ", ".join(f"{name} {getattr(self, name).shape}" for name in COLUMNS)
            raise InputError(self.path, found=found, expected="arrays of one common length >= 1")
        for row, name in _faults({name: getattr(self, name) for name in COLUMNS})[:1]:
            found = f"{name} = {getattr(self, name)[row]} in row {row + 1}"
            raise InputError(self.path, found=found, expected=_EXPECTED[name])

    @classmethod
    def from_arrays(
        cls,
        *,
        freq_hz: ArrayLike,
        sigma_hz: ArrayLike,
        mode: ArrayLike | None = None,
        n: ArrayLike = -1,
        angle_deg: ArrayLike = np.nan,
        zeta: ArrayLike = np.nan,
        card: Sequence[str] = (),
        synthetic: bool = False,
        path: str = "table",
    ) -> FrequencyTable:
        """Build from arrays or scalars broadcast to the frequencies; ``synthetic`` marks the first comment line."""
        freq = np.atleast_1d(np.asarray(freq_hz, float))
        lines = tuple(card)
        if synthetic and not (lines and _says_synthetic(lines[0])):
            lines = ("SYNTHETIC: made by a program, not measured", *lines)
        whole = {"mode": np.arange(1, freq.size + 1) if mode is None else mode, "n": n}
        for name, values in whole.items():
            if np.any(np.asarray(values) != np.trunc(values)):
                raise InputError(path, found=f"{name} = {values!r}", expected="whole numbers")
        numbers = whole | {"sigma_hz": sigma_hz, "angle_deg": angle_deg, "zeta": zeta}
        rest: dict[str, Any] = {
            name: np.broadcast_to(values, freq.shape) if np.ndim(values) == 0 else values
            for name, values in numbers.items()
        }
        return cls(freq_hz=freq, card=lines, path=path, **rest)

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str], *, sigma: float | None = None) -> FrequencyTable:
        """Read mode,n,freq_hz,sigma_hz,angle_deg,zeta; n, angle_deg, zeta may be empty or absent.

        Column names may differ in case, have units in brackets, or be common words; units are converted: `Frequency
        [kHz]`, `Nodal diameter`, `Damping [%]` (`casingfem.io.columns`). The table of `casingfem modes --out` is read
        too, without its additional values. Other columns are stored but not used; one that resembles the name of a
        missing column is refused as misspelt. `sigma`, relative to the frequency, replaces sigma_hz if the row or the
        file does not state it.

        Warns
        -----
        ModelWarning
            `table-columns`: columns that are not used.

        Raises
        ------
        InputError
            Every deviation from such a table, with file, line and column.
        """
        csv = named(read(path), TABLE)
        extra = _extra_columns(csv, sigma)
        columns, wrong = dict[str, Array](), list[InputError]()
        for name in COLUMNS:
            try:
                columns[name] = _column(csv, name, sigma, columns)
            except InputError as error:
                wrong.append(error)
        wrong += _misfits(csv, columns)
        if wrong:
            raise together(wrong)
        return cls(**columns, card=csv.card, path=csv.path, extra={name: csv.cells[name] for name in extra})

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the table, whole or not at all; reading it back gives every number bit for bit."""
        lines = [f"# {line}".rstrip() for line in self.card]
        own = [*COLUMNS[:-1], "zeta [-]" if _looks_like_percent(self.zeta) else "zeta"]
        lines.append(",".join((*own, *map(_quoted, self.extra))))
        for row in range(len(self)):
            values = ((name, getattr(self, name)[row].item()) for name in COLUMNS)
            cells = ["" if value != value or (name == "n" and value < 0) else repr(value) for name, value in values]
            lines.append(",".join([*cells, *(_quoted(column[row]) for column in self.extra.values())]))
        write_atomic(path, "\n".join(lines) + "\n")

    @property
    def synthetic(self) -> bool:
        """Whether the first comment line is marked SYNTHETIC: the data are not measured."""
        return bool(self.card) and _says_synthetic(self.card[0])

    def groups(self) -> tuple[Group, ...]:
        """Doublets and singles of the table; the rule is that of ``grouping.grouped``."""
        return grouped(self.n, self.freq_hz, self.angle_deg)

    def splits(self) -> dict[int, float]:
        """Relative split (f_upper - f_lower)/mean of the lowest doublet of each n."""
        found: dict[int, float] = {}
        for group in self.groups():
            if isinstance(group, Doublet) and group.n not in found:
                low, high = self.freq_hz[list(group.rows)]
                found[group.n] = float((high - low) / (0.5 * (low + high)))
        return found

    def without(self, *modes: int) -> FrequencyTable:
        """Leave out the rows with these mode numbers.

        Raises
        ------
        ValueError
            A mode number is not in the table, or all rows are left out.
        """
        missing = sorted(set(modes) - set(self.mode.tolist()))
        if missing:
            raise ValueError(f"{self.path} has no mode {missing[0]}; it has {self.mode.tolist()}")
        kept = ~np.isin(self.mode, modes)
        arrays = {name: getattr(self, name)[kept] for name in COLUMNS}
        extra = {name: tuple(np.array(cells, dtype=object)[kept]) for name, cells in self.extra.items()}
        return FrequencyTable(**arrays, card=self.card, path=self.path, extra=extra)

    def __len__(self) -> int:
        return int(self.mode.size)

    def columns(self) -> dict[str, Any]:
        """One row for each mode, with the file's further columns; n is None and numbers nan if the test has none."""
        return {column.name: column.values(self) for column in TABLE_COLUMNS} | dict(self.extra)

    def __repr__(self) -> str:
        doublets = sum(len(group.rows) == 2 for group in self.groups())
        title = f"FrequencyTable({len(self)} modes" + (", SYNTHETIC" if self.synthetic else "")
        if doublets:
            title += f", {doublets} doublet" + ("s" if doublets > 1 else "")
        return "\n".join([title + ")", *table_lines(TABLE_COLUMNS, records_of(TABLE_COLUMNS, self))])


def _says_synthetic(line: str) -> bool:
    return re.search(r"\bSYNTHETIC\b", line) is not None


def _quoted(cell: str) -> str:
    return '"' + cell.replace('"', '""') + '"' if set(cell) & set(',"') or cell.startswith("#") else cell


def _column(csv: StrictCsv, name: str, sigma: float | None, columns: Mapping[str, Array]) -> Array:
    """The numbers of one column, or the default if the column is absent."""
    blank = _BLANK.get(name)
    if name == "sigma_hz" and sigma is not None:
        stated = csv.numbers(name, blank=np.nan) if name in csv.header else np.full(len(csv.lines), np.nan)
        relative = sigma * columns["freq_hz"] if "freq_hz" in columns else stated
        return np.where(np.isnan(stated), relative, stated)
    if name not in csv.header:
        return np.full(len(csv.lines), blank)
    if name in ("mode", "n"):
        return csv.integers(name, blank=None if blank is None else -1)
    return csv.numbers(name, blank=blank)


def _looks_like_percent(zeta: FloatArray) -> bool:
    known = zeta[~np.isnan(zeta)]
    return known.size > 0 and float(np.median(known)) > PERCENT


def _extra_columns(csv: StrictCsv, sigma: float | None) -> list[str]:
    """Columns without a meaning here; likely misspellings are refused first, since they explain missing columns."""
    extra = [name for name in csv.header if name not in COLUMNS + COMPUTED]
    for name in extra:
        stem = re.split(r"[_\[( ]", name.lower())[0]
        absent = [c for c in COLUMNS if c not in csv.header and c != "n"]
        near = [c for c in absent if stem and (c.startswith(stem[:4]) or stem.startswith(c.split("_")[0]))]
        if near:
            expected = f"{near[0]}, unit and all"
            raise csv.refuse_header(column=name, found="an unknown column", expected=expected)
    for name, meaning in _REQUIRED.items():
        if name not in csv.header and not (name == "sigma_hz" and sigma is not None):
            raise csv.refuse_header(column=name, found="no such column", expected=meaning)
    if extra:
        names = ", ".join(csv.written.get(name, name) for name in extra)
        warn("table-columns", f"{csv.path}: found columns that are stored but not used: {names}", stacklevel=4)
    return extra


def _misfits(csv: StrictCsv, columns: Mapping[str, Array]) -> list[InputError]:
    """List values out of range in the columns that could be read; only in memory does -1 mean an empty n."""
    written = [(row, "n") for row, text in enumerate(csv.cells.get("n", ())) if text.startswith("-")]
    wrong = list[InputError]()
    for row, name in sorted(_faults(columns) + written):
        found = csv.cells[name][row] if name in csv.cells else f"{columns[name][row]:.6g} by default"
        if name == "mode" and csv.cells[name].index(found) < row:
            found += " again"
        wrong.append(csv.refuse(row=row, column=name, found=found, expected=_EXPECTED[name]))
    if not wrong and "zeta" in columns and "zeta" not in csv.factors and _looks_like_percent(columns["zeta"]):
        found = f"a median damping ratio of {np.nanmedian(columns['zeta']):.3g}, as in per cent"
        expected = "a ratio; name the column zeta [%] if it is per cent, zeta [-] if it is a ratio"
        wrong.append(csv.refuse_header(column="zeta", found=found, expected=expected))
    return wrong


def _faults(columns: Mapping[str, Array]) -> list[tuple[int, str]]:
    """List (row, column) of the values out of range, by row; columns may be missing."""
    below = columns.get("freq_hz", np.inf)
    rules: dict[str, Callable[[Array], Array]] = {
        "mode": lambda mode: (mode >= 1) & _first(mode),
        "n": lambda n: n >= -1,
        "freq_hz": lambda freq: (freq > 0) & (freq < np.inf),
        "sigma_hz": lambda sigma: (sigma > 0) & (sigma < below),
        "angle_deg": lambda angle: np.isnan(angle) | ((angle >= 0) & (angle < 360)),
        "zeta": lambda zeta: np.isnan(zeta) | ((zeta >= 0) & (zeta < 1)),
    }
    return sorted((int(row), name) for name in columns for row in np.flatnonzero(~rules[name](columns[name])))


def _first(mode: Array) -> Array:
    """Mark the first row of each mode number."""
    first = np.zeros(mode.size, bool)
    first[np.unique(mode, return_index=True)[1]] = True
    return first
