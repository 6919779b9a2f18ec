"""From what a file holds to a mesh: which cells it is made of, what its groups have, what is refused."""

import warnings

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.draft import Block, Draft, Lookup, build, joined

CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], dtype=float)
POINTS = np.vstack([CUBE, [[2.0, 0.5, 0.5], [0.5, 0.5, 2.0]]])
BRICK, PYRAMIDS = [[0, 1, 2, 3, 4, 5, 6, 7]], [[1, 2, 6, 5, 8], [4, 5, 6, 7, 9]]


def block(kind, cells, first=1):
    cells = np.array(cells)
    return Block(kind, cells, np.arange(first, first + len(cells)))


def draft(*blocks, points=POINTS, **more):
    return Draft(points=points, node_numbers=np.arange(101, 101 + len(points)), blocks=blocks, **more)


@pytest.mark.parametrize(
    ("kind", "dim"),
    [("vertex", 0), ("line", 1), ("line3", 1), ("triangle6", 2), ("quad", 2), ("polygon", 2), ("polygon7", 2),
     ("tetra10", 3), ("wedge", 3), ("wedge15", 3), ("wedge18", 3), ("pyramid", 3), ("pyramid14", 3), ("unheard", 3)],
)  # fmt: skip
def test_kinds_of_cells_have_a_dimension(kind, dim):
    assert block(kind, [[0]]).dim == dim


def test_numbers_are_looked_up_in_any_order():
    find = Lookup(np.array([30, 7, 12]), "a.inp", "node")
    assert find(np.array([[12, 30], [7, 12]])).tolist() == [[2, 0], [1, 2]]
    assert find(np.array([], dtype=int)).tolist() == []
    for wanted, missing in (([7, 40, 50], 40), ([1, 7], 1), ([8], 8)):
        with pytest.raises(cf.errors.ModelError, match=rf"a\.inp: node {missing} is named but not given: .*mesh-file"):
            find(np.array(wanted))
    with pytest.raises(cf.errors.ModelError, match=r"a\.inp: node 7 is given twice: .*mesh-file"):
        Lookup(np.array([7, 30, 7]), "a.inp", "node")


def test_cells_of_several_kinds_are_written_as_bricks_with_their_numbers():
    mesh = build(draft(block("line", [[0, 1]], 50), block("hexahedron", BRICK, 7), block("pyramid", PYRAMIDS, 20)), "a")
    assert (mesh.kind, mesh.source) == ("hexahedron", "a")
    assert mesh.cells.tolist() == [*BRICK, [1, 2, 6, 5, 8, 8, 8, 8], [4, 5, 6, 7, 9, 9, 9, 9]]
    assert mesh.cell_numbers.tolist() == [7, 20, 21]
    assert mesh.node_numbers.tolist() == list(range(101, 111))


@pytest.mark.parametrize(
    ("blocks", "told"),
    [
        ([], "a: found no cells: .*mesh-no-cells"),
        ([block("vertex", [[0]])], "a: found 1 vertex: .*mesh-no-cells"),
        ([block("line", [[0, 1], [1, 2]])], "a: found 2 line: .*mesh-no-cells"),
        ([block("hexahedron", BRICK), block("tet9", [range(9)])], "a: found 1 hexahedron, 1 tet9: .*mesh-mixed-cells"),
        ([block("hexahedron27", [[0] * 27]), block("wedge", [[0] * 6] * 2), block("wedge", [[0] * 6], 9)],
         "a: found 1 hexahedron27, 3 wedge: .*mesh-mixed-cells"),
        ([block("wedge18", [[0] * 18])], "a: found 1 wedge18: .*mesh-unsupported-cell"),
        ([block("polygon5", [[0, 1, 2, 3, 4]])], "a: found 1 polygon5: .*mesh-unsupported-cell"),
        ([block("triangle10", [[0] * 10])], "a: found 1 triangle10: .*mesh-unsupported-cell"),
    ],
)  # fmt: skip
def test_meshes_of_no_kind_are_refused(blocks, told):
    with pytest.raises(cf.errors.ModelError, match=told):
        build(draft(*blocks), "a")


def test_a_group_has_all_that_the_file_gives_its_name():
    """Node sets, cells of both blocks, their facets, squares on them: each in the numbers of the mesh."""
    squares = block("quad", [[3, 2, 1, 0], [0, 4, 7, 3]], 70)
    sets = {
        "all": [(0, np.array([0])), (2, np.array([1]))],
        "skin": [(1, np.array([1])), (2, np.array([0]))],
        "rod": [(3, np.array([0]))],
        "none": [(0, np.array([], dtype=int)), (1, np.array([], dtype=int))],
    }
    mesh = build(
        draft(block("hexahedron", BRICK), squares, block("pyramid", PYRAMIDS, 20), block("line", [[0, 1]], 90),
              node_sets={"skin": np.array([8]), "held": np.array([2, 0])}, cell_sets=sets,
              facet_sets={"tip": np.array([[0, 1, 5, 4], [1, 2, 8, 8]])}),
        "a",
    )  # fmt: skip
    groups = mesh.groups
    assert list(groups) == ["all", "skin", "rod", "none", "tip", "held"]
    assert {name: sorted(set(group.nodes.tolist())) for name, group in groups.items()} == {
        "all": [0, 1, 2, 3, 4, 5, 6, 7, 9], "skin": [0, 1, 2, 3, 4, 5, 6, 7, 8], "rod": [0, 1], "none": [],
        "tip": [0, 1, 2, 4, 5, 8], "held": [0, 2],
    }  # fmt: skip
    assert {name: group.cells.tolist() for name, group in groups.items()} == {
        "all": [0, 2], "skin": [1], "rod": [], "none": [], "tip": [], "held": []
    }  # fmt: skip
    assert groups["all"].facets is None
    for name, wanted in (("skin", [{0, 3, 4, 7}]), ("tip", [{0, 1, 4, 5}, {1, 2, 8}])):
        assert [set(mesh.facets[tuple(facet)].tolist()) for facet in groups[name].facets] == wanted
    assert [groups[name].facets is None for name in ("rod", "none", "held")] == [True, True, True]


