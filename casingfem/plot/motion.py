"""Pictures of a run: spectrum and waterfall, orbit of a tip and of the rim at the tip, energies."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from casingfem.io.arrays import Array
from casingfem.plot.history import BINS, envelope, time_unit
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, PURPLE, SKY, new_figure, styled
from casingfem.plot.thousands import in_thousands, shown_factor
from casingfem.plot.ticks import Powers, label_decades
from casingfem.plot.waves import COMMON, Mark, mark_frequencies

SLICES, LEAST, FLOOR = 64, 256, 60.0  # of time in a waterfall, samples in each; dB below the loudest that is shown
QUIET = 1e-3  # of the largest amplitude: a spectrum ends a quarter beyond its last line above it
SMALL = 1e-4  # of the largest energy: less is no bar that one sees
LATE = 0.25  # of a run, from its end: the orbit and the spectrum at the end
COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)


class _Orbit(Protocol):
    """Motion of a tip and of the rim at the tip, along normal and rim [m], (ns, 2), at times [s], (ns,)."""

    @property
    def time(self) -> Array: ...

    @property
    def tip(self) -> Array: ...

    @property
    def rim(self) -> Array: ...


@styled
def figure_spectrum(
    time: Array, values: Array, *, label: str, unit: str, top_hz: float | None = None, marks: Sequence[Mark] = (),
    turn_hz: float = 0.0, waterfall: bool = True,
) -> Figure:  # fmt: skip
    """Amplitude spectrum over the whole run and at its end; below, a waterfall over time.

    `values` at equal steps of `time` [s]; frequencies up to `top_hz`, or to where the amplitude has fallen to QUIET of
    the largest. `marks` are above the spectrum; for a structure that rotates at `turn_hz` the axis also shows engine
    orders. Colours are decibels below the loudest slice, over a range of FLOOR.
    """
    figure = new_figure(8.2, 5.6 if waterfall else 3.0)
    panels: Any = figure.subplots(1 + waterfall, 1, height_ratios=(1.0, 1.2)[: 1 + waterfall], squeeze=False)[:, 0]
    upper = panels[0]
    step = float(np.diff(time).mean()) if time.size > 1 else 1.0
    late = values[int((1.0 - LATE) * values.size) :]
    whole = spectrum(values, step)
    top = min(top_hz or np.inf, 0.5 / step, heard(*whole, [mark.freq_hz for mark in marks]))
    for (freq, amplitude), colour, words in (
        (whole, PERFECT, "whole run"), (spectrum(late, step), BEFORE, "last quarter"),
    ):  # fmt: skip
        shown = (freq > 0.0) & (freq <= top)
        if shown.any() and amplitude[shown].max() > 0.0:
            upper.semilogy(freq[shown], np.maximum(amplitude[shown], 1e-300), color=colour, linewidth=0.8, label=words)
    largest = max((float(line.get_ydata().max()) for line in upper.lines), default=1.0)
    upper.set(xlabel="frequency [Hz]", ylabel=f"{label} [{unit}]", xlim=(0.0, top))
    in_thousands(upper.xaxis)
    if largest > 0.0:
        upper.set_ylim(1e-5 * largest, 2.0 * largest)
        label_decades(upper.yaxis)
    mark_frequencies(upper, marks, top)
    if turn_hz > 0.0:
        orders = np.array(MaxNLocator(9, steps=[1, 2, 5, 10]).tick_values(0.0, top / turn_hz))
        scale = shown_factor(upper.xaxis)
        labels = [f"{scale * order * turn_hz:.4g}\n{order:g}" for order in orders]
        upper.set_xticks(orders * turn_hz, labels)
        upper.set_xlim(0.0, top)
        upper.set_xlabel(f"{upper.get_xlabel()}\nengine order, frequency over speed [-]")
    if upper.lines:
        figure.legend(*upper.get_legend_handles_labels(), loc="outside upper left", ncols=4, fontsize=8)
    if waterfall:
        _waterfall(figure, panels[1], time, values, step, top)
    return figure


def heard(freq: Array, amplitude: Array, marks: Sequence[float]) -> float:
    """Upper limit of a spectrum [Hz]: a quarter beyond the last line above QUIET of the largest, and three marks.

    >>> heard(np.array([0.0, 10.0, 20.0, 30.0]), np.array([0.0, 1.0, 0.5, 1e-5]), [4.0])
    25.0
    """
    if not amplitude.size or not amplitude.max() > 0.0:
        return float(freq[-1]) if freq.size else 1.0
    last = float(freq[amplitude > QUIET * amplitude.max()][-1])
    return 1.25 * max(last, *sorted(marks)[:3], float(freq[min(8, freq.size - 1)]) if freq.size > 8 else 0.0)


def spectrum(values: Array, step: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and amplitudes with a Hann window: 1 for a sine of amplitude 1 on a line or between two lines.

    >>> freq, a = spectrum(np.sin(2.0 * np.pi * 50.0 * 1e-3 * np.arange(1000)), 1e-3)
    >>> float(freq[a.argmax()]), round(float(a.max()), 3)
    (50.0, 1.0)
    """
    window = np.hanning(values.size)
    weight = float(window.sum()) or 1.0
    return np.fft.rfftfreq(values.size, step), np.abs(np.fft.rfft((values - values.mean()) * window)) * 2.0 / weight


