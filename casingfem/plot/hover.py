"""Values at the pointer: positions of the data in a matplotlib figure."""

import re
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.thousands import shown_factor

MOST = 400  # values of one line; a longer line is thinned evenly
CELLS = 4000  # of a map; larger ones show none
Series = dict[str, Any]


def hover_values(figure: Figure) -> list[Series]:
    """Every series of a saved figure: its name, the names of its axes, and rows (x, y on the page, values).

    Positions are fractions of the figure's width and height from its upper left corner. Lines without name and markers,
    such as grids and error bars, are left out.

    >>> figure = Figure()
    >>> _ = figure.add_subplot().plot([1.0, 2.0], [3.0, 5.0], "o", label="modes")
    >>> figure.draw_without_rendering()
    >>> [(one["name"], [row[2:] for row in one["rows"]]) for one in hover_values(figure)]
    [('modes', [[1, 3], [2, 5]])]
    """
    found = []
    for axes in figure.axes:
        if axes.name == "polar" or not axes.axison or axes.get_label() == "<colorbar>":
            continue
        shared = (other.get_xlabel() for other in (axes, *axes.get_shared_x_axes().get_siblings(axes)))
        names = [plain(next(filter(None, shared), "")), plain(axes.get_ylabel())]
        for name, values, third in series(axes):
            rows = placed(figure, axes, values)
            if rows:
                found.append({"name": name, "axes": [*names, *third], "rows": rows})
    return found


def series(axes: Axes) -> list[tuple[str, Array, list[str]]]:
    """Name, values (rows, 2 or 3) and name of the third value, for every line, scatter plot and map of some axes."""
    found: list[tuple[str, Array, list[str]]] = []
    for line in axes.lines:
        named = not str(line.get_label()).startswith("_")
        if line.get_transform() == axes.transData and (named or line.get_marker() not in ("None", "", None)):
            x, y = (np.asarray(part, dtype=float) for part in (line.get_xdata(), line.get_ydata()))
            every = max(1, -(-len(x) // MOST))
            found.append((str(line.get_label()) if named else "", np.stack([x, y], axis=1)[::every], []))
    for cloud in axes.collections:
        values = cloud.get_array()
        if values is None or np.size(values) > CELLS:
            continue
        if isinstance(cloud, PathCollection):
            places = np.asarray(cloud.get_offsets(), dtype=float)
        elif isinstance(cloud, QuadMesh):
            corners = np.asarray(cloud.get_coordinates(), dtype=float)
            places = 0.25 * (corners[1:, 1:] + corners[:-1, 1:] + corners[1:, :-1] + corners[:-1, :-1]).reshape(-1, 2)
        else:
            continue
        bar = cloud.colorbar
        third = plain(bar.ax.get_ylabel()) if bar is not None else "value"
        found.append(("", np.column_stack([places, np.ma.filled(np.ma.ravel(values), np.nan)]), [third]))
    return found


def placed(figure: Figure, axes: Axes, values: Array) -> list[list[float]]:
    """Rows of positions on the page and values, for points inside the axes."""
    kept = values[np.isfinite(values).all(axis=1)]
    if not len(kept):
        return []
    at = axes.transData.transform(kept[:, :2])
    box = axes.bbox
    inside = (at[:, 0] >= box.x0 - 1) & (at[:, 0] <= box.x1 + 1) & (at[:, 1] >= box.y0 - 1) & (at[:, 1] <= box.y1 + 1)
    x, y = at[inside, 0] / figure.bbox.width, 1.0 - at[inside, 1] / figure.bbox.height
    shown = kept[inside]
    shown[:, :2] *= shown_factor(axes.xaxis), shown_factor(axes.yaxis)
    rows = zip(x.tolist(), y.tolist(), shown, strict=True)
    return [[round(a, 4), round(b, 4), *map(short, row)] for a, b, row in rows]


def short(value: float) -> float | int:
    """A number with six digits, whole numbers without a point."""
    number = float(f"{value:.6g}")
    return int(number) if number.is_integer() and abs(number) < 1e15 else number


def plain(label: str) -> str:
    r"""A label without line breaks and mathematical markup.

    >>> plain("modal coordinate\n[kg$^{1/2}$ m]")
    'modal coordinate [kg^1/2 m]'
    """
    return re.sub(r"[${}]", "", label.replace("\n", " "))
