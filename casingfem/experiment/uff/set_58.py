"""Functions of universal files, set 58 (text) and 58b (binary): frequency responses, spectra, time records.

Every point counts: the numbers found must be as many as the header says, on as many lines or bytes. Widely used
readers return fewer points, or none, from files that were cut or edited, and that without an error; hence this one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.uff.numbers import Columns, check_end, check_lines, integers, reals, series
from casingfem.experiment.uff.split import RawSet
from casingfem.io.arrays import Array, FloatArray, freeze

KIND_WORDS = (
    "general", "time response", "auto spectrum", "cross spectrum", "frequency response", "transmissibility",
    "coherence", "auto correlation", "cross correlation", "power spectral density", "energy spectral density",
    "probability density", "spectrum", "cumulative frequency distribution", "peaks valley", "stress/cycles",
    "strain/cycles", "orbit", "mode indicator", "force pattern", "partial power", "partial coherence", "eigenvalue",
    "eigenvector", "shock response spectrum", "finite impulse response", "multiple coherence", "order function",
)  # fmt: skip
TEXTS = 5  # lines of text, then those of the function, of the numbers and of four axes
REAL, REAL_DOUBLE, COMPLEX, COMPLEX_DOUBLE = 2, 4, 5, 6
DECADES = 30  # what is measured spans fewer; bytes in the wrong order span more


class Channel(NamedTuple):
    """Where something was measured: name, node, direction (1, 2, 3 = x, y, z; 4, 5, 6 turns; 0 scalar; signed)."""

    name: str
    node: int
    direction: int


class Axis(NamedTuple):
    """What an axis shows: kind of data (17 time, 18 frequency, ...), exponents of length, force, temperature."""

    kind: int = 0
    exponents: tuple[int, int, int] = (0, 0, 0)
    label: str = "NONE"
    unit: str = "NONE"


class Axes(NamedTuple):
    """The four axes of a function: what it is over, what it is, what it is divided by, and z."""

    abscissa: Axis
    ordinate: Axis
    denominator: Axis = Axis()
    z: Axis = Axis()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Function:
    """One measured function, in the units that its axes name.

    Parameters
    ----------
    kind : its number in the format, 1 time response, 4 frequency response, 12 spectrum, ...
    text : the five lines of text above it
    numbers : function's identification, version, load case
    response, reference : where it was measured, and what it refers to
    x, values : abscissa (points,), ascending, and ordinate (points,), real or complex
    step : spacing of the abscissa, 0 where it is uneven
    double : whether the file keeps 13 digits (8 bytes) or 6 (4 bytes)
    z, axes : z value; what the axes show
    """

    kind: int
    text: tuple[str, ...]
    numbers: tuple[int, int, int] = (0, 0, 0)
    response: Channel
    reference: Channel
    x: FloatArray
    values: Array
    step: float
    double: bool
    z: float = 0.0
    axes: Axes

    def __post_init__(self) -> None:
        freeze(self, "x", "values")

    @property
    def word(self) -> str:
        """The kind in words."""
        return KIND_WORDS[self.kind]

    def __repr__(self) -> str:
        low, high = self.x[[0, -1]].tolist()
        places = (
            f"{self.response.node}:{self.response.direction:+d}/{self.reference.node}:{self.reference.direction:+d}"
        )
        return f"Function({self.word}, {places}, {len(self.x)} points, {low:g} to {high:g} {self.axes.abscissa.unit})"


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionHeader:
    """What stands above the numbers of a function, whether these are all there or not.

    Parameters
    ----------
    kind, text, numbers, response, reference, z, axes : as of a `Function`
    points : how many the header says
    start, step : of an even abscissa, as the header says
    binary : whether the numbers are bytes (58b)
    line : where the set begins in the file
    fault : why the numbers cannot be read, "" where they can
    """

    kind: int
    text: tuple[str, ...]
    numbers: tuple[int, int, int]
    response: Channel
    reference: Channel
    points: int
    start: float
    step: float
    z: float
    axes: Axes
    binary: bool
    line: int
    fault: str = ""

    @property
    def word(self) -> str:
        """The kind in words."""
        return KIND_WORDS[self.kind]

    def __repr__(self) -> str:
        there = "whole" if not self.fault else f"not whole: {self.fault}"
        return f"FunctionHeader({self.word}, {self.text[0].strip()!r}, {self.points} points, {there})"


class Layout(NamedTuple):
    """How a function's numbers stand: real or complex, single or double, with an abscissa or without, how many."""

    is_complex: bool
    double: bool
    even: bool
    points: int

    @property
    def ordinates(self) -> int:
        """Numbers of the ordinate at one point."""
        return 2 if self.is_complex else 1


