"""Is a mesh round? Normals and sizes of surfaces, cuts and waves on both sides of what is allowed; grids of tubes."""

import numpy as np
import pytest

import casingfem as cf


def skin(u, waves=0.0):
    """A cylinder of radius 1 with eight waves of a height; around first, so that its normals point outwards."""
    theta = 2.0 * np.pi * u[:, 0]
    r = 1.0 + waves * np.cos(8.0 * theta)
    return np.stack([r * np.cos(theta), r * np.sin(theta), 0.4 * u[:, 1]], axis=1)


def test_the_wall_of_a_frustum_lies_about_its_mean_radius():
    """r from 3 to 7 over a height of 3: slant (4, 3), normal (3, -4)/5, thickness 2."""
    place = cf.imported.revolved((3.0, 7.0), (10.0, 13.0), 2.0)
    found = place(np.array([[0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [1.0, 0.25, 0.5], [0.75, 0.5, 1.0]]))
    expected = [[3, 0, 10], [5 - 0.6, 0, 11.5 + 0.8], [0, 5 + 0.6, 11.5 - 0.8], [-(7 + 0.3), 0, 13 - 0.4]]
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_grids_have_their_cells_and_ends():
    mesh = cf.imported.grid_mesh("hexahedron20", (2, 3, 1), lambda u: u, groups={"far": (1, 1.0), "near": (2, 0.0)})
    assert mesh.source == "grid"
    assert np.all(mesh.points[mesh.groups["far"].nodes, 1] == 1.0)
    assert len(mesh.groups["far"].facets) == 2
    assert len(mesh.groups["near"].facets) == 6
    assert np.count_nonzero(mesh.points[:, 2] == 0.0) == len(mesh.groups["near"].nodes)
    assert len(cf.imported.grid_mesh("quad", (4, 2), skin, wrap=0).points) == 12


def test_counts_must_have_the_dimensions_of_the_kind():
    with pytest.raises(ValueError, match="counts"):
        cf.imported.grid_mesh("quad", (1, 1, 1), lambda u: u)
