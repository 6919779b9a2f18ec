"""Selection of usable responses: lines of the band, sensors with a signal, form, and weights of the lines."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import FORMS
from casingfem.experiment.frf.frf_set import PLACES, FrfSet
from casingfem.experiment.frf.sensor_grid import form_of
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

LEAST_LINES = 30
EVEN = 0.05  # of a step: largest deviation of a rounded line from its place
USUAL_FORM = "accelerance"  # assumed for a hammer test whose file has no unit
MISSING = 0.2  # of the lines: a channel that lacks more is left out
COHERENCE = 1e-3, 1.0 - 1e-6  # bounds of an estimate
LEAST_WEIGHT, ALIKE = 0.1, 21  # of an incoherent line; lines over which coherence is averaged


class Usable(NamedTuple):
    """Usable responses H (channels, lines) of `frfs` at `freq` [Hz], the power of j omega, and notes.

    `along` (lines,) is the weight of each line: 1, less where it is not coherent, 0 where a channel has no number; H is
    interpolated there.
    """

    frfs: FrfSet
    freq: FloatArray
    H: Array
    power: int
    along: FloatArray
    notes: tuple[str, ...]


def usable(frfs: FrfSet, band: tuple[float, float] | None, form: str | None, coherence: FrfSet | None) -> Usable:
    """Lines above 0 Hz in the band, without the sensors whose responses are zero or missing there.

    Raises
    ------
    InputError
        No frequency responses, uneven or too few lines, no channel with a signal, no phase, an unknown unit, a
        coherence over other lines.
    """
    if frfs.kind != "frf":
        raise InputError(frfs.path, found=f"kind {frfs.kind!r}", expected="frequency responses")
    low, high = band or (0.0, np.inf)
    if not 0.0 <= low < high:
        raise InputError(frfs.path, found=f"band {low:g} to {high:g} Hz", expected="0 <= from < to")
    kept = _ends_cut((frfs.x >= low) & (frfs.x <= high) & (frfs.x > 0.0), frfs.responses)
    freq = frfs.x[kept]
    if len(freq) < LEAST_LINES:
        raise InputError(frfs.path, found=f"{len(freq)} lines in the band", expected=f"at least {LEAST_LINES}")
    steps, even = np.diff(freq), np.linspace(freq[0], freq[-1], len(freq))
    if np.abs(freq - even).max() > EVEN * (even[1] - even[0]):
        raise InputError(frfs.path, found=f"steps from {steps.min():g} to {steps.max():g} Hz", expected="even steps")
    power, notes = form_of(frfs, form), list[str]()
    if power is None:
        power = FORMS[USUAL_FORM]
        notes.append(f"the responses have no unit: taken for {USUAL_FORM}. State `form` if they are not")
    H = frfs.responses[:, kept]
    silent, lacking = ~np.any(np.abs(H) > 0.0, axis=1), np.isnan(H).mean(axis=1) > MISSING
    whole, words = _without(frfs, silent & ~lacking, lacking)
    notes += words
    H, missing = whole.responses[:, kept], np.isnan(whole.responses[:, kept])
    if not np.any(np.abs(H.imag) > 0.0):
        found = "responses whose imaginary parts are all zero: magnitudes without phase?"
        raise InputError(frfs.path, found=found, expected="complex responses, real and imaginary part")
    along = np.ones(len(even)) if coherence is None else _coherent(whole, coherence, kept)
    if missing.any():
        notes.append(_missing(missing, even))
        H, along = _filled(H), np.where(missing.any(axis=0), 0.0, along)
    return Usable(whole, even, H, power, along, tuple(notes))


def _ends_cut(kept: BoolArray, H: Array) -> BoolArray:
    """Remove the lines at both ends on which no channel has a number."""
    some = np.flatnonzero(kept & ~np.isnan(H).all(axis=0))
    at = np.arange(len(kept))
    return np.asarray(kept & (at >= some.min(initial=len(kept))) & (at <= some.max(initial=-1)))


def _without(frfs: FrfSet, silent: BoolArray, lacking: BoolArray) -> tuple[FrfSet, list[str]]:
    """Remove sensors with a channel that is zero or lacks many numbers; return the set and notes that name them."""
    sensors = list(zip(frfs.response_point.tolist(), frfs.response_direction.tolist(), strict=True))
    notes, kept = list[str](), np.ones(len(frfs), bool)
    much = f"nan on more than {100.0 * MISSING:.0f} % of the lines"
    for off, what in ((silent, "zero on every line"), (lacking, much)):
        gone = {sensor for sensor, is_off in zip(sensors, off.tolist(), strict=True) if is_off}
        kept &= np.array([sensor not in gone for sensor in sensors])
        points = ", ".join(str(point) for point in sorted({point for point, _ in gone}))
        if gone:
            notes.append(f"{what}: {_channels(off)}; left out: point {points}")
    if not kept.any():
        raise InputError(frfs.path, found="; ".join(notes), expected="a signal")
    if kept.all():
        return frfs, notes
    return replace(frfs, **{name: getattr(frfs, name)[kept] for name in ("responses", *PLACES)}), notes


def _channels(which: BoolArray) -> str:
    return "channel " + ", ".join(str(k + 1) for k in np.flatnonzero(which))


def _missing(missing: BoolArray, freq: FloatArray) -> str:
    """Note on lines where channels have no number."""
    lines = np.flatnonzero(missing.any(axis=0))
    where = f"at {freq[lines[0]]:g} Hz" if len(lines) == 1 else f"from {freq[lines[0]]:g} to {freq[lines[-1]]:g} Hz"
    return f"nan in {_channels(np.asarray(missing.any(axis=1)))}: {len(lines)} of {len(freq)} lines left out, {where}"


def _filled(H: Array) -> Array:
    """Responses with missing values replaced by a straight line, for searches that do not weight lines."""
    at = np.arange(H.shape[1])
    return np.array([np.interp(at, at[there], row[there]) for row, there in zip(H, ~np.isnan(H), strict=True)])


def _coherent(frfs: FrfSet, coherence: FrfSet, kept: BoolArray) -> FloatArray:
    """Weight of each line from the noise |H|^2 (1 - g)/g, estimated from the coherence g.

    (Bendat and Piersol, Random Data, 4th ed., 2010, section 9.2.) Each channel's noise is divided by its median, so
    only its variation over the lines matters. Channels without coherence are ignored.
    """
    if not np.array_equal(coherence.x, frfs.x):
        found = f"coherence over {len(coherence.x)} lines from {coherence.x[0]:g} to {coherence.x[-1]:g} Hz"
        raise InputError(coherence.path, found=found, expected="the lines of the responses")
    mine, theirs = _same_places(frfs, coherence)
    if not len(mine):
        raise InputError(coherence.path, found="coherence of other channels", expected="those of the responses")
    given = np.nan_to_num(coherence.responses.real[theirs][:, kept])
    share = np.clip(median_filter(given, (1, ALIKE), mode="nearest"), *COHERENCE)
    variance = np.nan_to_num(np.abs(frfs.responses[mine][:, kept]) ** 2) * (1.0 - share) / share
    variance = median_filter(variance, (1, ALIKE), mode="nearest")
    usual = np.median(variance, axis=1, keepdims=True)
    noise = np.sqrt(np.median(variance / (usual + 1e-300), axis=0))
    return np.asarray(np.clip(1.0 / (noise + 1e-300), LEAST_WEIGHT, 1.0))


def _same_places(frfs: FrfSet, coherence: FrfSet) -> tuple[IntArray, IntArray]:
    """Channels that both sets have from the same sensor to the same reference.

    A sensor's only coherence applies to all.
    """
    mine, theirs = (np.column_stack([getattr(each, name) for name in PLACES]) for each in (frfs, coherence))
    sensor = (mine[:, None, :2] == theirs[None, :, :2]).all(axis=2)
    same = sensor & ((mine[:, None, 2:] == theirs[None, :, 2:]).all(axis=2) | (sensor.sum(axis=1, keepdims=True) == 1))
    found = same.any(axis=1)
    return np.flatnonzero(found), same.argmax(axis=1)[found]
