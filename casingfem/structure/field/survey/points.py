"""The points of a survey: read from CSV, with checked units, and their coverage of the circle."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

import numpy as np

from casingfem.errors import InputError, warn
from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from casingfem.io.columns import SURVEY, named
from casingfem.io.strict_csv import StrictCsv, read
from casingfem.io.together import together

Quantity: TypeAlias = Literal["radius", "thickness"]

_THETA = {"theta_deg": np.pi / 180.0, "theta_rad": 1.0}
_X, _Y, _Z = ({f"{axis}_m": 1.0, f"{axis}_mm": 1e-3} for axis in "xyz")
_RADIUS = {"radius_m": 1.0, "radius_mm": 1e-3}
_THICKNESS = {"thickness_m": 1.0, "thickness_mm": 1e-3}
_PLAUSIBLE: dict[Quantity, tuple[float, float]] = {"radius": (5e-3, 50.0), "thickness": (1e-5, 0.5)}
_BEYOND = 1e3  # medians: beyond, a number was mistyped
_SAME_HEIGHT = 5e-4  # m: points this close in z were meant to be one ring
_MOST_RINGS = 20  # more heights than that are a scan, not rings
_RING_POINTS = 8


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurveyPoints:
    """Measured points of a surface and their values; arrays (points,) in rad and m.

    Raises
    ------
    InputError
        Values are not finite or positive, or arrays have different lengths.
    """

    theta: FloatArray
    z: FloatArray
    value: FloatArray
    quantity: Quantity = "radius"
    path: str = "survey"
    card: tuple[str, ...] = field(default=())
    lines: IntArray | None = None  # of each point in its file

    def __post_init__(self) -> None:
        arrays = {name: np.array(getattr(self, name), float) for name in ("theta", "z", "value")}
        if len({array.shape for array in arrays.values()}) != 1 or arrays["z"].ndim != 1 or not len(self):
            found = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise InputError(self.path, found=found, expected="arrays of one equal length of at least 1")
        for name, array in arrays.items():
            bad = ~np.isfinite(array) | ((array <= 0.0) if name == "value" else False)
            if np.any(bad):
                found, expected = f"{name} = {array[bad][0]}", f"finite numbers, {self.quantity} > 0"
                raise InputError(self.path, found=found, expected=expected)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return int(np.size(self.z))

    def at(self, kept: BoolArray) -> SurveyPoints:
        """Some of the points, by a mask (points,)."""
        lines = None if self.lines is None else self.lines[kept]
        return replace(self, theta=self.theta[kept], z=self.z[kept], value=self.value[kept], lines=lines)

    def rings(self) -> IntArray:
        """Number the heights from the lowest: points within half a millimetre share a ring; (points,)."""
        order = np.argsort(self.z, kind="stable")
        high, first = self.z[order], np.zeros(len(self), np.int64)
        at = 0
        while (at := int(np.searchsorted(high, high[at] + _SAME_HEIGHT, side="right"))) < len(self):
            first[at] = 1
        ring = np.empty(len(self), np.int64)
        ring[order] = np.cumsum(first)
        return ring

    def coverage(self) -> tuple[float, int]:
        """Largest gap in theta [deg] and number of heights.

        A survey made of rings has at most 20 heights, nearly all with 8 points or more. Its largest gap is that of the
        worst ring. The gap of a scattered survey is that of all points together.
        """
        ring = self.rings()
        counts = np.bincount(ring)
        full = np.flatnonzero(counts >= _RING_POINTS)
        if counts.size <= _MOST_RINGS and counts[full].sum() >= 0.9 * len(self):
            return max(largest_gap_deg(self.theta[ring == k]) for k in full), int(full.size)
        return largest_gap_deg(self.theta), int(counts.size)


def largest_gap_deg(theta: FloatArray) -> float:
    """Largest angle [deg] between neighbouring points around the circle.

    Examples
    --------
    >>> round(largest_gap_deg(np.radians([0.0, 90.0, 100.0, 360.0])), 9)
    260.0
    """
    around = np.sort(np.mod(theta, 2 * np.pi))
    return float(np.degrees(np.diff(np.append(around, around[0] + 2 * np.pi)).max()))


def read_points(path: str | os.PathLike[str]) -> SurveyPoints:
    """Read a survey CSV with units in the column names: theta, z and radius (or thickness), or x, y and z.

    Names may have any case, units in brackets, and common words (`casingfem.io.columns`). Without a
    column of radii these are sqrt(x^2 + y^2). Other columns are ignored.

    Warns
    -----
    ModelWarning
        `survey-columns`: the ignored columns.

    Raises
    ------
    InputError
        The table is malformed (see strict_csv), columns or their units are missing, or values are not positive or seem
        to have another unit.
    """
    table = named(read(path), SURVEY)
    wrong, parts = list[InputError](), dict[str, tuple[FloatArray, str]]()
    flat = bool(set(table.header) & (_X.keys() | _Y.keys()))
    choices = {"z": _Z} | ({"x": _X, "y": _Y} if flat else {"theta": _THETA})
    if not flat or set(table.header) & (_RADIUS.keys() | _THICKNESS.keys()):
        choices["value"] = _RADIUS | _THICKNESS
    for part, choice in choices.items():
        try:
            parts[part] = _numbers(table, choice)
        except InputError as error:
            wrong.append(error)
    if wrong:
        raise together(wrong)
    (z, z_name), taken = parts["z"], {name for _, name in parts.values()}
    if flat:
        x, y = parts["x"][0], parts["y"][0]
        theta = np.arctan2(y, x) % (2.0 * np.pi)
        value, value_name = parts.get("value", (np.hypot(x, y), parts["x"][1]))
    else:
        (theta, theta_name), (value, value_name) = parts["theta"], parts["value"]
        if theta_name == "theta_rad":
            _check_angle_unit(table, theta)
    quantity: Quantity = "thickness" if value_name in _THICKNESS else "radius"
    like = f"a value like the others, whose median is {np.median(value):g} m"
    for bad, expected in ((value <= 0.0, "a value > 0"), (value > _BEYOND * np.median(value), like)):
        for row in np.flatnonzero(bad).tolist():
            found = table.cells[value_name][row]
            wrong.append(table.refuse(row=row, column=value_name, found=found, expected=expected))
    if wrong:
        raise together(wrong)
    _check_length_unit(table, value_name, quantity, float(np.median(value)))
    _check_height_unit(table, z_name, z, float(np.median(value)), quantity)
    if rest := [table.written.get(name, name) for name in table.header if name not in taken | {value_name}]:
        warn("survey-columns", f"{table.path}: found columns that are not read: {', '.join(rest)}", stacklevel=4)
    return SurveyPoints(theta=theta, z=z, value=value, quantity=quantity, path=table.path, card=table.card,
                        lines=table.lines)  # fmt: skip


def _numbers(table: StrictCsv, choices: dict[str, float]) -> tuple[FloatArray, str]:
    """The numbers of the single column of a quantity, in rad or m, and its name, which states the unit."""
    found = [name for name in table.header if name in choices]
    wanted = " or ".join(choices)
    if len(found) == 1:
        return table.numbers(found[0]) * choices[found[0]], found[0]
    stems = {name.rsplit("_", 1)[0] for name in choices}
    near = [name for name in table.header if name.split("_")[0].split("[")[0].strip().lower() in stems]
    if found:
        what, column = f"both {' and '.join(found)}", None
    elif near:
        what, column = "a column without a known unit in its name", near[0]
    else:
        what, column = f"no such column among {','.join(table.header)}", None
    raise table.refuse_header(column=column, found=what, expected=f"one column {wanted}")


def _check_angle_unit(table: StrictCsv, theta: FloatArray) -> None:
    for row in np.flatnonzero(np.abs(theta) > 4 * np.pi)[:1]:
        expected = "at most 4 pi rad (two turns); give degrees in a column theta_deg"
        raise table.refuse(row=row, column="theta_rad", found=f"{theta[row]:g} rad", expected=expected)


def _check_length_unit(table: StrictCsv, name: str, quantity: Quantity, median: float) -> None:
    low, high = _PLAUSIBLE[quantity]
    if not low <= median <= high:
        other = name.removesuffix("_m") + "_mm" if name.endswith("_m") else name.removesuffix("_mm") + "_m"
        expected = f"{low:g} to {high:g} m; is the column {other}?"
        found = f"a median {quantity} of {median:.4g} m"
        raise table.refuse_header(column=name, found=found, expected=expected)


def _check_height_unit(table: StrictCsv, name: str, z: FloatArray, value: float, quantity: Quantity) -> None:
    span, scale = float(np.ptp(z)), value if quantity == "radius" else 0.5
    low, high = 1e-3 * scale, 50.0 * scale
    if span > high or (name == "z_mm" and 0.0 < span < low):
        expected = f"{low:.3g} to {high:.3g} m; is the column {'z_m' if name == 'z_mm' else 'z_mm'}?"
        found = f"heights over {span:.4g} m"
        raise table.refuse_header(column=name, found=found, expected=expected)
