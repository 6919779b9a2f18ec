"""Tables beside matrices: positions of nodes with the directions of their own axes, and the dofs of the rows."""

from pathlib import Path

import numpy as np

from casingfem.io import strict_csv
from casingfem.io.arrays import FloatArray, IntArray

DIRECTIONS = {"q": 0, "x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6} | {str(k): k for k in range(7)}
OF_AXES = ("xx", "xy", "xz", "yx", "yy", "yz")  # directions of a node's own x and y
SQUARE = 1e-3  # how far these may be from unit vectors at right angles: three digits


def read_nodes(path: Path) -> dict[int, FloatArray]:
    """Positions of nodes, from a table node, x, y, z."""
    return nodes_and_axes(path)[0]


def nodes_and_axes(path: Path) -> tuple[dict[int, FloatArray], dict[int, FloatArray]]:
    """Positions, and own axes of those nodes that have some, from a table node, x, y, z, maybe xx, xy, xz, yx, yy, yz.

    Raises
    ------
    InputError
        For a node that is given twice, or axes that are not at right angles.
    """
    table = table_with(path, ("node", "x", "y", "z"))
    numbers = table.integers("node")
    values, first = np.unique(numbers, return_index=True)
    if len(values) < len(numbers):
        again = int(np.setdiff1d(np.arange(len(numbers)), first)[0])
        raise table.refuse(row=again, column="node", found=f"node {numbers[again]} again", expected="each node once")
    points = dict(zip(numbers.tolist(), np.stack([table.numbers(axis) for axis in "xyz"], axis=1), strict=True))
    axes: dict[int, FloatArray] = {}
    if not set(OF_AXES) & set(table.header):
        return points, axes
    table_with(path, OF_AXES)
    parts = np.stack([table.numbers(name, blank=np.nan) for name in OF_AXES], axis=1)
    for row in np.flatnonzero(~np.isnan(parts).all(axis=1)).tolist():
        try:
            axes[int(numbers[row])] = own_axes(parts[row])
        except ValueError as error:
            raise table.refuse(row=row, found=str(error), expected="two unit vectors at right angles") from None
    return points, axes


def own_axes(parts: FloatArray) -> FloatArray:
    """Axes, rows (3, 3), from the directions of x and y, (6,).

    Raises
    ------
    ValueError
        For directions that are not unit vectors at right angles.

    >>> own_axes(np.array([0.0, 1, 0, 0, 0, 1])).tolist()
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    x, y = parts[:3], parts[3:]
    odd = np.array([np.linalg.norm(x) - 1.0, np.linalg.norm(y) - 1.0, x @ y])
    if not np.abs(odd).max() <= SQUARE:
        raise ValueError(f"x along {x.tolist()} and y along {y.tolist()}")
    x = x / np.linalg.norm(x)
    y = y - (x @ y) * x
    y = y / np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)])


def read_dofs(path: Path) -> IntArray:
    """Node and direction of each row, from a table node, direction, (n, 2)."""
    table = table_with(path, ("node", "direction"))
    rows = []
    for k, (node, word) in enumerate(zip(table.cells["node"], table.cells["direction"], strict=True)):
        direction = DIRECTIONS.get(word.strip().lower())
        if direction is None or not node.strip().isdecimal():
            raise table.refuse(
                row=k, found=f"{node}, {word}", expected=f"the number of a node, and one of {', '.join(DIRECTIONS)}"
            )
        rows.append((int(node), direction))
    return np.array(rows, dtype=np.int64)


def table_with(path: Path, columns: tuple[str, ...]) -> strict_csv.StrictCsv:
    """Read a table that must have some columns."""
    table = strict_csv.read(path)
    if missing := [name for name in columns if name not in table.header]:
        found, expected = f"no column {', '.join(missing)}", f"columns {', '.join(columns)}"
        raise table.refuse_header(found=found, expected=expected)
    return table
