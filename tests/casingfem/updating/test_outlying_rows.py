"""Rows that contradict the others on drawn linear fits: Student's t of an own column for each, the best of all sets.

These tests call the search itself: how far a row is off and what the parameters can fit of it are drawn.
"""

from itertools import combinations

import numpy as np
import pytest
from scipy.stats import t

from casingfem.updating.outliers import Shift, outlying, step_without, strongest

ROWS, PARAMETERS = 15, 3


def drawn(seed, off, rows=ROWS):
    """Residuals of a fit of which some rows are off, its derivatives, and a shift for each row."""
    rng = np.random.default_rng(seed)
    J = rng.standard_normal((rows, PARAMETERS))
    r = rng.standard_normal(rows)
    for row, size in off.items():
        r[row] += size
    r = r - J @ np.linalg.lstsq(J, r, rcond=None)[0]
    return [Shift("frequency", (row,), np.eye(rows)[row]) for row in range(rows)], r, J


def fitted(r, J, chosen):
    """Chi^2, sizes and Student's t of own columns for some rows."""
    A = np.column_stack([J, np.eye(len(r))[:, list(chosen)]])
    C = np.linalg.inv(A.T @ A)
    x = C @ A.T @ r
    chi2 = float(np.sum((r - A @ x) ** 2))
    scale = max(1.0, np.sqrt(chi2 / (len(r) - A.shape[1])))
    k = len(chosen)
    return chi2, x[-k:], np.abs(x[-k:]) / (scale * np.sqrt(np.diag(C)[-k:]))


@pytest.mark.parametrize("size", [-9.0, 3.0, 4.0, 5.0, 6.0])
def test_one_row_is_named_if_its_deviation_is_significant_among_all_rows(size):
    named = 0
    for seed in range(12):
        shifts, r, J = drawn(seed, {4: size}, rows=9)  # of nine rows one may be wrong
        best = min(range(9), key=lambda k: fitted(r, J, [k])[0])
        _, (shift,), (deviation,) = fitted(r, J, [best])
        found = outlying(shifts, r, J, 9)
        if 2.0 * t.sf(deviation, 9 - PARAMETERS - 1) < 0.01 / 9:
            (one,) = found
            assert (one.kind, one.rows) == ("frequency", (best,))
            assert (one.shift, one.deviation) == pytest.approx((shift, deviation), rel=1e-9)
            named += 1
        else:
            assert found == []
        most = strongest(shifts, r, J)
        assert (most.rows, most.shift) == ((best,), pytest.approx(shift, rel=1e-9))
    assert named > 0 if size == -9.0 else named < 12


@pytest.mark.parametrize("off", [{2: 9.0, 11: -8.0}, {2: 9.0, 3: 9.0, 11: 12.0}])
def test_several_rows_are_the_best_of_all_sets(off):
    for seed in range(6):
        shifts, r, J = drawn(seed, off)
        found = outlying(shifts, r, J, ROWS)
        best = min(combinations(range(ROWS), len(off)), key=lambda chosen: fitted(r, J, chosen)[0])
        assert [one.rows[0] for one in found] == sorted(best) == sorted(off)
        _, sizes, deviations = fitted(r, J, sorted(off))
        assert [one.shift for one in found] == pytest.approx(sizes.tolist(), rel=1e-6)
        assert [one.deviation for one in found] == pytest.approx(deviations.tolist(), rel=1e-6)
        step = step_without(found, shifts, r, J)
        kept = [row for row in range(ROWS) if row not in off]
        np.testing.assert_allclose(step, -np.linalg.lstsq(J[kept], r[kept], rcond=None)[0], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(("rows", "most"), [(9, 1), (10, 2), (14, 2), (15, 3)])
def test_one_row_in_five_may_be_wrong_but_one_in_any_table(rows, most):
    shifts, r, J = drawn(1, {2: 90.0, 5: -80.0, 7: 70.0}, rows=15)
    assert len(outlying(shifts, r, J, rows)) <= most
    shifts, r, J = drawn(1, {2: 90.0}, rows=15)
    assert [one.rows for one in outlying(shifts, r, J, rows)] == [(2,)]


def test_without_three_degrees_of_freedom_left_no_row_is_named():
    for rows, named in ((PARAMETERS + 4, 1), (PARAMETERS + 3, 0)):
        shifts, r, J = drawn(2, {1: 1e4}, rows=rows)
        assert len(outlying(shifts, r, J, rows)) == named


def test_rows_that_the_parameters_fit_completely_are_not_judged():
    shifts, r, J = drawn(3, {4: 50.0})
    J = np.column_stack([J[:, :2], np.eye(ROWS)[:, 4]])
    r = r - J @ np.linalg.lstsq(J, r, rcond=None)[0]
    assert all(one.rows != (4,) for one in outlying(shifts, r, J, ROWS))
    whole = np.eye(ROWS)
    assert strongest(shifts, np.eye(ROWS)[6] * 7.0, whole).rows == (6,)  # no row is left: the parameters are kept


def test_priors_are_residuals_of_no_row():
    shifts, r, J = drawn(4, {4: 40.0})
    with_priors = np.vstack([J, 1e-3 * np.eye(PARAMETERS)])
    (one,) = outlying(shifts, np.append(r, np.zeros(PARAMETERS)), with_priors, ROWS)
    assert one.rows == (4,)
