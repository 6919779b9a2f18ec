"""What is refused or warned of in a mesh: sizes and distances worked out by hand, and both sides of each bound."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.bulk_data import EDGES, read
from tests.casingfem.structure.imported.parts import STEEL, box, flat, link, moved, squares, tapered


def found(mesh, code=""):
    """Lines of what a structure of this mesh is refused for, or warns of; with a code, its lines alone."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            if mesh.kind.startswith(("quad", "triangle")):
                cf.MeshShell(mesh=mesh, thickness=1e-3, material=STEEL)
            else:
                cf.Solid(mesh=mesh, material=STEEL)
            lines = [str(one.message) for one in warned]
        except cf.errors.ModelError as error:
            lines = str(error).splitlines()
    return [line for line in lines if line.endswith(f"[{code}]") or not code]


def codes(mesh, *scanned):
    """Codes of the lines; with some given, of those alone."""
    every = [line.rpartition("[")[2].rstrip("]") for line in found(mesh)]
    return [code for code in every if code in scanned or not scanned]


def says(mesh, code, *messages):
    """Whether the lines of a code are these messages, each after the name of the mesh and before the remedy."""
    lines = found(mesh, code)
    return len(lines) == len(messages) and all(f": {one}" in line for one, line in zip(messages, lines, strict=True))


SEAM, OVER, HANGS, TURNED = "mesh-open-seam", "mesh-overlap", "mesh-hanging-node", "mesh-flipped-shell"
REPEATED = "mesh-collapsed-cell"
CELLS = ("mesh-flat-cell", "mesh-inverted-cell", "mesh-scrambled-cell")


@pytest.mark.parametrize(("numbers", "told"), [
    ([4], "1 node (4)"), ([7, 8], "2 nodes (7, 8)"), (range(1, 6), "5 nodes (1, 2, 3, 4, 5)"),
    (range(1, 7), "6 nodes (1, 2, 3, 4, 5, ...)"),
])  # fmt: skip
def test_the_first_five_are_named(numbers, told):
    row = cf.imported.grid_mesh("quad", (4, 1), flat)
    points = np.where(np.isin(row.node_numbers, list(numbers))[:, None], np.nan, row.points)
    assert says(replace(row, points=points), "mesh-not-finite", f"{told} without finite coordinates")


def test_edges_of_a_collapsed_cell_count_as_long_as_its_longest():
    """A triangle of sides 1 and 200 as a square with a corner twice; beside it a square of 1 x 150."""
    points = [[0, 0], [200, 0], [200, 1], [200, 151], [199, 151], [199, 1]]
    longest = np.hypot(200.0, 1.0)
    triangle = squares(points[:3], [[0, 1, 2, 2]])
    assert says(triangle, "mesh-aspect", f"1 cell (1), ratio of longest to shortest edge up to {longest:.3g}")
    square = squares([[0, 0], [1, 0], [1, 150], [0, 150]], [[0, 1, 2, 3]])
    assert says(square, "mesh-aspect", "1 cell (1), ratio of longest to shortest edge up to 150")
    assert found(squares([[0, 0], [1, 0], [1, 99], [0, 99]], [[0, 1, 2, 3]]), "mesh-aspect") == []


def test_nodes_without_finite_coordinates_are_found():
    mesh = squares([[0, 0], [1, 0], [1, 1], [0, np.nan]], [[0, 1, 2, 3]])
    assert says(mesh, "mesh-not-finite", "1 node (4) without finite coordinates")
    assert found(tapered(0.5)) == []


@pytest.mark.parametrize(("cells", "bad"), [([[0, 1, 2, 2]], False), ([[0, 1, 1, 1]], True), ([[0, 1, 2, 3]], False)])
def test_squares_collapse_to_triangles_and_no_further(cells, bad):
    assert codes(squares([[0, 0], [1, 0], [1, 1], [0, 1]], cells), REPEATED) == [REPEATED] * bad


