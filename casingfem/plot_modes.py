"""Pictures of modes: frequencies by nodal diameters, shapes in space, rims."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from casingfem.arrays import Array, FloatArray
from casingfem.modal.mode_set import Modes
from casingfem.plot_style import AFTER, BEFORE, DIVERGING, PERFECT, new_figure, styled
from casingfem.structure.mesh import rim_values

PURE = 0.7  # below this share of its main order a mode is drawn hollow: a mixture


@styled
def figure_frequencies(actual: Modes, perfect: Modes | None = None) -> Figure:
    """Frequencies against nodal diameters (mode number on open shells), and those of the perfect shell."""
    figure = new_figure()
    axes: Any = figure.add_subplot()
    axes.set_ylabel("frequency [Hz]")
    if not actual.shell.chart.periodic:
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
        label = f"a mixture: less than {PURE:.0%} of its energy at n"
        axes.plot(n[mixed], freq[mixed], "o", mfc="white", color=BEFORE, markersize=5, label=label)
    axes.xaxis.get_major_locator().set_params(integer=True)
    figure.legend(loc="outside upper left", ncols=3)
    return figure


def branches(axes: Any, perfect: Modes) -> None:
    """Lines through the perfect shell's modes of one meridional rank."""
    first = True
    for m in np.unique(perfect.meridional[perfect.rigid :]):
        of_m = [k for k in range(perfect.rigid, len(perfect)) if perfect.meridional[k] == m]
        of_m.sort(key=lambda k: int(perfect.nodal_diameters[k]))
        x, y = perfect.nodal_diameters[of_m], perfect.freq[of_m]
        label = "perfect shell" if first else None
        axes.plot(x, y, "-s", color=PERFECT, mfc="white", markersize=4, linewidth=1, label=label)
        first = False


def radial(modes: Modes, mode: int) -> Array:
    """Displacement of a mode along the chart's first direction (radial; normal on a plate), (nodes,)."""
    direction = modes.shell.chart.directions(*modes.grid.nodes)[0]
    return np.asarray(np.einsum("in,ni->n", direction, modes.fields[:, :3, mode]))


def lattice(modes: Modes, most: tuple[int, int] = (15, 181)) -> Array:
    """Node numbers on the mesh's lines, thinned to at most this many, closed around, (along, around)."""
    a, b = np.round(modes.grid.nodes / np.ptp(modes.grid.nodes, axis=1)[:, None], 9)
    order = np.lexsort((b, a))
    table = order.reshape(len(np.unique(a)), -1)
    rows, columns = (
        np.unique(np.round(np.linspace(0, size - 1, min(size, limit))).astype(int))
        for size, limit in zip(table.shape, most, strict=True)
    )
    table = table[np.ix_(rows, columns)]
    return np.hstack([table, table[:, :1]]) if modes.shell.chart.periodic else table


@styled
def figure_shapes(modes: Modes, which: Sequence[int], columns: int = 3) -> Figure:
    """Shapes of some modes (indices), drawn exaggerated, coloured by the radial (or normal) displacement."""
    rows = -(-len(which) // columns)
    closed = modes.shell.chart.periodic
    figure = new_figure(8.4, (2.4 if closed else 3.0) * rows)
    nodes = lattice(modes)
    points = modes.shell.geometry(*modes.grid.nodes).surface.x
    size = float(np.linalg.norm(np.ptp(points, axis=1)))
    cmap = colormaps[DIVERGING]
    for k, mode in enumerate(which):
        axes: Any = figure.add_subplot(rows, columns, k + 1, projection="3d")
        u = modes.fields[:, :3, mode].T
        moved = points + 0.05 * size / np.abs(u).max() * u
        w = radial(modes, mode)
        shade = 0.5 + 0.5 * w[nodes] / max(np.abs(w).max(), 1e-300)
        faces = 0.25 * (shade[1:, 1:] + shade[:-1, 1:] + shade[1:, :-1] + shade[:-1, :-1])
        axes.plot_surface(
            *moved[:, nodes], facecolors=cmap(faces), rstride=1, cstride=1, linewidth=0, antialiased=False,
            shade=False,
        )  # fmt: skip
        axes.set_box_aspect(np.ptp(moved, axis=1), zoom=1.3 if closed else 0.95)
        axes.view_init(elev=38, azim=-60 if closed else -40)
        axes.set_axis_off()
        axes.set_title(title(modes, mode), y=0.98 if closed else 1.0)
    return figure


def title(modes: Modes, mode: int) -> str:
    """Number, frequency and nodal diameters of a mode."""
    n = int(modes.nodal_diameters[mode])
    words = f"mode {mode + 1}: {modes.freq[mode]:.1f} Hz"
    return words + (f", n = {n}" if n >= 0 else "") + (" (rigid)" if mode < modes.rigid else "")


@styled
def figure_rim(modes: Modes, which: Sequence[tuple[int, ...]], edge: str = "top", columns: int = 4) -> Figure:
    """Radial displacement around an edge for doublets or single modes (tuples of indices), seen along the axis."""
    rows = -(-len(which) // columns)
    figure = new_figure(8.4, 2.35 * rows + 0.3)
    theta = np.linspace(0.0, 2.0 * np.pi, 721)
    for k, group in enumerate(which):
        axes: Any = figure.add_subplot(rows, columns, k + 1, projection="polar")
        axes.plot(theta, np.ones_like(theta), color=PERFECT, linewidth=0.8)
        for mode, colour, style in zip(group, (BEFORE, AFTER), ("-", "--"), strict=False):
            wave = around(modes, mode, edge, theta)
            axes.plot(theta, 1.0 + 0.25 * wave / np.abs(wave).max(), style, color=colour, linewidth=1.2)
            angle = modes.angle_deg[mode]
            if np.isfinite(angle):
                axes.plot(np.radians([angle] * 2), [1.32, 1.48], color=colour, linewidth=2.2)
        axes.set_ylim(0.0, 1.5)
        axes.set_yticks([])
        axes.set_xticks(np.radians([0, 90, 180, 270]), ["0°", "90°", "180°", "270°"], fontsize=7, color="#666666")
        axes.tick_params(pad=-3)
        axes.spines["polar"].set_visible(False)
        axes.grid(False)
        words = " / ".join(f"{modes.freq[mode]:.2f}" for mode in group)
        axes.set_title(f"n = {modes.nodal_diameters[group[0]]}\n{words} Hz", fontsize=8.5)
    return figure


def around(modes: Modes, mode: int, edge: str, theta: FloatArray) -> Array:
    """Radial displacement of a mode along an edge at angles theta."""
    nodes, weights = rim_values(modes.grid, edge, theta)
    return np.asarray(np.sum(weights * radial(modes, mode)[nodes], axis=1))


def groups(modes: Modes, most: int) -> list[tuple[int, ...]]:
    """The lowest doublets and single elastic modes, at most `most` of them."""
    upper = {high for _, high in modes.doublets}
    pairs = dict(modes.doublets)
    found: list[tuple[int, ...]] = [
        (k, pairs[k]) if k in pairs else (k,) for k in range(modes.rigid, len(modes)) if k not in upper
    ]
    return found[:most]
