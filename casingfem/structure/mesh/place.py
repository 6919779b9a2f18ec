"""Values of nodal fields at any point of a shell, and their Fourier amplitudes on circumferential rings of nodes."""

from collections.abc import Callable

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.mesh.edge_form import places_of
from casingfem.structure.mesh.element import ElementQuadLobatto, lagrange
from casingfem.structure.mesh.shell_mesh import Grid, rim_values


def interpolation(grid: Grid, a: FloatArray, b: FloatArray) -> tuple[IntArray, FloatArray]:
    """Nodes and Lagrange weights at parameters (a, b): each (points, functions); see `place_jets`.

    >>> from casingfem.structure.geometry.chart import Plate
    >>> from casingfem.structure.mesh.shell_mesh import ShellMesh, make_grid
    >>> grid = make_grid(Plate(length=2.0, width=1.0), ShellMesh(order=3, rows=2, around=1))
    >>> nodes, weights = interpolation(grid, np.array([1.3]), np.array([0.1]))
    >>> np.sum(grid.nodes[:, nodes] * weights, axis=-1).round(12).ravel().tolist()
    [1.3, 0.1]
    """
    nodes, jets = place_jets(grid, a, b)
    return nodes, jets[0]


def place_jets(grid: Grid, a: FloatArray, b: FloatArray) -> tuple[IntArray, FloatArray]:
    """Nodes (points, functions) at parameters (a, b), and weights of the value and both slopes (3, points, functions).

    Raises
    ------
    ValueError
        If a point is outside the surface.
    """
    place = np.stack([np.atleast_1d(np.asarray(a, dtype=float)), np.atleast_1d(np.asarray(b, dtype=float))])
    lines = [np.append(np.unique(low), (low + size).max()) for low, size in zip(grid.corner, grid.size, strict=True)]
    if grid.periodic:
        place[1] = lines[1][0] + np.mod(place[1] - lines[1][0], lines[1][-1] - lines[1][0])
    for parameter, line in zip(place, lines, strict=True):
        slack = 1e-9 * (line[-1] - line[0])
        if parameter.min() < line[0] - slack or parameter.max() > line[-1] + slack:
            raise ValueError(f"at: found {parameter}, outside the surface; expected {line[0]:g} to {line[-1]:g}")
    cells = [
        np.clip(np.searchsorted(line, p, side="right") - 1, 0, len(line) - 2)
        for p, line in zip(place, lines, strict=True)
    ]
    local = [(p - line[k]) / np.diff(line)[k] for p, line, k in zip(place, lines, cells, strict=True)]
    i, j = ElementQuadLobatto(grid.mesh.order).pairs.T
    (f, df), (g, dg) = (lagrange(grid.mesh.order, np.clip(x, 0.0, 1.0)) for x in local)
    element = cells[0] * (len(lines[1]) - 1) + cells[1]
    size = grid.size[:, element]
    jets = np.stack([f[i] * g[j], df[i] * g[j] / size[0], f[i] * dg[j] / size[1]])
    return grid.elements[element], np.asarray(jets.transpose(0, 2, 1))


def ring_transform(
    chart: Chart, grid: Grid, n_max: int, places: Callable[[FloatArray], FloatArray] | None = None
) -> tuple[IntArray, Array]:
    """Ring nodes (rings, around) sorted by angle, and the transform (n_max + 1, around) to Fourier amplitudes.

    `places` maps angles to the second parameter if the two differ.
    """
    z, theta = grid.nodes
    edge = next(name for name, (held, _) in chart.edges.items() if held == 0)
    around = len(grid.edges[edge].nodes)
    rings = np.lexsort((theta, np.round(z / np.ptp(z), 9))).reshape(-1, around)
    samples = 2.0 * np.pi * np.arange(4 * around) / (4 * around)
    nodes, weights = rim_values(grid, edge, samples if places is None else places(samples))
    spread = np.zeros((len(samples), around))
    np.add.at(spread, (np.arange(len(samples))[:, None], places_of(grid.edges[edge].nodes, nodes)), weights)
    kernel = np.exp(-1j * np.outer(np.arange(n_max + 1), samples)) / len(samples)
    kernel[1:] *= 2.0
    return rings, kernel @ spread
