"""What is said about an update: identifiability, regularisation, left-out rows, posteriors, the model's own error."""

import json
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.extras import remedy
from casingfem.study import tasks
from casingfem.updating.identifiability import identifiability
from casingfem.updating.regularisation import WEIGHTS, chosen_weight, corner, trade_off
from casingfem.updating.result import weak_priors
from casingfem.updating.uncertainty.posterior import parabolas

BOUNDS = {"material.E": (150e9, 250e9), "shell.thickness": (2e-3, 4e-3), "material.nu": (0.2, 0.4)}


def blade(E=206.85e9, t=3e-3, nu=0.3):
    return cf.Shell(
        chart=cf.Panel(radius=0.6, length=0.3, angle=0.5), thickness=t, material=cf.Material(E=E, nu=nu, rho=7857.0),
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=1, around=1),
    )  # fmt: skip


def table(noise=0.0, sigma=1e-3, rows=8, seed=11):
    f = cf.modes(blade(200e9, 3.03e-3, 0.31), rows).freq
    f = np.sort(f * (1.0 + noise * np.random.default_rng(seed).standard_normal(rows)))
    return cf.FrequencyTable.from_arrays(freq_hz=f, sigma_hz=sigma * f)


def vary(*names, **more):
    return [cf.Parameter(name=name, lower=BOUNDS[name][0], upper=BOUNDS[name][1], **more) for name in names]


@pytest.fixture(scope="module")
def fit():
    return cf.update(blade(), table(1e-3), vary(*BOUNDS))


def test_singular_values_tell_what_is_known():
    """Two residuals of one sum: one direction known to 1/sqrt(1 + s^2), the other not at all."""
    two = [cf.Parameter(name=f"material.{n}", lower=0.0, upper=1.0, sigma=1.0) for n in ("E", "rho")]
    found = identifiability(two, np.array([[3.0, 3.0], [4.0, 4.0]]))
    np.testing.assert_allclose(found.singular, [5 * np.sqrt(2), 0.0], atol=1e-12)
    assert found.rank == 1
    np.testing.assert_allclose(found.left**2, 0.5 / 51 + 0.5)  # half of each width lies in either direction
    assert found.words(0) == "+0.71 material.E +0.71 material.rho"
    assert found.unseen == ()


def test_a_parameter_that_the_table_cannot_see_is_named(fit):
    """A shell so thin does not feel its shear correction; its fibres at the wrong place do."""
    seen = identifiability(fit.parameters, fit.jacobian)
    assert seen.unseen == ()
    assert "the data determine 3 of 3" in repr(seen)
    blind = identifiability(fit.parameters, fit.jacobian * [1.0, 1.0, 1e-6])
    assert blind.unseen == ("material.nu",)
    assert "does not see material.nu" in repr(blind)


def test_discrepancy_takes_the_weight_at_which_residuals_are_noise():
    J, r = np.eye(4)[:, :2] * 10.0, np.array([10.0, 0.0, 1.0, 1.0])
    curve = trade_off(J, r, np.zeros(2), np.zeros(2), np.ones(2))
    weight, rule, _ = chosen_weight("discrepancy", curve, 4)
    # |r|^2 = 2 + (10 w^2/(100 + w^2))^2 = 4
    assert rule == "discrepancy"
    assert weight == pytest.approx(np.sqrt(100 * np.sqrt(2) / (10 - np.sqrt(2))), rel=0.06)


def test_discrepancy_that_cannot_be_met_says_so():
    J, r = np.eye(4)[:, :2], np.array([1.0, 0.0, 9.0, 9.0])
    _, rule, note = chosen_weight("discrepancy", trade_off(J, r, np.zeros(2), np.zeros(2), np.ones(2)), 4)
    assert rule == "l-curve"
    assert "6.36 times their noise" in note


def test_the_corner_of_an_ill_posed_problem_lies_between_noise_and_signal():
    """Singular values 10^-k, a smooth solution, noise 1e-3: the best weight is near the noise, and the corner too."""
    random = np.random.default_rng(17)
    U, V = (np.linalg.qr(random.standard_normal((12, 12)))[0] for _ in range(2))
    A = U @ np.diag(10.0 ** (3.0 - 0.75 * np.arange(12))) @ V.T  # in units of the noise
    true = V @ (10.0 ** (-0.1 * np.arange(12)))
    r = -A @ true + random.standard_normal(12)
    curve = trade_off(A, r, np.zeros(12), np.zeros(12), np.ones(12))

    def error(w):
        d = np.linalg.solve(A.T @ A + w**2 * np.eye(12), -A.T @ r)
        return np.linalg.norm(d - true)

    best = min(error(w) for w in WEIGHTS)
    assert error(corner(curve)) < 2.0 * best
    assert error(WEIGHTS[0]) > 100.0 * best


