"""Parts of the friction solver against formulas written out: residual, slope, steps, errors as motion, sweeps."""

import math

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.friction.newton", "solver.friction.room", "solver.friction.coulomb")
solver_room = N.solver_room
MU = np.array([0.3, 0.5, 0.2])


def law(W, b, mu, dim, force, rho):
    """F of the law's projections, contact by contact, and u."""
    u, missed = W @ force + b, np.zeros(force.size)
    for k in range(force.size // dim):
        own = slice(k * dim + 1, (k + 1) * dim)
        pressed = max(force[k * dim] - rho[k, 0] * u[k * dim], 0.0)
        missed[k * dim] = force[k * dim] - pressed
        s = force[own] - rho[k, 1] * u[own]
        length = np.linalg.norm(s)
        missed[own] = force[own] - s * (1.0 if length <= mu[k] * pressed else mu[k] * pressed / length)
    return missed, u


def problem(dim, seed=5):
    rng, n = np.random.default_rng(seed), 3 * dim
    half = rng.standard_normal((n, n))
    W = half @ half.T / n + np.eye(n) + 0.05 * rng.standard_normal((n, n))
    force, u = rng.standard_normal(n), 0.1 * rng.standard_normal(n)
    force[::dim] = [3.0, 2.5, -4.0]  # one slips, one sticks, one is open
    force[1:dim], force[dim + 1 : 2 * dim] = 4.0, 0.1
    return W, u - W @ force, force


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_residual_and_slope_are_those_of_the_projections(dim):
    W, b, force = problem(dim)
    rho, u, miss = np.zeros((3, 2)), np.zeros(3 * dim), np.zeros(3 * dim)
    N.steps_in(W, dim, 3, rho)
    for k in range(3):
        i = k * dim
        block = W[i + 1 : i + dim, i + 1 : i + dim]
        top = np.linalg.eigvalsh(0.5 * (block + block.T)).max() if dim > 1 else math.inf
        np.testing.assert_allclose(rho[k], [1.0 / W[i, i], 1.0 / top], rtol=1e-13)
    rho *= [1.1, 0.9]
    size = N.law_residual(W, b, MU, rho, dim, 3, force, u, miss)
    missed, motion = law(W, b, MU, dim, force, rho)
    np.testing.assert_allclose(u, motion, rtol=1e-12)
    np.testing.assert_allclose(miss, missed, rtol=1e-12)
    assert size == pytest.approx(np.linalg.norm(missed), rel=1e-13)
    J, closed = np.zeros((3 * dim, 3 * dim)), np.zeros(3 * dim, dtype=int)
    n = N.law_slope(W, MU, rho, dim, 3, force, u, J, closed)
    assert closed[:n].tolist() == list(range(2 * dim))  # the third is open
    step = 1e-6
    for m in range(3 * dim):
        ahead, back = (law(W, b, MU, dim, force + side * step * np.eye(3 * dim)[m], rho)[0] for side in (1, -1))
        np.testing.assert_allclose(J[:n, m], (ahead - back)[: 2 * dim] / (2.0 * step), rtol=0.0, atol=2e-9)


def test_where_nothing_gives_way_along_the_tangent_friction_takes_the_normal_s_step():
    rho = np.zeros((1, 2))
    N.steps_in(np.diag([4.0, 0.0, 0.0]), 3, 1, rho)
    assert rho.tolist() == [[0.25, 0.25]]


def test_a_newton_step_solves_what_presses_with_a_hair_and_takes_over_the_rest():
    W, b, force = problem(2)
    room, rho, u, miss, step = solver_room(3, 2), np.zeros((3, 2)), np.zeros(6), np.zeros(6), np.zeros(6)
    N.steps_in(W, 2, 3, rho)
    N.law_residual(W, b, MU, rho, 2, 3, force, u, miss)
    J, closed, inside = np.zeros((6, 6)), np.zeros(6, dtype=int), np.zeros((6, 6))
    n = N.law_slope(W, MU, rho, 2, 3, force, u, J, closed)
    N.newton_step(J, closed, n, miss, inside, room, step, 6, 0.01)
    whole = np.vstack([J[:n] + 0.01 * np.eye(6)[:n], np.eye(6)[n:]])
    np.testing.assert_allclose(step, np.linalg.solve(whole, miss), rtol=1e-12)
    J[1] = J[0]
    inside[:] = 0.0
    N.newton_step(J, closed, n, miss, inside, room, step, 6, 0.0)
    assert np.isnan(step[:n]).all()
    np.testing.assert_array_equal(step[n:], miss[n:])


def test_errors_as_motion_are_over_the_free_motion_of_their_contact():
    b = np.array([0.2, -0.5, 0.0, 0.0, 0.1, 0.05])
    rho = np.array([[2.0, 4.0], [5.0, 8.0], [0.5, 0.25]])
    miss = np.array([0.3, -0.4, -0.2, 0.4, 0.01, -0.02])
    each = [max(0.3 / 2.0, 0.4 / 4.0) / 0.5, max(0.2 / 5.0, 0.4 / 8.0) / 0.5, max(0.01 / 0.5, 0.02 / 0.25) / 0.1]
    for k in range(3):
        alone = np.where(np.arange(6) // 2 == k, miss, 0.0)
        assert N.motion_miss(b, rho, 2, 3, alone) == pytest.approx(each[k], rel=1e-14)
    assert N.motion_miss(b, rho, 2, 3, miss) == pytest.approx(max(each), rel=1e-14)
    assert N.motion_miss(b, rho, 2, 3, np.zeros(6)) == 0.0
    assert [N.free_motion(b, 2, 3, k) for k in range(3)] == [0.5, 0.5, 0.1]


def test_round_off_of_sums_is_that_of_the_largest_product():
    W = np.array([[2.0, -3.0, 0.5, 0.0], [1.0, 4.0, 0.0, 0.2], [0.0, 6.0, 1.0, 0.0], [0.0, 0.1, 0.0, 1.0]])
    b, force = np.array([0.2, -0.4, 0.1, 0.3]), np.array([5.0, -7.0, 2.0, 1.0])
    expected = max(28.0 / 0.4, 42.0 / 0.3) * 2.0**-53
    assert N.sums_rounding(W, b, 2, 2, force) == pytest.approx(expected, rel=1e-14)
    assert N.sums_rounding(W, b, 2, 1, force) == pytest.approx(28.0 / 0.4 * 2.0**-53, rel=1e-14)
    assert N.sums_rounding(W, b, 2, 2, np.zeros(4)) == 0.0


def test_forces_are_measured_by_the_largest_or_by_what_a_gap_alone_asks_for():
    b, rho = np.array([-0.5, 100.0, 0.25, 100.0]), np.array([[2.0, 9.0], [8.0, 9.0]])
    assert N.force_scale(b, rho, 2, 2, np.array([0.1, -0.2, 0.3, -0.4])) == 2.0
    assert N.force_scale(b, rho, 2, 2, np.array([0.1, -0.2, 0.3, -5.0])) == 5.0
    assert N.force_scale(b, rho, 2, 1, np.array([0.1, -0.2, 0.3, -5.0])) == 1.0


def test_what_is_left_of_forces_in_open_contacts_is_dropped():
    force = np.array([1e-9, 0.1, 2.0, -0.5, 1.0, 0.3])
    rho, u = np.array([[2.0, 1.0], [2.0, 1.0], [2.0, 1.0]]), np.array([1e-3, 9.0, 0.9, 9.0, 0.5, 9.0])
    N.release(rho, 2, 3, u, force)
    assert force.tolist() == [0.0, 0.0, 2.0, -0.5, 0.0, 0.0]


@pytest.mark.parametrize("dim", [2, 3])
def test_newton_s_method_ends_at_the_law_and_tells_how_far_it_is_from_it(dim):
    rng = np.random.default_rng(11)
    for _ in range(5):
        half = rng.standard_normal((3 * dim, 3 * dim))
        W = half @ half.T / (3 * dim) + 0.5 * np.eye(3 * dim)
        b, room, force = rng.standard_normal(3 * dim), solver_room(3, dim), np.zeros(3 * dim)
        b[::dim] -= 1.0
        iterations, residual = N.newton(W, b, MU, dim, 3, force, room)
        rho = np.zeros((3, 2))
        N.steps_in(W, dim, 3, rho)
        missed, _ = law(W, b, MU, dim, force, rho)
        scale = max(np.abs(force).max(), np.abs(b[::dim] * rho[:, 0]).max())
        assert 0 < iterations <= 12
        assert residual <= 1e-12
        assert np.linalg.norm(missed) <= 2e-12 * scale
        assert room.left[0] <= 1e-9
        again = N.newton(W, b, MU, dim, 3, force, room)
        assert again[0] == 0


def test_bursts_of_sweeps_begin_where_newton_s_steps_ended_whatever_an_earlier_call_left():
    rng = np.random.default_rng(5)
    for _ in range(30):
        half = rng.standard_normal((6, 6))
        W, b = half @ half.T / 6 + 0.01 * np.eye(6), rng.standard_normal(6) - [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]
        room, force = solver_room(3, 2), np.zeros(6)
        room.vectors[N.BASE] = math.nan
        _, residual = N.newton(W, b, np.array([1.5, 2.0, 0.8]), 2, 3, force, room)
        assert residual <= 1e-12


def held(W, q, i, dim, mu, force):
    """Whether a contact that the others push by q is open, sticks or slips against its friction, and how well."""
    own, u = force[i : i + dim], W[i : i + dim, i : i + dim] @ force[i : i + dim] + q
    if q[0] >= 0.0:
        return not own.any()
    drag = np.linalg.norm(own[1:])
    on_gap = abs(u[0]) <= 1e-12
    if np.abs(u[1:]).max(initial=0.0) <= 1e-12:
        return on_gap and drag <= mu * own[0]
    against = own[1:] @ u[1:] <= -(1.0 - 1e-12) * drag * np.linalg.norm(u[1:])
    return on_gap and against and abs(drag - mu * own[0]) <= 2e-3 * mu * own[0]


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_a_sweep_solves_contact_after_contact_with_what_the_others_push_by_then(dim):
    W, rng, seen = problem(dim)[0], np.random.default_rng(3), set()
    for _ in range(12):
        b, force = rng.standard_normal(3 * dim) - 0.5, rng.uniform(0.1, 0.5, 3 * dim)
        b[::dim] -= 0.7
        before = force.copy()
        N.sweep(W, b, MU, dim, 3, force, 1)
        for k in range(3):
            i = k * dim
            pushed = np.concatenate([force[:i], np.zeros(dim), before[i + dim :]])
            q = (W @ pushed + b)[i : i + dim]
            assert held(W, q, i, dim, MU[k], force)
            slips = dim > 1 and np.abs(W[i + 1 : i + dim, i : i + dim] @ force[i : i + dim] + q[1:]).max() > 1e-9
            seen.add("open" if q[0] >= 0.0 else "slips" if slips else "sticks")
        twice, one = before.copy(), force
        N.sweep(W, b, MU, dim, 3, twice, 2)
        N.sweep(W, b, MU, dim, 3, one, 1)
        np.testing.assert_array_equal(twice, one)
    assert seen == ({"open", "sticks"} if dim == 1 else {"open", "slips", "sticks"})
