"""Levenberg and Marquardt within bounds: known minima, bounds, refused points."""

import numpy as np
import pytest

from casingfem.updating.solve import PREDICTED_DECREASE, levenberg_marquardt


def rosenbrock(x):
    return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])


def slope(x):
    return np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])


WIDE = np.full(2, 10.0)


def test_rosenbrock_from_its_classical_start():
    x, why = levenberg_marquardt(rosenbrock, slope, np.array([-1.2, 1.0]), -WIDE, WIDE, 60)
    np.testing.assert_allclose(x, [1.0, 1.0], atol=2e-5)  # sqrt(FLOOR) = 1e-5 in 1 - x_1, twice that in x_2
    assert why.startswith("converged")


def test_a_linear_problem_takes_its_exact_minimum():
    random = np.random.default_rng(5)
    A, b = random.standard_normal((9, 2)), random.standard_normal(9)
    exact = np.linalg.lstsq(A, b, rcond=None)[0]
    limit = np.linalg.norm(A @ exact - b) * np.sqrt(PREDICTED_DECREASE) / np.linalg.svd(A)[1].min()
    x, _ = levenberg_marquardt(lambda x: A @ x - b, lambda x: A, np.zeros(2), -WIDE, WIDE, 40)
    np.testing.assert_allclose(x, exact, atol=limit)


def test_bounds_hold_and_the_rest_is_minimal():
    upper = np.array([0.5, 10.0])
    x, _ = levenberg_marquardt(rosenbrock, slope, np.array([-1.2, 1.0]), -WIDE, upper, 60)
    np.testing.assert_allclose(x, [0.5, 0.25], atol=2e-5)  # sqrt(PREDICTED_DECREASE chi^2)/10


def test_units_do_not_matter():
    unit = np.array([1e11, 1e-3])
    x, _ = levenberg_marquardt(
        lambda y: rosenbrock(y / unit), lambda y: slope(y / unit) / unit, np.array([-1.2, 1.0]) * unit,
        -WIDE * unit, WIDE * unit, 60,
    )  # fmt: skip
    np.testing.assert_allclose(x / unit, [1.0, 1.0], atol=2e-5)


def test_a_point_that_cannot_be_evaluated_is_stepped_around():
    def fun(x):
        if x[1] > 1.2:
            raise ValueError("no such structure")
        return rosenbrock(x)

    x, _ = levenberg_marquardt(fun, slope, np.array([-1.0, 1.0]), -WIDE, WIDE, 80)
    np.testing.assert_allclose(x, [1.0, 1.0], atol=2e-5)


def test_a_direction_without_data_is_left_alone():
    x, _ = levenberg_marquardt(
        lambda x: x[:1] - 3.0, lambda x: np.array([[1.0, 0.0]]), np.array([0.0, 2.0]), -WIDE, WIDE, 40
    )
    np.testing.assert_allclose(x, [3.0, 2.0], atol=1e-6)


def test_a_sum_of_squares_that_is_enough_ends_the_descent():
    seen = []

    def fun(x):
        seen.append(float(np.sum((10.0 * x) ** 2)))
        return 10.0 * x

    x, why = levenberg_marquardt(fun, lambda x: 10.0 * np.eye(2), np.ones(2), -WIDE, WIDE, 20, enough=50.0)
    assert seen[-1] < 50.0 <= min(seen[:-1])
    assert np.abs(x).max() > 1e-3
    assert "below 50" in why


def test_running_out_of_evaluations_is_told():
    _, why = levenberg_marquardt(rosenbrock, slope, np.array([-1.2, 1.0]), -WIDE, WIDE, 3)
    assert why == "not converged after 3 evaluations"


@pytest.mark.parametrize("side", [0.0, 3.0])
def test_starting_on_a_bound(side):
    x, _ = levenberg_marquardt(
        lambda x: x - 1.0, lambda x: np.eye(2), np.array([side, side]), np.zeros(2), np.full(2, 3.0), 40
    )
    np.testing.assert_allclose(x, [1.0, 1.0], atol=1e-6)


def descent(values, jacobians, x=1.0, c=0.0):
    """Trial points of a descent of r = (x, c) with given residuals and slopes; a None is refused."""
    trials, answers, slopes = [], iter([(x, c), *values]), iter(jacobians)

    def fun(at):
        trials.append(at.copy())
        answer = next(answers)
        if answer is None:
            raise ValueError("no such structure")
        return np.array(answer)

    why = levenberg_marquardt(
        fun, lambda _: np.array([[next(slopes)], [0.0]]), np.array([x]), -WIDE[:1], WIDE[:1], len(values)
    )[1]  # fmt: skip
    return np.array(trials)[1:, 0], why