def many_harmonics(values):
    """A small cylinder with a field of eight coefficients."""
    waves = {2 * k + 2: (float(c), float(s)) for k, (c, s) in enumerate(np.reshape(values, (-1, 2)))}
    return cf.Shell(
        chart=cf.Cylinder(radius=0.3, height=0.3), thickness=3e-3, supports={"base": cf.Clamped()},
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0), thickness_defect=cf.FourierField.of(waves),
        mesh=cf.ShellMesh(order=5, rows=1, around=7),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("rule", ["discrepancy", pytest.param("l-curve", marks=pytest.mark.campaign)])
def test_many_harmonics_are_held_as_strongly_as_the_data_ask(rule):
    random = np.random.default_rng(23)
    true = 0.01 * random.standard_normal(8)
    found = cf.modes(many_harmonics(true), 16)
    rows = 12
    measured = cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[:rows] * (1 + 1e-3 * random.standard_normal(rows)), sigma_hz=1e-3 * found.freq[:rows],
        n=found.nodal_diameters[:rows], angle_deg=found.angle_deg[:rows],
    )  # fmt: skip
    names = [f"thickness.p{2 * k + 2}.{part}" for k in range(4) for part in ("cos", "sin")]
    free = [cf.Parameter(name=name, lower=-0.3, upper=0.3) for name in names]
    fit = cf.update(many_harmonics(np.zeros(8)), measured, free, regularise=cf.updating.Regularisation(rule=rule))
    assert fit.regularised is not None
    assert fit.regularised.names == tuple(names)
    if fit.regularised.rule == "discrepancy":
        assert fit.chi2 == pytest.approx(fit.residuals, rel=0.15)
    assert np.linalg.norm(np.subtract(fit.value, true)) < np.linalg.norm(true)
    assert json.loads(json.dumps(fit.to_json()))["regularised"]["rule"] in ("discrepancy", "l-curve")
    assert "regularised with weight" in repr(fit)


def test_regularising_nothing_is_refused():
    with pytest.raises(cf.errors.InputError, match="no harmonic is varied"):
        cf.update(blade(), table(), vary("material.E"), regularise=cf.updating.Regularisation())
    with pytest.raises(cf.errors.InputError, match=r"'material.rho' is not varied"):
        cf.update(blade(), table(), vary("material.E"), regularise=cf.updating.Regularisation(names=("material.rho",)))
    with pytest.raises(cf.errors.InputError, match="expected discrepancy or l-curve"):
        cf.updating.Regularisation(rule="guess")


@pytest.mark.slow
def test_left_out_rows_are_predicted_as_well_as_their_sigma_says(fit):
    left = cf.updating.leave_one_out(fit)
    assert [row.mode for row in left.rows] == list(range(1, 9))
    assert 0.3 < left.rms_sigma < 2.0
    assert left.rms > fit.rms_after
    assert "predicted without themselves" in repr(left)


@pytest.mark.slow
def test_a_left_out_row_is_not_used():
    """One frequency wrong by 3 %: the others, and the fit without it, know where it belongs."""
    clean = table(rows=5)
    f = clean.freq_hz.copy()
    f[3] *= 1.03
    wrong = cf.FrequencyTable.from_arrays(freq_hz=f, sigma_hz=clean.sigma_hz)
    fit = cf.update(blade(), wrong, vary("material.E", "shell.thickness"), outliers="keep")
    row = cf.updating.leave_one_out(fit).rows[3]
    assert row.predicted_hz == pytest.approx(clean.freq_hz[3], rel=2e-3)
    assert row.deviation < -10.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "names", "words"),
    [
        (2, ("material.E", "shell.thickness"), "table: without mode 1, 1 residuals cannot determine 2 parameters"),
        (1, ("material.E",), "table: without mode 1, no row is left to predict it from"),
    ],
)
def test_rows_that_the_parameters_cannot_do_without_are_not_left_out(rows, names, words):
    fit = cf.update(blade(), table(rows=rows), vary(*names), outliers="keep")
    assert fit.to_json()["worst"]["sigma"] == pytest.approx(0.0, abs=1e-6)  # of a fit that leaves nothing: an error
    with pytest.raises(cf.errors.InputError, match=words):
        cf.updating.leave_one_out(fit)


