"""Forces and responses that were sampled together: one hit of a hammer, or one run of a shaker."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import power_of_unit
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.io.arrays import FloatArray
from casingfem.io.together import together

LEAST = 16  # samples of a record
LARGEST = 1e30  # of a number in a record
LONGEST = 12  # letters of a unit: with the force's it must fit into 20 columns of a universal file
EVEN = 0.05  # of a step: what rounded times may be off their even places
UNCALIBRATED = "v"  # a force cell whose sensitivity is not known: shapes without a scale
FORCES = {"n": 1.0, "newton": 1.0, "kn": 1e3, "dan": 10.0, "mn": 1e-3, "lbf": 4.4482216152605, "kgf": 9.80665}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Take:
    """Time records of forces and responses over the same times.

    Parameters
    ----------
    response, force
        Sets of kind "time", (channels, samples); their units are those of the file.
    name
        Its name in messages.

    Raises
    ------
    InputError
        The sets are not time records, their times differ or are not evenly spaced, or there are too few samples.

    Examples
    --------
    >>> t = np.arange(64) / 256.0
    >>> force = FrfSet.from_arrays(kind="time", x=t, responses=[np.exp(-((t - 0.05) ** 2) / 1e-4)], unit="N")
    >>> response = FrfSet.from_arrays(kind="time", x=t, responses=[np.sin(90.0 * t)], unit="m/s^2")
    >>> Take(response=response, force=force)
    Take(1 force, 1 response, 0.25 s at 256 Hz)
    """

    response: FrfSet
    force: FrfSet
    name: str = "record"

    def __post_init__(self) -> None:
        for part in (self.response, self.force):
            if part.kind != "time":
                raise InputError(self.name, found=f"a set of kind {part.kind!r}", expected="time records")
        x = self.response.x
        if not np.array_equal(x, self.force.x):
            found = f"{len(x)} samples of the responses, {len(self.force.x)} of the forces, or other instants"
            raise InputError(self.name, found=found, expected="forces and responses at the same instants")
        if len(x) < LEAST:
            raise InputError(self.name, found=f"{len(x)} samples", expected=f"{LEAST} or more")
        if np.abs(x - np.linspace(x[0], x[-1], len(x))).max() > EVEN * (x[-1] - x[0]) / (len(x) - 1):
            steps = np.diff(x)
            found = f"steps from {steps.min():g} to {steps.max():g} s"
            expected = "even steps: export the record as sampled, with all digits of its times"
            raise InputError(self.name, found=found, expected=expected)

    @property
    def fs(self) -> float:
        """Samples per second [Hz]."""
        return float((len(self) - 1) / (self.response.x[-1] - self.response.x[0]))

    def __len__(self) -> int:
        return len(self.response.x)

    def __repr__(self) -> str:
        counts = (
            f"{len(part)} {word}{'s' * (len(part) > 1)}"
            for part, word in ((self.force, "force"), (self.response, "response"))
        )
        return f"Take({', '.join(counts)}, {len(self) / self.fs:.6g} s at {self.fs:.6g} Hz)"


class RecordChannel(NamedTuple):
    """A channel of a file: name, kind ("" if unknown), place and unit."""

    name: str
    kind: Literal["force", "response", ""] = ""
    point: int = 0
    direction: int = 0
    unit: str = ""


class RecordBlock(NamedTuple):
    """Channels (channels, samples) of a file that were sampled together at `fs` [Hz]."""

    name: str
    fs: float
    values: FloatArray
    channels: tuple[RecordChannel, ...]


def is_force(unit: str) -> bool:
    """Whether a unit is one of force.

    >>> is_force("N"), is_force("m/s^2"), is_force("lbf")
    (True, False, True)
    """
    return unit.strip().lower() in FORCES


def responses_of(block: RecordBlock) -> FrfSet:
    """The responses of a block, with or without forces."""
    force = np.array([_as_force(c) for c in block.channels], bool)
    if force.all():
        raise InputError(block.name, found="no response", expected="channels of responses")
    return _set(_finite(block), np.flatnonzero(~force).tolist())


def _as_force(channel: RecordChannel) -> bool:
    return channel.kind == "force" or (not channel.kind and is_force(channel.unit))


def _finite(block: RecordBlock) -> RecordBlock:
    """The block; numbers that are not finite or impossible in any unit are refused."""
    spoilt = [c.name for c, row in zip(block.channels, block.values, strict=True) if not np.isfinite(row).all()]
    if spoilt:
        found = f"nan or infinity in {', '.join(spoilt)}"
        raise InputError(block.name, found=found, expected="finite numbers: leave the channel out, or export it again")
    if block.values.size and float(np.abs(block.values).max()) > LARGEST:
        found = f"numbers up to {np.abs(block.values).max():.3g}"
        raise InputError(block.name, found=found, expected=f"numbers below {LARGEST:g}: check the units and factors")
    return block


def take_of(block: RecordBlock) -> Take:
    """The forces and the responses of a block.

    A channel of unknown kind is a force if its unit is one, else a response.

    Raises
    ------
    InputError
        There is no force or no response, numbers are not finite, responses have several units, or a unit belongs to
        another quantity.
    """
    force = np.array([_as_force(c) for c in block.channels], bool)
    named = ", ".join(
        c.name if c.unit and c.unit in c.name else f"{c.name} [{c.unit or 'no unit'}]" for c in block.channels
    )
    if not force.any() or force.all():
        what = "no channel of a force" if not force.any() else "no response"
        expected = "a force and a response: state them with --channels (channel,kind,point,direction,unit,factor)"
        raise InputError(block.name, found=f"{what} among {named}", expected=expected)
    _finite(block)
    _units(block, force.tolist())
    return Take(
        response=_set(block, np.flatnonzero(~force).tolist()),
        force=_set(block, np.flatnonzero(force).tolist()),
        name=block.name,
    )


def _units(block: RecordBlock, force: list[bool]) -> None:
    """Refuse force units that are not of force, and response units that are not of motion."""
    wrong = list[InputError]()
    for channel, is_one in zip(block.channels, force, strict=True):
        unit = channel.unit.strip()
        if is_one and unit and unit.lower() not in (*FORCES, UNCALIBRATED):
            expected = "N, kN, daN, mN, lbf, kgf, or V if the force cell is not calibrated"
        elif not is_one and not _motion(unit):
            expected = "a unit of a motion, such as m/s^2, g, mm/s, mm"
        else:
            continue
        advice = "correct it in the file or with --channels, where a factor converts the numbers"
        wrong.append(
            InputError(f"{block.name}, {channel.name}", found=f"the unit {unit!r}", expected=f"{expected}: {advice}")
        )
    if wrong:
        raise together(wrong)


def _motion(unit: str) -> bool:
    """Whether a unit is one of displacement, velocity or acceleration, or missing."""
    try:
        power_of_unit(unit)
    except ValueError:
        return False
    return True


def _set(block: RecordBlock, at: list[int]) -> FrfSet:
    """Some channels of a block, which must have one unit; forces in N."""
    chosen = [block.channels[k] for k in at]
    values, units = block.values[at], [c.unit.strip() for c in chosen]
    known = [FORCES.get(unit.lower()) for unit in units]
    if all(known):
        values, units = values * np.array(known, float)[:, None], ["N"] * len(units)
    long = next((unit for unit in units if len(unit) > LONGEST), None)
    if long is not None:
        expected = f"at most {LONGEST} letters, such as m/s^2: state it with --channels"
        raise InputError(block.name, found=f"the unit {long!r}", expected=expected)
    if len(set(units)) > 1:
        found = f"responses in {' and '.join(sorted(set(unit or 'no unit' for unit in units)))}"
        expected = "one unit: convert them with the column factor of --channels, or estimate each kind separately"
        raise InputError(block.name, found=found, expected=expected)
    places: dict[str, Any] = {
        "response_point": np.array([c.point for c in chosen], np.int64),
        "response_direction": np.array([c.direction for c in chosen], np.int64),
    }
    x = np.arange(values.shape[1]) / block.fs
    return FrfSet.from_arrays(kind="time", x=x, responses=values, unit=units[0], path=block.name, **places)


def with_card(take: Take, card: tuple[str, ...]) -> Take:
    """The record with these source lines in its sets."""
    return replace(take, response=replace(take.response, card=card), force=replace(take.force, card=card))
