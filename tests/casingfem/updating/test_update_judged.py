"""What is stated about an update: identifiability, regularisation, left-out rows, posteriors, the model's own error."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from tests.probed import numbers_of_result

DATA = Path(__file__).resolve().parents[3] / "data"
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
def test_many_harmonics_are_fixed_as_strongly_as_the_data_ask(rule, held):
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
    assert "regularised with a weight" in repr(fit)
    held(1e-4, **numbers_of_result(fit))


def test_regularising_nothing_is_refused():
    with pytest.raises(cf.errors.InputError, match="no harmonic among"):
        cf.update(blade(), table(), vary("material.E"), regularise=cf.updating.Regularisation())
    with pytest.raises(cf.errors.InputError, match=r"'material\.rho', expected varied"):
        cf.update(blade(), table(), vary("material.E"), regularise=cf.updating.Regularisation(names=("material.rho",)))
    with pytest.raises(cf.errors.InputError, match="expected discrepancy or l-curve"):
        cf.updating.Regularisation(rule="guess")


@pytest.mark.slow
def test_residuals_that_stay_large_do_not_slow_the_update(held):
    """Those of the measured blade stay at 1.7 sigma. Gauss-Newton's steps overshoot there and need 16 solutions."""
    study = cf.load_study(DATA / "studies" / "olson_lindberg.toml")
    fit = cf.update(study.start, study.table, list(study.parameters), model_error=0.01)
    values, jacobian = fit.given.with_priors(fit.x, fit.values, fit.jacobian)
    left = np.linalg.lstsq(jacobian, -values, rcond=None)[0] / fit.stated_sigma
    assert fit.misfit > 1.5
    assert np.abs(left).max() < 2e-3
    assert len(fit.history) <= 8
    held(1e-4, **numbers_of_result(fit))


@pytest.mark.slow
def test_left_out_rows_are_predicted_as_well_as_their_sigma_states(held):
    fit = cf.update(blade(), table(1e-3, rows=6), vary("material.E", "material.nu"))
    left = cf.updating.leave_one_out(fit)
    assert [row.mode for row in left.rows] == list(range(1, 7))
    assert 0.3 < left.rms_sigma < 2.0
    assert left.rms > fit.rms_after
    assert "each row predicted from the others" in repr(left)
    held(1e-4, **numbers_of_result(left))


@pytest.mark.slow
def test_a_left_out_row_is_not_used(held):
    """One frequency wrong by 3 %: the others, and the fit without it, know where it belongs."""
    clean = cf.modes(blade(200e9), 4).freq
    wrong = cf.FrequencyTable.from_arrays(freq_hz=clean * [1.0, 1.0, 1.03, 1.0], sigma_hz=1e-3 * clean)
    fit = cf.update(blade(), wrong, vary("material.E"), outliers="keep")
    row = cf.updating.leave_one_out(fit).rows[2]
    assert row.predicted_hz == pytest.approx(clean[2], rel=1e-6)
    assert row.deviation < -10.0
    held(1e-4, **numbers_of_result(fit))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "names", "words"),
    [
        (2, ("material.E", "shell.thickness"), "table: without mode 1: found 1 residuals for 2 parameters"),
        (1, ("material.E",), "table: without mode 1: found no other row, expected rows from which to predict it"),
    ],
)
def test_rows_that_the_parameters_cannot_do_without_are_not_left_out(rows, names, words):
    fit = cf.update(blade(), table(rows=rows), vary(*names), outliers="keep")
    assert fit.to_json()["worst"]["sigma"] == pytest.approx(0.0, abs=1e-6)  # of a fit that leaves nothing: an error
    with pytest.raises(cf.errors.InputError, match=words):
        cf.updating.leave_one_out(fit)


