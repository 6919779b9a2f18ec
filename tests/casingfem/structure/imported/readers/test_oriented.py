"""Which shell cells are turned round: by trying all ways on small meshes."""

from itertools import product

import numpy as np
import pytest

from casingfem.structure.imported.readers.draft import to_turn


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


def turned(cells):
    """Which cells are turned, of those with edges that two of them share."""
    count = {}
    for cell, edges in enumerate(edges_of(cells).tolist()):
        for a, b in edges:
            count.setdefault((min(a, b), max(a, b)), []).append((cell, a < b))
    pairs = [two for two in count.values() if len(two) == 2]
    return to_turn(len(cells), np.array([[a[0], b[0]] for a, b in pairs]), np.array([a[1] == b[1] for a, b in pairs]))


@pytest.mark.parametrize("cells", [STRIP, TRIANGLES], ids=["squares", "triangles"])
def test_the_fewest_cells_are_turned_that_make_all_neighbours_agree(cells):
    assert disagreements(cells) == 0
    for which in product([False, True], repeat=len(cells)):
        given = turned_cells(cells, which)
        found = turned(given)
        assert disagreements(turned_cells(given, found)) == 0
        assert found.sum() == min(sum(which), len(cells) - sum(which))


def test_parts_that_do_not_touch_are_turned_each_for_itself():
    other = [tuple(20 + node for node in cell) for cell in TRIANGLES[:3]]
    given = turned_cells(TRIANGLES[:3], (False, True, False)) + turned_cells(other, (True, False, True))
    assert turned(given).tolist() == [False, True, False, False, True, False]


def test_of_two_cells_that_disagree_one_is_turned():
    found = turned([(0, 1, 2), (1, 2, 3)])
    assert found.sum() == 1


def test_a_strip_with_one_side_is_left_as_it_is():
    moebius = [(0, 1, 3, 2), (2, 3, 5, 4), (4, 5, 0, 1)]
    assert disagreements(moebius) > 0
    assert not turned(moebius).any()
