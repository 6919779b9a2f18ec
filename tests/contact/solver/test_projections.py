"""The shortest motion that opens all gaps: every set of active contacts tried, rows of any length; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.unilateral.active_set")


@pytest.mark.parametrize("spread", [0.0, 1.0, 2.0])
def test_contacts_enter_and_leave_until_all_gaps_are_open(spread):
    """More contacts than directions of motion: what is taken in first has to leave again."""
    rng, left = np.random.default_rng(6), 0
    for _ in range(8):
        rows = rng.standard_normal((24, 4))
        lengths, possible = 10.0 ** rng.uniform(-spread, spread, 24), 3.0 * rng.standard_normal(4)
        gaps = rng.exponential(0.3, 24) - rows @ possible
        A, b = rows * lengths[:, None], gaps * lengths
        force, w = np.full(24, 7.0), N.active_space(24, 4)
        status, changes = N.project(A, b, 24, 4, force, w)
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
