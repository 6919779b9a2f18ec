"""Pictures of modes: frequencies and splits by nodal diameters, rims."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.mistuning import Mistuning
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, PURPLE, SKY, new_figure, styled
from casingfem.plot.ticks import label_decades
from casingfem.structure.mesh.shell_mesh import rim_values

PURE = 0.7  # below this share of its main order a mode is drawn hollow: a mixture
COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)  # of the meridional ranks 1, 2, ...
FLOOR = 1e-4  # per cent: splits over draws below are drawn there


@styled
def figure_frequencies(actual: ModeSet, perfect: Modes | None = None) -> Figure:
    """Frequencies against nodal diameters (mode number on open shells), with those of the perfect shell."""
    figure = new_figure()
    axes: Any = figure.add_subplot()
    axes.set_ylabel("frequency [Hz]")
    if actual.rings is None:
        if perfect is not None:
            axes.plot(np.arange(len(perfect)) + 1, perfect.freq, "o", mfc="none", color=PERFECT, label="perfect")
        axes.plot(np.arange(len(actual)) + 1, actual.freq, "o", color=BEFORE, label="this structure")
        axes.set_xlabel("mode")
        figure.legend(loc="outside upper left", ncols=3)
        return figure
    axes.set_xlabel("nodal diameters n")
    elastic = np.arange(len(actual)) >= actual.rigid
    if perfect is not None:
        branches(axes, perfect)
    n, freq = actual.nodal_diameters, actual.freq
    for low, high in actual.doublets:
        axes.plot([n[low]] * 2, freq[[low, high]], color=BEFORE, linewidth=4, alpha=0.25, solid_capstyle="round")
    pure = actual.purity >= PURE
    axes.plot(n[elastic & pure], freq[elastic & pure], "o", color=BEFORE, markersize=5, label="this structure")
    mixed = elastic & ~pure
    if mixed.any():
        label = f"a mixture: less than {100 * PURE:.0f} % of its energy at n"
        axes.plot(n[mixed], freq[mixed], "o", mfc="white", color=BEFORE, markersize=5, label=label)
    axes.xaxis.get_major_locator().set_params(integer=True)
    figure.legend(loc="outside upper left", ncols=3)
    return figure


def branches(axes: Any, perfect: Modes) -> None:
    """Lines through the perfect shell's modes of the same meridional rank."""
    for place, m in enumerate(np.unique(perfect.meridional[perfect.rigid :])):
        of_m = [k for k in range(perfect.rigid, len(perfect)) if perfect.meridional[k] == m]
        of_m.sort(key=lambda k: int(perfect.nodal_diameters[k]))
        x, y = perfect.nodal_diameters[of_m], perfect.freq[of_m]
        label = None if place else "perfect shell"
        axes.plot(x, y, "-s", color=PERFECT, mfc="white", markersize=4, linewidth=1, label=label)


@styled
def figure_splits(found: Mistuning) -> Figure:
    """Quantiles of the relative split against nodal diameters: 10 to 90 % as a bar, median, 99 % as a tick."""
    figure = new_figure()
    axes: Any = figure.add_subplot()
    ranks = sorted({m for _, m in found.perfect})
    for m in ranks:
        colour = COLOURS[(m - 1) % len(COLOURS)]
        own = sorted(n for n, rank in found.perfect if rank == m)
        present = [n for n in own if np.any((found.n == n) & (found.m == m))]
        if not present:
            continue
        splits = [100.0 * found.split[(found.n == n) & (found.m == m)] for n in present]
        low, middle, high, far = (
            np.maximum([np.quantile(values, level) for values in splits], FLOOR) for level in (0.1, 0.5, 0.9, 0.99)
        )
        x = np.array(present) + 0.18 * (m - 0.5 * (ranks[0] + ranks[-1]))
        axes.vlines(x, low, high, color=colour, linewidth=4.0, alpha=0.45)
        axes.plot(x, middle, "o", color=colour, markersize=4.5, label=f"m = {m}")
        axes.plot(x, far, "_", color=colour, markersize=9.0)
    axes.set(yscale="log", xlabel="nodal diameters n", ylabel="split of the pair [%]")
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_title(f"Splits over {found.draws} draws: median, 10 to 90 %, 99 %")
    label_decades(axes.yaxis)
    figure.legend(loc="outside upper right", ncols=len(ranks))
    return figure


def radial(modes: Modes, mode: int) -> Array:
    """Displacement of a mode along the chart's first direction (radial; normal on a plate), (nodes,)."""
    direction = modes.shell.chart.directions(*modes.grid.nodes)[0]
    return np.asarray(np.einsum("in,ni->n", direction, modes.fields[:, :3, mode]))


