"""Pictures of coincidences: Campbell diagram in the blade's frame, and frequency over nodal diameters at one speed."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, GREEN, MEASURED, PERFECT, PURPLE, SKY, new_figure, rpm_above, styled
from casingfem.plot.ticks import label_decades

if TYPE_CHECKING:  # pages of contact draw its table without the modes of structures
    from casingfem.modal.campbell import Campbell
    from casingfem.modal.interaction import DiskFrequencies, Interactions

MARKS: dict[str, dict[str, Any]] = {
    "unstable": {"color": AFTER, "marker": "^", "linestyle": "", "markersize": 5.0},
    "not decided": {"color": PERFECT, "marker": "x", "linestyle": "", "markersize": 4.5},
    "resonance": {"color": PURPLE, "marker": "s", "linestyle": "", "markersize": 4.0},
    "safe": {"color": GREEN, "marker": "o", "linestyle": "", "markersize": 3.5},
}
Blade: TypeAlias = "Sequence[float] | FloatArray | Campbell | DiskFrequencies"


@styled
def figure_campbell(found: "Interactions", blade: Blade, *, orders: int = 8) -> Figure:
    """Campbell diagram of a blade: waves |f_c -+ n f|, the blade's modes, engine orders; filled: contact excites."""
    from casingfem.modal.interaction import blade_over_speed, wave_hz

    figure = new_figure(7.6, 4.8)
    axes: Any = figure.add_subplot()
    speed = np.linspace(*found.speed_hz, 400)
    blades = (float(blade_over_speed(blade, n, *found.speed_hz)[1].max(initial=1.0)) for n, _, _ in found.pairs)
    top = 1.35 * max([c.blade_hz for c in found.meetings] or blades)
    _engine_orders(axes, speed, top, orders)
    met = {(c.n, c.m) for c in found.meetings}
    for n, m, freq in found.pairs:
        if (n, m) in met:
            slow, fast = (wave_hz(n, freq, speed, found.turning, sense) for sense in (-1, 1))
            axes.plot(speed, np.abs(slow - n * speed), color=SKY, linewidth=0.9, zorder=2)
            axes.plot(speed, fast + n * speed, color=SKY, linewidth=0.9, linestyle="--", zorder=2)
    for n in dict.fromkeys(n for n, _, _ in found.pairs):
        at, freq_b = blade_over_speed(blade, n, *found.speed_hz)
        axes.plot(at, freq_b, color=BEFORE, zorder=3)
    _mark(axes, found)
    for label, style in (("casing mode at the blade, |f_c - n f|", "-"), ("f_c + n f", "--")):
        axes.plot([], [], color=SKY, linestyle=style, label=label)
    axes.plot([], [], color=BEFORE, label="blade")
    axes.plot([], [], color=PERFECT, linestyle=":", linewidth=0.8, label="engine orders")
    axes.set(xlim=found.speed_hz, ylim=(0.0, top), xlabel="speed f [Hz]", ylabel="frequency at the blade [Hz]")
    figure.legend(loc="outside upper left", ncols=3)
    return figure


@styled
def figure_zzenf(found: "Interactions", blade: Blade, speed_hz: float) -> Figure:
    """Frequency over nodal diameters at one speed: casing, blade, and the lines n f - f_c and f_c -+ n f.

    Left (SAFE) nodal diameters of the casing; for a bladed disk of N blades also (ZZENF) the line n f folded at N/2.
    """
    from casingfem.modal.interaction import DiskFrequencies

    disk = isinstance(blade, DiskFrequencies)
    figure = new_figure(8.6 if disk else 7.6, 4.4)
    panels: Any = figure.subplots(1, 2 if disk else 1, squeeze=False)[0]
    _safe(panels[0], found, blade, speed_hz)
    if isinstance(blade, DiskFrequencies):
        _zigzag(panels[1], found, blade, speed_hz)
    figure.legend(loc="outside upper left", ncols=3)
    return figure