def test_refused_steps_are_damped_by_two_four_eight_and_taken_ones_begin_again():
    """Of r = x a step ends at x mu/(1 + mu); one that brings what it promised leaves .03 of mu."""
    trials, why = descent([None, None, None, (6.4 / 7.4, 0.0), None, None, (9.0, 0.0)], [1.0] * 2)
    start = np.array([1.0] * 4 + [6.4 / 7.4] * 3)
    mu = np.array([0.1, 0.2, 0.8, 6.4, 0.192, 0.384, 1.536])
    np.testing.assert_allclose(trials, start * mu / (1.0 + mu), rtol=1e-12)
    assert why == "not converged after 7 evaluations"


@pytest.mark.parametrize("gain", [-0.2, 0.0009, 0.0011, 0.002, 0.3, 0.6, 0.9, 1.0, 1.4])
def test_the_damping_follows_what_a_step_brought_over_what_it_promised(gain):
    """mu max(.03, 1 - (2 gain - 1)^3) from a gain of .001 on; twice mu below, from where it was."""
    promised = 1.0 - (0.1 / 1.1) ** 2
    left = 26.0 - gain * promised  # of |r|^2, r = (1, 5)
    trials, _ = descent([(0.7, np.sqrt(left - 0.49)), (0.0, 0.0)], [1.0] * 3, c=5.0)
    taken = gain > 0.001
    mu = 0.1 * max(0.03, 1.0 - (2.0 * gain - 1.0) ** 3) if taken else 0.2
    from_there, r = (0.1 / 1.1, 0.7) if taken else (1.0, 1.0)
    np.testing.assert_allclose(trials, [0.1 / 1.1, from_there - r / (1.0 + mu)], rtol=1e-11)


@pytest.mark.parametrize(("slopes", "scales"), [((2.0, 1.0, 4.0), (2.0, 4.0)), ((1.0, 3.0, 0.5), (3.0, 3.0))])
def test_the_damping_weighs_by_the_largest_slope_so_far(slopes, scales):
    """d = -J r/(J^2 + mu D^2); each step brings all it promised."""
    x, mu, r = 1.0, 0.1, 1.0
    ends, values = [], []
    for J, D in zip(slopes, (slopes[0], *scales), strict=True):
        step = -J * r / (J**2 + mu * D**2)
        x, r, mu = x + step, r + J * step, 0.03 * mu
        ends.append(x)
        values.append((r, 0.0))
    trials, _ = descent(values, [*slopes, 1.0])
    np.testing.assert_allclose(trials, ends, rtol=1e-9)


@pytest.mark.parametrize(("c", "squares"), [(100.0, 1e-3 + 1e-10), (0.0, 1e-10)])
@pytest.mark.parametrize("by", [0.99, 1.01])
def test_a_descent_ends_where_a_step_promises_less_than_round_off(c, squares, by):
    """1e-7 of the sum of squares and 1e-10; the first step promises 120/121 of x^2."""
    x = np.sqrt(by * squares * 121.0 / 120.0)
    trials, why = descent([(0.0, c)], [1.0] * 2, x=x, c=c)
    assert len(trials) == (by > 1.0)
    assert (why == "converged: no step promises to lower chi^2") == (by < 1.0)


@pytest.mark.parametrize(("width", "count"), [(9.6e9, 6), (9.8e9, 5)])
def test_steps_too_small_for_their_bounds_end_a_descent_that_gains_nothing(width, count):
    """A fifth step of 1/103.4 is 1e-12 of 9.67e9. A parameter that does not move at all is no reason to end."""
    tried = []

    def fun(x):
        tried.append(x)
        return np.array([1.0]) if len(tried) == 1 else np.array([2.0])

    _, why = levenberg_marquardt(
        fun,
        lambda _: np.array([[1.0, 0.0]]),
        np.ones(2),
        np.array([-0.4, -0.5]) * width,
        np.array([0.6, 0.5]) * width,
        20,
    )
    assert why == "stuck: steps too small to matter do not lower chi^2"
    assert len(tried) == 1 + count


def test_a_sum_of_squares_that_is_just_enough_is_not_below_it():
    x, why = levenberg_marquardt(lambda x: x, lambda _: np.eye(1), np.array([2.0]), -WIDE[:1], WIDE[:1], 5, enough=4.0)
    np.testing.assert_allclose(x, [0.2 / 1.1], rtol=1e-12)
    assert why == "converged: chi^2 is below 4"
