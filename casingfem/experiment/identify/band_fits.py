"""Fits of all bands of a set of responses, each knowing what the modes of the others add to it.

First the bands with peaks are fitted, each from the poles that LSCF finds stable in it. Then every band is fitted
again, those without peaks too, from what was found, after the responses of modes outside its window have been taken
off: what its polynomials have to follow is then small.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.bands import Band
from casingfem.experiment.identify.poles.pole_fit import PoleFit, fit_poles
from casingfem.experiment.identify.poles.pole_selection import alike_lines, noise_at, select_poles
from casingfem.experiment.identify.poles.pole_window import Window, floor_of
from casingfem.experiment.identify.poles.stabilisation import Stabilisation, lscf_poles, stabilise
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.as_waves import as_waves
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import Shifted, shifted
from casingfem.io.arrays import Array, BoolArray, FloatArray
from casingfem.io.side_by_side import Each, largest_first

ORDER = 8, 3, 40  # of a window without peaks, more for each peak, at most
PASSES = 2  # fits of every band after the first
USUAL_ZETA = 2e-3  # of a picked pole that no stable one is near to


class Responses(NamedTuple):
    """Lines [Hz], responses (channels, lines), standard deviation of each channel's noise, power of j omega.

    `along` (lines,) and `leak` as in `Window`; `places` of channels round a circle, where they are known.
    """

    freq: FloatArray
    H: Array
    noise: FloatArray
    power: int
    along: FloatArray
    leak: float = 0.0
    places: Places | None = None


class BandFits(NamedTuple):
    """One fit for each band, its stabilisation diagram, and what set-ups differ by in ln f, 0 where there is one.

    `belongs` (channels,) as in `Shifted`.
    """

    bands: list[Band]
    fits: list[PoleFit]
    diagrams: list[Stabilisation]
    shift: float
    leak: float
    belongs: BoolArray | None = None


def fit_bands(
    data: Responses,
    bands: list[Band],
    order: int | None,
    picked: FloatArray | None = None,
    say: Callable[[str], None] = lambda _: None,
    each: Each = map,
) -> BandFits:
    """Fit every band: see above; `order` and `say` as in `identify`; frequencies `picked` [Hz] are the poles.

    First by `each` alone; so are clusters of a test with shifted peaks.
    """
    say(f"poles: 0 of {len(bands)} bands done")
    first = {}
    parts = [_of_band(data, band) for band in bands]
    for k, found_there in largest_first(each, partial(_first_fit, order, picked), parts, lambda part: part[1].peaks):
        first[k] = found_there
        say(f"poles: {len(first)} of {len(bands)} bands done")
    diagrams, fits = [first[k][0] for k in range(len(bands))], [first[k][1] for k in range(len(bands))]
    if any(fit is not None and len(fit.freq) for fit in fits):
        say("set-ups")
        kind = "complex" if any(fit.window.columns == 2 for fit in fits if fit is not None) else "real"
        whole = replace(_window(data, Band((0, len(data.freq)), (0, len(data.freq)), 0)), residues=kind)
        found = shifted(whole, _modes(data, bands, fits), data.places, each)
        data = data._replace(leak=found.leak)
        if found.several and picked is None:
            say("waves round the circle")
            found = as_waves(found, whole, data.places, each)
            aligned = _aligned_fits(data, bands, found, whole)
            return BandFits(bands, aligned, diagrams, found.shift, found.leak, found.belongs)
    for again in range(PASSES):
        for k, band in enumerate(bands):
            say(f"fit {again + 2} of {PASSES + 1}, band {k + 1} of {len(bands)}")
            starts, outside = _sides(data, band, _modes(data, bands, fits))
            fits[k] = select_poles(_window(data, band, outside), starts, search=picked is None)
    return BandFits(bands, [fit for fit in fits if fit is not None], diagrams, 0.0, data.leak)


def _of_band(data: Responses, band: Band) -> tuple[Responses, Band]:
    """The responses in the window of a band, and the band by their lines."""
    first, end = band.window
    inside = data._replace(freq=data.freq[first:end], H=data.H[:, first:end], along=data.along[first:end], places=None)
    return inside, band._replace(core=(band.core[0] - first, band.core[1] - first), window=(0, end - first))


def _first_fit(
    order: int | None, picked: FloatArray | None, one: tuple[Responses, Band]
) -> tuple[Stabilisation, PoleFit | None]:
    """The diagram of a band, and the fit from what is stable in it; None where it has no peaks."""
    data, band = one
    diagram, starts = _sweep(data, band, order)
    if picked is not None:
        starts = _picks(data.freq, band, picked, starts)
    return diagram, select_poles(_window(data, band), starts, search=picked is None) if band.peaks else None


def _aligned_fits(data: Responses, bands: list[Band], found: Shifted, whole: Window) -> list[PoleFit]:
    """Fits of what the channels would show if all set-ups had the same frequencies; sigma knows that they do not."""
    straight = found.aligned(whole)
    data = data._replace(H=straight.as_complex.T * data.noise[:, None] / np.where(data.along > 0.0, data.along, 1.0))
    freq, sigma = found.mean()
    modes, aligned = found.modes._replace(freq=freq[:, None]), []
    for band in bands:
        starts, outside = _sides(data, band, modes)
        window = replace(_window(data, band, outside), residues=straight.residues)
        fit = fit_poles(window, *starts.T, steps=0)
        nearest = np.array([np.abs(freq - f).argmin() for f in fit.freq], int)
        known = np.r_[sigma[nearest], found.sigma_zeta[nearest]]
        white = np.sqrt(np.maximum(fit.noise * np.diag(fit.covariance), 1e-300)) / fit.raised
        least = 1.0 if found.sigma_mean is None else 0.0  # waves tell modes apart whose mean frequencies meet
        more = np.maximum(np.tile(_by_misfit(fit), 2) / fit.raised, 1.0)  # what is not white noise counts once
        raised = np.maximum(known / white, least) * more
        apart = found.apart(nearest[1:], nearest[:-1])
        rival = fit.rival if found.rival is None else found.rival[nearest]
        fit = replace(fit, matching=found.sigma_matching[nearest], rival=rival, seen=found.seen()[nearest], apart=apart)
        fit = replace(fit, A=_residues(window, found.modes.residues[nearest]), worth=found.worth[nearest])
        aligned.append(replace(fit, covariance=fit.covariance * np.outer(raised, raised)))
    return aligned


def _residues(window: Window, residues: Array) -> FloatArray:
    """Residues (poles, channels) as those of a fit: where mean frequencies meet, only the set-ups tell them apart."""
    weighted = residues * window.weight * window.scale**window.power
    return np.stack([weighted.real, weighted.imag], axis=1)[:, : window.columns]


def _by_misfit(fit: PoleFit) -> FloatArray:
    """By how much what a fit leaves about each pole raises its standard deviations, (poles,).

    Where the model lacks something more than the noise is left, and that is alike on many lines.
    """
    raised = [noise_at(fit, k) / fit.noise * alike_lines(fit, k) for k in range(len(fit.freq))]
    return np.asarray(np.sqrt(raised), np.float64)


def _sides(data: Responses, band: Band, modes: Modes) -> tuple[FloatArray, Modes]:
    """Poles within a band's window, (poles, 2) of freq [Hz] and zeta, and the modes outside."""
    freq = modes.freq[:, 0]
    inside = (freq >= data.freq[band.window[0]]) & (freq <= data.freq[band.window[1] - 1])
    return np.column_stack([freq, modes.zeta])[inside], modes.some(np.flatnonzero(~inside))


