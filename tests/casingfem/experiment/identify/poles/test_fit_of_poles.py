"""What a fit of poles gives, against least squares with every column written out as real numbers."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_fit import _Data, _state, _step, _system, fit_poles
from casingfem.experiment.identify.poles.pole_selection import (
    alike_lines,
    basis,
    gains,
    has_skirts,
    hidden_split,
    noise_at,
    penalty,
)
from casingfem.experiment.identify.poles.pole_window import Window

LINES = np.arange(90.0, 112.0, 0.5)
FREQ, ZETA = np.array([97.0, 98.5, 104.0]), np.array([0.01, 0.02, 0.015])


def window(residues="real", noise=0.3, floor=0.0):
    """Three modes in four channels, with noise; some lines weigh little, one nothing."""
    rng = np.random.default_rng(12)
    along = np.linspace(0.5, 1.0, len(LINES))
    along[7] = 0.0
    empty = Window(freq=LINES, Y=np.zeros((2 * len(LINES), 4)), power=1, residues=residues, weight=np.ones(4),
                   floor=floor, along=along)  # fmt: skip
    H = empty.values(FREQ, ZETA) @ (rng.standard_normal((3, 4)) + (0.5j if residues == "complex" else 0.0))
    H = H + noise * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)) * along[:, None]
    return Window(freq=LINES, Y=np.vstack([H.real, H.imag]), power=1, residues=residues, weight=empty.weight,
                  floor=floor, along=along)  # fmt: skip


def columns_of(data, freq=FREQ, zeta=ZETA):
    return np.hstack([data.resonances(freq, zeta), data.residuals()])


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_a_fit_is_that_of_the_real_columns(residues):
    data = window(residues)
    fit = fit_poles(data, FREQ[::-1], ZETA[::-1], steps=0)
    s, m, half = data.columns, 3, len(LINES)
    columns, D = columns_of(data), data.slopes(FREQ, ZETA)
    A = np.linalg.lstsq(columns, data.Y, rcond=None)[0]
    R = data.Y - columns @ A
    np.testing.assert_allclose(fit.freq, FREQ, rtol=1e-14)
    np.testing.assert_allclose(fit.zeta, ZETA, rtol=1e-14)
    np.testing.assert_allclose(fit.A, A[: m * s].reshape(m, s, 4), rtol=1e-8)
    assert fit.squares == pytest.approx(np.sum(R**2), rel=1e-10)
    free = 2 * 4 * (half - 1) - 4 * s * (m + 4) - 2 * m  # one line is missing; four polynomials
    assert fit.variance == pytest.approx(np.sum(R**2) / free, rel=1e-10)
    np.testing.assert_allclose(fit.spread, R[:half] + 1j * R[half:], atol=1e-9)
    gram = np.linalg.inv(columns.T @ columns)[: m * s, : m * s]
    np.testing.assert_allclose(fit.gram, gram.reshape(m, s, m, s), rtol=1e-6, atol=1e-8 * gram.max())
    tilt = np.linalg.lstsq(columns, D, rcond=None)[0][: m * s]
    np.testing.assert_allclose(fit.tilt, tilt.reshape(m, s, 2 * m, s), rtol=1e-6, atol=1e-8 * np.abs(tilt).max())
    assert fit.parameters == m * s * 4 + 2 * m
    assert not fit.converged
    each = [getattr(fit, name).tolist() for name in ("matching", "rival", "seen", "apart", "worth")]
    assert each == [[0.0] * 3, [0.0] * 3, [1.0] * 3, [0.0] * 2, [0.0] * 3]


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_the_covariance_is_that_of_white_noise_raised_by_what_lines_have_in_common(residues):
    data = window(residues)
    fit = fit_poles(data, FREQ, ZETA, steps=0)
    s, half = data.columns, len(LINES)
    columns, D = columns_of(data), data.slopes(FREQ, ZETA)
    A = np.linalg.lstsq(columns, data.Y, rcond=None)[0]
    R = data.Y - columns @ A
    across = (D - columns @ np.linalg.lstsq(columns, D, rcond=None)[0]).reshape(2 * half, 6, s)
    residues_of = np.concatenate([A[: 3 * s], A[: 3 * s]]).reshape(6, s, 4)
    J = -np.einsum("ljs,jsc->ljc", across, residues_of)  # (2 lines, 2 poles, channels)
    information = np.einsum("ljc,lkc->jk", J, J)
    scores = np.einsum("ljc,lc->lj", J, R)
    scores = scores[:half] + scores[half:]
    meat = scores.T @ scores
    for lag, share in ((1, 2.0 / 3.0), (2, 1.0 / 3.0)):
        near = scores[lag:].T @ scores[:-lag]
        meat = meat + share * (near + near.T)
    white = np.linalg.inv(information)
    raised = np.sqrt(np.maximum(np.diag(white @ meat @ white) / (fit.variance * np.diag(white)), 1.0))
    assert raised.min() < 1.0 + 1e-12 < raised.max()
    np.testing.assert_allclose(fit.raised, raised, rtol=1e-6)
    np.testing.assert_allclose(fit.covariance, white * np.outer(raised, raised), rtol=1e-5, atol=1e-9 * white.max())


def test_the_noise_of_a_fit_is_no_less_than_the_floor():
    quiet, loud = (fit_poles(window(floor=floor), FREQ, ZETA, steps=0) for floor in (0.01, 5.0))
    assert quiet.noise == quiet.variance
    assert loud.noise == 25.0


def test_no_poles_leave_what_polynomials_leave():
    data = window()
    fit = fit_poles(data, np.zeros(0), np.zeros(0))
    rest = data.Y - data.residuals() @ np.linalg.lstsq(data.residuals(), data.Y, rcond=None)[0]
    assert fit.squares == pytest.approx(np.sum(rest**2), rel=1e-10)
    assert fit.converged
    assert fit.freq.size == 0


@pytest.mark.parametrize(
    ("freq", "zeta"), [([97.5, 99.5, 104.0], [0.002, 0.02, 0.01]), ([97.1, 98.4, 104.2], [0.1, 0.2, 0.1])]
)
def test_a_step_is_that_of_gauss_and_newton_cut_to_two_half_widths_and_one_of_ln_zeta(freq, zeta):
    data = _Data.of(window())
    at = _state(data, np.array(freq), np.array(zeta))
    system = _system(at)
    for damping in (1e-12, 3.0):
        full = system.full + damping * np.diag(np.diag(system.full))
        step = -np.linalg.solve(full, system.gradient)
        step /= max(1.0, *np.abs(step[:3] / (2.0 * at.zeta)), *np.abs(step[3:]))
        new = _step(data, at, damping)
        np.testing.assert_allclose(np.log(new.f / at.f), step[:3], rtol=1e-7, atol=1e-12)
        np.testing.assert_allclose(np.log(new.zeta / at.zeta), step[3:], rtol=1e-7, atol=1e-12)


def test_damping_stays_within_its_bounds():
    data = _Data.of(window())
    for zeta, bound in ((1e-6, 1e-6), (0.5, 0.5)):
        at = _state(data, np.array([97.0]), np.array([zeta]))
        found = [_step(data, at._replace(D=sign * at.D), 1e-3).zeta[0] for sign in (1.0, -1.0)]
        assert min(found) >= 1e-6
        assert max(found) <= 0.5
        assert bound in found


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_a_pole_gains_what_the_squares_rise_without_it(residues):
    data = window(residues)
    fit = fit_poles(data, FREQ, ZETA, steps=0)
    for k in range(3):
        columns = columns_of(data, np.delete(FREQ, k), np.delete(ZETA, k))
        rest = data.Y - columns @ np.linalg.lstsq(columns, data.Y, rcond=None)[0]
        rise = np.sum(rest**2) - fit.squares
        assert gains(fit)[k] == pytest.approx(rise / noise_at(fit, k) / alike_lines(fit, k), rel=1e-7)
    Q = basis(fit)
    np.testing.assert_allclose(Q.T @ Q, np.eye(Q.shape[1]), atol=1e-12)
    columns = columns_of(data)
    np.testing.assert_allclose(Q @ (Q.T @ columns), columns, atol=1e-9)
    assert Q.shape == columns.shape


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_the_hidden_split_is_seen_where_its_squares_exceed_the_price_and_three_sigma(residues):
    """(split/2)^2 |g' across all|^2 |a|^2 = noise (sqrt(price) + 3)^2."""
    data = window(residues)
    fit = fit_poles(data, FREQ, ZETA, steps=0)
    columns = columns_of(data)
    g = data.slopes(FREQ[1:2], ZETA[1:2])[:, 0]
    across = np.sum((g - columns @ np.linalg.lstsq(columns, g, rcond=None)[0]) ** 2) * np.sum(fit.A[1] ** 2)
    price = (4 * data.columns + 2) * np.log(2 * 4 * len(LINES))
    assert penalty(data) == pytest.approx(price, rel=1e-12)
    want = 2.0 * (np.sqrt(price) + 3.0) * np.sqrt(fit.variance / across)
    assert hidden_split(fit, 1) == pytest.approx(want, rel=1e-7)


