"""Time records of universal files: functions of kind 1, combined into records that were sampled together."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Sequence
from typing import Literal

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import FORCE, UNKNOWN
from casingfem.experiment.frf.records.take import EVEN, RecordBlock, RecordChannel, is_force
from casingfem.experiment.uff.read import UniversalFile, read_uff
from casingfem.experiment.uff.set_58 import Function

GENERAL, TIME_RESPONSE = 0, 1
TIME = 17  # of an abscissa
Kind = Literal["force", "response", ""]


def read_universal(path: str | os.PathLike[str]) -> tuple[list[RecordBlock], UniversalFile]:
    """Blocks of functions that were sampled together, and the file that contains them.

    A function that repeats a channel begins another block. If blocks then lack a force or a response, the first block
    contains the first record of each channel, the second block the second.

    Raises
    ------
    InputError
        The file cannot be read completely, has no time records, or a block has unequal rates or lengths.
    """
    file = read_uff(path)
    functions = [each for each in file.functions if _is_time(each)]
    if not functions:
        there = ", ".join(sorted({function.word for function in file.functions})) or file.contents
        raise InputError(str(path), found=there, expected="time records (set 58, function type 1)")
    groups = _in_turn(functions)
    if not all(_complete(group) for group in groups):
        groups = _by_number(functions, str(path))
    many = len(groups) > 1
    return [_block(group, f"{path}, record {k + 1}" if many else str(path)) for k, group in enumerate(groups)], file


def _is_time(function: Function) -> bool:
    timed = function.axes.abscissa.kind in (0, TIME)
    return function.kind == TIME_RESPONSE or (
        function.kind == GENERAL and timed and not np.iscomplexobj(function.values)
    )


def kind_of(function: Function) -> Kind:
    """Force or response, from the code of the ordinate, else from its unit; "" if both leave it open."""
    code, unit = function.axes.ordinate.kind, _unit(function)
    if code == FORCE or (code in UNKNOWN and is_force(unit)):
        return "force"
    return "" if code in UNKNOWN and not unit else "response"


def _unit(function: Function) -> str:
    unit = function.axes.ordinate.unit
    return "" if unit.upper() == "NONE" else unit


def _place(function: Function) -> tuple[str, int, int]:
    return kind_of(function), function.response.node, function.response.direction


def _in_turn(functions: Sequence[Function]) -> list[list[Function]]:
    """Groups in the order of the file; a group ends where a channel repeats."""
    groups: list[list[Function]] = [[]]
    for function in functions:
        if any(_place(other) == _place(function) for other in groups[-1]):
            groups.append([])
        groups[-1].append(function)
    return groups


def _complete(group: Sequence[Function]) -> bool:
    forces = [kind_of(function) == "force" for function in group]
    return any(forces) and not all(forces)


def _by_number(functions: Sequence[Function], path: str) -> list[list[Function]]:
    """Groups of the first, second, ... record of every channel."""
    by_place = defaultdict[tuple[str, int, int], list[Function]](list)
    for function in functions:
        by_place[_place(function)].append(function)
    counts = {len(own) for own in by_place.values()}
    if len(counts) > 1:
        words = (f"{len(own)} of {place[0] or 'channel'} {place[1]}" for place, own in by_place.items())
        found = f"records: {', '.join(words)}"
        raise InputError(
            path, found=found, expected="equal numbers for all channels: each hit with its force and responses"
        )
    return [list(group) for group in zip(*by_place.values(), strict=True)]


def _block(group: Sequence[Function], name: str) -> RecordBlock:
    first = group[0]
    for k, function in enumerate(group):
        step, other = _step(function, name, k), _step(first, name, 0)
        if abs(step - other) > 1e-6 * other:
            found = f"function {k + 1} at {1.0 / step:.6g} samples a second, function 1 at {1.0 / other:.6g}"
            raise InputError(name, found=found, expected="one rate: export all channels with the same rate")
        if len(function.x) != len(first.x) or abs(function.x[0] - first.x[0]) > EVEN * step:
            found = f"{len(function.x)} samples from {function.x[0]:g} s in function {k + 1}"
            raise InputError(name, found=found, expected=f"{len(first.x)} from {first.x[0]:g} s, as function 1 has")
    channels = tuple(
        RecordChannel(f"function {k + 1}", kind_of(f), f.response.node, f.response.direction, _unit(f))
        for k, f in enumerate(group)
    )
    values = np.array([np.real(function.values) for function in group], np.float64)
    return RecordBlock(name, 1.0 / _step(first, name, 0), values, channels)


def _step(function: Function, name: str, k: int) -> float:
    """Sampling interval [s]."""
    x = function.x
    unit = function.axes.abscissa.unit.lower()
    scale = {"ms": 1e-3, "msec": 1e-3}.get(unit, 1.0)
    if unit not in ("", "none", "s", "sec", "ms", "msec") or len(x) < 2:
        raise InputError(name, found=f"function {k + 1} over {len(x)} points in {unit!r}", expected="times in s")
    step = float(x[-1] - x[0]) / (len(x) - 1)
    if np.abs(x - np.linspace(x[0], x[-1], len(x))).max() > EVEN * step:
        raise InputError(name, found=f"uneven times in function {k + 1}", expected="even steps: export as sampled")
    return step * scale
