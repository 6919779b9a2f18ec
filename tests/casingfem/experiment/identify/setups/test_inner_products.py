"""Inner products over the lines, and the fits that are made of them, against the columns written out line by line."""

from itertools import product

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups import inner_products
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks, _At, apart, linked, squares_at

LINES = np.arange(90.0, 112.0, 0.7)
SETUPS = [np.array([4, 0, 2]), np.array([1]), np.array([3, 5])]
FREQ = np.array([[97.0, 97.3, 96.8], [103.0, 102.5, 103.4]])
ZETA = np.array([[0.02, 0.03, 0.025], [0.015, 0.012, 0.02]])


def window(residues="complex", power=2, leak=0.0, along=None, lines=LINES):
    """Random data of six channels."""
    rng = np.random.default_rng(4)
    weights = np.ones(len(lines)) if along is None else along
    data = rng.standard_normal((2, len(lines), 6)) * weights[:, None]
    return Window(freq=lines, Y=data.reshape(-1, 6), power=power, residues=residues, weight=np.arange(1.0, 7.0),
                  floor=0.0, along=weights, leak=leak)  # fmt: skip


def peaks(seen, f, zeta):
    """Resonances, as `Window` defines them: means over three places where lines leak; weighted (lines, modes)."""
    share = zip((-1, 0, 1), (1 / 6, 2 / 3, 1 / 6), strict=True) if seen.leak else [(0, 1.0)]
    total, scale = 0.0, seen.freq.mean()
    for by, part in share:
        x = (seen.freq[:, None] + by * seen.leak) / scale
        w = f / scale
        total = total + part * (1j * x) ** seen.power * w**2 / (w**2 - x**2 + 2j * zeta * w * x)
    return total * seen.along[:, None]


def slopes(seen, f, zeta):
    """Derivatives of `peaks` by ln f, then by ln zeta, by differences of fourth order."""
    found = []
    for k in (0, 1):
        at = [
            peaks(seen, f * np.exp(h * (k == 0)), zeta * np.exp(h * (k == 1))) for h in np.array([-2, -1, 1, 2]) * 1e-4
        ]
        found.append((at[0] - 8.0 * at[1] + 8.0 * at[2] - at[3]) / 12e-4)
    return np.concatenate(found, axis=1)


def stacked(seen, columns):
    """Real columns, parts over each other; for complex residues j times each beside it."""
    if seen.residues == "complex":
        columns = np.stack([columns, 1j * columns], axis=2).reshape(len(columns), -1)
    return np.concatenate([columns.real, columns.imag])


def across(seen, columns):
    """What the polynomials, powers of the line times (j x)^q, do not hold."""
    x = seen.freq / seen.freq.mean()
    terms = (seen.along * (1j * x) ** seen.power)[:, None] * (x[:, None] - 1.0) ** np.arange(4)
    basis = stacked(seen, terms)
    return columns - basis @ np.linalg.lstsq(basis, columns, rcond=None)[0]


KINDS = [
    *product(("real", "complex"), (0, 1, 2), ((0.0, None),)),
    ("real", 2, (0.7, None)),
    ("complex", 1, (0.5, None)),
    ("real", 1, (0.7, np.linspace(0.3, 1.0, len(LINES)))),
    ("complex", 2, (0.0, np.linspace(1.0, 0.2, len(LINES)))),
]


@pytest.mark.parametrize(("residues", "power", "seen"), KINDS)
@pytest.mark.parametrize("at_once", [1, 8000])
def test_products_are_those_of_the_columns(monkeypatch, residues, power, seen, at_once):
    monkeypatch.setattr(inner_products, "AT_ONCE", at_once)
    data = window(residues, power, *seen)
    own, by_data = Problem.of(data, SETUPS).products(np.log(FREQ), np.log(ZETA))
    for k, channels in enumerate(SETUPS):
        f, zeta = FREQ[:, k], ZETA[:, k]
        columns = across(data, stacked(data, np.hstack([peaks(data, f, zeta), slopes(data, f, zeta)])))
        size = np.abs(columns.T @ columns).max()
        np.testing.assert_allclose(own[k], columns.T @ columns, atol=1e-8 * size)
        rest = across(data, data.Y[:, channels])
        np.testing.assert_allclose(by_data[k][:, : len(channels)], columns.T @ rest, atol=1e-8 * size)
        assert not by_data[k][:, len(channels) :].any()


