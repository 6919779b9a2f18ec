"""A period is followed exactly, whatever the looks, and so is its derivative."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct
from reports.verification.schemes.cycles import mass_on_stop, rod
from tests.contact.cycles.bodies import random_body

pytestmark = pytest.mark.slow
HZ = 1.3 / (2.0 * math.pi)


def test_the_orbit_is_the_same_whatever_the_number_of_evaluations():
    driven = rod(4.0)
    few, *found = (ct.cycles.orbit(driven.over("freq_hz", freq_hz=10e3, looks=n), 10e3) for n in (10, 40, 300, 4800))
    for other in found:
        assert other.x == pytest.approx(few.x, abs=1e-10 * np.abs(few.x).max())
        assert other.multiplier == pytest.approx(few.multiplier, abs=1e-10)
        assert other.amplitude["x"] == pytest.approx(few.amplitude["x"], rel=1e-10)
        assert other.force == pytest.approx(few.force, rel=1e-11)


def test_an_orbit_of_the_rod_is_what_an_integrator_of_its_own_follows():
    driven = rod(4.0)
    family, freq_hz = driven.over("freq_hz", freq_hz=10e3), 10e3
    found = ct.cycles.orbit(family, freq_hz)
    body, k = driven.patch.body, float(driven.stiffness[0])
    tip, m = body.rows[0], body.omega.size

    def rate(t, state):
        q, v = state[:m], state[m:]
        force = driven.amplitude * math.cos(2.0 * math.pi * freq_hz * t) - k * max(tip @ q - 0.2e-3, 0.0)
        return np.concatenate([v, -2.0 * body.zeta * body.omega * v - body.omega**2 * q + tip * force])

    start = np.concatenate([found.x[:m], found.x[m:] * family.scale])
    run = solve_ivp(rate, (0.0, found.period), start, method="DOP853", rtol=1e-11, atol=1e-14, dense_output=True)
    size = np.abs(start).max(), np.abs(start[:m]).max()
    assert run.y[:m, -1] == pytest.approx(start[:m], abs=1e-7 * size[1])
    tips = tip @ run.sol(np.linspace(0.0, found.period, 20_001))[:m]
    assert found.amplitude["x"] == pytest.approx(np.abs(tips).max(), rel=1e-5)
    assert found.force[0] == pytest.approx(k * (tips.max() - 0.2e-3), rel=1e-4)


@pytest.mark.parametrize("slide", [12.0, -12.0])
def test_sliding_friction_is_what_an_integrator_of_its_own_follows(slide):
    """A block of three modes on a belt: normal and tangential motion coupled, the slip never turns."""
    rng, mu, k, m = np.random.default_rng(8), 0.4, 40.0, 3
    rows, omega = rng.standard_normal((2, m)), np.array([1.0, 1.7, 2.9])
    body = ct.ModalBody(omega=omega, zeta=np.full(m, 0.08), channels=("n", "t"), rows=rows, S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("n",), tangent=(("t",),), slide=slide, clearance=0.05)
    driven = ct.cycles.DrivenBody(patch=patch, channel="n", amplitude=0.3, stiffness=k, mu=mu)
    family = driven.over("freq_hz", freq_hz=0.2)
    found = ct.cycles.orbit(family, 0.2, settle=400)

    def rate(t, state):
        q, v = state[:m], state[m:]
        lam = k * max(-(0.05 + rows[0] @ q), 0.0)
        friction = -mu * lam * math.copysign(1.0, rows[1] @ v - slide)
        force = rows[0] * (lam + 0.3 * math.cos(2.0 * math.pi * 0.2 * t)) + rows[1] * friction
        return np.concatenate([v, force - 0.16 * omega * v - omega**2 * q])

    start = np.concatenate([found.x[:m], found.x[m:] * omega])
    run = solve_ivp(rate, (0.0, 5.0), start, method="DOP853", rtol=1e-11, atol=1e-13, dense_output=True)
    assert found.closings[0] > 0
    assert run.y[:, -1] == pytest.approx(start, abs=1e-8)
    side = rows[1] @ run.sol(np.linspace(0.0, 5.0, 5001))[:m]
    assert found.amplitude["t"] == pytest.approx(np.abs(side).max(), rel=1e-5)
    slow = replace(driven, patch=replace(patch, slide=1e-4 * slide))
    with pytest.raises(ct.NumericsError, match="contact 1 at the change from slip to stick"):
        ct.cycles.orbit(slow.over("freq_hz", freq_hz=0.2), 0.2)


def test_least_gap_of_an_orbit_without_contact_is_the_clearance_less_the_amplitude():
    free = replace(mass_on_stop(), patch=replace(mass_on_stop().patch, clearance=1.0))
    omega = 0.8
    found = ct.cycles.orbit(free.over("freq_hz", freq_hz=omega / (2.0 * math.pi)), omega / (2.0 * math.pi))
    amplitude = 0.02 / abs(1.0 - omega**2 + 0.05j * omega)
    assert found.amplitude["x"] == pytest.approx(amplitude, rel=1e-9)
    assert found.gap == pytest.approx([1.0 - amplitude], rel=1e-9)
    assert (found.closings, found.force[0]) == ((0,), 0.0)


def test_two_equal_stops_are_one_of_twice_the_stiffness():
    one = mass_on_stop(100.0)
    body = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "a", "b"), rows=[[1.0], [-1.0], [-1.0]],
                        S=np.zeros((3, 3)))  # fmt: skip
    patch = ct.Patch(body=body, normal=("a", "b"), clearance=0.1)
    two = replace(one, patch=patch, stiffness=50.0)
    freq_hz = 1.07511 / (2.0 * math.pi)
    orbits = [ct.cycles.orbit(driven.over("freq_hz", freq_hz=freq_hz), freq_hz) for driven in (one, two)]
    assert orbits[1].x == pytest.approx(orbits[0].x, abs=1e-12)
    assert orbits[1].multiplier == pytest.approx(orbits[0].multiplier, abs=1e-10)
    assert orbits[1].closings == (1, 1)
    assert orbits[1].contacts == 2
    assert orbits[1].force == pytest.approx([0.5 * orbits[0].force[0]] * 2, rel=1e-9)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"stiffness": 0.0}, "stiffness: found 0 N/m"),
        ({"restitution": 1.2}, "restitution: found"),
        ({"channel": "y"}, "channel: found 'y'"),
        ({"amplitude": -1.0}, "amplitude: found -1.0"),
        ({"mu": 0.1}, "mu: found friction, expected one tangent"),
    ],
)
def test_bad_input_names_its_field(given, words):
    with pytest.raises(ct.InputError, match=words):
        replace(mass_on_stop(100.0), **given)


def test_contacts_that_cannot_be_distinguished_are_refused():
    body = ct.ModalBody(omega=[1.0], zeta=[0.02], channels=("a", "b"), rows=[[-1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("a", "b"), clearance=0.1)
    with pytest.raises(ct.InputError, match="found linearly dependent rows"):
        ct.cycles.DrivenBody(patch=patch, channel="a", amplitude=0.5)


def test_an_undamped_mode_at_resonance_has_no_orbit():
    body = ct.ModalBody(omega=[2.0 * math.pi], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]])
    driven = ct.cycles.DrivenBody(
        patch=ct.Patch(body=body, normal=("x",), clearance=1.0), channel="x", amplitude=1.0, stiffness=1.0
    )
    with pytest.raises(ct.NumericsError, match="resonance"):
        ct.cycles.orbit(driven.over("freq_hz", freq_hz=1.0), 1.0)


@pytest.mark.parametrize("looks", [9, 12])
def test_the_least_gap_between_two_evaluations_is_found(looks):
    """Free motion before stops that it does not reach: gaps and amplitudes are those of many looks."""
    driven = replace(random_body(1, 2), amplitude=0.01)
    fine, coarse = (ct.cycles.orbit(driven.over("freq_hz", freq_hz=HZ, looks=n), HZ, settle=5) for n in (4096, looks))
    assert fine.closings == (0, 0)
    assert fine.gap.min() > 0.01
    assert coarse.gap == pytest.approx(fine.gap, rel=1e-9)
    assert coarse.amplitude["d"] == pytest.approx(fine.amplitude["d"], rel=1e-9)
