"""Orbits whose shape and multipliers are known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
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


def oscillator(e, zeta, d):
    body = ct.ModalBody(omega=[1.0], zeta=[zeta], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=d)
    return ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=1.0, restitution=e, shown=("x",))


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
