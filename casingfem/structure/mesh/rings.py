"""Rings of nodes around a closed shell, and the Fourier amplitudes of what is given on them."""

import numpy as np

from casingfem.io.arrays import Array, IntArray
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.mesh.edge_form import places_of
from casingfem.structure.mesh.shell_mesh import Grid, rim_values


def ring_transform(chart: Chart, grid: Grid, n_max: int) -> tuple[IntArray, Array]:
    """Ring nodes (rings, around) sorted by angle, and the transform (n_max + 1, around) to Fourier amplitudes."""
    z, theta = grid.nodes
    edge = next(name for name, (held, _) in chart.edges.items() if held == 0)
    around = len(grid.edges[edge].nodes)
    order = np.lexsort((theta, np.round(z / np.ptp(z), 9)))
    rings = order.reshape(-1, around)
    samples = 2.0 * np.pi * np.arange(4 * around) / (4 * around)
    nodes, weights = rim_values(grid, edge, samples)
    spread = np.zeros((len(samples), around))
    np.add.at(spread, (np.arange(len(samples))[:, None], places_of(grid.edges[edge].nodes, nodes)), weights)
    n = np.arange(n_max + 1)
    kernel = np.exp(-1j * np.outer(n, samples)) / len(samples)
    kernel[1:] *= 2.0
    return rings, kernel @ spread