def narrow(lines, at, *, hum=False):
    """A peak much narrower than the lines, or one wrong line, in three channels."""
    freq, shape = np.asarray(lines, float), np.array([1.0, -0.5, 0.8])
    empty = Window(freq=freq, Y=np.zeros((2 * len(freq), 3)), power=0, residues="real", weight=np.ones(3), floor=1e-6,
                   along=np.ones(len(freq)))  # fmt: skip
    H = empty.values(np.array([at]), np.array([1e-5])) * shape
    if hum:
        H = np.where((freq == at)[:, None], 50.0 * shape, 0.0) + 0j
    noise = np.random.default_rng(3).standard_normal((2, *H.shape))
    H = H + 1e-3 * (noise[0] + 1j * noise[1])
    data = Window(freq=freq, Y=np.vstack([H.real, H.imag]), power=0, residues="real", weight=np.ones(3), floor=1e-6,
                  along=empty.along)  # fmt: skip
    return fit_poles(data, np.array([at]), np.array([1e-5]), steps=0)


def test_skirts_are_three_lines_on_either_side_beyond_one_and_a_half():
    """The nearest of a skirt are lines 98 and 102 about 100 and 100.4, 99 and 103 about 100.6."""
    assert has_skirts(narrow(range(80, 121), 100.0), 0)
    assert not has_skirts(narrow(range(80, 121), 100.0, hum=True), 0)
    assert has_skirts(narrow(range(96, 121), 100.0), 0)
    assert not has_skirts(narrow(range(97, 121), 100.0), 0)
    assert has_skirts(narrow(range(80, 105), 100.0), 0)
    assert not has_skirts(narrow(range(80, 104), 100.0), 0)
    assert not has_skirts(narrow(range(97, 121), 100.4), 0)
    assert has_skirts(narrow(range(97, 121), 100.6), 0)
