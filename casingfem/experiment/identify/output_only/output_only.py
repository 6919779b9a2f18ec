"""Frequencies, damping and shapes of the modes in responses to loads that are not measured.

1. `correlations`: all sensors with some references, in blocks of the record.
2. Bands of a few peaks of the power spectra; `subspace`: poles that recur over the orders by frequency, damping, shape.
3. Step 2 is repeated without each block in turn: the jackknife gives the uncertainty of every number (Efron and Stein,
   Ann. Stat. 9, 1981, 586). It is no less than the true one on average, and larger for the shapes of close pairs.
4. Pairs, nodal diameters and orientations follow as for frequency responses; each mode is sure, or doubtful for a
   reason.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import find_peaks, peak_widths
from scipy.signal.windows import blackmanharris
from scipy.special import chdtri

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid, sensor_grid
from casingfem.experiment.identify.assembled import circle_notes, columns_of, labelled, oriented, sensor_notes
from casingfem.experiment.identify.clusters import Responses, bands
from casingfem.experiment.identify.exponential import ABOVE_ZERO
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.experiment.identify.mode import (
    Found,
    Mode,
    Residues,
    Sensors,
    mode_of,
    neighbours,
    one_of,
    paired,
    unresolved_notes,
)
from casingfem.experiment.identify.output_only.correlations import (
    BLOCKS,
    EDGE,
    Correlations,
    chosen_references,
    correlated,
    zoomed,
)
from casingfem.experiment.identify.output_only.subspace import Cluster, Swept, again, clusters, fits_in, swept
from casingfem.experiment.identify.spectra import Peaks
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray

LAG_PART = 4.0  # length of a block in longest lags
LEAST = 2000  # samples of a record
PRESENT = 0.8  # of the records without a block, in which a mode must be found again
KNOWN = 0.5  # of a bandwidth: largest standard deviation of a frequency without a visible peak
OFTEN = 0.5  # of the model orders, in which a sure mode recurs
ALIKE = float(chdtri(2, 1e-3))  # largest chi-squared by chance of two modes' differences, once in a thousand
NORMAL = 2.0  # least standard deviations of a split without a note, and of the power of a peak
LONGER = "a longer record may resolve it"
EMPTY = 6  # a band wider than so many times the lines around its peaks is divided
LOBES = 1e-8  # of the largest power: ten times the side lobes of the window
WIDEST = 4.0  # lines: half-power width of the window's main lobe, and more
MISSED, NAMED = 2.0, 8  # lines within which a peak is that of a mode; peaks that a note names
MADE = "identified from responses alone: stochastic subspaces of their correlations, jackknife over blocks"
MARGIN = 1.3  # widening of a band at each end, in edges of its filter


class Estimated(NamedTuple):
    """A mode, and the share of the model orders in which it recurs."""

    found: Found
    recurs: float


def identify_output_only(
    records: FrfSet,
    *,
    angles: Mapping[int, float] | None = None,
    places: Mapping[int, ArrayLike] | None = None,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    n_max: int | None = None,
    references: Sequence[int] | None = None,
    seconds: float | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> Identified:
    """Modes of responses to random loads that are not measured.

    Parameters
    ----------
    records
        Time records (kind "time") of all sensors, over the same instants.
    angles, places, band, n_max
        As of `identify`.
    order
        Largest order of the subspace models; None takes it from the number of peaks of each band.
    references
        Points whose sensors are references; None takes up to four that explain the others best.
    seconds
        Longest lag of the correlations [s]; None takes an eightieth of the record.

    Raises
    ------
    InputError
        No time records, a record that is too short, sensors twice, points without a sensor.

    Notes
    -----
    The loads must be random, many, and without peaks of their own in the band. Shapes have no scale.
    """
    started, rules = time.perf_counter(), USUAL
    y, fs, frfs = _usable(records)
    own = _references(frfs, y, references)
    lags = _lags(y, fs, seconds, records.path)
    scale = y.std(axis=1)
    say("correlations")
    found = correlated(y / scale[:, None], fs, lags, own)
    grid, channels = _grid(frfs, own, angles, places)
    freq, power = _spectra(found)
    low, high = band or (0.0, 0.5 * fs)
    kept = (freq >= max(low, freq[1])) & (freq <= high)
    if kept.sum() < 8 or not low < high:
        found_band = f"band {low:g} to {high:g} Hz"
        raise InputError(records.path, found=found_band, expected=f"from < to, up to {0.5 * fs:g} Hz")
    peaks = _peaks(freq[kept], power[kept], _scatter(found)[kept], rules)
    estimated, diagram = _bands(found, freq[kept], power[kept], peaks, order, say, rules)
    factors = np.outer(scale, scale[own])
    circle = None if angles is None else Circle.of(grid.theta, n_max)
    whole = [_scaled(each, factors[None]) for each in estimated]
    modes, sensors = labelled(lambda at: _modes(whole, channels, at, rules), Sensors.of(grid, 0, circle))
    doublets = paired(modes)
    modes = oriented(modes, doublets, sensors)
    lines, measured, fitted = _compared(found, whole, factors, channels, low, high)
    notes = (
        f"output only: {len(own)} reference{'s' * (len(own) > 1)}, lags up to {lags / fs:.3g} s, {BLOCKS} blocks;"
        " shapes have no scale",
        *circle_notes(modes, grid, circle), *sensor_notes(modes, grid, circle),
        *unresolved_notes(modes, LONGER), *_close(modes, doublets), *_lonely(modes, doublets),
        *_bare(modes, freq[kept][peaks.at], float(freq[1])),
    )  # fmt: skip
    return Identified(
        **columns_of(modes, doublets, grid), sensors=grid, lines=lines, measured=measured, fitted=fitted,
        doublets=doublets, unresolved=tuple(k for k, mode in enumerate(modes) if mode.unresolved),
        reasons=tuple(mode.reason for mode in modes), notes=notes, diagram=diagram,
        card=(*records.card, MADE), seconds=time.perf_counter() - started,
    )  # fmt: skip


def _usable(records: FrfSet) -> tuple[FloatArray, float, FrfSet]:
    """Responses (sensors, samples) without their means, the sampling rate [Hz], and the set without silent sensors."""
    if records.kind != "time":
        raise InputError(records.path, found=f"kind {records.kind!r}", expected="time records")
    values, x = np.asarray(records.responses), records.x
    if len(x) < LEAST:
        raise InputError(records.path, found=f"{len(x)} samples", expected=f"{LEAST} or more")
    step = float(x[-1] - x[0]) / (len(x) - 1)
    if np.abs(x - np.linspace(x[0], x[-1], len(x))).max() > 0.05 * step:
        raise InputError(records.path, found="uneven instants", expected="even steps: export the record as sampled")
    y = values - values.mean(axis=1, keepdims=True)
    alive = np.flatnonzero(y.std(axis=1) > 0.0)
    if not len(alive):
        raise InputError(records.path, found="no channel with a signal", expected="a response")
    names = ("response_point", "response_direction", "reference_point", "reference_direction")
    left = replace(records, responses=values[alive], **{name: getattr(records, name)[alive] for name in names})
    return y[alive], 1.0 / step, left


def _references(frfs: FrfSet, y: FloatArray, points: Sequence[int] | None) -> IntArray:
    if points is None:
        return chosen_references(y / y.std(axis=1, keepdims=True))
    at = np.flatnonzero(np.isin(frfs.response_point, list(points)))
    missing = sorted(set(points) - set(frfs.response_point.tolist()))
    if missing or not len(at):
        found = f"references at points {', '.join(map(str, missing)) or 'none'}"
        raise InputError(frfs.path, found=found, expected="points of the record")
    return at


def _lags(y: FloatArray, fs: float, seconds: float | None, path: str) -> int:
    """Number of samples of the longest lag."""
    count = y.shape[1]
    lags = round(seconds * fs) if seconds is not None else int(count / (LAG_PART * BLOCKS))
    if not 16 <= lags <= count // (BLOCKS + 2):
        found = f"lags of {lags / fs:.3g} s in a record of {count / fs:.4g} s"
        raise InputError(
            path, found=found, expected=f"at most a {BLOCKS + 2}th of the record, {16.0 / fs:.2g} s or more"
        )
    return lags


def _grid(
    frfs: FrfSet, own: IntArray, angles: Mapping[int, float] | None, places: Mapping[int, ArrayLike] | None
) -> tuple[SensorGrid, IntArray]:
    """Sensors and references, and the row and column (channels, 2) of each channel in the correlations."""
    count, bases = len(frfs), len(own)
    row, column = np.repeat(np.arange(count), bases), np.tile(np.arange(bases), count)
    pairs = FrfSet.from_arrays(
        kind="frf", x=[1.0], responses=np.ones((count * bases, 1), complex), unit="", path=frfs.path,
        response_point=frfs.response_point[row], response_direction=frfs.response_direction[row],
        reference_point=frfs.response_point[own[column]], reference_direction=frfs.response_direction[own[column]],
    )  # fmt: skip
    return sensor_grid(pairs, angles, places), np.column_stack([row, column])


def _spectra(found: Correlations) -> tuple[FloatArray, FloatArray]:
    """Lines [Hz] and the power of the references at them."""
    freq = np.asarray(np.fft.rfftfreq(found.R.shape[-1], 1.0 / found.fs), np.float64)
    power = _power(found, found.mean)
    return freq, np.asarray(np.maximum(power, 1e-12 * power.max()))


def _scatter(found: Correlations) -> FloatArray:
    """Standard deviation of the power of the references (lines,), by jackknife over the blocks."""
    count = len(found.R)
    power = np.array([_power(found, found.without(block)) for block in range(count)])
    return np.asarray(np.sqrt((count - 1) / count * np.sum((power - power.mean(axis=0)) ** 2, axis=0)))


def _power(found: Correlations, R: FloatArray) -> FloatArray:
    """Power of the references (lines,) from correlations R (sensors, references, 2 L).

    The window over the lags has no side lobes of tones. It is zero at its ends, where the correlations of modes that
    have not decayed have a kink.
    """
    window = blackmanharris(R.shape[-1], sym=False)
    own = R[found.references, np.arange(len(found.references))]
    return np.asarray(np.fft.rfft(own * np.fft.ifftshift(window - window[0]), axis=-1).real.sum(axis=0))


def _peaks(freq: FloatArray, power: FloatArray, scatter: FloatArray, rules: Thresholds) -> Peaks:
    """Peaks that are above their surroundings, significant by their scatter, and not too wide for a mode."""
    at, _ = find_peaks(10.0 * np.log10(power), prominence=rules.prominence_db)
    at = at[power[at] > np.maximum(NORMAL * scatter[at], LOBES * power.max())]
    width = peak_widths(power, at)[0] if len(at) else np.zeros(0)
    narrow = width * (freq[1] - freq[0]) < np.maximum(2.0 * rules.zeta_most * freq[at], WIDEST * (freq[1] - freq[0]))
    return Peaks(at=at[narrow], width=width[narrow])


def _bands(
    found: Correlations, freq: FloatArray, power: FloatArray, peaks: Peaks, order: int | None,
    say: Callable[[str], None], rules: Thresholds,
) -> tuple[list[Estimated], Stabilisation]:  # fmt: skip
    """Identify the modes of all bands, in ascending order, with their diagram."""
    data = Responses(freq, np.sqrt(power)[:, None], np.ones(len(freq)), peaks)
    cut = [part for core, _, _ in bands(data, rules) for part in _around(core, peaks.at, rules)]
    modes, diagrams = list[Estimated](), list[Stabilisation]()
    seen = freq[peaks.at]
    for k, core in enumerate(cut):
        say(f"band {k + 1} of {len(cut)}")
        low, high = float(freq[core.start]), float(freq[core.stop - 1])
        inside = seen[(seen >= low) & (seen <= high)]
        reach = MARGIN * EDGE * (high - low) / (1.0 - 2.0 * MARGIN * EDGE)
        ends = max(0.0, low - reach), min(0.5 * found.fs, high + reach)
        most = order or min(rules.order_a_peak * max(len(inside), 1) + rules.order_extra, rules.order_most)
        here, diagram = _band(found, ends, most, inside, rules)
        step = float(freq[1] - freq[0])
        modes += [mode for mode in here if low <= mode.found.freq < high + step]
        diagrams.append(diagram)
    return modes, Stabilisation.join(diagrams)


def _around(core: slice, at: IntArray, rules: Thresholds) -> list[slice]:
    """Divide a band into the lines around its peaks and the lines beyond, if the latter are many more.

    The step between the lags of a band is its inverse width. A wide band with few peaks would not resolve close modes.
    """
    inside = at[(at >= core.start) & (at < core.stop)]
    if not len(inside):
        return [core]
    margin = max(rules.reach_lines, int(inside[-1] - inside[0]) // 2)
    start, stop = max(core.start, int(inside[0]) - margin), min(core.stop, int(inside[-1]) + margin)
    if core.stop - core.start < EMPTY * (stop - start):
        return [core]
    return [part for part in (slice(core.start, start), slice(start, stop), slice(stop, core.stop)) if _lines(part)]


def _lines(part: slice) -> int:
    return int(part.stop - part.start)


def _band(
    found: Correlations, ends: tuple[float, float], most: int, seen: FloatArray, rules: Thresholds
) -> tuple[list[Estimated], Stabilisation]:
    """Identify the modes of one band."""
    zoom = zoomed(found.mean, found.fs, *ends)
    largest = fits_in(zoom, most)
    if largest < 2:
        return [], Stabilisation.join([])
    orders = range(max(1, largest // 4), largest + 1)
    whole = swept(zoom, orders)
    candidates, diagram = clusters(whole, orders, rules)
    parts = [swept(zoomed(found.without(block), found.fs, *ends), orders) for block in range(len(found.R))]
    found_again = [_jackknifed(cluster, whole, parts, len(orders), rules) for cluster in candidates]
    every = [estimated for estimated in found_again if estimated is not None]
    modes = [estimated for estimated in every if _known(estimated.found)]
    for peak in seen.tolist():  # the nearest mode of each peak without a well-known mode
        near = [each for each in every if abs(each.found.freq - peak) < each.found.zeta * peak]
        if near and not any(each in modes for each in near):
            modes.append(min(near, key=lambda each: abs(each.found.freq - peak)))
    return sorted(modes, key=lambda each: each.found.freq), diagram


def _jackknifed(cluster: Cluster, whole: Swept, parts: list[Swept], orders: int, rules: Thresholds) -> Estimated | None:
    """Add the jackknife uncertainty to a mode; return None if too few of the records without a block contain it."""
    mode = again(whole, cluster, rules)
    others = [other for part in parts if (other := again(part, cluster, rules)) is not None]
    count = len(others)
    if mode is None or count < PRESENT * len(parts):
        return None
    poles = np.array([other.pole for other in others])
    factor = float(np.sqrt((count - 1) / count))
    freq, zeta = _numbers(np.array([mode.pole]))
    spread = [factor * float(np.sqrt(np.sum((v - v.mean()) ** 2))) for v in _numbers(poles)]
    A = np.array([other.A for other in others])
    moved = (factor * (A - A.mean(axis=0))).reshape(count, -1).T
    residues = Residues(mode.A.ravel(), np.zeros(mode.A.size), moved)
    signal = float(np.linalg.norm(mode.A) / (np.linalg.norm(moved) + 1e-300))
    found = Found(float(freq[0]), spread[0], float(zeta[0]), spread[1], residues, signal, float("nan"))
    return Estimated(found, len(mode.orders) / orders)


def _numbers(poles: Array) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and damping ratios."""
    size: FloatArray = np.hypot(poles.real, poles.imag)
    return np.asarray(size / (2.0 * np.pi), np.float64), np.asarray(-poles.real / size, np.float64)


