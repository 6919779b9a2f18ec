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
from casingfem.experiment.frf.sensor_grid import SensorGrid, form_of, radial_signs, sensor_grid
from casingfem.experiment.identify.band_fits import BandFits, Responses, core_of, fit_bands
from casingfem.experiment.identify.bands import find_bands, line_noise
from casingfem.experiment.identify.found_modes import FoundMode, found_modes
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.identify.mode_pairs import notes_of, paired, settled
from casingfem.experiment.identify.stabilisation import join
from casingfem.io.arrays import Array, FloatArray

LEAST_LINES = 30
EVEN = 0.05  # of a step: what rounded lines may be off their even places


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
    say: Callable[[str], None] = lambda _: None,
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
        "receptance", "mobility" or "accelerance"; None reads it from the unit.
    order
        Largest number of modes in a window's LSCF sweep; None takes it from the number of peaks.
    n_max
        Largest nodal diameter; None as far as the sensors tell them apart.
    pick
        Frequencies [Hz] of the modes, picked by hand from a stabilisation diagram: they are refined, none is added,
        none is left out.
    say
        Is told from time to time what is being done.

    Raises
    ------
    InputError
        No frequency responses, uneven or too few lines, dead channels, sensors without angle or reference, picks
        outside the lines.
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
    grid = sensor_grid(frfs, angles, places)
    freq, H = _lines(frfs, band)
    noise = np.maximum(line_noise(H), 1e-9 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1)))
    data = Responses(freq, H, noise, form_of(frfs, form))
    picked = None if pick is None else _picked(frfs.path, pick, freq)
    found = fit_bands(data, find_bands(freq, H, noise, picked), order, picked, say)
    cores = [core_of(freq, band) for band in found.bands]
    circle = None if angles is None else Circle.of(grid.theta, n_max)
    modes, left_out = found_modes(found.fits, cores, grid, radial_signs(grid), circle, keep=picked is not None)
    doublets = paired(modes)
    modes = settled(modes, doublets)
    return Identified(
        **_columns(modes, doublets, grid),
        sensors=grid,
        lines=freq,
        measured=H,
        fitted=_fitted(found, H),
        doublets=doublets,
        unresolved=tuple(k for k, mode in enumerate(modes) if mode.unresolved),
        doubts=tuple(mode.doubt for mode in modes),
        notes=(*test_notes(found), *notes_of(modes, doublets), *left_out),
        diagram=join(found.diagrams, cores),
        card=frfs.card,
        seconds=time.perf_counter() - started,
    )


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
        f" are given, which differ by {100.0 * found.shift:.2g} % (standard deviation); the uncertainties are those of"
        " the means"
    )
    leaked = "peaks are widened as by a Hann window, which is taken account of"
    return (*([shifted] if found.shift else []), *([leaked] if found.leak else []))


def _lines(frfs: FrfSet, band: tuple[float, float] | None) -> tuple[FloatArray, Array]:
    """Lines of the band and the responses there, refused where they cannot be used."""
    if frfs.kind != "frf":
        raise InputError(frfs.path, found=f"kind {frfs.kind!r}", expected="frequency responses")
    low, high = band or (0.0, np.inf)
    if not 0.0 <= low < high:
        raise InputError(frfs.path, found=f"band {low:g} to {high:g} Hz", expected="0 <= from < to")
    kept = (frfs.x >= low) & (frfs.x <= high) & (frfs.x > 0.0)
    freq, H = np.array(frfs.x[kept]), np.array(frfs.responses[:, kept])
    if len(freq) < LEAST_LINES:
        raise InputError(frfs.path, found=f"{len(freq)} lines in the band", expected=f"at least {LEAST_LINES}")
    steps, even = np.diff(freq), np.linspace(freq[0], freq[-1], len(freq))
    if np.abs(freq - even).max() > EVEN * (even[1] - even[0]):
        raise InputError(frfs.path, found=f"steps from {steps.min():g} to {steps.max():g} Hz", expected="even steps")
    dead = np.flatnonzero(np.abs(H).max(axis=1) == 0.0)
    if dead.size:
        place = f"channel {dead[0] + 1} (point {frfs.response_point[dead[0]]})"
        raise InputError(frfs.path, found=f"{place} is zero on every line", expected="a signal, or leave it out")
    return even, H


def _fitted(found: BandFits, H: Array) -> Array:
    """The fits over their cores, in the units of the responses; nan elsewhere."""
    whole = np.full(H.shape, complex(np.nan, np.nan))
    for fit, band in zip(found.fits, found.bands, strict=True):
        start = band.window[0]
        core = slice(band.core[0] - start, band.core[1] - start)
        whole[:, slice(*band.core)] = H[:, slice(*band.core)] - (fit.spread[core] / fit.window.weight).T
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