@pytest.mark.slow
def test_a_prior_stands_in_for_a_row_left_out():
    free = [vary("material.E")[0], *vary("shell.thickness", sigma=1e-4)]
    left = cf.updating.leave_one_out(cf.update(blade(), table(rows=2), free, outliers="keep"))
    assert [row.mode for row in left.rows] == [1, 2]
    assert left.rms > 1e-4


@pytest.mark.slow
def test_parabolas_are_right_to_second_order(fit):
    near = parabolas(fit)
    step = 2.0 * fit.sigma * [1.0, -1.0, 1.0]
    problem = fit.problem
    problem.anchor = None
    exact = problem.state(fit.x + step).values
    tangent = near.r + near.J @ step
    assert np.abs(near(fit.x + step)[0] - exact).max() < 0.05 * np.abs(tangent - exact).max()


@pytest.mark.slow
def test_laplace_equals_gauss_newton_where_residuals_are_straight():
    """f^2 ~ E: in log E nearly straight; without noise the Hessian is J^T J."""
    fit = cf.update(blade(), table(), [cf.Parameter(name="material.E", lower=150e9, upper=250e9, log=True)])
    sure = cf.updating.laplace(fit)
    assert sure.sigma[0] == pytest.approx(fit.stated_sigma[0], rel=0.02)
    assert np.array_equal(sure.gauss_newton, fit.stated_sigma)
    assert abs(sure.bend[0]) < 1e-2
    assert "\nmaterial.E  decades " in repr(sure)
    assert sure.to_json()["parameters"][0]["log"] is True


@pytest.mark.slow
def test_laplace_sees_what_gauss_and_newton_leave_out(fit):
    """sum r H: against the derivative of the exact gradient."""
    sure = cf.updating.laplace(fit)
    problem, h = fit.problem, 0.2 * fit.sigma
    gradient = []
    for k in range(3):
        ends = [fit.x + s * h * (np.arange(3) == k) for s in (1.0, -1.0)]
        states = [(problem.data_jacobian(x), problem.state(x).values) for x in ends]
        gradient.append((states[0][0].T @ states[0][1] - states[1][0].T @ states[1][1]) / (2.0 * h[k]))
    np.testing.assert_allclose(np.linalg.inv(sure.covariance) * np.outer(h, h), np.array(gradient) * np.outer(h, h),
                               atol=2e-3)  # fmt: skip


def bent(fit, part):
    """Parabolas whose curvatures take so much from J^T J: sum r H = -part J^T J."""
    near = parabolas(fit)
    return replace(near, H=-part * near.r[:, None, None] / (near.r @ near.r) * (near.J.T @ near.J))


@pytest.mark.slow
def test_a_fit_is_a_minimum_while_its_curvatures_leave_something(fit):
    left = 1e-6
    sure = cf.updating.laplace(fit, bent(fit, 1.0 - left))
    np.testing.assert_allclose(sure.sigma, fit.stated_sigma / np.sqrt(left), rtol=1e-6)
    J = parabolas(fit).J
    steepest = np.linalg.norm(J / np.linalg.norm(J, axis=0), 2) ** 2
    words = rf"posterior: the fit is no minimum \(lowest curvature {-left * steepest:.2g}\): "
    with pytest.raises(cf.errors.InputError, match=words):
        cf.updating.laplace(fit, bent(fit, 1.0 + left))


def test_without_emcee_it_is_named(fit, monkeypatch):
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(cf.errors.MissingExtraError) as caught:
        cf.updating.sample_posterior(fit)
    assert str(caught.value) == f'posterior = "emcee" needs the package emcee: {remedy("sampling")}'


@pytest.mark.slow
def test_chains_of_20_times_their_memory_are_taken_and_no_shorter_ones(fit, monkeypatch):
    emcee = pytest.importorskip("emcee")
    monkeypatch.setattr(emcee.EnsembleSampler, "get_autocorr_time", lambda *_, **__: np.array([1.0, 2.5, 2.0]))
    assert cf.updating.sample_posterior(fit, steps=51, checks=1).autocorrelation == 2.5
    with pytest.raises(cf.errors.InputError, match="chains of 50 steps are correlated over 2; take more"):
        cf.updating.sample_posterior(fit, steps=50, checks=1)


