"""What a result says, on a fit of a blade whose numbers are replaced; the way down to it, step by step."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.updating.following import overlaps, paired_rows, plane_of
from casingfem.updating.problem import Given, Problem
from casingfem.updating.solve import covariance, lower_misfit, require_enough, solve, stepped
from casingfem.updating.updating import fitted_to_mesh, modes_of
from tests.casingfem.updating.test_update_judged import blade, table, vary


@pytest.fixture(scope="module")
def fit():
    return cf.update(blade(), table(1e-3, rows=6), vary("material.E", "shell.thickness"), outliers="keep")


def test_the_floor_of_a_model_is_what_brings_chi_square_to_its_freedom(fit):
    """All sigma 1e-3 of their frequencies, four degrees of freedom: chi^2/(1 + s^2/1e-6) = 4."""
    far = replace(fit, values=np.array([3.0, -4.0, 5.0, 1.0, -2.0, 3.0]))
    assert far.chi2 == pytest.approx(64.0)
    assert far.model_floor == pytest.approx(1e-3 * np.sqrt(64.0 / 4.0 - 1.0), rel=1e-6)
    assert replace(fit, values=np.full(6, 0.8)).model_floor == 0.0
    assert replace(fit, values=np.full(6, 0.8165)).model_floor > 0.0
    assert far.free == 4
    assert far.residuals == 6
    assert far.misfit == pytest.approx(4.0)
    assert far.inflation == pytest.approx(4.0)
    np.testing.assert_allclose(far.sigma, 4.0 * fit.stated_sigma, rtol=1e-12)


@pytest.mark.parametrize(
    ("rms", "stopped", "arrived"),
    [(1.999, "converged: so", True), (2.001, "converged: so", False), (0.1, "stuck: so", False)],
)
def test_a_fit_has_arrived_where_it_converged_within_two_sigma(fit, rms, stopped, arrived):
    assert replace(fit, values=rms * np.array([1.0, -1.0] * 3), stopped=stopped).arrived is arrived


def test_parameters_that_correlate_beyond_95_per_cent_are_told(fit):
    for r, told in ((0.951, True), (-0.951, True), (0.949, False)):
        C = np.array([[4.0, 2.0 * 3.0 * r], [2.0 * 3.0 * r, 9.0]])
        found = replace(fit, covariance=C)
        np.testing.assert_allclose(found.correlation, [[1.0, r], [r, 1.0]], rtol=1e-12)
        pairs = found.indistinct()
        assert pairs == ([("shell.thickness", "material.E", pytest.approx(r))] if told else [])
    blind = replace(fit, covariance=np.diag([4.0, 0.0]))
    np.testing.assert_array_equal(blind.correlation, [[1.0, 0.0], [0.0, 0.0]])


def test_pairs_and_parameters_are_told_as_plain_data(fit):
    row = fit.pairs()[2]
    given = fit.table
    expected = {
        "mode": 3, "n": None, "measured_hz": given.freq_hz[2], "before_hz": fit.before.freq[2],
        "after_hz": fit.after.freq[2], "sigma_hz": given.sigma_hz[2], "confidence": pytest.approx(1.0, abs=1.0),
        "error_after_rel": pytest.approx(fit.after.freq[2] / given.freq_hz[2] - 1.0, rel=1e-12),
    }  # fmt: skip
    assert {name: row[name] for name in expected} == expected
    assert [pair["mode"] for pair in fit.pairs()] == [1, 2, 3, 4, 5, 6]
    first = fit.records()[0]
    assert first["name"] == "material.E"
    assert (first["start"], first["value"]) == (206.85e9, fit.value[0])
    assert (first["sigma"], first["log"], first["at_bound"]) == (fit.sigma[0], False, False)
    told = fit.to_json()
    assert told["iterations"] == len(fit.history)
    assert told["misfit"] == fit.misfit
    assert told["unpaired"] == []
    assert told["with_outliers"] is None
    assert told["regularised"] is None
    before, after = (np.sqrt(np.mean((f[:6] / given.freq_hz - 1.0) ** 2)) for f in (fit.before.freq, fit.after.freq))
    assert (told["rms_before"], told["rms_after"]) == (pytest.approx(before), pytest.approx(after))
    assert fit.residuals_of() == [1] * 6


def test_rows_that_are_lost_or_unpaired_are_told_by_their_numbers(fit):
    assert replace(fit, lost=(2, 4)).to_json()["lost"] == [3, 5]
    assert "because mode 3, 5 of the table could not be followed" in repr(replace(fit, lost=(2, 4)))
    assert replace(fit, pairing=replace(fit.pairing, unpaired_rows=(0, 3))).unpaired == (1, 4)


def test_priors_pull_their_parameters_to_the_start(fit):
    given = replace(fit.given, prior=np.array([0.0, 3.0]), start=np.array([1.0, 2.0]))
    values, jacobian = given.with_priors(np.array([1.5, 1.8]), np.array([7.0]), np.array([[4.0, 5.0]]))
    np.testing.assert_allclose(values, [7.0, 3.0 * -0.2], rtol=1e-12)
    np.testing.assert_array_equal(jacobian, [[4.0, 5.0], [0.0, 3.0]])
    assert isinstance(given, Given)
    assert given.problem().prior is given.prior


def test_a_problem_knows_its_start_its_priors_and_what_it_was_made_of():
    free = [
        cf.Parameter(name="material.E", lower=1e9, upper=1e12, log=True),
        cf.Parameter(name="shell.thickness", lower=1e-3, upper=1e-2, sigma=2e-4),
    ]
    problem = Problem(blade(), table(rows=3), free, 7, 0.25)
    np.testing.assert_allclose(problem.start, [np.log10(206.85e9), 3e-3], rtol=1e-14)
    np.testing.assert_allclose(problem.prior, [0.0, 5e3], rtol=1e-14)
    given = problem.given
    assert (given.count, given.reach, given.shapes, given.exact) == (7, 0.25, None, False)
    assert problem.structure(problem.start) is problem.shell
    other = problem.structure(problem.start + np.array([np.log10(2.0), 1e-3]))
    assert other.material.E == pytest.approx(2.0 * 206.85e9)
    assert other.thickness == pytest.approx(4e-3)
    assert other.mesh == problem.shell.mesh


@pytest.mark.slow
def test_a_problem_evaluates_a_point_once_and_tells_its_progress():
    told = []
    problem = Problem(blade(), table(rows=3), vary("material.E"), 5, 0.5, lambda *line: told.append(line))
    x = problem.start
    state = problem.state(x)
    assert problem.state(x.copy()) is state
    other = problem.state(1.01 * x)
    assert problem.history == [pytest.approx(np.sqrt(np.mean(s.values**2))) for s in (state, other)]
    assert told == [(1, problem.history[0]), (2, problem.history[1])]
    expected = (other.modes.freq[:3] - table(rows=3).freq_hz) / table(rows=3).sigma_hz
    np.testing.assert_allclose(other.values, expected, rtol=1e-12)
    f = other.modes.freq[:3]
    np.testing.assert_allclose(problem.jac(1.01 * x)[:, 0], f / (2.0 * 1.01 * x[0]) / table(rows=3).sigma_hz, rtol=1e-8)
    assert problem.anchor is problem.state(1.01 * x)
    assert set(problem.seconds) >= {"sensitivities", "pairing", "assemble", "solve"}
    assert all(0.0 <= spent < 100.0 for spent in problem.seconds.values())
    problem.solve_afresh()
    assert problem.exact
    assert problem.anchor is None
    assert problem.state(1.01 * x) is not other


def test_a_covariance_leaves_out_what_the_data_do_not_see():
    J = np.array([[3e6, 0.0, 1.0], [0.0, 0.0, 2.0], [4e6, 0.0, 0.0]])
    seen = np.linalg.inv(J[:, [0, 2]].T @ J[:, [0, 2]])
    found = covariance(J)
    np.testing.assert_allclose(found[np.ix_([0, 2], [0, 2])], seen, rtol=1e-9)
    np.testing.assert_array_equal(found[1], np.zeros(3))


def test_as_many_residuals_as_parameters_are_enough():
    require_enough(3, 3)
    with pytest.raises(cf.errors.InputError, match="so 2 residuals cannot determine 3 parameters: measure more modes"):
        require_enough(2, 3, "so ")


@pytest.mark.parametrize(("longest", "share"), [(1.5, 1.0), (0.9, 0.5), (0.3, 0.25), (0.125, 0.125), (0.12, 0.0)])
def test_a_step_is_halved_until_there_is_a_structure(longest, share):
    def state(x):
        if x[0] - 2.0 > longest:
            raise ValueError("no such structure")

    found = stepped(SimpleNamespace(state=state), np.array([2.0, 1.0]), np.array([1.0, -2.0]))
    np.testing.assert_allclose(found, [2.0 + share, 1.0 - 2.0 * share], rtol=1e-14)


def state_of(rows, rms):
    matches = tuple(SimpleNamespace(rows=row) for row in rows)
    return SimpleNamespace(pairing=SimpleNamespace(matches=matches, rms=rms))


@pytest.mark.parametrize(
    ("rows", "rms", "lower"),
    [
        ([(0,), (1, 2)], 0.9989, True), ([(0,), (1, 2)], 0.9991, False), ([(0,), (1,)], 0.1, False),
        ([(0,), (1, 2), (3,)], 5.0, True), ([(0, 1), (2,)], 0.5, True),
    ],
)  # fmt: skip
def test_rows_paired_anew_are_taken_where_they_are_more_or_nearer(rows, rms, lower):
    assert lower_misfit(state_of([(0,), (1, 2)], 1.0), state_of(rows, rms)) is lower


class Valleys(SimpleNamespace):
    """A problem whose descents end at given places, one for each damping."""

    def fun(self, x):
        return np.array([x[0], 0.0])

    def state(self, x):
        return f"state at {x[0]}"

    def adopt(self, x, state):
        self.adopted = float(x[0]), state


@pytest.mark.parametrize(
    ("ends", "tried", "best"),
    [
        ([(2.8, "converged")], 1, 2.8), ([(2.9, "converged"), (1.0, "converged")], 2, 1.0),
        ([(1.0, "stuck"), (2.0, "not converged"), (0.5, "stuck")], 3, 0.5),
        ([(3.0, "converged"), (4.0, "converged"), (5.0, "converged")], 3, 3.0),
    ],
)  # fmt: skip
def test_another_way_down_is_tried_where_the_first_ends_high_or_does_not_arrive(monkeypatch, ends, tried, best):
    """An rms of 2 sigma is high: of two residuals, one of them zero, 2 sqrt 2."""
    asked = []

    def descend(problem, lower, upper, most, damping, begin):
        asked.append(damping)
        x, message = ends[len(asked) - 1]
        return np.array([x]), message

    monkeypatch.setitem(solve.__globals__, "descend", descend)
    problem = Valleys()
    x, message = solve(problem, -np.ones(1), np.ones(1), 5)
    assert asked == [0.1, 1.0, 0.01][:tried]
    assert (x[0], message) == (best, dict(ends)[best])
    assert problem.adopted == (best, f"state at {best}")


def test_angles_are_left_out_of_a_table_for_an_imported_part():
    plain = cf.FrequencyTable.from_arrays(freq_hz=[1.0, 2.0], sigma_hz=0.1)
    assert fitted_to_mesh(plain, None) is plain
    turned = cf.FrequencyTable.from_arrays(
        freq_hz=[1.0, 2.0, 3.0], sigma_hz=0.1, n=[3, 3, 4], angle_deg=[5.0, np.nan, 7.0]
    )
    with pytest.warns(cf.errors.ModelWarning, match="table: 2 angles of pairs on an imported part"):
        found = fitted_to_mesh(turned, None)
    assert np.isnan(found.angle_deg).all()
    with pytest.raises(cf.errors.ModelError, match="found shapes to fit on an imported part"):
        fitted_to_mesh(plain, object())


def test_rows_set_aside_are_named_once_and_ascending():
    assert modes_of([SimpleNamespace(modes=(7, 3)), SimpleNamespace(modes=(3, 1))]) == (1, 3, 7)
    assert modes_of([]) == ()


def row(rows, modes):
    return Match(rows=rows, modes=modes, n=3, confidence=1.0, measured_hz=(), computed_hz=())


@pytest.mark.parametrize(
    ("modes", "unpaired", "plane"),
    [((1, 2), (), (1, 2)), ((1,), (2,), (1, 2)), ((2,), (1,), (1, 2)), ((1,), (), (1,)), ((0,), (1, 2), (0,))],
)
def test_half_a_doublet_has_the_plane_of_both_unless_the_other_has_a_row(modes, unpaired, plane):
    pairing = cf.correlation.Pairing(matches=(), unpaired_rows=(), unpaired_modes=unpaired)
    assert plane_of(row((0,) * len(modes), modes), SimpleNamespace(doublets=((1, 2),)), pairing) == plane


def test_rows_are_told_by_their_groups_ascending():
    pairing = cf.correlation.Pairing(
        matches=(row((4,), (0,)), row((0, 2), (1, 2))), unpaired_rows=(), unpaired_modes=()
    )
    assert paired_rows(pairing) == ((0, 2), (4,))


def test_overlaps_are_squares_of_cosines_by_mass(fit):
    """Of shapes of any scale and mixed ones: a third and two thirds."""
    modes = fit.after
    fields = modes.fields.copy()
    fields[:, :, 0] = -3.0 * (modes.fields[:, :, 0] + np.sqrt(2.0) * modes.fields[:, :, 1])
    share = overlaps(modes, replace(modes, fields=fields))
    np.testing.assert_allclose(share[:3, 0], [1.0 / 3.0, 2.0 / 3.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(share[1:, 1:], np.eye(len(modes) - 1), atol=1e-6)
