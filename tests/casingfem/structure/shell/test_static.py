"""Static solutions: equilibrium, closed forms, symmetry planes, and what is refused."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification import static as verify_static

SOFT = cf.Material(E=210e9, nu=0.0, rho=7800.0)
ROUND = cf.ShellMesh(order=5, rows=2, around=5)
MESH = cf.ShellMesh(order=5, rows=2, around=1)
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def strip(**changes):
    parts = {"chart": cf.Plate(length=1.0, width=0.1), "thickness": 0.01, "material": SOFT, "mesh": MESH}
    return cf.Shell(**(parts | {"supports": {"root": cf.Clamped()}} | changes))


@pytest.mark.parametrize(
    ("load", "total"),
    [
        (cf.loads.SurfaceLoad(force=(1.0, 2.0, -3.0)), (0.1, 0.2, -0.3)),
        (cf.loads.Pressure(pressure=5.0), (0.0, 0.0, 0.5)),
        (cf.loads.Gravity(acceleration=(0.0, -2.0, 0.0)), (0.0, -2.0 * 7800.0 * 1e-3, 0.0)),
        (cf.loads.EdgeLoad(edge="left", force=(0.0, 4.0, 0.0)), (0.0, 4.0, 0.0)),
        (cf.loads.PointLoad(at=(0.37, 0.021), force=(0.0, 0.0, 7.0)), (0.0, 0.0, 7.0)),
    ],
    ids=["surface", "pressure", "gravity", "edge", "point"],
)
def test_loads_add_up(load, total):
    system = cf.shell.assemble(strip(supports={}))
    np.testing.assert_allclose(load.nodal(system.shell, system.grid)[:, :3].sum(axis=0), total, rtol=1e-12, atol=1e-12)


def test_moment_of_a_point_load_is_that_of_its_place():
    system = cf.shell.assemble(strip(supports={}))
    nodal = cf.loads.PointLoad(at=(0.37, 0.021), force=(0.0, 0.0, 1.0)).nodal(system.shell, system.grid)
    np.testing.assert_allclose(nodal[:, 2] @ system.points, [0.37, 0.021, 0.0], atol=1e-13)


def test_beam_under_its_own_weight():
    """q L^4/(8 E I) + q L^2/(2 kappa G A)."""
    q, inertia, area = 7800.0 * 9.80665 * 1e-3, 0.1 * 0.01**3 / 12, 1e-3
    exact = q / (8 * 210e9 * inertia) + q / (2 * 5 / 6 * 105e9 * area)
    assert cf.solve_static(strip(), [cf.loads.Gravity()]).at(1.0, 0.0)[2] == pytest.approx(-exact, rel=1e-7)


@pytest.mark.slow
def test_tube_under_pressure():
    """Closed by diaphragms that let it lengthen, thin, far from its ends: u_r = p R^2/(E t)."""
    tube = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=2.0),
        thickness=5e-3,
        material=STEEL,
        supports={"base": cf.ShearDiaphragm(), "top": cf.ElasticEdge(k_z=1e3)},
        mesh=cf.ShellMesh(order=8, rows=4, around=5),
    )
    moved = cf.solve_static(tube, [cf.loads.Pressure(pressure=-1e5)]).at(1.0, 0.7)
    assert np.hypot(*moved[:2]) == pytest.approx(1e5 * 0.25 / (210e9 * 5e-3), rel=2e-4)
    assert moved[:2] @ [np.cos(0.7), np.sin(0.7)] > 0.0


def test_loads_superpose_and_work_both_ways():
    """Betti: the work of one load on the other's displacement is the same both ways."""
    one, two = (
        cf.loads.PointLoad(at=(0.6, 0.03), force=(0.0, 0.0, 3.0)),
        cf.loads.EdgeLoad(edge="tip", force=(0.0, 1.0, 2.0)),
    )
    shell = strip(chart=cf.geometry.TwistedPlate(length=1.0, width=0.1, twist=0.5), material=STEEL)
    a, b, both = (cf.solve_static(shell, loads) for loads in ([one], [two], [one, two]))
    np.testing.assert_allclose(both.fields, a.fields + b.fields, rtol=1e-6, atol=1e-9 * np.abs(both.fields).max())
    work = [np.sum(load.nodal(shell, a.grid) * state.fields) for load, state in ((one, b), (two, a))]
    assert work[0] == pytest.approx(work[1], rel=1e-7)


