"""Cells that are written as those of another kind, corners repeated, are found again as what they were."""

import numpy as np
import pytest

from casingfem.structure.imported.cells.mapped import mapped
from casingfem.structure.imported.mesh.collapsed import CORNERS, common_kind, forms, native, spread, written_as

COLLAPSED = [(target, kind) for target, kinds in CORNERS.items() if forms(target) for kind in kinds if kind != target]
NODES = {"triangle": 3, "triangle6": 6, "wedge15": 15, "pyramid13": 13, "tetra10": 10}


@pytest.mark.parametrize(("target", "kind"), COLLAPSED)
def test_what_is_written_as_another_kind_comes_back(target, kind):
    cells = 100 + np.arange(2 * NODES[kind]).reshape(2, -1)
    (found, rows, slots), *others = native(target, cells[:, spread(target, kind)])
    assert (found, rows.tolist(), others) == (kind, [0, 1], [])
    back = cells[:, spread(target, kind)][:, slots]
    assert np.array_equal(np.sort(back, axis=1), cells)
    corners = len(set(CORNERS[target][kind]))
    assert np.array_equal(np.sort(back[:, :corners], axis=1), cells[:, :corners])


def test_every_kind_that_has_nodes_of_its_own_is_among_them():
    assert {kind for _, kind in COLLAPSED} == set(NODES)


@pytest.mark.parametrize(
    ("kinds", "target"),
    [
        ("wedge", "hexahedron"), ("pyramid", "hexahedron"), ("triangle", "quad"), ("wedge15", "hexahedron20"),
        ("pyramid13", "hexahedron20"), ("triangle6", "quad8"), ("triangle6 quad9", "quad9"), ("tetra10", "tetra10"),
        ("tetra10 hexahedron20", "hexahedron20"), ("quad triangle6", ""), ("hexahedron tetra10", ""),
    ],
)  # fmt: skip
def test_kinds_that_mix_have_one_that_all_can_be_written_as(kinds, target):
    assert common_kind(kinds.split()) == target


UNIT = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)


@pytest.mark.parametrize(
    ("kind", "cell", "volume"),
    [
        ("wedge", [0, 1, 2, 4, 5, 6], 1 / 2), ("wedge", [4, 5, 6, 0, 1, 2], 1 / 2),
        ("pyramid", [0, 1, 2, 3, 4], 1 / 3), ("pyramid", [0, 3, 2, 1, 4], 1 / 3),
        ("tetra", [0, 1, 2, 4], 1 / 6),
    ],
)  # fmt: skip
def test_a_brick_that_another_cell_is_written_as_has_its_volume_whichever_way_it_is_numbered(kind, cell, volume):
    brick = written_as("hexahedron", kind, np.array([cell]), UNIT)
    assert mapped("hexahedron", UNIT, brick).measure.sum() == pytest.approx(volume, rel=1e-12)
