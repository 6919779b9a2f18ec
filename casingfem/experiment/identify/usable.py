"""What of a set of responses can be used: lines of the band, sensors with a signal, the form of the responses."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import PLACES, FrfSet
from casingfem.experiment.frf.sensor_grid import FORMS, form_of
from casingfem.io.arrays import Array, BoolArray, FloatArray

LEAST_LINES = 30
EVEN = 0.05  # of a step: what rounded lines may be off their even places
USUAL_FORM = "accelerance"  # of a hammer test whose file has no unit


class Usable(NamedTuple):
    """Responses H (channels, lines) of `frfs` at `freq` [Hz], the power of j omega, and what was done, in words."""

    frfs: FrfSet
    freq: FloatArray
    H: Array
    power: int
    notes: tuple[str, ...]


def usable(frfs: FrfSet, band: tuple[float, float] | None, form: str | None) -> Usable:
    """Lines above 0 Hz in the band, without the sensors whose responses are zero there.

    Raises
    ------
    InputError
        No frequency responses, uneven or too few lines, no channel with a signal, an unknown unit.
    """
    if frfs.kind != "frf":
        raise InputError(frfs.path, found=f"kind {frfs.kind!r}", expected="frequency responses")
    low, high = band or (0.0, np.inf)
    if not 0.0 <= low < high:
        raise InputError(frfs.path, found=f"band {low:g} to {high:g} Hz", expected="0 <= from < to")
    kept = (frfs.x >= low) & (frfs.x <= high) & (frfs.x > 0.0)
    freq = frfs.x[kept]
    if len(freq) < LEAST_LINES:
        raise InputError(frfs.path, found=f"{len(freq)} lines in the band", expected=f"at least {LEAST_LINES}")
    steps, even = np.diff(freq), np.linspace(freq[0], freq[-1], len(freq))
    if np.abs(freq - even).max() > EVEN * (even[1] - even[0]):
        raise InputError(frfs.path, found=f"steps from {steps.min():g} to {steps.max():g} Hz", expected="even steps")
    power, notes = form_of(frfs, form), list[str]()
    if power is None:
        power = FORMS[USUAL_FORM]
        notes.append(f"the responses have no unit: taken for {USUAL_FORM}; `form` says otherwise")
    dead = np.all(frfs.responses[:, kept] == 0.0, axis=1)
    if dead.any():
        frfs, words = _without(frfs, dead)
        notes.append(words)
    return Usable(frfs, even, frfs.responses[:, kept], power, tuple(notes))


def _without(frfs: FrfSet, dead: BoolArray) -> tuple[FrfSet, str]:
    """The set without sensors of which a channel is zero, and what is said of them."""
    sensors = list(zip(frfs.response_point.tolist(), frfs.response_direction.tolist(), strict=True))
    gone = {sensor for sensor, silent in zip(sensors, dead.tolist(), strict=True) if silent}
    kept = np.array([sensor not in gone for sensor in sensors])
    channels = ", ".join(str(k + 1) for k in np.flatnonzero(dead))
    points = ", ".join(str(point) for point in sorted({point for point, _ in gone}))
    what = f"zero on every line: channel {channels}; left out: point {points}"
    if not kept.any():
        raise InputError(frfs.path, found=what, expected="a signal")
    parts = {name: getattr(frfs, name)[kept] for name in ("responses", *PLACES)}
    return replace(frfs, **parts), what
