"""When a contact is said to begin to stick and to slip again, one step at a time, against slips and cones by hand."""

import math

import numpy as np
import pytest

from tests.contact.plain import names

N = names("loop.tally", "record.record")
H, TIME, MU = 0.2, 7.0, 0.5
W = np.diag([3.0, 2.0, 2.0, 4.0, 2.5, 2.0]) + 0.1
W[4, 5], W[5, 4] = 0.3, 0.3
STICKS, SLIPS = [2.0, 0.3, -0.4], [2.0, 0.6, -0.8]  # of a cone of radius 1
SINCE = 6.5


def stepped(lam, before, last, *, stuck, hold=0.9, pressed=1.0, dim=3, since=SINCE):
    """Events, and what is kept, after a step of the second of two contacts."""
    past = N.Sticking(np.zeros((2, 2 * dim)), np.array([7.0, hold]), np.array([7.0, pressed]), np.array([7.0, since]))
    sums, out = N.tally(2), N.samples(N.Record(), 3, 2, 1)
    past.slip[:, : dim + 1] = [[3.0], [4.0]]  # the other contact's
    past.slip[:, dim + 1 :] = [last, before]
    sums.stuck[1] = stuck
    forces = np.concatenate([[5.0, 1.0, -1.0][:dim], lam])
    compliance, b = W[: 2 * dim, : 2 * dim], np.arange(2.0 * dim)
    moved = compliance @ forces + b
    N.note_sticking(past, sums, out, 1, TIME, H, MU, compliance, forces, moved)
    slip = moved[dim + 1 :]
    held = forces[dim + 1 :] - np.linalg.solve(compliance[dim + 1 :, dim + 1 :], slip - last)
    np.testing.assert_allclose(past.slip[0, dim + 1 :], slip, rtol=1e-13)
    assert past.slip[1, dim + 1 :].tolist() == list(last)
    assert (past.slip[:, : dim + 1] == [[3.0], [4.0]]).all()
    ratio = np.linalg.norm(held) / (MU * lam[0]) if lam[0] > 0.0 else math.inf
    assert past.hold.tolist() == [7.0, pytest.approx(ratio, rel=1e-12)]
    assert past.pressed.tolist() == [7.0, lam[0]]
    assert past.since[0] == 7.0
    n = sums.filled[2]
    assert out.event_contact[:n].tolist() == [1] * n
    return list(zip(out.event_kind[:n].tolist(), out.event_time[:n].tolist(), strict=True)), ratio, past.since[1]


@pytest.mark.parametrize(
    ("before", "pressed", "part"),
    [
        ([0.4, -0.2], 1.0, 1.0 / 3.0 - 0.5),  # continued, the slip is zero a third of a step after the last
        ([0.2, -0.1], 1.0, 0.5),
        ([0.15, -0.075], 1.0, 0.5),  # it would be two steps
        ([0.1, -0.05], 1.0, 0.0),  # not slowing down
        ([-0.4, 0.2], 1.0, 0.0),
        ([0.3, 0.1], 1.0, 0.0125 / (0.025 - 0.0125) - 0.5),  # across, too
        ([0.4, -0.2], 0.0, 0.0),  # it has just closed
    ],
)
def test_sticking_begins_where_the_slip_continued_is_zero(before, pressed, part):
    events, _, since = stepped(STICKS, before, [0.1, -0.05], stuck=0, pressed=pressed)
    assert events == [(3, pytest.approx(TIME + part * H, rel=1e-14))]
    assert since == events[0][1]


def test_a_contact_that_stood_still_sticks_from_its_step_on():
    assert stepped(STICKS, [0.4, -0.2], [0.0, 0.0], stuck=0)[0] == [(3, TIME)]


def test_one_tangent_is_enough():
    events, _, _ = stepped([2.0, 0.3], [-0.4], [-0.1], stuck=0, dim=2)
    assert events == [(3, pytest.approx(TIME + (1.0 / 3.0 - 0.5) * H, rel=1e-14))]
    assert stepped([2.0, -1.0], [-0.4], [-0.1], stuck=0, dim=2)[0] == []


