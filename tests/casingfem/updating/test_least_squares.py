"""The solver of an update on drawn problems: scipy's optimum within bounds, reasons for stopping, points that fail.

These tests call the solver itself: residuals that stay large or cannot be evaluated are drawn, which no casing offers.
"""

import numpy as np
import pytest
from scipy.optimize import least_squares

from casingfem.updating.least_squares import levenberg_marquardt
from casingfem.updating.solve import stepped

T = np.linspace(0.0, 3.0, 25)
FAR = np.full(2, 50.0)


class Counted:
    """Residuals and derivatives that count how often they are evaluated."""

    def __init__(self, fun, jac, fails=lambda x: False):
        self.parts, self.fails, self.evaluations, self.slopes = (fun, jac), fails, 0, 0

    def fun(self, x):
        self.evaluations += 1
        if self.fails(x):
            raise ValueError("no such point")
        return self.parts[0](x)

    def jac(self, x):
        self.slopes += 1
        return self.parts[1](x)

    def solved(self, x, lower=-FAR, upper=FAR, most=100, **more):
        return levenberg_marquardt(self.fun, self.jac, np.array(x, float), lower, upper, most, **more)


def decay(noise, seed=1):
    """Of a e^(-b t) with noise, which leaves residuals of its size."""
    y = 2.0 * np.exp(-1.3 * T) + noise * np.random.default_rng(seed).standard_normal(T.size)

    def jac(x):
        return np.column_stack([np.exp(-x[1] * T), -x[0] * T * np.exp(-x[1] * T)])

    return Counted(lambda x: x[0] * np.exp(-x[1] * T) - y, jac)


def rosenbrock():
    return Counted(
        lambda x: np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]]),
        lambda x: np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]]),
    )


@pytest.mark.parametrize("noise", [0.01, 0.3, 1.0])
@pytest.mark.parametrize("upper", [50.0, 1.5])
@pytest.mark.parametrize("start", [[1.0, 0.2], [0.3, 1.4], [1.4, 1.0]])
def test_the_end_is_the_optimum_within_the_bounds(noise, upper, start):
    problem = decay(noise)
    lower, upper = np.zeros(2), np.array([upper, 50.0])
    end = problem.solved(start, lower, upper, decrease=1e-14)
    exact = least_squares(problem.parts[0], start, problem.parts[1], bounds=(lower, upper), xtol=1e-14, gtol=1e-14)
    assert end.stopped == "converged: no step is predicted to lower chi^2"
    assert end.x == pytest.approx(exact.x, rel=2e-4)  # of scipy beside a bound
    if exact.active_mask.any():
        assert end.x[0] == upper[0]


def test_a_curved_valley_is_followed_to_its_end():
    problem = rosenbrock()
    end = problem.solved([-1.2, 1.0])
    assert end.x == pytest.approx([1.0, 1.0], abs=1e-5)
    assert problem.evaluations < 40
    assert problem.slopes < problem.evaluations  # only after steps that are taken


def test_second_derivatives_spare_steps_where_residuals_stay_large():
    """Without them the last steps overshoot; `enough` asks to do without."""
    counts = []
    for seed in (1, 2, 4, 5, 6, 7):
        with_them, without = decay(3.0, seed), decay(3.0, seed)
        one = with_them.solved([1.0, 0.5], decrease=1e-14)
        two = without.solved([1.0, 0.5], decrease=1e-14, enough=1e-9)
        assert one.x == pytest.approx(two.x, rel=1e-4)
        assert np.abs(one.S).max() > 0.0
        counts.append((with_them.evaluations, without.evaluations))
    used, needed = np.sum(counts, axis=0)
    assert used <= 46 < 70 <= needed


def test_second_derivatives_that_are_known_are_used_from_the_start():
    usual, known, none = (decay(3.0, seed=7) for _ in range(3))
    end = usual.solved([1.0, 0.5], decrease=1e-14)
    again = known.solved(end.x + 0.1, decrease=1e-14, S=end.S, damping=1e-6)
    none.solved(end.x + 0.1, decrease=1e-14, damping=1e-6, enough=1e-9)
    assert again.x == pytest.approx(end.x, rel=1e-4)
    assert known.evaluations < none.evaluations


