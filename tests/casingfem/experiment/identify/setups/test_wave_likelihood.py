"""The likelihood of modes that are waves, against the Gaussian of all data at once; its steps; what waves are."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import (
    WaveRead,
    _step,
    as_one_wave,
    fitted,
    kinds_alone,
    likely_kinds,
    pairs_near,
    sized,
    wave_fit,
)
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem, Waves
from casingfem.experiment.identify.setups.wave_residues import unlikely_at

LINES = np.arange(95.0, 105.0, 0.4)
SETUPS = [np.array([4, 0, 6]), np.array([1, 2]), np.array([3, 5])]
CHANNELS = 7
WEIGHT = np.linspace(0.8, 1.7, CHANNELS)
FREQ = np.array([[99.0, 99.2, 98.9], [101.0, 100.8, 101.3]])
ZETA = np.array([0.012, 0.02])
NOISE, SHIFT = 0.04, 2e-3
THETA = np.radians([2.0, 50.0, 110.0, 155.0, 200.0, 260.0, 310.0])
KIND, SIZE = np.array([1, 0]), np.array([0.7, 0.4])


def waves():
    """n = 1, n = 2, and a kind that is no wave."""
    rng = np.random.default_rng(31)
    columns = [np.column_stack([np.cos(n * THETA), np.sin(n * THETA)]) for n in (1, 2)]
    off, lag = rng.uniform(0.05, 0.4, (2, 3, CHANNELS))
    return Waves(np.array([*columns, np.zeros((CHANNELS, 2))]), off, lag)


def problem(residues="complex", noise=NOISE):
    rng = np.random.default_rng(32)
    empty = Window(freq=LINES, Y=np.zeros((2 * len(LINES), CHANNELS)), power=1, residues=residues, weight=WEIGHT,
                   floor=0.0, along=np.ones(len(LINES)))  # fmt: skip
    turns = np.array([0.7 * np.cos(2 * THETA - 0.4), 0.4 * np.sin(THETA + 0.3)])
    modes = Modes(
        FREQ, ZETA, turns * np.exp(0.1j * (residues == "complex") * rng.standard_normal((2, CHANNELS))) / 100.0
    )
    H = modes.response(empty, SETUPS)
    H = H + np.sqrt(NOISE) * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    data = Window(freq=LINES, Y=np.vstack([H.real, H.imag]), power=1, residues=residues, weight=WEIGHT, floor=0.0,
                  along=empty.along)  # fmt: skip
    c = Cluster(modes, data, (96.0, 104.0), noise, 0.01)
    return WaveProblem(c, Problem.of(data, SETUPS), WEIGHT, waves(), SHIFT)


def across(data, columns):
    Q = np.linalg.qr(data.residuals())[0]
    return columns - Q @ (Q.T @ columns)


def gaussian(whole, kind, size, p, q):
    """Data, columns, residues' means by the waves, variances of both, channel after channel as set-ups have them."""
    data, s = whole.cluster.window, whole.cluster.window.columns
    y, peaks, D = [], [], []
    for k, channels in enumerate(SETUPS):
        columns = across(data, data.resonances(np.exp(p[:, k]), np.exp(q)))
        for c in channels:
            y.append(across(data, data.Y[:, [c]])[:, 0])
            peaks.append(columns)
            mean = np.zeros((2 * s, 4))
            for mode in range(2):
                mean[mode * s, 2 * mode : 2 * mode + 2] = WEIGHT[c] * whole.waves.columns[kind[mode], c]
            D.append(mean)
    order = np.concatenate(SETUPS)
    parts = np.stack([whole.waves.off[kind], whole.waves.lag[kind]][:s], axis=2)[:, order]  # modes, channels, parts
    S = (parts * size[:, None, None] * WEIGHT[order][:, None]).swapaxes(0, 1).reshape(CHANNELS, -1) ** 2
    lines = len(y[0])
    blocks = np.zeros((CHANNELS * lines, CHANNELS * 2 * s))
    for c in range(CHANNELS):
        blocks[c * lines : (c + 1) * lines, c * 2 * s : (c + 1) * 2 * s] = peaks[c]
    return np.concatenate(y), blocks, np.vstack(D), S.ravel(), np.repeat((3.0 * size) ** 2, 2)


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_likelihood_residues_and_waves_are_those_of_the_gaussian_of_all_data(residues):
    whole = problem(residues)
    p, q = np.log(FREQ) + 2e-4, np.log(ZETA) + 0.05
    y, seen, D, S, P = gaussian(whole, KIND, SIZE, p, q)
    prior = np.diag(S) + D @ np.diag(P) @ D.T
    C = whole.cluster.noise * np.eye(len(y)) + seen @ prior @ seen.T
    solved, off = np.linalg.solve(C, y), p - p.mean(axis=1, keepdims=True)
    left = float(y @ solved) + np.sum(off**2) / SHIFT**2
    log_det = np.linalg.slogdet(C)[1] - len(y) * np.log(whole.cluster.noise)
    shapes = Shapes(KIND, SIZE)
    fit = wave_fit(whole, shapes, p, q)
    assert fit.squares == pytest.approx(whole.cluster.noise * left, rel=1e-8)
    assert fit.unlikely == pytest.approx(left + log_det, rel=1e-8)
    assert unlikely_at(whole, shapes, whole.products(p, q)) == pytest.approx(left + log_det, rel=1e-8)
    A = (prior @ seen.T @ solved).reshape(CHANNELS, 2, -1)
    A = A[:, :, 0] + (1j * A[:, :, 1] if residues == "complex" else 0.0)
    np.testing.assert_allclose(fit.residues[:, np.concatenate(SETUPS)], A.T, rtol=1e-6)
    np.testing.assert_allclose(fit.x.ravel(), np.diag(P) @ D.T @ seen.T @ solved, rtol=1e-6)


