"""Modes from frequency responses, without a hand on the mouse.

The axis is cut at the valleys between peaks; in each band sdypy-EMA's LSCF gives poles for growing orders, those that
stay are the start, and a least-squares fit with residues eliminated does the rest: it decides how many poles there
are, refines them, and says how sure each is. Shapes give n, orientation and partners. sdypy's part ends with the
start.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs, sensor_grid
from casingfem.experiment.identify.band_fits import BandFits, Responses, core_of, fit_bands
from casingfem.experiment.identify.found_modes import (
    FoundMode,
    found_modes,
    notes_of,
    paired,
    settled,
    window_note,
    window_time,
    without_window,
)
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.identify.poles.bands import find_bands, line_noise
from casingfem.experiment.identify.poles.stabilisation import join
from casingfem.experiment.identify.setups.around import Places, suspect_sensors, suspected
from casingfem.experiment.identify.usable import usable
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray
from casingfem.io.side_by_side import side_by_side, usable_cores
from contact.io.workers import forks

MOST_OFF = 0.5  # share of the sensors that labels may do without
LARGE = 40_000  # values, whose identification takes seconds


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
    processes: int | None = None,
) -> Identified:
    """Frequencies, damping, shapes, nodal diameters and orientations of the modes in frequency responses.

    Parameters
    ----------
    frfs
        Responses of every sensor to one or more references, over evenly spaced lines.
    angles
        Angle [deg] of each response point on the sensors' circle; without them modes have no n and no orientation.
    places
        Position [m] of each response point: the shapes can then be put on a model's wall.
    band
        Frequencies [Hz] from, to; all lines if None.
    form
        "receptance", "mobility" or "accelerance"; None reads it from the unit; without a unit, accelerance.
    order
        Largest number of modes in a window's LSCF sweep; None takes it from the number of peaks.
    n_max
        Largest nodal diameter; None as far as the sensors tell them apart.
    pick
        Frequencies [Hz] of the modes, picked by hand from a stabilisation diagram: they are refined, none is added,
        none is left out.
    exponential
        Time constant tau [s] of an exponential window exp(-t/tau), whose damping is taken off; None reads it from a
        line `exponential_window_s: ...` of the set's card, where there is one.
    coherence
        Of the responses, over the same lines: a line weighs less where it is low.
    say
        Is told from time to time what is being done.
    processes
        That share the bands of a large test; by default one for each core where they can be copies of this one, as on
        Linux with one BLAS thread, else this one alone. What is found is the same.

    Raises
    ------
    InputError
        No frequency responses, uneven or too few lines, no channel with a signal, magnitudes without phase, sensors
        without angle or reference, picks outside the lines, a coherence over other lines.
    MissingExtraError
        sdypy-EMA is not installed.

    Examples
    --------
    >>> theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    >>> H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    >>> frfs = FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8))
    >>> found = identify(frfs, angles=dict(enumerate(np.degrees(theta))))
    >>> found.freq.round(4).tolist(), found.zeta.round(6).tolist(), found.n.tolist()
    ([100.0], [0.004], [2])
    """
    started = time.perf_counter()
    tau = window_time(frfs, exponential)
    frfs, freq, H, power, along, said = usable(frfs, band, form, coherence)
    grid = sensor_grid(frfs, angles, places)
    noise = np.maximum(line_noise(H), 1e-9 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1)))
    circle = None if angles is None else Circle.of(grid.theta, n_max)
    data = Responses(freq, H, noise, power, along, places=None if circle is None else _places(grid, circle))
    picked = None if pick is None else _picked(frfs.path, pick, freq)
    with side_by_side(_workers(H, processes)) as each:
        found = fit_bands(data, find_bands(freq, H, noise, picked), order, picked, say, each)
    cores = [core_of(freq, band) for band in found.bands]
    kept = picked is not None
    modes, left_out = found_modes(found.fits, cores, grid, radial_signs(grid), circle, kept)
    trusted = trusted_sensors(found, grid)
    belong = belonging(modes, grid, circle, trusted)
    if len(belong) < len(grid):  # those that do not belong where they are said to stand spoil labels
        others = Circle(theta=grid.theta[belong], orders=() if circle is None else circle.orders)
        modes, left_out = found_modes(found.fits, cores, grid, radial_signs(grid), others, kept, belong)
    doublets = paired(modes)
    modes = settled(modes, doublets)
    suspects = channel_notes(modes, grid, circle, trusted)
    round_it = circle_notes(modes, grid, circle)
    notes = (*said, *test_notes(found), *round_it, *suspects, *notes_of(modes, doublets), *left_out)
    if tau is not None:
        modes, notes = without_window(modes, tau), (window_note(tau), *notes)
    return Identified(
        **_columns(modes, doublets, grid),
        sensors=grid,
        lines=freq,
        measured=H,
        fitted=_fitted(found, H),
        doublets=doublets,
        unresolved=tuple(k for k, mode in enumerate(modes) if mode.unresolved),
        doubts=tuple(mode.doubt for mode in modes),
        notes=notes,
        diagram=join(found.diagrams, cores),
        card=frfs.card,
        seconds=time.perf_counter() - started,
        shift=found.shift,
    )


def _workers(H: Array, processes: int | None) -> int:
    """How many processes share a test: one for a small one, which would be done before they begin."""
    most = processes or (usable_cores() if forks() else 1)
    return most if H.size >= LARGE else 1


def _places(grid: SensorGrid, circle: Circle) -> Places:
    """Where each channel stands round the circle."""
    order = np.argsort(grid.channels.ravel())
    sensor, reference = (each.ravel()[order] for each in np.indices(grid.channels.shape))
    return Places(grid.theta[sensor], radial_signs(grid)[sensor], reference, circle.orders)


def _picked(path: str, pick: ArrayLike, freq: FloatArray) -> FloatArray:
    """Picked frequencies, ascending, refused where no lines are."""
    picked = np.unique(np.asarray(pick, float))
    outside = picked[~((picked > freq[0]) & (picked < freq[-1]))]
    if picked.size == 0 or outside.size:
        found = f"{outside[0]:g} Hz picked" if outside.size else "no frequency picked"
        raise InputError(path, found=found, expected=f"frequencies between {freq[0]:g} and {freq[-1]:g} Hz")
    return picked


def test_notes(found: BandFits) -> tuple[str, ...]:
    """What a test with shifted peaks or with leakage is said to be."""
    shifted = (
        "peaks lie at different frequencies in different channels (roving mass, moved hammer?): means over the set-ups"
        f" are given, which differ by {100.0 * found.shift:.2g} % (standard deviation); the uncertainties shown are"
        " what one more set-up would give, those of the means are smaller"
    )
    leaked = "peaks are widened as by a Hann window, which is taken account of"
    return (*([shifted] if found.shift else []), *([leaked] if found.leak else []))


def trusted_sensors(found: BandFits, grid: SensorGrid) -> BoolArray | None:
    """Sensors that move, by most of their references, as they should where they stand; None where that is not known."""
    return None if found.belongs is None else np.median(found.belongs[grid.channels], axis=1) > 0.5


def circle_notes(modes: list[FoundMode], grid: SensorGrid, circle: Circle | None) -> tuple[str, ...]:
    """Where the sensors tell no n, or a mode has the largest that they tell: a larger one would look like a smaller."""
    if circle is None or not modes:
        return ()
    if not circle.orders:
        low, high = np.degrees([grid.theta.min(), grid.theta.max()]).tolist()
        where = f"{len(np.unique(grid.theta))} angles from {low:.4g} to {high:.4g} deg"
        return (f"no n is told: the {len(grid)} sensors stand at {where}, too few or too near (angles in radians?)",)
    if not any(mode.n == circle.n_max for mode in modes):
        return ()
    return (
        f"n = {circle.n_max} is the largest looked for, at most what {len(grid)} sensors tell apart: modes of a larger"
        " n would be given a smaller one",
    )


def channel_notes(
    modes: list[FoundMode], grid: SensorGrid, circle: Circle | None, trusted: BoolArray | None
) -> tuple[str, ...]:
    """Which sensors of a circle are suspected, by the modes that are sure."""
    shapes = _sure_shapes(modes, grid)
    return () if circle is None else suspected(shapes, circle.n_max, grid.theta, grid.points, trusted)


def belonging(modes: list[FoundMode], grid: SensorGrid, circle: Circle | None, trusted: BoolArray | None) -> IntArray:
    """Sensors that are trusted, or not suspected, by which modes are labelled; all where too few would be left."""
    every, shapes = np.arange(len(grid)), _sure_shapes(modes, grid)
    if circle is None or not shapes.size:
        return every
    off = suspect_sensors(shapes, circle.n_max, grid.theta, grid.points, trusted)
    off = off if trusted is None else np.union1d(off, np.flatnonzero(~trusted))
    return np.delete(every, off) if len(off) <= MOST_OFF * len(every) else every


def _sure_shapes(modes: list[FoundMode], grid: SensorGrid) -> FloatArray:
    """Radial shapes of the modes that are sure, (sensors, modes)."""
    return np.array([mode.shape for mode in modes if not mode.doubt]).T * radial_signs(grid)[:, None]


def _fitted(found: BandFits, H: Array) -> Array:
    """The fits over their cores, in the units of the responses; nan elsewhere."""
    whole = np.full(H.shape, complex(np.nan, np.nan))
    for fit, band in zip(found.fits, found.bands, strict=True):
        start = band.window[0]
        core = slice(band.core[0] - start, band.core[1] - start)
        weight = fit.window.along[core, None] * fit.window.weight
        there = np.arange(*band.core)[weight[:, 0] > 0.0]
        whole[:, there] = H[:, there] - (fit.spread[there - start] / weight[there - band.core[0]]).T
    return whole


def _columns(modes: list[FoundMode], doublets: tuple[tuple[int, int], ...], grid: SensorGrid) -> dict[str, Any]:
    """Fields of `Identified` that have one entry for each mode."""

    def column(name: str) -> FloatArray:
        return np.array([getattr(mode, name) for mode in modes], float)

    count = len(grid), len(grid.references)
    names = ("freq", "sigma_freq", "zeta", "sigma_zeta", "purity", "collinearity", "signal", "residue_scale")
    members = {k for pair in doublets for k in pair}
    bound = np.array([np.nan if k in members or mode.n == 0 else mode.split_bound for k, mode in enumerate(modes)])
    return {
        **{name: column(name) for name in names},
        "n": np.array([mode.n for mode in modes], np.int64),
        "angle_deg": np.degrees(column("angle")),
        "sigma_angle": np.degrees(column("sigma_angle")),
        "shapes": np.array([mode.shape for mode in modes]).reshape(-1, count[0]).T,
        "sigma_shapes": np.array([mode.sigma_shape for mode in modes]).reshape(-1, count[0]).T,
        "residues": np.array([mode.residues for mode in modes], complex).reshape(-1, *count).transpose(1, 2, 0),
        "split_bound": bound.reshape(-1),
    }