@pytest.mark.parametrize("edge", [1.0, 1.0 - 0.5e-9, 1.0 - 2e-9])
def test_a_force_at_the_edge_of_its_cone_slips(edge):
    events, _, _ = stepped([2.0, 0.6 * edge, -0.8 * edge], [0.4, -0.2], [0.1, -0.05], stuck=0)
    assert len(events) == (edge < 1.0 - 1e-9)


@pytest.mark.parametrize("hold", [0.2, 0.9])
def test_sticking_ends_where_the_force_that_would_hold_crosses_the_cone(hold):
    events, ratio, _ = stepped(SLIPS, [0.0, 0.0], [0.1, -0.05], stuck=1, hold=hold)
    assert ratio > 1.5
    assert events == [(2, pytest.approx(TIME + H * ((1.0 - hold) / (ratio - hold) - 1.0), rel=1e-13))]


def test_a_force_that_would_still_hold_ends_in_its_step_at_the_latest():
    """W_TT undoes nothing where the slip is as it was."""
    slip = (W @ np.array([5.0, 1.0, -1.0, *SLIPS]) + np.arange(6.0))[4:]
    for share, part in ((0.0, 0.0), (1e-3, 0.0)):
        events, ratio, _ = stepped(SLIPS, [0.0, 0.0], slip + share * W[4:, 4:] @ [-0.6, 0.8], stuck=1, hold=0.5)
        assert ratio == pytest.approx(1.0 - share, rel=1e-9)
        assert events == [(2, pytest.approx(TIME + part * H, rel=1e-9))]


def test_it_ends_no_earlier_than_it_began():
    assert stepped(SLIPS, [0.0, 0.0], [0.1, -0.05], stuck=1, hold=0.2, since=6.99)[0] == [(2, 6.99)]
    for hold in (1.0, 1.3):  # it turned without a rest
        assert stepped(SLIPS, [0.0, 0.0], [0.1, -0.05], stuck=1, hold=hold)[0] == [(2, SINCE)]
    assert stepped([0.0, 0.0, 0.0], [0.0, 0.0], [0.0, 0.0], stuck=1)[0] == [(2, TIME - 0.5 * H)]
    assert stepped([0.0, 0.0, 0.0], [0.0, 0.0], [0.0, 0.0], stuck=1, since=6.95)[0] == [(2, 6.95)]


def test_nothing_is_noted_of_what_stays_as_it_is():
    assert stepped(STICKS, [0.4, -0.2], [0.1, -0.05], stuck=1)[0] == []
    assert stepped(STICKS, [0.4, -0.2], [0.1, -0.05], stuck=1)[2] == SINCE
    assert stepped(SLIPS, [0.4, -0.2], [0.1, -0.05], stuck=0)[0] == []
    assert stepped([0.0, 0.0, 0.0], [0.4, -0.2], [0.1, -0.05], stuck=0)[0] == []


@pytest.mark.parametrize("scale", [0.25, 1.5])
def test_small_forces_stick_as_large_ones_do(scale):
    lam = scale * np.array(STICKS)
    assert [kind for kind, _ in stepped(lam, [0.4, -0.2], [0.1, -0.05], stuck=0)[0]] == [3]
    events, ratio, _ = stepped(scale * np.array(SLIPS), [0.0, 0.0], [0.1, -0.05], stuck=1, hold=0.2)
    assert events == [(2, pytest.approx(TIME + H * (0.8 / (ratio - 0.2) - 1.0), rel=1e-13))]


def test_motion_along_one_line_is_that_of_a_determinant_below_a_millionth_of_a_millionth():
    lam, slip, last = np.array([1.0, 0.7, -0.3]), np.array([0.0, 1.0, 0.4]), np.zeros(3)
    for left, held in ((0.9e-12, math.hypot(0.7 - 0.5, -0.3 - 0.2)), (1.2e-12, math.hypot(0.6, 0.6) / 1.2e-12)):
        coupled = np.eye(3)
        coupled[1, 2] = coupled[2, 1] = math.sqrt(1.0 - left)
        assert N.holding(coupled, 0, 3, lam, slip, last) == pytest.approx(held, rel=1e-3)