@pytest.mark.slow
def test_what_a_study_asks_beyond_its_fit_is_refused_with_its_file(fit, monkeypatch):
    study = SimpleNamespace(path="blade.toml")
    monkeypatch.setattr(tasks, "laplace", lambda fit: cf.updating.laplace(fit, bent(fit, 2.0)))
    with pytest.raises(cf.errors.InputError, match=r"^blade\.toml: update: posterior: the fit is no minimum"):
        tasks.judge_update(study, fit, left_out=False, posterior="laplace", say=lambda _: None)
    assert tasks.judge_update(study, fit, left_out=False, posterior=None, say=lambda _: None) == {}


@pytest.mark.slow
def test_samples_agree_with_the_gaussian_where_there_is_one(fit):
    pytest.importorskip("emcee")
    drawn = cf.updating.sample_posterior(fit, steps=2000, checks=2)
    np.testing.assert_allclose(drawn.sigma, cf.updating.laplace(fit).sigma, rtol=0.15)
    np.testing.assert_allclose(drawn.samples.mean(axis=0), fit.x, atol=0.3 * fit.sigma.max())
    assert drawn.gap < 0.05
    assert json.loads(json.dumps(drawn.to_json()))["kind"] == "emcee"
    assert (drawn.samples >= fit.lower).all()


@pytest.mark.slow
def test_the_models_own_error_is_what_scatter_noise_does_not_explain():
    """Noise of 1 % called 0.1 %: the floor is 1 %."""
    fit = cf.update(blade(), table(0.01), vary("material.E"))
    assert fit.misfit > 5.0
    assert 0.006 < fit.model_floor < 0.014
    assert "beyond the stated sigma" in repr(fit)
    again = cf.update(blade(), table(0.01), vary("material.E"), model_error=fit.model_floor)
    assert again.misfit == pytest.approx(1.0, abs=0.02)
    assert cf.update(blade(), table(1e-4), vary(*BOUNDS)).model_floor == 0.0


@pytest.mark.slow
def test_a_saturated_fit_names_its_bound():
    stuck = [cf.Parameter(name="material.E", lower=204e9, upper=250e9)]
    fit = cf.update(blade(), table(), stuck)
    assert fit.saturated == ("material.E at its lower bound 2.04e+11",)
    assert "saturated: material.E at its lower bound" in repr(fit)
    mode, sigma = fit.worst()
    assert sigma == pytest.approx(fit.values.max())  # too high
    assert fit.values[mode - 1] == fit.values.max()


@pytest.mark.slow
def test_a_fit_at_its_upper_bound_says_so_and_that_its_worst_row_is_too_low():
    """E of 196 instead of 200 GPa leaves every frequency below what was measured."""
    stuck = [cf.Parameter(name="material.E", lower=150e9, upper=196e9)]
    fit = cf.update(blade(195e9), table(rows=4), stuck, outliers="keep")
    assert fit.saturated == ("material.E at its upper bound 1.96e+11",)
    mode, sigma = fit.worst()
    assert sigma == pytest.approx(fit.values[mode - 1]) == pytest.approx(fit.values.min())
    assert fit.values.max() < 0.0


def test_chi_square_decides_whether_sigma_are_called_too_small_or_too_large(fit):
    """Five degrees of freedom: 1 of 20 above 11.0705, 1 of 100 below 0.5543."""

    def scaled(squares):
        return replace(fit, values=fit.values * np.sqrt(squares / fit.chi2))

    assert scaled(11.06).inflation == 1.0
    assert scaled(11.08).inflation == pytest.approx(np.sqrt(11.08 / 5.0))
    assert [scaled(squares).overstated for squares in (0.553, 0.556)] == [True, False]


def test_a_prior_is_called_all_that_is_known_where_the_data_narrow_it_by_less_than_a_tenth():
    """A posterior sigma of 0.9 of the prior's: J^T J = (1/0.81 - 1)/sigma^2."""
    edge = np.sqrt(1.0 / 0.81 - 1.0) / 1e9
    vary = [cf.Parameter(name=f"material.{name}", lower=1e9, upper=1e12, sigma=1e9) for name in ("E", "nu")]
    free = cf.Parameter(name="material.rho", lower=1.0, upper=1e5)
    jacobian = np.array([[0.6, 0.6, 0.0], [0.8, 0.8, 0.0]]) * [edge * 0.99, edge * 1.01, 1.0]
    assert weak_priors([*vary, free], jacobian) == (True, False, False)


