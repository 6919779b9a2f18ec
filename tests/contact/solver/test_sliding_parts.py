"""Parts of the start for sliding contacts, and one contact with friction, against the law written out."""

import math
from itertools import product

import numpy as np
import pytest

from tests.contact.plain import names, plain

N = names("solver.friction.all_sliding", "solver.friction.one_contact", "solver.friction.coulomb")
MU = np.array([0.3, 0.15, 0.2])


def room_of(count, dim):
    return N.solver_room(count, dim)


def problem(dim, seed=4):
    rng, n = np.random.default_rng(seed), 3 * dim
    half = rng.standard_normal((n, n))
    return half @ half.T / n + np.eye(n), rng


@pytest.mark.parametrize("dim", [2, 3])
def test_directions_follow_the_slip_and_how_far_they_turn_is_told(dim):
    u, d = np.arange(1.0, 3 * dim + 1.0), np.zeros((3, 2))
    exact = np.array([u[k * dim + 1 : (k + 1) * dim] for k in range(3)])
    exact /= np.linalg.norm(exact, axis=1)[:, None]
    assert N.follow(u, dim, 3, d, True) == 1.0
    np.testing.assert_allclose(d[:, : dim - 1], exact, rtol=1e-14)
    if dim == 3:
        turned = u.copy()
        turned[4] += 0.7
        new = turned[4:6] / np.linalg.norm(turned[4:6])
        assert N.follow(turned, 3, 3, d, False) == pytest.approx(np.abs(new - exact[1]).max(), rel=1e-12)
        np.testing.assert_allclose(d[1], new, rtol=1e-14)
        assert N.follow(np.array([1.0, 5.0, 0.0]), 3, 1, np.array([[0.0, 1.0]]), False) == 2.0
    assert N.follow(u, dim, 3, d, False) <= 1.0
    assert N.follow(-u, dim, 3, d, False) == 2.0
    u[dim + 1 : 2 * dim] = 0.0
    assert N.follow(u, dim, 3, d, True) == 2.0


def test_an_angle_is_that_from_the_direction_to_the_vector():
    for a, b in ((0.3, 1.9), (2.0, -2.0), (-1.0, -1.2)):
        found = N.between(3.0 * math.cos(b), 3.0 * math.sin(b), math.cos(a), math.sin(a))
        assert found == pytest.approx(math.remainder(b - a, 2.0 * math.pi), rel=1e-12)


def test_what_friction_drags_is_the_motion_of_tangential_forces_alone():
    W, rng = problem(3)
    W = W + 0.1 * rng.standard_normal(W.shape)
    force, out = rng.standard_normal(9), np.zeros(9)
    N.dragged(W, force, 9, out)
    alone = force.copy()
    alone[::3] = 0.0
    np.testing.assert_allclose(out, W @ alone, rtol=1e-12)
    out[:] = 7.0
    N.dragged(W, force, 6, out)
    np.testing.assert_allclose(out[:6], W[:6, :6] @ alone[:6], rtol=1e-12)
    assert (out[6:] == 7.0).all()


def complementary(A, gap):
    """Every answer of 0 <= x, 0 <= A x + gap, complementary."""
    found = []
    for closed in product([False, True], repeat=len(gap)):
        c, x = np.flatnonzero(closed), np.zeros(len(gap))
        x[c] = np.linalg.solve(A[np.ix_(c, c)], -gap[c])
        if (x >= 0.0).all() and ((A @ x + gap)[~np.array(closed)] >= 0.0).all():
            found.append(x)
    return found


@pytest.mark.parametrize("start", [[0, 0, 0, 0], [1, 1, 1, 1], [1, 0, 0, 1]])
def test_normals_are_found_from_any_set_of_closed_ones(start):
    rng, room = np.random.default_rng(7), room_of(4, 2)
    for _ in range(10):
        A = np.eye(4) + 0.25 * rng.standard_normal((4, 4))
        gap = rng.standard_normal(4) - 0.3
        room.vectors[N.NORMAL, :4], room.vectors[N.GAP, :4], room.whole[N.CLOSED, :4] = start, gap, start
        assert N.press(A, 4, room)
        answers = complementary(A, gap)
        assert any(np.allclose(room.vectors[N.NORMAL, :4], x, rtol=1e-9, atol=1e-12) for x in answers)
        assert room.whole[N.CLOSED, :4].tolist() == (room.vectors[N.NORMAL, :4] > 0.0).astype(int).tolist()


