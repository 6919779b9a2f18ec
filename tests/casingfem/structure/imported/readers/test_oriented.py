"""Which shell cells are turned round: by trying all ways on small meshes."""

from itertools import product

import numpy as np
import pytest

from casingfem.structure.imported.readers.draft import against


def edges_of(cells):
    return np.array([[(cell[k], cell[(k + 1) % len(cell)]) for k in range(len(cell))] for cell in cells])


def turned_cells(cells, which):
    return [cell[::-1] if turn else cell for cell, turn in zip(cells, which, strict=True)]


def disagreements(cells):
    """Edges that two cells run along in the same way; edges of more cells or of one join nothing."""
    count = {}
    for cell in edges_of(cells).tolist():
        for a, b in cell:
            count.setdefault((min(a, b), max(a, b)), []).append(a < b)
    return sum(len(ways) == 2 and ways[0] == ways[1] for ways in count.values())


STRIP = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 9, 8), (5, 6, 10, 9)]
TRIANGLES = [(0, 1, 2), (2, 1, 3), (2, 3, 4), (4, 3, 5)]


@pytest.mark.parametrize("cells", [STRIP, TRIANGLES], ids=["squares", "triangles"])
def test_the_fewest_cells_are_turned_that_make_all_neighbours_agree(cells):
    assert disagreements(cells) == 0
    for which in product([False, True], repeat=len(cells)):
        given = turned_cells(cells, which)
        found = against(edges_of(given))
        assert disagreements(turned_cells(given, found)) == 0
        assert found.sum() == min(sum(which), len(cells) - sum(which))


def test_parts_that_do_not_touch_are_turned_each_for_itself():
    other = [tuple(20 + node for node in cell) for cell in TRIANGLES[:3]]
    given = turned_cells(TRIANGLES[:3], (False, True, False)) + turned_cells(other, (True, False, True))
    assert against(edges_of(given)).tolist() == [False, True, False, False, True, False]


def test_of_two_cells_that_disagree_one_is_turned():
    found = against(edges_of([(0, 1, 2), (1, 2, 3)]))
    assert found.sum() == 1


def test_a_strip_with_one_side_is_left_as_it_is():
    moebius = [(0, 1, 3, 2), (2, 3, 5, 4), (4, 5, 0, 1)]
    assert disagreements(moebius) > 0
    assert not against(edges_of(moebius)).any()


def test_an_edge_of_three_cells_joins_nothing():
    assert not against(edges_of([(0, 1, 2), (0, 1, 3), (0, 1, 4)])).any()


def test_the_edge_of_a_square_without_length_joins_nothing():
    """Two triangles, written as squares with their last corner twice, share a corner alone there."""
    triangles = [(0, 1, 2, 2), (3, 4, 2, 2), (4, 3, 5, 5)]
    assert not against(edges_of(triangles)).any()
    assert against(edges_of([(0, 1, 2, 2), (0, 1, 3, 3), (1, 0, 4, 4)])).tolist() == [False, False, False]
