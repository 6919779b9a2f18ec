"""A table of channels: kind, place, unit and factor of each channel of a record."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.records.take import RecordBlock, RecordChannel
from casingfem.io.strict_csv import StrictCsv, read
from casingfem.io.together import together

DIRECTIONS = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
KINDS = ("force", "response")
COLUMNS = ("channel", "kind", "point", "direction", "unit", "factor")
NEEDED = ("channel", "kind", "point", "unit")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChannelTable:
    """Rows by the channel's name or number in the file; channels without a row are left out."""

    path: str
    rows: Mapping[str, RecordChannel]
    factors: Mapping[str, float]


def direction_of(word: str) -> int | None:
    """Direction number of universal files, None for other words; r is the direction of a radial sensor, without a sign.

    >>> direction_of("x"), direction_of("-z"), direction_of("2"), direction_of("r"), direction_of("-r")
    (1, -3, 2, 0, None)
    """
    text = word.strip().lower().removeprefix("+")
    sign = -1 if text.startswith("-") else 1
    text = text.removeprefix("-")
    if text == "r":
        return 0 if sign > 0 else None
    if text in DIRECTIONS:
        return sign * DIRECTIONS[text]
    if text in ("", *map(str, range(7))):
        return sign * int(text or 0)
    return None


def read_channels(path: str | os.PathLike[str]) -> ChannelTable:
    """Read a csv or workbook with the columns channel, kind, point, unit and, if wanted, direction and factor.

    `channel` is the name in the file, or a number from 1; `kind` is force or response; `factor` converts a number of
    the file to the unit.

    Raises
    ------
    InputError
        There are other columns, invalid kinds or directions, a repeated channel, or a factor of 0.
    """
    csv = read(path)
    for name in (*csv.header, *NEEDED):
        if name not in COLUMNS or name not in csv.header:
            found = "an unknown column" if name in csv.header else "no such column"
            raise csv.refuse_header(column=name, found=found, expected=",".join(COLUMNS))
    rows, factors, wrong = dict[str, RecordChannel](), dict[str, float](), list[InputError]()
    points, numbers = csv.integers("point"), np.ones(len(csv.lines))
    if "factor" in csv.header:
        numbers = csv.numbers("factor", blank=1.0)
    directions = csv.cells.get("direction", ("",) * len(csv.lines))
    for row, name in enumerate(csv.cells["channel"]):
        direction = direction_of(directions[row])
        wrong += _wrong(csv, row, name, direction, float(numbers[row]), rows)
        kind: Any = csv.cells["kind"][row].lower()
        rows[name] = RecordChannel(name, kind, int(points[row]), direction or 0, csv.cells["unit"][row])
        factors[name] = float(numbers[row])
    if wrong:
        raise together(wrong)
    return ChannelTable(path=csv.path, rows=rows, factors=factors)


def _wrong(
    csv: StrictCsv, row: int, name: str, direction: int | None, factor: float, above: Mapping[str, RecordChannel]
) -> list[InputError]:
    """The faults of a row."""
    found = list[InputError]()
    if name in above or not name:
        found.append(csv.refuse(row=row, column="channel", found=repr(name), expected="each channel once"))
    kind = csv.cells["kind"][row]
    if kind.lower() not in KINDS:
        found.append(csv.refuse(row=row, column="kind", found=repr(kind), expected=" or ".join(KINDS)))
    if direction is None:
        word, expected = csv.cells["direction"][row], "x, y, z with or without a sign, r (radial), or empty"
        found.append(csv.refuse(row=row, column="direction", found=repr(word), expected=expected))
    if factor == 0.0:
        found.append(csv.refuse(row=row, column="factor", found="0", expected="another number"))
    return found


def described(block: RecordBlock, table: ChannelTable | None) -> RecordBlock:
    """The block with the channels and units that the table states; unchanged without a table.

    Raises
    ------
    InputError
        The block does not have a channel of the table.
    """
    if table is None:
        return block
    names = [channel.name for channel in block.channels]
    at, missing = list[int](), list[str]()
    for name in table.rows:
        k = names.index(name) if name in names else int(name) - 1 if name.isdigit() else -1
        if 0 <= k < len(names):
            at.append(k)
        else:
            missing.append(name)
    if missing or len(set(at)) < len(at):
        found = f"channel {', '.join(missing)} of {table.path}" if missing else f"one channel twice in {table.path}"
        raise InputError(block.name, found=found, expected=f"one of {_named(names)}, each once")
    factors = np.array(list(table.factors.values()))[:, None]
    return block._replace(values=block.values[at] * factors, channels=tuple(table.rows.values()))


def _named(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + (f" ({len(names)} in all)" if len(names) > 8 else "")
