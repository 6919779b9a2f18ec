"""Scans of a mesh one by one: sizes and distances worked out by hand, and both sides of each bound."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.checks import (
    attached_pairs,
    bad_cells,
    coincident,
    extremes,
    hanging,
    local_sizes,
    non_finite,
    normals,
    overlaps,
    parts,
    repeated_nodes,
    spacing,
    split_facets,
    stray_middles,
)
from casingfem.structure.imported.mesh.findings import edge_lengths, edge_vectors, named
from tests.casingfem.structure.imported.parts import box, codes, flat, link, moved, squares, tapered

GAUSS = 0.5 - 0.5 / np.sqrt(3.0)  # the first of two points on [0, 1]


@pytest.mark.parametrize(("numbers", "told"), [
    ([4], "1 cell (4)"), ([7, 8], "2 cells (7, 8)"), (range(1, 6), "5 cells (1, 2, 3, 4, 5)"),
    (range(1, 7), "6 cells (1, 2, 3, 4, 5, ...)"),
])  # fmt: skip
def test_the_first_five_are_named(numbers, told):
    assert named("cell", np.array(numbers)) == told


def test_edges_of_a_collapsed_cell_count_as_long_as_its_longest():
    """A 3-4-5 triangle as a square with a corner twice; beside it a square of 2 x 3."""
    mesh = squares([[0, 0], [3, 0], [3, 4], [9, 0], [11, 0], [11, 3], [9, 3]], [[0, 1, 2, 2], [3, 4, 5, 6]])
    np.testing.assert_allclose(edge_lengths(mesh), [[3, 4, 5, 5], [2, 3, 2, 3]], rtol=1e-14)
    np.testing.assert_allclose(edge_vectors(mesh)[0, :2], [[3, 0, 0], [0, 4, 0]])


def test_nodes_without_finite_coordinates_are_found():
    mesh = squares([[0, 0], [1, 0], [1, 1], [0, np.nan]], [[0, 1, 2, 3]])
    assert [f.message for f in non_finite(mesh)] == ["1 node (4) without finite coordinates"]
    assert non_finite(tapered(0.5)) == []


@pytest.mark.parametrize(("cells", "bad"), [([[0, 1, 2, 2]], False), ([[0, 1, 1, 1]], True), ([[0, 1, 2, 3]], False)])
def test_squares_collapse_to_triangles_and_no_further(cells, bad):
    assert codes(repeated_nodes(squares([[0, 0], [1, 0], [1, 1], [0, 1]], cells))) == ["mesh-collapsed-cell"] * bad


def test_a_quadratic_square_that_lost_a_middle_node_only_is_refused():
    square = tapered(0.8, "quad8")
    cells = square.cells.copy()
    cells[0, 5] = cells[0, 4]
    assert codes(repeated_nodes(cf.imported.MeshData(kind="quad8", points=square.points, cells=cells))) == [
        "mesh-collapsed-cell"
    ]
    assert repeated_nodes(square) == []


def test_a_triangle_among_quadratic_squares_needs_all_its_middles():
    """A square collapsed at corners 2 and 3, whose middles are 4, 5 and 7, and 6 = 2; then 7 is missing."""
    x = [[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]]
    assert repeated_nodes(squares(x, [[0, 1, 2, 2, 3, 4, 2, 5]], "quad8")) == []
    assert codes(repeated_nodes(squares(x, [[0, 1, 2, 2, 3, 4, 2, 4]], "quad8"))) == ["mesh-collapsed-cell"]
    assert codes(repeated_nodes(squares(x, [[0, 1, 2, 2, 3, 4, 5, 5]], "quad8"))) == []


def test_extremes_are_relative_to_the_cube_or_square_of_the_longest_edge():
    """A box of .2 x .3 x .6 has a sixth of .6^3; a square of side 1 tapered to .5 varies from 1 to .5."""
    for nodes in (False, True):
        np.testing.assert_allclose(extremes(box(0.2, 0.3, 0.6), nodes=nodes), [[1 / 6], [1 / 6]], rtol=1e-12)
    longest = 1.25  # the slanted side, squared
    np.testing.assert_allclose(extremes(tapered(0.5), nodes=True), np.array([[0.5], [1.0]]) / longest, rtol=1e-12)
    inner = np.array([[1.0 - 0.5 * (1.0 - GAUSS)], [1.0 - 0.5 * GAUSS]]) / longest
    np.testing.assert_allclose(extremes(tapered(0.5), nodes=False), inner, rtol=1e-12)


def test_local_sizes_of_a_shell_count_along_its_mean_normal():
    """A square folded over its diagonal: at corner 2, pushed to the inside, the area is negative."""
    mesh = squares([[0, 0], [1, 0], [0.25, 0.25], [0, 1]], [[0, 1, 2, 3]])
    inner, at_nodes = local_sizes(mesh, "quad", mesh.cells)
    np.testing.assert_allclose(at_nodes, [[1.0, 0.25, -0.5, 0.25]], rtol=1e-12)
    assert inner.shape == (1, 4)
    assert inner.sum() / 4.0 == pytest.approx(0.25, rel=1e-12)
    other = cf.imported.MeshData(kind="quad", points=mesh.points[:, [1, 0, 2]], cells=mesh.cells)
    np.testing.assert_allclose(local_sizes(other, "quad", mesh.cells)[1], at_nodes, rtol=1e-12)


def test_a_pyramid_is_measured_short_of_its_apex():
    """Its own axes times 2, 3 and 5: the volume is thirty times that of the reference everywhere."""
    from casingfem.structure.imported.mesh.cell_kind import KINDS

    points = KINDS["pyramid13"].places * [2.0, 3.0, 5.0]
    mesh = cf.imported.MeshData(kind="tetra", points=points, cells=np.array([[0, 1, 2, 4]]))
    for sizes in local_sizes(mesh, "pyramid13", np.arange(13)[None]):
        np.testing.assert_allclose(sizes, 30.0, rtol=1e-9)


@pytest.mark.parametrize(("mesh", "found"), [
    (box(1, 1, 2e-9), []),
    (box(1, 1, 0.5e-9), ["mesh-flat-cell"]),
    (box(1, 1, -2e-9), ["mesh-inverted-cell"]),
    (moved(box(1, 1, 1), 6, [-0.9, -0.9, -0.9]), ["mesh-scrambled-cell"]),
    (moved(box(1, 1, 1), 6, [-0.4, -0.4, -0.4]), []),  # folded at the corner alone, beyond the quadrature points
])  # fmt: skip
def test_cells_flat_inverted_or_folded(mesh, found):
    assert codes(bad_cells(mesh)) == found


@pytest.mark.parametrize(("kind", "node", "shift", "stray"), [
    ("quad8", 4, 0.34, False), ("quad8", 4, 0.36, True), ("quad9", 8, 0.69, False), ("quad9", 8, 0.71, True),
    ("quad9", 5, 0.59, False), ("quad9", 5, 0.61, True),
])  # fmt: skip
def test_middles_stray_beyond_a_third_of_the_reach_of_their_corners(kind, node, shift, stray):
    """Sides of 1 and sqrt 3: .35 of the distance to the farthest corner, 1, 2 and sqrt 3."""
    mesh = cf.imported.grid_mesh(kind, (1, 1), lambda u: flat(u * [1.0, np.sqrt(3.0)]))
    assert stray_middles(moved(mesh, node, [0.0, shift, 0.0])).tolist() == [stray]


def test_spacing_is_halved_by_middle_nodes():
    assert spacing(box(0.2, 0.3, 0.6)) == pytest.approx(0.2, rel=1e-14)
    assert spacing(box(0.2, 0.3, 0.6, kind="hexahedron20")) == pytest.approx(0.1, rel=1e-14)


def halves(gap, **given):
    """Two squares of side 1 whose nodes 2 and 5, 3 and 6 stand `gap` apart, bound by nothing."""
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [1 + gap, 0], [3, 0], [3, 1], [1 + gap, 1]]
    return squares(points, [[0, 1, 2, 3], [4, 5, 6, 7]], **given)


@pytest.mark.parametrize(("gap", "seen"), [(0.0, True), (0.9e-3, True), (1.1e-3, False)])
def test_nodes_within_a_thousandth_of_the_shortest_edge_coincide(gap, seen):
    found = coincident(halves(gap))
    told = "4 nodes (2, 3, 5, 8) coincide with another node but are not joined to it"
    assert [f.message for f in found] == [told] * seen


def test_attachments_join_pairs_and_parts():
    pairs = np.array([[1, 4], [2, 7], [1, 7]])
    assert attached_pairs(halves(0.0), pairs).tolist() == [False, False, False]
    assert attached_pairs(halves(0.0), np.zeros((0, 2), dtype=int)).tolist() == []
    bolt = halves(0.0, attachments=cf.imported.Attachments(springs=(link(1, 4),)))
    assert attached_pairs(bolt, pairs).tolist() == [True, False, False]
    assert [f.message.split(" coincide")[0] for f in coincident(bolt)] == ["2 nodes (3, 8)"]
    both = halves(
        0.0,
        attachments=cf.imported.Attachments(
            springs=(link(1, 4),), equations=(cf.imported.Equation(terms=link(2, 7).terms),)
        ),
    )
    assert coincident(both) == []
    assert parts(bolt) == []


def test_parts_are_counted_with_the_largest_first():
    """Squares 1, 2 | 3 | 4, 5, 6; then the first two parts are fixed together by a rigid connection of three nodes."""
    x = [[k, y] for y in (0, 1) for k in range(9)]
    cells = [[k, k + 1, k + 10, k + 9] for k in (0, 1, 3, 5, 6, 7)]
    cells[2] = [3, 4, 13, 12]
    loose = squares(x, cells)
    told = ["3 parts that do not touch, of 3, 2, 1 cells; not in the largest: 3 cells (1, 2, 3)"]
    assert [f.message for f in parts(loose)] == told
    body = cf.imported.Rigid(reference=1, nodes=np.array([13, 4, 0]))
    tied = squares(x, cells, attachments=cf.imported.Attachments(rigids=(body,)))
    told = ["2 parts that do not touch, of 3, 3 cells; not in the largest: 3 cells (4, 5, 6)"]
    assert [f.message for f in parts(tied)] == told


def test_cells_given_twice_and_branches():
    row = cf.imported.grid_mesh("quad", (2, 1), flat)
    assert overlaps(row) == []
    twice = cf.imported.MeshData(kind="quad", points=row.points, cells=row.cells[[0, 1, 1]])
    assert [f.message for f in overlaps(twice)] == ["1 cell (3) with the same nodes as another"]
    shared = sorted(set(row.cells[0]) & set(row.cells[1]))
    points = np.vstack([row.points, row.points[shared] + [0.0, 0.0, 1.0]])
    fin = cf.imported.MeshData(kind="quad", points=points, cells=np.vstack([row.cells, [[*shared, 7, 6]]]))
    assert overlaps(fin) == []
    points[-2:] = row.points[shared] + [0.5, 0.0, 0.04]  # over the second cell
    message = "2 cells (2, 3) overlap a neighbour, folded back at their common edge, at 2 nodes (3, 4)"
    assert [f.message for f in overlaps(replace(fin, points=points))] == [message]
    bricks = box(1, 1, 1, counts=(2, 1, 1))
    facet = sorted(set(bricks.cells[0]) & set(bricks.cells[1]))
    third = [facet[0], facet[1], facet[3], facet[2], *range(12, 16)]
    points = np.vstack([bricks.points, bricks.points[third[:4]] + [0.0, 5.0, 0.0]])
    fork = cf.imported.MeshData(kind="hexahedron", points=points, cells=np.vstack([bricks.cells, [third]]))
    assert [f.message for f in overlaps(fork)] == ["3 cells (1, 2, 3) share a facet with two or more others"]


def test_a_corner_on_a_middle_node_hangs_and_linear_cells_have_none():
    row = cf.imported.grid_mesh("quad8", (2, 1), flat)
    assert hanging(row) == []
    assert hanging(cf.imported.grid_mesh("quad", (2, 1), flat)) == []
    x = [[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]]
    assert hanging(squares(x, [[0, 1, 2, 2, 3, 4, 2, 5]], "quad8")) == []  # a triangle: 2 is a corner and a middle
    cells = row.cells.copy()
    cells[1, 0] = cells[0, 4]
    found = hanging(cf.imported.MeshData(kind="quad8", points=row.points, cells=cells))
    assert found[0].message == "1 cell (1) use a corner of another cell as a middle node"


def test_neighbours_with_middles_of_their_own_are_split():
    row = cf.imported.grid_mesh("quad8", (3, 1), flat)
    assert split_facets(row) == []
    both = (set(row.cells[0]) & set(row.cells[1])) - set(row.cells[:, :4].ravel())
    cells = np.where(np.isin(row.cells, list(both)) & (np.arange(3) == 1)[:, None], len(row.points), row.cells)
    found = split_facets(
        cf.imported.MeshData(kind="quad8", points=np.vstack([row.points, [[0.3, 0.5, 0]]]), cells=cells)
    )
    told = ["2 cells (1, 2) share the corners of a facet with a neighbour, but not its middle nodes"]
    assert [f.message for f in found] == told


def test_normals_against_a_neighbour_and_collapsed_edges():
    row = cf.imported.grid_mesh("quad", (3, 1), flat)
    assert normals(row) == []
    turned = row.cells.copy()
    turned[0] = turned[0, ::-1]
    found = normals(cf.imported.MeshData(kind="quad", points=row.points, cells=turned))
    assert [f.message for f in found] == ["2 cells (1, 2) with a normal opposite to a neighbour's"]
    assert normals(box(1, 1, 1, counts=(2, 1, 1))) == []
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, 1, 0], [0, 0, 1], [0, 1, 1]])
    for fin in ([0, 1, 7, 6], [1, 0, 6, 7]):  # a branch: its normal is independent
        assert normals(cf.imported.MeshData(kind="quad", points=points, cells=[[0, 1, 3, 2], [1, 0, 4, 5], fin])) == []
        assert (
            len(normals(cf.imported.MeshData(kind="quad", points=points, cells=[[0, 1, 3, 2], [0, 1, 5, 4], fin]))) == 1
        )
    fan = squares([[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 2, 0, 0], [2, 3, 0, 0]])
    assert normals(fan) == []  # both have the edge from node 0 to itself
