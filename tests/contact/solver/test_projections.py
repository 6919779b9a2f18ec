"""The shortest motion that opens all gaps: every set of active contacts tried, rows of any length; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.unilateral.active_set")


@pytest.mark.parametrize(("spread", "size"), [(0.0, 4), (1.0, 4), (2.0, 4), (1.0, 8)])
def test_contacts_enter_and_leave_until_all_gaps_are_open(spread, size):
    """More contacts than directions of motion: what is taken in first has to leave again."""
    rng, left = np.random.default_rng(102), 0
    for _ in range(8):
        rows = rng.standard_normal((20, size))
        lengths, possible = 10.0 ** rng.uniform(-spread, spread, 20), 3.0 * rng.standard_normal(size)
        gaps = rng.exponential(0.3, 20) - rows @ possible
        A, b = rows * lengths[:, None], gaps * lengths
        force, w = np.full(20, 7.0), N.active_space(20, size)
        status, changes = N.project(A, b, 20, size, force, w)
        assert status == N.SOLVED == 0
        assert force.min() == 0.0
        np.testing.assert_allclose(w.y, A.T @ force, rtol=1e-12, atol=1e-12)
        open_by = rows @ w.y + gaps
        assert open_by.min() >= -1e-13
        np.testing.assert_allclose(open_by * (force > 0.0), 0.0, atol=1e-13)
        left += changes - np.count_nonzero(force)
    assert left > 5


def test_a_row_that_follows_from_others_is_settled_where_these_have_opened_it():
    """The third gap is the sum of the others' and a little more, or less."""
    A = np.array([[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [2.0, 0.5, 0.0]])
    for last in (-5.0, -4.9, -5.5):
        b = np.array([-4.0, -1.0, last])
        force, w = np.zeros(3), N.active_space(3, 3)
        assert N.project(A, b, 3, 3, force, w)[0] == N.SOLVED
        gaps = A @ w.y + b
        assert gaps.min() >= -1e-12
        assert abs(gaps @ force) <= 1e-11
        assert (force >= 0.0).all()
        np.testing.assert_allclose(A.T @ force, w.y, atol=1e-13)
        if last >= -5.0:
            np.testing.assert_allclose(w.y, [2.0, 2.0, 0.0], atol=1e-13)


@pytest.mark.parametrize(("apart", "solved"), [(0.0, True), (-1e-3, False), (1e-3, True)])
def test_two_walls_with_room_between_them_hold_and_without_do_not(apart, solved):
    """Gaps 2 y - 1 and apart + 1 - 2 y."""
    A, b, force = np.array([[2.0, 0.0], [-2.0, 0.0]]), np.array([-1.0, 1.0 + apart]), np.zeros(2)
    status, _ = N.project(A, b, 2, 2, force, N.active_space(2, 2))
    assert status == (N.SOLVED if solved else N.NO_MOTION)
    if solved:
        np.testing.assert_allclose(force, [0.25, 0.0], atol=1e-13)


def test_the_first_of_equally_deep_contacts_is_taken_and_round_off_is_not_depth():
    A, w = np.array([[3.0, 0.0], [0.0, 2.0], [3.0, 0.0]]), N.active_space(3, 2)
    N.begin(A, 3, 2, np.ones(3), w)
    assert N.most_violated(A, np.array([-3.0, -2.0, -3.0]), 3, 2, w) == 0
    assert N.most_violated(A, np.array([-2.0, -2.0, -2.0]), 3, 2, w) == 1
    w.y[:] = [1.0, 0.0]
    for depth, found in ((1e-14, -1), (4e-14, 0)):  # of a sum of terms of 6: 4e-15 of it is round-off
        assert N.most_violated(A, np.array([-3.0 - depth, 0.0, 3.0]), 3, 2, w) == found
        w.y[0] = -1.0
        assert N.most_violated(A, np.array([9.0, 0.0, 3.0 - depth]), 3, 2, w) == (2 if found == 0 else -1)
        w.y[0] = 1.0


def test_active_gaps_are_closed_once_more_and_forces_follow_from_the_motion():
    A, b = np.array([[1.0, 0.5, 0.0], [0.3, -2.0, 1.0], [0.2, 0.1, 4.0]]), np.array([-1.0, -3.0, -3.0])
    for pulled in (False, True):
        b[1] = 9.0 if pulled else -3.0
        w, d = N.active_space(3, 3), np.zeros(3)
        N.begin(A, 3, 3, np.zeros(3), w)
        for count, k in enumerate((2, 1)):
            d[:] = w.J @ A[k]
            N.enter(w.J, w.R, count, 3, d)
            w.active[count] = k
        rows = A[[2, 1]]
        w.y[:], w.lam[:] = rows.T @ [0.7, 0.3], 5.0
        N.polish(A, b, 2, 3, w)
        exact = np.maximum(np.linalg.solve(rows @ rows.T, -b[[2, 1]]), 0.0)
        assert (exact == 0.0).any() == pulled
        np.testing.assert_allclose(w.lam, [*exact, 5.0], rtol=1e-12)
        np.testing.assert_allclose(w.y, rows.T @ exact, rtol=1e-12, atol=1e-14)
