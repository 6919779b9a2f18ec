"""The fit of poles: exact gradient, honest covariance, how many poles."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.experiment.identify import verdict
from casingfem.experiment.identify.poles import pole_fit
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_selection import hidden_split, select_poles
from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.cluster_modes import only_peaks
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.own_shifts import Modes, apart, linked

LINES = np.arange(390.0, 410.0, 0.1)
SEED = 2711


def window(freq, zeta, shapes, *, sigma=0.0, residues="real", power=2, seed=SEED):
    """Responses of modes with these shapes (modes, channels) and white noise."""
    x, w = LINES[:, None] / LINES.mean(), np.array(freq) / LINES.mean()
    g = (1j * x) ** power * w**2 / (w**2 - x**2 + 2j * np.array(zeta) * w * x)
    rng = np.random.default_rng(seed)
    H = g @ np.asarray(shapes)
    H = H + sigma * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    stacked = np.concatenate([H.real, H.imag])
    floor = 3e-4 * np.sqrt(np.mean(stacked**2))
    weight = np.ones(H.shape[1])
    return Window(
        freq=LINES, Y=stacked, power=power, residues=residues, weight=weight, floor=floor, along=np.ones(len(LINES))
    )


SHAPES = np.random.default_rng(77).standard_normal((3, 8))
THREE = [397.0, 400.0, 400.8], [0.003, 0.001, 0.0012]


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_gradient_and_full_matrix_are_those_of_the_sum_of_squares(residues):
    data = pole_fit._Data.of(window(*THREE, SHAPES, sigma=0.5, residues=residues))
    p = np.log([397.1, 399.95, 400.9, 0.0028, 0.0011, 0.0013])

    def residual(p):
        left = pole_fit._state(data, np.exp(p[:3]), np.exp(p[3:])).R.ravel()
        return np.concatenate([left.real, left.imag])

    step = 1e-6
    J = np.column_stack([(residual(p + step * e) - residual(p - step * e)) / (2 * step) for e in np.eye(6)])
    system = pole_fit._system(pole_fit._state(data, np.exp(p[:3]), np.exp(p[3:])))
    np.testing.assert_allclose(system.gradient, J.T @ residual(p), rtol=1e-6)
    np.testing.assert_allclose(system.full, J.T @ J, rtol=1e-6, atol=1e-6 * np.abs(J.T @ J).max())


def test_exact_data_give_exact_poles():
    fit = fit_poles(window(*THREE, SHAPES), np.array([396.5, 399.9, 401.0]), np.array([0.002, 0.002, 0.002]))
    np.testing.assert_allclose(fit.freq, THREE[0], rtol=1e-6)
    np.testing.assert_allclose(fit.zeta, THREE[1], rtol=1e-3)
    assert fit.converged


@pytest.mark.slow
def test_standard_deviations_are_those_of_repeated_tests():
    found, sigmas = [], []
    for seed in range(120):
        fit = fit_poles(window(*THREE, SHAPES, sigma=2.0, seed=seed), *np.array(THREE))
        found.append(np.log(np.r_[fit.freq, fit.zeta]))
        sigmas.append(np.sqrt(fit.variance * np.diag(fit.covariance)))
    scatter = np.std(found, axis=0, ddof=1)
    np.testing.assert_allclose(scatter, np.mean(sigmas, axis=0), rtol=0.2)  # 6.5 % is one sigma of a scatter


def test_a_start_with_too_few_poles_grows_and_one_with_too_many_shrinks():
    data = window(*THREE, SHAPES, sigma=0.5)
    few = select_poles(data, np.array([[400.0, 0.002]]))
    many = select_poles(
        data, np.array([[394.0, 0.002], [397.0, 0.002], [400.0, 0.001], [400.7, 0.001], [405.0, 0.004]])
    )
    for fit in (few, many):
        assert np.abs(fit.freq - THREE[0]).max() < 0.01
        assert fit.window.residues == "real"


@pytest.mark.slow
def test_phases_of_their_own_make_residues_complex():
    shapes = SHAPES * np.exp(1j * np.random.default_rng(5).uniform(-0.6, 0.6, SHAPES.shape))
    fit = select_poles(window(*THREE, shapes, sigma=0.2), np.column_stack(THREE))
    assert fit.window.residues == "complex"
    np.testing.assert_allclose(fit.freq, THREE[0], rtol=1e-5)


def test_the_split_that_would_be_missed_falls_with_the_noise():
    loud, quiet = (
        hidden_split(select_poles(window([400.0], [0.002], SHAPES[:1], sigma=sigma), np.array([[400.0, 0.002]])), 0)
        for sigma in (2.0, 0.2)
    )
    assert loud / quiet == pytest.approx(10.0, rel=0.1)


@pytest.mark.parametrize(("part", "told"), [(3.0, 2), (0.3, 1)])
def test_a_split_above_that_bound_is_seen_and_one_far_below_is_not(part, told):
    first, second = np.linalg.qr(SHAPES[:2].T)[0].T * 10.0
    alone = select_poles(window([400.0], [0.002], [first + second], sigma=0.5), np.array([[400.0, 0.002]]))
    split = part * hidden_split(alone, 0)
    pair = [400.0 * (1 - split / 2), 400.0 * (1 + split / 2)]
    data = window(pair, [0.002, 0.002], [first, second], sigma=0.5)
    assert len(select_poles(data, np.array([[400.0, 0.002]])).freq) == told


def test_no_response_at_all_has_no_poles():
    silent = window([400.0], [0.002], np.zeros((1, 8)))
    assert len(select_poles(silent, np.zeros((0, 2))).freq) == 0


@pytest.mark.parametrize("leak", [0.0, 0.5])
def test_slopes_are_derivatives_and_lines_left_out_change_no_other(leak):
    data = replace(window(*THREE, SHAPES), along=np.linspace(0.2, 1.0, len(LINES)))
    data = replace(data, leak=leak * float(LINES[1] - LINES[0]) * 2.0)
    f, zeta = np.array(THREE)
    g, slopes = data.peaks(f, zeta)
    for k, slope in enumerate(slopes):
        high, low = (data.values(f * np.exp(by * (k == 0)), zeta * np.exp(by * (k == 1))) for by in (1e-6, -1e-6))
        np.testing.assert_allclose(slope, (high - low) / 2e-6, atol=1e-6 * np.abs(slope).max())
    np.testing.assert_allclose(g, data.values(f, zeta), rtol=1e-12)
    kept = np.arange(len(LINES)) % 3 != 1
    few = data.cut(kept)
    np.testing.assert_allclose(few.values(f, zeta) * (few.scale / data.scale) ** 2, g[kept], rtol=1e-9)


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_one_setup_is_fitted_as_common_poles_are(residues):
    """By inner products alone, or with all lines: the same poles, squares and standard deviations."""
    data = window(*THREE, SHAPES, sigma=0.5, residues=residues)
    fit = fit_poles(data, *np.array(THREE))
    start = 1.0002 * np.array(THREE[0])[:, None], 1.1 * np.array(THREE[1])
    for fitted in (apart, linked):
        own = fitted(data, [np.arange(8)], *start, 0.25, (390.0, 410.0))
        np.testing.assert_allclose(own.freq[:, 0], fit.freq, rtol=1e-7)
        np.testing.assert_allclose(own.zeta[:, 0], fit.zeta, rtol=1e-4)
        assert own.squares == pytest.approx(fit.squares, rel=1e-6)
        white = 0.25 * np.diag(fit.covariance) / fit.raised**2
        np.testing.assert_allclose([*own.variance[:, 0], *own.zeta_variance[:, 0]], white, rtol=1e-2)


def test_a_mode_that_runs_away_is_taken_out_of_its_cluster_alone():
    """What peaks there are does not go with it: skirts that nothing explains would spoil the clusters beside."""
    data = window([400.0], [0.002], SHAPES[:1], sigma=0.5)
    modes = Modes(np.array([[400.0], [401.0]]), np.array([0.002, 0.002]), np.ones((2, 8), complex))
    cluster = Cluster(modes, data, (399.0, 402.0), 0.25)
    own = linked(data, [np.arange(8)], np.array([[400.0], [405.0]]), np.array([0.002, 0.1]), 0.25, (398.0, 406.0))
    kept = only_peaks(cluster, [np.arange(8)], own._replace(zeta=np.array([[0.002], [0.1]])), 0.01)
    assert kept.freq.ravel() == pytest.approx([400.0], rel=1e-5)
    assert kept.squares / data.Y.size == pytest.approx(0.25, rel=0.1)


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_the_highest_peak_of_a_cluster_says_how_damped_a_mode_beside_it_may_be(order):
    """Beside a wide high peak a wide one stays, beside a narrow high one it goes, in either order of the two."""
    freq, channels, wide, narrow = [397.0, 403.0], [np.arange(8)], 0.02, 0.004
    data = window(freq, [narrow, narrow], SHAPES[:2], sigma=0.5)
    own = linked(data, channels, np.array(freq)[:, None], np.full(2, narrow), 0.25, (395.0, 405.0))
    own = own._replace(freq=np.array(freq)[:, None], zeta=np.array([[narrow], [wide]]))
    for high, low, count in ((wide, narrow, 2), (narrow, wide, 1)):
        residues = np.ones((2, 8), complex) * [[9.0], [1.0]]
        modes = Modes(np.array(freq)[order, None], np.array([high, low])[order], residues[order])
        cluster = Cluster(modes, data, (395.0, 405.0), 0.25)
        assert len(only_peaks(cluster, channels, own, 0.01).freq) == count


@pytest.mark.parametrize("gain", [1e-3, 1e3])
def test_a_channel_in_another_unit_makes_no_two_poles_one(gain):
    """Its signal over its noise is what it was; in its own units it would be all of every shape."""
    near = [397.0, 400.0, 400.4], THREE[1]
    seen = window(*near, SHAPES, sigma=0.05)
    fit = select_poles(replace(seen, weight=np.r_[1.0 / gain, seen.weight[1:]]), np.column_stack(near))
    assert fit.freq == pytest.approx(near[0], abs=0.01)
    assert not [told for pole in range(3) for told in verdict._beside(fit, pole)]
