"""Orbits whose shape and multipliers are known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import contact as ct
from contact.cycles.passage import passage
from tests.contact.cycles.bodies import random_body

pytestmark = pytest.mark.slow  # they compile the loop of a phase

G = 9.81


def ball(force, e=0.5, height=0.0):
    """A ball of 1 kg over a table that moves by force/w^2 cos(w t), in the table's frame."""
    body = ct.ModalBody(omega=[0.0], zeta=[0.0], channels=("y",), rows=[[1.0]], S=[[0.0]])
    patch = ct.Patch(body=body, normal=("y",), load=[-G], displacement=[height])
    return ct.cycles.DrivenBody(patch=patch, channel="y", amplitude=force, restitution=e)


def ball_orbit(force, w, e):
    """State in mid-flight (height, velocity) and its fraction of the period; multipliers of the impact map.

    The table's velocity at the impact is (g T/2)(1 - e)/(1 + e), trace = 1 + e^2 + (1 + e)^2 y''/g, determinant e^2.
    """
    T, A = 2.0 * math.pi / w, force / w**2
    phase = -math.asin(0.5 * G * T * (1.0 - e) / (1.0 + e) / (A * w))  # where the table slows down
    table = A * math.cos(phase)
    acceleration = -A * w**2 * math.cos(phase)
    trace = 1.0 + e**2 + (1.0 + e) ** 2 * acceleration / G
    half = phase / w + 0.5 * T
    height = table + G * T**2 / 8.0 - A * math.cos(w * half)
    return height, A * w * math.sin(w * half), (half / T) % 1.0, np.roots([1.0, -trace, e**2])


def test_a_ball_bounces_once_a_period_with_the_multipliers_of_the_impact_map():
    w, e, force = 20.0, 0.5, 12.0
    height, velocity, start, expected = ball_orbit(force, w, e)
    family = ball(force, e).over("freq_hz", freq_hz=w / (2.0 * math.pi))
    found = ct.cycles.orbit(family, w / (2.0 * math.pi), guess=family.state([1.001 * height], [velocity]), start=start)
    assert found.x == pytest.approx(family.state([height], [velocity]), rel=1e-9, abs=1e-9)
    assert sorted(np.abs(found.multipliers)) == pytest.approx(sorted(np.abs(expected)), abs=1e-6)
    assert np.prod(found.multipliers).real == pytest.approx(e**2, abs=1e-6)
    assert found.closings == (1,)


def test_a_ball_over_a_moving_table_is_a_moving_ball_over_a_table():
    """The gap's own motion takes part in impact and derivative: y is the ball's height, the gap y - A cos w t."""
    w, e, force = 20.0, 0.5, 12.0
    height, velocity, start, expected = ball_orbit(force, w, e)
    family = ball(0.0, e, height=1.0).over("freq_hz", freq_hz=w / (2.0 * math.pi))
    still, period = family.at(w / (2.0 * math.pi))
    table = force / w**2
    moving = replace(still.drive, c=still.drive.c._replace(wave=np.array([[-table + 0j]])))
    motion, time = replace(still, drive=moving, driven={}), start * period
    state = family.state(
        [height + table * math.cos(w * time)], [velocity - table * w * math.sin(w * time)]
    )  # fmt: skip
    end = passage(motion, state, time, period)
    assert end.x == pytest.approx(state, abs=1e-9)
    assert sorted(np.abs(np.linalg.eigvals(end.M))) == pytest.approx(sorted(np.abs(expected)), abs=1e-6)


def test_the_bouncing_ball_flips_at_the_force_of_the_closed_form():
    w, e = 20.0, 0.5
    T = 2.0 * math.pi / w
    expected = math.hypot(0.5 * G * T * (1.0 - e) / (1.0 + e) * w, 2.0 * G * (1.0 + e**2) / (1.0 + e) ** 2)
    family = ball(1.0, e).over("amplitude", freq_hz=w / (2.0 * math.pi))
    height, velocity, start, _ = ball_orbit(0.95 * expected, w, e)
    first = ct.cycles.orbit(family, 0.95 * expected, guess=family.state([height], [velocity]), start=start)
    found = ct.cycles.follow(family, (0.95 * expected, 1.05 * expected), first=first).branches[0]
    assert [special.kind for special in found.specials] == ["flip"]
    assert found.specials[0].orbit.value == pytest.approx(expected, rel=1e-6)
    assert found.points[0].stable
    assert not found.points[-1].stable


def shaw_holmes(w, e, zeta, d, force=1.0):
    """Time of the impact within the period and multipliers of x'' + 2 zeta x' + x = force cos w t against x <= d.

    Free flight from (d, -e v) at t0 to (d, v) a period later; the multipliers by the exact flow and the saltation.
    """
    T, wd = 2.0 * math.pi / w, math.sqrt(1.0 - zeta**2)
    X = force / (1.0 - w**2 + 2j * zeta * w)

    def forced(t):
        z = X * np.exp(1j * w * t)
        return np.array([z.real, (1j * w * z).real])

    decay, c, s = math.exp(-zeta * T), math.cos(wd * T), math.sin(wd * T)
    flow = decay * np.array([[c + zeta / wd * s, s / wd], [-s / wd, c - zeta / wd * s]])

    def miss(unknown):
        t0, v = unknown
        after = np.array([d, -e * v])
        return flow @ (after - forced(t0)) + forced(t0) - [d, v]

    def multipliers(t0, v):
        def pull(state):
            return np.array([state[1], -state[0] - 2.0 * zeta * state[1] + force * math.cos(w * t0)])

        J = np.diag([1.0, -e])
        jump = pull([d, -e * v]) - J @ pull([d, v])
        return np.linalg.eigvals((J + np.outer(jump, [1.0, 0.0]) / v) @ flow)

    return miss, multipliers, T