def test_a_quadratic_square_that_lost_a_middle_node_only_is_refused():
    square = tapered(0.8, "quad8")
    cells = square.cells.copy()
    cells[0, 5] = cells[0, 4]
    assert codes(cf.imported.MeshData(kind="quad8", points=square.points, cells=cells)) == [REPEATED]
    assert found(square) == []


def test_a_triangle_among_quadratic_squares_needs_all_its_middles():
    """A square collapsed at corners 2 and 3, whose middles are 4, 5 and 7, and 6 = 2; then 7 is missing."""
    x = [[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]]
    assert found(squares(x, [[0, 1, 2, 2, 3, 4, 2, 5]], "quad8")) == []
    assert codes(squares(x, [[0, 1, 2, 2, 3, 4, 2, 4]], "quad8")) == [REPEATED]
    assert codes(squares(x, [[0, 1, 2, 2, 3, 4, 5, 5]], "quad8"), REPEATED) == []


@pytest.mark.parametrize(
    ("mesh", "seen"),
    [
        (box(1.0, 0.5, 1.9e-9), True), (box(1.0, 0.5, 2.1e-9), False), (box(0.1, 0.05, 1.9e-10), True),
        (box(0.1, 0.05, 2.1e-10), False), (squares([[0, 0], [2, 0], [2, 1.9e-9], [0, 1.9e-9]], [[0, 1, 2, 3]]), True),
        (squares([[0, 0], [2, 0], [2, 2.1e-9], [0, 2.1e-9]], [[0, 1, 2, 3]]), False),
    ],
)  # fmt: skip
def test_a_cell_is_flat_below_a_billionth_of_the_cube_or_square_of_its_longest_edge(mesh, seen):
    assert codes(mesh, *CELLS) == ["mesh-flat-cell"] * seen


@pytest.mark.parametrize(("top", "seen"), [(0.019, True), (0.021, False)])
def test_a_cell_is_nearly_folded_where_its_size_at_a_node_is_a_fiftieth_of_the_largest(top, seen):
    """A square of side 1 tapered to `top`: the area per r and s varies as much from side to side."""
    assert says(tapered(top), "mesh-distorted-cell", *["1 cell (1) nearly folded"] * seen)


def test_sizes_of_a_shell_count_along_its_mean_normal():
    """A square folded over its diagonal: at corner 2, pushed to the inside, the area is negative, from below too."""
    mesh = squares([[0, 0], [1, 0], [0.4, 0.4], [0, 1]], [[0, 1, 2, 3]])
    below = cf.imported.MeshData(kind="quad", points=mesh.points[:, [1, 0, 2]], cells=mesh.cells)
    for one in (mesh, below):
        assert codes(one) == ["mesh-distorted-cell"]
    further = squares([[0, 0], [1, 0], [0.25, 0.25], [0, 1]], [[0, 1, 2, 3]])
    assert codes(further, *CELLS) == ["mesh-scrambled-cell"]


def test_a_pyramid_is_measured_short_of_its_apex(tmp_path):
    """Its size is the same everywhere, and zero at the apex itself."""
    corners = np.array([[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [1, 1.5, 5]], dtype=float)
    middles = corners[np.array(EDGES["pyramid13"])].mean(axis=1)
    mesh = read(tmp_path, np.vstack([corners, middles]), [("pyramid13", np.arange(13)[None])])
    assert codes(mesh, "mesh-distorted-cell", *CELLS) == []


@pytest.mark.parametrize(("mesh", "seen"), [
    (box(1, 1, 2e-9), []),
    (box(1, 1, 0.5e-9), ["mesh-flat-cell"]),
    (box(1, 1, -2e-9), ["mesh-inverted-cell"]),
    (moved(box(1, 1, 1), 6, [-0.9, -0.9, -0.9]), ["mesh-scrambled-cell"]),
    (moved(box(1, 1, 1), 6, [-0.4, -0.4, -0.4]), []),  # folded at the corner alone, beyond the quadrature points
])  # fmt: skip
def test_cells_flat_inverted_or_folded(mesh, seen):
    assert codes(mesh, *CELLS) == seen


@pytest.mark.parametrize(("kind", "node", "shift", "stray"), [
    ("quad8", 4, 0.34, False), ("quad8", 4, 0.36, True), ("quad9", 5, 0.59, False), ("quad9", 5, 0.61, True),
])  # fmt: skip
def test_middles_stray_beyond_a_third_of_the_reach_of_their_corners(kind, node, shift, stray):
    """Sides of 1 and sqrt 3: .35 of the distance to the farthest corner, 1, 2 and sqrt 3."""
    mesh = cf.imported.grid_mesh(kind, (1, 1), lambda u: flat(u * [1.0, np.sqrt(3.0)]))
    assert codes(moved(mesh, node, [0.0, shift, 0.0]), *CELLS) == ["mesh-scrambled-cell"] * stray


def halves(gap, **given):
    """Two squares of side 1 whose nodes 2 and 5, 3 and 6 stand `gap` apart, bound by nothing."""
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [1 + gap, 0], [3, 0], [3, 1], [1 + gap, 1]]
    return squares(points, [[0, 1, 2, 3], [4, 5, 6, 7]], **given)


