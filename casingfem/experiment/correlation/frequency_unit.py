"""Unit of a frequency table: all rows differ from the computed modes by one factor, for example 2 pi.

The lowest row with n nodal diameters is compared with the lowest computed mode with n; without labels, the k-th row is
compared with the k-th mode. The ratios measured/computed are nearly equal if a unit is wrong.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple, NoReturn

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.matches import Pairing
from casingfem.experiment.correlation.pairing import ModeSet, pair
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray

UNITS = {"rad/s": 2.0 * math.pi, "kHz": 1e-3, "1/min": 60.0}
ALIKE = 0.2  # relative: models before an update are not better than that
MOST = 0.8  # of the ratios must agree: single rows may be wrong
FEWEST = 3  # ratios that show a factor which is no unit; two suffice for a unit
CLEAR = 3.0  # how much less the rows scatter about the modes if the table is divided by the factor
SCATTER = 0.005  # relative: rows that scatter less about the modes may belong to them


class Scale(NamedTuple):
    """Median ratio measured/computed of a table, the number of ratios, and words for a unit that explains it."""

    ratio: float
    ratios: int
    unit: str
    remedy: str


def scale_of(table: FrequencyTable, freq: FloatArray, n: IntArray | None) -> Scale | None:
    """Factor between a table and the lowest computed modes; None if the rows do not agree on one.

    Parameters
    ----------
    freq, n
        Computed frequencies in Hz, ascending, and nodal diameters (modes,); None for modes without labels.

    >>> table = FrequencyTable.from_arrays(freq_hz=[620.0, 1270.0, 1890.0], sigma_hz=1.0)
    >>> scale_of(table, np.array([100.0, 200.0, 300.0]), None).unit
    'rad/s'
    """
    if freq[0] <= 0.0:
        return None  # of a part that floats
    order = np.sort(table.freq_hz)
    ratios = order[: len(freq)] / freq[: len(order)]
    if n is not None and np.all(table.n >= 0):
        labels = np.intersect1d(table.n, n)
        ratios = np.array([table.freq_hz[table.n == label].min() / freq[n == label].min() for label in labels])
    if len(ratios) < 2:
        return None
    ratio = float(np.median(ratios))
    if np.mean(np.abs(np.log(ratios / ratio)) < ALIKE) < MOST:
        return None
    for unit, factor in UNITS.items():
        if abs(math.log(ratio / factor)) < ALIKE:
            return Scale(ratio, len(ratios), unit, f"write the unit in the heading of the column, freq [{unit}]")
        if abs(math.log(ratio * factor)) < ALIKE:
            name = f"numbers in Hz that were converted from {unit}"
            return Scale(ratio, len(ratios), name, "correct the conversion, or the unit in the heading of the column")
    return Scale(ratio, len(ratios), "", "") if len(ratios) >= FEWEST else None


def refuse_unpaired(table: FrequencyTable, freq: FloatArray, n: IntArray | None, reach: float) -> NoReturn:
    """Raise an error that no row pairs with a computed mode, with the factor between them if there is one.

    Raises
    ------
    InputError
        Naming the unit, the factor, or the frequencies of both sides.
    """
    if scale := scale_of(table, freq, n):
        refuse_scale(table, scale, freq, reach)
    raise InputError(
        f"no row of {table.path} pairs with a computed mode within {reach:.0%}: "
        f"measured {table.freq_hz.min():.1f} to {table.freq_hz.max():.1f} Hz, "
        f"computed {freq[0]:.1f} to {freq[-1]:.1f} Hz"
    )


def require_hz(table: FrequencyTable, freq: FloatArray, n: IntArray | None, reach: float, *, any_factor: bool) -> None:
    """Refuse a table in another unit, from its ratios to the lowest computed modes alone.

    Parameters
    ----------
    any_factor
        Also refuse a factor beyond the reach that is no unit.

    Raises
    ------
    InputError
        Naming the unit or the factor.
    """
    scale = scale_of(table, freq, n)
    if scale is not None and (scale.unit or (any_factor and abs(math.log(scale.ratio)) > math.log1p(reach))):
        refuse_scale(table, scale, freq, reach)


def require_scale(table: FrequencyTable, modes: ModeSet, pairing: Pairing, reach: float) -> None:
    """Refuse a table whose rows are all outside the reach of their modes by one factor.

    The rows may belong to higher modes, with which they are paired. The table is refused only if the rows scatter
    clearly less about the computed modes after a division by the factor.

    Parameters
    ----------
    modes
        All computed modes up to the table's highest row.
    pairing
        The pairing of the table with these modes.
    reach
        Largest relative frequency error of a match.

    Raises
    ------
    InputError
        Naming the unit or the factor.
    """
    scale = scale_of(table, modes.freq, getattr(modes, "nodal_diameters", None))
    if scale is None or abs(math.log(scale.ratio)) <= math.log1p(reach):
        return
    divided = replace(table, freq_hz=table.freq_hz / scale.ratio, sigma_hz=table.sigma_hz / scale.ratio)
    least = scatter(pair(modes, divided, reach=reach), len(table), reach)
    if scatter(pairing, len(table), reach) > max(CLEAR * least, SCATTER):
        refuse_scale(table, scale, modes.freq, reach)


def scatter(pairing: Pairing, rows: int, reach: float) -> float:
    """Mean |log(measured/computed)| about the median, of the share MOST of the rows that scatter least.

    A row without a mode counts as one at its reach.
    """
    logs = np.array([math.log(measured / computed) for _, _, _, measured, computed, _ in pairing.pairs()])
    around = np.full(rows, math.log1p(reach))
    if len(logs):
        around[: len(logs)] = np.abs(logs - np.median(logs))
    return float(np.sort(around)[: math.ceil(MOST * rows)].mean())


def refuse_scale(table: FrequencyTable, scale: Scale, freq: FloatArray, reach: float) -> NoReturn:
    """Raise an error that a table differs from the model by a factor.

    Raises
    ------
    InputError
        Naming the unit or the factor.
    """
    found = (
        f"{table.freq_hz.min():.6g} to {table.freq_hz.max():.6g}, where the lowest computed mode has {freq[0]:.6g} Hz: "
        f"typically {scale.ratio:.4g} times what is computed (median of {scale.ratios} ratios)"
    )
    if scale.unit:
        raise InputError(table.path, column="freq_hz", found=f"{found}, as of {scale.unit}",
                         expected=f"Hz; {scale.remedy}")  # fmt: skip
    raise InputError(
        table.path, column="freq_hz", found=found,
        expected=f"frequencies in Hz, within {reach:.0%} of the computed ones; check the unit of the table, and E, rho "
        "and the dimensions of the model",
    )  # fmt: skip
