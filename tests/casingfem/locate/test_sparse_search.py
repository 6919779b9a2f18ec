"""Matching pursuit on small linear problems, against all subsets tried one by one."""

from itertools import combinations

import numpy as np
import pytest
from scipy.stats import f

from casingfem.locate.misfit import Point
from casingfem.locate.sparse_search import (
    Bounds,
    best_addition,
    exchanged,
    fitted,
    gains,
    pruned,
    scale2,
    search,
    significant,
    threshold,
    unexplained,
)

COUNT = 7
BOUNDS = Bounds(lower=-np.ones(COUNT), upper=np.zeros(COUNT))


def problem(seed, truth):
    """Residuals J (x - truth) of alike columns, and a start at zero."""
    rng = np.random.default_rng(seed)
    J = rng.standard_normal((15, COUNT)) + 0.9 * rng.standard_normal((15, 1))

    def evaluate(x):
        left = 20.0 * J @ (x - truth)
        return Point(x, None, left, 20.0 * J, float(left @ left))

    return evaluate, evaluate(np.zeros(COUNT))


def best_subset(evaluate, start, size):
    fits = {subset: fitted(evaluate, start, subset, BOUNDS).chi2 for subset in combinations(range(COUNT), size)}
    return list(min(fits, key=fits.get))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("begun", [[4, 5, 6], [0, 5, 6], [1, 4, 5], [0, 3, 6]])
def test_exchanging_one_change_at_a_time_ends_at_the_best_subset(seed, begun):
    truth = np.array([-0.8, 0.0, -0.5, -0.6, 0.0, 0.0, 0.0])
    evaluate, start = problem(seed, truth)
    found, at = exchanged(evaluate, fitted(evaluate, start, begun, BOUNDS), begun, BOUNDS, rounds=4, tried=COUNT)
    assert found == best_subset(evaluate, start, 3) == [0, 2, 3]
    np.testing.assert_allclose(at.x, truth, atol=1e-6)


def test_one_change_is_not_exchanged_and_needless_ones_are_dropped():
    truth = np.array([-0.8, 0.0, -0.5, 0.0, 0.0, 0.0, 0.0])
    evaluate, start = problem(3, truth)
    alone = fitted(evaluate, start, [5], BOUNDS)
    assert exchanged(evaluate, alone, [5], BOUNDS) == ([5], alone)
    whole = [0, 1, 2, 6]
    left, at = pruned(evaluate, fitted(evaluate, start, whole, BOUNDS), whole, BOUNDS, 0.01)
    assert left == [0, 2]
    np.testing.assert_allclose(at.x, truth, atol=1e-9)


@pytest.mark.parametrize("active", [[], [2], [0, 4]])
def test_what_a_change_promises_is_what_its_fit_gains(active):
    """The problem is linear: within bounds, and those active refitted."""
    evaluate, start = problem(5, np.full(COUNT, -0.02))
    at = fitted(evaluate, start, active, Bounds(lower=-9.0 * np.ones(COUNT), upper=9.0 * np.ones(COUNT)))
    wide = Bounds(lower=-9.0 * np.ones(COUNT), upper=9.0 * np.ones(COUNT))
    promised = gains(at, active, wide)
    for c in range(COUNT):
        if c in active:
            assert promised[c] == -np.inf
        else:
            assert promised[c] == pytest.approx(at.chi2 - fitted(evaluate, at, [*active, c], wide).chi2, rel=1e-6)
    taken, there = best_addition(evaluate, at, active, wide, tried=COUNT)
    assert taken == int(np.argmax(promised))
    assert there.chi2 == pytest.approx(at.chi2 - promised.max(), rel=1e-6)


def test_a_bounded_change_promises_less_and_an_unseen_one_nothing():
    J = np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    at = Point(np.zeros(3), None, np.array([4.0, 1.0]), J, 17.0)
    found = gains(at, [], Bounds(lower=-np.ones(3), upper=np.ones(3)))
    assert found.tolist() == [17.0 - 5.0, -np.inf, 17.0 - 9.0]  # both would go further than 1
    assert best_addition(lambda x: at, at, [0, 2], Bounds(lower=-np.ones(3), upper=np.ones(3))) == (None, at)


def test_significance_is_that_of_the_f_test():
    """s^2 = max(1, chi^2/dof); quantile of F(1, 10) at 0.05/5: 10.04."""
    before, after = (Point(np.zeros(1), None, np.zeros(12), np.zeros((12, 1)), chi2) for chi2 in (25.0, 5.0))
    assert threshold(0.05, 5, 12, 2) == pytest.approx(10.044, abs=1e-3)
    assert scale2(after, 2) == 1.0
    assert scale2(before, 2) == 2.5
    assert significant(before, after, 2, 0.05, 5)
    assert not significant(before, Point(np.zeros(1), None, np.zeros(12), np.zeros((12, 1)), 14.97), 2, 0.05, 5)
    assert unexplained(Point(np.zeros(1), None, np.zeros(12), np.zeros((12, 1)), 18.31), 2, 0.05)  # 95 % of 10 dof
    assert not unexplained(Point(np.zeros(1), None, np.zeros(12), np.zeros((12, 1)), 18.30), 2, 0.05)


@pytest.mark.parametrize(("over", "found"), [(0.97, [3]), (1.03, [3, 5])])
def test_a_second_change_must_beat_the_luckiest_of_all_pairs(over, found):
    """Orthogonal changes, residuals of 1.6 sigma; the second gains so many times what F(1, 26) asks of 21 pairs."""
    rows, level, s2 = 28, 0.01, 2.5
    asked = s2 * f.isf(level / (COUNT * (COUNT - 1) // 2), 1, rows - 2)
    truth = np.zeros(COUNT)
    truth[[3, 5]] = -0.9, -0.1 * np.sqrt(over * asked)
    J = np.vstack([10.0 * np.eye(COUNT), np.zeros((rows - COUNT, COUNT))])
    noise = np.append(np.zeros(COUNT), np.full(rows - COUNT, np.sqrt(s2 * (rows - 2) / (rows - COUNT))))

    def evaluate(x):
        left = J @ (x - truth) + noise
        return Point(x, None, left, J, float(left @ left))

    assert search(evaluate, BOUNDS, most=3, level=level)[0] == found
