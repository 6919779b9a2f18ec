"""Identify modes from frequency responses: spectra, poles, shapes, verdicts.

1. `usable`: lines, channels, kind of response. `spectra`: noise, visible peaks, the end of the ringing.
2. `lscf`: poles that recur over the orders of p-LSCF. `pole_fit`, `counting`, `clusters`: maximum likelihood of close
   modes together, as many as the data justify.
3. `setups`: channels that were measured together are identified alone, and their modes are merged.
4. `mode`, `verdict`: shapes, nodal diameters, pairs, what is doubtful. Every visible peak has a mode.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid, sensor_grid
from casingfem.experiment.identify.assembled import circle_notes, columns_of, labelled, oriented, sensor_notes
from casingfem.experiment.identify.clusters import (
    Modal,
    Responses,
    first_poles,
    fitted_groups,
    leaks,
    missing_peaks,
    modal_of,
    refined_end,
    settled_fits,
    unexplained,
    with_residues,
)
from casingfem.experiment.identify.exponential import window_note, window_time, without_window
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.experiment.identify.mode import Mode, Sensors, found_in, merged, mode_of, pair_notes, paired, settled
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.experiment.identify.setups import SetUp, setups_of
from casingfem.experiment.identify.spectra import line_noise, ringing, tapered, visible_peaks
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.experiment.identify.tracks import Track, setup_notes, shift_of, tracked
from casingfem.experiment.identify.usable import usable
from casingfem.experiment.identify.verdict import reasons, without_copies, without_twins
from casingfem.io.arrays import Array, FloatArray

USUAL_ZETA = 3e-3  # damping ratio from which a picked mode starts where no pole recurs
PASSES = False, True, True  # whether each fit may add poles; every fit may remove some


def identify(
    frfs: FrfSet,
    *,
    angles: Mapping[int, float] | None = None,
    places: Mapping[int, ArrayLike] | None = None,
    band: tuple[float, float] | None = None,
    form: str | None = None,
    order: int | None = None,
    n_max: int | None = None,
    pick: ArrayLike | None = None,
    exponential: float | None = None,
    coherence: FrfSet | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> Identified:
    """Frequencies, damping, shapes, nodal diameters and orientations of the modes in frequency responses.

    It also accepts time records of responses to random loads that were not measured (`identify_output_only`).

    Parameters
    ----------
    frfs
        Responses of every sensor to one or more references, over evenly spaced lines; or a set of kind "time".
    angles
        Angle [deg] of each response point on the sensors' circle; without them modes have no n and no orientation.
    places
        Position [m] of each response point: the shapes can then be put on a model's wall.
    band
        Frequencies [Hz] from, to; all lines if None.
    form
        "receptance", "mobility" or "accelerance"; None reads it from the unit; without a unit, accelerance.
    order
        Largest order of the p-LSCF estimator; None takes it from the number of peaks of each band.
    n_max
        Largest nodal diameter of a label; None takes 64. Labels end below the first n that the sensors cannot
        distinguish from a smaller one: at 11 on 24 even sensors.
    pick
        Frequencies [Hz] of the modes, picked from a stabilisation diagram: they are refined; no mode is added or left
        out.
    exponential
        Time constant tau [s] of an exponential window exp(-t/tau), whose damping is subtracted; None reads it from a
        line `exponential_window_s: ...` of the set's card, if it has one.
    coherence
        Coherence of the responses, over the same lines: lines with low coherence have less weight.
    say
        Called with the name of the current step.

    Raises
    ------
    InputError
        No frequency responses, uneven or too few lines, no channel with a signal, magnitudes without phase, sensors
        without angle or reference, picks outside the lines, a coherence over other lines.

    Examples
    --------
    >>> theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    >>> H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    >>> frfs = FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8))
    >>> found = identify(frfs, angles=dict(enumerate(np.degrees(theta))))
    >>> found.freq.round(4).tolist(), found.zeta.round(6).tolist(), found.n.tolist()
    ([100.0], [0.004], [2])
    """
    if frfs.kind == "time":
        return _of_records(frfs, angles, places, band, order, n_max, say, form, pick, exponential, coherence)
    started = time.perf_counter()
    rules = USUAL
    tau = window_time(frfs, exponential)
    frfs, freq, H, power, along, said = usable(frfs, band, form, coherence)
    grid = sensor_grid(frfs, angles, places)
    picked = None if pick is None else _picked(frfs.path, pick, freq)
    noise = np.maximum(line_noise(H), 1e-9 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1)))
    data, left = _responses(freq, H, noise, along, rules)
    data, poles, diagram = _first(data, order, say, rules)
    fits = (
        _fits(data, with_residues(data, poles, rules), say, rules)
        if picked is None
        else _picked_fits(data, with_residues(data, _picks(picked, poles), rules), rules)
    )
    circle = None if angles is None else Circle.of(grid.theta, n_max)
    alone = [] if picked is not None else _setups(data, fits, grid, order, say, rules)
    if picked is None and not alone and leaks([(data, modal_of(fits, len(noise)))], rules):
        data = data._replace(leak=float(freq[1] - freq[0]))
        fits = _fits(data, modal_of(fits, len(noise)), say, rules)
    elif alone:
        data = data._replace(leak=alone[0].data.leak)
    alone, tracks = tracked(alone, noise, grid, circle, rules) if alone else ([], [])
    modes, sensors = labelled(
        lambda at: _modes(fits, tracks, noise, at, picked is not None, rules), Sensors.of(grid, power, circle)
    )
    modes = modes if tracks or picked is not None else without_copies(modes, grid.directions)
    doublets = paired(modes)
    modes = oriented(settled(modes, doublets), doublets, sensors)
    modes = modes if picked is not None else without_twins(modes, doublets)
    notes = (
        *said, *_empty(modes, rules), *_test_notes(data, left, rules), *setup_notes(tracks),
        *circle_notes(modes, grid, circle), *sensor_notes(modes, grid, circle), *pair_notes(modes, doublets),
    )  # fmt: skip
    if tau is not None:
        modes, notes = without_window(modes, tau), (window_note(tau), *notes)
    return Identified(
        **columns_of(modes, doublets, grid),
        sensors=grid,
        lines=freq,
        measured=H,
        fitted=_fitted(data, fits, noise, alone),
        doublets=doublets,
        unresolved=tuple(k for k, mode in enumerate(modes) if mode.unresolved),
        reasons=tuple(mode.reason for mode in modes),
        notes=notes,
        diagram=diagram,
        card=frfs.card,
        seconds=time.perf_counter() - started,
        shift=shift_of(tracks),
    )


def _of_records(
    records: FrfSet, angles: Mapping[int, float] | None, places: Mapping[int, ArrayLike] | None,
    band: tuple[float, float] | None, order: int | None, n_max: int | None, say: Callable[[str], None], *others: object,
) -> Identified:  # fmt: skip
    """Modes of responses alone; `others` are options that belong to frequency responses."""
    from casingfem.experiment.identify.output_only.output_only import identify_output_only

    names = ("form", "pick", "exponential", "coherence")
    given = [name for name, value in zip(names, others, strict=True) if value is not None]
    if given:
        found = f"{', '.join(given)} with time records"
        raise InputError(records.path, found=found, expected="frequency responses for these options")
    return identify_output_only(
        records, angles=angles, places=places, band=band, order=order, n_max=n_max, say=say
    )  # fmt: skip


def _responses(
    freq: FloatArray, H: Array, noise: FloatArray, along: FloatArray, rules: Thresholds
) -> tuple[Responses, float]:
    """The responses over their noise, and the part of the ringing left at the end of the record."""
    end, left = ringing(freq, H)
    faded = tapered(freq, H, end)
    quiet = noise if not np.isfinite(end) else np.maximum(line_noise(faded), 1e-9 * np.abs(H).max(axis=1))
    peaks = visible_peaks((faded / quiet[:, None]).T, rules)
    return Responses(freq, (H / noise[:, None]).T, along, peaks, end), left


def _first(
    data: Responses, order: int | None, say: Callable[[str], None], rules: Thresholds
) -> tuple[Responses, Array, Stabilisation]:
    """Find the recurring poles, and the responses with the duration of ringing that fits them."""
    poles, diagram = first_poles(data, order, say, rules)
    if np.isfinite(data.end):
        data = data._replace(end=refined_end(data, poles, rules))
        poles, diagram = first_poles(data, order, say, rules)
    return data, poles, diagram


def _fits(data: Responses, modes: Modal, say: Callable[[str], None], rules: Thresholds) -> list[PoleFit]:
    """Fit all groups of modes: add and remove poles until every visible peak has one."""
    channels, fits = data.Y.shape[1], list[PoleFit]()
    for number, more in enumerate(PASSES):
        say(f"fit {number + 1} of {len(PASSES)}")
        starts = missing_peaks(data, modes)
        modes = Modal.join([modes, Modal(starts, np.zeros((len(starts), channels)))], channels)
        fits = fitted_groups(data, modes, more, rules)
        modes = modal_of(fits, channels)
    fits = settled_fits(data, fits, rules)
    return fits + unexplained(data, fits, rules)


def _picked_fits(data: Responses, modes: Modal, rules: Thresholds) -> list[PoleFit]:
    """Fit the picked modes: refine them, without adding or removing any."""
    return settled_fits(data, fitted_groups(data, modes, None, rules), rules)


def _picked(path: str, pick: ArrayLike, freq: FloatArray) -> FloatArray:
    """Picked frequencies in ascending order; refuse picks outside the measured lines."""
    picked = np.unique(np.asarray(pick, float))
    outside = picked[~((picked > freq[0]) & (picked < freq[-1]))]
    if picked.size == 0 or outside.size:
        found = f"{outside[0]:g} Hz picked" if outside.size else "no frequency picked"
        raise InputError(path, found=found, expected=f"frequencies between {freq[0]:g} and {freq[-1]:g} Hz")
    return picked


def _picks(picked: FloatArray, poles: Array) -> Array:
    """Picked poles [rad/s], each with the damping of the recurring pole nearest to it."""
    zeta = np.full(len(picked), USUAL_ZETA)
    if len(poles):
        nearest = np.abs(np.abs(poles) / (2.0 * np.pi) - picked[:, None]).argmin(axis=1)
        zeta = -poles[nearest].real / np.abs(poles[nearest])
    return np.asarray(2.0 * np.pi * picked * (-zeta + 1j * np.sqrt(1.0 - zeta**2)))


def _setups(
    data: Responses, fits: list[PoleFit], grid: SensorGrid, order: int | None, say: Callable[[str], None],
    rules: Thresholds,
) -> list[SetUp]:  # fmt: skip
    """Identify each set-up alone; return nothing if all channels belong to one set-up."""
    alone = list[SetUp]()
    for channels in setups_of(data, fits, grid, rules):
        say(f"set-up {len(alone) + 1}: {len(channels)} channels")
        own = data.some(channels, rules)
        start = with_residues(own, first_poles(own, order, say, rules)[0], rules)
        alone.append(SetUp(channels, own, _fits(own, start, say, rules)))
    if alone and leaks([(part.data, modal_of(part.fits, len(part.channels))) for part in alone], rules):
        leak = float(data.freq[1] - data.freq[0])
        alone = [part._replace(data=part.data._replace(leak=leak)) for part in alone]
        alone = [
            part._replace(fits=_fits(part.data, modal_of(part.fits, len(part.channels)), say, rules)) for part in alone
        ]
    return alone


def _modes(
    fits: list[PoleFit], tracks: list[Track], noise: FloatArray, sensors: Sensors, kept: bool, rules: Thresholds
) -> list[Mode]:
    """Modes with their verdicts; unresolved neighbours are merged unless they were picked."""
    if tracks:
        return [replace(mode_of(track.found, sensors), reason=track.reason) for track in tracks]
    found: list[Mode] = []
    for fit in fits:
        modes = [mode_of(pole, sensors) for pole in found_in(fit, noise, rules)]
        phases = [mode.collinearity for mode in modes]
        modes = [replace(mode, reason=why) for mode, why in zip(modes, reasons(fit, phases, rules), strict=True)]
        found += modes if kept else merged(fit, modes)
    return sorted(found, key=lambda mode: mode.freq)


def _empty(modes: list[Mode], rules: Thresholds) -> tuple[str, ...]:
    """Return the error for a test without a mode: the reason and the remedy."""
    text = (
        f"no mode: no peak is {rules.prominence_db:g} dB above its surroundings and {rules.above_noise_db:g} dB above"
        " the noise, and no pole recurs. Measure with closer lines or more averages, or pick frequencies"
    )
    return () if modes else (text,)


def _test_notes(data: Responses, left: float, rules: Thresholds) -> tuple[str, ...]:
    """Notes on the record: whether it ends before the ringing has decayed, and leakage."""
    ended = (
        f"the records end {data.end:.3g} s after the hit, when {100.0 * left:.0f} % of the ringing is left; the fit"
        " includes this end. Measure longer, or use an exponential window and give its time constant"
    )
    leaked = "peaks are widened as by a Hann window; the fit includes this"
    return (*([ended] if left > rules.ended else []), *([leaked] if data.leak else []))


def _fitted(data: Responses, fits: list[PoleFit], noise: FloatArray, alone: list[SetUp]) -> Array:
    """Fitted responses in the units of the measured ones (channels, lines); nan where nothing was fitted."""
    whole = np.full(data.Y.T.shape, complex(np.nan, np.nan))
    parts = [(part.channels, part.fits) for part in alone] or [(np.arange(len(whole)), fits)]
    for channels, own in parts:
        for fit in own:
            first = int(np.searchsorted(data.freq, fit.window.freq[0]))
            there = np.flatnonzero(fit.window.along > 0.0)
            rest = fit.rest[there] / fit.window.along[there, None]
            values = (data.Y[np.ix_(first + there, channels)] - rest) * noise[channels]
            whole[np.ix_(channels, first + there)] = values.T
    whole[:, np.isnan(whole).any(axis=0)] = np.nan
    return whole
