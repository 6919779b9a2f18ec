"""Assign measured shapes to rows of a frequency table: by frequency, and by n where both sides state it.

Shapes go to rows at the least sum of |log f_shape/f_row|, none farther apart than `reach`. If another choice costs less
than twice as much, the choice is uncertain and is refused; but the two rows of a doublet share one plane of shapes.
"""

from collections.abc import Sequence

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.frequency_unit import UNITS
from casingfem.experiment.correlation.measured_shapes import MeasuredShapes
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.assignment import assignment

REACH = 1e-3
SURE = 2.0  # times as far must any other choice be
EXACT = 1e-6  # relative distances of less than this are none: six digits of a universal file


def rows_of_shapes(measured: MeasuredShapes, table: FrequencyTable, *, reach: float = REACH) -> IntArray:
    """The row of each shape, (shapes,); -1 for shapes without a row nearby.

    Parameters
    ----------
    reach
        Largest relative distance of a shape's frequency from its row's.

    Raises
    ------
    InputError
        No shape is near a row; shapes that could belong to more than one row, or rows to more than one shape.

    Examples
    --------
    >>> table = FrequencyTable.from_arrays(freq_hz=[100.0, 100.5, 130.0], sigma_hz=0.01, n=[3, 3, 5])
    >>> shapes = MeasuredShapes.from_arrays(freq_hz=[100.01, 117.0, 130.0], values=np.eye(3), points=np.eye(3),
    ...                                     directions=np.eye(3), n=[3, 4, -1])
    >>> rows_of_shapes(shapes, table, reach=1e-3).tolist()
    [0, -1, 2]
    """
    apart = np.abs(np.log(measured.freq_hz[:, None] / table.freq_hz))
    both = (measured.n[:, None] >= 0) & (table.n >= 0)
    apart[(apart > reach) | (both & (measured.n[:, None] != table.n))] = np.inf
    prices = np.pad(np.minimum(apart, 2.0 * reach), ((0, 0), (0, len(apart))), constant_values=2.0 * reach)
    rows = np.full(len(apart), -1)
    for shape, row in zip(*assignment(prices), strict=True):
        if row < len(table) and np.isfinite(apart[shape, row]):
            rows[shape] = row
    if np.all(rows < 0):
        raise nothing_near(measured, table, reach)
    refuse_doubtful(apart, rows, measured, table)
    return rows


def nothing_near(measured: MeasuredShapes, table: FrequencyTable, reach: float) -> InputError:
    """Error for shapes that fit no row: they come from another test, or their frequencies are not in Hz."""
    for unit, factor in UNITS.items():
        if np.mean(np.abs(np.log(measured.freq_hz[:, None] / (factor * table.freq_hz))).min(axis=1) <= reach) > 0.5:
            found = f"frequencies that are {factor:.4g} times those in {table.path}: they are probably in {unit}"
            return measured.error(found, "frequencies of the shapes in Hz")
    gaps = np.abs(np.log(measured.freq_hz[:, None] / table.freq_hz))
    shape, row = np.unravel_index(int(gaps.argmin()), gaps.shape)
    near = f"{measured.freq_hz[shape]:.6g} Hz{labelled(int(measured.n[shape]))}"
    of = f"mode {table.mode[row]} of {table.path} at {table.freq_hz[row]:.6g} Hz{labelled(int(table.n[row]))}"
    expected = f"a shape and a row of the same n, at most {100.0 * reach:.2g} % apart in frequency"
    return measured.error(
        f"no shape that belongs to a row; the nearest ones are the shape at {near} and {of}", expected
    )


def labelled(n: int) -> str:
    """Text for a number n; empty if there is none."""
    return f" (n = {n})" if n >= 0 else ""


def refuse_doubtful(apart: FloatArray, rows: IntArray, measured: MeasuredShapes, table: FrequencyTable) -> None:
    """Refuse shapes for which another choice of row is nearly as good."""
    group = {row: k for k, rows_of in enumerate(g.rows for g in table.groups()) for row in rows_of}
    shape_at = {int(row): shape for shape, row in enumerate(rows) if row >= 0}
    for row, shape in shape_at.items():
        own = apart[shape, row]
        for other in np.flatnonzero(np.isfinite(apart[shape])).tolist():
            if other == row or group[other] == group[row]:
                continue
            swapped = shape_at.get(other)
            now = own + (0.0 if swapped is None else apart[swapped, other])
            then = apart[shape, other] + (0.0 if swapped is None else apart[swapped, row])
            if then < SURE * now + EXACT:
                first, last = sorted((row, other))
                modes = f"{table.mode[first]} and {table.mode[last]} of {table.path}"
                where = f"{table.freq_hz[first]:.6g} and {table.freq_hz[last]:.6g} Hz"
                found = f"the shape at {measured.freq_hz[shape]:.6g} Hz, which fits modes {modes}, at {where}"
                expected = "shapes that fit one row each: state their n, or use the table of the same test"
                raise measured.error(found, expected)
        for other in np.flatnonzero(np.isfinite(apart[:, row]) & (rows < 0)).tolist():
            if apart[other, row] < SURE * own + EXACT:
                both = " and ".join(f"{measured.freq_hz[k]:.6g}" for k in sorted((shape, other))) + " Hz"
                found = f"two shapes, {both}, that fit mode {table.mode[row]} of {table.path}"
                raise measured.error(found, "one shape for each row: state their n, or remove one")


def columns(values: FloatArray, rows: Sequence[int] | IntArray, count: int) -> FloatArray:
    """Values of shapes (last axis) in the columns of their rows: (..., count), nan elsewhere."""
    spread = np.full((*values.shape[:-1], count), np.nan)
    at = np.asarray(rows)
    spread[..., at[at >= 0]] = values[..., at >= 0]
    return spread