@pytest.mark.slow
def test_half_a_structure_on_its_symmetry_plane_is_the_whole():
    whole = cf.Shell(
        chart=cf.Panel(radius=0.5, length=0.6, angle=1.2),
        thickness=5e-3,
        material=STEEL,
        supports={"root": cf.ShearDiaphragm(), "tip": cf.ShearDiaphragm()},
        mesh=cf.ShellMesh(order=6, rows=4, around=2),
    )
    half = cf.Shell(
        chart=cf.Panel(radius=0.5, length=0.3, angle=1.2),
        thickness=5e-3,
        material=STEEL,
        supports={"root": cf.ShearDiaphragm(), "tip": cf.edge.Symmetry()},
        mesh=cf.ShellMesh(order=6, rows=2, around=2),
    )
    load = cf.loads.SurfaceLoad(force=(-1e4, 0.0, 0.0))
    places = [(0.3, 0.6), (0.3, 0.0), (0.1, -0.4)]
    found = [np.array([cf.solve_static(shell, [load]).at(*place) for place in places]) for shell in (whole, half)]
    found[0][:, 2] -= cf.solve_static(whole, [load]).at(0.3, 0.0)[2]  # the whole may slide along its axis
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6, atol=1e-6 * np.abs(found[0]).max())


def test_corner_of_two_symmetry_planes_is_fixed_by_both():
    quarter = strip(supports={"root": cf.edge.Symmetry(), "left": cf.edge.Symmetry()}, material=STEEL)
    system = cf.shell.assemble(quarter)
    corner = np.flatnonzero((system.grid.nodes[0] == 0.0) & np.isclose(system.grid.nodes[1], -0.05))
    reached = np.abs(system.expand(np.eye(system.size))[corner[0]]).max(axis=1)
    np.testing.assert_allclose(reached, [0.0, 0.0, 1.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("supports", "loads", "code"),
    [
        ({"root": cf.Clamped()}, [], "load-none"),
        ({"root": cf.Clamped()}, [cf.loads.EdgeLoad(edge="rim", force=(0.0, 0.0, 1.0))], "load-edge"),
        ({"root": cf.Clamped()}, [cf.loads.PointLoad(at=(1.01, 0.0), force=(0.0, 0.0, 1.0))], "load-place"),
        ({}, [cf.loads.Gravity()], "static-loose"),
        ({"left": cf.edge.Symmetry()}, [cf.loads.Gravity()], "static-loose"),
    ],
)
def test_refused(supports, loads, code):
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.solve_static(strip(supports=supports), loads)
    assert caught.value.code == code


@pytest.mark.slow
def test_a_ring_has_loads_and_its_weight_is_refused():
    """A ring stiffens the loaded edge of a tube; gravity would miss its mass."""
    parts = {"chart": cf.Cylinder(radius=0.2, height=0.1), "thickness": 2e-3, "material": STEEL, "mesh": ROUND}
    ring = cf.Ring(section=cf.edge.Section.rectangle(width=0.02, depth=0.02))
    plain, ringed = (cf.Shell(**parts, supports={"base": cf.Clamped()} | top) for top in ({}, {"top": ring}))
    push = [cf.loads.PointLoad(at=(0.1, 0.0), force=(1.0, 0.0, 0.0))]
    bare, stiff = (cf.solve_static(shell, push).at(0.1, 0.0)[0] for shell in (plain, ringed))
    assert 0.0 < stiff < 0.2 * bare
    with pytest.raises(cf.errors.ModelError, match="load-ring"):
        cf.solve_static(ringed, [cf.loads.Gravity()])


@pytest.mark.slow
def test_obstacle_set_lies_within_a_hundredth(tmp_path, capsys):
    rows = verify_static.rows(quick=False)
    assert len(rows) == 9
    assert [str(row["verdict"]).split()[0] for row in rows] == ["pass", "a"] + ["pass"] * 7
    errors = [float(str(row["error %"])) for row in rows]
    assert max(abs(error) for error in errors[2:]) < 0.5
    assert len(verify_static.main(tmp_path, quick=True)) == 6
    assert "hole deg" in capsys.readouterr().out


def test_a_wrong_twist_sense_is_not_the_twisted_beam():
    """In plane and out of plane are not the same number: the rows can fail."""
    assert verify_static.beam(0.32, 1.0, (0.0, 0.0, 1.0)) > 3.0 * verify_static.beam(0.32, 1.0, (0.0, 1.0, 0.0))


def test_a_cone_has_no_plane_of_symmetry_at_its_rim(frustum):
    with pytest.raises(cf.errors.ModelError, match="symmetry-slanted"):
        frustum(supports={"base": cf.edge.Symmetry()})
    bowl = cf.Revolved(profile=cf.geometry.Arc(radius=0.5, start=0.0, end=1.0))  # at the equator it has one
    cf.Shell(chart=bowl, thickness=3e-3, material=STEEL, supports={"base": cf.edge.Symmetry(), "top": cf.Clamped()})
    with pytest.raises(cf.errors.ModelError, match="symmetry-slanted"):
        cf.Shell(chart=bowl, thickness=3e-3, material=STEEL, supports={"top": cf.edge.Symmetry()})
