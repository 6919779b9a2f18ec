"""Strips: bands along a shell's first parameter with their own thickness or material."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.geometry.chart import require_positive
from casingfem.structure.material import Material
from contact.io.keys import Key

ON_LINE = 1e-9  # a mesh line this part of the shell's length away is the end of a strip


@dataclass(frozen=True, slots=True, kw_only=True)
class Strip:
    """A band of other thickness or material: a flange, a stiffener, one of several casings in a row.

    `start` and `end` [m] are values of the chart's first parameter: the axis of a casing, the span of a blade, the
    meridian's arc of a dome, each from 0. The strip is symmetric about the mid-surface, without offset. Thickness
    fields are relative and apply to a strip as to the wall.

    Raises
    ------
    ModelError
        `strip-extent`: start and end are not finite or not in order; `shell-thickness`: the thickness is not positive.

    Examples
    --------
    >>> flange = Strip(start=0.24, end=0.25, thickness=12e-3)
    >>> flange.covers(np.array([0.23, 0.245])).tolist()
    [False, True]
    """

    start: Annotated[float, Key("start along the axis or span [m]", "place", "reach", alias="from")]
    end: Annotated[float, Key("end along the axis or span [m]", "place", "reach", alias="to")]
    thickness: Annotated[float, Key("wall thickness of this part [m]", "length", "thickness")]
    material: Material | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.start) and np.isfinite(self.end) and self.start < self.end):
            raise ModelError("strip-extent", f"strip: found start {self.start!r}, end {self.end!r}")
        require_positive("strip", "shell-thickness", thickness=self.thickness)

    def covers(self, a: Array) -> Array:
        """Whether points a of the first parameter are in the strip, including its ends."""
        slack = ON_LINE * (self.end - self.start)
        inside = np.real(a)
        return np.asarray((inside >= self.start - slack) & (inside <= self.end + slack))


def spread(strips: Sequence[Strip], inside: Array, base: complex, values: Sequence[complex]) -> Array:
    """A number at points: `base`, or the strip's own value.

    >>> spread([Strip(start=1.0, end=2.0, thickness=2e-3)], np.array([0.5, 1.5]), 1e-3, [2e-3]).tolist()
    [0.001, 0.002]
    """
    numbers = np.full(np.shape(inside), base)
    for strip, value in zip(strips, values, strict=True):
        numbers = np.where(strip.covers(inside), value, numbers)
    return numbers


def check_strips(strips: Sequence[Strip], ends: tuple[float, float], lines: FloatArray | None) -> None:
    """Refuse strips outside the shell or overlapping, and ends that are on no mesh line.

    `ends` bounds the first parameter; `lines` are the element lines along it, None before there is a mesh.
    """
    low, high = np.real(ends)
    slack = ON_LINE * (high - low)
    order = sorted(range(len(strips)), key=lambda k: strips[k].start)
    for place, k in enumerate(order):
        strip, name = strips[k], f"strip[{k + 1}] from {strips[k].start:g} to {strips[k].end:g} m"
        if strip.start < low - slack or strip.end > high + slack:
            raise ModelError("strip-outside", f"{name} reaches beyond the shell, which has {low:g} to {high:g} m")
        if place and strip.start < strips[order[place - 1]].end - slack:
            raise ModelError("strip-overlap", f"{name} overlaps strip[{order[place - 1] + 1}]")
        for end in (strip.start, strip.end):
            if lines is not None and np.abs(np.real(lines) - end).min() > slack:
                raise ModelError("strip-off-line", f"{name}: no element line at {end:g} m")


def breaks_between(strips: Sequence[Strip], ends: tuple[float, float], lines: Sequence[float] = ()) -> list[float]:
    """The ends of the shell and of its strips, and lines of its chart, as parts of the length, from 0 to 1.

    >>> breaks_between([Strip(start=1.0, end=3.0, thickness=2e-3)], (0.0, 4.0))
    [0.0, 0.25, 0.75, 1.0]
    """
    low, high = np.real(ends)
    places = [*(end for strip in strips for end in (strip.start, strip.end)), *lines]
    parts = sorted((place - low) / (high - low) for place in places)
    inner: list[float] = []
    for part in parts:
        if ON_LINE < part < 1.0 - ON_LINE and (not inner or part - inner[-1] > ON_LINE):
            inner.append(float(part))
    return [0.0, *inner, 1.0]
