"""Fits of all bands of a set of responses, each knowing what the modes of the others add to it.

First the bands with peaks are fitted, each from the poles that LSCF finds stable in it. Then every band is fitted
again, those without peaks too, from what was found, after the responses of modes outside its window have been taken
off: what its polynomials have to follow is then small.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.bands import Band
from casingfem.experiment.identify.ema_poles import lscf_poles
from casingfem.experiment.identify.own_shifts import aligned, shifted_reading
from casingfem.experiment.identify.pole_fit import PoleFit, fit_poles
from casingfem.experiment.identify.pole_selection import select_poles
from casingfem.experiment.identify.pole_window import Window
from casingfem.experiment.identify.stabilisation import Stabilisation, stabilise
from casingfem.io.arrays import Array, FloatArray

FLOOR = 3e-4  # of a window's rms: a model is not better than that
ORDER = 8, 3, 40  # of a window without peaks, more for each peak, at most
PASSES = 2  # fits of every band after the first, 1 where peaks are shifted
USUAL_ZETA = 2e-3  # of a picked pole that no stable one is near to


class Responses(NamedTuple):
    """Lines [Hz], responses (channels, lines), standard deviation of each channel's noise, power of j omega."""

    freq: FloatArray
    H: Array
    noise: FloatArray
    power: int


class BandFits(NamedTuple):
    """One fit for each band, its stabilisation diagram, and whether peaks are shifted from channel to channel."""

    bands: list[Band]
    fits: list[PoleFit]
    diagrams: list[Stabilisation]
    shifted: bool


class _Mode(NamedTuple):
    """A pole and its residues (channels,) of (j f)^q w^2/(w^2 - f^2 + 2 j zeta w f), f in Hz."""

    freq: float
    zeta: float
    residues: Array


def fit_bands(
    data: Responses,
    bands: list[Band],
    order: int | None,
    picked: FloatArray | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> BandFits:
    """Fit every band: see above; `order` and `say` as in `identify`; frequencies `picked` [Hz] are the poles."""
    fits: list[PoleFit | None] = []
    diagrams = []
    for k, band in enumerate(bands):
        say(f"poles in band {k + 1} of {len(bands)}")
        diagram, starts = _sweep(data, band, order)
        diagrams.append(diagram)
        if picked is not None:
            starts = _picks(data.freq, band, picked, starts)
        fits.append(select_poles(_window(data, band, []), starts, search=picked is None) if band.peaks else None)
    fits, shifted = _read(data, bands, fits, reduce=picked is None)
    passes = 1 if shifted else PASSES
    for again in range(passes):
        for k, band in enumerate(bands):
            say(f"fit {again + 2} of {passes + 1}, band {k + 1} of {len(bands)}")
            modes = _modes(data, bands, fits)
            low, high = data.freq[band.window[0]], data.freq[band.window[1] - 1]
            inside = [mode for mode in modes if low <= mode.freq <= high]
            outside = [mode for mode in modes if not low <= mode.freq <= high]
            starts = np.array([(mode.freq, mode.zeta) for mode in inside]).reshape(-1, 2)
            window, fit = _window(data, band, outside), fits[k]
            if shifted and fit is not None:
                fits[k] = _without_shifts(replace(window, residues=fit.window.residues), starts)
            else:
                fits[k] = select_poles(window, starts, search=picked is None)
    return BandFits(bands, [fit for fit in fits if fit is not None], diagrams, shifted)


def _picks(freq: FloatArray, band: Band, picked: FloatArray, stable: FloatArray) -> FloatArray:
    """Picked frequencies in a window, each with the damping of the stable pole nearest to it (poles, 2)."""
    low, high = freq[band.window[0]], freq[band.window[1] - 1]
    here = picked[(picked >= low) & (picked <= high)]
    if not len(stable):
        return np.column_stack([here, np.full(len(here), USUAL_ZETA)])
    return np.column_stack([here, stable[np.abs(stable[None, :, 0] - here[:, None]).argmin(axis=1), 1]])


def _read(
    data: Responses, bands: list[Band], fits: list[PoleFit | None], *, reduce: bool
) -> tuple[list[PoleFit | None], bool]:
    """The fits, and whether peaks are shifted from channel to channel; then with as few poles as that leaves."""
    readings = [
        None if fit is None else shifted_reading(fit, *core_of(data.freq, band))
        for band, fit in zip(bands, fits, strict=True)
    ]
    shifted = sum(reading.evidence for reading in readings if reading is not None) > 0.0
    if not (shifted and reduce):
        return fits, shifted
    return [
        fit if fit is None or reading is None else fit_poles(fit.window, *reading.starts.T)
        for fit, reading in zip(fits, readings, strict=True)
    ], True


def _without_shifts(window: Window, starts: FloatArray) -> PoleFit:
    """The fit of what the channels would show without shifts; sigma knows of them."""
    straight, shift = aligned(fit_poles(window, *starts.T))
    return replace(fit_poles(straight, *starts.T), shift=shift)


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


def _window(data: Responses, band: Band, outside: list[_Mode]) -> Window:
    """What is to be fitted in a band, without the modes outside its window."""
    lines = slice(*band.window)
    whole = data.H[:, lines] / data.noise[:, None]
    rest = whole - _added(data, lines, outside) / data.noise[:, None]
    return Window(
        freq=data.freq[lines],
        Y=np.concatenate([rest.real, rest.imag], axis=1).T,
        power=data.power,
        residues="real",
        weight=1.0 / data.noise,
        floor=FLOOR * float(np.sqrt(0.5 * np.mean(np.abs(whole) ** 2))),
    )


def _added(data: Responses, lines: slice, modes: list[_Mode]) -> Array:
    """Sum of modes (channels, lines)."""
    if not modes:
        return np.zeros((len(data.H), 1))
    f = data.freq[lines]
    own, zeta = np.array([(mode.freq, mode.zeta) for mode in modes]).T[:, :, None]
    unit = (1j * f) ** data.power * own**2 / (own**2 - f**2 + 2j * zeta * own * f)
    return np.asarray(np.array([mode.residues for mode in modes]).T @ unit)


def _modes(data: Responses, bands: list[Band], fits: list[PoleFit | None]) -> list[_Mode]:
    """Modes of all cores."""
    modes = []
    for band, fit in zip(bands, fits, strict=True):
        if fit is None:
            continue
        low, high = core_of(data.freq, band)
        residues = fit.A[:, 0] + (1j * fit.A[:, 1] if fit.window.columns == 2 else 0.0)
        residues = residues / fit.window.weight / fit.window.scale**data.power
        for k in np.flatnonzero((fit.freq >= low) & (fit.freq < high)).tolist():
            modes.append(_Mode(float(fit.freq[k]), float(fit.zeta[k]), residues[k]))
    return modes
