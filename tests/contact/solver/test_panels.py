"""Elimination in panels as plain Python: every bit of elimination by single columns, and which pivots are none."""

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.dense")


def problem(n, seed=0):
    """A matrix with zeros and room beyond n, and a right side."""
    rng = np.random.default_rng(seed)
    A, x = np.full((n + 2, n + 3), 7.0), rng.normal(size=n + 2)
    A[:n, :n] = rng.normal(size=(n, n)) * (rng.random((n, n)) > 0.2)
    A[0, 0] = 0.0
    return A, x


@pytest.mark.parametrize("n", [2, 4, 5, 11, 12, 13, 21, 29])
def test_panels_change_no_bit(n):
    A, x = problem(n)
    (one, a), (other, b) = ((A.copy(), x.copy()) for _ in range(2))
    assert N.eliminate(one, a, n)
    assert N.eliminate_panels(other, b, n)
    upper = np.triu_indices(n)
    np.testing.assert_array_equal(one[upper], other[upper])
    np.testing.assert_array_equal(a, b)
    whole = np.triu(one[:n, :n])
    np.testing.assert_allclose(np.linalg.solve(whole, a[:n]), np.linalg.solve(A[:n, :n], x[:n]), rtol=1e-8)
    for changed in (one, other):
        assert (changed[n:] == 7.0).all()
        assert (changed[:, n:] == 7.0).all()
    np.testing.assert_array_equal(a[n:], x[n:])


@pytest.mark.parametrize("column", [0, 1, 3, 4, 6, 9])
@pytest.mark.parametrize("way", ["eliminate", "eliminate_panels"])
def test_a_column_of_zeros_or_one_that_is_no_number_has_no_pivot(column, way):
    for value in (0.0, np.nan):
        A, x = problem(10)
        A[:, column] = value
        with np.errstate(invalid="ignore"):
            assert not getattr(N, way)(A, x, 10)


def test_panels_are_taken_from_forty_unknowns_on():
    for n, panels in ((39, None), (40, N.Panels(used=True))):
        A, x = problem(n, seed=3)
        found = x.copy()
        assert N.solve_in_place(A.copy(), found, n, panels)
        np.testing.assert_allclose(found[:n], np.linalg.solve(A[:n, :n], x[:n]), rtol=1e-9)
    with pytest.raises(TypeError):
        N.solve_in_place(A.copy(), x.copy(), 40, None)
    A[:, 17] = 0.0
    assert not N.solve_in_place(A, x, 40, N.Panels(used=True))
