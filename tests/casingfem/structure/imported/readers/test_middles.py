"""Middle nodes that cells leave out: which edges they stand on, which cells share them, what they are tied to."""

import numpy as np
import pytest

from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.readers.middles import QUADRATIC, filled, known_middles, raised

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 4], [3, 3, 3], [0.4, 0.1, 0], [0.2, 1.1, 0.3]])
EDGES = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}  # VTK's slots of a tetrahedron's middles


def tetra10(corners, **middles):
    row = [*corners, *[-1] * 6]
    for slot, node in middles.items():
        row[int(slot[1:])] = node
    return row


@pytest.mark.parametrize("kind", QUADRATIC)
def test_linear_cells_are_raised_beside_any_quadratic_kind_alone(kind):
    corners = len(KINDS[QUADRATIC[kind]].corners)
    x = np.vstack([np.array(KINDS[QUADRATIC[kind]].corners, dtype=float)])
    x = x if x.shape[1] == 3 else np.insert(x, 2, 0.0, axis=1)
    cells = np.arange(corners)[None]
    name, found = raised(kind, cells, x, [kind, "tetra10"])
    assert name == QUADRATIC[kind]
    assert found.tolist() == [[*range(corners), *[-1] * (KINDS[name].nodes - corners)]]
    assert raised(kind, cells, x, [kind, "tetra"])[0] == kind


def test_wedges_numbered_from_above_stand_upright_when_raised():
    x = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0]])
    _, found = raised("wedge", np.arange(6)[None], x, ["wedge15"])
    assert found[0, :6].tolist() == [3, 4, 5, 0, 1, 2]


def test_kinds_without_quadratic_ones_stay_as_they_are():
    assert raised("line", np.array([[0, 1]]), POINTS, ["tetra10"])[0] == "line"


def test_missing_middles_stand_half_way_and_follow_both_ends():
    cells = np.array([tetra10((0, 1, 2, 3), s4=5, s9=6), tetra10((2, 1, 4, 3), s6=4)])
    points, (found,), tie = filled(POINTS, ["tetra10"], [cells])
    np.testing.assert_array_equal(points[: len(POINTS)], POINTS)
    for row, given in zip(found.tolist(), cells.tolist(), strict=True):
        for (a, b), slot in EDGES.items():
            ends = tuple(sorted((row[a], row[b])))
            if given[slot] >= 0:
                assert row[slot] == given[slot]
            elif ends == (2, 3):  # the first cell has a node there
                assert row[slot] == 6
            else:
                np.testing.assert_array_equal(points[row[slot]], POINTS[list(ends)].mean(axis=0))
                (at,) = np.flatnonzero(tie.nodes == row[slot])
                assert tie.others[at].tolist() == list(ends)
    assert found[0, 5] == found[1, 4]  # both have the edge between nodes 1 and 2
    assert tie.weights.tolist() == [[0.5, 0.5]] * len(tie.nodes)
    assert tie.nodes.tolist() == list(range(len(POINTS), len(points)))
    assert len(tie.nodes) == 6  # of nine edges three have a node of their own
    assert (cells < 0).sum() == 9  # what was given is not changed


def test_middles_of_blocks_are_counted_one_after_the_other():
    cells = [np.array([tetra10((0, 1, 2, 3))]), np.array([[0, 1, 2, 4]]), np.array([tetra10((4, 3, 2, 1))])]
    points, found, tie = filled(POINTS, ["tetra10", "tetra", "tetra10"], cells)
    assert found[1].tolist() == [[0, 1, 2, 4]]
    assert len(tie.nodes) == 9
    for table in (found[0], found[2]):
        for (a, b), slot in EDGES.items():
            np.testing.assert_array_equal(points[table[0, slot]], POINTS[table[0, [a, b]]].mean(axis=0))


def test_cells_that_take_all_middles_from_others_add_no_nodes():
    whole = np.array([[0, 1, 2, 3, 10, 11, 12, 13, 14, 15]])
    points, found, tie = filled(POINTS, ["tetra10", "tetra10"], [whole, np.array([tetra10((3, 2, 1, 0))])])
    assert tie is None
    assert points is POINTS
    # edges 3-2, 2-1, 1-3, 3-0, 2-0, 1-0 of the second
    assert found[1].tolist() == [[3, 2, 1, 0, 15, 11, 14, 13, 12, 10]]


def test_whole_cells_are_left_as_they_are():
    cells = np.array([[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]])
    points, found, tie = filled(POINTS, ["tetra10"], [cells])
    assert (points is POINTS, tie) == (True, None)
    assert found[0] is cells


def test_known_middles_are_found_on_edges_written_either_way():
    table = np.array([[5, 2, 9, -1, 30, 31]])
    other = np.array([[2, 5, 7, 40, -1, -1]])
    edges = np.array([[2, 5], [2, 9], [5, 9], [5, 7], [0, 1]])
    kinds, cells = ["triangle6", "triangle6", "triangle"], [table, other, np.array([[0, 1, 2]])]
    # edges of a triangle: first to second, second to third, third to first
    assert known_middles(kinds, cells, edges).tolist() == [40, 30, 31, -1, -1]