def _known(found: Found) -> bool:
    """Whether a mode without a visible peak is well determined: precise frequency, and damping above zero."""
    wide = 2.0 * found.zeta * found.freq
    return found.sigma_freq < KNOWN * wide and ABOVE_ZERO * found.sigma_zeta < found.zeta


def _scaled(estimated: Estimated, factors: FloatArray) -> Estimated:
    """Scale a mode to the units of the responses."""
    residues, by = estimated.found.residues, factors.ravel()
    scaled = Residues(residues.values * by, residues.direct, residues.moved * by[:, None])
    return estimated._replace(found=estimated.found._replace(residues=scaled))


def _modes(estimated: list[Estimated], channels: IntArray, sensors: Sensors, rules: Thresholds) -> list[Mode]:
    """Modes with shapes, labels and verdicts, ascending; neighbours without a partner may be merged."""
    estimated = sorted(estimated, key=lambda each: each.found.freq)
    modes = [replace(mode_of(each.found, sensors), split_bound=0.0) for each in estimated]
    gaps = [float(np.hypot(low.sigma_freq, high.sigma_freq)) for low, high in pairwise(modes)]
    chi = [_chi(low, high, gap) for (low, high), gap in zip(pairwise(modes), gaps, strict=True)]
    members = {k for pair in paired(modes) for k in pair}  # their shapes show that they are two
    chi = [np.inf if modes[k].n < 1 or {k, k + 1} & members else each for k, each in enumerate(chi)]
    done = list[Mode]()
    for k in neighbours([mode.n for mode in modes], chi, ALIKE):
        strongest = max(k, key=lambda i: modes[i].signal)
        mode = modes[k[0]] if len(k) == 1 else one_of([modes[i] for i in k], gaps[k[0]])
        done.append(replace(mode, reason=_reasons(mode, estimated[strongest], rules)))
    return done


