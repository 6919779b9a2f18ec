"""Is a mesh round? Normals and sizes of surfaces, cuts and waves on both sides of what is allowed; grids of tubes."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.grid import cube_cells, end_group
from casingfem.structure.imported.revolution import elements_around, facet_normals, hoop_component, round_about_z
from tests.casingfem.structure.imported.parts import box, flat

WALL = cf.imported.revolved((0.5, 0.5), (0.0, 0.4), 0.02)


def skin(u, waves=0.0):
    """A cylinder of radius 1 with eight waves of a height; around first, so that its normals point outwards."""
    theta = 2.0 * np.pi * u[:, 0]
    r = 1.0 + waves * np.cos(8.0 * theta)
    return np.stack([r * np.cos(theta), r * np.sin(theta), 0.4 * u[:, 1]], axis=1)


def without(mesh, *cells):
    return cf.imported.MeshData(kind=mesh.kind, points=mesh.points, cells=np.delete(mesh.cells, cells, axis=0))


def test_the_hoop_component_of_normals_of_any_length():
    """At (3, 4): e_theta = (-4, 3)/5; on the axis there is no hoop direction."""
    x, n = np.array([[3.0, 4.0, 7.0], [0.0, 0.0, 1.0]]), np.array([[2.0, 5.0, 1.0], [1.0, 1.0, 0.0]])
    np.testing.assert_allclose(hoop_component(x, n), [7.0 / 5.0 / np.sqrt(30.0), 0.0], rtol=1e-13)


def test_facets_of_a_brick_have_their_middles_areas_and_outward_normals():
    x, normals, size = facet_normals(box(2, 3, 5))
    order = np.lexsort(x.T)
    middles = np.array([[1, 1.5, 0], [1, 0, 2.5], [0, 1.5, 2.5], [2, 1.5, 2.5], [1, 3, 2.5], [1, 1.5, 5]])
    outward = np.array([[0, 0, -1], [0, -1, 0], [-1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    areas = np.array([6.0, 10.0, 15.0, 15.0, 10.0, 6.0])
    np.testing.assert_allclose(x[order], middles, atol=1e-13)
    np.testing.assert_allclose(size[order], areas, rtol=1e-13)
    np.testing.assert_allclose(normals[order], areas[:, None] * outward, atol=1e-12)


def test_edges_of_a_shell_have_normals_in_its_plane():
    x, normals, size = facet_normals(cf.imported.grid_mesh("quad8", (1, 1), lambda u: flat(u * [2.0, 3.0])))
    order = np.lexsort(x.T)
    np.testing.assert_allclose(x[order], [[1, 0, 0], [0, 1.5, 0], [2, 1.5, 0], [1, 3, 0]], atol=1e-13)
    np.testing.assert_allclose(size[order], [2, 3, 3, 2], rtol=1e-13)
    unit = normals[order] / np.linalg.norm(normals[order], axis=1, keepdims=True)
    np.testing.assert_allclose(unit, [[0, -1, 0], [-1, 0, 0], [1, 0, 0], [0, 1, 0]], atol=1e-13)


@pytest.mark.parametrize(("gone", "round_"), [((), True), ((0,), True), ((0, 1), True), ((0, 1, 2), False),
                                              ((0, 25), True), ((0, 25, 47), False)])  # fmt: skip
@pytest.mark.parametrize("kind", ["hexahedron20", "quad9"])
def test_holes_may_cut_half_a_meridional_section(kind, gone, round_):
    """Ten cells of one height along the axis: each cell that is missing lays bare two tenths of the section."""
    if kind == "quad9":
        mesh = cf.imported.grid_mesh(kind, (24, 10), skin, wrap=0)
    else:
        mesh = cf.imported.grid_mesh(kind, (1, 24, 10), WALL, wrap=1)
    assert round_about_z(without(mesh, *gone)) is round_


@pytest.mark.parametrize(("lean", "round_"), [(0.095, True), (0.105, False)])
@pytest.mark.parametrize("kind", ["hexahedron20", "quad9"])
def test_waves_may_lean_by_a_tenth_in_the_mean(kind, lean, round_):
    """Eight waves r = 1 + a cos 8 theta lean by 8 a/sqrt 2."""
    waves = lean * np.sqrt(2.0) / 8.0
    if kind == "quad9":
        mesh = cf.imported.grid_mesh(kind, (64, 1), lambda u: skin(u, waves), wrap=0)
    else:

        def place(u):
            return skin(u[:, 1:], waves) * np.column_stack([1.0 + 0.1 * u[:, [0, 0]], np.full(len(u), 1e3)])

        mesh = cf.imported.grid_mesh(kind, (1, 64, 1), place, wrap=1)
    assert round_about_z(mesh) is round_


def test_a_plate_through_the_axis_is_not_round():
    assert not round_about_z(cf.imported.grid_mesh("quad", (2, 1), lambda u: np.insert(u - [0.5, 0.0], 1, 0.0, axis=1)))


def test_elements_around_are_those_of_the_widest():
    tube = cf.imported.revolved((0.5, 0.4), (0.0, 0.3), 0.05)
    assert elements_around(cf.imported.grid_mesh("hexahedron20", (1, 12, 2), tube, wrap=1)) == 12
    assert elements_around(cf.imported.grid_mesh("quad", (7, 1), skin, wrap=0)) == 7
    uneven = cf.imported.grid_mesh("quad", (4, 1), lambda u: skin(np.stack([u[:, 0] ** 2, u[:, 1]], axis=1)), wrap=0)
    assert elements_around(uneven) == 2  # the last of (k/4)^2 goes seven sixteenths round


def test_cells_at_the_axis_do_not_count_and_a_plane_has_none_around():
    def disc(u):
        theta, r = 2.0 * np.pi * u[:, 0], u[:, 1]
        return flat(np.stack([r * np.cos(theta), r * np.sin(theta)], axis=1))

    assert elements_around(cf.imported.grid_mesh("quad", (9, 2), disc, wrap=0)) == 9
    assert elements_around(cf.imported.grid_mesh("quad", (9, 1), disc, wrap=0)) == 0
    cone = cf.imported.grid_mesh("quad", (9, 2), lambda u: np.insert(disc(u)[:, :2], 2, 2.0 + u[:, 1], axis=1), wrap=0)
    assert elements_around(cone) == 9  # far from the origin, and on the axis all the same
    meridian = cf.imported.grid_mesh("quad", (2, 2), lambda u: np.insert(u + 0.5, 1, 0.0, axis=1))
    assert elements_around(meridian) == 0


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


@pytest.mark.parametrize(("kind", "corner"), [("tetra", 4), ("tetra10", 10)])
def test_six_tetrahedra_fill_a_cube_right_handed(kind, corner):
    cells = cube_cells(kind, 3)
    assert cells.shape == (6, corner, 3)
    np.testing.assert_allclose(np.linalg.det(cells[:, 1:4] - cells[:, :1]), 1.0, rtol=1e-14)
    assert np.unique(cells[:, :4].reshape(-1, 3), axis=0).tolist() == [
        [x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)
    ]


def test_counts_must_have_the_dimensions_of_the_kind():
    with pytest.raises(ValueError, match="quad has 2 dimensions, counts has 3"):
        cf.imported.grid_mesh("quad", (1, 1, 1), lambda u: u)


def test_an_end_has_the_facets_that_lie_in_it_wholly():
    mesh = box(1, 1, 1, counts=(2, 1, 1))
    group = end_group(mesh, mesh.points[:, 0] <= 0.5)
    assert len(group.nodes) == 8
    assert len(group.facets) == 5