def _mark(axes: Any, found: "Interactions") -> None:
    """Coincidences: filled for the sum, hollow for the differences, with their n."""
    for filled, label in ((True, "f_c + f_b = n f: flutter"), (False, "difference: resonance")):
        shown = [c for c in found.meetings if (c.branch == "sum") is filled]
        face = AFTER if filled else "white"
        x, y = [c.speed_hz for c in shown], [c.blade_hz for c in shown]
        axes.plot(x, y, "o", color=AFTER, markerfacecolor=face, markersize=6, label=label, zorder=4)
    below, level = -np.inf, 0
    for c in found.meetings:  # by speed: labels that would overlap are stacked
        level = level + 1 if c.speed_hz - below < 0.06 * np.ptp(found.speed_hz) else 0
        below, place = c.speed_hz, (c.speed_hz, c.blade_hz)
        axes.annotate(
            f"n = {c.n}", place, textcoords="offset points", xytext=(3, 5 + 9 * level), fontsize=7, zorder=5,
        )  # fmt: skip


def _safe(axes: Any, found: "Interactions", blade: Blade, speed_hz: float) -> None:
    """Casing modes and the blade frequencies that would coincide, over n."""
    from casingfem.modal.interaction import blade_over_speed, wave_hz

    n = np.array([n for n, _, _ in found.pairs])
    at = np.array([speed_hz])
    f_c = np.array([float(wave_hz(n, freq, at, found.turning, -1)[0]) for n, _, freq in found.pairs])
    axes.plot(n, f_c, "o", color=MEASURED, markersize=4, label="casing f_c")
    axes.plot([0, n.max()], [0.0, n.max() * speed_hz], color=PERFECT, linestyle=":", label="order n: n f")
    fast = n * speed_hz > f_c
    axes.plot(n[fast], (n * speed_hz - f_c)[fast], "^", color=AFTER, ms=6, label="blade that flutters, n f - f_c")
    axes.plot(
        n[~fast], (f_c - n * speed_hz)[~fast], "v", mfc="white", color=AFTER, label="blade in resonance, f_c - n f"
    )
    for order in dict.fromkeys(n.tolist()):
        at, freq = blade_over_speed(blade, order, *found.speed_hz)
        now = np.array([np.interp(speed_hz, at, column) for column in freq.T])
        axes.hlines(now, order - 0.4, order + 0.4, color=BEFORE, label="blade f_b" if order == n[0] else None)
    axes.set(xlabel="nodal diameters n of the casing", ylabel="frequency [Hz]", title=f"f = {speed_hz:g} Hz")
    axes.set_ylim(bottom=0.0)
    axes.xaxis.get_major_locator().set_params(integer=True)


def _zigzag(axes: Any, found: "Interactions", disk: "DiskFrequencies", speed_hz: float) -> None:
    """The disk's families, and the line n f folded at half the number of blades."""
    most = max(n for n, _, _ in found.pairs)
    order = np.arange(most + 1)
    axes.plot([disk.folded(int(n)) for n in order], order * speed_hz, color=PERFECT, linestyle=":")
    families = [(k, freq) for k, values in sorted(disk.freq.items()) for freq in values]
    axes.plot(*zip(*families, strict=True), "s", color=BEFORE, markersize=4, label="disk f_b")
    for n, _, freq in found.pairs:
        wanted = n * speed_hz - freq
        if wanted > 0.0:
            axes.plot(disk.folded(n), wanted, "^", color=AFTER, markersize=6)
    axes.set(xlabel=f"nodal diameters of the disk, {disk.blades} blades", title="folded (ZZENF)", ylim=(0.0, None))
    axes.xaxis.get_major_locator().set_params(integer=True)


@styled
def figure_speeds(found: "Campbell", *, orders: int = 8) -> Figure:
    """A structure's frequencies over speed with engine orders, and dots at their crossings."""
    figure = new_figure(7.6, 4.6)
    axes: Any = figure.add_subplot()
    top = 1.15 * float(found.freq.max())
    _engine_orders(axes, found.speed_hz, top, orders)
    for column in found.freq.T:
        axes.plot(found.speed_hz, column, color=BEFORE)
    beside_ends(axes, [(f"mode {k}", float(column[-1])) for k, column in enumerate(found.freq.T, 1)], top)
    for order in range(1, orders + 1):
        for _, at in found.crossings(order):
            axes.plot(at, order * at, "o", color=AFTER, markersize=5)
    axes.plot([], [], color=BEFORE, label="mode")
    axes.plot([], [], "o", color=AFTER, markersize=5, label="engine order coincides with a mode")
    axes.plot([], [], color=PERFECT, linestyle=":", linewidth=0.8, label="engine orders")
    axes.set(xlabel="speed [Hz]", ylabel="frequency in the rotating frame [Hz]", ylim=(0.0, top))
    axes.set_xlim(float(found.speed_hz[0]), float(found.speed_hz[-1]))
    rpm_above(axes)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return figure


