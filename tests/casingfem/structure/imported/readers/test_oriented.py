"""Which shell cells a reader turns round: by trying all ways on small meshes."""

import warnings
from itertools import product

import numpy as np
import pytest

import casingfem as cf


def turned_cells(cells, which):
    return [cell[::-1] if turn else cell for cell, turn in zip(cells, which, strict=True)]


def disagreements(cells):
    """Edges that two cells run along in the same way; edges of more cells or of one join nothing."""
    count = {}
    for cell in cells:
        for a, b in zip(cell, (*cell[1:], cell[0]), strict=True):
            count.setdefault((min(a, b), max(a, b)), []).append(a < b)
    return sum(len(ways) == 2 and ways[0] == ways[1] for ways in count.values())


STRIP = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 9, 8), (5, 6, 10, 9)]
TRIANGLES = [(0, 1, 2), (2, 1, 3), (2, 3, 4), (4, 3, 5)]


def in_strip(node):
    """Nodes of `STRIP` in rows of four."""
    return node % 4, node // 4, 0.0


def in_zigzag(node):
    """Nodes of `TRIANGLES`, from 20 on far away."""
    return node // 2, node % 2, 0.1 * (node // 20)


def turned(cells, place, folder):
    """Which cells are read with their nodes the other way round."""
    points = [place(k) for k in range(max(map(max, cells)) + 1)]
    text = "*NODE\n" + "".join(f"{k + 1}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(points))
    for k, cell in enumerate(cells):
        text += f"*ELEMENT, TYPE=S{len(cell)}\n{k + 1}, {', '.join(str(node + 1) for node in cell)}\n"
    (folder / "a.inp").write_text(text)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = cf.read_mesh(folder / "a.inp")
    ways = []
    for given, read in zip(cells, mesh.cells.tolist(), strict=True):
        read = list(dict.fromkeys(read))
        at = read.index(given[0])
        ways.append(read[at - len(read) + 1] != given[1])
    assert any("mesh-turned-shell" in str(w.message) for w in caught) == any(ways)
    return np.array(ways)


@pytest.mark.parametrize(("cells", "place"), [(STRIP, in_strip), (TRIANGLES, in_zigzag)], ids=["squares", "triangles"])
def test_the_fewest_cells_are_turned_that_make_all_neighbours_agree(cells, place, tmp_path):
    assert disagreements(cells) == 0
    for which in product([False, True], repeat=len(cells)):
        given = turned_cells(cells, which)
        found = turned(given, place, tmp_path)
        assert disagreements(turned_cells(given, found)) == 0
        assert found.sum() == min(sum(which), len(cells) - sum(which))


def test_parts_that_do_not_touch_are_turned_each_for_itself(tmp_path):
    other = [tuple(20 + node for node in cell) for cell in TRIANGLES[:3]]
    given = turned_cells(TRIANGLES[:3], (False, True, False)) + turned_cells(other, (True, False, True))
    assert turned(given, in_zigzag, tmp_path).tolist() == [False, True, False, False, True, False]


def test_of_two_cells_that_disagree_one_is_turned(tmp_path):
    found = turned([(0, 1, 2), (1, 2, 3)], in_zigzag, tmp_path)
    assert found.sum() == 1


def test_a_strip_with_one_side_is_left_as_it_is(tmp_path):
    """A band of 40 squares, turned by half a turn where it closes."""
    count = 40
    ring = [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(count - 1)]
    moebius = [*ring, (2 * count - 2, 2 * count - 1, 0, 1)]

    def place(node):
        around, side = np.pi * (node // 2) / count, 0.2 * (node % 2) - 0.1
        r = 1.0 + side * np.cos(around)
        return r * np.cos(2.0 * around), r * np.sin(2.0 * around), side * np.sin(around)

    assert disagreements(moebius) > 0
    assert not turned(moebius, place, tmp_path).any()
