"""Which rows are set aside, round by round, where each look at them finds what is said beforehand."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.updating.outliers import Outlier, shifts_of
from casingfem.updating.problem import Problem
from casingfem.updating.updating import contradicting, without_outliers
from tests.casingfem.updating.test_update_judged import blade, table, vary


def aside(*modes):
    return tuple(Outlier(modes=(mode,), n=-1, kind="frequency", shift=0.1, deviation=9.0) for mode in modes)


@dataclass
class Fit:
    """What the rounds ask of a fit."""

    x: np.ndarray
    table: cf.FrequencyTable
    lower: np.ndarray
    upper: np.ndarray
    given: SimpleNamespace
    before: str = "before"
    after: str = "modes of the fit"
    outliers: tuple = ()
    plain: object = None
    pairing = SimpleNamespace(matches="pairs of the fit")
    values = jacobian = None


class Rounds:
    """Looks at all rows find `whole` one after the other, those at the rows of a fit `own`, then nothing."""

    def __init__(self, monkeypatch, whole, own=(), rows=8, near=(0.3, -9.0)):
        self.whole_looks, self.own_looks, self.near = iter(whole), iter(own), np.array(near)
        self.fits, self.looks = [], []
        data = table(rows=rows)
        self.table = replace(data, sigma_hz=2.0 * data.sigma_hz)  # with the model's error
        state = SimpleNamespace(modes="modes", pairing=SimpleNamespace(matches="pairs"))
        self.problem = SimpleNamespace(
            shell="shell", table=self.table, vary=("E", "t"), count=11, reach=0.4, progress="progress", shapes=None,
            paired_anew=lambda x: state, fun=lambda x: None, jac=lambda x: None,
        )  # fmt: skip
        given = SimpleNamespace(table=self.table, with_priors=lambda *of: (None, None))
        self.fit = Fit(np.array([1.0, 2.0]), data, np.array([0.0, 1.5]), np.array([1.2, 4.0]), given)
        for name in ("contradicting", "fitted"):
            monkeypatch.setitem(without_outliers.__globals__, name, getattr(self, name))
        monkeypatch.setitem(without_outliers.__globals__, "shifts_of", lambda modes, rows, matches: (modes, matches))
        monkeypatch.setitem(without_outliers.__globals__, "Problem", lambda *of: of)

    def contradicting(self, shifts, residual, jacobian, fit, rows):
        own = shifts == ("modes of the fit", "pairs of the fit")
        assert own or shifts == ("modes", "pairs")
        assert rows is (fit.given.table if own else self.table)
        self.looks.append("own" if own else "whole")
        return aside(*next(self.own_looks if own else self.whole_looks, ())), self.near

    def fitted(self, less, rows, regularise, most, begin):
        assert (less[0], *less[2:]) == ("shell", ("E", "t"), 11, 0.4, "progress", None)
        assert (regularise, most) == ("regularise", 7)
        np.testing.assert_array_equal(less[1].mode, rows.mode)
        np.testing.assert_array_equal(less[1].sigma_hz, 2.0 * rows.sigma_hz)
        self.fits.append((sorted({*range(1, 9)} - set(rows.mode.tolist())), *begin))
        given = SimpleNamespace(table=less[1], with_priors=lambda *of: (None, None))
        return replace(self.fit, x=begin[0] + 0.1, table=rows, given=given, before="of its own")

    def __call__(self):
        return without_outliers(self.problem, self.fit, "regularise", 7)


def test_where_nothing_contradicts_the_fit_stays_as_it_is(monkeypatch):
    rounds = Rounds(monkeypatch, [()])
    assert rounds() is rounds.fit
    assert rounds.looks == ["whole", "own"]


@pytest.mark.parametrize(
    ("whole", "own", "fits"),
    [
        ([(5,), (5,)], [], [[5]]),
        ([(5,), (5,), (5, 7)], [(7,)], [[5], [5, 7]]),
        ([(5,), ()], [], [[5]]),
        ([()], [(3,)], [[3]]),
        ([(5,), (7,), (5,), (7,), (5,)], [], [[5], [7], [5], [7]]),
        ([(1,), (2,), (3,), (4,), (5,), (6,)], [], [[1], [2], [3], [4], [5]]),
    ],
)
def test_rows_are_looked_at_until_they_settle_five_times_at_most(monkeypatch, whole, own, fits):
    """All rows first; the fit's own where these are as before, or have been set aside twice."""
    rounds = Rounds(monkeypatch, whole, own)
    found = rounds()
    assert [rows for rows, *_ in rounds.fits] == fits
    assert [one.modes[0] for one in found.outliers] == fits[-1]
    assert found.plain is rounds.fit
    assert found.before == "before"
    assert rounds.fit.outliers == ()


def test_a_fit_begins_where_the_last_one_ended_with_a_step_within_the_bounds(monkeypatch):
    rounds = Rounds(monkeypatch, [(5,), (6,), (6,)])
    rounds()
    (_, x, step), (_, other, less) = rounds.fits
    np.testing.assert_array_equal(x, [1.0, 2.0])
    np.testing.assert_allclose(step, [0.2, -0.5], rtol=1e-12)
    np.testing.assert_allclose(other, [1.1, 2.1], rtol=1e-12)
    np.testing.assert_allclose(less, [0.1, -0.6], rtol=1e-12)


@pytest.mark.parametrize(("rows", "many"), [(3, 0), (4, 1)])
def test_more_rows_are_kept_than_parameters(monkeypatch, rows, many):
    rounds = Rounds(monkeypatch, [(1,), (1,)], rows=rows)
    assert len(rounds().outliers) == many


def test_what_stands_on_a_bound_gives_no_way_to_a_row():
    """A row 4 % off of eight; the step without it brings the thickness alone where all others want it."""
    problem = Problem(blade(), table(rows=8), vary("material.E", "shell.thickness"), 10, 0.5)
    x = problem.start
    J, state = problem.jac(x), problem.state(x)
    r = 1e-5 * J[:, 1] + 0.3 * np.array([1, -1, -1, 1, 1, 1, -1, -1])
    shifts = shifts_of(state.modes, problem.table, state.pairing.matches)
    shifted = r - 40.0 * np.eye(8)[4]  # 4 % of sigma 1e-3
    found, step = contradicting(shifts, shifted, J, SimpleNamespace(at_bound=(True, False)), problem.table)
    assert [one.modes for one in found] == [(5,)]
    rest = np.arange(8) != 4
    expected = -(J[rest, 1] @ r[rest]) / (J[rest, 1] @ J[rest, 1])
    np.testing.assert_allclose(step, [0.0, expected], rtol=1e-6, atol=1e-12)
