"""Elimination in panels: the answer of numpy, and every bit of elimination by single columns."""

import numpy as np
import pytest

from contact.jit.compiled import entry
from contact.solver.dense import LARGE, Panels, eliminate, eliminate_panels, solve_in_place


def problem(n, seed=0):
    """A matrix with zeros, small pivots and room beyond n, and a right side."""
    rng = np.random.default_rng(seed)
    A, x = np.zeros((n, n + 3)), rng.normal(size=n)
    A[:, :n] = rng.normal(size=(n, n)) * (rng.random((n, n)) > 0.2)
    A[0, 0] = 0.0
    return A, x


@pytest.mark.slow
@pytest.mark.parametrize("n", [LARGE - 1, LARGE, LARGE + 1, LARGE + 6, 131])
def test_panels_change_no_bit_and_solve(n):
    A, x = problem(n)
    (one, a), (other, b) = ((A.copy(), x.copy()) for _ in range(2))
    assert eliminate(one, a, n)
    assert entry(eliminate_panels)(other, b, n)
    upper = np.triu_indices(n)
    assert np.array_equal(one[upper], other[upper])  # but for the sign of zeros
    assert np.array_equal(a, b)
    found, used = x.copy(), A.copy()
    assert solve_in_place(used, found, n, Panels(used=True))
    assert found == pytest.approx(np.linalg.solve(A[:, :n], x), rel=1e-9)
    assert not used[:, n:].any()


def test_a_matrix_without_inverse_is_told():
    A, x = problem(LARGE + 2)
    A[:, 17] = A[:, 5]
    A[:, 5] = 0.0
    assert not solve_in_place(A, x, LARGE + 2, Panels(used=True))
