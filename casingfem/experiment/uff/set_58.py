"""Functions of universal files, set 58 (text) and 58b (binary): frequency responses, spectra, time records.

The number of points must be that of the header, on as many lines or bytes. Widely used readers return fewer points, or
none, from truncated or edited files without an error, so this one exists.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.uff.numbers import Columns, check_lines, integers, reals
from casingfem.experiment.uff.set_58_numbers import TEXTS, Layout, as_stored, from_bytes, from_text
from casingfem.experiment.uff.split import RawSet
from casingfem.io.arrays import Array, FloatArray, freeze

KIND_WORDS = (
    "general", "time response", "auto spectrum", "cross spectrum", "frequency response", "transmissibility",
    "coherence", "auto correlation", "cross correlation", "power spectral density", "energy spectral density",
    "probability density", "spectrum", "cumulative frequency distribution", "peaks valley", "stress/cycles",
    "strain/cycles", "orbit", "mode indicator", "force pattern", "partial power", "partial coherence", "eigenvalue",
    "eigenvector", "shock response spectrum", "finite impulse response", "multiple coherence", "order function",
)  # fmt: skip
REAL, REAL_DOUBLE, COMPLEX, COMPLEX_DOUBLE = 2, 4, 5, 6


class Channel(NamedTuple):
    """A measured channel: name, node, direction (1, 2, 3 = x, y, z; 4, 5, 6 rotations; 0 scalar; signed).

    >>> Channel(name="rim", node=7, direction=-3).direction  # against z
    -3
    """

    name: str
    node: int
    direction: int


class Axis(NamedTuple):
    """An axis: kind of data (17 time, 18 frequency, ...), exponents of length, force, temperature.

    >>> Axis(kind=18, label="Frequency", unit="Hz").exponents
    (0, 0, 0)
    """

    kind: int = 0
    exponents: tuple[int, int, int] = (0, 0, 0)
    label: str = "NONE"
    unit: str = "NONE"


class Axes(NamedTuple):
    """The four axes of a function: abscissa, ordinate, its denominator, and z.

    >>> Axes(abscissa=Axis(kind=18, unit="Hz"), ordinate=Axis(kind=8, unit="m")).denominator.unit
    'NONE'
    """

    abscissa: Axis
    ordinate: Axis
    denominator: Axis = Axis()
    z: Axis = Axis()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FunctionHead:
    """Header of a function, in the units that its axes name.

    Parameters
    ----------
    kind : its number in the format, 1 time response, 4 frequency response, 12 spectrum, ...
    text : the five lines of text above it
    numbers : identification, version and load case of the function
    response, reference : the response channel and the reference channel
    step : spacing of the abscissa, 0 if it is uneven
    z, axes : z value; data of the axes
    """

    kind: int
    text: tuple[str, ...]
    numbers: tuple[int, int, int] = (0, 0, 0)
    response: Channel
    reference: Channel
    step: float
    z: float = 0.0
    axes: Axes

    @property
    def word(self) -> str:
        """The kind of response as a word, such as `acceleration`."""
        return KIND_WORDS[self.kind]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Function(FunctionHead):
    """One measured function.

    Parameters
    ----------
    x, values : abscissa (points,), ascending, and ordinate (points,), real or complex
    double : whether the file stores 13 digits (8 bytes) or 6 (4 bytes)
    others : as in `FunctionHead`

    Examples
    --------
    >>> import numpy as np
    >>> at = Channel(name="rim", node=7, direction=3)
    >>> axes = Axes(abscissa=Axis(kind=18, unit="Hz"), ordinate=Axis(kind=8, unit="m"))
    >>> found = Function(kind=4, text=("SYNTHETIC",), response=at, reference=at, step=1.0, axes=axes, x=np.arange(3.0),
    ...                  values=np.ones(3), double=True)
    >>> found.values.size, found.response.node
    (3, 7)
    """

    x: FloatArray
    values: Array
    double: bool

    def __post_init__(self) -> None:
        freeze(self, "x", "values")

    def __repr__(self) -> str:
        low, high = self.x[[0, -1]].tolist()
        places = "/".join(f"{at.node}:{at.direction:+d}" for at in (self.response, self.reference))
        return f"Function({self.word}, {places}, {len(self.x)} points, {low:g} to {high:g} {self.axes.abscissa.unit})"


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionHeader(FunctionHead):
    """Header of a function, whose numbers may be incomplete.

    Parameters
    ----------
    points : their number according to the header
    start : first value of an even abscissa, according to the header
    binary : whether the numbers are bytes (58b)
    line : line of the file where the set begins
    fault : reason why the numbers cannot be read, "" if they can
    others : as in `FunctionHead`

    Examples
    --------
    >>> at = Channel(name="rim", node=7, direction=3)
    >>> axes = Axes(abscissa=Axis(kind=18, unit="Hz"), ordinate=Axis(kind=8, unit="m"))
    >>> head = FunctionHeader(kind=4, text=("SYNTHETIC",), response=at, reference=at, step=1.0, axes=axes, points=800,
    ...                       start=0.0, binary=False, line=12, fault="found 30 numbers, expected 800")
    >>> head.points, head.fault
    (800, 'found 30 numbers, expected 800')
    """

    points: int
    start: float
    binary: bool
    line: int
    fault: str = ""

    def __repr__(self) -> str:
        there = "whole" if not self.fault else f"not whole: {self.fault}"
        return f"FunctionHeader({self.word}, {self.text[0].strip()!r}, {self.points} points, {there})"


def read_function(raw: RawSet) -> Function:
    """Read a complete data set 58 or 58b.

    Raises
    ------
    InputError
        The data set deviates from its format or its own header.
    """
    head, stated, start = _head(raw)
    layout = as_stored(raw, stated)
    x, values = (from_text if raw.binary is None else from_bytes)(raw, layout)
    if layout.even:
        x = start + head["step"] * np.arange(layout.points, dtype=np.float64)
    elif np.any(np.diff(x) <= 0.0):
        point = int(np.argmax(np.diff(x) <= 0.0)) + 1
        found = f"{x[point]:g} after {x[point - 1]:g} at point {point + 1}"
        raise raw.error(TEXTS + 6, found, "an abscissa that ascends")
    return Function(**head, x=x, values=values, double=layout.double)


def read_function_header(raw: RawSet) -> FunctionHeader:
    """Read the header of data set 58 or 58b, and report whether its numbers are complete.

    Raises
    ------
    InputError
        The header itself deviates from the format.
    """
    head, layout, start = _head(raw)
    try:
        read_function(raw)
        fault = ""
    except InputError as error:
        fault = str(error)
    return FunctionHeader(
        **head, points=layout.points, start=start, binary=raw.binary is not None, line=raw.first - 1, fault=fault
    )


def _head(raw: RawSet) -> tuple[dict[str, Any], Layout, float]:
    """Fields of a `FunctionHead`, the layout of the numbers, and the start of an even abscissa."""
    check_lines(raw, 0, TEXTS + 6, "header")
    kind, numbers, response, reference = _identity(raw)
    layout, start, step, z = _record7(raw)
    axes = Axes(*(_axis(raw, TEXTS + 2 + k) for k in range(4)))
    text = tuple(line.rstrip() for line in raw.lines[:TEXTS])
    head = {"kind": kind, "text": text, "numbers": numbers, "response": response, "reference": reference,
            "step": step if layout.even else 0.0, "z": z, "axes": axes}  # fmt: skip
    return head, layout, start


def _identity(raw: RawSet) -> tuple[int, tuple[int, int, int], Channel, Channel]:
    """Record 6: 2(I5, I10), 2(1X, 10A1, I10, I4)."""
    row, line = TEXTS, raw.lines[TEXTS].ljust(80)

    def whole(start: int, width: int, *, last: bool = False) -> int:
        return int(integers(raw, [row], Columns(start, width, 1), last=last)[0, 0])

    _check_blank(raw, row, (30, 55))
    kind = whole(0, 5)
    if not 0 <= kind < len(KIND_WORDS):
        raise raw.error(row, f"function type {kind}", f"0 to {len(KIND_WORDS) - 1}")
    channels = []
    for start, last in ((31, False), (56, True)):
        node, direction = whole(start + 10, 10), whole(start + 20, 4, last=last)
        if not -6 <= direction <= 6:
            raise raw.error(row, f"direction {direction}", "-6 to 6")
        channels.append(Channel(line[start : start + 10].strip(), node, direction))
    return kind, (whole(5, 10), whole(15, 5), whole(20, 10)), channels[0], channels[1]


def _check_blank(raw: RawSet, row: int, columns: tuple[int, ...]) -> None:
    """Refuse text in columns that must be blank."""
    for column in columns:
        if raw.lines[row][column : column + 1].strip():
            found = f"{raw.lines[row][column]!r} in column {column + 1}"
            raise raw.error(row, found, "a blank between names and numbers")


def _record7(raw: RawSet) -> tuple[Layout, float, float, float]:
    """Record 7: data type, points, spacing (3I10); abscissa's start and step, z (3E13.5)."""
    row = TEXTS + 1
    form, points, spacing = integers(raw, [row], Columns(0, 10, 3), last=False)[0].tolist()
    start, step, z = reals(raw, [row], Columns(30, 13, 3))[0].tolist()
    if form not in (REAL, REAL_DOUBLE, COMPLEX, COMPLEX_DOUBLE):
        raise raw.error(row, f"data type {form}", "2, 4 (real), 5 or 6 (complex)")
    if points < 1:
        raise raw.error(row, f"{points} points", "1 or more")
    if spacing not in (0, 1):
        raise raw.error(row, f"spacing {spacing}", "0 (uneven) or 1 (even)")
    if spacing == 1 and points > 1 and not step > 0.0:
        raise raw.error(row, f"the step {step:g} of an even abscissa", "a step above 0")
    layout = Layout(form in (COMPLEX, COMPLEX_DOUBLE), form in (REAL_DOUBLE, COMPLEX_DOUBLE), spacing == 1, points)
    return layout, start, step, z


def _axis(raw: RawSet, row: int) -> Axis:
    """Records 8 to 11: I10, 3I5, 2(1X, 20A1)."""
    line = raw.lines[row]
    _check_blank(raw, row, (25, 46))
    kind = int(integers(raw, [row], Columns(0, 10, 1), last=False)[0, 0])
    length, force, temperature = integers(raw, [row], Columns(10, 5, 3), last=False)[0].tolist()
    return Axis(kind, (length, force, temperature), line[26:46].strip(), line[47:].strip())
