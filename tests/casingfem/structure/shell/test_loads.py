"""Nodal loads on curved shells against surface integrals, a deflection as a table, what rotation adds at a speed."""

import warnings

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.structure.shell.assembly import spin
from casingfem.structure.shell.nodal_mass import nodal_mass
from casingfem.structure.shell.prestress import Spin

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CONE = cf.Shell(
    chart=cf.Frustum(r_base=0.5, r_top=0.2, height=0.4), thickness=5e-3, material=STEEL,
    mesh=cf.ShellMesh(order=4, rows=(0.0, 0.3, 1.0), around=5),
)  # fmt: skip
GRID = make_grid(CONE.chart, CONE.mesh)
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


def test_weight_by_the_mass_of_each_node():
    nodal = cf.loads.Gravity().nodal(CONE, GRID)
    mass = 7800.0 * 5e-3 * cf.loads.node_surface(CONE, GRID)
    np.testing.assert_allclose(nodal[:, :3], mass[:, None] * np.array([0.0, 0.0, -9.80665]), rtol=1e-12)
    centre = nodal_mass(CONE, GRID)  # the wall's own centre lies outside of the mid-surface: a moment on the normal
    np.testing.assert_allclose(nodal[:, 3:], -9.80665 * centre.moments[:, 1:2] * centre.tangents[:, 2], atol=1e-15)
    assert np.abs(nodal[:, 3]).max() > 0.0
    weighed = cf.Shell(
        chart=CONE.chart, thickness=5e-3, material=STEEL, masses={"top": [cf.edge.EdgeMass(angle=0.0, mass=1.0)]}
    )
    with pytest.raises(ValueError, match="gravity: found a ring or point masses on an edge"):
        cf.loads.Gravity().nodal(weighed, make_grid(weighed.chart, weighed.mesh))


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
    grid = make_grid(plate.chart, plate.mesh)
    nodal = cf.loads.PointLoad(at=(0.13, -0.07), force=(1.0, -2.0, 4.0)).nodal(plate, grid)
    np.testing.assert_allclose(grid.nodes @ nodal[:, :3], np.outer([0.13, -0.07], [1.0, -2.0, 4.0]), atol=1e-13)
    np.testing.assert_allclose(nodal.sum(axis=0), [1.0, -2.0, 4.0, 0.0, 0.0], atol=1e-12)


def test_each_side_of_a_strip_has_its_own_mass():
    """4 mm up to the line at 0.12 m, 5 mm beyond: a node on the line has a part of both."""
    strips = (cf.Strip(start=0.0, end=0.12, thickness=4e-3),)
    mass = nodal_mass(
        cf.Shell(chart=CONE.chart, thickness=5e-3, material=STEEL, mesh=CONE.mesh, strips=strips), GRID
    ).moments
    low, high = np.pi * (0.5 + 0.41) * 0.15, np.pi * (0.41 + 0.2) * 0.35
    np.testing.assert_allclose(mass[:, 0].sum(), 7800.0 * (4e-3 * low + 5e-3 * high), rtol=1e-12)
    np.testing.assert_allclose(mass[:, 2].sum(), 650.0 * (4e-3**3 * low + 5e-3**3 * high), rtol=1e-12)
    on = np.abs(GRID.nodes[0] - 0.12) < 1e-9
    below, above = (2 * np.pi * 0.41 * length / 20 * 1.25 for length in (0.12, 0.28))  # Lobatto's first weight: 1/20
    assert mass[on, 0].sum() == pytest.approx(7800.0 * (4e-3 * below + 5e-3 * above), rel=1e-12)


def test_a_deflection_is_told_as_a_table():
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


@pytest.mark.parametrize(("omega", "warned"), [(9.9, False), (10.1, True)])
def test_what_rotation_adds_at_a_speed(omega, warned):
    """omega^2 K1 + omega^4 K2; quadratic strains of 0.003 omega^2 are doubted from 0.3 on."""
    one, two = csc_array([[2.0, 1.0], [1.0, 5.0]]), csc_array([[0.0, 3.0], [3.0, 0.5]])
    spin = Spin(K1=one, K2=two, G=one, fields=np.zeros((1, 5)), nonlinear=0.003)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        K = spin.stiffness(omega)
    expected = omega**2 * one.toarray() + omega**4 * two.toarray()
    np.testing.assert_allclose(K.toarray(), expected, rtol=1e-15)
    words = [" found quadratic strains of 0.31 times the linear ones"]
    assert [str(w.message).split(":")[1] for w in told] == words * warned


def test_quadratic_strains_of_a_spinning_bar():
    """nu = 0: u' = rho/(2 E) ((h + L)^2 - (h + x)^2) and u'^2/2, their energies by 8 points of Gauss."""
    bar = cf.Plate(length=0.2, width=0.04)
    soft, rotation = cf.Material(E=210e9, nu=0.0, rho=7800.0), cf.Rotation.of_blade(bar, omega=1.0, hub_radius=0.3)
    mesh = cf.ShellMesh(order=4, rows=1, around=1)
    system = cf.shell.assemble(
        cf.Shell(chart=bar, thickness=3e-3, material=soft, supports={"root": cf.Clamped()}, mesh=mesh)
    )
    found = spin(system, rotation)
    x, w = np.polynomial.legendre.leggauss(8)
    strain = 7800.0 / 420e9 * (0.25 - (0.4 + 0.1 * x) ** 2)
    assert found.nonlinear == pytest.approx(np.sqrt((w @ strain**4 / 4.0) / (w @ strain**2)), rel=1e-9)
    tip = np.isclose(system.grid.nodes[0], 0.2)
    np.testing.assert_allclose(found.fields[tip, 0], 0.1 * w @ strain, rtol=1e-9)


def test_the_seam_of_a_tube_is_no_edge():
    mesh = cf.ShellMesh(order=2, rows=1, around=9)
    tube = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=5e-3, material=STEEL, mesh=mesh)
    grid = make_grid(tube.chart, mesh)
    area = cf.loads.node_surface(tube, grid)
    for z, part in ((0.0, 1 / 6), (0.15, 2 / 3), (0.3, 1 / 6)):
        here, whole = area[np.isclose(grid.nodes[0], z)], part * 0.3 * np.pi / 9
        assert (here.min(), here.max()) == pytest.approx((whole / 3, whole * 2 / 3), rel=1e-12)
