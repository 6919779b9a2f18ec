"""Rings of nodes and the Fourier amplitudes of what is given on them."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.place import ring_transform
from casingfem.structure.mesh.shell_mesh import make_grid

CHART = cf.Cylinder(radius=0.5, height=3.0)
GRID = make_grid(CHART, cf.ShellMesh(order=8, rows=(0.0, 0.2, 1.0), around=5))


@pytest.mark.parametrize("height", [3.0, 1e-5])
def test_rings_are_sorted_by_height_and_by_angle(height):
    chart = cf.Cylinder(radius=0.5, height=height)
    grid = make_grid(chart, GRID.mesh)
    rings, _ = ring_transform(chart, grid, 1)
    z, theta = grid.nodes[:, rings]
    assert rings.shape == (17, 40)
    assert np.unique(rings).tolist() == list(range(grid.nodes.shape[1]))
    np.testing.assert_allclose(z, np.repeat(z[:, :1], 40, axis=1), atol=1e-12 * height)
    assert np.all(np.diff(z[:, 0]) > 0.0)
    assert np.all(np.diff(theta, axis=1) > 0.0)


@pytest.mark.parametrize("ring", [0, 11])
def test_amplitudes_are_those_of_the_waves_on_a_ring(ring):
    """f = 3 + 2 cos theta - 5 sin 2 theta + 7 cos(4 theta + 0.3): a_n with f = Re sum a_n e^(i n theta)."""
    rings, transform = ring_transform(CHART, GRID, 4)
    theta = GRID.nodes[1, rings[ring]]
    f = 3.0 + 2.0 * np.cos(theta) - 5.0 * np.sin(2.0 * theta) + 7.0 * np.cos(4.0 * theta + 0.3)
    np.testing.assert_allclose(transform @ f, [3.0, 2.0, 5j, 0.0, 7.0 * np.exp(0.3j)], atol=2e-4)
