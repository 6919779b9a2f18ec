"""Rubs whose casing or blades turn: against Runge-Kutta steps in plain NumPy, and the energy ledger."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import contact as ct
from tests.contact.synthetic_rim import N_MAX, SIZE, blade
from tests.contact.turning_ring import turning_ring

LEAN, MU, PARTS = math.radians(10.0), 0.3, 4


def closed_contact(casing, tip, turning, hz, depth):
    """(q, v)' and the normal force of a contact that stays closed and slides, of the arrays of the bodies alone."""
    omega, n = 2.0 * np.pi * hz, np.arange(N_MAX + 1)
    bodies, own = ((casing, omega), (tip, 0.0)), casing.omega.size
    if turning == "blades":
        bodies = ((casing, 0.0), (tip, -omega))
    m = own + tip.omega.size
    C, K, first = np.zeros((m, m)), np.zeros((m, m)), 0
    for body, speed in bodies:
        here = slice(first, first + body.omega.size)
        C[here, here], K[here, here] = np.diag(2.0 * body.zeta * body.omega), np.diag(body.omega**2)
        if body.gyroscopic is not None and speed:
            C[here, here] += speed * body.gyroscopic
            K[here, here] += speed**2 * body.stiffness_by_speed
        first = here.stop
    normal, tangent = np.array([math.cos(LEAN), math.sin(LEAN)]), np.array([-math.sin(LEAN), math.cos(LEAN)])
    soft = tip.S + np.diag([0.0, 0.0])

    def force(t, q):
        phi = -omega * t
        waves = np.concatenate([np.cos(n * phi), np.sin(n[1:] * phi)])
        Q, T = np.zeros(m), np.zeros(m)
        Q[:own], T[:own] = waves @ casing.rows[:SIZE], waves @ casing.rows[SIZE:]
        Q[own:], T[own:] = -normal @ tip.rows, -tangent @ tip.rows
        S_nn = waves @ casing.S[:SIZE, :SIZE] @ waves + normal @ soft @ normal
        S_nt = waves @ casing.S[:SIZE, SIZE:] @ waves + normal @ soft @ tangent
        gap = -depth * (1.0 - math.cos(2.0 * phi)) + Q @ q
        pressed = -gap / (S_nn - MU * S_nt)
        return pressed, (Q - MU * T) * pressed

    def rate(t, z):
        q, v = z[:m], z[m:]
        return np.concatenate([v, force(t, q)[1] - C @ v - K @ q])

    return m, rate, force


def runge_kutta(m, rate, force, h, steps):
    """Normal force at the beginning of each step."""
    z, found, k = np.zeros(2 * m), np.zeros(steps), h / PARTS
    for step in range(steps):
        found[step] = force(step * h, z[:m])[0]
        for part in range(PARTS):
            t = step * h + part * k
            a = rate(t, z)
            b = rate(t + 0.5 * k, z + 0.5 * k * a)
            c = rate(t + 0.5 * k, z + 0.5 * k * b)
            d = rate(t + k, z + k * c)
            z = z + k / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return found


def turning_blade(tip):
    return replace(tip, gyroscopic=[[0.0, 1.5], [-1.5, 0.0]], stiffness_by_speed=[[2.0, 0.3], [0.3, 5.0]])


@pytest.mark.slow
@pytest.mark.parametrize(("turning", "imperfect"), [("casing", 0.0), ("casing", 0.05), ("blades", 0.0)])
def test_a_rub_of_turning_bodies_is_that_of_runge_kutta(turning, imperfect):
    h, steps, hz = 1e-6, 1200, 100.0
    casing, tip = turning_ring(imperfect=imperfect, S=3e-8), turning_blade(blade(S=6e-8))
    found = ct.run(
        ct.RotatingRim(
            casing, tip, clearance=-5e-5, speed_hz=hz, lean_deg=10.0, turning=turning,
            out_of_roundness=[{"p": 2, "cos": 5e-5}],
        ), law=ct.Coulomb(mu=MU), scheme=ct.ExactModal(law="averaged"), dt=h, t_end=(steps - 0.5) * h,
    )  # fmt: skip
    wanted = runge_kutta(*closed_contact(casing, tip, turning, hz, 5e-5), h, steps)

    assert found.force[:, 0].sum() == pytest.approx(wanted.sum(), rel=1e-6)
    np.testing.assert_allclose(found.force[:, 0], wanted, rtol=0.0, atol=1e-4 * wanted.max())


