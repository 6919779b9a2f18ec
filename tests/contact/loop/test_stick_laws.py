"""What holds a sticking tip, for any coupling of its two tangents."""

import numpy as np
import pytest

from contact.loop.tally import holding


@pytest.mark.parametrize("coupling", [0.0, 0.4, -0.9])
def test_the_force_that_holds_is_the_force_less_what_would_undo_the_slip(coupling):
    W = np.eye(4) * 9.0
    W[2:, 2:] = [[2.0, coupling], [coupling, 1.0]]
    lam, slip, last = np.array([0.0, 5.0, 0.7, -0.3]), np.array([0.0, 0.0, 0.25, -0.4]), np.array([0.0, 0.0, 0.1, 0.2])
    exact = lam[2:] - np.linalg.solve(W[2:, 2:], slip[2:] - last[2:])
    assert holding(W, 1, 3, lam, slip, last) == pytest.approx(np.hypot(*exact), rel=1e-12)
    assert holding(W, 1, 2, lam, slip, last) == pytest.approx(abs(0.7 - 0.15 / 2.0), rel=1e-12)


def test_tangents_that_move_along_one_line_take_the_trace():
    W = np.zeros((3, 3))
    W[1:, 1:] = np.outer([0.6, 0.8], [0.6, 0.8]) * 2.0
    lam, slip = np.array([1.0, 0.7, -0.3]), np.array([0.0, 0.06, 0.08])
    exact = lam[1:] - slip[1:] / 2.0
    assert holding(W, 0, 3, lam, slip, np.zeros(3)) == pytest.approx(np.hypot(*exact), rel=1e-12)