@pytest.mark.parametrize(("residues", "power", "seen"), KINDS)
def test_squares_and_the_power_that_is_left_on_peaks(residues, power, seen):
    data = window(residues, power, *seen)
    problem = Problem.of(data, SETUPS)
    rest = across(data, data.Y)
    each = [np.sum(rest[:, channels] ** 2) for channels in SETUPS]
    np.testing.assert_allclose(problem.squares, each, rtol=1e-10)
    at = _At.of(problem, np.log(FREQ), np.log(ZETA))
    left, half = np.zeros_like(rest), len(data.freq)
    for k, channels in enumerate(SETUPS):
        columns = across(data, stacked(data, peaks(data, FREQ[:, k], ZETA[:, k])))
        A = np.linalg.lstsq(columns, rest[:, channels], rcond=None)[0]
        left[:, channels] = rest[:, channels] - columns @ A
        np.testing.assert_allclose(at.residues[k][:, : len(channels)], A, rtol=1e-8, atol=1e-8 * np.abs(A).max())
        assert at.squares[k] == pytest.approx(np.sum(left[:, channels] ** 2), rel=1e-9)
    power_of = rest[:half] ** 2 + rest[half:] ** 2
    there = np.sum((left[:half] ** 2 + left[half:] ** 2) * power_of) / power_of.sum()
    assert problem.on_peaks(np.log(FREQ), np.log(ZETA), at.residues) == pytest.approx(0.5 * there, rel=1e-9)


def test_some_set_ups_are_those_alone():
    problem = Problem.of(window(), SETUPS)
    few = problem.some(np.array([2, 0]))
    assert [c.tolist() for c in few.setups] == [[3, 5], [4, 0, 2]]
    whole, part = (each.products(np.log(f), np.log(z)) for each, f, z in (
        (problem, FREQ, ZETA), (few, FREQ[:, [2, 0]], ZETA[:, [2, 0]]),
    ))  # fmt: skip
    np.testing.assert_allclose(part[0], whole[0][[2, 0]], rtol=1e-12)
    np.testing.assert_allclose(part[1], whole[1][[2, 0]], rtol=1e-12)
    np.testing.assert_array_equal(few.squares, problem.squares[[2, 0]])
    np.testing.assert_array_equal(few.power, problem.power[[2, 0]])
    assert problem.some(np.arange(3)) is problem


def residual(data, setup, theta, ridge):
    """What a set-up leaves at (ln f, ln zeta), residues eliminated, those of a ridge below; real."""
    m = len(theta) // 2
    columns = across(data, stacked(data, peaks(data, np.exp(theta[:m]), np.exp(theta[m:]))))
    columns = np.vstack([columns, np.diag(np.sqrt(ridge))])
    rest = np.vstack([across(data, data.Y[:, setup]), np.zeros((len(ridge), len(setup)))])
    return (rest - columns @ np.linalg.lstsq(columns, rest, rcond=None)[0]).ravel()


@pytest.mark.parametrize("residues", ["real", "complex"])
@pytest.mark.parametrize("held", [0.0, 30.0])
def test_gradient_and_normal_equations_are_those_of_what_is_left(residues, held):
    data = window(residues)
    ridge = held * np.array([1.0, 2.0])
    problem = Problem.of(data, SETUPS)._replace(ridge=np.repeat(ridge, data.columns))
    at = _At.of(problem, np.log(FREQ), np.log(ZETA))
    for k, setup in enumerate(SETUPS):
        theta, h = np.log(np.r_[FREQ[:, k], ZETA[:, k]]), 1e-5
        held_by = np.repeat(ridge, data.columns)
        whole = residual(data, setup, theta, held_by)
        both = [[residual(data, setup, theta + s * h * e, held_by) for s in (1, -1)] for e in np.eye(4)]
        J = np.column_stack([(up - down) / (2 * h) for up, down in both])
        assert at.squares[k] == pytest.approx(whole @ whole, rel=1e-9)
        np.testing.assert_allclose(at.gradient[k], J.T @ whole, rtol=1e-5, atol=1e-5 * np.abs(J.T @ whole).max())
        np.testing.assert_allclose(at.normal[k], J.T @ J, rtol=1e-5, atol=1e-6 * np.abs(J.T @ J).max())


