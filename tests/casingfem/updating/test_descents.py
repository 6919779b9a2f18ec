"""One way down, step by step, on a problem that tells what it is asked: r = x - goal."""

from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.updating.solve import descend

LOW, HIGH = np.array([0.0, -1.0]), np.array([8.0, 6.0])
SCALE = 1e3  # residuals of a far start are large beside what ends a descent


class Told:
    """Rows pair better `better` times after a descent, modes are missed `missed` times."""

    def __init__(self, better=0, missed=0, shapes=None, rows=2, start=(2.0, 5.0)):
        self.start, self.shapes, self.shapes_wait = np.array(start), shapes, False
        self.better, self.missed, self.rows = better, missed, rows
        self.told, self.places = [], []

    def state(self, rms):
        match = SimpleNamespace(rows=(0,))
        return SimpleNamespace(pairing=SimpleNamespace(matches=(match,), rms=rms), values=np.zeros(self.rows))

    def paired_anew(self, x):
        self.told.append("paired, shapes wait" if self.shapes_wait else "paired")
        self.places.append(x.copy())
        lower = self.told[-2:-1] == ["counted"] and self.better > 0
        self.better -= lower
        return self.state(0.5 if lower else 1.0)

    def fun(self, x):
        if not self.told[-1].startswith("descent"):
            self.told.append("descent of frequencies" if self.shapes_wait else "descent")
        return SCALE * (x - [3.0, 1.0]) if self.shapes_wait else SCALE * (x - [4.0, 2.0])

    def jac(self, x):
        return SCALE * np.eye(2)

    def counted(self, x):
        self.missed -= 1
        self.told.append("counted" if self.missed < 0 else "missed")
        self.end = self.state(1.0)
        return self.end if self.missed < 0 else None

    def solve_afresh(self):
        self.told.append("afresh")

    def adopt(self, x, state):
        assert state is self.end
        self.told.append("adopted")
        self.places.append(x.copy())


def down(problem, most=40, damping=0.1, begin=None):
    return descend(problem, LOW, HIGH, most, damping, begin)


ROUND = ["descent", "counted", "paired"]


@pytest.mark.parametrize(("better", "rounds"), [(0, 1), (1, 2), (3, 4), (4, 4), (9, 4)])
def test_a_descent_begins_again_where_rows_pair_better_three_times_at_most(better, rounds):
    problem = Told(better=better)
    x, why = down(problem)
    np.testing.assert_allclose(x, [4.0, 2.0], atol=1e-7)
    assert why.startswith("converged")
    assert problem.told == ["paired", *ROUND * rounds, *(["adopted"] if better < 4 else [])]
    np.testing.assert_array_equal(problem.places[0], [2.0, 5.0])
    np.testing.assert_array_equal(problem.places[1], x)


@pytest.mark.parametrize("missed", [1, 3, 4])
def test_where_a_mode_was_missed_every_point_is_solved_from_nothing(missed):
    problem = Told(missed=missed)
    down(problem)
    again = ["descent", "missed", "afresh", "paired"] * missed
    assert problem.told == ["paired", *again, *([*ROUND, "adopted"] if missed < 4 else [])]


@pytest.mark.parametrize(
    ("start", "begin", "first"),
    [((9.0, -2.0), None, (8.0, -1.0)), ((9.0, -2.0), (1.0, 7.0), (1.0, 6.0)), ((1.0, 1.0), (3.0, 2.0), (3.0, 2.0))],
)
def test_a_descent_begins_within_the_bounds(start, begin, first):
    problem = Told(start=start)
    down(problem, begin=None if begin is None else np.array(begin))
    np.testing.assert_array_equal(problem.places[0], first)


def test_the_damping_and_the_most_evaluations_are_those_asked_for():
    """A damped step leaves mu/(1 + mu) of the way."""
    x, why = down(Told(), most=1, damping=0.25)
    np.testing.assert_allclose(x, [4.0 - 2.0 * 0.2, 2.0 + 3.0 * 0.2], rtol=1e-12)
    assert why == "not converged after 1 evaluations"


@pytest.mark.parametrize(("rows", "first"), [(1, False), (2, True), (3, True)])
def test_frequencies_go_before_shapes_where_they_are_as_many_as_parameters(rows, first):
    problem = Told(shapes="shapes", rows=rows)
    x, _ = down(problem)
    alone = ["descent of frequencies"] if first else []
    assert problem.told == ["paired", "paired, shapes wait", *alone, "paired", *ROUND, "adopted"]
    np.testing.assert_allclose(x, [4.0, 2.0], atol=1e-7)
    np.testing.assert_allclose(problem.places[2], [3.0, 1.0] if first else [2.0, 5.0], atol=np.sqrt(rows) / SCALE)


def test_frequencies_alone_go_down_to_their_noise_and_no_further():
    """A sum of squares of 300 is enough for 300 rows, 17e6 at the start.

    Steps leave .1/1.1 of the way, then .003/1.003 of that: 141 000, 1.26.
    """
    problem = Told(shapes="shapes", rows=300)
    down(problem)
    left = 0.1 / 1.1 * (0.003 / 1.003)
    np.testing.assert_allclose(problem.places[2] - [3.0, 1.0], left * np.array([-1.0, 4.0]), rtol=1e-6)


def test_shapes_do_not_wait_where_a_descent_begins_elsewhere():
    problem = Told(shapes="shapes")
    down(problem, begin=np.array([1.0, 1.0]))
    assert problem.told == ["paired", *ROUND, "adopted"]