@pytest.mark.slow
def test_rows_that_pair_only_after_the_fit_do_not_count_in_the_rms():
    """Row 5, 3 % low, lies 4.9 % off at the start and 3.1 % at the end, of a reach of 4 %; f^2 is as E."""
    freq = cf.modes(blade(200e9), 5).freq * [1.0, 1.0, 1.0, 1.0, 0.97]
    rows = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=[1e-3, 1e-3, 1e-3, 1e-3, 5e-3] * freq)
    fit = cf.update(blade(206.85e9), rows, vary("material.E"), reach=0.04, outliers="keep")
    before, after = (np.sqrt(E / 200e9) for E in (206.85e9, fit.value[0]))
    assert fit.rms_before == pytest.approx(before - 1.0, rel=1e-6)
    assert fit.rms_after == pytest.approx(1.0 - after, rel=1e-6)
    assert [row["before_hz"] for row in fit.pairs()] == [pytest.approx(before * f, rel=1e-9) for f in freq[:4]] + [None]
    told = {line.split()[0]: line.split() for line in repr(fit).partition("confidence\n")[2].splitlines()[:5]}
    assert told["1"][:4] == ["1", "-", f"{freq[0]:.3f}", f"{before * freq[0]:.3f}"]
    assert told["5"][:4] == ["5", "-", f"{freq[4]:.3f}", "-"]
    errors = [100.0 * (after - 1.0)] * 4 + [100.0 * (after / 0.97 - 1.0)]
    assert [float(told[f"{k}"][5]) for k in range(1, 6)] == pytest.approx(errors, abs=6e-4)
    said = f"RMS {100.0 * (before - 1.0):.3f} % -> {100.0 * (1.0 - after):.3f} %, misfit {fit.misfit:.2f} sigma"
    assert said in repr(fit)


def test_what_is_left_of_each_parameter_is_its_sigma_by_data_and_width_over_the_width():
    J = np.random.default_rng(8).standard_normal((5, 3)) * [1.0, 0.2, 3.0]
    sigma = np.array([0.5, 2.0, 1.0])
    three = [cf.Parameter(name=f"p{k}", lower=-9.0, upper=9.0, sigma=s) for k, s in enumerate(sigma)]
    C = np.linalg.inv(J.T @ J + np.diag(sigma**-2.0))
    np.testing.assert_allclose(identifiability(three, J).left, np.sqrt(np.diag(C)) / sigma, rtol=1e-12)


def test_a_trade_off_is_the_regularised_least_squares_of_its_linear_problem():
    """One parameter regularised, one held by a prior about its start, one free; from a point away from the start."""
    rng, k = np.random.default_rng(5), 140
    J, r, away = rng.standard_normal((6, 3)), rng.standard_normal(6), np.array([0.3, -0.4, 0.2])
    prior, inverse = np.array([0.0, 2.0, 0.0]), np.array([0.7, 0.0, 0.0])
    w, left, size = trade_off(J, r, away, prior, inverse)[k]
    weights = np.diag(prior**2 + (w * inverse) ** 2)
    d = np.linalg.solve(J.T @ J + weights, J.T @ (J @ away - r))
    assert w == WEIGHTS[k]
    assert left == pytest.approx(np.linalg.norm(r + J @ (d - away)), rel=1e-10)
    assert size == pytest.approx(abs(0.7 * d[0]), rel=1e-10)


@pytest.mark.slow
def test_bend_is_how_far_a_residual_leaves_its_tangent_at_one_sigma(fit):
    near = parabolas(fit)
    bend = cf.updating.laplace(fit, near).bend
    for k, sigma in enumerate(fit.stated_sigma):
        step = sigma * (np.arange(3) == k)
        gap = near(near.x0 + step)[0] - near.r - near.J @ step
        assert bend[k] == pytest.approx(np.abs(gap).max(), rel=1e-9)


@pytest.mark.slow
def test_the_sigma_of_a_prediction_holds_the_row_and_what_the_others_leave_of_the_parameter():
    """f^2 is as E: with E alone each other row knows ln E to twice its relative sigma."""
    rows, sigma = 4, np.array([1e-3, 2e-3, 3e-3, 4e-3])
    f = cf.modes(blade(200e9), rows).freq
    seen = cf.FrequencyTable.from_arrays(freq_hz=f, sigma_hz=sigma * f)
    fit = cf.update(blade(), seen, vary("material.E"), outliers="keep")
    for k, row in enumerate(cf.updating.leave_one_out(fit).rows):
        others = np.sum(np.delete(sigma, k) ** -2.0) ** -0.5
        assert row.sigma_hz == pytest.approx(f[k] * np.hypot(sigma[k], others), rel=1e-4)