@pytest.mark.slow
def test_rotation_matrices_of_zeros_change_nothing():
    turning = turning_ring(share=0.0, imperfect=0.05)
    still = replace(turning, gyroscopic=None, stiffness_by_speed=None)
    plain = ct.run(rub_problem(still), law=ct.Coulomb(mu=MU), dt=1e-5, t_end=0.05)
    zero = ct.run(rub_problem(turning), law=ct.Coulomb(mu=MU), dt=1e-5, t_end=0.05)
    np.testing.assert_allclose(zero.force, plain.force, rtol=0.0, atol=1e-12 * plain.force.max())


def rub_problem(casing, tips=3, tip=None, **given):
    """Tips of three blades before a turning rim."""
    points = [ct.ContactPoint(blade=k, angle_deg=120.0 * k, lean_deg=10.0) for k in range(tips)]
    profile = ct.gaps.RimProfile.fourier([{"p": 3, "cos": 5e-5}])
    speed = ct.Speed(time=[0.0, 0.05], hz=[20.0, 20.0])
    given = {"clearance": -5e-5, "speed": speed, "profile": profile, "turning": "casing", **given}
    return ct.Rub(casing, [tip or blade()] * tips, points, **given)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["pairs", "imperfect", "damped", "cross-coupled", "overdamped", "all, speeding up"])
def test_the_ledger_of_coupled_bodies_closes(case):
    casing = turning_ring(imperfect=0.0 if case == "pairs" else 0.05, zeta=0.0)
    m = casing.omega.size
    mixed = np.random.default_rng(2).standard_normal((m, m))
    if case == "damped":
        casing = replace(casing, damping=mixed @ mixed.T)
    elif case == "cross-coupled":
        casing = replace(casing, stiffness=1e3 * mixed, damping=30.0 * np.eye(m))
    elif case == "overdamped":
        casing = replace(casing, damping=np.diag(np.linspace(1.0, 9e3, m)))
    elif case == "all, speeding up":
        higher = mixed - mixed.T, mixed + mixed.T
        casing = replace(
            casing, stiffness=1e3 * mixed, damping=mixed @ mixed.T, gyroscopic_higher=1e-6 * higher[0][None],
            stiffness_higher=1e-6 * higher[1][None],
        )  # fmt: skip
    ramp = {"speed": ct.Speed(time=[0.0, 0.05], hz=[15.0, 35.0])} if case == "all, speeding up" else {}
    found = ct.run(rub_problem(casing, tip=blade(zeta=0.0), **ramp), law=ct.Coulomb(mu=MU), dt=1e-5, t_end=0.05).energy
    assert abs(found.unaccounted) <= 1e-11 * found.scale
    assert abs(found.numerical) <= 1e-2 * found.scale
    assert abs(found.algorithmic) <= 1e-4 * found.scale
    if case in ("pairs", "imperfect"):
        assert abs(found.damping) <= 1e-12 * found.scale
        assert found.external == 0.0
    elif case in ("cross-coupled", "all, speeding up"):
        assert found.external != 0.0
    else:
        assert found.damping < 0.0


@pytest.mark.slow
def test_a_casing_that_turns_alone_moves_as_the_exponential_of_its_matrices():
    casing, hz, h, steps = turning_ring(imperfect=0.05), 30.0, 1e-4, 2000
    m = casing.omega.size
    C, K = casing.matrices(2.0 * np.pi * hz)
    velocity = np.random.default_rng(4).standard_normal(m)
    rim = ct.RotatingRim(
        casing, blade(), clearance=0.04, speed_hz=hz, casing_velocity=1e-3 * velocity, turning="casing"
    )
    found = ct.run(rim, dt=h, t_end=(steps - 0.5) * h, record=ct.Record(state_every=1))
    exact = expm(np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]]) * h)
    z, wanted = np.concatenate([np.zeros(m), 1e-3 * velocity]), np.zeros((steps, m))
    for step in range(steps):
        wanted[step], z = z[:m], exact @ z
    np.testing.assert_allclose(found.state[:, :m], wanted, rtol=0.0, atol=1e-12 * np.abs(wanted).max())


@pytest.mark.slow
def test_a_casing_at_rest_deflects_under_a_constant_force_as_its_stiffness_states():
    casing = turning_ring(imperfect=0.05)
    K = casing.matrices(2.0 * np.pi * 20.0)[1]
    load = np.random.default_rng(5).standard_normal(casing.omega.size)
    rest = np.linalg.solve(K, load)
    start = ct.gaps.Start(displacement=rest, load=load)
    found = ct.run(
        rub_problem(casing, clearance=0.03, casing_start=start), dt=1e-5, t_end=0.01, record=ct.Record(state_every=1)
    )  # fmt: skip
    np.testing.assert_allclose(found.state[-1, : rest.size], rest, rtol=0.0, atol=1e-12 * np.abs(rest).max())


