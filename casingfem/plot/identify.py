"""Pictures of an identification: the stabilisation diagram, and fitted over measured responses."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.identify.identified import Identified
from casingfem.io.arrays import Array, FloatArray
from casingfem.plot.style import AFTER, BEFORE, GREEN, MEASURED, PERFECT, PURPLE, new_figure, styled

MODES_A_ROW, MOST_ROWS = 14, 4
CLUSTER = 0.015  # of the axis: modes closer than this share one label
LETTER = 0.0042  # of the axis: half the width of a letter


@styled
def figure_stabilisation(found: Identified) -> Figure:
    """Poles over model order, with marks for stable and chosen ones, and the measured data in the background.

    The background shows the singular values of the response matrix over its references (the complex mode indicator,
    Shih et al., Mech. Syst. Signal Process. 2, 1988, 367); with one reference this is the norm over the sensors.
    """
    values = indicator(found)
    ends = _row_ends(found)
    figure = new_figure(9.6, 1.2 + 2.5 * (len(ends) - 1))
    rows = figure.subplots(len(ends) - 1, 1, squeeze=False)[:, 0]
    diagram = found.diagram
    for axes, low, high in zip(rows, ends[:-1], ends[1:], strict=True):
        behind = axes.twinx()
        behind.set_zorder(axes.get_zorder() - 1)
        axes.patch.set_visible(False)
        inside = (found.lines >= low) & (found.lines <= high)
        for k, curve in enumerate(values):
            behind.semilogy(found.lines[inside], curve[inside], color=PERFECT, lw=1.0 - 0.3 * min(k, 2), alpha=0.8)
        behind.set_yticks([])
        behind.minorticks_off()
        behind.spines["left"].set_visible(False)
        for kept, style in ((~diagram.stable, _STYLES[0]), (diagram.stable, _STYLES[1])):
            here = kept & (diagram.freq >= low) & (diagram.freq <= high)
            axes.plot(diagram.freq[here], diagram.order[here], **style)
        _mark(axes, found, low, high)
        axes.set(xlim=(low, high), ylabel="model order")
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        axes.grid(visible=False)
    rows[-1].set_xlabel("frequency [Hz]")
    rows[0].set_title(f"Stabilisation: {len(found)} modes chosen automatically", pad=27)
    handles, labels = rows[0].get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside lower center", ncols=4)
    return figure


_STYLES: tuple[dict[str, object], ...] = (
    {"marker": "x", "ls": "", "ms": 3.0, "mew": 0.6, "color": BEFORE, "alpha": 0.45, "label": "pole"},
    {"marker": "o", "ls": "", "ms": 3.2, "color": GREEN, "label": "stable pole"},
)


@styled
def figure_responses(found: Identified, channel: int | None = None) -> Figure:
    """Measured and fitted response of one channel (by default the strongest) with the identified modes."""
    if channel is None:
        channel = int(np.argmax(np.linalg.norm(found.measured, axis=1)))
    figure = new_figure(9.6, 5.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    measured, fitted = found.measured[channel], found.fitted[channel]
    upper.semilogy(found.lines, np.abs(measured), color=MEASURED, lw=0.9, label="measured")
    upper.semilogy(found.lines, np.abs(fitted), color=AFTER, lw=1.3, ls="--", label="fitted")
    lower.plot(found.lines, _phase(measured), color=MEASURED, lw=0.7)
    lower.plot(found.lines, _phase(fitted), color=AFTER, lw=1.0, ls="--")
    lower.set(ylim=(-280.0, 100.0), yticks=[-270, -180, -90, 0, 90])
    _mark(upper, found, float(found.lines[0]), float(found.lines[-1]))
    sensor, force = np.argwhere(found.sensors.channels == channel)[0].tolist()
    point, reference = int(found.sensors.points[sensor]), int(found.sensors.references[force, 0])
    upper.set_title(f"Response at point {point} to a force at point {reference}", pad=27)
    upper.set_ylabel("magnitude\n[unit of the responses]")
    lower.set(ylabel="phase [deg]", xlabel="frequency [Hz]", xlim=(found.lines[0], found.lines[-1]))
    figure.legend(handles=upper.lines[:2], loc="outside upper left", ncols=2, fontsize=8)
    return figure


@styled
def figure_fit(found: Identified, coherence: FrfSet | None = None) -> Figure:
    """All lines: mode indicator with sure and doubtful modes, rms of measured, fitted and residual, coherence."""
    figure = new_figure(9.6, 6.4 if coherence is None else 7.4)
    panels = 2 if coherence is None else 3
    rows = figure.subplots(panels, 1, sharex=True, height_ratios=(3, 3, 1)[:panels])
    for k, curve in enumerate(indicator(found)):
        rows[0].semilogy(found.lines, curve, color=MEASURED, lw=0.9 - 0.3 * min(k, 2), alpha=1.0 - 0.3 * min(k, 2))
    for freq, sure in zip(found.freq.tolist(), found.sure.tolist(), strict=True):
        colour, style, label = (AFTER, "-", "sure mode") if sure else (PURPLE, "--", "doubtful mode")
        rows[0].axvline(freq, color=colour, ls=style, lw=0.8, alpha=0.8, label=label)
    handles, labels = rows[0].get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    if unique:
        _legend_above(rows[0], list(unique.values()), list(unique))
    rows[0].set_ylabel("mode indicator\n[unit of the responses]")
    rows[0].set_title(f"Modes: {int(found.sure.sum())} sure, {int(np.sum(~found.sure))} doubtful", loc="right")
    parts = (("measured", found.measured, MEASURED), ("fitted", found.fitted, AFTER))
    for label, values, colour in (*parts, ("residual", found.measured - found.fitted, BEFORE)):
        rows[1].semilogy(found.lines, np.sqrt(np.mean(np.abs(values) ** 2, axis=0)), color=colour, lw=0.9, label=label)
    channels = len(found.measured)
    rows[1].set_ylabel(f"rms of {channels} channel{'s' * (channels > 1)}\n[unit of the responses]")
    _legend_above(rows[1], *rows[1].get_legend_handles_labels())
    if coherence is not None:
        kept = (coherence.x >= found.lines[0]) & (coherence.x <= found.lines[-1])
        rows[2].plot(coherence.x[kept], coherence.responses.real.min(axis=0)[kept], color=BEFORE, lw=0.6)
        rows[2].set(ylim=(0.0, 1.05), ylabel="coherence\n(least) [-]")
    rows[-1].set(xlabel="frequency [Hz]", xlim=(found.lines[0], found.lines[-1]))
    return figure


def _legend_above(axes: Axes, handles: Sequence[Any], names: Sequence[str]) -> None:
    """A legend in one line above a panel, at its left."""
    axes.legend(handles, names, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, fontsize=8, borderaxespad=0.1)


def _phase(values: Array) -> FloatArray:
    """Phase [deg] from -270 to 90, so that noise about 0 and -180, where real modes are, does not jump."""
    return np.asarray(np.mod(np.degrees(np.angle(values)) + 270.0, 360.0) - 270.0)


def indicator(found: Identified) -> FloatArray:
    """Singular values of the responses (sensors, references) at each line, (references, lines), largest first."""
    matrix: Array = found.measured[found.sensors.channels].transpose(2, 0, 1)
    return np.asarray(np.linalg.svd(matrix, compute_uv=False).T)


def _row_ends(found: Identified) -> list[float]:
    """Frequencies between rows of about equally many modes, in the widest gaps nearby."""
    first, last = float(found.lines[0]), float(found.lines[-1])
    rows = min(max(-(-len(found) // MODES_A_ROW), 1), MOST_ROWS)
    cuts = []
    for row in range(1, rows):
        middle = row * len(found) // rows
        near = range(max(middle - 2, 1), min(middle + 3, len(found)))
        best = max(near, key=lambda k: found.freq[k] - found.freq[k - 1])
        cuts.append(0.5 * float(found.freq[best] + found.freq[best - 1]))
    return [first, *cuts, last]


def _mark(axes: Axes, found: Identified, low: float, high: float) -> None:
    """Identified modes as lines, dashed for unresolved pairs; the n of each cluster above it."""
    clusters: list[list[int]] = []
    for k in np.flatnonzero((found.freq >= low) & (found.freq <= high)).tolist():
        whole = k in found.unresolved
        colour, label = (PURPLE, "pair, not distinguished") if whole else (AFTER, "mode")
        axes.axvline(found.freq[k], color=colour, lw=0.9, ls="--" if whole else "-", alpha=0.8, label=label)
        if clusters and found.freq[k] - found.freq[clusters[-1][0]] < CLUSTER * (high - low):
            clusters[-1].append(k)
        else:
            clusters.append([k])
    ends = [-np.inf] * 2
    for cluster in clusters:
        text = " ".join(str(n) for n in dict.fromkeys(found.n[cluster].tolist()) if n >= 0)
        place = float(found.freq[cluster].mean()), 1.0
        half = LETTER * (len(text) + 1) * (high - low)
        row = next((k for k, end in enumerate(ends) if place[0] - half > end), None)
        if row is None:
            continue
        ends[row] = place[0] + half
        axes.annotate(
            text, place, (0, 3 + 9 * row), xycoords=axes.get_xaxis_transform(), textcoords="offset points", ha="center",
            fontsize=8, color=AFTER,
        )  # fmt: skip
