"""Whirl frequencies, critical speeds, unbalance response and stability of rotors against equations of their own."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import contact as ct

R = ct.rotor
LENGTH, DIAMETER, E, MASS, POLAR, DIAMETRAL = 0.4, 0.03, 210e9, 12.0, 0.12, 0.07
EI = E * np.pi * DIAMETER**4 / 64.0
COMPLIANCE = np.array([[LENGTH**3 / 3.0, LENGTH**2 / 2.0], [LENGTH**2 / 2.0, LENGTH]]) / EI  # of a clamped beam's end
STIFF = np.linalg.inv(COMPLIANCE)


def overhung():
    """A disk on the end of a massless clamped shaft: x, ry, y and -rx."""
    zero = np.zeros((2, 2))
    sign = np.diag([1.0, 1.0, 1.0, -1.0])
    K = sign @ np.block([[STIFF, zero], [zero, STIFF]]) @ sign
    G = np.zeros((4, 4))
    G[1, 3], G[3, 1] = POLAR, -POLAR
    M = np.diag([MASS, DIAMETRAL, MASS, DIAMETRAL])
    dofs = [(1, d) for d in ("x", "ry", "y", "rx")]
    return ct.ModalBody.from_matrices(M, K, G=sign @ G @ sign, dofs=dofs, contact=dofs)


def determinant(w, W):
    """Of circular whirl at w (forward > 0) of the overhung disk turning at W, by its compliance."""
    inertia = np.diag([MASS * w * w, DIAMETRAL * w * w - POLAR * W * w])
    return np.linalg.det(np.eye(2) - COMPLIANCE @ inertia)


def roots(W, sign):
    grid = sign * np.linspace(0.5, 4000.0, 4_001)
    value = np.array([determinant(w, W) for w in grid])
    at = np.flatnonzero(value[:-1] * value[1:] < 0.0)
    return np.sort([abs(brentq(determinant, grid[k], grid[k + 1], args=(W,), xtol=1e-13)) for k in at])


@pytest.mark.slow
@pytest.mark.parametrize("hz", [5.0, 60.0, 150.0])
def test_overhung_disk_whirls_forward_and_backward_at_the_roots_of_its_determinant(hz):
    found = R.campbell(R.Rotor.of(overhung(), hz), [hz])
    for sense, sign in (("forward", 1.0), ("backward", -1.0)):
        exact = roots(2.0 * np.pi * hz, sign) / (2.0 * np.pi)
        assert exact.size
        np.testing.assert_allclose(found.of(sense)[0][: exact.size], exact, rtol=1e-8)


def test_senses_change_names_where_the_rotor_turns_the_other_sense():
    rotor = R.Rotor.of(overhung(), 60.0)
    ahead, mirrored = R.campbell(rotor, [60.0]), R.campbell(rotor, [-60.0])
    for sense in ("forward", "backward"):
        np.testing.assert_allclose(ahead.of(sense)[0], mirrored.of(sense)[0], rtol=1e-10)


def test_whirl_frequencies_of_the_shaft_with_little_mass_are_those_of_the_massless_one():
    clamp = R.Bearing(at=0.0, kxx=1e13, k_tilt=1e12)
    piece = R.Piece(length=LENGTH, diameter=DIAMETER, E=E, rho=1e-3, nu=0.3, elements=6)
    disk = R.Disk(at=LENGTH, mass=MASS, polar=POLAR, diametral=DIAMETRAL)
    rotor = R.Rotor.of(R.Shaft(pieces=[piece], disks=[disk], bearings=[clamp]), 60.0)
    shear = LENGTH / (piece.shear * E / 2.6 * piece.area)
    soft = COMPLIANCE + np.diag([shear, 0.0])
    for hz in (0.0, 60.0):
        W = 2.0 * np.pi * hz
        found = R.campbell(rotor, [hz])
        lowest = found.of("forward")[0][0] if hz else found.freq_hz[0]
        whirl = 2.0 * np.pi * lowest
        inertia = np.diag([MASS * whirl**2, DIAMETRAL * whirl**2 - POLAR * W * whirl])
        assert abs(np.linalg.det(np.eye(2) - soft @ inertia)) < 1e-5


def test_a_simply_supported_timoshenko_beam_has_its_exact_frequencies():
    """Sine modes: rho^2 I/(k G) w^4 - (rho A + ...) w^2 + EI b^4 = 0, per unit length (Timoshenko 1921)."""
    length, d = 1.0, 0.1
    piece = R.Piece(length=length, diameter=d, E=E, rho=7800.0, nu=0.3, elements=48)
    pins = [R.Bearing(at=z, kxx=1e13) for z in (0.0, length)]
    found = R.campbell(R.Rotor.of(R.Shaft(pieces=[piece], bearings=pins), 0.0, at=0.5), [0.0]).freq_hz
    stiff = piece.shear * E / 2.6 * piece.area
    for n in (1, 2):
        b = n * np.pi / length
        a, A, J = piece.rho, piece.area, piece.inertia
        quadratic = [a * a * A * J / stiff, -(a * A + a * J * b * b + a * A * E * J * b * b / stiff), E * J * b**4]
        exact = np.sqrt(np.roots(quadratic).real.min()) / (2.0 * np.pi)
        np.testing.assert_allclose(found[2 * n - 2 : 2 * n], exact, rtol=5e-5)


def test_a_rigid_tilt_of_a_stepped_shaft_has_the_inertia_of_its_cylinders_and_turns_by_their_polar_moment():
    """rho (A z^2 + I) along the shaft, and 2 rho I between the planes, however few the elements."""
    pieces = [R.Piece(length=0.1, diameter=0.06, elements=1), R.Piece(length=0.3, diameter=0.03, elements=2)]
    shaft = R.Shaft(pieces=pieces, bearings=[R.Bearing(at=0.0, kxx=1e7)])
    found, z = shaft.matrices(), shaft.nodes - 0.17
    one, other = (
        np.array([{way: z[node - 1], turn: sense}.get(d, 0.0) for node, d in found.dofs])
        for way, turn, sense in (("x", "ry", 1.0), ("y", "rx", -1.0))
    )
    diametral = sum(p.rho * (p.area * (b**3 - a**3) / 3.0 + p.inertia * (b - a))
                    for p, a, b in zip(pieces, (-0.17, -0.07), (-0.07, 0.23), strict=True))  # fmt: skip
    polar = sum(2.0 * p.rho * p.inertia * p.length for p in pieces)
    for tilt in (one, other):
        assert tilt @ found.M @ tilt == pytest.approx(diametral, rel=1e-12)
    assert one @ found.G @ other == pytest.approx(polar, rel=1e-12)
    assert other @ found.G @ one == pytest.approx(-polar, rel=1e-12)


def test_critical_speeds_are_where_the_whirl_frequency_is_the_speed():
    rotor = R.Rotor.of(overhung(), 0.0)
    critical = R.critical_speeds(rotor)
    assert [one["sense"] for one in critical[:2]] == ["backward", "forward"]
    for one in critical[:2]:
        whirl = R.campbell(rotor, [one["speed_hz"]]).of(one["sense"])[0]
        assert np.abs(whirl / one["speed_hz"] - 1.0).min() < 1e-8


def test_unbalance_response_on_unequal_supports_has_a_backward_part():
    body = ct.ModalBody(
        omega=[100.0, 140.0], zeta=[0.02, 0.02], channels=("d.x", "d.y"), rows=np.eye(2), S=np.zeros((2, 2))
    )
    W = 120.0
    found = R.unbalance_response(R.Rotor.of(body, 1.0, unbalance=R.Unbalance(moment=1.0)), [W / (2.0 * np.pi)])
    x, y = (W**2 / (w * w - W * W + 2j * 0.02 * w * W) for w in (100.0, 140.0))
    assert found.forward[0] == pytest.approx(0.5 * (x + y), rel=1e-9)
    assert abs(found.backward[0]) == pytest.approx(0.5 * abs(x - y), rel=1e-9)


@pytest.mark.parametrize("speeds", [[80.0, np.nan], [np.inf, 80.0], [[10.0, 20.0]]])
@pytest.mark.parametrize("answer", [R.unbalance_response, R.campbell])
def test_speeds_are_a_list_of_finite_numbers(answer, speeds):
    rotor = R.Rotor.of(R.Jeffcott(mass=1.0, stiffness=400.0, zeta=0.01), 1.0, unbalance=R.Unbalance(moment=1e-4))
    with pytest.raises(ct.InputError, match=r"speed_hz: found .*, expected a list of finite speeds"):
        answer(rotor, speeds)


def test_stability_map_finds_the_threshold_of_internal_damping():
    inner = R.Jeffcott(mass=2.0, stiffness=8e4, zeta=0.03, zeta_internal=0.02)
    found = ct.stability.of_rotor(R.Rotor.of(inner, 1.0), np.linspace(1.0, 150.0, 30))
    exact = inner.omega * (1.0 + 0.03 / 0.02) / (2.0 * np.pi)
    assert found.bands_hz[0][0] == pytest.approx(exact, rel=1e-6)


def test_cross_coupled_bearings_destabilise_where_their_work_exceeds_the_damping():
    """k_c r beyond c w: of a rigid mass on one bearing, w = sqrt(k/m)."""
    m, k, c = 5.0, 2e6, 400.0
    body = [
        ct.ModalBody.from_matrices(
            m * np.eye(2), [[k, kc], [-kc, k]], c * np.eye(2), dofs=[(1, "x"), (1, "y")], contact=[1], nonsymmetric=True
        )
        for kc in (0.99 * c * np.sqrt(k / m), 1.01 * c * np.sqrt(k / m))
    ]
    rates = [R.campbell(R.Rotor.of(one, 1.0), [10.0]).growth.max() for one in body]
    assert rates[0] < 0.0 < rates[1]


ROSS_CRITICAL = [91.7898326, 96.29661317, 271.28522677, 300.38458856, 636.09122779, 866.90896183, 1045.28280239]
ROSS_WHIRL = [91.56162911, 96.45747282, 265.41862166, 305.37247739, 658.31289265, 821.19430854, 1062.76763362]


def test_equal_critical_speeds_of_an_isotropic_rotor_are_one_forward_and_one_backward():
    disk = R.Jeffcott(mass=10.0, stiffness=4e6)
    c, n = np.cos(0.5), np.sin(0.5)
    oblique = replace(disk.body(), rows=disk.body().rows @ [[c, n], [-n, c]])
    for what in (disk, oblique):
        first, second = R.critical_speeds(R.Rotor.of(what, 50.0))[:2]
        assert first["speed_hz"] == pytest.approx(second["speed_hz"], rel=1e-9)
        assert {first["sense"], second["sense"]} == {"forward", "backward"}


@pytest.mark.parametrize("matrices", [True, False])
def test_a_rotor_of_ross_has_the_same_critical_speeds_by_its_matrices_and_by_its_sizes(matrices):
    """Two disks on a shaft on bearings that are softer along y; speeds [rad/s] of ROSS 2.3.0, whirl at 500 rad/s.

    `run_critical_speed().wn()` and `run_modal(500).wd` without torsion; M, K, C and G are those of x, y, rx and ry.
    """
    if matrices:
        with np.load(Path(__file__).with_name("ross_rotor.npz")) as kept:
            M, K, C, G = (kept[name] for name in "MKCG")
        dofs = [(node, axis) for node in range(1, 8) for axis in ("x", "y", "rx", "ry")]
        rotor = R.Rotor.of(ct.ModalBody.from_matrices(M, K, C, G=G, dofs=dofs, contact=[3]), 10.0, at="3")
    else:
        piece = R.Piece(length=1.5, diameter=0.05, E=211e9, rho=7810.0, nu=211.0 / (2.0 * 81.2) - 1.0, elements=6)
        disk = {"mass": 32.58972765304033, "polar": 0.32956362089137037, "diametral": 0.17808928257067666}
        soft = {"kxx": 1e6, "kyy": 8e5, "cxx": 1e2, "cyy": 1e2}
        rotor = R.Rotor.of(
            R.Shaft(
                pieces=[piece], disks=[R.Disk(at=z, **disk) for z in (0.5, 1.0)],
                bearings=[R.Bearing(at=z, **soft) for z in (0.0, 1.5)],
            ), 10.0,
        )  # fmt: skip
    turn = 2.0 * np.pi
    critical = [turn * one["speed_hz"] for one in R.critical_speeds(rotor)[: len(ROSS_CRITICAL)]]
    np.testing.assert_allclose(critical, ROSS_CRITICAL, rtol=5e-4)
    whirl = turn * R.campbell(rotor, [500.0 / turn]).freq_hz[: len(ROSS_WHIRL)]
    np.testing.assert_allclose(whirl, ROSS_WHIRL, rtol=5e-4)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: R.Jeffcott(mass=-1.0, stiffness=1.0), "mass: found -1.0"),
        (lambda: R.Jeffcott(mass=1.0, stiffness=0.0), "stiffness: found 0.0"),
        (lambda: R.Jeffcott(mass=1.0, stiffness=1.0, zeta=-0.1), "zeta: found -0.1"),
        (lambda: R.Piece(length=1.0, diameter=0.1, inner_diameter=0.2), "inner_diameter: found 0.2 m"),
        (lambda: R.Piece(length=1.0, diameter=0.1, nu=0.6), "nu: found 0.6"),
        (lambda: R.Disk(at=0.0, mass=1.0, polar=0.3, diametral=0.1), "at most twice the diametral"),
        (lambda: R.Bearing(at=0.0, kxx=-1.0), "kxx: found -1.0"),
        (lambda: R.Unbalance(moment=-1.0), "moment: found -1.0"),
        (lambda: R.Release(time=-1.0, moment=1.0), "time: found -1.0"),
        (lambda: R.Shaft(pieces=[], bearings=[R.Bearing(at=0.0, kxx=1.0)]), "no piece"),
        (lambda: R.Shaft(pieces=[R.Piece(length=1.0, diameter=0.1)]), "no bearing"),
        (
            lambda: R.Shaft(pieces=[R.Piece(length=1.0, diameter=0.1)], bearings=[R.Bearing(at=1.5, kxx=1.0)]),
            r"bearings\[0\].at: found 1.5 m",
        ),
        (lambda: R.Rotor.of(overhung(), 1.0, at="7"), "found '7.x'"),
        (lambda: R.Rotor.of(overhung(), 1.0, gravity=-9.81), "gravity: found -9.81"),
    ],
)
def test_rotors_that_cannot_be_are_refused(make, words):
    with pytest.raises(ct.InputError, match=words):
        make()
