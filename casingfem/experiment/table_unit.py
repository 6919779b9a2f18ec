"""Whether a table's frequencies stand in another unit than Hz: every row then is off by the same factor."""

import math
from typing import NoReturn

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray

UNITS = {"rad/s": 2.0 * math.pi, "kHz": 1e-3, "1/min": 60.0}
ALIKE = 0.2  # relative: models before an update are not better than that


def other_unit(table: FrequencyTable, freq: FloatArray, n: IntArray | None) -> str:
    """The unit in which the table agrees with the lowest computed modes; "" where that is none but maybe Hz.

    The lowest row of n nodal diameters stands beside the lowest such mode, the k-th row without n beside the k-th mode.

    Parameters
    ----------
    freq, n
        Computed frequencies in Hz, ascending, and nodal diameters (modes,); None where modes have no label.
    """
    if freq[0] <= 0.0:
        return ""  # of a part that floats
    order = np.sort(table.freq_hz)
    ratios = order[: len(freq)] / freq[: len(order)]
    if n is not None and np.all(table.n >= 0):
        labels = np.intersect1d(table.n, n)
        ratios = np.array([table.freq_hz[table.n == label].min() / freq[n == label].min() for label in labels])
    for unit, factor in UNITS.items():
        if len(ratios) > 1 and np.all(np.abs(np.log(ratios / factor)) < ALIKE):
            return unit
    return ""


def refuse_unpaired(table: FrequencyTable, freq: FloatArray, n: IntArray | None, reach: float) -> NoReturn:
    """Say that no row pairs with a computed mode, and why where the table stands in another unit.

    Raises
    ------
    InputError
        Naming the unit, or the frequencies of both sides.
    """
    require_hz(table, freq, n)
    raise InputError(
        f"no row of {table.path} pairs with a computed mode within {reach:.0%}: "
        f"measured {table.freq_hz.min():.1f} to {table.freq_hz.max():.1f} Hz, "
        f"computed {freq[0]:.1f} to {freq[-1]:.1f} Hz"
    )


def require_hz(table: FrequencyTable, freq: FloatArray, n: IntArray | None) -> None:
    """Refuse a table in another unit.

    Raises
    ------
    InputError
        Naming the unit, the first row and the mode beside it.
    """
    if unit := other_unit(table, freq, n):
        raise InputError(
            table.path, column="freq_hz",
            found=f"{table.freq_hz.min():.6g} to {table.freq_hz.max():.6g}, where the lowest computed mode has "
            f"{freq[0]:.6g} Hz: in every row about {UNITS[unit]:.4g} times what is computed, as of {unit}",
            expected="Hz",
        )  # fmt: skip