@pytest.mark.slow
def test_a_casing_that_speeds_up_follows_its_matrices_at_each_speed():
    casing, h, steps, hz = turning_ring(imperfect=0.05), 1e-5, 2000, (5.0, 60.0)
    m, t_end = casing.omega.size, steps * h
    velocity = 1e-3 * np.random.default_rng(4).standard_normal(m)
    found = ct.run(
        rub_problem(
            casing, clearance=0.04, speed=ct.Speed(time=[0.0, t_end], hz=hz),
            casing_start=ct.gaps.Start(velocity=velocity),
        ), dt=h, t_end=(steps - 0.5) * h, record=ct.Record(state_every=1),
    )  # fmt: skip

    def rate(t, z):
        C, K = casing.matrices(2.0 * np.pi * (hz[0] + (hz[1] - hz[0]) * t / t_end))
        return np.concatenate([z[m:], -C @ z[m:] - K @ z[:m]])

    z, wanted = np.concatenate([np.zeros(m), velocity]), np.zeros((steps, m))
    for step in range(steps):
        wanted[step] = z[:m]
        t = step * h
        a = rate(t, z)
        b = rate(t + 0.5 * h, z + 0.5 * h * a)
        c = rate(t + 0.5 * h, z + 0.5 * h * b)
        z = z + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(t + h, z + h * c))
    np.testing.assert_allclose(found.state[:, :m], wanted, rtol=0.0, atol=1e-5 * np.abs(wanted).max())
    assert abs(found.energy.unaccounted) <= 1e-10 * found.energy.scale
    assert found.energy.external > 0.0


def coupled_block(*, skew=0.0, seed=6):
    """A body of four modes seen at two points along x and y, with full damping and, by `skew`, a nonsymmetric K."""
    rng = np.random.default_rng(seed)
    mixed, odd = rng.standard_normal((2, 4, 4))
    return ct.ModalBody(
        omega=[200.0, 350.0, 500.0, 900.0], zeta=[0.001] * 4, channels=("a.x", "a.y", "b.x", "b.y"),
        rows=rng.standard_normal((4, 4)), S=1e-7 * np.eye(4), damping=4.0 * mixed @ mixed.T,
        stiffness=1e3 * (mixed + mixed.T) + skew * (odd - odd.T),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("skew", [0.0, 2e4])
def test_a_patch_of_coupled_modes_obeys_its_equation_of_motion(mu, skew):
    body, h, steps = coupled_block(skew=skew), 1e-5, 3000
    C, K = body.matrices()
    load = 40.0 * np.random.default_rng(8).standard_normal(4)
    patch = ct.Patch(
        body=body, normal=("a.y", "b.y"), tangent=(("a.x",), ("b.x",)), clearance=1e-4, slide=0.5, load=load
    )  # fmt: skip
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    found = ct.run(patch, law=law, dt=h, t_end=(steps - 0.5) * h, record=ct.Record(state_every=1))
    q, n = found.state, body.channels.index
    assert min(found.contact_steps) > 50
    smooth = np.flatnonzero((found.force[:-2] == 0.0).all(axis=1) & (found.force[1:-1] == 0.0).all(axis=1)) + 1
    smooth = smooth[(smooth > 1) & (smooth < steps - 2)]
    acceleration = (q[smooth + 1] - 2.0 * q[smooth] + q[smooth - 1]) / h**2
    velocity = (q[smooth + 1] - q[smooth - 1]) / (2.0 * h)
    left = acceleration + velocity @ C.T + q[smooth] @ K.T - load
    assert np.abs(left).max() <= 1e-3 * np.abs(acceleration).max()
    pushed = np.flatnonzero(found.force[:, 0] > 0.0)
    pushed = pushed[(pushed > 1) & (pushed < steps - 2)]
    change = (q[pushed + 1] - 2.0 * q[pushed] + q[pushed - 1]) / h**2 + q[pushed] @ K.T - load
    change += (q[pushed + 1] - q[pushed - 1]) / (2.0 * h) @ C.T
    along = [n(name) for name in (("a.x", "a.y", "b.x", "b.y") if mu else ("a.y", "b.y"))]
    outside = change - change @ np.linalg.pinv(body.rows[along]) @ body.rows[along]
    assert np.abs(outside).max() <= 1e-3 * np.abs(change).max()
    assert abs(found.energy.unaccounted) <= 1e-11 * found.energy.scale
    assert found.residual.max() <= 1e-12


def test_coupled_modes_at_a_point_gap_are_refused():
    side = ct.gaps.Side(body=coupled_block(), channel="a.y", sign=1)
    with pytest.raises(ct.InputError, match="sides: found coupled modes of body"):
        ct.run(ct.PointGap(sides=(side,), clearance=1.0), dt=1e-5, t_end=1e-4)