def one_setup(whole):
    """All channels in one set-up, whose frequencies cannot be off their mean."""
    return whole._replace(data=Problem.of(whole.cluster.window, [np.arange(CHANNELS)]))


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_slopes_and_equations_of_a_step(residues):
    """The gradient by differences; the equations as those of all unknowns, residues and waves eliminated."""
    whole, shapes = problem(residues), Shapes(KIND, SIZE)
    p, q, h = np.log(FREQ) + 3e-4, np.log(ZETA) + 0.05, 1e-5
    at = wave_fit(whole, shapes, p, q)
    theta = np.r_[p.ravel(), q]
    for k, e in enumerate(np.eye(8)):
        up, down = (wave_fit(whole, shapes, t[:6].reshape(2, 3), t[6:]).squares for t in (theta + h * e, theta - h * e))
        assert 2.0 * at.gradient[k] == pytest.approx(
            (up - down) / (2 * h), rel=2e-5, abs=2e-5 * np.abs(at.gradient).max()
        )
    y, seen, D, S, P = gaussian(whole, KIND, SIZE, p, q)
    noise, s = whole.cluster.noise, whole.cluster.window.columns
    A = at.residues[:, np.concatenate(SETUPS)].T
    A = np.stack([A.real, A.imag][:s], axis=2).ravel()
    moved = np.zeros((len(y), 8))
    for k in range(3):
        steps = [(mode * 3 + k, np.eye(2)[mode], np.zeros(2)) for mode in range(2)]
        steps += [(6 + mode, np.zeros(2), np.eye(2)[mode]) for mode in range(2)]
        for column, by_p, by_q in steps:
            shift = np.zeros((2, 3))
            shift[:, k] = by_p
            both = [gaussian(whole, KIND, SIZE, p + t * shift, q + t * by_q)[1] @ A for t in (h, -h)]
            moved[:, column] = -(both[0] - both[1]) / (2 * h)
    middle = np.kron(np.eye(2), np.eye(3) - 1.0 / 3.0) * np.sqrt(noise) / SHIFT
    top = np.hstack([moved, -seen, np.zeros((len(y), 4))])
    held = np.sqrt(noise / S)[:, None]
    tied = np.hstack([np.zeros((len(S), 8)), np.eye(len(S)) * held, -D * held])
    wide = np.hstack([np.zeros((4, 8 + len(S))), np.diag(np.sqrt(noise / P))])
    pull = np.hstack([middle, np.zeros((6, 2 + len(S) + 4))])
    J = np.vstack([top, tied, wide, pull])
    linear, own = J[:, 8:], J[:, :8]
    own = own - linear @ np.linalg.lstsq(linear, own, rcond=None)[0]
    np.testing.assert_allclose(at.normal, own.T @ own, rtol=1e-5, atol=1e-7 * at.normal.max())
    np.testing.assert_allclose(at.covariance(2.0), 2.0 * np.linalg.inv(own.T @ own), rtol=1e-4, atol=1e-12)


def test_in_one_set_up_nothing_pulls_at_a_frequency():
    whole, shapes = one_setup(problem()), Shapes(KIND, SIZE)
    near, far = (
        wave_fit(whole._replace(shift=shift), shapes, np.log(FREQ[:, :1]), np.log(ZETA)) for shift in (1e-9, 1.0)
    )
    assert near.squares == far.squares
    np.testing.assert_array_equal(near.normal, far.normal)


def test_a_step_stays_within_half_a_bandwidth_the_span_and_the_others():
    whole, shapes = problem(), Shapes(KIND, SIZE)
    at = wave_fit(whole, shapes, np.log(FREQ * 1.05), np.log(ZETA))
    size = np.diag(at.normal)
    wanted = -np.linalg.solve(at.normal + 1e-3 * np.diag(size), at.gradient)
    new = _step(whole, shapes, at, 1e-3)
    limit = ZETA[:, None] * np.ones(3)
    p = np.clip(at.p + np.clip(wanted[:6].reshape(2, 3), -limit, limit), np.log(96.0), np.log(104.0))
    middle = np.median(p, axis=1, keepdims=True)
    np.testing.assert_allclose(new.p, np.clip(p, middle - 0.01, middle + 0.01), rtol=1e-9)
    np.testing.assert_allclose(new.q, at.q + np.clip(wanted[6:], -0.7, 0.7), rtol=1e-9)
    assert np.abs(wanted[:6]).max() > ZETA.min()


