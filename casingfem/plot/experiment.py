"""Measurements: frequency responses with marked lines, the spectrum of a circle scan, deflections around."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from numpy.typing import ArrayLike
from scipy.signal.windows import hann

from casingfem.experiment.circle.record import ScanRecord
from casingfem.experiment.circle.scan import SEEN, CircleScan
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.plot.style import AFTER, BEFORE, GREEN, MEASURED, PERFECT, PURPLE, SKY, new_figure, styled

FULL_TURN = np.linspace(0.0, 2.0 * np.pi, 721)
COLOURS = (AFTER, BEFORE, GREEN, PURPLE, SKY)
RADIUS = 1.0, 0.45  # of the circle, and of the largest deflection drawn on it
FLOOR = 1e-5  # of the highest line: below it nothing is drawn


def say_synthetic(figure: Figure, card: Sequence[str]) -> None:
    """Write SYNTHETIC into the corner of a picture of simulated data."""
    if card and card[0].startswith("SYNTHETIC"):
        figure.text(0.995, 0.005, "SYNTHETIC", ha="right", va="bottom", fontsize=7, color=AFTER)


@styled
def figure_responses(
    frfs: FrfSet, *, marks: ArrayLike = (), labels: Sequence[str] = (), coherence: FrfSet | None = None
) -> Figure:
    """All channels in grey, their rms in black; the frequencies `marks` [Hz] are lines with `labels` above."""
    figure = new_figure(height=4.2 if coherence is None else 5.4)
    grid = figure.add_gridspec(1 if coherence is None else 2, 1, height_ratios=[4, 1][: 1 if coherence is None else 2])
    axes = figure.add_subplot(grid[0])
    size = np.abs(frfs.responses)
    axes.semilogy(frfs.x, size.T, color=PERFECT, linewidth=0.4, alpha=0.35)
    axes.semilogy(frfs.x, np.sqrt(np.mean(size**2, axis=0)), color=MEASURED, label=f"rms of {len(frfs)} channels")
    at = np.atleast_1d(np.asarray(marks, float))
    at = at[(at >= frfs.x[0]) & (at <= frfs.x[-1])]
    for freq in at.tolist():
        axes.axvline(freq, color=AFTER, linewidth=0.7, alpha=0.8)
    if len(labels) == len(at):
        for freq, label in zip(at.tolist(), labels, strict=True):
            axes.text(freq, 1.0, label, transform=axes.get_xaxis_transform(), fontsize=6.5, rotation=90, va="bottom")
    else:
        axes.set_title("Frequency responses")
    axes.set(ylabel=f"|H| [{frfs.unit}]", xlim=(frfs.x[0], frfs.x[-1]))
    figure.legend(loc="outside upper right")
    if coherence is not None:
        below = figure.add_subplot(grid[1], sharex=axes)
        below.plot(coherence.x, coherence.responses.real.min(axis=0), color=BEFORE, linewidth=0.6)
        below.set(ylim=(0.0, 1.05), ylabel="coherence\n(least) [-]")
        axes = below
    axes.set_xlabel("frequency [Hz]")
    say_synthetic(figure, frfs.card)
    return figure


@styled
def figure_scan(record: ScanRecord, found: CircleScan) -> Figure:
    """Spectrum of a scan around its tones (Hann window), and the fitted lines w +- nW above the noise."""
    figure = new_figure()
    axes = figure.add_subplot()
    count = len(record.velocity)
    spectrum = 4.0 * np.abs(np.fft.rfft(record.velocity * hann(count, sym=False))) / count
    freq = np.fft.rfftfreq(count, 1.0 / record.fs)
    lines, size = found.lines, np.abs(found.V)
    if record.force is not None:
        size = size * (spectrum.max() / max(float(size.max()), 1e-300))
    scaled = "" if record.force is None else ", scaled to the spectrum"
    there = np.abs(found.V) > SEEN * found.sigma
    reach = 1.5 * abs(found.rate)
    shown = (freq >= lines.min() - reach) & (freq <= lines.max() + reach)
    axes.semilogy(freq[shown], spectrum[shown], color=PERFECT, linewidth=0.7, label="spectrum, Hann window")
    for k, tone in enumerate(found.tones.tolist()):
        own = there[k]
        colour = COLOURS[k % len(COLOURS)]
        label = f"lines of {tone:.2f} Hz{scaled}" if len(found.tones) <= len(COLOURS) else None
        axes.plot(lines[k, own], size[k, own], "o", color=colour, markersize=4.5, label=label)
        for order, at, height in zip(found.n[own].tolist(), lines[k, own], size[k, own], strict=True):
            if height > 0.05 * size.max():
                axes.annotate(
                    f"{order:+d}", (at, height), xytext=(0, 5), textcoords="offset points", ha="center", fontsize=7
                )
    highest = max(float(spectrum[shown].max()), float(size.max()))
    axes.set_ylim(FLOOR * highest, 3.0 * highest)
    axes.set(xlabel="frequency [Hz]", ylabel="velocity [m/s]")
    axes.set_title(f"Circle scan at {60.0 * found.rate:.3g} rpm (W = {found.rate:.3g} Hz): lines at f + n W")
    figure.legend(loc="outside upper left", ncols=3)
    say_synthetic(figure, record.card)
    return figure


@styled
def figure_deflections(found: CircleScan, waves: Sequence[tuple[int, int]]) -> Figure:
    """Deflections around the circle of (tone, n): the real part at its maximum, the envelope, the antinodes."""
    columns = min(len(waves), 4)
    rows = -(-len(waves) // max(columns, 1))
    figure = new_figure(2.6 * columns, 2.9 * rows)
    for place, (tone, n) in enumerate(waves):
        axes = figure.add_subplot(rows, columns, place + 1, projection="polar")
        assert isinstance(axes, PolarAxes)
        wave = found.wave(tone, n)
        own = np.abs(found.n) == n
        V = np.exp(1j * np.multiply.outer(FULL_TURN, found.n[own])) @ found.V[tone, own]
        V = V * np.exp(-1j * np.radians(wave.phase_deg)) / max(wave.amplitude, 1e-300)
        axes.plot(FULL_TURN, np.full_like(FULL_TURN, RADIUS[0]), color=PERFECT, linewidth=0.8)
        axes.fill_between(FULL_TURN, RADIUS[0] - RADIUS[1] * np.abs(V), RADIUS[0] + RADIUS[1] * np.abs(V), color=SKY,
                          alpha=0.25, linewidth=0)  # fmt: skip
        axes.plot(FULL_TURN, RADIUS[0] + RADIUS[1] * V.real, color=AFTER)
        if n > 0:
            antinodes = np.radians(wave.angle_deg) + 2.0 * np.pi / n * np.arange(n)
            axes.plot(antinodes, np.full(n, RADIUS[0] + 1.1 * RADIUS[1]), ".", color=MEASURED, markersize=3)
        axes.set(ylim=(0.0, 1.6), yticks=[], xticks=np.radians([0.0, 90.0, 180.0, 270.0]))
        angle = "" if n == 0 else f", {wave.angle_deg:.1f} deg"
        axes.set_title(f"{wave.tone:.1f} Hz, n = {n}{angle}\ntravelling {wave.travelling:+.2f}", fontsize=8)
    say_synthetic(figure, found.card)
    return figure
