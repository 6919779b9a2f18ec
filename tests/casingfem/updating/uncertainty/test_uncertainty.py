"""What is made of a fit and its parabolas: predictions, densities, weak directions, by hand."""

import numpy as np
import pytest

import casingfem as cf


def test_samples_show_their_spread_and_quantiles():
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


def test_a_posterior_of_laplace_is_reported_as_plain_data():
    sure = cf.updating.Laplace(
        names=("a",), log=(False,), covariance=np.array([[4.0]]), gauss_newton=np.ones(1), bend=np.zeros(1)
    )
    told = {"name": "a", "log": False, "sigma": 2.0, "gauss_newton": 1.0, "bend": 0.0}
    assert sure.to_json() == {"kind": "laplace", "parameters": [told]}
