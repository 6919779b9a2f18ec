"""The report's section on the mode shapes of an update: what is like what before and after, and where it is not."""

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import IntArray
from casingfem.plot.correlation import mac_panel
from casingfem.plot.page import Cell, Picture, Section, Table
from casingfem.plot.style import new_figure, styled
from casingfem.updating.shape_fit import ShapeComparison, ShapeFit, ShapeMatch


def shapes_section(found: ShapeFit) -> Section:
    """MAC before and after, sensors that agree least, and what is left over on both sides."""
    caption = (
        "MAC of measured shapes (rows) with computed modes (columns) before and after the update; pairs are framed, "
        "doublets as one: within a frame the members may be turned."
    )
    return Section(
        "Mode shapes",
        tuple(shape_words(found)),
        (Picture.of(figure_shape_mac(found), caption),),
        (shapes_table(found), sensors_table(found)),
    )


def shape_words(found: ShapeFit) -> list[str]:
    """The outcome in sentences."""
    table, after = found.fit.table, found.after
    words = [
        f"Shapes were measured at {len(found.shapes.a)} sensors for {len(after.rows)} of the table's {len(table)} rows "
        f"and fitted beside the frequencies. The MAC of planes, in which the members of a doublet may be turned, is "
        f"{found.before.mean_plane:.3f} in the mean before the update and {after.mean_plane:.3f} after it."
    ]
    bare = [str(table.mode[row]) for row in range(len(table)) if row not in after.rows]
    words += [f"Without a shape: modes {', '.join(bare)} of the table."] if bare else []
    if found.shapes.unused_hz:
        words.append(f"Measured shapes of no row: {', '.join(f'{f:.2f}' for f in found.shapes.unused_hz)} Hz.")
    lost = [str(table.mode[row]) for row in after.pairing.unpaired_rows]
    words += [f"Measured, but paired with no computed mode: {', '.join(lost)}."] if lost else []
    top = float(table.freq_hz.max())
    extra = [mode for mode in after.pairing.unpaired_modes if after.modes.freq[mode] <= top]
    if extra:
        listed = ", ".join(f"{mode + 1} ({after.modes.freq[mode]:.2f} Hz)" for mode in extra)
        words.append(f"Computed below {top:.1f} Hz, but measured by nobody: modes {listed}.")
    return words


def shapes_table(found: ShapeFit) -> Table:
    """Every shape: the modes it pairs with, MAC and MAC of the plane, before and after."""
    rows: list[tuple[Cell, ...]] = []
    table = found.fit.table
    for row, old, new in zip(found.after.rows.tolist(), found.before.found, found.after.found, strict=True):
        n = int(table.n[row]) if table.n[row] >= 0 else None
        rows.append((int(table.mode[row]), n, float(table.freq_hz[row]), *cells(old), *cells(new)))
    columns = ("mode", "n", "measured [Hz]", "pairs with", "MAC", "plane", "updated: with", "MAC", "plane")
    caption = "Measured shapes and the computed modes that they pair with, before and after."
    return Table(caption, columns, tuple(rows), folded=len(rows) > 12)


def cells(match: ShapeMatch) -> tuple[Cell, Cell, Cell]:
    """Mode, MAC and MAC of the plane."""
    if match.mode is None:
        return None, None, None
    return match.mode + 1, f"{match.mac:.3f}", f"{match.plane:.3f}"


def sensors_table(found: ShapeFit) -> Table:
    """The sensors of lowest COMAC after the update."""
    rows = [
        tuple(None if isinstance(cell, float) and np.isnan(cell) else cell if k == 0 else f"{cell:.4f}"
              for k, cell in enumerate(one))
        for one in found.worst_sensors()
    ]  # fmt: skip
    caption = "The sensors that agree least: COMAC over all paired shapes, 1 where all agree."
    return Table(caption, ("sensor", "COMAC before", "after"), tuple(rows))


@styled
def figure_shape_mac(found: ShapeFit) -> Figure:
    """MAC before and after, side by side."""
    figure = new_figure(8.0, 4.2)
    for place, (name, side) in enumerate((("before", found.before), ("updated", found.after))):
        axes = figure.add_subplot(1, 2, place + 1)
        freq_hz = found.fit.table.freq_hz[side.rows]
        image = mac_panel(axes, side.mac, framed(side), side.modes, freq_hz, size=5.5)
        axes.set(ylabel="measured [Hz]" if place == 0 else "", title=name)
    figure.colorbar(image, ax=figure.axes, shrink=0.8)
    return figure


def framed(side: ShapeComparison) -> list[tuple[IntArray, IntArray]]:
    """Rows and modes of every pair that has a shape, both members of a doublet together."""
    place = {row: k for k, row in enumerate(side.rows.tolist())}
    shown = [(match, [place[row] for row in match.rows if row in place]) for match in side.pairing.matches]
    return [(np.array(rows), np.array(match.modes)) for match, rows in shown if rows]
