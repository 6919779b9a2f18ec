"""The two modes of a pair in parts: waves, their slopes, the best linear part, the sigma of what is told."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import f

import casingfem as cf
from casingfem.experiment.circle import pair
from casingfem.experiment.circle.pair import (
    basis,
    described,
    fitted_poles,
    jacobian,
    linear_part,
    require_two,
    split_pair,
)
from tests.casingfem.experiment.circle.test_circle_scan import SEED, close_pair, scan_of_a_pair

POLES, PARTS = np.array([370.0, 371.0, -6.0, -5.0]), np.array([[1.0, 0.5], [-0.3, 0.8], [1e-6, 2e-6]])
TONES, SIGMA = np.linspace(368.0, 373.0, 7), np.linspace(0.01, 0.02, 7)


def waves(at):
    """C and S over the noise by f1, f2, ln zeta1, ln zeta2, a1, a2, c, b1, b2, s; real above imaginary."""
    own, zeta, parts = 2.0 * np.pi * at[:2], np.exp(at[2:4]), at[4:].reshape(2, 3).T
    omega = 2.0 * np.pi * TONES[:, None]
    h = np.hstack([1j * omega / (own**2 - omega**2 + 2j * zeta * own * omega), 1j * omega]) / SIGMA[:, None]
    return np.vstack([(h @ parts).real, (h @ parts).imag]).ravel()


def test_the_slopes_of_a_pair_are_those_of_its_waves():
    at, slopes = np.r_[POLES, PARTS.T.ravel()], []
    model = basis(TONES, POLES, SIGMA) @ PARTS
    np.testing.assert_allclose(np.vstack([model.real, model.imag]).ravel(), waves(at), rtol=1e-12)
    for k in range(10):
        step = np.zeros(10)
        step[k] = 1e-5 * (at[k] if k < 2 else 1.0)
        slopes.append((waves(at + step) - waves(at - step)) / (2.0 * step[k]))
    found, size = jacobian(TONES, POLES, PARTS, SIGMA).T, np.linalg.norm(slopes, axis=1, keepdims=True)
    np.testing.assert_allclose(found / size, slopes / size, atol=1e-4)


def test_the_linear_part_of_a_pair_is_found_where_its_poles_are_known():
    data = basis(TONES, POLES, SIGMA) @ PARTS
    parts, residual = linear_part(TONES, POLES, data, SIGMA)
    np.testing.assert_allclose(parts, PARTS, rtol=1e-8)
    assert residual.shape == (28,)
    assert np.abs(residual).max() < 1e-9 * np.abs(data).max()


def test_the_sigma_of_a_pair_follow_from_the_covariance_of_all_that_is_fitted():
    factor = np.random.default_rng(SEED).standard_normal((10, 10))
    C = factor @ factor.T
    found = described(8, POLES, PARTS, C, 1.5)
    np.testing.assert_allclose(found.freq_sigma, np.sqrt(np.diag(C)[:2]), rtol=1e-12)
    assert (found.n, found.misfit, found.split) == (8, 1.5, 1.0)
    assert found.split_sigma == pytest.approx(np.sqrt(C[0, 0] + C[1, 1] - 2.0 * C[0, 1]), rel=1e-12)
    for k in range(2):
        a, b = PARTS[k]
        slope = np.zeros(10)
        slope[[4 + k, 7 + k]] = np.degrees(-b / (a * a + b * b) / 8), np.degrees(a / (a * a + b * b) / 8)
        assert found.angle_deg[k] == pytest.approx(np.degrees(np.arctan2(b, a)) / 8 % 22.5, rel=1e-12)
        assert found.angle_sigma_deg[k] == pytest.approx(np.sqrt(slope @ C @ slope), rel=1e-12)


@pytest.mark.slow
def test_a_misfit_above_one_raises_the_sigma_and_one_below_does_not_lower_them():
    """With the noise said to be a sixteenth of that the misfit is 16 times as large, for the same deviations."""
    seen = close_pair(np.random.default_rng(SEED))
    low, high = (split_pair(replace(seen, sigma=factor * seen.sigma), 8) for factor in (0.25, 4.0))
    assert high.misfit < 1.0 < low.misfit == pytest.approx(16.0 * high.misfit, rel=1e-6)
    np.testing.assert_allclose(high.freq_sigma / low.freq_sigma, 16.0 / low.misfit, rtol=1e-4)


@pytest.mark.slow
def test_six_tones_tell_a_pair_and_five_do_not():
    seen = scan_of_a_pair([369.0, 371.0])
    assert split_pair(seen, 8).split == pytest.approx(2.0, rel=1e-6)
    fewer = replace(seen, tones=seen.tones[:5], V=seen.V[:5], sigma=seen.sigma[:5], floor=seen.floor[:5])
    with pytest.raises(cf.errors.InputError, match="the pair n = 8: found 5 tones, expected 6 or more across it"):
        split_pair(fewer, 8)
    for n in (0, 7, -8):
        with pytest.raises(cf.errors.InputError, match=f"order n = {n}: expected one of the orders fitted, 1 or more"):
            split_pair(seen, n)


@pytest.mark.parametrize("squares", [60.0, 2000.0])
@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_two_are_told_from_one_where_noise_would_do_it_once_in_a_thousand(monkeypatch, squares, factor):
    """F of four more unknowns, at one of 27 starts; with a misfit above one its square is the noise."""
    pole, freedom = POLES[[0, 2]], 28 - 10
    monkeypatch.setattr(pair, "fitted_poles", lambda tones, data, sigma, members: pole if members == 1 else None)
    drawn = np.random.default_rng(SEED).standard_normal((2, 7, 2)) * [[[1.0]], [[1j]]]
    rest = linear_part(TONES, pole, drawn.sum(axis=0), SIGMA)[1]
    data = drawn.sum(axis=0) * np.sqrt(squares / (rest @ rest)) + basis(TONES, pole, SIGMA) @ PARTS[[0, 2]]
    gain = f.isf(1e-3 / 27.0, 4, freedom)
    misfit = np.sqrt((squares - 4.0 * gain) / freedom if squares < 100.0 else squares / (freedom + 4.0 * gain))
    assert (misfit > 1.0) == (squares > 100.0)
    if factor < 1.0:
        require_two(8, TONES, data, SIGMA, factor * misfit)
    else:
        said = f"found a misfit of {factor * misfit:.3g} with two and {np.sqrt(squares / 22):.3g} with one"
        with pytest.raises(cf.errors.InputError, match=said):
            require_two(8, TONES, data, SIGMA, factor * misfit)


def test_one_pole_is_found_within_the_tones_or_beyond():
    for freq, zeta in ((370.3, 2e-3), (366.0, 8e-3)):
        data = basis(TONES, np.array([freq, np.log(zeta)]), SIGMA) @ np.array([[1.0, -0.4], [1e-4, 2e-4]])
        np.testing.assert_allclose(fitted_poles(TONES, data, SIGMA, 1), [freq, np.log(zeta)], rtol=1e-6)
