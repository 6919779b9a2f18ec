"""What a mesh knows of itself: groups, facets, numbers, several as one."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import box, flat, link, squares

X = [[0, 0], [3, 0], [3, 4], [0, 4], [7, 0], [9, 9]]
PAIR = squares(X, [[0, 1, 2, 3], [1, 4, 2, 2]], source="part.inp")


def test_groups_keep_each_number_once_in_order():
    group = cf.imported.Group(nodes=[5, 2, 5], cells=np.array([3, 3, 1]), facets=[4, 1, 0, 2])
    assert (group.nodes.tolist(), group.cells.tolist()) == ([2, 5], [1, 3])
    assert group.facets.tolist() == [[4, 1], [0, 2]]
    assert cf.imported.Group(nodes=[1]).facets is None
    assert len(cf.imported.Group(nodes=[1]).cells) == 0
    assert cf.imported.Group(nodes=[1], facets=np.zeros((0, 2))).facets.shape == (0, 2)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"kind": "hexagon"}, "part.inp: cells of kind 'hexagon', expected one of line, "),
        ({"points": np.zeros((6, 2))}, r"points of shape \(6, 2\), expected \(nodes, 3\)"),
        ({"points": np.zeros(18)}, r"points of shape \(18,\)"),
        ({"cells": [[0, 1, 2]]}, r"cells of shape \(1, 3\), expected \(at least 1, 4\)"),
        ({"cells": [0, 1, 2, 3]}, r"cells of shape \(4,\)"),
        ({"cells": np.zeros((0, 4))}, r"cells of shape \(0, 4\)"),
        ({"cells": [[0, 1, 2, -1]]}, "cells refer to nodes outside 0 to 5"),
        ({"cells": [[0, 1, 2, 6]]}, "cells refer to nodes outside 0 to 5"),
        (
            {"attachments": cf.imported.Attachments(masses=(cf.imported.PointMass(node=-1, mass=1.0),))},
            "attachments refer to nodes outside 0 to 5",
        ),
        (
            {"attachments": cf.imported.Attachments(masses=(cf.imported.PointMass(node=6, mass=1.0),))},
            "attachments refer to nodes outside 0 to 5",
        ),
    ],
)
def test_what_is_no_mesh_is_refused(given, told):
    with pytest.raises(ValueError, match=told):
        replace(PAIR, **given)


def test_the_first_and_the_last_node_may_be_named():
    ends = cf.imported.Attachments(masses=tuple(cf.imported.PointMass(node=node, mass=1.0) for node in (0, 5)))
    assert replace(PAIR, cells=[[0, 1, 2, 5]], attachments=ends).used.tolist() == [0, 1, 2, 5]


def test_numbers_count_from_one_where_the_file_has_none():
    assert (PAIR.cell_numbers.tolist(), PAIR.node_numbers.tolist()) == ([1, 2], [1, 2, 3, 4, 5, 6])
    own = replace(PAIR, cell_numbers=np.array([7, 5]), node_numbers=np.array([9, 0, 4, 0, 6, 8]))
    assert (own.cell_numbers.tolist(), own.node_numbers.tolist()) == ([7, 5], [9, 0, 4, 0, 6, 8])
    assert own.labels.tolist() == [9, 10, 4, 11, 6, 8]


def test_nodes_in_use_and_the_box_around_them():
    """Node 5 is no cell's: the box is 7 by 4."""
    assert PAIR.used.tolist() == PAIR.present.tolist() == [0, 1, 2, 3, 4]
    assert replace(PAIR, attachments=cf.imported.Attachments(springs=(link(0, 5),))).present.tolist() == [
        0,
        1,
        2,
        3,
        4,
        5,
    ]
    assert PAIR.size == pytest.approx(np.hypot(7.0, 4.0), rel=1e-14)
    assert PAIR.collapsed.tolist() == [False, True]
    shown = "MeshData(part.inp: 2 quad, 1 of them collapsed, 6 nodes, 9 x 9 x 0 m)"
    assert repr(PAIR) == shown
    named = replace(
        PAIR,
        cells=PAIR.cells[:1],
        groups={"a": cf.imported.Group(nodes=[0])},
        attachments=cf.imported.Attachments(springs=(link(0, 1),)),
    )
    assert repr(named) == "MeshData(part.inp: 1 quad, 6 nodes, 9 x 9 x 0 m; groups a; 1 spring)"