def _chi(low: Mode, high: Mode, gap: float) -> float:
    """Chi-squared of the differences of two modes in frequency, of deviation `gap` [Hz], and damping.

    It is infinite beyond a bandwidth. Jackknife deviations are not below the true ones on average.
    """
    if high.freq - low.freq > 2.0 * max(low.zeta * low.freq, high.zeta * high.freq):
        return float("inf")
    by_zeta = np.hypot(low.sigma_zeta, high.sigma_zeta)
    return float(((high.freq - low.freq) / gap) ** 2 + ((high.zeta - low.zeta) / by_zeta) ** 2)


def _reasons(mode: Mode, estimated: Estimated, rules: Thresholds) -> str:
    """Reasons why a mode is doubtful, "" for a sure one; the shape of an unresolved pair may have any phase."""
    found = estimated.found
    reasons, wide = list[str](), 2.0 * found.zeta * found.freq
    if found.zeta < ABOVE_ZERO * found.sigma_zeta:
        reasons.append("its damping is not above zero: a tone of a machine, mains hum? Measure again at another time")
    if found.sigma_freq > rules.sure_freq * wide:
        reasons.append(
            f"its frequency is known to {100.0 * found.sigma_freq / wide:.0f} % of its bandwidth only: measure longer"
        )
    if found.sigma_zeta > rules.known_zeta * found.zeta:
        reasons.append(f"its damping is uncertain by {100.0 * found.sigma_zeta / found.zeta:.0f} %: measure longer")
    if found.zeta > rules.damped:
        reasons.append(f"its damping of {100.0 * found.zeta:.2g} % is that of a residual, or of several modes")
    if mode.collinearity < rules.in_phase and not mode.unresolved:
        reasons.append(f"only {100.0 * mode.collinearity:.0f} % of its shape is in phase: two modes, or a load's peak?")
    if estimated.recurs < OFTEN:
        reasons.append(f"it recurs in {100.0 * estimated.recurs:.0f} % of the model orders only")
    return "; ".join(reasons)