def lattice(modes: Modes, most: tuple[int, int] = (15, 181)) -> Array:
    """Node numbers on the lines of the mesh, thinned to at most this many, closed around, (along, around)."""
    a, b = np.round(modes.grid.nodes / np.ptp(modes.grid.nodes, axis=1)[:, None], 9)
    order = np.lexsort((b, a))
    table = order.reshape(len(np.unique(a)), -1)
    rows, columns = (
        np.unique(np.round(np.linspace(0, size - 1, min(size, limit))).astype(int))
        for size, limit in zip(table.shape, most, strict=True)
    )
    table = table[np.ix_(rows, columns)]
    return np.hstack([table, table[:, :1]]) if modes.shell.chart.periodic else table


def title(modes: ModeSet, mode: int) -> str:
    """Number, frequency and nodal diameters of a mode."""
    n = int(modes.nodal_diameters[mode])
    words = f"mode {mode + 1}: {modes.freq[mode]:.1f} Hz"
    return words + (f", n = {n}" if n >= 0 else "") + (" (rigid)" if mode < modes.rigid else "")


MEMBERS = ((BEFORE, "-", "lower member"), (AFTER, "--", "upper member"))  # of a doublet: colour, line, name


@styled
def figure_rim(modes: Modes, which: Sequence[tuple[int, ...]], edge: str | None = None, columns: int = 4) -> Figure:
    """Radial displacement around an edge for doublets or single modes (tuples of indices), viewed along the axis.

    The middle of each circle shows the frequencies and, if a mode has an orientation, the angle of its first antinode,
    with ticks outside. By default `edge` is the one that moves most.
    """
    rows = -(-len(which) // columns)
    figure = new_figure(9.0, 2.5 * rows + 0.35)
    moving = edge or most_moving(modes, [mode for group in which for mode in group])
    for k, group in enumerate(which):
        axes: Any = figure.add_subplot(rows, columns, k + 1, projection="polar")
        one_rim(axes, modes, group, moving)
    looks: list[tuple[str, Any, str]] = [*MEMBERS, (PERFECT, "-", "undeformed")]
    lines = [Line2D([], [], color=colour, linestyle=line, label=name) for colour, line, name in looks]
    figure.legend(handles=lines, loc="outside upper center", ncols=3)
    return figure


def one_rim(axes: Any, modes: Modes, group: tuple[int, ...], edge: str) -> None:
    """One doublet or single mode on polar axes."""
    theta = np.linspace(0.0, 2.0 * np.pi, 721)
    axes.plot(theta, np.ones_like(theta), color=PERFECT, linewidth=0.8)
    for k, (mode, (colour, line, _)) in enumerate(zip(group, MEMBERS, strict=False)):
        wave = around(modes, mode, edge, theta)
        peak = max(float(np.abs(wave).max()), 1e-300)
        axes.plot(theta, 1.0 + 0.25 * wave / peak, line, color=colour, linewidth=1.2)
        angle = modes.angle_deg[mode]
        words = f"{modes.freq[mode]:.2f} Hz"
        if np.isfinite(angle):
            axes.plot(np.radians([angle] * 2), [1.3, 1.46], color=colour, linewidth=2.4, solid_capstyle="butt")
            words += f"\nat {angle:.1f}°"
        place = 0.5 if len(group) == 1 else 0.61 - 0.22 * k
        axes.text(0.5, place, words, color=colour, fontsize=7, ha="center", va="center", transform=axes.transAxes)
    axes.set(ylim=(0.0, 1.5), yticks=[])
    axes.set_xticks(np.radians([0, 90, 180, 270]), ["0°", "90°", "180°", "270°"], fontsize=7, color="#666666")
    axes.tick_params(pad=-3)
    axes.spines["polar"].set_visible(False)
    axes.grid(False)
    numbers = ", ".join(str(mode + 1) for mode in group)
    axes.set_title(f"n = {modes.nodal_diameters[group[0]]}  (mode{'s' * (len(group) > 1)} {numbers})", fontsize=8.5)


def most_moving(modes: Modes, which: Sequence[int]) -> str:
    """The edge along which the radial displacement of these modes is largest."""
    edges, moves = modes.grid.edges, [np.abs(radial(modes, mode)) for mode in which]
    return max(edges, key=lambda name: sum(float(move[edges[name].nodes].max()) for move in moves))


def around(modes: Modes, mode: int, edge: str, theta: FloatArray) -> Array:
    """Radial displacement of a mode along an edge at angles theta."""
    nodes, weights = rim_values(modes.grid, edge, theta)
    return np.asarray(np.sum(weights * radial(modes, mode)[nodes], axis=1))


def groups(modes: ModeSet, most: int) -> list[tuple[int, ...]]:
    """The lowest doublets and single elastic modes, at most `most` of them."""
    upper = {high for _, high in modes.doublets}
    pairs = dict(modes.doublets)
    found: list[tuple[int, ...]] = [
        (k, pairs[k]) if k in pairs else (k,) for k in range(modes.rigid, len(modes)) if k not in upper
    ]
    return found[:most]