@pytest.mark.parametrize(("gap", "seen"), [(0.0, True), (0.9e-3, True), (1.1e-3, False)])
def test_nodes_within_a_thousandth_of_the_shortest_edge_coincide(gap, seen):
    told = "4 nodes (2, 3, 5, 8) coincide with another node but are not joined to it"
    assert says(halves(gap), SEAM, *[told] * seen)


@pytest.mark.parametrize(("gap", "seen"), [(0.45e-3, True), (0.55e-3, False)])
def test_the_shortest_edge_is_halved_by_its_middle_node(gap, seen):
    row = cf.imported.grid_mesh("quad8", (1, 1), flat)
    points = np.vstack([row.points, row.points * [2.0, 1.0, 1.0] + [1.0 + gap, 0.0, 0.0]])
    both = cf.imported.MeshData(kind="quad8", points=points, cells=np.vstack([row.cells, row.cells + len(row.points)]))
    assert len(found(both, SEAM)) == seen


def test_attachments_join_pairs_and_parts():
    bolt = halves(0.0, attachments=cf.imported.Attachments(springs=(link(1, 4),)))
    assert says(bolt, SEAM, "2 nodes (3, 8) coincide")
    assert found(halves(0.0), "mesh-parts")
    elsewhere = halves(0.0, attachments=cf.imported.Attachments(springs=(link(1, 5),)))  # to another place
    assert says(elsewhere, SEAM, "4 nodes (2, 3, 5, 8) coincide")
    both = halves(
        0.0,
        attachments=cf.imported.Attachments(
            springs=(link(1, 4),), equations=(cf.imported.Equation(terms=link(2, 7).terms),)
        ),
    )
    assert found(both, SEAM) == []
    assert found(bolt, "mesh-parts") == found(both, "mesh-parts") == []


def test_parts_are_counted_with_the_largest_first():
    """Squares 1, 2 | 3 | 4, 5, 6; then the first two parts are fixed together by a rigid connection of three nodes."""
    x = [[k, y] for y in (0, 1) for k in range(9)]
    cells = [[k, k + 1, k + 10, k + 9] for k in (0, 1, 3, 5, 6, 7)]
    cells[2] = [3, 4, 13, 12]
    loose = squares(x, cells)
    told = "3 parts that do not touch, of 3, 2, 1 cells; not in the largest: 3 cells (1, 2, 3)"
    assert says(loose, "mesh-parts", told)
    body = cf.imported.Rigid(reference=1, nodes=np.array([13, 4, 0]))
    tied = squares(x, cells, attachments=cf.imported.Attachments(rigids=(body,)))
    told = "2 parts that do not touch, of 3, 3 cells; not in the largest: 3 cells (4, 5, 6)"
    assert says(tied, "mesh-parts", told)