def read_function(raw: RawSet) -> Function:
    """Read set 58 or 58b whole.

    Raises
    ------
    InputError
        Anything that is not exactly as the format and the function's own header say.
    """
    check_lines(raw, 0, TEXTS + 6, "header")
    kind, numbers, response, reference = _identity(raw)
    layout, start, step, z = _record7(raw)
    axes = Axes(*(_axis(raw, TEXTS + 2 + k) for k in range(4)))
    if raw.binary is not None:
        x, values = _from_bytes(raw, layout)
    else:
        x, values = _from_text(raw, layout)
    if layout.even:
        x = start + step * np.arange(layout.points, dtype=np.float64)
    elif np.any(np.diff(x) <= 0.0):
        point = int(np.argmax(np.diff(x) <= 0.0)) + 1
        found = f"{x[point]:g} after {x[point - 1]:g} at point {point + 1}"
        raise raw.error(TEXTS + 6, found, "an abscissa that ascends")
    return Function(
        kind=kind,
        text=tuple(line.rstrip() for line in raw.lines[:TEXTS]),
        numbers=numbers,
        response=response,
        reference=reference,
        x=x,
        values=values,
        step=step if layout.even else 0.0,
        double=layout.double,
        z=z,
        axes=axes,
    )


def read_function_header(raw: RawSet) -> FunctionHeader:
    """Read what stands above the numbers of set 58 or 58b, and say whether they are whole.

    Raises
    ------
    InputError
        Where the header itself is not as the format says.
    """
    check_lines(raw, 0, TEXTS + 6, "header")
    kind, numbers, response, reference = _identity(raw)
    layout, start, step, z = _record7(raw)
    try:
        read_function(raw)
        fault = ""
    except InputError as error:
        fault = str(error)
    return FunctionHeader(
        kind=kind,
        text=tuple(line.rstrip() for line in raw.lines[:TEXTS]),
        numbers=numbers,
        response=response,
        reference=reference,
        points=layout.points,
        start=start,
        step=step if layout.even else 0.0,
        z=z,
        axes=Axes(*(_axis(raw, TEXTS + 2 + k) for k in range(4))),
        binary=raw.binary is not None,
        line=raw.first - 1,
        fault=fault,
    )


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
    """Refuse text where names and numbers are kept apart."""
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