def test_where_no_force_opens_what_closes_no_path_ends():
    room = room_of(2, 2)
    room.vectors[N.GAP, :2] = [-1.0, -1.0]
    assert not N.press(np.array([[1.0, -2.0], [-2.0, 1.0]]), 2, room)
    room.whole[N.CLOSED, :2] = [1, 0]
    assert not N.press(np.array([[0.0, 0.0], [0.0, 1.0]]), 2, room)


def test_closed_contacts_stay_closed_and_the_gaps_of_all_are_told():
    rng, room = np.random.default_rng(3), room_of(4, 2)
    A, gap, x, left = np.eye(4) + 0.2 * rng.standard_normal((4, 4)), rng.standard_normal(4), np.ones(4), np.ones(4)
    room.whole[N.CLOSED, :4] = [1, 0, 0, 1]
    assert N.with_closed(A, gap, 4, x, left, room)
    exact = np.linalg.solve(A[np.ix_([0, 3], [0, 3])], -gap[[0, 3]])
    np.testing.assert_allclose(x, [exact[0], 0.0, 0.0, exact[1]], rtol=1e-12)
    np.testing.assert_allclose(left, A @ x + gap, atol=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_sliding_contacts_press_with_their_friction_along_the_directions_held(dim):
    W, rng = problem(dim)
    room, b = room_of(3, dim), rng.standard_normal(3 * dim) - 0.5
    angle = np.array([0.4, 2.0, -1.0])
    d = np.stack([np.cos(angle), np.sin(angle)], axis=1) if dim == 3 else np.array([[1.0, 0], [-1.0, 0], [1.0, 0]])
    room.pairs[:], room.vectors[N.GAP, :3] = d, b[::dim]
    assert N.slide(W, MU, dim, 3, room)
    force = room.vectors[N.TRIAL, : 3 * dim].reshape(3, dim)
    assert (force[:, 0] >= 0.0).all()
    np.testing.assert_allclose(force[:, 1:], -MU[:, None] * force[:, :1] * d[:, : dim - 1], rtol=1e-13)
    gap = (W @ force.ravel() + b)[::dim]
    assert gap.min() >= -1e-12
    np.testing.assert_allclose(gap * force[:, 0], 0.0, atol=1e-12)
    assert (force[:, 0] > 0.0).any()


@pytest.mark.parametrize(("spread", "left"), [(0.0, 1e-12), (0.05, 1e-5), (0.2, 1e-4)])
def test_directions_are_continued_to_the_slip_that_friction_turns_round(spread, left):
    """Of tips that move together, or nearly, from forces of another direction."""
    rng, count, dim = np.random.default_rng(5), 3, 3
    rigid, own = np.tile(np.eye(3), (count, 1)), spread * rng.standard_normal((9, 9))
    W = rigid @ np.diag([1.0, 1.0, 1.6]) @ rigid.T + own @ own.T + 1e-3 * np.eye(9)
    b = np.tile([-1.0, 0.3, 0.4], count) + 0.1 * spread * rng.standard_normal(9)
    start, room = np.tile([0.3, 0.04, -0.03], count), room_of(count, dim)
    room.vectors[N.GAP, :3], room.whole[N.CLOSED, :3] = b[::3], 1
    assert N.continue_direction(W, b, np.full(3, 0.2), count, start, room)
    force = room.vectors[N.TRIAL, :9]
    u = (W @ force + b).reshape(3, 3)
    assert np.abs(u[:, 0] * force[::3]).max() <= 1e-12
    assert max(abs(N.between(*u[k, 1:], *room.pairs[k])) for k in range(3)) <= left
    assert start.tolist() == [0.3, 0.04, -0.03] * count


def test_the_start_is_left_alone_where_something_sticks_and_slides_where_all_slide():
    W, _ = problem(2)
    b = np.array([-1.0, 8.0, -0.5, -9.0, 0.4, 7.0])
    force, room = np.zeros(6), room_of(3, 2)
    assert N.all_sliding_start(W, b, MU, 2, 3, force, room)
    u = W @ force + b
    assert (u[::2] >= -1e-12).all()
    assert (force[::2] >= 0.0).all()
    np.testing.assert_allclose(u[::2] * force[::2], 0.0, atol=1e-12)
    np.testing.assert_allclose(force[1::2], -MU * force[::2] * np.sign(u[1::2]), rtol=1e-12)
    start = np.array([0.1, 0.0, 0.2, 0.0, 0.0, 0.0])
    kept = start.copy()
    assert not N.all_sliding_start(np.eye(6), np.array([-1.0, 0.1] * 3), MU, 2, 3, kept, room)
    assert np.array_equal(kept, start)


CASES = [
    (2.0, 0.3, 0.2, 1.5, -1.0, 0.1, 0.4), (2.0, 0.3, 0.2, 1.5, -1.0, 2.0, 0.4), (2.0, 0.3, 0.2, 1.5, -1.0, -2.0, 0.4),
    (1.0, -0.8, -0.7, 1.2, -0.5, 0.05, 0.6), (1.0, 0.8, 0.7, 1.2, -0.5, -3.0, 0.6),
]  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_one_contact_sticks_inside_its_cone_or_slips_at_its_edge(case):
    nn, nt, tn, tt, gap, slip, mu = case
    found, normal, drag = N.one_contact(*case)
    assert found
    u_n, u_t = nn * normal + nt * drag + gap, tn * normal + tt * drag + slip
    assert u_n == pytest.approx(0.0, abs=1e-14)
    assert normal > 0.0
    if abs(u_t) < 1e-13:
        assert abs(drag) <= mu * normal
    else:
        assert drag == pytest.approx(-mu * normal * np.sign(u_t), rel=1e-13)
    assert N.drag_ratio(*case) == pytest.approx(-drag / normal, rel=1e-13)


def test_one_contact_that_is_open_or_may_have_two_answers_is_told():
    assert N.one_contact(2.0, 0.3, 0.2, 1.5, 0.0, 1.0, 0.4) == (True, 0.0, 0.0)
    assert N.one_contact(2.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0) == (True, 0.5, 0.0)
    assert N.one_contact(0.4, 1.0, 0.0, 9.0, -1.0, 1.0, 0.4) == (False, 0.0, 0.0)
    assert N.one_contact(0.4, -1.0, 0.0, 9.0, -1.0, 1.0, 0.4) == (False, 0.0, 0.0)
    assert N.one_contact(1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 0.4) == (False, 0.0, 0.0)
    assert math.isnan(N.drag_ratio(-1.0, 0.0, 0.0, 1.0, -1.0, 1.0, 0.4))


def test_at_the_edge_of_the_cone_a_contact_still_sticks():
    assert N.drag_ratio(1.0, 0.0, 0.0, 1.0, -1.0, 0.5, 0.5) == 0.5
    assert N.drag_ratio(1.0, 0.0, 0.0, 1.0, -1.0, -0.25, 0.5) == -0.25
    assert N.drag_ratio(1.0, 0.0, 0.0, 1.0, -1.0, -0.75, 0.5) == -0.5


def test_a_path_that_has_not_ended_by_its_count_is_no_answer(monkeypatch):
    room = room_of(4, 2)
    with plain() as module:
        made = vars(module("contact.solver.friction.all_sliding"))
    room.vectors[N.GAP, :4] = [-1.0, -1.0, -1.0, -1.0]
    for rounds, ends in ((0, False), (4, False), (5, True)):  # four contacts close one by one, then it is seen
        room.whole[N.CLOSED, :4], room.vectors[N.NORMAL, :4] = 0, 0.0
        monkeypatch.setitem(made, "MOST_CHANGES", rounds - 16)
        assert N.press(np.eye(4), 4, room) == ends
    np.testing.assert_array_equal(room.vectors[N.NORMAL, :4], np.ones(4))


def test_closed_contacts_that_no_force_keeps_closed_are_told():
    x, left, room = np.zeros(2), np.zeros(2), room_of(2, 2)
    room.whole[N.CLOSED, :2] = [1, 0]
    assert N.with_closed(np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([-1.0, 3.0]), 2, x, left, room)
    np.testing.assert_allclose([x, left], [[0.5, 0.0], [0.0, 3.25]], atol=1e-15)
    assert not N.with_closed(np.array([[0.0, 0.5], [0.5, 1.0]]), np.array([-1.0, 3.0]), 2, x, left, room)
    room.vectors[N.GAP, :2], room.vectors[N.NORMAL, :2] = [0.0, 3.0], [1.0, 0.0]
    assert not N.press(np.array([[0.0, 0.5], [0.5, 1.0]]), 2, room)
    assert room.vectors[N.NORMAL, 0] == 0.0  # not a force that happens to stand there