def test_a_fit_ends_where_no_pole_lowers_the_squares_and_a_hopeless_one_early():
    whole, shapes = problem(), Shapes(KIND, SIZE)
    start = np.log(FREQ * (1.0 + np.array([[1e-3], [-1e-3]]))), np.log(ZETA * 1.3)
    end = fitted(whole, shapes, *start)
    assert np.abs(end.gradient @ np.linalg.solve(end.normal, end.gradient)) < 0.1 * NOISE
    first = fitted(whole, shapes, *start, 1)
    given_up = fitted(whole, shapes, *start, hopeless=-1e9)
    np.testing.assert_array_equal(given_up.p, first.p)  # the first step is made
    np.testing.assert_array_equal(fitted(whole, shapes, *start, hopeless=1e9).p, end.p)
    np.testing.assert_array_equal(fitted(whole, shapes, *start, 0).p, start[0])


def test_kinds_of_waves_that_channels_are_off_by_the_same_share_a_number():
    off = np.array([[1.0, 2.0], [1.0, 2.0], [1.0, 3.0], [1.0, 2.0]])
    lag = np.array([[5.0, 2.0], [5.0, 2.0], [5.0, 2.0], [6.0, 2.0]])
    kinds = Waves(np.array([np.eye(2), np.zeros((2, 2)), [[0, 0], [0, 1.0]], np.eye(2)]), off, lag)
    assert kinds.spread.tolist() == [0, 0, 1, 2]
    assert kinds.is_wave.tolist() == [True, False, True, True]
    more = kinds.seen_by(np.array([1]))
    assert more.is_wave.tolist() == [True, False, True, True, False]
    assert more.off[-1].tolist() == more.lag[-1].tolist() == [0.03, 3.0]
    assert (more.columns.shape, more.off.shape) == ((5, 2, 2), (5, 2))


def test_the_kind_of_a_mode_by_its_residues_alone():
    whole = problem()
    assert kinds_alone(whole).tolist() == KIND.tolist()
    heard = whole.waves._replace(off=np.where(np.arange(CHANNELS) < 4, 1.0, 1e9) * np.ones((3, 1)))
    spoilt = whole.cluster.modes.residues.copy()
    spoilt[:, 4:] = 5.0
    modes = whole.cluster.modes._replace(residues=spoilt)
    assert kinds_alone(whole._replace(waves=heard, cluster=whole.cluster._replace(modes=modes))).tolist() == [1, 0]


def test_kinds_become_the_likeliest_and_some_may_have_to_be_waves():
    whole, p, q = problem(), np.log(FREQ), np.log(ZETA)
    at = whole.products(p, q)
    assert likely_kinds(whole, Shapes(np.array([0, 1]), SIZE), at, q).kind.tolist() == [1, 0]
    only = likely_kinds(whole, Shapes(np.array([0, 1]), SIZE), at, q, np.array([1]))
    assert only.kind.tolist() == [0, 0]
    each = [unlikely_at(whole, Shapes(np.array([kind, kind]), SIZE), at) for kind in (0, 1)]
    assert (
        as_one_wave(whole, Shapes(np.array([2, 2]), SIZE), at, np.array([0, 1])).kind.tolist() == [np.argmin(each)] * 2
    )


def test_modes_take_the_size_of_their_waves_or_residues_within_a_factor_of_ten():
    whole, p, q = problem(), np.log(FREQ), np.log(ZETA)
    read = WaveRead(Shapes(KIND, SIZE), wave_fit(whole, Shapes(KIND, SIZE), p, q))
    found = sized(whole, read, SIZE)
    means = [whole.waves.columns[kind] @ x for kind, x in zip(KIND, read.fit.x, strict=True)]
    np.testing.assert_allclose(found.shapes.size, [np.sqrt(np.mean(mean**2)) for mean in means], rtol=1e-12)
    free = Shapes(np.array([1, 2]), SIZE)
    alone = WaveRead(free, wave_fit(whole, free, p, q))
    size = np.sqrt(np.mean(np.abs(alone.fit.residues[1] / WEIGHT) ** 2))
    assert sized(whole, alone, SIZE).shapes.size[1] == pytest.approx(size, rel=1e-12)
    held = sized(whole, read, np.array([100.0, 1e-3]))
    np.testing.assert_allclose(held.shapes.size, [10.0, 1e-2], rtol=1e-12)


def test_pairs_are_near_by_the_wider_of_both():
    whole = problem()
    p = np.log(100.0) + np.array([[0.0, 0.0, 0.0], [0.1, 4 * SHIFT + 0.039, 0.2], [1.0, 1.0, 1.0]])
    assert pairs_near(whole, p, np.log([0.01, 0.02, 0.01])) == [(0, 1)]
    assert pairs_near(whole, p, np.log([0.01, 0.019, 0.01])) == []