def test_facets_of_no_cell_are_counted_and_left_out():
    sets = {"tip": np.array([[0, 1, 5, 4], [0, 1, 6, 7], [0, 2, 5, 7]])}
    with pytest.warns(
        cf.errors.ModelWarning, match=r"a: group 'tip' has 2 of 3 facets that belong to no cell: .*mesh-loose-facets"
    ):
        mesh = build(draft(block("hexahedron", BRICK), facet_sets=sets), "a")
    assert len(mesh.groups["tip"].facets) == 1
    assert sorted(set(mesh.groups["tip"].nodes.tolist())) == [0, 1, 4, 5]


def test_names_of_groups_that_no_program_can_print_are_refused():
    with pytest.raises(cf.errors.ModelError, match=r"a: found the group .*mesh-file"):
        build(draft(block("hexahedron", BRICK), node_sets={"a\u202eb": np.array([0])}), "a")


SHEET = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0), (3, 0.5, 0)], dtype=float)


def test_the_fewer_shell_cells_are_turned_round_and_named():
    blocks = [block("quad", [[0, 1, 2, 3], [1, 2, 5, 4]], 7), block("triangle", [[4, 6, 5]], 30)]
    with pytest.warns(
        cf.errors.ModelWarning,
        match=r"a: 1 cell \(8\) turned round, with normals against their neighbours'.*mesh-turned-shell",
    ):
        mesh = build(draft(*blocks, points=SHEET, cell_sets={"t": [(1, np.array([0]))]}), "a")
    x = mesh.points[mesh.cells]
    assert (np.cross(x[:, 1] - x[:, 0], x[:, 3] - x[:, 1])[:, 2] >= 0.0).all()
    assert [set(row) for row in mesh.cells.tolist()] == [{0, 1, 2, 3}, {1, 2, 4, 5}, {4, 5, 6}]
    assert mesh.groups["t"].cells.tolist() == [2]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        build(draft(block("quad", [[0, 1, 2, 3], [1, 4, 5, 2]]), points=SHEET), "a")


def test_middles_that_solids_leave_out_are_tied_and_those_of_shells_are_held_with_their_ends():
    tie = cf.imported.Tie(nodes=np.array([9]), others=np.array([[0, 1]]), weights=np.array([[0.5, 0.5]]))
    cells = np.full((1, 20), -1)
    cells[0, :8] = range(8)
    mesh = build(draft(block("hexahedron20", cells), attachments=cf.imported.Attachments(glued=(tie,))), "a")
    assert (len(mesh.points), mesh.node_numbers[10:].tolist()) == (22, [0] * 12)
    assert [len(one.nodes) for one in mesh.attachments.glued] == [12, 1]
    shell = np.array([[0, 1, 2, 3, -1, -1, -1, 6]])
    points = np.vstack([SHEET[:6], [[0.0, 0.5, 0.0]]])
    sets = {"edge": np.array([1, 2, 3]), "corner": np.array([0])}
    mesh = build(draft(block("quad8", shell), points=points, node_sets=sets), "a")
    assert not mesh.attachments.glued
    assert mesh.points[mesh.groups["edge"].nodes].tolist() == [
        [1, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [1, 0.5, 0],
        [0.5, 1, 0],
    ]
    assert mesh.groups["corner"].nodes.tolist() == [0]
    assert mesh.node_numbers[7:].tolist() == [0, 0, 0]


def test_nodes_closer_than_a_distance_are_one():
    """Two bricks side by side, a gap of 1e-3 between them; nodes of no cell stay apart."""
    one = cf.imported.grid_mesh("hexahedron", (1, 1, 1), lambda u: u, groups={"far": (0, 1.0)})
    points = np.vstack([one.points, one.points + np.array([1.001, 0.0, 0.0]), [[1.0, 0.0, 0.0]]])
    spring = cf.imported.Spring(terms=(cf.imported.Term(16, 0, 1.0), cf.imported.Term(8, 1, -1.0)), stiffness=5.0)
    mesh = cf.imported.MeshData(
        kind="hexahedron", points=points, cells=np.vstack([one.cells, one.cells + 8]), cell_numbers=np.array([1, 2]),
        node_numbers=np.arange(1, 18), groups={"near": cf.imported.Group(nodes=8 + np.arange(8), cells=np.array([1]))},
        attachments=cf.imported.Attachments(springs=(spring,)), source="a",
    )  # fmt: skip
    assert len(joined(mesh, 0.9e-3).points) == 17
    found = joined(mesh, 1.1e-3)
    assert len(found.points) == 13
    for cell, given in zip(found.cells, mesh.cells, strict=True):
        np.testing.assert_allclose(found.points[cell], points[given], atol=1.1e-3)
    assert len(set(found.cells[0]) & set(found.cells[1])) == 4
    assert set(found.node_numbers.tolist()) == {*range(1, 9), *(9 + n for n in range(8) if one.points[n, 0] == 1.0), 17}
    np.testing.assert_allclose(found.points[found.groups["near"].nodes], points[8:16], atol=1.1e-3)
    (term, other) = found.attachments.springs[0].terms
    assert found.node_numbers[term.node] == 17
    np.testing.assert_allclose(found.points[other.node], points[8], atol=1.1e-3)
