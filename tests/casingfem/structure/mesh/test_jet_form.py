"""Element matrices of forms on jets, against the sum over all points at once."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.jet_form import jet_elements
from casingfem.structure.mesh.shell_mesh import make_grid


@pytest.mark.parametrize(("order", "rows", "around"), [(2, (0.0, 0.3, 1.0), 2), (4, (0.0, 0.6, 1.0), 7)])
def test_sums_by_directions_are_the_sum_over_points(order, rows, around):
    """At order 4 twelve elements are taken together and two are left."""
    grid = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=order, rows=rows, around=around))
    elements, points = len(grid.elements), len(grid.weights)
    H = np.random.default_rng(order).standard_normal((elements, points, 15, 15))
    H += H.swapaxes(2, 3)
    found = jet_elements(grid, H)
    for e in (0, 1, elements - 1):
        rates = grid.table / np.array([1.0, *grid.size[:, e]])[:, None, None]  # (3, functions, points)
        jets = np.einsum("skq,dc->qsdkc", rates, np.eye(5)).reshape(points, 15, -1)
        expected = np.einsum("qim,qij,qjn->mn", jets, H[e], jets, optimize=True)
        np.testing.assert_allclose(found[e], expected, rtol=1e-10, atol=1e-9)
