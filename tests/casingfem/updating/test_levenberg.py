"""Levenberg and Marquardt within bounds: known minima, bounds, refused points."""

import numpy as np
import pytest

from casingfem.updating.levenberg import PREDICTED_DECREASE, levenberg_marquardt


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
