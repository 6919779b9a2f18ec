"""Frequencies, damping and shapes of the modes in responses to loads that are not measured.

1. `correlations`: all sensors with some references, in blocks of the record. `bands`: bands of a few peaks.
2. `subspace`: poles that recur over the orders by frequency, damping, shape. `jackknife`: their uncertainty.
3. Pairs, nodal diameters and orientations follow as for frequency responses; each mode is sure, or doubtful for a
   reason.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtri

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid, sensor_grid
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.identify.labels import circle_notes, labelled, oriented
from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.experiment.identify.mode import Mode, Residues, Sensors, mode_of
from casingfem.experiment.identify.output_only.bands import bands_about, peaks_of, spectrum_of
from casingfem.experiment.identify.output_only.correlations import BLOCKS, Correlations, chosen_references, correlated
from casingfem.experiment.identify.output_only.jackknife import Estimated, modes_of
from casingfem.experiment.identify.pairs import neighbours, one_of, paired, unresolved_notes
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray
from contact.io.progress import each, tell

LAG_PART = 4.0  # length of a block in longest lags
LEAST = 2000  # samples of a record
OFTEN = 0.5  # of the model orders, in which a sure mode recurs
ALIKE = float(chdtri(2, 1e-3))  # largest chi-squared by chance of two modes' differences, once in a thousand
NORMAL = 2.0  # least standard deviations of a split without a note
LONGER = "a longer record may resolve it"
MISSED, NAMED = 2.0, 8  # lines within which a peak is that of a mode; peaks that a note names
MADE = "identified from responses alone: stochastic subspaces of their correlations, jackknife over blocks"


def identify_output_only(
    records: FrfSet,
    *,
    angles: Mapping[int, float] | None = None,
    places: Mapping[int, ArrayLike] | None = None,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    n_max: int | None = None,
    seconds: float | None = None,
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
    seconds
        Longest lag of the correlations [s]; None takes an eightieth of the record.

    Raises
    ------
    InputError
        No time records, a record that is too short, sensors twice, points without a sensor.

    Notes
    -----
    The loads must be random, many, and without peaks of their own in the band. Shapes have no scale. Up to four sensors
    that explain the others best are the references.
    """
    started, rules = time.perf_counter(), USUAL
    y, fs, frfs = _usable(records)
    own = chosen_references(y / y.std(axis=1, keepdims=True))
    lags = _lags(y, fs, seconds, records.path)
    scale = y.std(axis=1)
    tell("correlations")
    found = correlated(y / scale[:, None], fs, lags, own)
    grid, channels = _grid(frfs, own, angles, places)
    low, high = band or (0.0, 0.5 * fs)
    whole = spectrum_of(found)
    kept = (whole.freq >= max(low, whole.freq[1])) & (whole.freq <= high)
    if kept.sum() < 8 or not low < high:
        found_band = f"band {low:g} to {high:g} Hz"
        raise InputError(records.path, found=found_band, expected=f"from < to, up to {0.5 * fs:g} Hz")
    spectrum = whole.at(kept)
    peaks = peaks_of(spectrum, rules)
    cut = bands_about(spectrum, peaks, 0.5 * fs, rules)
    parts = [modes_of(found, part, order, rules) for part in each(cut, "band")]
    factors = np.outer(scale, scale[own])
    estimated = [_scaled(mode, factors) for modes, _ in parts for mode in modes]
    circle = None if angles is None else Circle.of(grid.theta, n_max)
    modes, sensors, suspects = labelled(lambda at: _modes(estimated, channels, at, rules), Sensors.of(grid, 0, circle))
    doublets = paired(modes)
    modes = oriented(modes, doublets, sensors)
    lines, measured, fitted = _compared(found, estimated, factors, channels, low, high)
    notes = (
        f"output only: {len(own)} reference{'s' * (len(own) > 1)}, lags up to {lags / fs:.3g} s, {BLOCKS} blocks;"
        " shapes have no scale",
        *circle_notes(modes, grid, circle), *suspects,
        *unresolved_notes(modes, LONGER), *_close(modes, doublets), *_lonely(modes, doublets),
        *_bare(modes, spectrum.freq[peaks], float(whole.freq[1])),
    )  # fmt: skip
    return Identified.of(
        modes, doublets, grid, lines=lines, measured=measured, fitted=fitted, notes=notes,
        diagram=Stabilisation.join([diagram for _, diagram in parts]), card=(*records.card, MADE),
        seconds=time.perf_counter() - started,
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
    if found.zeta < rules.above_zero * found.sigma_zeta:
        reasons.append("its damping is not above 0: a tone of a machine, or mains hum? Measure again at another time")
    if found.sigma_freq > rules.sure_freq * wide:
        reasons.append(
            f"its frequency is known to {100.0 * found.sigma_freq / wide:.0f} % of its bandwidth only: measure longer"
        )
    if found.sigma_zeta > rules.known_zeta * found.zeta:
        reasons.append(f"its damping is uncertain by {100.0 * found.sigma_zeta / found.zeta:.0f} %: measure longer")
    if found.zeta > rules.zeta_most:
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
    for mode in estimated:
        omega = 2.0 * np.pi * mode.found.freq
        pole = omega * (-mode.found.zeta + 1j * np.sqrt(1.0 - mode.found.zeta**2))
        A = mode.found.residues.values.reshape(factors.shape)
        for p, residues in ((pole, A), (pole.conjugate(), A.conj())):
            q = p - 2j * np.pi * lines
            fitted += residues[..., None] * (np.exp(q * lags / fs) - 1.0) / q
    at = tuple(channels.T)
    return lines, measured[at], fitted[at]
