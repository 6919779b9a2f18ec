"""Common steps of hammer and shaker tests: selected lines, consistent channels, notes on signs and units."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import power_of_unit
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.records.take import Take
from casingfem.io.arrays import BoolArray, FloatArray

BAND = 2.56  # samples a second over the highest line kept, as analysers have it
TURNED = -0.5  # mean of Re Y over that of |Re Y| at the drive point, below which a channel is turned over


def lines_of(samples: int, fs: float) -> FloatArray:
    """Lines [Hz] of a transform with this number of samples."""
    return np.asarray(np.fft.rfftfreq(samples, 1.0 / fs), np.float64)


def kept_lines(freq: FloatArray, fs: float, band: tuple[float, float] | None) -> BoolArray:
    """Lines above 0 Hz in the band, or up to fs/2.56."""
    low, high = band or (0.0, fs / BAND)
    kept = (freq > 0.0) & (freq >= low) & (freq <= high)
    if not 0.0 <= low < high or not kept.any():
        found = f"{low:g} to {high:g} Hz without a line" if low < high else f"{low:g} to {high:g} Hz"
        expected = f"from below to, with lines, which are {freq[1] - freq[0]:g} Hz apart up to {freq[-1]:g} Hz"
        raise InputError("band", found=found, expected=expected)
    return kept


def same_channels(takes: list[Take]) -> FrfSet:
    """The response channels, which must be the same in all records of one hit point."""
    first = takes[0].response
    for take in takes[1:]:
        same = np.array_equal(take.response.response_point, first.response_point)
        if not (same and np.array_equal(take.response.response_direction, first.response_direction)):
            found = f"responses at points {_listed(take.response)}, {takes[0].name} has {_listed(first)}"
            raise InputError(take.name, found=found, expected="the same channels for all hits at one point")
    return first


def _listed(frfs: FrfSet) -> str:
    return ", ".join(str(point) for point in frfs.response_point.tolist())


def _turned_over(frfs: FrfSet) -> Iterator[str]:
    """Drive points at which the structure would give energy to the hammer, so that a channel has the wrong sign."""
    try:
        power = power_of_unit(frfs.unit)
    except ValueError:
        power = None
    if power is None:
        return
    mobility = frfs.responses * (2j * np.pi * frfs.x) ** (1 - power)
    for k, row in enumerate(mobility.real):
        here, there = int(frfs.response_direction[k]), int(frfs.reference_direction[k])
        if frfs.response_point[k] != frfs.reference_point[k] or abs(here) != abs(there):
            continue
        sign = -1.0 if here * there < 0 else 1.0
        if float(sign * row.sum()) < TURNED * float(np.abs(row).sum()):
            yield (
                f"channel {k + 1}: the mobility at the drive point {frfs.response_point[k]} is negative: force or"
                " response has the wrong sign; check the signs of both channels"
            )


def notes_of(frfs: FrfSet, force_unit: str) -> Iterator[str]:
    """Notes on drive points with a wrong sign, and on responses or forces without a unit."""
    yield from _turned_over(frfs)
    if frfs.unit and not force_unit:
        yield "the force has no unit, so N is assumed: give the unit in the file, as `force 1 x [N]`, or by --channels"
    if not frfs.unit:
        yield "the responses have no unit: give it with --channels, or give their kind with --form of identify"