def beside_ends(axes: Any, ends: Sequence[tuple[str, float]], top: float) -> None:
    """Names right of the panel at the ends of their curves; of overlapping names only the first is kept."""
    low = -np.inf
    for name, height in sorted(ends, key=lambda end: end[1]):
        if height < top and height - low > 0.035 * top:
            axes.annotate(
                name, (1.0, height), xycoords=("axes fraction", "data"), xytext=(3, 0), textcoords="offset points",
                fontsize=7.5, color=BEFORE, va="center", annotation_clip=False,
            )  # fmt: skip
            low = height


def _engine_orders(axes: Any, speed: FloatArray, top: float, orders: int) -> None:
    """Lines n f with their n at the end, where the numbers do not overlap."""
    last = (-np.inf, -np.inf)
    for order in range(orders, 0, -1):
        axes.plot(speed, order * speed, color=PERFECT, linewidth=0.6, linestyle=":", zorder=1)
        edge = min(float(speed[-1]), top / order)
        place = (edge / float(np.ptp(speed) or 1.0), order * edge / top)
        if abs(place[0] - last[0]) > 0.025 or abs(place[1] - last[1]) > 0.05:
            axes.annotate(
                f"{order}", (edge, order * edge), fontsize=7, color="#666666", ha="right", va="top",
                xytext=(-2, -1), textcoords="offset points",
            )  # fmt: skip
            last = place


@styled
def figure_stability(found: Any) -> Figure:
    """Growth of a closed contact over speed, a `contact.stability.StabilityMap`, with shaded unstable bands."""
    figure = new_figure(7.6, 3.6)
    axes: Any = figure.add_subplot()
    _growth(axes, found)
    axes.set_xlabel("speed [Hz]")
    rpm_above(axes)
    return figure


@styled
def figure_interactions(found: Any, *, orders: int = 8) -> Figure:
    """The table of dangerous speeds: Campbell diagram in the blade's frame, growth and amplitude over speed.

    `found` is the result of `contact.interactions`. Only the unstable ranges of the table are shaded. A row that closed
    contact proposed is marked at the frequency of its pole, with its nodal diameters.
    """
    runs = len(found.runs) > 0
    figure = new_figure(8.2, 7.4 if runs else 6.0)
    ratios = (2.4, 1.0, 0.8) if runs else (2.4, 1.0)
    upper, lower, *rest = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    peaks, growth = found.peaks, found.peaks.map
    speed = growth.speed_hz
    marked = [row for row in found.rows if row.peak is not None]
    top = 1.35 * max([*(row.peak.freq_hz for row in marked), float(min(peaks.blade_hz, default=1.0))])
    if peaks.rotor:
        top = 1.1 * max(float(speed[-1]), float(np.min(peaks.wave_hz, initial=np.inf, axis=0)[:4].max(initial=0.0)))
    _engine_orders(upper, speed, top, 1 if peaks.rotor else orders)
    for wave in peaks.wave_hz.T:
        if wave.min() < top:
            upper.plot(speed, wave, color=SKY, linewidth=0.6, zorder=2)
    for freq in peaks.blade_hz:
        if freq < top:
            upper.axhline(freq, color=BEFORE, linewidth=0.8, zorder=2)
    for row in marked:
        upper.plot(row.at.speed_hz, row.peak.freq_hz, **MARKS[row.at.verdict], zorder=4)
    upper.set(ylim=(0.0, top), ylabel="whirl frequency [Hz]" if peaks.rotor else "frequency at the blade [Hz]")
    lower.axhline(0.0, color="#777777", linewidth=0.8)
    lower.plot(growth.seen_hz, growth.seen_growth, color=BEFORE, linewidth=1.0)
    lower.set_ylabel("growth [1/s]")
    for run in found.runs:
        lower.plot(run.speed_hz, run.growth, **MARKS[run.verdict], zorder=4)
        rest[0].plot(run.speed_hz, 1e3 * run.shown_m, **MARKS[run.verdict])
    for row in found.rows:
        if row.at.verdict == "unstable":
            for axes in (upper, lower, *rest):
                axes.axvspan(row.from_hz, row.to_hz, color=AFTER, alpha=0.12, linewidth=0.0)
    touched = any(run.amplitude_m > 0.0 for run in found.runs)
    for axes in rest:
        axes.set(yscale="log" if touched else "linear", ylabel="disk [mm]" if peaks.rotor else "rim [mm]")
        if touched:
            label_decades(axes.yaxis)
    names = (
        ("whirl", "growth without contact") if peaks.rotor else ("|f_c - n f|", "blade alone; growth of closed contact")
    )
    for label, colour in zip(names, (SKY, BEFORE), strict=True):
        upper.plot([], [], color=colour, label=label)
    upper.plot([], [], color=PERFECT, linestyle=":", linewidth=0.8, label="engine orders")
    shown = {run.verdict for run in found.runs} | {row.at.verdict for row in found.rows}
    for verdict in [name for name in MARKS if name in shown]:
        upper.plot([], [], **MARKS[verdict], label=verdict)
    _names_apart(upper, [(f"{row.peak.n}", row.at.speed_hz, row.peak.freq_hz) for row in marked], speed, top)
    figure.legend(loc="outside upper left", ncols=4, fontsize=8)
    beyond = 0.012 * float(np.ptp(speed))  # room for the marks at both ends
    figure.axes[-1].set(xlabel="speed [Hz]", xlim=(float(speed[0]) - beyond, float(speed[-1]) + beyond))
    rpm_above(upper)
    return figure