def test_facets_are_counted_by_the_cells_that_have_them():
    """Edge 1-2 is shared, the collapsed edge 2-2 is none."""
    assert PAIR.sharing.tolist() == [[1, 2, 1, 1], [1, 1, 0, 2]]
    assert PAIR.boundary.tolist() == [[0, 0], [0, 2], [0, 3], [1, 0], [1, 1]]
    assert box(1, 1, 1, counts=(2, 1, 1)).sharing.tolist() == [[1, 2, 1, 1, 1, 1], [2, 1, 1, 1, 1, 1]]


def test_a_side_of_a_brick_collapsed_to_a_triangle_is_a_facet_and_to_an_edge_is_none():
    """A wedge as a brick: corners 2 and 3 are one, 6 and 7 too; its facet (3, 7, 6, 2) is an edge."""
    x = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
    wedge = cf.imported.MeshData(
        kind="hexahedron", points=np.array(x, dtype=float), cells=np.array([[0, 1, 2, 2, 3, 4, 5, 5]])
    )
    assert wedge.sharing.tolist() == [[1, 1, 1, 0, 1, 1]]


def test_facets_of_a_group_of_nodes_lie_wholly_in_it():
    mesh = replace(
        PAIR,
        groups={
            "nodes": cf.imported.Group(nodes=[0, 1, 4]),
            "given": cf.imported.Group(nodes=[0], facets=[[1, 1]]),
            "inner": cf.imported.Group(nodes=[1, 2]),
        },
    )
    assert mesh.group_facets("nodes").tolist() == [[0, 0], [1, 0]]
    assert mesh.group_facets("given").tolist() == [[1, 1]]
    assert mesh.group_facets("inner").tolist() == []
    assert mesh.facet_nodes(np.array([[1, 1], [0, 3]])).tolist() == [[4, 2], [3, 0]]


def test_facets_of_quadratic_cells_have_their_middles():
    square = cf.imported.grid_mesh("quad8", (1, 1), flat)
    cell = square.cells[0]
    assert square.facet_nodes(np.array([[0, 2]])).tolist() == [[cell[2], cell[3], cell[6]]]


def test_meshes_beside_each_other_keep_their_groups_under_their_names():
    """The first has six nodes and two cells; its node 5 is no cell's."""
    first = replace(PAIR, groups={"edge": cf.imported.Group(nodes=[0, 1], facets=[[0, 0]])})
    groups = {
        "all": cf.imported.Group(nodes=[0, 3], cells=[0]),
        "edge": cf.imported.Group(nodes=[2, 3], facets=[[0, 2]]),
    }
    x = [[20, 0], [21, 0], [21, 1], [20, 1]]
    other = squares(x, [[0, 1, 2, 3]], source="other.inp", groups=groups)
    both = cf.imported.beside({"a": first, "b": other})
    assert both.source == "part.inp and other.inp"
    assert both.cells.tolist() == [*PAIR.cells.tolist(), [6, 7, 8, 9]]
    np.testing.assert_array_equal(both.points, np.vstack([first.points, other.points]))
    assert list(both.groups) == ["a", "a.edge", "b", "b.all", "b.edge"]
    told = {name: (g.nodes.tolist(), g.cells.tolist(), g.facets is not None and g.facets.tolist())
            for name, g in both.groups.items()}  # fmt: skip
    assert told == {
        "a": ([0, 1, 2, 3, 4], [0, 1], False), "a.edge": ([0, 1], [], [[0, 0]]), "b": ([6, 7, 8, 9], [2], False),
        "b.all": ([6, 9], [2], False), "b.edge": ([8, 9], [], [[2, 2]]),
    }  # fmt: skip
    assert cf.imported.beside({"a": first, "b": first}).source == "part.inp"
