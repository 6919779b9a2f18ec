"""The numbers of functions in universal files: text of set 58 or bytes of set 58b, as many as the header states."""

from typing import Any, NamedTuple

import numpy as np

from casingfem.experiment.uff.numbers import Columns, check_end, check_lines, reals, series
from casingfem.experiment.uff.split import RawSet
from casingfem.io.arrays import Array, FloatArray

TEXTS = 5  # lines of text, then those of the function, of the numbers and of four axes
DECADES = 30  # what is measured spans fewer; bytes in the wrong order span more


class Layout(NamedTuple):
    """Layout of a function's numbers: real or complex, single or double, with or without abscissa, their count."""

    is_complex: bool
    double: bool
    even: bool
    points: int

    @property
    def ordinates(self) -> int:
        """Number of values of the ordinate at one point."""
        return 2 if self.is_complex else 1


def from_text(raw: RawSet, layout: Layout) -> tuple[FloatArray, Array]:
    """The numbers of set 58: 6E13.5, or 4E20.12; an uneven abscissa of doubles is in E13.5 before them."""
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


def as_stored(raw: RawSet, layout: Layout) -> Layout:
    """The layout with the precision that the length of binary data shows, since a header may state a wrong one."""
    if raw.binary is None:
        return layout
    other = layout._replace(double=not layout.double)
    fits = [
        any(form.itemsize * each.points == len(raw.payload) for form in _forms(each, raw.binary.order))
        for each in (layout, other)
    ]
    return other if fits == [False, True] else layout


def from_bytes(raw: RawSet, layout: Layout) -> tuple[FloatArray, Array]:
    """The numbers of set 58b; their length shows whether an abscissa with doubles has 4 bytes or 8."""
    assert raw.binary is not None
    check_end(raw, TEXTS + 6, "header")
    size, forms = len(raw.payload), _forms(layout, raw.binary.order)
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


def _forms(layout: Layout, order: str) -> list[np.dtype[Any]]:
    """Possible byte layouts of one point: an uneven abscissa with doubles has 4 bytes or 8."""
    wide = f"{order}f{8 if layout.double else 4}"
    ordinate = [("y", wide, (layout.ordinates,))]
    abscissas = [] if layout.even else dict.fromkeys((f"{order}f4", wide))
    return [np.dtype([("x", each), *ordinate]) for each in abscissas] or [np.dtype(ordinate)]


def _check_order(raw: RawSet, values: Array, form: np.dtype[Any]) -> None:
    """Refuse numbers that span many decades, but only a few in the other byte order."""
    decades, values = [], values[~np.isnan(values)]
    for each in (values, np.ascontiguousarray(values).view(form.newbyteorder())):
        with np.errstate(invalid="ignore"):  # bytes in the other order may be signalling nans
            sizes = np.abs(each[each != 0.0].astype(np.float64))
        decades.append(np.ptp(np.log10(sizes)) if sizes.size and np.isfinite(sizes).all() else np.inf)
    if decades[0] > DECADES and decades[1] < 0.5 * decades[0]:
        found = f"numbers over {decades[0]:.0f} decades, over {decades[1]:.0f} in the other byte order"
        raise raw.error(-1, found, "the byte order of the data")


def _parted(table: FloatArray, layout: Layout) -> tuple[FloatArray, Array]:
    """Abscissa (empty if it is even) and ordinate from a table of points."""
    x = np.empty(0) if layout.even else table[:, 0]
    y = table[:, -layout.ordinates :]
    return x, np.ascontiguousarray(y, np.float64).view(np.complex128)[:, 0] if layout.is_complex else y[:, 0]