def test_cells_given_twice_and_branches():
    row = cf.imported.grid_mesh("quad", (2, 1), flat)
    assert found(row) == []
    twice = cf.imported.MeshData(kind="quad", points=row.points, cells=row.cells[[0, 1, 1]])
    assert says(twice, OVER, "1 cell (3) with the same nodes as another")
    shared = sorted(set(row.cells[0]) & set(row.cells[1]))
    points = np.vstack([row.points, row.points[shared] + [0.0, 0.0, 1.0]])
    fin = cf.imported.MeshData(kind="quad", points=points, cells=np.vstack([row.cells, [[*shared, 7, 6]]]))
    assert found(fin, OVER) == []
    points[-2:] = row.points[shared] + [0.5, 0.0, 0.04]  # over the second cell
    message = "2 cells (2, 3) overlap a neighbour, folded back at their common edge, at 2 nodes (3, 4)"
    assert says(replace(fin, points=points), OVER, message)
    bricks = box(1, 1, 1, counts=(2, 1, 1))
    facet = sorted(set(bricks.cells[0]) & set(bricks.cells[1]))
    third = [facet[0], facet[1], facet[3], facet[2], *range(12, 16)]
    points = np.vstack([bricks.points, bricks.points[third[:4]] + [0.0, 5.0, 0.0]])
    fork = cf.imported.MeshData(kind="hexahedron", points=points, cells=np.vstack([bricks.cells, [third]]))
    assert says(fork, OVER, "3 cells (1, 2, 3) share a facet with two or more others")


def test_a_corner_on_a_middle_node_hangs_and_linear_cells_have_none():
    row = cf.imported.grid_mesh("quad8", (2, 1), flat)
    assert found(row) == []
    assert found(cf.imported.grid_mesh("quad", (2, 1), flat)) == []
    x = [[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]]
    assert found(squares(x, [[0, 1, 2, 2, 3, 4, 2, 5]], "quad8"), HANGS) == []  # a triangle: 2 is a corner and a middle
    cells = row.cells.copy()
    cells[1, 0] = cells[0, 4]
    first, *_ = found(cf.imported.MeshData(kind="quad8", points=row.points, cells=cells), HANGS)
    assert ": 1 cell (1) use a corner of another cell as a middle node" in first


def test_neighbours_with_middles_of_their_own_are_split():
    row = cf.imported.grid_mesh("quad8", (3, 1), flat)
    assert found(row) == []
    both = (set(row.cells[0]) & set(row.cells[1])) - set(row.cells[:, :4].ravel())
    cells = np.where(np.isin(row.cells, list(both)) & (np.arange(3) == 1)[:, None], len(row.points), row.cells)
    mesh = cf.imported.MeshData(kind="quad8", points=np.vstack([row.points, [[0.3, 0.5, 0]]]), cells=cells)
    told = "2 cells (1, 2) share the corners of a facet with a neighbour, but not its middle nodes"
    assert says(mesh, HANGS, told)


def test_normals_against_a_neighbour_and_collapsed_edges():
    row = cf.imported.grid_mesh("quad", (3, 1), flat)
    assert found(row) == []
    turned = row.cells.copy()
    turned[0] = turned[0, ::-1]
    mesh = cf.imported.MeshData(kind="quad", points=row.points, cells=turned)
    assert says(mesh, TURNED, "2 cells (1, 2) with a normal opposite to a neighbour's")
    assert found(box(1, 1, 1, counts=(2, 1, 1)), TURNED) == []
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, 1, 0], [0, 0, 1], [0, 1, 1]])
    for fin in ([0, 1, 7, 6], [1, 0, 6, 7]):  # a branch: its normal is independent
        for second, count in (([1, 0, 4, 5], 0), ([0, 1, 5, 4], 1)):
            mesh = cf.imported.MeshData(kind="quad", points=points, cells=[[0, 1, 3, 2], second, fin])
            assert len(found(mesh, TURNED)) == count
    fan = squares([[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 2, 0, 0], [2, 3, 0, 0]])
    assert found(fan, TURNED) == []  # both have the edge from node 0 to itself
