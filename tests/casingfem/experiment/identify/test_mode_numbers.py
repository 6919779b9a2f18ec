"""Modes from fitted poles by numbers written out: shapes and their covariance, notes on pairs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.found_modes import (
    _left_of,
    _mode,
    found_modes,
    notes_of,
    paired,
    settled,
    without_antinode,
)
from casingfem.experiment.identify.mode_shapes import mode_shape, pole_slopes, residue_matrix, shape_covariance
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_selection import hidden_split
from casingfem.experiment.identify.poles.pole_window import Window
from tests.casingfem.experiment.identify.test_found_modes import mode

LINES = np.arange(90.0, 112.0, 0.25)
FREQ, ZETA = np.array([98.0, 103.0]), np.array([0.006, 0.009])
WEIGHT = np.array([1.0, 2.0, 0.5, 1.5, 0.8, 1.2])
GRID = np.array([[0, 3], [4, 1], [2, 5]])  # three sensors, two references


def fitted(kind="complex", freq=FREQ, residues=None, power=1, sigma=0.5):
    """A fit of six channels with noise."""
    rng = np.random.default_rng(14)
    if residues is None:
        real, imaginary = rng.standard_normal((2, len(freq), 6))
        residues = real + (0.4j * imaginary if kind == "complex" else 0.0)
    empty = Window(freq=LINES, Y=np.zeros((2 * len(LINES), 6)), power=power, residues=kind, weight=WEIGHT, floor=0.0,
                   along=np.ones(len(LINES)))  # fmt: skip
    H = empty.values(freq, ZETA[: len(freq)]) @ residues * WEIGHT
    H = H + sigma * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    data = Window(freq=LINES, Y=np.vstack([H.real, H.imag]), power=power, residues=kind, weight=WEIGHT, floor=0.0,
                  along=empty.along)  # fmt: skip
    return fit_poles(data, freq, ZETA[: len(freq)], steps=0)


@pytest.mark.parametrize("kind", ["real", "complex"])
def test_a_shape_is_the_first_singular_vector_turned_into_phase_its_largest_part_positive(kind):
    fit = fitted(kind)
    for pole in range(2):
        A = fit.A[pole] / WEIGHT
        matrix = (A[0] + (1j * A[1] if kind == "complex" else 0.0))[GRID]
        np.testing.assert_allclose(residue_matrix(fit, pole, GRID), matrix, rtol=1e-12)
        u, sizes, _ = np.linalg.svd(matrix)
        angles = np.linspace(0.0, np.pi, 20001) if kind == "complex" else np.zeros(1)
        each = u[:, :1] * np.exp(1j * angles)
        turned = each[:, np.linalg.norm(each.real, axis=0).argmax()]
        want = turned.real / np.linalg.norm(turned.real)
        want = want * np.sign(want[np.abs(want).argmax()])
        shape = mode_shape(fit, pole, GRID)
        np.testing.assert_allclose(shape.values, want, atol=2e-4)
        assert shape.collinearity == pytest.approx(np.linalg.norm(turned.real) ** 2, rel=1e-6)
        assert shape.balance == pytest.approx(2.0 * sizes[0] * sizes[1] / (sizes[0] ** 2 + sizes[1] ** 2), rel=1e-12)
        values = np.einsum("rs,sor->o", shape.parts, np.stack([matrix.real, matrix.imag])[: fit.A.shape[1]])
        np.testing.assert_allclose(values, shape.values, rtol=1e-10)
        np.testing.assert_allclose(
            shape.covariance, shape_covariance(fit, (pole, shape.parts), (pole, shape.parts), GRID), rtol=1e-9
        )
    three = np.array([[0, 3, 2], [4, 1, 0], [2, 5, 1]])
    sizes = np.linalg.svd(residue_matrix(fit, 0, three), compute_uv=False)
    balance = 2.0 * sizes[0] * sizes[1] / (sizes[0] ** 2 + sizes[1] ** 2)
    assert mode_shape(fit, 0, three).balance == pytest.approx(balance, rel=1e-9)
    one = mode_shape(fit, 0, GRID[:, :1])
    assert (one.second, one.balance) == (0.0, 0.0)


@pytest.mark.parametrize("kind", ["real", "complex"])
def test_residues_follow_poles_as_the_fit_says(kind):
    """Where all that is left is small, by differences of fits at other poles."""
    fit, h = fitted(kind, sigma=1e-7), 1e-5
    parts = np.array([[0.7, -0.4], [0.2, 0.5]])[:, : fit.A.shape[1]]
    slopes = pole_slopes(fit, 1, parts, GRID)
    for k, e in enumerate(np.eye(4)):
        values = []
        for step in (h, -h):
            moved = fit_poles(fit.window, FREQ * np.exp(step * e[:2]), ZETA * np.exp(step * e[2:]), steps=0)
            A = (moved.A[1] / WEIGHT)[:, GRID]
            values.append(np.einsum("rs,sor->o", parts, A))
        np.testing.assert_allclose(slopes[:, k], (values[0] - values[1]) / (2 * h), rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("kind", ["real", "complex"])
def test_the_covariance_of_shapes_has_direct_noise_and_that_through_the_poles(kind):
    fit = fitted(kind)
    s = fit.A.shape[1]
    parts = np.array([[0.7, -0.4], [0.2, 0.5]])[:, :s], np.array([[0.1, 0.3], [-0.6, 0.2]])[:, :s]
    direct = np.zeros(3)
    for o in range(3):
        for r in range(2):
            direct[o] += parts[0][r] @ fit.gram[0, :, 1, :] @ parts[1][r] / WEIGHT[GRID[o, r]] ** 2
    a, b = pole_slopes(fit, 0, parts[0], GRID), pole_slopes(fit, 1, parts[1], GRID)
    want = fit.variance * (np.diag(direct) + a @ fit.covariance @ b.T)
    np.testing.assert_allclose(shape_covariance(fit, (0, parts[0]), (1, parts[1]), GRID), want, rtol=1e-10)


@pytest.mark.parametrize("kind", ["real", "complex"])
def test_a_second_shape_is_over_the_largest_that_noise_gives(kind):
    fit = fitted(kind)
    s = fit.A.shape[1]
    direct = np.sqrt(sum(fit.gram[0, c, 0, c] for c in range(s)) * np.mean(1.0 / WEIGHT**2))
    through = 0.0
    for r in range(2):
        for c in range(s):
            slopes = pole_slopes(fit, 0, np.eye(s)[[c]], GRID[:, [r]])
            through += np.trace(slopes @ fit.covariance @ slopes.T)
    limit = np.sqrt(fit.variance) * (direct * (np.sqrt(3.0) + np.sqrt(2.0) + 3.0) + 3.0 * np.sqrt(through))
    second = np.linalg.svd(residue_matrix(fit, 0, GRID), compute_uv=False)[1]
    assert mode_shape(fit, 0, GRID).second == pytest.approx(second / limit, rel=1e-9)


THETA = np.radians([0.0, 50.0, 110.0, 160.0, 230.0, 300.0])
SIGN = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])
SENSORS = SensorGrid(points=np.arange(6), directions=SIGN.astype(int), theta=THETA, references=np.array([[9, 1]]),
                     channels=np.arange(6)[:, None], places=np.zeros((6, 3)))  # fmt: skip


def test_the_numbers_of_a_mode():
    waves = SIGN * np.array([2.0 * np.cos(2 * THETA - 0.6), 1.5 * np.cos(THETA + 0.2)])
    fit = replace(fitted("real", residues=waves), matching=np.array([3e-4, 0.0]))
    circle = Circle.of(THETA)
    found = _mode(fit, 0, SENSORS, SIGN, circle, None)
    shape = mode_shape(fit, 0, SENSORS.channels)
    sigma = np.sqrt(fit.variance * np.diag(fit.covariance))
    assert (found.freq, found.zeta, found.n) == (98.0, 0.006, 2)
    assert found.sigma_freq == pytest.approx(98.0 * np.hypot(sigma[0], 3e-4), rel=1e-6)
    assert found.sigma_zeta == pytest.approx(0.006 * sigma[2], rel=1e-6)
    label = circle.label(shape.values * SIGN, shape.covariance * np.outer(SIGN, SIGN))
    assert (found.purity, found.angle, found.sigma_angle) == (label.purity, label.angle, label.sigma)
    assert found.angle == pytest.approx(0.3, abs=0.02)
    np.testing.assert_allclose(found.sigma_shape**2, np.diag(shape.covariance), rtol=1e-12)
    peak = np.sqrt(np.mean(fit.A[0] ** 2)) / (2.0 * 0.006) * 98.0 / LINES.mean()
    assert found.signal == pytest.approx(peak / np.sqrt(2.0 * fit.variance), rel=1e-9)
    assert found.residue_scale == pytest.approx(LINES.mean())
    np.testing.assert_allclose(found.residues[:, 0], fit.A[0, 0] / WEIGHT, rtol=1e-12)
    assert found.split_bound == pytest.approx(hidden_split(fit, 0), rel=1e-12)
    assert not found.double
    some = np.array([0, 2, 3, 4, 5])
    fewer = _mode(fit, 0, SENSORS, SIGN, Circle.of(THETA[some]), some)
    values, covariance = shape.values * SIGN, shape.covariance * np.outer(SIGN, SIGN)
    label = Circle.of(THETA[some]).label(values[some], covariance[np.ix_(some, some)])
    assert (fewer.n, fewer.angle, fewer.sigma_angle) == (label.n, label.angle, label.sigma)
    plain = _mode(fit, 1, SENSORS, SIGN, None, None)
    assert plain.n == -1
    assert np.isnan([plain.purity, plain.angle, plain.sigma_angle]).all()


@pytest.mark.parametrize(("share", "double"), [(0.3, True), (0.05, False), (0.0, False)])
def test_a_mode_of_two_shapes_is_double_and_hides_a_split_by_their_balance(share, double):
    """Two references see one shape and a second one so large: their balance is 0.2 or more."""
    first, second = np.array([0.8, 0.0, 0.6]), np.array([-0.6, 0.0, 0.8])
    matrix = np.outer(first, [0.6, 0.8]) + share * np.outer(second, [-0.8, 0.6])
    residues = np.zeros(6)
    residues[GRID] = 20.0 * matrix
    fit = fitted("real", FREQ[:1], residues[None], sigma=0.1)
    grid = replace(SENSORS, points=np.arange(3), directions=np.ones(3, int), theta=THETA[:3],
                   references=np.zeros((2, 2), int), channels=GRID, places=np.zeros((3, 3)))  # fmt: skip
    found = _mode(fit, 0, grid, np.ones(3), None, None)
    assert found.double is double
    balance = mode_shape(fit, 0, GRID).balance
    assert balance == pytest.approx(2.0 * share / (1.0 + share**2), abs=0.01)
    assert found.split_bound == pytest.approx(hidden_split(fit, 0) / (balance if double else 1.0), rel=1e-12)


def test_modes_of_a_core_count_once_and_what_is_left_out_is_said():
    fit = fitted("real", residues=SIGN * np.array([2.0 * np.cos(2 * THETA), 1.5 * np.cos(THETA)]))
    for low, count in ((98.0, 2), (98.001, 1)):
        assert len(found_modes([fit], [(low, 110.0)], SENSORS, SIGN, None)[0]) == count
    for high, count in ((103.0, 1), (103.001, 2)):
        assert len(found_modes([fit], [(90.0, high)], SENSORS, SIGN, None)[0]) == count
    for first in ((100.0, 110.0), (90.0, 100.0)):
        whole, _ = found_modes([fit, fit], [first, (90.0, 110.0)], SENSORS, SIGN, None)
        assert [one.freq for one in whole] == [98.0, 103.0]
    loud = replace(fit, covariance=fit.covariance + np.diag([0.0, 0.0, 0.0, 1e6]))  # damping of the second is not known
    kept, words = found_modes([loud], [(90.0, 110.0)], SENSORS, SIGN, None)
    assert [one.freq for one in kept] == [98.0]
    assert len(words) == 1
    assert words[0].startswith("left out: 103.00 Hz, damping uncertain by ")
    assert found_modes([loud], [(90.0, 103.0)], SENSORS, SIGN, None)[1] == ()
    picked, none = found_modes([loud], [(90.0, 110.0)], SENSORS, SIGN, None, keep=True)
    assert [one.freq for one in picked] == [98.0, 103.0]
    assert picked[1].doubt.startswith("damping uncertain")
    assert not none


def test_what_is_left_of_two_residues_in_their_sum():
    fit = SimpleNamespace(A=np.array([[[3.0, 0.0], [0.0, 1.0]], [[0.0, 4.0], [0.0, -1.0]]]))
    assert _left_of(fit, 0, 1) == pytest.approx(5.0 / (np.sqrt(10.0) + np.sqrt(17.0)), rel=1e-12)


def test_a_mode_that_may_be_a_pair_is_uncertain_by_half_the_split():
    found = without_antinode(mode(200.0, sigma_freq=0.3, split_bound=0.004))
    assert found.sigma_freq == pytest.approx(np.hypot(0.3, 0.5 * 0.004 * 200.0), rel=1e-12)
    assert np.isnan([found.angle, found.sigma_angle]).all()


def test_modes_without_partner_are_settled_and_named():
    modes = [mode(100.0, double=True), mode(110.0, n=0), mode(120.0, n=2), mode(130.0, n=4, unresolved=True),
             mode(140.0, n=5), mode(141.0, n=5, angle=0.2 + np.pi / 10)]  # fmt: skip
    pairs = paired(modes)
    assert pairs == ((4, 5),)
    found = settled(modes, pairs)
    assert [one.unresolved for one in found] == [True, False, False, True, False, False]
    assert [bool(np.isnan(one.angle)) for one in found] == [True, False, True, False, False, False]
    assert found[2].sigma_freq == pytest.approx(np.hypot(1.0, 6.0), rel=1e-12)
    assert notes_of(found, pairs) == (
        "pair at 100.00 Hz: split below 5 of its bandwidth (1.0e-01 relative), given as one frequency",
        "n = 2 at 120.00 Hz has no partner: the references do not drive it, or the split is below 5 of its bandwidth"
        " (1.0e-01 relative); no orientation is given",
        "pair at 130.00 Hz: split below 5 of its bandwidth (1.0e-01 relative), given as one frequency",
    )
