"""How strongly parameters are regularised: which ones, where an L-curve turns, which weight noise allows."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.updating.test_update_judged import blade, table, vary


def test_what_an_update_is_not_asked_for_rightly_is_refused_first():
    for more, words in (
        ({"outliers": "drop"}, 'outliers: found \'drop\', expected "set-aside" or "keep"'),
        ({"model_error": 1.0}, r"model_error must lie in \[0, 1\), found 1.0"),
        ({"model_error": -0.1}, r"model_error must lie in \[0, 1\), found -0.1"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.update(blade(), table(rows=3), vary("material.E"), count=7, **more)
    with pytest.raises(cf.errors.InputError, match="vary: found no parameters, expected at least one"):
        cf.update(blade(), table(rows=3), [])


def trade_off(J, r, away, held, weights):
    """|r + J d| and |held (away + d)| where r^2 + w^2 |held (away + d)|^2 of the linear problem is least, each w."""
    found = []
    for w in weights:
        A, b = np.vstack([J, w * np.diag(held)]), np.concatenate([-r, -w * held * away])
        size = np.linalg.norm(A, axis=0)
        d = np.linalg.lstsq(A / size, b, rcond=None)[0] / size
        found.append((w, np.linalg.norm(r + J @ d), np.linalg.norm(held * (away + d))))
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize("rule", ["discrepancy", "l-curve"])
def test_a_regularised_update_is_stationary_at_the_weight_that_its_rule_chooses(rule):
    """J^T r + w^2 D^-2 (x - x0) = 0 for the one held; discrepancy: the largest weight that noise allows; else the bend.

    The bend is where the curve of the logarithms of both norms turns most, by its curvature.
    """
    width = 0.5e-3
    free = [
        cf.Parameter(name="material.E", lower=100e9, upper=300e9),
        cf.Parameter(name="shell.thickness", lower=2e-3, upper=4e-3, sigma=width),
    ]
    held = cf.updating.Regularisation(rule=rule, names=("shell.thickness",))
    fit = cf.update(blade(), table(1e-3), free, regularise=held, outliers="keep")
    w, away = fit.regularised.weight, fit.x - [206.85e9, 3e-3]
    assert fit.regularised.names == ("shell.thickness",)
    pull = np.array([0.0, w**2 / width**2 * away[1]])
    scale = np.linalg.norm(fit.jacobian, axis=0) * np.linalg.norm(fit.values)
    np.testing.assert_allclose((fit.jacobian.T @ fit.values + pull) / scale, 0.0, atol=3e-3)
    curve = fit.regularised.curve
    assert np.ptp(np.diff(np.log(curve[:, 0]))) < 1e-9
    expected = trade_off(fit.jacobian, fit.values, away, np.array([0.0, 1.0 / width]), curve[:, 0])
    np.testing.assert_allclose(curve, expected, rtol=1e-5)
    if fit.regularised.rule == "discrepancy":
        chosen = curve[curve[:, 1] <= np.sqrt(len(fit.values)), 0].max()
    else:
        t, x, y = np.log(curve.T)
        dx, dy = np.gradient(x, t), np.gradient(y, t)
        still = np.maximum((dx**2 + dy**2) ** 1.5, 1e-12)  # where the curve does not change it does not turn
        bend = (dx * np.gradient(dy, t) - dy * np.gradient(dx, t)) / still
        chosen = curve[2 + bend[2:-2].argmax(), 0]
    assert abs(np.log(chosen / w)) < 0.2
