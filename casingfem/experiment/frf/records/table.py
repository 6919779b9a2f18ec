"""Time records of a csv table: a column of times, then one column for each channel.

Names are `time [s]`, `force 5 x [N]`, `response 12 -z [m/s^2]`: the word, the point, the direction, the unit.
"""

from __future__ import annotations

import os
import re
from typing import Literal

import numpy as np

from casingfem.experiment.frf.records.channels import direction_of
from casingfem.experiment.frf.records.take import EVEN, RecordBlock, RecordChannel
from casingfem.io.strict_csv import StrictCsv, read
from casingfem.io.together import together

TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "": 1.0}
FORCES, RESPONSES = ("force", "hammer", "shaker"), ("response", "acceleration", "velocity", "displacement", "acc")
NAME = re.compile(r"\s*(?P<name>[^\[(]*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?\s*")
CHANNEL = re.compile(
    r"(?P<word>.*?)[\s_]*(?P<point>[0-9]{1,9})?[\s_:]*(?P<direction>[+-]?(?:[xyz]|r[xyz]|(?<=[0-9\s_:+-])r))?"
)


def read_table(path: str | os.PathLike[str], *, by_names: bool) -> list[RecordBlock]:
    """The records of a table with a column of times.

    Parameters
    ----------
    path
        The table.
    by_names
        Whether the column names state points and directions. False if a table of channels states them.

    Raises
    ------
    InputError
        The first column is not time, times are not evenly spaced, cells are not numbers, or point or direction of a
        force or response cannot be read.
    """
    csv = read(path)
    first = NAME.fullmatch(csv.header[0])
    unit = (first["unit"] or "").strip().lower() if first else ""
    word = first["name"].lower() if first else ""
    if word.partition("_")[0] not in ("time", "t", "zeit") or len(csv.header) < 2:
        expected = "a column of times first, as in time [s],force 1 x [N],response 1 x [m/s^2]"
        raise csv.refuse_header(column=csv.header[0], found="another column", expected=expected)
    unit = unit or word.partition("_")[2]
    if unit not in TIMES:
        raise csv.refuse_header(column=csv.header[0], found=f"times in {unit!r}", expected="s or ms")
    time = csv.numbers(csv.header[0]) * TIMES[unit]
    fs = _rate(csv, time)
    values = np.array([csv.numbers(name) for name in csv.header[1:]])
    channels = tuple(channel_of(name) for name in csv.header[1:])
    unread = [name for name in csv.header[1:] if by_names and not _place_read(name)]
    if unread:
        expected = "word, point and direction (x, y, z or -x, -y, -z, or r), as `response 12 -z [m/s^2]`, or --channels"
        raise together(
            [csv.refuse_header(column=name, found="no point or direction", expected=expected) for name in unread]
        )
    return [RecordBlock(csv.path, fs, values, channels)]


def channel_of(name: str) -> RecordChannel:
    """Kind, point, direction and unit in the name of a column.

    >>> channel_of("force 5 -x [N]")
    RecordChannel(name='force 5 -x [N]', kind='force', point=5, direction=-1, unit='N')
    """
    word, point, direction, unit = _parts(name)
    kind: Literal["force", "response", ""] = ""
    if word.startswith(FORCES):
        kind = "force"
    elif word.startswith(RESPONSES):
        kind = "response"
    return RecordChannel(name, kind, int(point or 0), direction_of(direction) or 0, unit)


def _parts(name: str) -> tuple[str, str, str, str]:
    """Word, point, direction and unit of a name, each empty if missing."""
    whole = NAME.fullmatch(name)
    text, unit = (name, "") if whole is None else (whole["name"], (whole["unit"] or "").strip())
    parts = CHANNEL.fullmatch(text.lower())
    assert parts is not None
    return parts["word"].strip(" _"), parts["point"] or "", parts["direction"] or "", unit


def _place_read(name: str) -> bool:
    """Whether the digits of the name are only those of its point, and its direction is valid.

    >>> _place_read("force 5 -x [N]"), _place_read("force [N]"), _place_read("response 3 q"), _place_read("force 9 -r")
    (True, True, False, False)
    """
    word, point, direction, _ = _parts(name)
    return direction_of(direction) is not None and (bool(point) or not any(c.isdigit() for c in word))


def _rate(csv: StrictCsv, time: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    """Samples per second of evenly spaced times."""
    if len(time) < 2 or not time[-1] > time[0]:
        raise csv.refuse(found=f"{len(time)} rows", expected="times that ascend")
    step = float(time[-1] - time[0]) / (len(time) - 1)
    off = np.abs(time - np.linspace(time[0], time[-1], len(time)))
    if off.max() > 10.0 * EVEN * step:
        row = int(np.argmax(off > 10.0 * EVEN * step))
        raise csv.refuse(row=row, column=csv.header[0], found=f"{time[row]:g} s", expected=f"even steps of {step:g} s")
    return 1.0 / step
