"""Responses as they are identified: usable lines and channels over their noise, and their visible peaks.

1. `usable` takes lines of a band and sensors with a signal. Lines with little coherence have less weight.
2. `over_noise` divides each channel by its noise, and finds the peaks that a person sees and the end of the ringing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import FORMS
from casingfem.experiment.frf.frf_set import PLACES, FrfSet
from casingfem.experiment.frf.sensor_grid import form_of
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray, freeze

LEAST_LINES = 30
EVEN = 0.05  # of a step: largest deviation of a rounded line from its place
USUAL_FORM = "accelerance"  # assumed for a hammer test whose file has no unit
MISSING = 0.2  # of the lines: a channel that lacks more is left out
COHERENCE = 1e-3, 1.0 - 1e-6  # bounds of an estimate
LEAST_WEIGHT, ALIKE = 0.1, 21  # of an incoherent line; lines over which coherence is averaged
ROUGH = np.sqrt(20.0 * 2.0 * np.log(2.0))  # median of third differences of complex noise of unit deviation
STEADY = 201  # lines over which the noise is taken as constant


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


def line_noise(H: Array) -> FloatArray:
    """Standard deviation of the real (or imaginary) part of each channel's noise, (channels,).

    From third differences over the lines, var = 20 sigma^2; their median ignores the few lines on peaks.

    >>> rng = np.random.default_rng(5)
    >>> float(line_noise(0.3 * (rng.normal(size=(1, 4000)) + 1j * rng.normal(size=(1, 4000))))[0].round(1))
    0.3
    """
    return np.asarray(np.median(np.abs(np.diff(H, 3, axis=1)), axis=1) / ROUGH)


def noise_along(Y: Array) -> FloatArray:
    """Noise of each line, rms over the channels, of weighted responses Y (lines, channels), (lines,)."""
    rough = np.sqrt(np.mean(np.abs(np.diff(Y, 3, axis=0)) ** 2, axis=1) / 40.0)
    near = median_filter(rough, min(STEADY, len(rough)), mode="nearest")
    return np.asarray(np.pad(near, (1, 2), mode="edge"))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Peaks:
    """Visible peaks of the mode indicator: lines (peaks,) and half-power bandwidths in lines (peaks,)."""

    at: IntArray
    width: FloatArray

    def __post_init__(self) -> None:
        freeze(self, "at", "width")


class Responses(NamedTuple):
    """Responses Y (lines, channels) divided by their `noise` (channels,), at `freq` [Hz].

    `along` (lines,) has the weights of the lines. `peaks` are the visible peaks. `end` is the duration of the recorded
    ringing [s], `left` the share of the ringing that is left then. `leak` is the distance of lines [Hz] over which a
    Hann window leaks, else 0.
    """

    freq: FloatArray
    Y: Array
    noise: FloatArray
    along: FloatArray
    peaks: Peaks
    end: float = np.inf
    left: float = 0.0
    leak: float = 0.0

    @property
    def step(self) -> float:
        """Distance of lines [rad/s]."""
        return 2.0 * np.pi * float(self.freq[1] - self.freq[0])

    def some(self, channels: IntArray, rules: Thresholds = USUAL) -> Responses:
        """The responses of some channels, with the visible peaks of these channels."""
        Y = self.Y[:, channels]
        return self._replace(Y=Y, noise=self.noise[channels], peaks=visible_peaks(Y, rules))


def over_noise(used: Usable, rules: Thresholds = USUAL) -> Responses:
    """Usable responses over the noise of their channels, with their peaks and the end of their ringing."""
    freq, H = used.freq, used.H
    noise = np.maximum(line_noise(H), 1e-9 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1)))
    end, left = ringing(freq, H)
    faded = tapered(freq, H, end)
    quiet = noise if not np.isfinite(end) else np.maximum(line_noise(faded), 1e-9 * np.abs(H).max(axis=1))
    peaks = visible_peaks((faded / quiet[:, None]).T, rules)
    return Responses(freq, (H / noise[:, None]).T, noise, used.along, peaks, end, left)


def visible_peaks(Y: Array, rules: Thresholds = USUAL) -> Peaks:
    """Peaks of sum |Y|^2 over the channels that a person would see: above their surroundings and above the noise.

    Y (lines, channels) are responses over the noise of their channels.

    Examples
    --------
    >>> f = np.arange(100.0, 200.0, 0.05)
    >>> Y = sum(1e3 / (1j * (f - at) + 0.1) for at in (120.0, 121.0, 150.0))[:, None]
    >>> noise = np.random.default_rng(1).normal(size=(2, 2000, 1))
    >>> f[visible_peaks(Y + noise[0] + 1j * noise[1]).at].round(1).tolist()
    [120.0, 121.0, 150.0]
    """
    from scipy.signal import find_peaks, peak_widths  # loads scipy.interpolate, which most commands do not need

    power = np.sum(np.abs(Y) ** 2, axis=1) + 1e-300
    least = 2.0 * Y.shape[1] * np.maximum(noise_along(Y), 1e-9) ** 2
    level = 10.0 * np.log10(power)
    at, _ = find_peaks(level, prominence=rules.prominence_db, height=10.0 * np.log10(least) + rules.above_noise_db)
    return Peaks(at=at, width=peak_widths(power, at)[0] if len(at) else np.zeros(0))


def ringing(freq: FloatArray, H: Array) -> tuple[float, float]:
    """Duration of the recorded ringing after the hit [s], and the share of the ringing left at its end.

    A record of length T that starts d before the hit ends T - d after it. Where the ringing has not decayed, the
    impulse response of H (channels, lines) ends there with a step, and is empty in the last d seconds. (inf, 0) where
    there is no such step.

    Examples
    --------
    >>> f, D = np.arange(50.0, 150.0), 0.9
    >>> q = 3.0 + 2j * np.pi * (f - 100.3)
    >>> end, left = ringing(f, ((1.0 - np.exp(-q * D)) / q)[None])
    >>> round(end, 1), 0.04 < left < 0.1  # exp(-3 D) = 0.07, of the mean over the first lines
    (0.9, True)
    """
    lines = len(freq)
    step = float(freq[1] - freq[0])
    shape = np.hanning(lines + 2)[1:-1]
    impulse = np.fft.ifft(H * shape, axis=1)
    energy = np.sum(np.abs(impulse) ** 2 / np.sum(np.abs(impulse) ** 2, axis=1, keepdims=True), axis=0)
    near = max(3, lines // 60)
    total = np.cumsum(np.r_[0.0, energy, energy[: 2 * near]])
    before = (total[near:lines] - total[: lines - near]) / near  # energy[k - near : k], k = near ... lines - 1
    after = (total[2 * near : lines + near] - total[near:lines]) / near
    skirt = 4  # times at both ends that belong to the hit: the main lobe of the taper
    inside = np.arange(near, lines) < lines - skirt - near // 2
    inside &= np.arange(near, lines) > lines // 4
    drop = np.where(inside, before / (np.maximum(after, 1e-14 * energy.max()) + 1e-300), 0.0)
    k = int(np.argmax(drop))
    if drop[k] < 10.0:
        return float("inf"), 0.0
    start = float(np.mean(energy[2 : 2 + near]))
    left = float(np.sqrt(before[k] / max(start, 1e-300)))
    return (k + near) / (lines * step), min(left, 1.0)


def tapered(freq: FloatArray, H: Array, end: float) -> Array:
    """Responses whose ringing is faded out towards `end` [s], which removes the ripples of a cut-off record."""
    if not np.isfinite(end):
        return H
    lines = len(freq)
    t = np.arange(lines) / (lines * float(freq[1] - freq[0]))
    fade = np.where(t < end, np.cos(0.5 * np.pi * t / end) ** 2, 0.0)
    return np.asarray(np.fft.fft(np.fft.ifft(H, axis=1) * fade, axis=1))
