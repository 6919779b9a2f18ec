"""A body in other coordinates is the same body: a rotation of its modes, made up for by coupling, changes no result."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

R = ct.rotor
RUN = {"t_end": 0.02, "dt": 2e-5}


def rotation(size):
    return np.linalg.qr(np.random.default_rng(1).standard_normal((size, size)))[0]


def turned(body):
    """The body in coordinates p of its modes q = P p, P a drawn rotation, coupled by stiffness and damping."""
    m = body.omega.size
    P = rotation(m)
    C, K = body.without_rotation().matrices()
    omega, zeta = body.omega.mean() * np.ones(m), 0.5 * body.zeta
    return replace(
        body, omega=omega, zeta=zeta, rows=body.rows @ P, stiffness=P.T @ K @ P - np.diag(omega**2),
        damping=P.T @ C @ P - np.diag(2.0 * zeta * omega),
        participation=None if body.participation is None else body.participation @ P,
    )  # fmt: skip


def lever(zeta=0.01):
    return ct.ModalBody(
        omega=[30.0, 70.0, 160.0], zeta=[zeta, 2.0 * zeta, zeta], channels=("x", "y"),
        rows=[[1.0, 0.4, -0.6], [0.3, -0.8, 0.5]], S=[[2e-5, 5e-6], [5e-6, 3e-5]],
    )  # fmt: skip


def patch(body, start):
    return ct.Patch(body=body, normal=("x", "y"), clearance=0.005, velocity=start)


@pytest.mark.slow
@pytest.mark.parametrize("zeta", [0.0, 0.01])
def test_events_of_a_body_in_other_coordinates_are_the_same(zeta):
    body, velocity, P = lever(zeta), np.array([-1.0, 0.3, 0.2]), rotation(3)
    one, two = (
        ct.run(patch(what, v), scheme=ct.scheme.EventDriven(), t_end=0.3, dt=1e-3, record=ct.Record(every=1))
        for what, v in ((body, velocity), (turned(body), P.T @ velocity))
    )
    assert np.count_nonzero(one.force) > 20
    np.testing.assert_allclose(two.gap, one.gap, atol=1e-9)
    np.testing.assert_allclose(two.impulse, one.impulse, rtol=1e-7)
    assert two.energy.lost_in_contact == pytest.approx(one.energy.lost_in_contact, rel=1e-6, abs=1e-12)
    assert two.energy.damping == pytest.approx(one.energy.damping, rel=1e-6, abs=1e-12)


def test_an_indefinite_stiffness_by_events_is_refused():
    body = replace(lever(), stiffness=np.array([[0.0, 5e3, 0.0], [5e3, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    with pytest.raises(ct.InputError, match="stiffness: found an indefinite matrix, expected a positive semidefinite"):
        ct.run(patch(body, [0.0, 0.0, 0.0]), scheme=ct.scheme.EventDriven(), t_end=0.01, dt=1e-3)


def tip():
    return ct.ModalBody(
        omega=2.0 * np.pi * np.array([150.0, 400.0]), zeta=[0.01, 0.02], channels=("span", "flap", "chord"),
        rows=[[0.2, 1.0], [1.0, -0.2], [0.0, 0.1]], S=1e-8 * np.eye(3),
    )  # fmt: skip


def stable(casing, blade, speed_hz=(50.0, 70.0, 100.0, 130.0), **more):
    rotor = R.Rotor.of(R.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02), 60.0, unbalance=R.Unbalance(moment=1e-2))
    rub = R.rotor_rub(rotor, casing, [blade], [ct.ContactPoint(lean_deg=20.0)], clearance=3e-4, **more)
    return ct.stability.rotor_stability(rub, speed_hz, mu=0.2)


def assert_same(one, two):
    for name in ("rub_force", "rub_orbit", "rub_growth", "dry_hz"):
        np.testing.assert_allclose(getattr(two, name), getattr(one, name), rtol=1e-5, err_msg=name)
    assert one.words == two.words


def test_whirl_with_a_blade_in_other_coordinates_is_the_same():
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1)
    one = stable(casing, tip())
    assert np.nanmax(one.rub_force) > 0.0
    assert_same(one, stable(casing, turned(tip())))
    stiff = np.diag([3.0, 1.0])
    faster = [ct.gaps.Stiffening(stiffness_by_speed=stiff, at_hz=10.0)]
    assert stable(casing, tip(), stiffening=faster).words != ""
    other = [ct.gaps.Stiffening(stiffness_by_speed=rotation(2).T @ stiff @ rotation(2), at_hz=10.0)]
    assert_same(stable(casing, tip(), stiffening=faster), stable(casing, turned(tip()), stiffening=other))


def test_whirl_with_a_blade_that_stiffens_is_that_of_a_stiffer_blade_at_one_speed():
    casing, stiff, hz = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1), np.array([3.0, 1.0]), 130.0
    blade = replace(tip(), rows=20.0 * tip().rows)
    squares = blade.omega**2 + (2.0 * np.pi) ** 2 * (hz**2 - 10.0**2) * stiff
    faster = [ct.gaps.Stiffening(stiffness_by_speed=np.diag(stiff), at_hz=10.0)]
    one = stable(casing, blade, [hz, 1.0001 * hz], stiffening=faster)
    two = stable(casing, replace(blade, omega=np.sqrt(squares)), [hz, 1.0001 * hz])
    assert one.rub_force[0] == pytest.approx(two.rub_force[0], rel=1e-9)
    assert one.rub_force[0] != pytest.approx(stable(casing, blade, [hz, 1.0001 * hz]).rub_force[0], rel=0.01)


def rims(which):
    """A rim, and the same with the modes of one body in other coordinates."""
    parts = {"casing": ring(), "blade": blade()}
    changed = parts | {which: turned(parts[which])}
    return [ct.RotatingRim(**each, clearance=-1e-5, speed_hz=20.0, lean_deg=25.0) for each in (parts, changed)]


@pytest.mark.parametrize("which", ["blade", "casing"])
def test_exact_growth_of_a_rim_in_other_coordinates_is_the_same(which):
    speeds = np.array([20.0, 37.0])
    one, two = (ct.stability.floquet_growth(rim, speeds, mu=0.3) for rim in rims(which))
    np.testing.assert_allclose(two, one, rtol=1e-5, atol=1e-5)
    assert np.ptp(one) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("which", ["blade", "casing"])
def test_a_rub_in_other_coordinates_is_the_same(which):
    one, two = (ct.run(rim, law=ct.Coulomb(mu=0.2), **RUN) for rim in rims(which))
    assert one.impulse[0] > 0.0
    np.testing.assert_allclose(two.force, one.force, rtol=1e-6, atol=1e-6 * one.force.max())
    np.testing.assert_allclose(two.gap, one.gap, atol=1e-6 * np.abs(one.gap).max())
