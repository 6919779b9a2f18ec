"""Identify modes from frequency responses: spectra, poles, shapes, verdicts.

1. `responses`: usable lines and channels, kind of response; noise, visible peaks, the end of the ringing.
2. `lscf`: poles that recur over the orders of p-LSCF. `groups`: close modes are fitted together by maximum likelihood
   (`pole_fit`), as many as the data justify (`counting`), until every visible peak has a mode.
3. `setups`: channels that were measured together are identified alone; `tracks` averages their modes.
4. `one_peak`: one mode where a peak differs between channels. `mode`: shapes and reasons for doubtful modes. `labels`:
   nodal diameters and antinodes. `pairs`: pairs of modes.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid, sensor_grid
from casingfem.experiment.identify.exponential import window_note, window_time, without_window
from casingfem.experiment.identify.groups import (
    SetUp,
    all_fitted,
    picked_fits,
    refined_end,
    with_leakage,
    with_residues,
)
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.identify.labels import circle_notes, labelled, oriented
from casingfem.experiment.identify.lscf import Candidates, recurring_poles
from casingfem.experiment.identify.mode import Mode, Sensors, found_in, mode_of, reasons
from casingfem.experiment.identify.one_peak import one_a_peak
from casingfem.experiment.identify.pairs import merged, pair_notes, paired, settled, without_twins
from casingfem.experiment.identify.responses import Responses, over_noise, usable
from casingfem.experiment.identify.setups import setups_of
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.experiment.identify.tracks import tracked
from casingfem.io.arrays import Array, FloatArray
from contact.io.progress import tell
from contact.io.threads import with_one_thread

USUAL_ZETA = 3e-3  # damping ratio from which a picked mode starts where no pole recurs


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
        refused = {"form": form, "pick": pick, "exponential": exponential, "coherence": coherence}
        return _of_records(frfs, refused, angles=angles, places=places, band=band, order=order, n_max=n_max)
    started = time.perf_counter()
    rules = USUAL
    tau = window_time(frfs, exponential)
    used = usable(frfs, band, form, coherence)
    grid = sensor_grid(used.frfs, angles, places)
    picked = None if pick is None else _picked(frfs.path, pick, used.freq)
    data = over_noise(used, rules)
    data, (poles, diagram) = _recurring(data, order, rules)
    if picked is None:
        parts = _identified(data, poles, grid, order, rules)
    else:
        start = with_residues(data, _picks(picked, poles), rules)
        parts = [SetUp(np.arange(len(used.H)), data, picked_fits(data, start, rules))]
    circle = None if angles is None else Circle.of(grid.theta, n_max)
    apart = tuple[str, ...]()
    if circle is None and picked is None:
        parts, apart = _one_a_peak(parts, grid, rules)
    several = tracked(parts, grid, circle, rules) if len(parts) > 1 else None
    found = partial(_modes, parts[0], picked is not None, rules) if several is None else several.modes
    modes, sensors, suspects = labelled(found, Sensors.of(grid, used.power, circle))
    doublets = paired(modes)
    modes = oriented(settled(modes, doublets), doublets, sensors)
    modes = without_twins(modes) if circle is None and picked is None else modes
    notes = (
        *used.notes, *_empty(modes, rules), *_test_notes(parts[0].data, rules),
        *(several.notes if several else ()), *apart, *circle_notes(modes, grid, circle), *suspects,
        *pair_notes(modes, doublets),
    )  # fmt: skip
    if tau is not None:
        modes, notes = without_window(modes, tau, rules), (window_note(tau), *notes)
    return Identified.of(
        modes,
        doublets,
        grid,
        lines=used.freq,
        measured=used.H,
        fitted=_fitted(several.parts if several else parts),
        notes=notes,
        diagram=diagram,
        card=used.frfs.card,
        seconds=time.perf_counter() - started,
        shift=several.shift if several else 0.0,
    )


def _of_records(records: FrfSet, refused: Mapping[str, object], **options: Any) -> Identified:
    """Modes of responses alone; `refused` are options that belong to frequency responses."""
    from casingfem.experiment.identify.output_only.output_only import identify_output_only

    given = [name for name, value in refused.items() if value is not None]
    if given:
        found = f"{', '.join(given)} with time records"
        raise InputError(records.path, found=found, expected="frequency responses with these options")
    return identify_output_only(records, **options)


def _one_a_peak(parts: list[SetUp], grid: SensorGrid, rules: Thresholds) -> tuple[list[SetUp], tuple[str, ...]]:
    """The set-ups with one mode at each peak that differs between channels, and notes."""
    directions = np.zeros(grid.channels.size, np.int64)
    directions[grid.channels] = grid.directions[:, None]
    done, notes = list[SetUp](), list[str]()
    for part in parts:
        both = [one_a_peak(fit, directions[part.channels], rules) for fit in part.fits]
        done.append(part._replace(fits=[fit for fit, _ in both]))
        notes += [note for _, some in both for note in some]
    return done, tuple(notes)


@with_one_thread
def _recurring(data: Responses, order: int | None, rules: Thresholds) -> tuple[Responses, Candidates]:
    """Find the recurring poles, and the responses with the duration of ringing that fits them."""
    found = recurring_poles(data, order, rules)
    if np.isfinite(data.end):
        data = data._replace(end=refined_end(data, found.poles, rules))
        found = recurring_poles(data, order, rules)
    return data, found


@with_one_thread
def _identified(data: Responses, poles: Array, grid: SensorGrid, order: int | None, rules: Thresholds) -> list[SetUp]:
    """Fit all channels together; if they were measured in several set-ups, fit each alone."""
    whole = SetUp(np.arange(len(data.noise)), data, all_fitted(data, with_residues(data, poles, rules), rules))
    alone = list[SetUp]()
    for channels in setups_of(whole, grid, rules):
        tell(f"set-up {len(alone) + 1}: {len(channels)} channels")
        own = data.some(channels, rules)
        start = with_residues(own, recurring_poles(own, order, rules).poles, rules)
        alone.append(SetUp(channels, own, all_fitted(own, start, rules)))
    return with_leakage(alone or [whole], rules)


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


def _modes(whole: SetUp, kept: bool, rules: Thresholds, sensors: Sensors) -> list[Mode]:
    """Modes with their verdicts, ascending; unresolved neighbours are merged unless all are `kept`."""
    found: list[Mode] = []
    for fit in whole.fits:
        modes = [mode_of(pole, sensors) for pole in found_in(fit, whole.data.noise, rules)]
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


def _test_notes(data: Responses, rules: Thresholds) -> tuple[str, ...]:
    """Notes on the record: whether it ends before the ringing has decayed, and leakage."""
    ended = (
        f"the records end {data.end:.3g} s after the hit, where {100.0 * data.left:.0f} % of the vibration remains; the"
        " fit includes this effect. Measure longer, or use an exponential window and give its time constant"
    )
    leaked = "peaks are as wide as with the leakage of a Hann window; the fit includes this effect"
    return (*([ended] if data.left > rules.ended else []), *([leaked] if data.leak else []))


def _fitted(parts: list[SetUp]) -> Array:
    """Fitted responses in the units of the measured ones (channels, lines); nan where nothing was fitted."""
    lines, channels = len(parts[0].data.freq), sum(len(part.channels) for part in parts)
    whole = np.full((channels, lines), complex(np.nan, np.nan))
    for part in parts:
        data = part.data
        for fit in part.fits:
            first = int(np.searchsorted(data.freq, fit.window.freq[0]))
            there = np.flatnonzero(fit.window.along > 0.0)
            rest = fit.rest[there] / fit.window.along[there, None]
            whole[np.ix_(part.channels, first + there)] = ((data.Y[first + there] - rest) * data.noise).T
    whole[:, np.isnan(whole).any(axis=0)] = np.nan
    return whole