def truth(residues="complex"):
    """Two modes with frequencies of their own, without noise, and a window of their responses."""
    shapes = np.array([[1.0, -0.6, 0.8, 0.4, 0.3, -0.7], [-0.5, 0.9, 0.7, -1.0, 0.6, 0.2]])
    shapes = shapes * (1.0 if residues == "real" else 1.0 - 0.4j)
    data = window(residues, power=1, lines=np.arange(90.0, 112.0, 0.2))
    modes = Modes(FREQ, np.array([0.02, 0.03]), shapes)
    H = modes.response(data, SETUPS)
    return modes, Window(freq=data.freq, Y=np.vstack([H.real, H.imag]), power=1, residues=residues, weight=data.weight,
                         floor=0.0, along=data.along)  # fmt: skip


def test_the_response_of_modes_is_weighted_and_in_hertz():
    modes, data = truth()
    for k, channels in enumerate(SETUPS):
        f = data.freq[:, None]
        g = 1j * f * FREQ[:, k] ** 2 / (FREQ[:, k] ** 2 - f**2 + 2j * modes.zeta * FREQ[:, k] * f)
        want = g @ modes.residues[:, channels] * (channels + 1.0)
        np.testing.assert_allclose(data.as_complex[:, channels], want, rtol=1e-10)
    last = modes.some(np.array([1]))
    assert (last.freq.tolist(), last.zeta.tolist()) == ([FREQ[1].tolist()], [0.03])
    np.testing.assert_array_equal(last.residues, modes.residues[1:])


@pytest.mark.parametrize("residues", ["real", "complex"])
@pytest.mark.parametrize("fit", [apart, linked])
def test_exact_data_give_exact_modes_and_the_variance_of_their_information(residues, fit):
    modes, data = truth(residues)
    own = fit(data, SETUPS, FREQ * 1.002, np.array([0.021, 0.027]), 0.5, (92.0, 110.0))
    np.testing.assert_allclose(own.freq, FREQ, rtol=1e-7)
    np.testing.assert_allclose(own.zeta, np.repeat([[0.02], [0.03]], 3, axis=1), rtol=1e-5)
    np.testing.assert_allclose(own.residues, modes.residues * data.weight * data.scale, rtol=1e-5)
    assert squares_at(data, SETUPS, FREQ, modes.zeta) < 1e-12 * np.sum(data.Y**2)
    assert squares_at(data, SETUPS, FREQ[:0], modes.zeta[:0]) == pytest.approx(np.sum(across(data, data.Y) ** 2))
    information = []
    for k, channels in enumerate(SETUPS):  # without noise that is J^T J, of each set-up
        theta, h, none = np.log(np.r_[FREQ[:, k], modes.zeta]), 1e-5, np.zeros(2 * data.columns)
        both = [[residual(data, channels, theta + s * h * e, none) for s in (1, -1)] for e in np.eye(4)]
        J = np.column_stack([(up - down) / (2 * h) for up, down in both])
        information.append(J.T @ J)
    if fit is apart:
        want = np.array([0.5 * np.diag(np.linalg.inv(each)) for each in information]).T
        np.testing.assert_allclose(np.vstack([own.variance, own.zeta_variance]), want, rtol=1e-4)
        return
    whole, index = np.zeros((8, 8)), [[k, 3 + k, 6, 7] for k in range(3)]
    for each, at in zip(information, index, strict=True):
        whole[np.ix_(at, at)] += each
    want = 0.5 * np.diag(np.linalg.inv(whole))
    np.testing.assert_allclose(own.variance, want[:6].reshape(2, 3), rtol=1e-4)
    np.testing.assert_allclose(own.zeta_variance, np.repeat(want[6:, None], 3, axis=1), rtol=1e-4)


def test_modes_in_another_order_keep_what_belongs_to_them():
    rng = np.random.default_rng(6)
    four = rng.uniform(size=(4, 2, 3))
    own = OwnPeaks(*four, rng.uniform(size=(2, 6)) + 0j, 3.0, 0.7)
    turned = own.ordered([np.array([0, 1]), np.array([1, 0]), np.array([1, 0])], SETUPS)
    for now, before in zip(turned[:4], four, strict=True):
        np.testing.assert_array_equal(now[:, 0], before[:, 0])
        np.testing.assert_array_equal(now[:, 1:], before[::-1, 1:])
    np.testing.assert_array_equal(turned.residues[:, SETUPS[0]], own.residues[:, SETUPS[0]])
    np.testing.assert_array_equal(turned.residues[:, [1, 3, 5]], own.residues[::-1, [1, 3, 5]])
    assert turned[5:] == (3.0, 0.7)
