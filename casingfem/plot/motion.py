"""Pictures of what a run did: spectrum and waterfall, the orbit of a tip and of the rim before it, energies."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, PURPLE, SKY, new_figure, styled

SLICES, LEAST, FLOOR = 64, 256, 60.0  # of time in a waterfall, samples in each; dB below the loudest that is shown
LATE = 0.25  # of a run, from its end: the orbit and the spectrum at the end
COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)


class _Orbit(Protocol):
    """Motion of a tip and of the rim before it, along normal and rim [m], (ns, 2), at times [s], (ns,)."""

    @property
    def time(self) -> Array: ...

    @property
    def tip(self) -> Array: ...

    @property
    def rim(self) -> Array: ...


@styled
def figure_spectrum(time: Array, values: Array, *, label: str, unit: str, top_hz: float | None = None) -> Figure:
    """Amplitude spectrum over the whole run and at its end, and how it came to be: a waterfall over time.

    `values` at equal steps of `time` [s]; frequencies up to `top_hz`. Colours are decibels of the loudest slice, FLOOR
    of them: neither one shock nor silence sets the scale.
    """
    figure = new_figure(8.2, 5.4)
    upper, lower = figure.subplots(2, 1, height_ratios=(1.0, 1.3))
    step = float(np.diff(time).mean()) if time.size > 1 else 1.0
    top = min(top_hz or np.inf, 0.5 / step)
    late = values[int((1.0 - LATE) * values.size) :]
    for part, colour, words in ((values, PERFECT, "whole run"), (late, BEFORE, "last quarter")):
        freq, amplitude = spectrum(part, step)
        shown = (freq > 0.0) & (freq <= top)
        if shown.any():
            upper.semilogy(freq[shown], np.maximum(amplitude[shown], 1e-300), color=colour, linewidth=0.8, label=words)
    largest = max((float(line.get_ydata().max()) for line in upper.lines), default=1.0)
    upper.set(xlabel="frequency [Hz]", ylabel=f"{label} [{unit}]", xlim=(0.0, top))
    if largest > 0.0:
        upper.set_ylim(1e-5 * largest, 2.0 * largest)
    if upper.lines:
        upper.legend(fontsize=8)
    _waterfall(figure, lower, time, values, step, top)
    return figure


def spectrum(values: Array, step: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and amplitudes by Hann's window: 1 for a sine of amplitude 1 between two lines or on one.

    >>> freq, a = spectrum(np.sin(2.0 * np.pi * 50.0 * 1e-3 * np.arange(1000)), 1e-3)
    >>> float(freq[a.argmax()]), round(float(a.max()), 3)
    (50.0, 1.0)
    """
    window = np.hanning(values.size)
    weight = float(window.sum()) or 1.0
    return np.fft.rfftfreq(values.size, step), np.abs(np.fft.rfft((values - values.mean()) * window)) * 2.0 / weight


def waterfall(values: Array, step: float) -> tuple[Array, Array, Array]:
    """Starts of slices [samples], frequencies [Hz], amplitudes (slices, frequencies); none of too short a record."""
    size = max(LEAST, 2 * values.size // SLICES)
    if values.size < size:
        return np.zeros(0), np.zeros(0), np.zeros((0, 0))
    starts = np.unique(np.linspace(0, values.size - size, SLICES).astype(int))
    slices = [spectrum(values[i : i + size], step) for i in starts]
    return starts.astype(float), slices[0][0], np.array([amplitude for _, amplitude in slices])


def _waterfall(figure: Figure, axes: Any, time: Array, values: Array, step: float, top: float) -> None:
    starts, freq, amplitude = waterfall(values, step)
    axes.set(xlabel="time [s]", ylabel="frequency [Hz]")
    if len(starts) < 2 or not amplitude.max() > 0.0:
        axes.text(0.5, 0.5, "too short a record for a waterfall", transform=axes.transAxes, ha="center")
        return
    shown = freq <= top
    level = 20.0 * np.log10(np.maximum(amplitude[:, shown] / amplitude.max(), 1e-12))
    middle = float(time[0]) + step * (starts + 0.5 * (values.size - starts[-1]))
    drawn = axes.pcolormesh(
        middle, freq[shown], level.T, shading="nearest", rasterized=True, vmin=-FLOOR, vmax=0.0, cmap="magma"
    )
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label="level [dB of the loudest]", extend="min")


@styled
def figure_orbit(motion: _Orbit) -> Figure:
    """Orbit of a tip, and of the rim under it, in the contact's plane: the whole run with its peaks, its end on top."""
    figure = new_figure(8.2, 4.0)
    panels: Any = figure.subplots(1, 2)
    for axes, values, name in ((panels[0], motion.tip, "tip"), (panels[1], motion.rim, "rim under it")):
        micro = 1e6 * values
        late = slice(int((1.0 - LATE) * len(micro)), None)
        axes.plot(micro[:, 1], micro[:, 0], color=PERFECT, linewidth=0.4, label="whole run", rasterized=True)
        axes.plot(micro[late, 1], micro[late, 0], color=BEFORE, linewidth=0.6, label="last quarter", rasterized=True)
        axes.set(xlabel="along the rim [µm]", ylabel="along the normal, outwards [µm]", title=name)
        for limit, column in ((axes.set_xlim, micro[:, 1]), (axes.set_ylim, micro[:, 0])):
            low, high = float(column.min()), float(column.max())
            margin = 0.05 * (high - low) or 1e-6
            limit(low - margin, high + margin)
    panels[0].legend(fontsize=8)
    return figure


@styled
def figure_energy(ledger: Mapping[str, float], time: Array, strain: Mapping[str, Array]) -> Figure:
    """Where energy came from and went to over a run [J], and strain energy of each body over time."""
    figure = new_figure(8.2, 3.6 + 2.0 * bool(strain))
    rows: Any = figure.subplots(1 + bool(strain), 1, squeeze=False)[:, 0]
    names = list(ledger)
    values = np.array([ledger[name] for name in names])
    colours = [AFTER if value > 0.0 else BEFORE for value in values]
    rows[0].barh(names[::-1], values[::-1], color=colours[::-1])
    rows[0].axvline(0.0, color="#777777", linewidth=0.8)
    rows[0].set_xlabel("energy [J], into the bodies positive")
    for (name, energy), colour in zip(strain.items(), COLOURS, strict=False):
        rows[1].plot(time, energy, color=colour, linewidth=0.7, label=name, rasterized=True)
    if strain:
        top = max(float(energy.max(initial=0.0)) for energy in strain.values())
        rows[1].set(xlabel="time [s]", ylabel="strain energy [J]")
        if top > 0.0:
            rows[1].set(yscale="log", ylim=(1e-6 * top, 2.0 * top))
        rows[1].legend(fontsize=8)
    return figure
