"""Pictures of motion: marks in spectra, waves around the rim by nodal diameter, force over angle, Poincare sections."""

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, new_figure, styled

FLOOR = 60.0  # dB below the strongest wave that is shown
CELLS = 500  # of frequency in a map: the largest amplitude of each
LATE = 0.5  # of a run, from its end: waves are those of this part
COMMON = 20.0  # an orbit whose sides differ by less is drawn in one scale


class Mark(NamedTuple):
    """A frequency [Hz] with a short name, of a kind: "f_b" or "f_c"."""

    freq_hz: float
    name: str
    kind: str


LOOKS = {"f_b": (AFTER, "-", "blade alone, f_b"), "f_c": (GREEN, ":", "casing alone, f_c with its n")}


def mark_frequencies(axes: Any, marks: Sequence[Mark], top: float) -> None:
    """Lines at frequencies up to `top`, with names above the panel in enough rows to avoid overlap."""
    shown = sorted((mark for mark in marks if 0.0 < mark.freq_hz < top), key=lambda mark: mark.freq_hz)
    ends: list[float] = []
    for mark in shown:
        colour = LOOKS[mark.kind][0]
        width = (0.012 + 0.008 * len(mark.name)) * top
        row = next((k for k, end in enumerate(ends) if mark.freq_hz - 0.5 * width > end), len(ends))
        if row < 3:
            ends[row : row + 1] = [mark.freq_hz + 0.5 * width]
            axes.annotate(
                mark.name, (mark.freq_hz, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 1.5 + 8.5 * row),
                textcoords="offset points", ha="center", va="bottom", fontsize=7, color=colour, annotation_clip=False,
            )  # fmt: skip
    for kind in dict.fromkeys(mark.kind for mark in shown):
        colour, line, words = LOOKS[kind]
        places = [mark.freq_hz for mark in shown if mark.kind == kind]
        axes.vlines(
            places, 0.0, 1.0, transform=axes.get_xaxis_transform(), color=colour, linestyle=line, linewidth=0.8,
            label=words, zorder=1,
        )  # fmt: skip


class _Rim(Protocol):
    """Waves of a rim, a `contact.recovery.around_rim.RimMotion`."""

    @property
    def time(self) -> Array: ...

    @property
    def waves(self) -> Array: ...

    @property
    def with_blades(self) -> int: ...


def full_spectrum(rim: _Rim) -> tuple[Array, Array]:
    """Frequencies [Hz], positive with the blades, and amplitudes [m] (N + 1, lines) of the second half of a run.

    With a Hann window, a wave a cos(n theta - omega t) has the amplitude a at omega/2 pi, and a standing wave half of
    that at both signs. Means are removed.
    """
    late = rim.waves[int((1.0 - LATE) * len(rim.waves)) :]
    window = np.hanning(len(late))
    sign = rim.with_blades or 1
    found = np.fft.fft((late - late.mean(axis=0)) * window[:, None], axis=0) / (float(window.sum()) or 1.0)
    step = float(rim.time[-1] - rim.time[0]) / (len(rim.time) - 1)
    freq = sign * np.fft.fftfreq(len(late), step)
    order = np.argsort(freq, kind="stable")
    return freq[order], np.abs(found[order]).T


