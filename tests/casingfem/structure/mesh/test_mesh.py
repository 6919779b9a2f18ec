"""Tensor meshes over charts: numbering, seam, edges, interpolation along a rim."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import casingfem as cf
from casingfem.structure.mesh.element import ElementQuadLobatto, gauss, lobatto
from casingfem.structure.mesh.shell_mesh import edge_breaks, make_grid, quads, rim_values, tensor_rule

CASING, PLATE = cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), cf.Plate(length=2.0, width=1.0)
GRADED = (0.0, 0.03, 0.5, 0.9, 1.0)


@pytest.mark.parametrize("order", range(2, 13))
@pytest.mark.parametrize("chart", [CASING, PLATE], ids=["casing", "plate"])
def test_neighbours_share_nodes_at_the_places_both_give_them(order, chart):
    grid = make_grid(chart, cf.ShellMesh(order=order, rows=GRADED, around=5))
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
    grid = make_grid(CASING, cf.ShellMesh(order=4, rows=GRADED, around=7))
    a, b = grid.parameters
    assert grid.measure.sum() == pytest.approx(0.25 * 2 * np.pi, rel=1e-13)
    assert (grid.measure * a**3).sum() == pytest.approx(0.25**4 / 4 * 2 * np.pi, rel=1e-12)
    assert (grid.measure * b**2).sum() == pytest.approx(0.25 * (2 * np.pi) ** 3 / 3, rel=1e-12)


@pytest.mark.parametrize(("chart", "length"), [(CASING, 2 * np.pi), (PLATE, 1.0)], ids=["casing", "plate"])
def test_edge_nodes_run_along_the_edge_with_weights_that_integrate(chart, length):
    grid = make_grid(chart, cf.ShellMesh(order=5, rows=2, around=4))
    for name, (held, end) in chart.edges.items():
        edge = grid.edges[name]
        places = grid.nodes[:, edge.nodes]
        assert np.all(places[held] == chart.bounds[held][end])
        assert np.all(np.diff(places[edge.along]) > 0)
        full = length if edge.along == 1 else np.diff(chart.bounds[0])[0]
        assert edge.weights.sum() == pytest.approx(full, rel=1e-13)


def test_edge_rule_integrates_polynomials_on_a_plate():
    grid = make_grid(PLATE, cf.ShellMesh(order=4, rows=2, around=3))
    edge = grid.edges["left"]
    x = grid.nodes[0, edge.nodes]
    assert edge.weights @ x**7 == pytest.approx(2.0**8 / 8, rel=1e-12)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=9), st.integers(0, 8))
def test_rim_interpolation_follows_waves_around_the_seam(angles, n):
    grid = make_grid(cf.Cylinder(radius=1.0, height=1.0), cf.ShellMesh(order=8, rows=1, around=11))
    nodes, weights = rim_values(grid, "top", np.array(angles))
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-11)
    values = (np.cos(n * grid.nodes[1, nodes]) * weights).sum(axis=1)
    np.testing.assert_allclose(values, np.cos(n * np.array(angles)), atol=2e-4)
    assert np.all(grid.nodes[0, nodes] == 1.0)


def test_rim_interpolation_is_exact_for_polynomials_on_an_open_edge():
    grid = make_grid(PLATE, cf.ShellMesh(order=5, rows=2, around=3))
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
        cf.ShellMesh(**changes)


def test_defaults_and_breaks_of_a_mesh():
    assert cf.ShellMesh() == cf.ShellMesh(order=8, rows=1, around=21)
    assert cf.ShellMesh(rows=4).breaks.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert cf.ShellMesh(rows=GRADED).breaks.tolist() == list(GRADED)


@pytest.mark.parametrize("changes", [{"order": 2}, {"order": 20}, {"around": 1}, {"rows": 1}, {"rows": (0.0, 1.0)},
                                     {"order": np.int64(3), "rows": np.int64(2), "around": np.int64(5)}])  # fmt: skip
def test_the_ends_of_what_a_mesh_may_be_are_taken(changes):
    assert cf.ShellMesh(**changes).breaks[-1] == 1.0


@pytest.mark.parametrize(("changes", "message"), [
    ({"order": 21}, r"mesh\.order must be a whole number from 2 to 20, found 21"),
    ({"order": 4.0}, r"mesh\.order .*found 4\.0"),
    ({"around": 2.5}, r"mesh\.around must be a whole number of at least 1, found 2\.5"),
])  # fmt: skip
def test_refuses_numbers_beyond_the_ends(changes, message):
    with pytest.raises(ValueError, match=message):
        cf.ShellMesh(**changes)


def test_a_mesh_of_more_unknowns_than_memory_has_is_refused():
    """5 x 20^2 x 10 x 100 = 2 000 000 unknowns are taken."""
    assert cf.ShellMesh(order=20, rows=10, around=100).around == 100
    with pytest.raises(ValueError, match=r"mesh: some 2e\+06 unknowns"):
        cf.ShellMesh(order=20, rows=10, around=101)
    with pytest.raises(ValueError, match="unknowns"):
        cf.ShellMesh(order=20, rows=tuple(np.linspace(0.0, 1.0, 12)), around=100)


def test_quadrature_points_run_along_the_second_coordinate_first():
    x, points, weights = tensor_rule(2)
    own, w = gauss(3)
    assert x.tolist() == own.tolist()
    assert points[:, 4].tolist() == [own[1], own[1]]
    assert points[:, 5].tolist() == [own[1], own[2]]
    np.testing.assert_allclose(weights, [a * b for a in w for b in w], rtol=1e-14)


def test_quantities_of_elements_of_different_sizes():
    """Rows from 0 to 0.6 and 2, three elements of width 1 from -1.5: element 4 is the middle one of the second row."""
    grid = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=2, rows=(0.0, 0.3, 1.0), around=3))
    np.testing.assert_allclose(grid.corner[:, 4], [0.6, -0.5], rtol=1e-14)
    np.testing.assert_allclose(grid.size[:, 4], [1.4, 1.0], rtol=1e-14)
    np.testing.assert_allclose(grid.middle[:, 0], [0.3] * 3 + [1.3] * 3, rtol=1e-14)
    a, b = grid.parameters
    np.testing.assert_allclose((a[4, 5], b[4, 5]), (0.6 + 1.4 * gauss(3)[0][1], -0.5 + gauss(3)[0][2]), rtol=1e-13)
    np.testing.assert_allclose(grid.measure[[1, 4]], np.outer([0.6, 1.4], grid.weights), rtol=1e-13)


@pytest.mark.parametrize(("held", "name"), [(0, "tip"), (1, "right")])
def test_elements_of_an_edge_have_their_nodes_and_weights(held, name):
    """Along x rows of 0.6 and 1.4, across three elements of 1."""
    grid = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=3, rows=(0.0, 0.3, 1.0), around=3))
    edge, spans = grid.edges[name], ([1.0, 1.0, 1.0], [0.6, 1.4])[held]
    assert edge.along == 1 - held
    assert edge.parts.tolist() == [[3 * k, 3 * k + 1, 3 * k + 2, 3 * k + 3] for k in range(len(spans))]
    np.testing.assert_allclose(edge.shares, np.outer(spans, lobatto(3)[1]), rtol=1e-13)
    whole = np.zeros(len(edge.nodes))
    for part, shares in zip(edge.parts, edge.shares, strict=True):
        whole[part] += shares
    np.testing.assert_allclose(edge.weights, whole, rtol=1e-13)
    places = grid.nodes[1 - held, edge.nodes]
    starts = np.cumsum([0.0, *spans[:-1]]) + (0.0 if held else -1.5)
    np.testing.assert_allclose(places[edge.parts], starts[:, None] + np.outer(spans, lobatto(3)[0]), atol=1e-13)


def test_the_last_element_of_a_closed_edge_ends_at_its_first_node():
    edge = make_grid(CASING, cf.ShellMesh(order=3, rows=1, around=4)).edges["top"]
    assert edge.parts.tolist() == [[0, 1, 2, 3], [3, 4, 5, 6], [6, 7, 8, 9], [9, 10, 11, 0]]
    assert edge.weights[0] == pytest.approx(2.0 * np.pi / 4 * 2.0 * lobatto(3)[1][0], rel=1e-13)


@pytest.mark.parametrize(("at", "row"), [(0.0, 0.0), (0.2, 0.0), (0.4, 0.6), (1.31, 2.0), (1.9, 2.0)])
def test_a_station_is_the_nearest_line_of_nodes_between_elements(at, row):
    chart = cf.Cylinder(radius=0.5, height=2.0)
    grid = make_grid(chart, cf.ShellMesh(order=3, rows=(0.0, 0.3, 1.0), around=5), {"there": at})
    edge = grid.edges["there"]
    np.testing.assert_allclose(grid.nodes[0, edge.nodes], row, atol=1e-14)
    assert edge.along == 1
    assert edge.parts[-1, -1] == 0
    assert edge.weights.sum() == pytest.approx(2.0 * np.pi, rel=1e-13)


@pytest.mark.parametrize(("name", "length"), [("left", 0.8), ("tip", 0.6 * 0.5)])
def test_lengths_of_the_edges_of_a_panel(name, length):
    chart = cf.Panel(radius=0.6, length=0.8, angle=0.5)
    grid = make_grid(chart, cf.ShellMesh(order=3, rows=2, around=3))
    edge = grid.edges[name]
    arc = edge.arc(chart.surface(*grid.nodes[:, edge.nodes], None))
    assert arc.shape == edge.nodes.shape
    assert arc.sum() == pytest.approx(length, rel=1e-13)


def test_an_element_is_cut_at_its_nodes_into_right_handed_quadrilaterals():
    grid = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=3, rows=2, around=2))
    cut = quads(grid)
    assert cut.shape == (4 * 9, 4)
    assert set(cut[9:18].ravel()) == set(grid.elements[1])
    corners = grid.nodes[:, cut]
    d = corners[:, :, [1, 2, 3, 0]] - corners
    assert np.all(d[0, :, [0, 2]] * [[1.0], [-1.0]] > 0.0)  # along x, then back
    np.testing.assert_allclose(d[1, :, [0, 2]], 0.0, atol=1e-14)
    areas = (corners[0, :, 1] - corners[0, :, 0]) * (corners[1, :, 2] - corners[1, :, 1])
    steps = np.diff(lobatto(3)[0])
    np.testing.assert_allclose(areas[:9].reshape(3, 3), 1.0 * 1.5 * np.outer(steps, steps), rtol=1e-12)


def test_breaks_of_an_edge_are_the_ends_of_its_elements():
    plate = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=3, rows=(0.0, 0.3, 1.0), around=3))
    np.testing.assert_allclose(edge_breaks(plate, "left"), [0.0, 0.6, 2.0], atol=1e-14)
    np.testing.assert_allclose(edge_breaks(plate, "root"), [-1.5, -0.5, 0.5, 1.5], atol=1e-14)
    casing = make_grid(CASING, cf.ShellMesh(order=3, rows=1, around=4))
    np.testing.assert_allclose(edge_breaks(casing, "base"), np.pi / 2.0 * np.arange(5), atol=1e-14)


def test_places_on_a_rim_are_seen_by_the_element_they_are_in():
    """On a line between two elements by the latter; beyond the ends of an open edge by the last one."""
    grid = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=2, rows=1, around=3))
    edge = grid.edges["tip"].nodes
    nodes, weights = rim_values(grid, "tip", np.array([-1.6, -0.5, 1.0, 1.5]))
    assert nodes.tolist() == [edge[k : k + 3].tolist() for k in (0, 2, 4, 4)]
    np.testing.assert_allclose((grid.nodes[1, nodes] * weights).sum(axis=1), [-1.6, -0.5, 1.0, 1.5], rtol=1e-12)
