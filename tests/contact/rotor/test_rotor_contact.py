"""A rotor whose tips rub on a casing: synchronous rub, blade-off, momentum and energy, what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import contact as ct
from tests.contact.rotor.penalty_rotor import penalty_run

R = ct.rotor
M, K, ZETA = 10.0, 4e6, 0.1
CASING = {"radius": 0.25, "mass": 20.0, "stiffness": 2e7, "zeta": 0.1}
ALL = ct.Record(every=1, state_every=1)


def jeffcott(hz, *, zeta=ZETA, inner=0.0, **more):
    return R.Rotor.of(R.Jeffcott(mass=M, stiffness=K, zeta=zeta, zeta_internal=inner), hz, **more)


def disk(rub, result):
    return result.state_of("rotor") @ (rub.rotor.plane[0] + 1j * rub.rotor.plane[1])


def tips(angles, **more):
    return {
        "blades": [R.rigid_tip()] * len(angles),
        "tips": [ct.gaps.ContactPoint(blade=j, angle_deg=float(a)) for j, a in enumerate(angles)],
    } | more


@pytest.mark.slow
def test_open_rotor_in_a_casing_moves_like_the_rotor_alone_to_second_order():
    release = R.Release(time=0.1, moment=5e-2, angle_deg=90.0)
    rotor = jeffcott(80.0, zeta=0.02, unbalance=R.Unbalance(moment=1e-3, angle_deg=-30.0, release=release))
    rub = R.rotor_rub(rotor, R.rigid_casing(**CASING), clearance=2e-2, **tips([0.0]))
    errors = []
    for dt in (1e-4, 5e-5):
        record = ct.Record(every=10, state_every=10)
        found, alone = (ct.run(what, t_end=0.3, dt=dt, record=record) for what in (rub, rotor))
        exact = alone.state @ (rotor.plane[0] + 1j * rotor.plane[1])
        errors.append(np.abs(disk(rub, found) - exact).max() / np.abs(exact).max())
        assert abs(found.energy.unaccounted) < 1e-10 * found.energy.scale
    assert errors[1] < 3e-5
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_synchronous_rub_is_that_of_the_algebraic_solution(sense):
    """One tip stays closed: r Z_r = U W^2 - F (1 + i mu) e, s Z_s = F (1 + i mu) e, Re((r - s) e*) = c."""
    W, mu, clearance, U = 2.0 * np.pi * 60.0, 0.1, 1e-3, 2e-2
    rotor = jeffcott(sense * 60.0, unbalance=R.Unbalance(moment=U))
    place = tips([-15.0 * sense])
    rub = R.rotor_rub(rotor, R.rigid_casing(**CASING), clearance=clearance, **place)
    result = ct.run(rub, law=ct.Coulomb(mu=mu), t_end=0.5, dt=2e-5, record=ALL)
    e = np.exp(-1j * np.radians(15.0))
    of_rotor, of_casing = (
        k - m * W**2 + 2j * zeta * np.sqrt(k * m) * W
        for m, k, zeta in ((M, K, ZETA), (CASING["mass"], CASING["stiffness"], CASING["zeta"]))
    )
    soft = (1.0 + 1j * mu) * (1.0 / of_rotor + 1.0 / of_casing)
    force = ((U * W**2 / of_rotor * e.conjugate()).real - clearance) / soft.real
    radius = abs((U * W**2 - force * (1.0 + 1j * mu) * e) / of_rotor)
    last = slice(-1000, None)
    assert result.force[last].mean() == pytest.approx(force, rel=2e-4)
    assert np.abs(disk(rub, result)[last]).mean() == pytest.approx(radius, rel=1e-5)
    swing = np.hypot(*result.state_of("casing")[last, :2].T).mean() / np.sqrt(CASING["mass"])
    assert swing == pytest.approx(abs(force * (1.0 + 1j * mu) / of_casing), rel=2e-4)
    assert abs(result.energy.unaccounted) < 1e-10 * result.energy.scale


@pytest.mark.slow
def test_blade_off_of_eleven_tips_has_the_impulses_of_a_fine_penalty_model():
    clearance, k, mu, release = 5e-4, 2e7, 0.1, 0.01
    angles = np.arange(1, 12) * 30.0  # the blade at 0 degrees is lost
    lost = R.Release(time=release, moment=2.5e-2)
    rotor = jeffcott(70.0, zeta=0.05, unbalance=R.Unbalance(moment=1e-4, release=lost))
    rub = R.rotor_rub(rotor, R.rigid_casing(**CASING), clearance=clearance, **tips(angles))
    law = ct.laws.Hertz(k=k, exponent=1.0, mu=mu)
    result = ct.run(rub, law=law, t_end=0.1, dt=1e-5, record=ALL)
    damped = [np.array([m, s, 2.0 * z * np.sqrt(s * m)]) for m, s, z in ((M, K, 0.05), (20.0, 2e7, 0.1))]
    impulse, _, places = penalty_run(
        2e-7, 500_000, 50, *damped, 2.0 * np.pi * 70.0, clearance, np.array([1e-4 + 0j, 2.51e-2 + 0j]), release,
        np.radians(angles), k, mu, 0.25, np.inf,
    )  # fmt: skip
    assert np.count_nonzero(impulse) == 4
    np.testing.assert_allclose(result.impulse, impulse, rtol=2e-3, atol=1e-9)
    found = disk(rub, result)
    x = places[: found.size, 0]
    assert np.abs(found - x).max() < 5e-3 * np.abs(x).max()
    bearings = ct.recovery.support_forces(rub, result)["bearings"] @ np.array([1.0, 1j])
    fine = -K * x - damped[0][2] * np.gradient(x, 1e-5)
    assert np.abs(bearings - fine).max() < 2e-2 * np.abs(fine).max()


@pytest.mark.slow
def test_friction_stops_a_rotor_that_is_pressed_all_around_at_the_rate_of_its_torque():
    """Twelve tips press with k times the interference: J dOmega/dt = T - mu R N, the energy turns to heat."""
    k, mu, inertia, torque, squeeze = 1e6, 0.2, 0.05, 5.0, 1e-5
    force = 12.0 * k * squeeze
    rub = R.rotor_rub(
        jeffcott(50.0), R.rigid_casing(**CASING), clearance=-squeeze, spin=R.Spin(inertia=inertia, torque=torque),
        **tips(np.arange(12) * 30.0),
    )  # fmt: skip
    result = ct.run(rub, law=ct.laws.Hertz(k=k, exponent=1.0, mu=mu), t_end=0.2, dt=1e-4, record=ALL)
    rate = (torque - mu * CASING["radius"] * force) / inertia
    ahead = result.state_of("spin")[:, 0] / np.sqrt(inertia)
    np.testing.assert_allclose(np.diff(ahead, 2)[1:] / 1e-8, rate, rtol=1e-5)
    start, t = 2.0 * np.pi * 50.0, 0.2
    end = start + rate * t
    given = 0.5 * inertia * (start**2 - end**2) + torque * 0.5 * (start + end) * t
    assert result.notes.heat.sum() == pytest.approx(given, rel=1e-4)
    assert abs(result.energy.unaccounted) < 1e-10 * result.energy.scale


@pytest.mark.slow
def test_energy_and_momentum_of_a_rotor_that_slows_are_accounted_to_round_off():
    """All that casing, disk, shaft, spin and unbalance store, against the drive, damping and what contacts take."""
    release = R.Release(time=0.01, moment=1e-1, angle_deg=40.0)
    rotor = R.Rotor.of(shaft(), 60.0, unbalance=R.Unbalance(moment=1e-3, release=release), modes=8)
    rub = R.rotor_rub(
        rotor, R.rigid_casing(**CASING), clearance=3e-4, profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": 5e-5}]),
        spin=R.Spin(inertia=0.4, torque=60.0), **tips(np.arange(6) * 60.0),
    )  # fmt: skip
    result = ct.run(rub, law=ct.Coulomb(mu=0.15), t_end=0.05, dt=5e-6)
    energy, spin, speed = result.energy, result.notes.spin, 2.0 * np.pi * 60.0
    assert min(-spin.friction, abs(spin.rotation), abs(spin.unbalance), abs(spin.gyroscopic), spin.shared_end) > 1e-9
    assert result.impulse.max() > 1.0
    assert abs(energy.unaccounted) < 1e-10 * energy.scale
    assert abs(spin.unaccounted) < 1e-12 * spin.start
    assert abs(spin.momentum_unaccounted) < 1e-12 * spin.momentum_start
    stored = energy.end.discrete - energy.start.discrete + speed * (spin.momentum_end - spin.momentum_start)
    stored += spin.shared_end - spin.shared_start - spin.released - 60.0 * speed * 0.05
    heat = result.notes.drive.sum() - energy.friction
    assert heat == pytest.approx(result.notes.heat.sum(), rel=1e-4)
    bearings = energy.external + spin.gyroscopic  # their cross-coupled stiffness
    assert abs(stored - energy.contact - energy.damping - energy.algorithmic - bearings + heat) < 1e-12 * spin.start


def test_a_rotor_that_its_drive_takes_beyond_the_known_speeds_ends_with_an_error():
    def driven(**more):
        rub = R.rotor_rub(
            R.Rotor.of(shaft(), 10.0, modes=4), R.rigid_casing(**CASING), clearance=1e-2,
            spin=R.Spin(inertia=0.01, torque=20.0, **more), **tips([0.0]),
        )  # fmt: skip
        return ct.run(rub, t_end=0.02, dt=5e-5)

    with pytest.raises(ct.NumericsError, match=r"outside 0 to 12 Hz.*most_hz"):
        driven()
    assert driven(most_hz=20.0).notes.orbit.speed_hz_end == pytest.approx(10.0 + 20.0 * 0.02 / 0.02 / np.pi, rel=5e-3)


@pytest.mark.slow
def test_speed_after_a_blade_off_falls_as_in_a_fine_penalty_model():
    clearance, k, mu, inertia = 5e-4, 2e7, 0.1, 0.05
    angles = np.arange(1, 12) * 30.0
    rotor = jeffcott(70.0, zeta=0.05, unbalance=R.Unbalance(moment=2.5e-2))
    rub = R.rotor_rub(
        rotor, R.rigid_casing(**CASING), clearance=clearance, spin=R.Spin(inertia=inertia), **tips(angles)
    )  # fmt: skip
    damped = [np.array([m, s, 2.0 * z * np.sqrt(s * m)]) for m, s, z in ((M, K, 0.05), (20.0, 2e7, 0.1))]
    start = 2.0 * np.pi * 70.0
    impulse, speed, places = penalty_run(
        2e-7, 300_000, 50, *damped, start, clearance, np.array([2.5e-2 + 0j, 2.5e-2 + 0j]), 0.0, np.radians(angles), k,
        mu, 0.25, inertia,
    )  # fmt: skip
    result = ct.run(rub, law=ct.laws.Hertz(k=k, exponent=1.0, mu=mu), t_end=0.06, dt=1e-5, record=ALL)
    ahead = result.state_of("spin")[:, 0] / np.sqrt(inertia)
    fallen = (ahead[-1] - ahead[-2]) / 1e-5
    assert speed - start < -50.0
    assert fallen == pytest.approx(speed - start, rel=5e-3)
    np.testing.assert_allclose(result.impulse, impulse, rtol=1e-2, atol=1e-9)
    assert np.abs(disk(rub, result) - places[: len(ahead), 0]).max() < 1e-2 * np.abs(places).max()


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "stays"), [(0.99, False), (1.01, True)])
def test_dry_whirl_rolls_on_above_the_lower_speed_of_black(factor, stays):
    """A rotor that rolls backward at w = R Omega/c needs mu >= |Im B/Re B| of B = 1/Z_rotor + 1/Z_casing at w.

    Black, J. Mech. Eng. Sci. 10, 1968, 1. The lower speed is c w/R of the w where mu suffices.
    """
    clearance, mu, zeta = 1e-3, 0.3, 0.05
    radius, bodies = CASING["radius"], ((M, K), (CASING["mass"], CASING["stiffness"]))

    def soft(w):
        return np.array([1.0 / (k - m * w * w + 2j * zeta * np.sqrt(k * m) * w) for m, k in bodies])

    w = factor * brentq(lambda w: ((1.0 - 1j * mu) * soft(w).sum()).imag, 1000.0, 1300.0)
    force = -clearance / np.conj(soft(w).sum())
    places = np.array([-force, force]) * np.conj(soft(w))  # of disk and casing; both turn by e^(-i w t)
    rotor = jeffcott(w * clearance / (2.0 * np.pi * radius), zeta=zeta)
    n = 240
    rub = R.rotor_rub(
        rotor, R.rigid_casing(**CASING | {"zeta": zeta}), clearance=clearance, **tips(np.arange(n) * 360.0 / n)
    )  # fmt: skip
    scale = np.sqrt([CASING["mass"], M])
    start = (scale * places[::-1])[:, None]
    q, v = (np.hstack([part.real, part.imag]).ravel() for part in (start, -1j * w * start))
    rub = replace(rub, casing_start=replace(rub.casing_start, displacement=q, velocity=v))
    result = ct.run(rub, law=ct.Coulomb(mu=mu), t_end=0.1, dt=1e-5, record=ALL)
    found = disk(rub, result)
    assert bool(abs(found[-1]) > 0.9 * abs(places[0])) == stays
    if stays:
        turned = np.unwrap(np.angle(found))
        assert (turned[-1] - turned[len(turned) // 2]) / (0.05 * w) == pytest.approx(-1.0, rel=0.01)


def shaft():
    bearing = {"kxx": 2e7, "kyy": 3e7, "kxy": 4e6, "kyx": -4e6, "cxx": 2e3}
    return R.Shaft(
        pieces=[R.Piece(length=0.5, diameter=0.05, elements=3)],
        disks=[R.Disk(at=0.3, mass=12.0, polar=0.2, diametral=0.11)],
        bearings=[R.Bearing(at=0.0, **bearing), R.Bearing(at=0.5, kxx=5e7, cxx=1e3)],
    )


@pytest.mark.slow
def test_energy_of_a_rubbing_shaft_with_gyroscopic_disk_is_accounted_to_round_off():
    release = R.Release(time=0.01, moment=1e-1)
    speed = ct.Speed(time=[0.0, 0.05], hz=[60.0, 50.0])
    rotor = R.Rotor.of(shaft(), speed, unbalance=R.Unbalance(release=release), modes=8, gravity=9.80665)
    rub = R.rotor_rub(rotor, R.rigid_casing(**CASING), clearance=3e-4, **tips(np.arange(6) * 60.0))
    result = ct.run(rub, law=ct.Coulomb(mu=0.15), t_end=0.05, dt=5e-6)
    assert result.impulse.max() > 1.0
    assert abs(result.energy.unaccounted) < 1e-10 * result.energy.scale


@pytest.mark.slow
def test_disk_without_shaft_and_casing_without_mounts_keep_their_momentum():
    """Both are free within 1e-4 of their motion, so that contact and friction leave M x + M_c s as it is."""
    rotor = R.Rotor.of(R.Jeffcott(mass=M, stiffness=1e-3), 50.0, velocity=np.sqrt(M) * np.array([1.0, 0.5]))
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=1e-3)
    rub = R.rotor_rub(rotor, casing, clearance=1e-3, **tips(np.arange(12) * 30.0))
    result = ct.run(rub, law=ct.Coulomb(mu=0.2), t_end=0.02, dt=1e-5, record=ALL)
    s = result.state_of("casing")[:, :2] @ np.array([1.0, 1j]) / np.sqrt(20.0)
    momentum = (M * np.diff(disk(rub, result)) + 20.0 * np.diff(s)) / 1e-5
    assert result.impulse.sum() > 1.0
    np.testing.assert_allclose(momentum, M * (1.0 + 0.5j), rtol=1e-6)


def test_rotors_that_no_rub_can_have_are_refused():
    casing, varying = R.rigid_casing(**CASING), ct.Speed(time=[0.0, 1.0], hz=[10.0, 20.0])
    with pytest.raises(ct.InputError, match="internal damping and a speed that varies"):
        R.rotor_rub(jeffcott(varying, inner=0.01), casing, [R.rigid_tip()])
    still = ct.ModalBody(
        omega=[700.0], zeta=[0.0], channels=("radial.cos0", "tangential.cos0"), rows=[[1.0], [0.0]],
        S=np.zeros((2, 2)), kind="rim", n_max=0, radius=0.45,
    )  # fmt: skip
    with pytest.raises(ct.InputError, match="found n_max = 0"):
        R.rotor_rub(jeffcott(10.0), still, [R.rigid_tip()])
    with pytest.raises(ct.InputError, match="axial friction on a rotor"):
        R.rotor_rub(jeffcott(10.0), casing, [R.rigid_tip()], [ct.gaps.ContactPoint(axial="chord")])
    with pytest.raises(ct.InputError, match="mass: found"):
        R.rigid_casing(radius=0.25, mass=0.0, stiffness=1.0)
    with pytest.raises(ct.InputError, match="expected a rub from"):
        ct.Rub(
            casing,
            [R.rigid_tip()],
            rotor=R.Rotor.of(
                R.Shaft(pieces=[R.Piece(length=0.5, diameter=0.05)], bearings=[R.Bearing(at=0.0, kxx=1e7)]), 10.0
            ),
        )