@styled
def figure_waves(rim: _Rim, pairs: Sequence[tuple[int, float]] = (), top_hz: float | None = None) -> Figure:
    """Amplitude of the rim's waves by nodal diameter and frequency, with the blades and against them.

    `pairs` (n, f_c) of the casing alone are marked at both signs. Right: the amplitude by nodal diameter in both
    directions, root of the sum of squares.
    """
    freq, amplitude = full_spectrum(rim)
    turning = bool(rim.with_blades)
    names = ("with the blades", "against the blades") if turning else ("towards +theta", "towards -theta")
    most = float(amplitude.max(initial=0.0))
    strong = np.abs(freq)[(amplitude > 1e-3 * most).any(axis=0)] if most > 0.0 else np.zeros(0)
    low = [f for _, f in pairs]
    known = max([float(strong.max(initial=0.0)), *sorted(low)[:1]])
    top = min(top_hz or np.inf, 1.15 * known or np.inf, float(np.abs(freq).max()))
    figure = new_figure(8.2, 4.6)
    axes, beside = figure.subplots(1, 2, sharey=True, width_ratios=(3.2, 1.0))
    kept = np.abs(freq) <= top
    at, shown = gathered(freq[kept], amplitude[:, kept], CELLS)
    seen = np.flatnonzero((amplitude > 1e-3 * most).any(axis=1))
    inside = [(order, f) for order, f in pairs if f <= top and order < len(amplitude)]
    last = max([*seen.tolist()[-1:], *(order for order, _ in inside)], default=len(amplitude) - 1)
    amplitude, shown = amplitude[: last + 1], shown[: last + 1]
    n = np.arange(last + 1)
    level = 20.0 * np.log10(np.maximum(shown / (most or 1.0), 1e-12))
    drawn = axes.pcolormesh(
        at, n, level, shading="nearest", rasterized=True, vmin=-FLOOR, vmax=0.0, cmap="Blues", edgecolors="none"
    )
    figure.colorbar(drawn, ax=[axes, beside], label=f"level [dB of {1e6 * most:.3g} µm]", extend="min", shrink=0.9)
    for sign in (1.0, -1.0):
        axes.plot([sign * f for _, f in inside], [order for order, _ in inside], "|", color=AFTER, markersize=9)
    axes.axvline(0.0, color="#777777", linewidth=0.6)
    axes.grid(visible=False)
    axes.set(
        xlabel="frequency in the casing's frame [Hz]", ylabel="nodal diameters n", xlim=(-top, top),
        ylim=(-0.5, len(n) - 0.5),
    )  # fmt: skip
    for side, words in (("left", f"\u2190 {names[1]}"), ("right", f"{names[0]} \u2192")):
        axes.set_title(words, loc=side, fontsize=8.5, fontweight="normal")
    axes.yaxis.get_major_locator().set_params(integer=True)
    for sign, colour, name in ((1, BEFORE, names[0]), (-1, AFTER, names[1])):
        part = np.sqrt((amplitude[:, np.sign(freq) == sign] ** 2).sum(axis=1))
        beside.barh(n + 0.2 * sign, 1e6 * part, height=0.4, color=colour, label=name)
    beside.set_xlabel("amplitude [µm]")
    beside.grid(visible=False, axis="y")
    if inside:
        axes.plot([], [], "|", color=AFTER, markersize=9, label="casing alone, f_c")
    figure.legend(loc="outside upper left", ncols=3, fontsize=8)
    return figure


def gathered(freq: Array, amplitude: Array, most: int) -> tuple[Array, Array]:
    """A limited number of columns: the largest amplitude of neighbours, at their middle.

    >>> gathered(np.arange(4.0), np.array([[1.0, 5.0, 2.0, 0.0]]), 2)[1].tolist()
    [[5.0, 2.0]]
    """
    if freq.size <= most:
        return freq, amplitude
    starts = np.unique(np.linspace(0, freq.size, most + 1).astype(int))[:-1]
    ends = np.append(starts[1:], freq.size) - 1
    return 0.5 * (freq[starts] + freq[ends]), np.maximum.reduceat(amplitude, starts, axis=1)


@styled
def figure_force_map(found: Any) -> Figure:
    """Largest contact force over angle on the casing and time, a `contact.recovery.around_rim.ForceMap`."""
    figure = new_figure(8.2, 3.6)
    axes: Any = figure.add_subplot()
    axes.set_facecolor("#eeeeee")
    top = float(np.nanmax(found.force)) if np.isfinite(found.force).any() else 0.0
    drawn = axes.pcolormesh(
        found.angle_deg, found.time, np.ma.masked_invalid(found.force), rasterized=True, cmap="magma_r", vmin=0.0,
        vmax=top or 1.0,
    )  # fmt: skip
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label="largest force of a tip [N]")
    axes.set(xlabel="angle on the casing [deg]", ylabel="time [s]", xlim=(0.0, 360.0))
    axes.set_xticks(range(0, 361, 45))
    return figure


@styled
def figure_section(found: Any) -> Figure:
    """Poincare section, a `contact.recovery.around_rim.Section`: displacement and velocity of a tip once per turn."""
    figure = new_figure(6.0, 4.0)
    axes: Any = figure.add_subplot()
    drawn = axes.scatter(
        1e6 * found.displacement, 1e3 * found.velocity, c=found.time, s=14.0, cmap="viridis", linewidths=0.0
    )
    figure.colorbar(drawn, ax=axes, label="time [s]")
    axes.margins(0.12)
    axes.set(xlabel="tip along the normal [µm]", ylabel="velocity [mm/s]")
    axes.plot([], [], " ", label=f"{len(found.time)} turns")
    figure.legend(loc="outside upper left", fontsize=8, handlelength=0.0, handletextpad=0.0)
    axes.ticklabel_format(useOffset=False)
    axes.axhline(0.0, color=PERFECT, linewidth=0.6, zorder=0)
    return figure
