"""Tensor meshes over charts: numbering, seam, edges, interpolation along a rim."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from casingfem.structure.geometry.chart import Cylinder, Frustum, Plate
from casingfem.structure.mesh.element import ElementQuadLobatto
from casingfem.structure.mesh.shell_mesh import ShellMesh, make_grid, rim_values

CASING, PLATE = Frustum(r_base=0.5, r_top=0.45, height=0.25), Plate(length=2.0, width=1.0)
GRADED = (0.0, 0.03, 0.5, 0.9, 1.0)


@pytest.mark.parametrize("order", range(2, 13))
@pytest.mark.parametrize("chart", [CASING, PLATE], ids=["casing", "plate"])
def test_neighbours_share_nodes_at_the_places_both_give_them(order, chart):
    grid = make_grid(chart, ShellMesh(order=order, rows=GRADED, around=5))
    local = ElementQuadLobatto(order).doflocs
    for e, nodes in enumerate(grid.elements):
        own = grid.corner[:, e, None] + grid.size[:, e, None] * local.T
        gap = grid.nodes[:, nodes] - own
        if chart.periodic:
            gap[1] -= 2 * np.pi * np.round(gap[1] / (2 * np.pi))
        assert np.abs(gap).max() < 1e-13
    along = order * 4 + 1
    assert grid.nodes.shape[1] == along * (order * 5 + (0 if chart.periodic else 1))
    assert len(np.unique(grid.nodes.round(12), axis=1).T) == grid.nodes.shape[1]


def test_quadrature_covers_the_parameter_rectangle():
    grid = make_grid(CASING, ShellMesh(order=4, rows=GRADED, around=7))
    a, b = grid.parameters
    assert grid.measure.sum() == pytest.approx(0.25 * 2 * np.pi, rel=1e-13)
    assert (grid.measure * a**3).sum() == pytest.approx(0.25**4 / 4 * 2 * np.pi, rel=1e-12)
    assert (grid.measure * b**2).sum() == pytest.approx(0.25 * (2 * np.pi) ** 3 / 3, rel=1e-12)


@pytest.mark.parametrize(("chart", "length"), [(CASING, 2 * np.pi), (PLATE, 1.0)], ids=["casing", "plate"])
def test_edge_nodes_run_along_the_edge_with_weights_that_integrate(chart, length):
    grid = make_grid(chart, ShellMesh(order=5, rows=2, around=4))
    for name, (held, end) in chart.edges.items():
        edge = grid.edges[name]
        places = grid.nodes[:, edge.nodes]
        assert np.all(places[held] == chart.bounds[held][end])
        assert np.all(np.diff(places[edge.along]) > 0)
        full = length if edge.along == 1 else np.diff(chart.bounds[0])[0]
        assert edge.weights.sum() == pytest.approx(full, rel=1e-13)


def test_edge_rule_integrates_polynomials_on_a_plate():
    grid = make_grid(PLATE, ShellMesh(order=4, rows=2, around=3))
    edge = grid.edges["left"]
    x = grid.nodes[0, edge.nodes]
    assert edge.weights @ x**7 == pytest.approx(2.0**8 / 8, rel=1e-12)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=9), st.integers(0, 8))
def test_rim_interpolation_follows_waves_around_the_seam(angles, n):
    grid = make_grid(Cylinder(radius=1.0, height=1.0), ShellMesh(order=8, rows=1, around=11))
    nodes, weights = rim_values(grid, "top", np.array(angles))
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-11)
    values = (np.cos(n * grid.nodes[1, nodes]) * weights).sum(axis=1)
    np.testing.assert_allclose(values, np.cos(n * np.array(angles)), atol=2e-4)
    assert np.all(grid.nodes[0, nodes] == 1.0)


def test_rim_interpolation_is_exact_for_polynomials_on_an_open_edge():
    grid = make_grid(PLATE, ShellMesh(order=5, rows=2, around=3))
    y = np.linspace(-0.5, 0.5, 23)
    nodes, weights = rim_values(grid, "tip", y)
    np.testing.assert_allclose((grid.nodes[1, nodes] ** 5 * weights).sum(axis=1), y**5, atol=1e-13)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"order": 1}, r"mesh\.order"),
        ({"around": 0}, r"mesh\.around"),
        ({"rows": 0}, r"mesh\.rows"),
        ({"rows": (0.0,)}, r"mesh\.rows"),
        ({"rows": (0.0, 0.5)}, r"mesh\.rows"),
        ({"rows": (0.1, 1.0)}, r"mesh\.rows"),
        ({"rows": (0.0, 0.6, 0.5, 1.0)}, r"mesh\.rows"),
        ({"rows": (0.0, 0.5, 0.5, 1.0)}, r"mesh\.rows"),
        ({"rows": (0.0, float("nan"), 1.0)}, r"mesh\.rows"),
    ],
)
def test_refuses_a_mesh_that_is_none(changes, message):
    with pytest.raises(ValueError, match=message):
        ShellMesh(**changes)