def _lonely(modes: Sequence[Mode], doublets: tuple[tuple[int, int], ...]) -> list[str]:
    """Modes of n >= 1 without a partner."""
    members = {k for pair in doublets for k in pair}
    return [
        f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the loads do not drive it, or its peak is hidden; measure"
        " longer or move a reference"
        for k, mode in enumerate(modes)
        if mode.n > 0 and k not in members and not mode.unresolved
    ]


def _close(modes: Sequence[Mode], doublets: tuple[tuple[int, int], ...]) -> list[str]:
    """Notes on doublets whose split is below two standard deviations."""
    pairs = [(modes[low], modes[high]) for low, high in doublets]
    splits = [(low, high.freq - low.freq, float(np.hypot(low.sigma_freq, high.sigma_freq))) for low, high in pairs]
    return [
        f"pair of n = {low.n} at {low.freq:.2f} Hz: its split of {split:.2g} Hz is below two standard deviations,"
        f" {NORMAL * sigma:.2g} Hz; without a split the antinodes may lie anywhere; {LONGER}"
        for low, split, sigma in splits
        if split < NORMAL * sigma
    ]


def _bare(modes: Sequence[Mode], seen: FloatArray, step: float) -> list[str]:
    """Note on visible peaks without a mode, on lines `step` [Hz] apart."""
    near = [np.abs(seen - mode.freq) <= max(2.0 * mode.zeta * mode.freq, MISSED * step) for mode in modes]
    bare = seen[~np.any(near, axis=0)] if near else seen
    if not len(bare):
        return []
    peaks = f"peak{'s' * (len(bare) > 1)} at {', '.join(f'{peak:.4g}' for peak in bare[:NAMED])} Hz"
    more = f" and {len(bare) - NAMED} more" if len(bare) > NAMED else ""
    return [f"no mode recurs at the {peaks}{more}: a tone, a load's peak, or a record too short: measure longer"]