def oscillator(e, zeta, d):
    body = ct.ModalBody(omega=[1.0], zeta=[zeta], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=d)
    return ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=1.0, restitution=e, shown=("x",))


@pytest.mark.parametrize(("w", "d"), [(2.0, 0.05), (2.6, 0.0), (1.6, 0.1)])
def test_shaw_and_holmes_oscillator_has_its_closed_form(w, d):
    e, zeta = 0.8, 0.05
    family = oscillator(e, zeta, d).over("freq_hz", freq_hz=w / (2.0 * math.pi))
    found = ct.cycles.orbit(family, w / (2.0 * math.pi), settle=400)
    miss, multipliers, T = shaw_holmes(w, e, zeta, d)
    end = passage(*family.at(found.value)[:1], np.asarray(found.x), found.start * T, T)
    hit = [event for event in end.events if event.closes]
    assert len(hit) == 1
    exact = fsolve(miss, [hit[0].time, hit[0].speed], xtol=1e-12)
    assert [hit[0].time, hit[0].speed] == pytest.approx(exact, abs=1e-9)
    assert sorted(np.abs(found.multipliers)) == pytest.approx(sorted(np.abs(multipliers(*exact))), abs=1e-6)


def test_shaw_and_holmes_oscillator_flips_where_its_closed_form_does():
    e, zeta, d = 0.8, 0.05, 0.0

    def beyond(w):
        miss, multipliers, _ = shaw_holmes(w, e, zeta, d)
        return float(multipliers(*fsolve(miss, guess, xtol=1e-12)).real.min()) + 1.0

    family = oscillator(e, zeta, d).over("freq_hz", freq_hz=0.4)
    first = ct.cycles.orbit(family, 2.2 / (2.0 * math.pi), settle=600)
    found = ct.cycles.follow(family, (first.value, 2.9 / (2.0 * math.pi)), first=first).branches[0]
    flips = found.of("flip")
    w = 2.0 * math.pi * flips[0].orbit.value
    orbit = flips[0].orbit
    end = passage(*family.at(orbit.value)[:1], np.asarray(orbit.x), orbit.start * orbit.period, orbit.period)
    hit = next(event for event in end.events if event.closes)
    guess = [hit.time, hit.speed]
    assert w == pytest.approx(brentq(beyond, w - 0.01, w + 0.01, xtol=1e-12), rel=1e-6)


@pytest.mark.parametrize("d", [0.0, 0.02])
def test_the_impact_oscillators_free_orbit_closes_and_shears(d):
    """Without force, damping or loss: T = 2 (pi - acos(d/a))/w, a^2 = d^2 + (v/w)^2 with the speed v at the stop.

    The derivative of one period is a shear along the orbit by -dT/dv: both multipliers are 1.
    """
    w, v = 3.0, 0.3
    body = ct.ModalBody(omega=[w], zeta=[0.0], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=d)
    driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.0, restitution=1.0, shown=("x",))
    family = driven.over("freq_hz", freq_hz=1.0)
    motion, _ = family.at(1.0)
    amplitude = math.hypot(d, v / w)
    T = 2.0 * (math.pi - math.acos(d / amplitude)) / w
    end = passage(motion, family.state([-amplitude], [0.0]), 0.0, T)
    assert end.x == pytest.approx(family.state([-amplitude], [0.0]), abs=1e-13)
    slope = -2.0 / w * d / (amplitude**2 * math.sqrt(1.0 - (d / amplitude) ** 2))  # dT/d amplitude
    assert end.M == pytest.approx(np.array([[1.0, 0.0], [w * amplitude * slope, 1.0]]), abs=1e-10)


def test_modes_that_stiffness_and_damping_couple_move_as_their_own_modes():
    """The same body by other coordinates q = T z, in which its matrices are full and its frequencies one."""
    driven = random_body(3, 2, stiffness=50.0)
    body = driven.patch.body
    T = np.linalg.qr(np.random.default_rng(4).standard_normal((6, 6)))[0]
    K, C = T.T @ np.diag(body.omega**2) @ T, T.T @ np.diag(2.0 * body.zeta * body.omega) @ T
    mixed = replace(body, omega=np.full(6, 2.0), zeta=np.zeros(6), rows=body.rows @ T, stiffness=K - 4.0 * np.eye(6),
                    damping=C)  # fmt: skip
    coupled = replace(driven, patch=replace(driven.patch, body=mixed))
    found = [ct.cycles.orbit(one.over("freq_hz", freq_hz=0.4), 0.4) for one in (driven, coupled)]
    assert found[0].contacts > 0
    assert found[1].amplitude["d"] == pytest.approx(found[0].amplitude["d"], rel=1e-8)
    sizes = [np.sort(np.abs(one.multipliers)) for one in found]
    assert sizes[1] == pytest.approx(sizes[0], abs=1e-8)
