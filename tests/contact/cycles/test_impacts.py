"""Impacts at rigid contacts by hand: what hits, who shares it, what rests, what stays closed; and their derivative."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.cycles.passage import Event, Motion, _at_rest, _impact, _switched, pressing
from contact.cycles.switched import Drive, Forcing, Plant

A = np.array([[0, 0, 1.0, 0], [0, 0, 0, 1.0], [-3.0, 0.5, -0.1, 0], [0.5, -7.0, 0, -0.2]])


def motion(C, S=None, e=0.5, moves=(0.0, 0.0), rest=(0.0, 0.0)):
    """Two coordinates of mass 1 and 1/2 before contacts of these rows, whose obstacles move as Re z e^(i 2 t)."""
    C = np.atleast_2d(C)
    k, n = len(C), np.zeros((len(C), 2))
    B = np.vstack([np.zeros((2, k)), C.T * [[1.0], [2.0]]])
    plant = Plant(
        A=A, B=B, C=np.hstack([C, n]), S=np.zeros((k, k)) if S is None else np.array(S), rate=3.0,
        D=np.array([[1.0, 0, 0, 0]]), E=np.zeros((1, k)), restitution=np.broadcast_to(e, (k,)),
    )  # fmt: skip
    none = np.zeros((1, 1), complex)
    drive = Drive(
        w=2.0, harmonics=np.ones(1),
        b=Forcing(np.array([0.0, 0.0, 0.3, -0.4]), np.array([[0.0], [0.0], [0.7], [0.2j]])),
        c=Forcing(np.array(rest[:k]), np.array(moves[:k], complex)[:, None]), d=Forcing(np.zeros(1), none),
    )  # fmt: skip
    return Motion(plant=plant, drive=drive, step=0.1, phases={})


X = np.array([0.2, -0.3, -1.5, 0.4])


def test_velocities_of_gaps_and_states():
    """Those of the modes, and of the obstacle: d/dt Re z e^(i 2 t)."""
    what, t = motion([[1.0, 0.5]], moves=(0.1 + 0.2j,)), 0.4
    velocity, rows, faster = what.gap_velocity(X, t)
    obstacle = (2j * (0.1 + 0.2j) * np.exp(0.8j)).real
    assert velocity == pytest.approx([-1.5 + 0.2 + obstacle], rel=1e-12)
    np.testing.assert_allclose(rows, [[0.0, 0.0, 1.0, 0.5]], atol=1e-14)
    assert faster == pytest.approx([(-4.0 * (0.1 + 0.2j) * np.exp(0.8j)).real], rel=1e-12)
    force = np.array([0.0, 0.0, 0.3 + 0.7 * math.cos(0.8), -0.4 - 0.2 * math.sin(0.8)])
    np.testing.assert_allclose(what.velocity((), X, t), A @ X + force, rtol=1e-12)


def test_one_contact_turns_its_velocity_round_by_the_restitution():
    what, t = motion([[1.0, 0.5]], moves=(0.1,)), 0.4
    before = what.gap_velocity(X, t)[0][0]
    after, M, closed, event = _impact(what, X, None, (), 0, t)
    assert what.gap_velocity(after, t)[0][0] == pytest.approx(-0.5 * before, rel=1e-12)
    change = after - X
    assert change[:2].tolist() == [0.0, 0.0]
    assert change[3] == pytest.approx(change[2], rel=1e-12)  # impulses 1 and .5 on masses 1 and .5
    assert (M, closed) == (None, ())
    assert event == Event(t, 0, True, False, pytest.approx(-before), False)


def test_an_impact_without_rebound_keeps_what_presses():
    """Acceleration along the gap: of the modes less that of the obstacle, with the force of the drive."""
    for pull, stays in ((40.0, ()), (-40.0, (0,))):
        what = motion([[1.0, 0.5]], e=0.0)
        pulled = Forcing(np.array([0.0, 0.0, pull, 0.0]), np.zeros((4, 1), complex))
        what = replace(what, drive=replace(what.drive, b=pulled), phases={}, driven={})
        after, _, closed, event = _impact(what, X, None, (), 0, 0.4)
        assert what.gap_velocity(after, 0.4)[0][0] == pytest.approx(0.0, abs=1e-14)
        assert (closed, event.stays) == (stays, bool(stays))


@pytest.mark.parametrize("e", [0.0, 0.5])
def test_the_derivative_of_an_impact_is_that_of_hitting_earlier_or_later(e):
    """Straight lines before and after: x + tau v-, the hit at the time that makes the gap zero."""
    what, t = motion([[1.0, 0.5]], e=e, moves=(0.1 + 0.05j,)), 0.4

    def gap(x, at):
        return float(what.plant.C[0] @ x + what.drive.c.at(what.angle(at))[0])

    x0 = X - np.array([gap(X, t), 0.0, 0.0, 0.0])  # at the obstacle
    _, M, closed, _ = _impact(what, x0, np.eye(4), (), 0, t)

    def through(x):
        """State at t of a motion that is x at t by the free one, and hits within a moment."""
        tau = 0.0
        for _ in range(50):
            here = moved_by(x, tau, ())
            tau -= gap(here, t + tau) / what.gap_velocity(here, t + tau)[0][0]
        after, _, now, _ = _impact(what, moved_by(x, tau, ()), None, (), 0, t + tau)
        return moved_by(after, -tau, now, t + tau)

    def moved_by(x, tau, phase, at=t):
        k1 = what.velocity(phase, x, at)
        return x + tau * what.velocity(phase, x + 0.5 * tau * k1, at + 0.5 * tau)

    h = 1e-5
    columns = [(through(x0 + h * d) - through(x0 - h * d)) / (2.0 * h) for d in np.eye(4)]
    np.testing.assert_allclose(np.array(columns).T, M, atol=2e-6 * np.abs(M).max())
    assert e == 0.0 or closed == ()


def test_a_rigid_contact_that_is_closed_takes_its_share_of_a_hit_on_another():
    """Rows that press on each other: the closed one must not be driven inside."""
    what = motion([[1.0, 0.0], [-0.6, 1.0]], e=(0.0, 0.5))
    x = np.array([0.0, 0.0, 0.0, -2.0])
    after, _, _, _ = _impact(what, x, None, (0,), 1, 0.4)
    velocity = what.gap_velocity(after, 0.4)[0]
    H = np.array([[1.0, -0.6], [-0.6, 0.36 + 2.0]])
    impulse = np.linalg.solve(H, [0.0, 3.0])  # from -2 to 1 at the one, still at the other
    assert impulse[0] > 0.0
    np.testing.assert_allclose(velocity, [0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(after - x, what.plant.B @ impulse, atol=1e-14)
    apart = motion([[1.0, 0.0], [0.6, 1.0]], e=(0.0, 0.5))  # the hit lifts the first off: it takes none
    after, _, _, _ = _impact(apart, x, None, (0,), 1, 0.4)
    assert apart.gap_velocity(after, 0.4)[0][0] > 0.0
    np.testing.assert_allclose(after - x, apart.plant.B[:, 1] * 3.0 / 2.36, atol=1e-14)


def test_a_slow_hit_ends_a_series_at_rest():
    """Slower than 1e-7 of the velocities that add up to it: nothing rebounds."""
    what = motion([[1.0, 0.5]])
    for slow, rests in ((0.9e-7, True), (1.2e-7, False)):
        x = np.array([0.0, 0.0, -1.0 - 2.0 * slow, 2.0])
        _, _, _, event = _impact(what, x, None, (), 0, 0.4)
        assert event.rests == rests
    after, M, _, event = _at_rest(what, x, np.eye(4), (), 0, 0.4, np.array([1.0]))
    velocity, rows, _ = what.gap_velocity(after, 0.4)
    assert velocity[0] == pytest.approx(0.0, abs=1e-14)
    np.testing.assert_allclose(what.plant.C @ M, 0.0, atol=1e-14)
    np.testing.assert_allclose(rows @ M, 0.0, atol=1e-14)
    assert (event.speed, event.closes, event.rests, event.contact) == (0.0, True, True, 0)
    away = np.array([0.0, 0.0, 1.0, 1.0]) / 1.5  # B over H = 1 + 2 (1/2)^2
    np.testing.assert_allclose(after - x, -away * what.gap_velocity(x, 0.4)[0][0], atol=1e-18)


def test_all_that_touch_and_hardly_move_come_to_rest_together():
    what = motion([[1.0, 0.0], [0.0, 1.0]])
    x, still = np.array([0.0, 0.0, -1e-9, -2e-9]), np.array([1e-8, 1e-8])
    after, _, _, _ = _at_rest(what, x, None, (), 0, 0.4, still)
    np.testing.assert_allclose(after, 0.0, atol=1e-24)
    for other in ([0.0, 1e-3, -1e-9, -2e-9], [0.0, 0.0, -1e-9, -2e-8]):  # open, or not slow
        after, _, _, _ = _at_rest(what, np.array(other), None, (), 0, 0.4, still)
        np.testing.assert_allclose(after, [0.0, other[1], 0.0, other[3]], atol=1e-24)
    after, _, _, _ = _at_rest(what, np.array([0.0, 1e-3, -1e-9, -2e-9]), None, (1,), 0, 0.4, still)
    np.testing.assert_allclose(after, [0.0, 1e-3, 0.0, 0.0], atol=1e-24)


def test_openings_and_soft_closings_leave_the_state_as_it_is():
    soft = motion([[1.0, 0.5], [0.0, 1.0]], S=np.diag([0.1, 0.2]))
    M = np.eye(4)
    x, after, closed, event = _switched(soft, X, M, (0, 1), 0, 0.4)
    assert x is X
    assert after is M
    assert (closed, event) == ((1,), Event(0.4, 0, False, False, 0.0))
    x, after, closed, event = _switched(soft, X, M, (1,), 0, 0.4)
    assert x is X
    assert after is M
    assert (closed, event) == ((0, 1), Event(0.4, 0, True, True, 0.0))
    rigid = motion([[1.0, 0.5]])
    assert _switched(rigid, X, None, (), 0, 0.4)[3].speed == pytest.approx(1.3)


def test_contacts_that_press_at_a_state():
    soft = motion([[1.0, 0.0], [0.0, 1.0]], S=[[0.1, 0.05], [0.05, 0.2]], rest=(0.1, 0.2), moves=(0.05, 0.0))
    assert soft.closed_at(np.array([-0.16, 0.0, 0.0, 0.0]), 0.0) == (0,)
    assert soft.closed_at(np.array([-0.14, 0.0, 0.0, 0.0]), 0.0) == ()
    assert soft.closed_at(np.array([-0.06, 0.0, 0.0, 0.0]), math.pi / 2.0) == (0,)
    assert soft.closed_at(np.array([-0.16, -0.3, 0.0, 0.0]), 0.0) == (1,)  # whose force lifts the first off
    hard = motion([[1.0, 0.0]], rest=(0.1,))
    assert hard.closed_at(np.array([-0.1, 0.0, 0.0, 0.0]), 0.0) == ()
    with pytest.raises(ct.NumericsError, match="a rigid contact is closed where the period begins"):
        hard.closed_at(np.array([-0.1 - 2.1e-10, 0.0, 0.0, 0.0]), 0.0)
    assert hard.closed_at(np.array([-0.1 - 1.9e-10, 0.0, 0.0, 0.0]), 0.0) == ()


@pytest.mark.parametrize("size", [1e-15, 1.0, 1e9])
def test_forces_that_press_grow_with_the_gaps_however_small_these_are(size):
    """The first force closes the second contact, which is open by itself; the third opens."""
    W = np.array([[1.0, -2.0, 0.5], [-2.0, 5.0, 0.0], [0.5, 0.0, 1.0]])
    exact = np.array([*np.linalg.solve(W[:2, :2], [1.0, -0.5]), 0.0])
    lam = pressing(W, size * np.array([-1.0, 0.5, -0.1]))
    np.testing.assert_allclose(lam, size * exact, rtol=1e-12)
    assert not pressing(W, size * np.array([0.0, 0.5, 0.1])).any()