def _picks(freq: FloatArray, band: Band, picked: FloatArray, stable: FloatArray) -> FloatArray:
    """Picked frequencies in a window, each with the damping of the stable pole nearest to it (poles, 2)."""
    low, high = freq[band.window[0]], freq[band.window[1] - 1]
    here = picked[(picked >= low) & (picked <= high)]
    if not len(stable):
        return np.column_stack([here, np.full(len(here), USUAL_ZETA)])
    return np.column_stack([here, stable[np.abs(stable[None, :, 0] - here[:, None]).argmin(axis=1), 1]])


def core_of(freq: FloatArray, band: Band) -> tuple[float, float]:
    """Frequencies [Hz] from, to below which a pole belongs to a band."""
    low, high = band.core
    return float(freq[low]), float(freq[high]) if high < len(freq) else float(2.0 * freq[-1] - freq[-2])


def _sweep(data: Responses, band: Band, order: int | None) -> tuple[Stabilisation, FloatArray]:
    """Poles of growing orders in a window, and those that stay."""
    lines = slice(*band.window)
    weighted = data.H[:, lines] / data.noise[:, None]
    most = order or min(ORDER[0] + ORDER[1] * band.peaks, ORDER[2], weighted.shape[1] // 6)
    return stabilise(lscf_poles(data.freq[lines], weighted, most), data.freq[lines], weighted)


def _window(data: Responses, band: Band, outside: Modes | None = None) -> Window:
    """What is to be fitted in a band, without the modes outside its window."""
    lines = slice(*band.window)
    weighted = (data.H[:, lines] / data.noise[:, None] * data.along[lines]).T
    window = Window(
        freq=data.freq[lines],
        Y=np.concatenate([weighted.real, weighted.imag]),
        power=data.power,
        residues="real",
        weight=1.0 / data.noise,
        floor=floor_of(weighted),
        along=data.along[lines],
        leak=data.leak,
    )
    if outside is None or not len(outside.zeta):
        return window
    added = outside.response(window, [np.arange(len(data.H))])
    return replace(window, Y=window.Y - np.concatenate([added.real, added.imag]))


def _modes(data: Responses, bands: list[Band], fits: list[PoleFit | None]) -> Modes:
    """Modes of all cores, as of one set-up."""
    parts = [Modes(np.zeros((0, 1)), np.zeros(0), np.zeros((0, len(data.H))))]
    for band, fit in zip(bands, fits, strict=True):
        if fit is None:
            continue
        low, high = core_of(data.freq, band)
        residues = fit.A[:, 0] + (1j * fit.A[:, 1] if fit.window.columns == 2 else 0.0)
        modes = Modes(fit.freq[:, None], fit.zeta, residues / fit.window.weight / fit.window.scale**data.power)
        parts.append(modes.some(np.flatnonzero((fit.freq >= low) & (fit.freq < high))))
    return Modes(*(np.concatenate(each) for each in zip(*parts, strict=True)))
