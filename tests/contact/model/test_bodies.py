"""Rods, masses and walls as nodes and chains; hinged beams: numbers worked out by hand."""

import math

import numpy as np
import pytest

import contact as ct

ROD = ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0, elements=3, x=1.0, velocity=-2.0, end_mass=0.25, damping=0.5)


def test_what_a_rod_is():
    assert (ROD.wave_speed, ROD.impedance, ROD.mass, ROD.end, ROD.crossing_time) == (2.0, 2.0, 3.0, 4.0, 0.5)
    plain = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0)
    assert (plain.elements, plain.x, plain.velocity, plain.end_mass, plain.damping) == (100, 0.0, 0.0, 0.0, 0.0)
    assert (plain.force, plain.force_hz, plain.force_deg) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("fixed", "left", "right", "mass", "held"),
    [
        ("none", True, False, [0.75, 1.0, 1.0, 0.5], []), ("none", False, True, [0.5, 1.0, 1.0, 0.75], []),
        ("left", True, False, [0.5, 1.0, 1.0, 0.75], [0]), ("right", False, True, [0.75, 1.0, 1.0, 0.5], [3]),
    ],
)  # fmt: skip
def test_nodes_of_a_rod(fixed, left, right, mass, held):
    rod = ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0, elements=3, x=1.0, end_mass=0.25, damping=0.5, fixed=fixed)
    nodes = rod.nodes(has_left=left, has_right=right)
    assert nodes.position.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert nodes.mass.tolist() == mass
    assert np.flatnonzero(nodes.held).tolist() == held
    assert nodes.springs.tolist() == [4.0, 4.0, 4.0, 0.0]
    assert nodes.damping.tolist() == [0.5 * m for m in mass]
    assert (nodes.ground.tolist(), nodes.stretch.tolist()) == ([0.0] * 4, [0.0] * 4)


@pytest.mark.parametrize(
    ("make", "name", "value"),
    [
        (ct.PointMass, "mass", 0.0), (ct.PointMass, "x", math.nan), (ct.PointMass, "velocity", math.inf),
        (ct.PointMass, "force", math.nan), (ct.PointMass, "force_deg", math.nan), (ct.PointMass, "stiffness", -1.0),
        (ct.PointMass, "damping", -1.0), (ct.PointMass, "force_hz", -1.0), (ct.PointMass, "anchor", math.nan),
        (ct.Wall, "x", math.inf), (ct.Rod, "area", 0.0), (ct.Rod, "E", -1.0), (ct.Rod, "rho", 0.0),
        (ct.Rod, "x", math.nan), (ct.Rod, "velocity", math.nan), (ct.Rod, "end_mass", -1.0),
        (ct.Rod, "damping", -1.0), (ct.Rod, "elements", 0),
    ],
)  # fmt: skip
def test_bodies_that_cannot_be_are_refused(make, name, value):
    given = {ct.Rod: {"length": 1.0, "area": 1.0, "E": 1.0, "rho": 1.0}, ct.PointMass: {"mass": 1.0}, ct.Wall: {}}
    with pytest.raises(ct.InputError, match=f"{name}: found {value}"):
        make(**given[make] | {name: value})


def test_defaults_of_a_mass_and_a_wall():
    mass, wall = ct.PointMass(mass=1.0), ct.Wall()
    assert (mass.x, mass.velocity, mass.stiffness, mass.stretch, mass.end) == (0.0,) * 5
    assert (mass.damping, mass.force, mass.force_hz, mass.force_deg) == (0.0,) * 4
    assert (wall.x, wall.end, wall.velocity, wall.force, wall.force_hz, wall.force_deg) == (0.0,) * 6
    assert mass.moves
    assert not wall.moves
    assert ct.PointMass(mass=1.0, x=2.0, anchor=0.5).stretch == 1.5


MASS = ct.PointMass(mass=1.0, x=1.0)


@pytest.mark.parametrize(
    ("bodies", "words"),
    [
        ([MASS], "bodies: found 1, expected at least two, or one and a wall"),
        (
            [ct.PointMass(mass=1.0, x=3.5), ROD],
            r"x: body 2 \(rod at x = 1\) and body 1 \(pointmass at x = 3\.5\) overlap by 0\.5 m, expected a gap >= 0",
        ),
        (
            [ct.PointMass(mass=1.0, x=9.0), ct.PointMass(mass=1.0, x=3.5), ROD],  # the first and the last pair
            r"x: body 3 \(rod at x = 1\) and body 2 \(pointmass at x = 3\.5\) overlap by 0\.5 m",
        ),
        (
            [ROD, ct.PointMass(mass=1.0, x=0.5), ct.PointMass(mass=1.0, x=3.5)],
            r"x: body 1 \(rod at x = 1\) and body 3 \(pointmass at x = 3\.5\) overlap by 0\.5 m",
        ),
        (
            [
                ct.PointMass(mass=1.0, x=9.0),
                ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="left", x=0.5),
                ct.Wall(),
            ],
            r"between body 3 \(wall at x = 0\) and body 2 \(rod at x = 0\.5\)",
        ),
        (
            [ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="left", x=0.5), ct.Wall()],
            r"between body 2 \(wall at x = 0\) and body 1 \(rod at x = 0\.5\)",
        ),
    ],
)
def test_bodies_that_cannot_meet_are_refused(bodies, words):
    with pytest.raises(ct.InputError, match=words):
        ct.run(bodies, t_end=1.0, courant=0.5)


