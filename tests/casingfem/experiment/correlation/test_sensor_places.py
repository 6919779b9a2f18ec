"""Where sensors stand: nearest points inside and beyond the edges, how far they may be, nodes of imported parts."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.sensors import nearest, on_wall, sensors_at_nodes
from tests.casingfem.structure.imported.parts import added_nodes


def surface(shell, points):
    return np.real(shell.geometry(*nearest(shell, points)).surface.x).T


def test_nearest_points_of_a_plate_end_at_its_edges(steel):
    plate = cf.Shell(chart=cf.Plate(length=0.4, width=0.3), thickness=2e-3, material=steel)
    low, high = np.array([0.0, -0.15, 0.0]), np.array([0.4, 0.15, 0.0])
    away = low + (high - low) * np.array(
        [[0.3, 0.7, 0.0], [-0.1, 0.2, 0.0], [1.1, 0.4, 0.0], [0.6, -0.2, 0.0], [0.8, 1.3, 0.0], [1.2, -0.4, 0.0]]
    )
    away[:, 2] = np.linspace(-0.02, 0.03, 6)
    np.testing.assert_allclose(surface(plate, away), np.clip(away, low, high), atol=1e-12)


def test_nearest_points_of_a_cone_lie_on_its_line_or_at_its_ends(steel):
    """Beside it, inside and outside, across the seam, above the top, below the base."""
    cone = cf.Shell(chart=cf.Frustum(r_base=0.5, r_top=0.4, height=0.2), thickness=2e-3, material=steel)
    line, slope = np.array([0.5, 0.0]), np.array([-0.1, 0.2])
    where = np.array([[0.46, 0.1], [0.5, 0.12], [0.42, 0.1], [0.41, 0.25], [0.49, -0.03]])  # radius, height
    angles = np.array([0.3, -0.01, 3.1, 4.0, 6.2])
    part = np.clip((where - line) @ slope / (slope @ slope), 0.0, 1.0)
    r, z = (line + part[:, None] * slope).T
    exact = np.column_stack([r * np.cos(angles), r * np.sin(angles), z])
    points = np.column_stack([where[:, 0] * np.cos(angles), where[:, 0] * np.sin(angles), where[:, 1]])
    np.testing.assert_allclose(surface(cone, points), exact, atol=1e-9)


@pytest.mark.parametrize(
    ("height", "tolerance", "near"),
    [(0.0099, None, True), (0.0101, None, False), (0.03, 0.03, True), (0.003, 0.002, False)],
)
def test_a_sensor_may_be_a_fiftieth_of_the_size_away_or_as_far_as_is_said(height, tolerance, near, steel):
    """Of a plate of .3 by .4, whose diagonal is .5."""
    plate = cf.Shell(chart=cf.Plate(length=0.4, width=0.3), thickness=2e-3, material=steel)
    where = np.array([[0.1, 0.05, 0.0], [0.2, 0.1, height]])
    if near:
        assert on_wall(plate, where, np.array([4, 9]), tolerance=tolerance)[2] == pytest.approx(
            [0.0, height], abs=1e-12
        )
        return
    with pytest.raises(cf.errors.ModelError, match=f"sensor 9 at .* m is {height:g} m from the wall"):
        on_wall(plate, where, np.array([4, 9]), tolerance=tolerance)


def test_sensors_of_an_imported_part_are_at_its_nearest_nodes_that_cells_use():
    """Sides of 4, 2 and 1; a node of no cell stands where the second sensor is."""
    grid = cf.imported.grid_mesh("hexahedron", (2, 1, 1), lambda u: u * (4.0, 2.0, 1.0))
    mesh, _ = added_nodes(grid, [2.05, 0.06, 0.01])
    part, out = SimpleNamespace(mesh=mesh), np.eye(3)[:2]
    points = np.array([[3.96, 2.0, 1.03], [2.05, 0.06, 0.01]])
    allowed = 0.02 * mesh.size
    assert allowed == pytest.approx(0.02 * np.sqrt(21.0), rel=1e-12)
    found = sensors_at_nodes(part, points, out)
    np.testing.assert_allclose(mesh.points[found.nodes[:, 0]], [[4.0, 2.0, 1.0], [2.0, 0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(
        found.distance, np.linalg.norm(points - mesh.points[found.nodes[:, 0]], axis=1), rtol=1e-12
    )
    assert found.labels.tolist() == [1, 2]
    assert len(found) == 2
    assert found.weights.tolist() == [[1.0], [1.0]]
    assert np.isnan(found.a).all()
    assert np.isnan(found.b).all()
    fields = np.arange(5.0 * 3 * len(mesh.points)).reshape(-1, 5, 3)
    np.testing.assert_array_equal(found.shapes(fields), [fields[found.nodes[k, 0], k] for k in range(2)])
    assert sensors_at_nodes(part, points, out, [7, 7]).labels.tolist() == [7, 7]
    assert sensors_at_nodes(part, points - [0.3, 0.0, 0.0], out, tolerance=0.4).distance.max() < 0.4
    with pytest.raises(cf.errors.ModelError, match=r"sensor 8 at .* from a node, 0\.07 m are allowed"):
        sensors_at_nodes(part, points, out, [7, 8], tolerance=0.07)
    with pytest.raises(cf.errors.ModelError, match=r"from a node, 0\.09165 m are allowed"):
        sensors_at_nodes(part, points - [0.05, 0.06, 0.0], out)
