"""The search for few changes on drawn linear problems: the best of all sets, limits on both sides, what noise explains.

These tests call the search itself: which sets mislead it is drawn, as no casing offers them.
"""

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import chi2, f

from casingfem.locate.misfit import Point
from casingfem.locate.sparse_search import Bounds, search


def linear(J, r):
    """Residuals r + J x and their derivatives."""

    def evaluate(x):
        values = r + J @ x
        return Point(x, None, values, J, float(values @ values), ())

    return evaluate


def best_of(J, r, bounds, count):
    """Least chi^2 of all sets of `count` changes within their bounds, and that set."""
    fits = []
    for on in map(list, combinations(range(J.shape[1]), count)):
        fit = lsq_linear(J[:, on], -r, (bounds.lower[on], bounds.upper[on]), tol=1e-14)
        fits.append((2.0 * fit.cost, on))
    return min(fits)


def bounded(changes, lower=-1.0, upper=0.0):
    return Bounds(lower=np.full(changes, lower), upper=np.full(changes, upper))


def drawn(seed, true, own=1.0, changes=9, rows=40):
    """Changes of equal size of which another column is nearly the sum of two, the less the more it has of its own.

    One after the other, the sum and then the rest are chosen; all together, the sum explains nothing.
    """
    rng = np.random.default_rng(seed)
    J = 60.0 * rng.standard_normal((rows, changes))
    places = rng.permutation(changes)
    where, x = np.sort(places[:true]), np.zeros(changes)
    if true > 1:
        J[:, places[true]] = own * J[:, places[true]] + J[:, places[:2]].sum(axis=1) / np.sqrt(2.0)
    x[where] = -0.5
    return J, -J @ x + rng.standard_normal(rows), where, x


@pytest.mark.slow
@pytest.mark.parametrize(("true", "own"), [(1, 1.0), (2, 0.3), (3, 0.2), (4, 0.3)])
def test_the_changes_found_are_the_best_of_all_sets_of_their_number(true, own):
    for seed in range(8):
        J, r, where, x = drawn(seed, true, own)
        found, at = search(linear(J, r), bounded(9), most=4, level=1e-3)
        least, on = best_of(J, r, bounded(9), true)
        assert on == where.tolist() == found
        assert at.chi2 == pytest.approx(least, rel=1e-6)
        assert np.flatnonzero(at.x).tolist() == found
        assert at.x[found] == pytest.approx(x[found], abs=0.05)


@pytest.mark.parametrize("most", [0, 1, 2, 3])
def test_no_more_changes_are_found_than_asked_for(most):
    J, r, *_ = drawn(3, 4, 0.3)
    found, at = search(linear(J, r), bounded(9), most=most, level=1e-3)
    assert len(found) == most
    assert at.chi2 == pytest.approx(best_of(J, r, bounded(9), most)[0], rel=1e-6)


@pytest.mark.parametrize(("size", "kept"), [(0.199, True), (0.201, False)])
def test_changes_below_the_least_are_left_out_and_the_others_fitted_again(size, kept):
    J, _ = np.linalg.qr(np.random.default_rng(1).standard_normal((12, 4)))
    J[:, 1] += 0.2 * J[:, 0]
    r = -1e4 * J @ [-0.7, -0.2, 0.0, 0.0]
    found, at = search(linear(1e4 * J, r), bounded(4), most=3, level=1e-3, least=size)
    assert found == ([0, 1] if kept else [0])
    assert at.chi2 == pytest.approx(best_of(1e4 * J, r, bounded(4), len(found))[0], abs=1e-6)


def test_a_change_beyond_its_bounds_ends_at_them():
    J = np.random.default_rng(2).standard_normal((10, 3))
    found, at = search(linear(50.0 * J, 50.0 * J[:, 2] * 1.4), bounded(3), most=1, level=1e-3)
    assert found == [2]
    assert at.x.tolist() == [0.0, 0.0, -1.0]


@pytest.mark.parametrize(("share", "found"), [(0.999, []), (1.001, [1])])
def test_residuals_that_noise_leaves_in_one_of_twenty_tables_are_not_searched(share, found):
    """Of ten rows; the change explains all of it, which is significant at this level."""
    J = np.zeros((10, 3))
    J[[0, 1, 2], [0, 1, 2]] = 100.0
    r = np.zeros(10)
    r[1] = np.sqrt(share * chi2.isf(0.05, 10))
    assert search(linear(J, r), bounded(3), most=2, level=0.3)[0] == found


@pytest.mark.parametrize("level", [1e-3, 1e-2])
@pytest.mark.parametrize("noise", [1.0, 4.0])
@pytest.mark.parametrize(("share", "found"), [(0.99, []), (1.01, [1])])
def test_a_change_is_significant_above_the_quantile_of_f_over_the_candidates(level, noise, share, found):
    """Chi^2 falls by the square of the residual in its row; the scale is that of the other rows, at least one."""
    rows, changes = 12, 4
    J = np.zeros((rows, changes))
    J[range(changes), range(changes)] = 100.0
    r = np.zeros(rows)
    r[changes:] = noise
    scale = max(1.0, np.sum(r**2) / (rows - 1))
    r[1] = np.sqrt(share * scale * f.isf(level / changes, 1, rows - 1))
    assert search(linear(J, r), bounded(changes), most=1, level=level)[0] == found


def test_data_that_depend_on_no_change_find_none():
    J = np.zeros((6, 3))
    assert search(linear(J, np.full(6, 9.0)), bounded(3), most=2, level=0.01)[0] == []
    J[:, 1] = 50.0
    found, at = search(linear(J, np.full(6, 9.0)), bounded(3), most=1, level=0.01)
    assert found == [1]
    assert at.x.tolist() == pytest.approx([0.0, -0.18, 0.0])