def test_gravity_that_is_no_number_is_refused():
    with pytest.raises(ct.InputError, match="gravity: found nan"):
        ct.run([MASS, ct.Wall()], gravity=math.nan, t_end=1.0, dt=0.1)


HINGED = ct.bodies.HingedBeam(
    length=0.6, width=0.03, height=0.01, E=70e9, rho=2700.0, elements=3, torque=2.0, angle_deg=30.0
)


def test_a_hinged_beam_by_hand():
    assert HINGED.area == pytest.approx(3e-4)
    assert HINGED.second_moment == pytest.approx(2.5e-9)
    assert HINGED.mass == pytest.approx(0.486)
    assert HINGED.inertia == pytest.approx(0.486 * 0.36 / 3.0)
    a = math.radians(30.0)
    expected = [[s * math.cos(a), s * math.sin(a), a] for s in (0.0, 0.2, 0.4, 0.6)]
    np.testing.assert_allclose(HINGED.nodes(), expected, atol=1e-15)
    lumped = HINGED.lumped()
    assert lumped[:, 0] == pytest.approx(0.81 * np.array([0.1, 0.2, 0.2, 0.1]))
    assert lumped[:, 1].tolist() == lumped[:, 0].tolist()
    assert lumped[:, 2] == pytest.approx(2700.0 * 2.5e-9 * np.array([0.1, 0.2, 0.2, 0.1]))
    plain = ct.bodies.HingedBeam(length=0.6, width=0.03, height=0.01, E=70e9, rho=2700.0)
    assert (plain.elements, plain.torque, plain.angle_deg, plain.spin) == (40, 0.0, 0.0, 0.0)


def test_the_fastest_vibration_of_an_element_of_a_beam():
    """Its stiffness of Bernoulli's theory, and half of its mass and rotary inertia at each end."""
    L, EA, EI = 0.2, 70e9 * 3e-4, 70e9 * 2.5e-9
    K = np.zeros((6, 6))
    K[np.ix_([0, 3], [0, 3])] = EA / L * np.array([[1, -1], [-1, 1]])
    bend = [[12, 6 * L, -12, 6 * L], [6 * L, 4 * L**2, -6 * L, 2 * L**2], [-12, -6 * L, 12, -6 * L],
            [6 * L, 2 * L**2, -6 * L, 4 * L**2]]  # fmt: skip
    K[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = EI / L**3 * np.array(bend)
    M = np.diag(np.tile(0.5 * L * 2700.0 * np.array([3e-4, 3e-4, 2.5e-9]), 2))
    fastest = math.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real.max())
    assert HINGED.omega_max() == pytest.approx(fastest, rel=1e-9)


def test_gaps_and_first_contact_of_a_beam_in_a_circle():
    scene = ct.bodies.BeamInCircle(HINGED, radius=0.605, offset=0.02)
    nodes = np.array([[0.5, 0.2, 9.0], [-0.1, -0.3, 9.0]])
    assert scene.gaps(nodes) == pytest.approx([0.605 - math.hypot(0.48, 0.2), 0.605 - math.hypot(0.12, 0.3)])
    angle = scene.first_contact_angle
    assert math.hypot(0.6 * math.cos(angle) - 0.02, 0.6 * math.sin(angle)) == pytest.approx(0.605, rel=1e-12)
    assert ct.bodies.BeamInCircle(HINGED, radius=0.605).offset == 0.0


@pytest.mark.parametrize(("torque", "spin"), [(2.0, 0.0), (2.0, 3.0), (0.0, 3.0)])
@pytest.mark.parametrize("angle_deg", [30.0, 390.0, -40.0])
def test_the_time_to_first_contact_is_that_of_a_rigid_beam(torque, spin, angle_deg):
    beam = ct.bodies.HingedBeam(length=0.6, width=0.03, height=0.01, E=70e9, rho=2700.0,
                                torque=torque, angle_deg=angle_deg, spin=spin)  # fmt: skip
    scene = ct.bodies.BeamInCircle(beam, radius=0.605, offset=0.02)
    t = scene.first_contact_time
    start = math.radians(angle_deg - 360.0 if angle_deg > 360.0 else angle_deg)
    assert start + spin * t + 0.5 * torque / beam.inertia * t**2 == pytest.approx(scene.first_contact_angle, rel=1e-12)


@pytest.mark.parametrize(
    ("torque", "spin", "words"),
    [(0.0, 0.0, "torque: found 0 N m and a spin of 0 rad/s"), (-1.0, 2.0, "torque: found -1.0"),
     (1.0, -2.0, "spin: found -2.0")],
)  # fmt: skip
def test_a_beam_that_does_not_turn_to_the_circle_has_no_time(torque, spin, words):
    beam = ct.bodies.HingedBeam(length=0.6, width=0.03, height=0.01, E=70e9, rho=2700.0, torque=torque, spin=spin)
    with pytest.raises(ct.InputError, match=words):
        _ = ct.bodies.BeamInCircle(beam, radius=0.605, offset=0.02).first_contact_time


@pytest.mark.parametrize("name", ["length", "width", "height", "E", "rho"])
def test_hinged_beams_have_sizes_above_zero(name):
    with pytest.raises(ct.InputError, match=f"{name}: found 0.0"):
        ct.bodies.HingedBeam(**{"length": 0.6, "width": 0.03, "height": 0.01, "E": 70e9, "rho": 2700.0} | {name: 0.0})
