"""Nodal loads on curved shells against surface integrals, a deflection as a table, what rotation adds at a speed."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CONE = cf.Shell(
    chart=cf.Frustum(r_base=0.5, r_top=0.2, height=0.4), thickness=5e-3, material=STEEL,
    mesh=cf.ShellMesh(order=4, rows=(0.0, 0.3, 1.0), around=5),
)  # fmt: skip
GRID = cf.shell.assemble(CONE).grid
AREA = np.pi * 0.7 * 0.5


def test_a_surface_load_acts_on_the_area_of_each_node():
    area = cf.loads.node_surface(CONE, GRID)
    assert area.sum() == pytest.approx(AREA, rel=1e-12)
    assert area @ GRID.nodes[0] == pytest.approx(2 * np.pi * 0.5 * (0.5 * 0.4 / 2 - 0.3 * 0.4 / 3), rel=1e-12)
    nodal = cf.loads.SurfaceLoad(force=(2.0, -3.0, 5.0)).nodal(CONE, GRID)
    np.testing.assert_allclose(nodal, area[:, None] * np.array([2.0, -3.0, 5.0, 0.0, 0.0]), rtol=1e-15)


def test_a_pressure_acts_inwards_along_the_normal():
    """On a cone of slope 3 in 5 that narrows upwards: p A times 0.8 inwards and 0.6 down at each node."""
    nodal = cf.loads.Pressure(pressure=7.0).nodal(CONE, GRID)
    area, theta = 7.0 * cf.loads.node_surface(CONE, GRID), GRID.nodes[1]
    expected = area * np.array([-0.8 * np.cos(theta), -0.8 * np.sin(theta), -0.6 + 0.0 * theta])
    np.testing.assert_allclose(nodal[:, :3], expected.T, atol=1e-13)
    assert np.abs(nodal[:, 3:]).max() == 0.0
    assert nodal[:, 2].sum() == pytest.approx(-7.0 * np.pi * (0.5**2 - 0.2**2), rel=1e-12)


@pytest.mark.parametrize(("edge", "radius", "z"), [("base", 0.5, 0.0), ("top", 0.2, 0.4)])
def test_a_force_along_an_edge(edge, radius, z):
    nodal = cf.loads.EdgeLoad(edge=edge, force=(1.0, 2.0, -3.0)).nodal(CONE, GRID)
    np.testing.assert_allclose(nodal.sum(axis=0), 2.0 * np.pi * radius * np.array([1.0, 2.0, -3.0, 0, 0]), rtol=1e-12)
    assert np.abs(nodal[np.abs(GRID.nodes[0] - z) > 1e-9]).max() == 0.0
    with pytest.raises(ValueError, match="load: found edge 'rim', expected one of base, top"):
        cf.loads.EdgeLoad(edge="rim", force=(1.0, 0.0, 0.0)).nodal(CONE, GRID)


def test_a_point_load_has_its_place_and_direction():
    plate = cf.Shell(
        chart=cf.Plate(length=0.4, width=0.2), thickness=5e-3, material=STEEL, mesh=cf.ShellMesh(order=3, rows=2)
    )
    grid = cf.shell.assemble(plate).grid
    nodal = cf.loads.PointLoad(at=(0.13, -0.07), force=(1.0, -2.0, 4.0)).nodal(plate, grid)
    np.testing.assert_allclose(grid.nodes @ nodal[:, :3], np.outer([0.13, -0.07], [1.0, -2.0, 4.0]), atol=1e-13)
    np.testing.assert_allclose(nodal.sum(axis=0), [1.0, -2.0, 4.0, 0.0, 0.0], atol=1e-12)


def test_a_deflection_is_reported_as_a_table():
    shell = cf.Shell(
        chart=cf.Plate(length=0.4, width=0.2), thickness=5e-3, material=STEEL, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=3, rows=1, around=1),
    )  # fmt: skip
    loads = [
        cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, 2e3)),
        cf.loads.PointLoad(at=(0.2, 0.1), force=(0.0, 5e3, 0.0)),
    ]
    system = cf.shell.assemble(shell)
    bent, same = cf.shell.solve_static(shell, loads), cf.shell.solve_static(shell, loads, system=system)
    np.testing.assert_allclose(same.fields, bent.fields, rtol=1e-12)
    work = sum(np.sum(load.nodal(shell, system.grid) * bent.fields) for load in loads)
    assert bent.energy == pytest.approx(0.5 * work, rel=1e-9)
    table = bent.columns()
    assert list(table) == ["x_m", "y_m", "z_m", "u_x_m", "u_y_m", "u_z_m", "w_1_rad", "w_2_rad"]
    np.testing.assert_allclose([table["x_m"], table["y_m"], table["z_m"]], system.points.T, atol=1e-15)
    np.testing.assert_array_equal([table[name] for name in list(table)[3:]], bent.fields.T)
    corner = np.flatnonzero((system.points[:, 0] == 0.4) & np.isclose(system.points[:, 1], 0.1))[0]
    np.testing.assert_allclose(bent.at(0.4, 0.1), bent.fields[corner, :3], rtol=1e-9)
    most = np.linalg.norm(bent.fields[:, :3], axis=1).max()
    assert repr(bent) == f"Deflection(at most {most:.4g} m of 16 nodes, strain energy {bent.energy:.4g} J)"
    assert system.cells.tolist()[0][0] == 9
    assert system.cells.shape == (9, 5)
    with pytest.raises(ValueError, match="found no loads, expected at least one"):
        cf.shell.solve_static(shell, [])


def test_the_seam_of_a_tube_is_no_edge():
    mesh = cf.ShellMesh(order=2, rows=1, around=9)
    tube = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=5e-3, material=STEEL, mesh=mesh)
    grid = cf.shell.assemble(tube).grid
    area = cf.loads.node_surface(tube, grid)
    for z, part in ((0.0, 1 / 6), (0.15, 2 / 3), (0.3, 1 / 6)):
        here, whole = area[np.isclose(grid.nodes[0], z)], part * 0.3 * np.pi / 9
        assert (here.min(), here.max()) == pytest.approx((whole / 3, whole * 2 / 3), rel=1e-12)