def _compared(
    found: Correlations, estimated: list[Estimated], factors: FloatArray, channels: IntArray, low: float, high: float
) -> tuple[FloatArray, Array, Array]:
    """Lines [Hz], and half spectra of the correlations, measured and synthesised from the modes, (channels, lines)."""
    lags = found.R.shape[-1] // 2
    R = found.mean[..., :lags] * factors[..., None]
    R[..., 0] *= 0.5
    freq = np.asarray(np.fft.rfftfreq(lags, 1.0 / found.fs), np.float64)
    kept = (freq > 0.0) & (freq >= low) & (freq <= high)
    lines, fs = freq[kept], found.fs
    measured = np.fft.rfft(R, axis=-1)[..., kept] / fs
    fitted = np.zeros_like(measured)
    for each in estimated:
        omega = 2.0 * np.pi * each.found.freq
        pole = omega * (-each.found.zeta + 1j * np.sqrt(1.0 - each.found.zeta**2))
        A = each.found.residues.values.reshape(factors.shape)
        for p, residues in ((pole, A), (pole.conjugate(), A.conj())):
            q = p - 2j * np.pi * lines
            fitted += residues[..., None] * (np.exp(q * lags / fs) - 1.0) / q
    at = tuple(channels.T)
    return lines, measured[at], fitted[at]