def waterfall(values: Array, step: float) -> tuple[Array, Array, Array]:
    """Starts of slices [samples], frequencies [Hz], amplitudes (slices, frequencies); None for too short a record."""
    size = max(LEAST, 2 * values.size // SLICES)
    if values.size < size:
        return np.zeros(0), np.zeros(0), np.zeros((0, 0))
    starts = np.unique(np.linspace(0, values.size - size, SLICES).astype(int))
    slices = [spectrum(values[i : i + size], step) for i in starts]
    return starts.astype(float), slices[0][0], np.array([amplitude for _, amplitude in slices])


def _waterfall(figure: Figure, axes: Any, time: Array, values: Array, step: float, top: float) -> None:
    starts, freq, amplitude = waterfall(values, step)
    scale, name = time_unit(float(time[-1] - time[0]) if time.size else 1.0)
    axes.set(xlabel=f"time [{name}]", ylabel="frequency [Hz]")
    if len(starts) < 2 or not amplitude.max() > 0.0:
        axes.text(0.5, 0.5, "the record is too short for a spectrogram", transform=axes.transAxes, ha="center")
        return
    shown = freq <= top
    level = 20.0 * np.log10(np.maximum(amplitude[:, shown] / amplitude.max(), 1e-12))
    middle = scale * (float(time[0]) + step * (starts + 0.5 * (values.size - starts[-1])))
    drawn = axes.pcolormesh(
        middle, freq[shown], level.T, shading="nearest", rasterized=True, vmin=-FLOOR, vmax=0.0, cmap="magma"
    )
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label="level [dB re maximum]", extend="min")


@styled
def figure_orbit(motion: _Orbit) -> Figure:
    """Orbit of a tip, and of the rim at the tip, in the contact plane: the whole run with its peaks, its end on top."""
    figure = new_figure(8.2, 4.0)
    panels: Any = figure.subplots(1, 2)
    for axes, values, name in ((panels[0], motion.tip, "tip"), (panels[1], motion.rim, "rim under it")):
        micro = 1e6 * values
        late = slice(int((1.0 - LATE) * len(micro)), None)
        axes.plot(micro[:, 1], micro[:, 0], color=PERFECT, linewidth=0.4, label="whole run", rasterized=True)
        axes.plot(micro[late, 1], micro[late, 0], color=BEFORE, linewidth=0.6, label="last quarter", rasterized=True)
        axes.set(xlabel="along the rim [µm]", ylabel="along the normal, outwards [µm]", title=name)
        _whole(axes, micro)
        axes.xaxis.set_major_locator(MaxNLocator(5))
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=2, fontsize=8)
    return figure


def _whole(axes: Any, points: Array) -> None:
    """Limits of all points (n, 2), with one scale for both axes if their ranges are similar."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.maximum(high - low, 1e-9)
    middle = 0.5 * (low + high)
    if size.max() < COMMON * size.min():
        size = np.full(2, size.max())
        axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(middle[1] - 0.55 * size[1], middle[1] + 0.55 * size[1])
    axes.set_ylim(middle[0] - 0.55 * size[0], middle[0] + 0.55 * size[0])


@styled
def figure_energy(ledger: Mapping[str, float], time: Array, strain: Mapping[str, Array]) -> Figure:
    """Sources and sinks of energy over a run [J], and strain energy of each body over time.

    Sources below SMALL of the largest are omitted.
    """
    figure = new_figure(8.2, 2.6 + 2.4 * bool(strain))
    rows: Any = figure.subplots(1 + bool(strain), 1, squeeze=False)[:, 0]
    largest = max(map(abs, ledger.values()), default=0.0)
    names = [name for name, value in ledger.items() if abs(value) > SMALL * largest] or list(ledger)
    values = np.array([ledger[name] for name in names])
    rows[0].barh(names[::-1], values[::-1], color=PERFECT)  # the colours below are those of the bodies
    rows[0].axvline(0.0, color="#777777", linewidth=0.8)
    rows[0].set_xlabel("energy into the bodies [J]")
    rows[0].xaxis.set_major_formatter(Powers(-3, 4))
    for (name, energy), colour in zip(strain.items(), COLOURS, strict=False):
        if len(energy) <= 2 * BINS:
            rows[1].plot(time, energy, color=colour, linewidth=0.8, label=name)
        else:
            at, low, high = envelope(time, energy, BINS)
            rows[1].fill_between(at, np.maximum(low, 1e-300), high, color=colour, alpha=0.25, linewidth=0.0)
            rows[1].plot(at, high, color=colour, linewidth=0.9, label=name)
    if strain:
        top = max(float(energy.max(initial=0.0)) for energy in strain.values())
        rows[1].set(xlabel="time [s]", ylabel="strain energy [J]")
        if top > 0.0:
            rows[1].set(yscale="log", ylim=(1e-6 * top, 2.0 * top))
            label_decades(rows[1].yaxis)
        figure.legend(*rows[1].get_legend_handles_labels(), loc="outside upper right", ncols=4, fontsize=8)
    return figure