@pytest.mark.slow
def test_a_prior_replaces_a_row_left_out():
    free = [vary("material.E")[0], *vary("shell.thickness", sigma=1e-4)]
    left = cf.updating.leave_one_out(cf.update(blade(), table(rows=2), free, outliers="keep"))
    assert [row.mode for row in left.rows] == [1, 2]
    assert left.rms > 1e-4


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
def test_laplace_sees_what_gauss_and_newton_leave_out(fit, held):
    """sum r H: against the derivative of the exact gradient."""
    sure = cf.updating.laplace(fit)
    held(1e-3, **numbers_of_result(sure), **numbers_of_result(fit, "fit "))
    problem, h = fit.problem, 0.2 * fit.sigma
    gradient = []
    for k in range(3):
        ends = [fit.x + s * h * (np.arange(3) == k) for s in (1.0, -1.0)]
        states = [(problem.data_jacobian(x), problem.state(x).values) for x in ends]
        gradient.append((states[0][0].T @ states[0][1] - states[1][0].T @ states[1][1]) / (2.0 * h[k]))
    np.testing.assert_allclose(np.linalg.inv(sure.covariance) * np.outer(h, h), np.array(gradient) * np.outer(h, h),
                               atol=2e-3)  # fmt: skip


@pytest.mark.slow
def test_chains_of_20_times_their_memory_are_taken_and_no_shorter_ones(fit, monkeypatch):
    emcee = pytest.importorskip("emcee")
    monkeypatch.setattr(emcee.EnsembleSampler, "get_autocorr_time", lambda *_, **__: np.array([1.0, 2.5, 2.0]))
    assert cf.updating.sample_posterior(fit, steps=51, checks=1).autocorrelation == 2.5
    with pytest.raises(cf.errors.InputError, match="chains of 50 steps, expected at least 5"):
        cf.updating.sample_posterior(fit, steps=50, checks=1)


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
def test_the_models_own_error_is_what_scatter_noise_does_not_explain(held):
    """Noise of 1 % called 0.1 %: the floor is 1 %."""
    fit = cf.update(blade(), table(0.01), vary("material.E"))
    assert fit.misfit > 5.0
    assert 0.006 < fit.model_floor < 0.014
    assert "that the stated sigma do not explain" in repr(fit)
    again = cf.update(blade(), table(0.01), vary("material.E"), model_error=fit.model_floor)
    assert again.misfit == pytest.approx(1.0, abs=0.02)
    held(1e-4, **numbers_of_result(fit))
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
def test_a_fit_at_its_upper_bound_states_so_and_that_its_worst_row_is_too_low(held):
    """E of 196 instead of 200 GPa leaves every frequency below what was measured."""
    stuck = [cf.Parameter(name="material.E", lower=150e9, upper=196e9)]
    fit = cf.update(blade(195e9), table(rows=4), stuck, outliers="keep")
    assert fit.saturated == ("material.E at its upper bound 1.96e+11",)
    mode, sigma = fit.worst()
    assert sigma == pytest.approx(fit.values[mode - 1]) == pytest.approx(fit.values.min())
    assert fit.values.max() < 0.0
    held(1e-4, **numbers_of_result(fit))


def test_chi_square_decides_whether_sigma_are_called_too_small_or_too_large(fit):
    """Five degrees of freedom: 1 of 20 above 11.0705, 1 of 100 below 0.5543."""

    def scaled(squares):
        return replace(fit, values=fit.values * np.sqrt(squares / fit.chi2))

    assert scaled(11.06).inflation == 1.0
    assert scaled(11.08).inflation == pytest.approx(np.sqrt(11.08 / 5.0))
    assert [scaled(squares).overstated for squares in (0.553, 0.556)] == [True, False]


@pytest.mark.slow
def test_rows_that_pair_only_after_the_fit_do_not_count_in_the_rms(held):
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
    held(1e-4, **numbers_of_result(fit))


@pytest.mark.slow
def test_the_sigma_of_a_prediction_keeps_the_row_and_what_the_others_leave_of_the_parameter():
    """f^2 is as E: with E alone each other row knows ln E to twice its relative sigma."""
    rows, sigma = 4, np.array([1e-3, 2e-3, 3e-3, 4e-3])
    f = cf.modes(blade(200e9), rows).freq
    seen = cf.FrequencyTable.from_arrays(freq_hz=f, sigma_hz=sigma * f)
    fit = cf.update(blade(), seen, vary("material.E"), outliers="keep")
    for k, row in enumerate(cf.updating.leave_one_out(fit).rows):
        others = np.sum(np.delete(sigma, k) ** -2.0) ** -0.5
        assert row.sigma_hz == pytest.approx(f[k] * np.hypot(sigma[k], others), rel=1e-4)