def _names_apart(axes: Any, names: Sequence[tuple[str, float, float]], speed: FloatArray, top: float) -> None:
    """Names above their positions; of overlapping names only the first is kept."""
    kept = list[tuple[float, float]]()
    for name, at, height in names:
        place = (at / (float(np.ptp(speed)) or 1.0), height / top)
        if all(abs(place[0] - x) > 0.035 or abs(place[1] - y) > 0.05 for x, y in kept):
            axes.annotate(
                name, (at, height), textcoords="offset points", xytext=(0, 4), fontsize=7.5, zorder=5, ha="center",
                va="bottom",
            )  # fmt: skip
            kept.append(place)


@styled
def figure_map(pairs: Sequence[tuple[int, float]], blade_hz: Sequence[float], speed_hz: float) -> Figure:
    """Interaction map at one speed: frequency over nodal diameters of casing and blade, with coincidences.

    `pairs` are n and f_c of the casing's modes. Triangles are blade frequencies that coincide with the casing's waves:
    f_b = n f - f_c for flutter, f_b = f_c - n f for resonance. If a triangle lies on a line of the blade, the two
    interact.
    """
    figure = new_figure(7.6, 4.2)
    axes: Any = figure.add_subplot()
    n, casing = (np.array(part) for part in zip(*pairs, strict=True))
    speed = abs(speed_hz)
    axes.plot(n, casing, "o", color=MEASURED, markersize=4, label="casing alone, f_c")
    axes.plot(
        [0, n.max(initial=1)], [0.0, n.max(initial=1) * speed], color=PERFECT, linestyle=":", label="order n: n f"
    )
    met = n * speed - casing
    for kept, mark, face, label in (
        (met > 0.0, "^", AFTER, "n f - f_c: flutter if f_b"), (met <= 0.0, "v", "white", "f_c - n f: resonance if f_b"),
    ):  # fmt: skip
        if kept.any():
            axes.plot(
                n[kept], np.abs(met)[kept], mark, color=AFTER, markerfacecolor=face, markersize=6, label=label, zorder=4
            )
    top = 1.15 * float(max(casing.max(initial=1.0), np.abs(met).max(initial=0.0)))
    for k, freq in enumerate(freq for freq in blade_hz if freq < top):
        axes.axhline(freq, color=BEFORE, linewidth=1.0, label=None if k else "blade alone, f_b")
    axes.set(xlabel="nodal diameters n", ylabel="frequency [Hz]", ylim=(0.0, top))
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_title(f"at {60.0 * speed:,.0f} rpm ({speed:.4g} Hz)", loc="left", fontsize=9, fontweight="normal")
    figure.legend(loc="outside upper left", ncols=3, fontsize=8)
    return figure


def _growth(axes: Any, found: Any) -> None:
    """Growth over speed with shaded unstable bands, on a scale that shows more than one sharp peak."""
    axes.axhline(0.0, color="#777777", linewidth=0.8)
    axes.plot(found.speed_hz, found.growth, color=BEFORE, linewidth=1.0)
    axes.plot(found.peak_speed_hz, found.peak_growth, "^", color=AFTER, markersize=5)
    for low, high in found.bands_hz:
        axes.axvspan(low, high, color=AFTER, alpha=0.12, linewidth=0.0)
    axes.set_ylabel("growth [1/s]")