def test_second_derivatives_at_the_end_are_those_of_the_residuals():
    problem = decay(1.0, seed=2)
    end = problem.solved([2.0, 0.2], decrease=1e-14)
    r, e = problem.parts[0](end.x), np.exp(-end.x[1] * T)
    exact = np.array([[0.0, -(r @ (T * e))], [-(r @ (T * e)), end.x[0] * (r @ (T**2 * e))]])
    np.testing.assert_allclose(end.S, exact, atol=0.35 * np.abs(exact).max())


@pytest.mark.parametrize("most", [1, 3])
def test_no_more_points_are_evaluated_than_asked_for(most):
    problem = rosenbrock()
    end = problem.solved([-1.2, 1.0], most=most)
    assert end.stopped == f"not converged after {most} evaluations"
    assert problem.evaluations == most + 1  # and the start
    assert float(np.sum(problem.parts[0](end.x) ** 2)) <= 24.2


def test_the_iteration_ends_below_the_sum_of_squares_that_is_enough():
    problem = decay(0.3)
    least = float(np.sum(problem.parts[0](problem.solved([1.0, 0.2]).x) ** 2))
    end = problem.solved([1.0, 0.2], enough=1.2 * least)
    assert end.stopped == f"converged: chi^2 is below {1.2 * least:g}, which round-off explains"
    assert least < float(np.sum(problem.parts[0](end.x) ** 2)) < 1.2 * least
    assert problem.solved([1.0, 0.2], enough=0.99 * least).stopped == "converged: no step is predicted to lower chi^2"


def test_a_linear_problem_is_solved_in_few_steps_and_ends_without_another():
    J = np.random.default_rng(1).standard_normal((8, 2))
    problem = Counted(lambda x: J @ (x - [3.0, -2.0]), lambda x: J)
    end = problem.solved([0.0, 0.0])
    assert end.x == pytest.approx([3.0, -2.0], rel=1e-4)
    assert problem.evaluations < 8
    once = problem.evaluations
    assert problem.solved(end.x, damping=1e-3).x == pytest.approx(end.x, rel=1e-4)
    assert problem.evaluations - once <= 2


def test_points_that_cannot_be_evaluated_are_avoided():
    problem = rosenbrock()
    problem.fails = lambda x: x[0] > 1.0 + 1e-3 or x[1] > 1.5
    end = problem.solved([-1.2, 1.0])
    assert end.x == pytest.approx([1.0, 1.0], abs=1e-4)


def test_derivatives_of_the_wrong_sign_end_with_a_reason():
    problem = decay(0.1)
    problem.parts = problem.parts[0], lambda x, jac=problem.parts[1]: -jac(x)
    end = problem.solved([1.0, 0.2], -1e12 * FAR, 1e12 * FAR)
    assert end.stopped == "not converged: even steps far below the range of the parameters do not lower chi^2"
    assert end.x.tolist() == [1.0, 0.2]


def test_a_parameter_without_effect_stays():
    J = np.array([[1.0, 0.0], [2.0, 0.0], [0.5, 0.0]])
    end = Counted(lambda x: J @ x - [3.0, 6.0, 1.5], lambda x: J).solved([0.0, 7.0])
    assert end.x == pytest.approx([3.0, 7.0], rel=1e-4)


class Bounded:
    """A problem that has a solution up to a length from the start."""

    def __init__(self, reach):
        self.reach = reach

    def state(self, x):
        if x[0] > self.reach:
            raise ValueError("springs turned negative")


@pytest.mark.parametrize(("reach", "share"), [(9.0, 1.0), (7.9, 0.5), (3.9, 0.25), (1.9, 0.125), (0.9, 0.0)])
def test_a_step_is_halved_until_the_structure_there_has_a_solution(reach, share):
    found = stepped(Bounded(1.0 + reach), np.array([1.0, 2.0]), np.array([8.0, -4.0]))
    assert found.tolist() == [1.0 + 8.0 * share, 2.0 - 4.0 * share]