def _from_text(raw: RawSet, layout: Layout) -> tuple[FloatArray, Array]:
    """The numbers of set 58: 6E13.5, or 4E20.12; an uneven abscissa of doubles stands in E13.5 before them."""
    start, fields = TEXTS + 6, layout.ordinates + (not layout.even)
    if layout.double and not layout.even:
        return _mixed(raw, layout, start)
    columns = Columns(0, 20, 4) if layout.double else Columns(0, 13, 6)
    count = fields * layout.points
    check_end(raw, start - (-count // columns.fields), f"{layout.points} points")
    table = series(raw, start, count, columns, reals, f"{layout.points} points").reshape(layout.points, fields)
    return _parted(table, layout)


def _mixed(raw: RawSet, layout: Layout, start: int) -> tuple[FloatArray, Array]:
    """Doubles over an uneven abscissa: 2(E13.5, E20.12), or E13.5, 2E20.12."""
    width, each = 13 + 20 * layout.ordinates, 1 if layout.is_complex else 2
    lines = -(-layout.points // each)
    check_lines(raw, start, lines, f"{layout.points} points")
    check_end(raw, start + lines, f"{layout.points} points")
    table = np.empty((lines * each, 1 + layout.ordinates))
    for k in range(each):
        rows = range(start, start + (layout.points - k + each - 1) // each)
        table[k : layout.points : each, :1] = reals(raw, rows, Columns(k * width, 13, 1), last=False)
        ordinate = Columns(k * width + 13, 20, layout.ordinates)
        table[k : layout.points : each, 1:] = reals(raw, rows, ordinate, last=k == each - 1)
    if layout.points % each and len(raw.lines[start + lines - 1].rstrip()) > width:
        raise raw.error(start + lines - 1, "more than one point", f"the last of {layout.points} points")
    return _parted(table[: layout.points], layout)


def _from_bytes(raw: RawSet, layout: Layout) -> tuple[FloatArray, Array]:
    """The numbers of set 58b: the length of the data tells whether an abscissa beside doubles has 4 bytes or 8."""
    assert raw.binary is not None
    check_end(raw, TEXTS + 6, "header")
    order, size = raw.binary
    wide = f"{order}f{8 if layout.double else 4}"
    abscissas = [] if layout.even else [f"{order}f4", wide]
    ordinate = [("y", wide, (layout.ordinates,))]
    forms = [np.dtype([("x", each), *ordinate]) for each in abscissas] or [np.dtype(ordinate)]
    fitting = [form for form in forms if form.itemsize * layout.points == size]
    if not fitting:
        expected = " or ".join(dict.fromkeys(f"{form.itemsize * layout.points}" for form in forms))
        raise raw.error(-1, f"{size} bytes of data", f"{expected} for the {layout.points} points of the header")
    table = np.frombuffer(raw.payload, fitting[0])
    parts = [table["y"]] if layout.even else [table["x"][:, None], table["y"]]
    whole = np.concatenate([part.astype(np.float64) for part in parts], axis=1)
    spoilt = ~np.isfinite(whole)
    if layout.is_complex:  # a response without a number: an analyser's 0/0, where nothing pushed
        spoilt[:, -layout.ordinates :] = np.isinf(whole[:, -layout.ordinates :])
    if spoilt.any():
        point = int(np.argwhere(spoilt)[0, 0]) + 1
        raise raw.error(TEXTS + 6, f"nan or infinity at point {point}", "finite numbers")
    _check_order(raw, table["y"], fitting[0]["y"].base)
    return _parted(whole, layout)


def _check_order(raw: RawSet, values: Array, form: np.dtype[Any]) -> None:
    """Refuse numbers over many decades that shrink to a few in the other byte order."""
    decades, values = [], values[~np.isnan(values)]
    for each in (values, np.ascontiguousarray(values).view(form.newbyteorder())):
        with np.errstate(invalid="ignore"):  # bytes in the other order may be signalling nans
            sizes = np.abs(each[each != 0.0].astype(np.float64))
        decades.append(np.ptp(np.log10(sizes)) if sizes.size and np.isfinite(sizes).all() else np.inf)
    if decades[0] > DECADES and decades[1] < 0.5 * decades[0]:
        found = f"numbers over {decades[0]:.0f} decades, over {decades[1]:.0f} in the other byte order"
        raise raw.error(-1, found, "the byte order of the data")


def _parted(table: FloatArray, layout: Layout) -> tuple[FloatArray, Array]:
    """Abscissa (empty where it is even) and ordinate from a table of points."""
    x = np.empty(0) if layout.even else table[:, 0]
    y = table[:, -layout.ordinates :]
    return x, y[:, 0] + 1j * y[:, 1] if layout.is_complex else y[:, 0]
