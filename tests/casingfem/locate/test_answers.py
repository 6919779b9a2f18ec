"""What the answer of a search may mean, and the steps that lead to it, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import f as fisher

from casingfem.locate.explanations import (
    LIKELY,
    groups_alike,
    half_turns,
    images,
    likely,
    loosening,
    placed,
    promised,
    sigmas,
    visible,
)
from casingfem.locate.misfit import Point
from casingfem.locate.sparse_search import Bounds, best_addition, bounded_step, fitted, keep_searching

RNG = np.random.default_rng(43)


def test_a_bolt_can_lose_all_that_it_has():
    bounds = loosening(np.array([1.0, 0.4]))
    assert bounds.lower.tolist() == [-1.0, -0.4]
    assert bounds.upper.tolist() == [0.0, 0.0]
    assert bounds.span.tolist() == [1.0, 0.4]


def test_standard_deviations_are_those_of_the_normal_matrix():
    J = RNG.standard_normal((6, 2)) * [1.0, 20.0]
    np.testing.assert_allclose(sigmas(J, 3.0), 3.0 * np.sqrt(np.diag(np.linalg.inv(J.T @ J))), rtol=1e-9)
    assert sigmas(np.zeros((6, 0)), 3.0).shape == (0,)
    assert sigmas(np.column_stack([J[:, 0], np.zeros(6)]), 1.0)[1] > 1e6 * sigmas(J[:, :1], 1.0)[0]


ANGLES = 2.0 * np.pi * np.arange(8) / 8


def test_places_are_candidates_at_their_angles_or_none():
    assert list(placed(np.array([ANGLES[3] + 2.0 * np.pi, ANGLES[6] + 0.9e-6]), ANGLES)) == [[3, 6]]
    assert list(placed(np.array([ANGLES[3] + 1.1e-6]), ANGLES)) == []
    assert list(placed(np.array([ANGLES[3], ANGLES[3]]), ANGLES)) == []


def test_images_are_half_turns_then_turns_and_mirrors_of_all():
    found = list(images([1, 2], ANGLES))
    assert found[:4] == [[1, 2], [1, 6], [5, 2], [5, 6]]
    assert found[4:12] == [[k, (k + 1) % 8] for k in range(8)]
    assert found[12:] == [[k, (k - 1) % 8] for k in range(8)]
    assert list(images([], ANGLES)) == [[]]
    assert half_turns(4)[0] == (False,) * 4
    assert len(half_turns(4)) == 16
    assert half_turns(5) == []


def test_likely_explanations_are_within_three_sigma_the_best_first():
    told = [SimpleNamespace(behind=b) for b in (3.0, 8.999, 9.0, -1.0)]
    assert [one.behind for one in likely(told)] == [-1.0, 3.0, 8.999]
    assert LIKELY == 3.0**2


def point(jacobian, values, x=None, chi2=None):
    values, jacobian = np.array(values, dtype=float), np.array(jacobian, dtype=float)
    start = np.zeros(jacobian.shape[1]) if x is None else np.array(x)
    return Point(start, None, values, jacobian, float(values @ values) if chi2 is None else chi2)


def test_the_smallest_change_that_shows_is_that_of_the_f_test():
    at = point(np.array([[3.0, 0.0, 0.0], [4.0, 0.0, 0.5]] + [[0.0] * 3] * 8), np.zeros(10))
    needed = fisher.isf(0.05 / 3, 1, 9)
    np.testing.assert_allclose(visible(at, 0.05, 1.5), 1.5 * np.sqrt(needed) / [5.0, np.nan, 0.5], rtol=1e-9)


@pytest.mark.parametrize(("cosine", "groups"), [(0.9991, ((1, 3),)), (0.9989, ())])
def test_places_of_parallel_effects_are_one_group(cosine, groups):
    third = [5.0 * cosine, 5.0 * np.sqrt(1.0 - cosine**2), 0.0]
    J = np.column_stack([[2.0, 0.0, 0.0], [0.0, 0.0, 1.0], third, [0.0, 0.0, 0.0], [-2.0, 0.0, 0.0]])
    assert groups_alike(J) == groups
    alike = np.column_stack([J[:, 0], J[:, 1], 2.0 * J[:, 0], 3.0 * J[:, 1], J[:, 0]])
    assert groups_alike(alike) == ((1, 3, 5), (2, 4))


def test_a_linear_step_within_bounds_promises_what_is_left():
    """Rows that pair with nothing, 100 of chi^2, stay; the second change stops at its bound."""
    at = point([[2.0, 0.0], [0.0, 1.0], [0.0, 0.0]], [1.0, 3.0, 0.5], [-0.2, -0.1], chi2=110.25)
    bounds = Bounds(lower=np.array([-1.0, -0.6]), upper=np.zeros(2))
    assert promised(at, [0, 1], bounds) == pytest.approx(100.0 + 2.5**2 + 0.25)
    assert promised(at, [0], bounds) == pytest.approx(100.0 + 9.25)
    assert promised(point(np.zeros((3, 2)), [1.0, 3.0, 0.5]), [0], bounds) == pytest.approx(10.25)


def test_a_bounded_step_is_none_where_nothing_is_seen():
    at = point([[1.0, 0.0], [0.0, 0.0]], [2.0, 1.0])
    low, high = np.array([-5.0]), np.array([1.0])
    assert bounded_step(at, [1], low, high) is None
    assert bounded_step(point(np.zeros((0, 2)), []), [0], low, high) is None
    np.testing.assert_allclose(bounded_step(at, [0], low, high), [-2.0], atol=1e-9)
    np.testing.assert_allclose(bounded_step(at, [0], -0.5 * high, high), [-0.5], atol=1e-12)
    both = bounded_step(at, [0, 1], np.full(2, -5.0), np.full(2, 1.0))
    assert both[0] == pytest.approx(-2.0)


def test_a_fit_halves_steps_until_they_gain():
    """chi^2 has its minimum at .3 of the first linear step; others than the active ones go back to zero."""
    asked = []

    def evaluate(x):
        asked.append(x.copy())
        return Point(
            x, None, np.array([10.0 * (x[0] + 0.3)]), np.array([[3.0, 1.0]]), float((x[0] + 0.3) ** 2 + x[1] ** 2)
        )

    bounds = Bounds(lower=-np.ones(2), upper=np.ones(2))
    start = evaluate(np.array([0.0, 0.5]))
    found = fitted(evaluate, start, [0], bounds)
    assert asked[1].tolist() == [0.0, 0.0]
    assert asked[2][0] == pytest.approx(-1.0)  # to the bound, no gain; a half of it gains
    assert asked[3][0] == pytest.approx(-0.5)
    assert found.x[1] == 0.0
    assert found.chi2 < 0.09
    assert fitted(evaluate, start, [0, 1], bounds).chi2 < start.chi2
    none = fitted(evaluate, start, [], bounds)
    assert none.x.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("taken", "accepted", "chi2", "on"),
    [
        (0, 0, 99.0, True),
        (1, 0, 99.0, True),
        (2, 0, 99.0, False),
        (2, 1, 99.0, True),
        (3, 3, 99.0, False),
        (0, 0, 1.0, False),
    ],
)
def test_a_search_goes_on_while_a_change_may_be_accepted_and_noise_explains_too_little(taken, accepted, chi2, on):
    at = point(np.zeros((8, 2)), np.zeros(8), chi2=chi2)
    assert keep_searching(taken, accepted, 3, at, 0.01) is on


def test_of_the_most_promising_changes_the_best_on_the_full_model_is_taken():
    """The linear model promises most of the first; the full one gains most by the second; the third is not tried."""

    def evaluate(x):
        gain = 3.0 * abs(x[0]) + 8.0 * abs(x[1]) + 20.0 * abs(x[2])
        return Point(x, None, np.array([4.0, 3.0, 1.0]), -np.diag([4.0, 3.0, 1.0]), 26.0 - gain)

    bounds = Bounds(lower=np.zeros(3), upper=np.ones(3))
    taken, there = best_addition(evaluate, evaluate(np.zeros(3)), [], bounds, tried=2)
    assert taken == 1
    assert there.x.tolist() == [0.0, 1.0, 0.0]
