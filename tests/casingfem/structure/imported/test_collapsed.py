"""Cells that are written as those of another kind, corners repeated, are found again as what they were."""

import numpy as np
import pytest

from casingfem.structure.imported.mesh.collapsed import CORNERS, forms, native, spread

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
