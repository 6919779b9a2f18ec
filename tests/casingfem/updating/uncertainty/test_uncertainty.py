"""What is made of a fit and its parabolas: predictions, densities, weak directions, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.updating.uncertainty.posterior import Parabolas, weakest
from casingfem.updating.uncertainty.prediction import Prediction
from casingfem.updating.uncertainty.sampling import log_density

RNG = np.random.default_rng(6)
NEAR = Parabolas(
    x0=np.array([1.0, -2.0]),
    r=np.array([0.5, -1.0, 2.0]),
    J=RNG.standard_normal((3, 2)),
    H=RNG.standard_normal((3, 2, 2)),
)
PRIOR = np.array([0.0, 0.5])


def fit(lower=(0.0, -3.0), upper=(2.0, 0.0)):
    names = [SimpleNamespace(name=name, log=log) for name, log in (("material.E", False), ("support.base.k_r", True))]
    return SimpleNamespace(
        lower=np.array(lower), upper=np.array(upper), parameters=names, x=NEAR.x0, stated_sigma=np.array([0.3, 0.7]),
        given=SimpleNamespace(prior=PRIOR, start=np.array([0.8, -1.0])),
    )  # fmt: skip


def test_residuals_of_parabolas_are_those_of_second_order():
    d = np.array([0.3, -0.2])
    expected = [NEAR.r[k] + NEAR.J[k] @ d + 0.5 * d @ NEAR.H[k] @ d for k in range(3)]
    np.testing.assert_allclose(NEAR(NEAR.x0 + d)[0], expected, rtol=1e-12)


def test_the_density_is_that_of_residuals_and_priors_within_the_bounds():
    points = np.array([[1.2, -1.5], [0.0, -3.0], [2.0, 0.0], [-1e-9, -1.0], [1.0, 1e-9], [1.0, -3.1], [2.1, -1.0]])
    found = log_density(points, fit(), NEAR)
    for point, value in zip(points[:3], found[:3], strict=True):
        prior = (point[1] + 1.0) * 0.5
        assert value == pytest.approx(-0.5 * np.sum(NEAR(point) ** 2) - 0.5 * prior**2, rel=1e-12)
    assert found[3:].tolist() == [-np.inf] * 4


def test_the_laplace_covariance_is_the_inverse_of_the_whole_hessian():
    J = np.array([[4.0, 1.0], [1.0, 0.3], [0.0, 2.0]])
    H = np.zeros((3, 2, 2))
    H[1] = [[0.2, 0.1], [0.1, -0.6]]
    near = Parabolas(x0=NEAR.x0, r=NEAR.r, J=J, H=H)
    found = cf.updating.laplace(fit(), near)
    hessian = J.T @ J + np.diag(PRIOR**2) - H[1]
    np.testing.assert_allclose(found.covariance, np.linalg.inv(hessian), rtol=1e-12)
    np.testing.assert_allclose(found.bend, [0.5 * 0.2 * 0.3**2, 0.5 * 0.6 * 0.7**2], rtol=1e-12)
    assert found.names == ("material.E", "support.base.k_r")
    assert found.log == (False, True)
    records = found.records()
    assert [row["gauss_newton"] for row in records] == [0.3, 0.7]
    assert [row["sigma"] for row in records] == pytest.approx(np.sqrt(np.diag(np.linalg.inv(hessian))))
    assert f"{found.sigma[0]:.3g}" in repr(found)


def test_the_weakest_direction_is_told_by_its_two_main_parameters():
    names = SimpleNamespace(parameters=[SimpleNamespace(name=name) for name in "abc"])
    turn, _ = np.linalg.qr(np.array([[0.3, 1.0, 0.0], [0.1, 0.0, 1.0], [-0.9, 0.2, 0.3]]))
    assert weakest(names, turn @ np.diag([-1.0, 2.0, 3.0]) @ turn.T) == "c, a"


def test_errors_of_predictions_are_relative_or_in_sigma():
    rows = (
        Prediction(mode=1, n=4, measured_hz=100.0, predicted_hz=101.0, sigma_hz=0.5),
        Prediction(mode=3, n=-1, measured_hz=200.0, predicted_hz=194.0, sigma_hz=1.5),
    )
    assert [row.error for row in rows] == pytest.approx([0.01, -0.03])
    assert [row.deviation for row in rows] == pytest.approx([2.0, -4.0])
    left = cf.updating.LeftOut(rows=rows)
    assert left.rms == pytest.approx(np.sqrt((0.01**2 + 0.03**2) / 2.0))
    assert left.rms_sigma == pytest.approx(np.sqrt(10.0))
    told = left.to_json()
    assert told["rms"] == left.rms
    assert told["rms_sigma"] == left.rms_sigma
    assert told["rows"][1] == {
        "mode": 3, "n": None, "measured_hz": 200.0, "predicted_hz": 194.0, "sigma_hz": 1.5,
        "error": pytest.approx(-0.03), "deviation": pytest.approx(-4.0),
    }  # fmt: skip


def test_samples_tell_their_spread_and_quantiles():
    samples = np.column_stack([np.arange(201.0), 5.0 - np.arange(201.0)])
    drawn = cf.updating.PosteriorSamples(
        names=("a", "b"), log=(False, True), samples=samples, gauss_newton=np.array([1.0, 2.0]), acceptance=0.4,
        autocorrelation=30.0, gap=0.01,
    )  # fmt: skip
    spread = np.sqrt(np.sum((np.arange(201.0) - 100.0) ** 2) / 200.0)
    np.testing.assert_allclose(drawn.sigma, spread, rtol=1e-12)
    first, second = drawn.records()
    assert first == {
        "name": "a", "log": False, "low": 5.0, "median": 100.0, "high": 195.0, "sigma": pytest.approx(spread),
        "gauss_newton": 1.0,
    }  # fmt: skip
    assert [second[name] for name in ("low", "median", "high")] == [-190.0, -95.0, 0.0]
    assert list(drawn.columns()) == ["a", "log10 b"]
    told = drawn.to_json()
    assert (told["samples"], told["levels"], told["kind"]) == (201, [0.025, 0.5, 0.975], "emcee")
    assert (told["acceptance"], told["autocorrelation"], told["gap"]) == (0.4, 30.0, 0.01)


def test_a_posterior_of_laplace_is_told_as_plain_data():
    sure = cf.updating.Laplace(
        names=("a",), log=(False,), covariance=np.array([[4.0]]), gauss_newton=np.ones(1), bend=np.zeros(1)
    )
    told = {"name": "a", "log": False, "sigma": 2.0, "gauss_newton": 1.0, "bend": 0.0}
    assert sure.to_json() == {"kind": "laplace", "parameters": [told]}
