"""Fit of modes whose shapes are waves round a circle, but for what each channel is off.

Where two members of a pair meet in a set-up, their residues there are hardly known, and so are their frequencies. But
the residues of a mode k of n nodal diameters are, in all set-ups,

    Re A_kc = w_c . x_k + s_k off_c e,   Im A_kc = s_k lag_c e',   e, e' ~ N(0, 1),

w_c the columns cos n theta and sin n theta, s_k its size, off_c and lag_c what channel c shows in most modes; ln f of a
set-up is off the mode's mean by the usual shift. With G = Phi^T Phi, b = Phi^T y of a channel, L the noise over the
variances of A, E x their means, H = (G + L)^-1 and A = H (b + L E x) eliminated, x from N x = r,

    squares = |y|^2 - b^T H b - r^T x,   N = sum E^T (L - L H L) E + prior,   r = sum E^T L H b.

Slopes by the poles are those of |y - Phi A|^2 at the best A and x; both are eliminated from the equations of Gauss and
Newton, too. All comes from inner products over the lines, as in `own_shifts.py`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

STEPS = 25
SETTLED = 0.1  # of the noise's variance: a gain that ends the fit
STEEP = 1e6  # damping of the steps that ends it, too
TRUST = 1.0, 0.7  # largest step: half-power half-widths, ln zeta
ZETA = 1e-6, 0.3
SURE = 0.03  # of a mode's size, that a channel is off a wave at least
WIDE = 3.0  # times the size of a mode, that the parts of its wave, or residues without a wave, may well be


class Waves(NamedTuple):
    """Columns (kinds, channels, columns) of each n, zeros for kinds that are no wave; what channels are off.

    `off` and `lag` (kinds, channels) are the standard deviations of real and imaginary parts over the mode's size.
    """

    columns: FloatArray
    off: FloatArray
    lag: FloatArray

    @property
    def is_wave(self) -> BoolArray:
        """Which kinds are waves, (kinds,)."""
        return np.asarray(self.columns.any(axis=(1, 2)))

    def seen_by(self, channels: IntArray) -> Waves:
        """With one more kind, the last: a local mode that so many channels see, the others next to nothing of it."""
        spread = np.full(self.columns.shape[1], SURE)
        spread[channels] = WIDE
        columns = np.concatenate([self.columns, np.zeros((1, *self.columns.shape[1:]))])
        return Waves(columns, np.vstack([self.off, spread]), np.vstack([self.lag, spread]))


class WaveProblem(NamedTuple):
    """A cluster's data, the weight of each channel's residues, what is known of shapes, and the usual shift."""

    cluster: Cluster
    data: Problem
    weight: FloatArray
    waves: Waves
    shift: float

    def products(self, p: FloatArray, q: FloatArray) -> Products:
        """At ln f and ln zeta, both (modes, setups)."""
        return Products(p, *self.data.products(p, q))


class Products(NamedTuple):
    """Inner products of resonances and slopes with each other and with the data, at ln f (modes, setups)."""

    p: FloatArray
    own: FloatArray
    by_data: FloatArray


class Shapes(NamedTuple):
    """The kind of wave that each mode is, and its size, both (modes,)."""

    kind: IntArray
    size: FloatArray


class WaveFit(NamedTuple):
    """Poles, squares left (deviations from waves and from usual shifts among them), -2 ln of the likelihood.

    `residues` (modes, channels) are weighted; `x` (modes, columns); `normal`, `gradient` of (ln f, set-up by set-up for
    each mode, then ln zeta).
    """

    p: FloatArray
    q: FloatArray
    squares: float
    unlikely: float
    residues: Array
    x: FloatArray
    normal: FloatArray
    gradient: FloatArray

    def covariance(self, noise: float) -> FloatArray:
        """Of (ln f, ln zeta)."""
        return np.asarray(noise * np.linalg.pinv(self.normal, hermitian=True))


def fitted(problem: WaveProblem, shapes: Shapes, p: FloatArray, q: FloatArray, steps: int = STEPS) -> WaveFit:
    """Levenberg-Marquardt from a start ln f (modes, setups), ln zeta (modes,)."""
    at, damping = wave_fit(problem, shapes, p, q), 1e-3
    for _ in range(steps):
        new = _step(problem, shapes, at, damping)
        gain = at.squares - new.squares
        if gain >= 0.0:
            at, damping = new, 0.2 * damping
            if gain < SETTLED * problem.cluster.noise:
                break
        else:
            damping *= 8.0
            if damping > STEEP:
                break
    return at


def wave_fit(problem: WaveProblem, shapes: Shapes, p: FloatArray, q: FloatArray) -> WaveFit:
    """Everything at one set of poles."""
    return solved(problem, shapes, problem.products(p, np.repeat(q[:, None], p.shape[1], axis=1)), q)


def _step(problem: WaveProblem, shapes: Shapes, at: WaveFit, damping: float) -> WaveFit:
    """One damped step within the trust limits, peaks within the cluster's span and near each other."""
    size = np.diag(at.normal)
    step = -np.linalg.solve(at.normal + np.diag(damping * size + 1e-12 * size.max() + 1e-300), at.gradient)
    m, count = at.p.shape
    limit = TRUST[0] * np.exp(at.q)[:, None]
    p = at.p + np.clip(step[: m * count].reshape(m, count), -limit, limit)
    p, middle = np.clip(p, *np.log(problem.cluster.span)), np.median(p, axis=1, keepdims=True)
    p = np.clip(p, middle - problem.cluster.apart, middle + problem.cluster.apart)
    q = np.clip(at.q + np.clip(step[m * count :], -TRUST[1], TRUST[1]), *np.log(ZETA))
    return wave_fit(problem, shapes, p, q)


class _Drawn(NamedTuple):
    """Residues eliminated at some poles: waves x from N x, and of each set-up (H, H b, H L E)."""

    squares: float
    unlikely: float
    N: FloatArray
    x: FloatArray
    parts: list[tuple[FloatArray, FloatArray, FloatArray]]


def unlikely_at(problem: WaveProblem, shapes: Shapes, at: Products) -> float:
    """-2 ln of the likelihood at some poles, alone."""
    return _drawn(problem, shapes, at).unlikely


def solved(problem: WaveProblem, shapes: Shapes, at: Products, q: FloatArray) -> WaveFit:
    """Residues and waves at some poles, and the equations of the next step."""
    (m, count), s = at.p.shape, problem.data.window.columns
    width = problem.waves.columns.shape[2]
    own, turns = slice(0, m * s), slice(m * s, None)
    squares, unlikely, N, x, parts = _drawn(problem, shapes, at)
    size = m * count + m
    normal, gradient, cross = np.zeros((size, size)), np.zeros(size), np.zeros((size, m * width))
    residues = np.zeros((m, problem.data.window.Y.shape[1]), complex)
    for k, (channels, (H, free, drawn)) in enumerate(zip(problem.data.setups, parts, strict=True)):
        A = free + drawn @ x
        each = A.reshape(len(A), m, s)
        residues[:, channels] = (each[:, :, 0] + (1j * each[:, :, 1] if s == 2 else 0.0)).T
        moved = np.concatenate([each, each], axis=1).reshape(len(A), -1)  # residues that belong to each slope
        slopes, across = at.own[k][turns, turns], at.own[k][turns, own]
        left = at.by_data[k][turns, : len(A)].T - A @ across.T
        V = (moved[:, :, None] * across).reshape(len(A), 2 * m, s, m * s).sum(axis=2)
        turned = V @ H
        told = (slopes * (moved.T @ moved)).reshape(2 * m, s, 2 * m, s).sum(axis=(1, 3))
        told -= np.tensordot(turned, V, axes=([0, 2], [0, 2]))
        here = np.r_[np.arange(m) * count + k, m * count + np.arange(m)]
        normal[np.ix_(here, here)] += told
        gradient[here] -= (left * moved).reshape(-1, 2 * m, s).sum(axis=(0, 2))
        cross[here] += np.tensordot(V, drawn, axes=([0, 2], [0, 1]))
    normal -= cross @ np.linalg.solve(N, cross.T)
    off, pull = _pull(problem, at)
    gradient[: m * count] += pull * off.ravel()
    normal[: m * count, : m * count] += pull * np.kron(np.eye(m), np.eye(count) - 1.0 / count)
    return WaveFit(at.p, q, squares, unlikely, residues, np.asarray(x.reshape(m, width), np.float64), normal, gradient)


def _drawn(problem: WaveProblem, shapes: Shapes, at: Products) -> _Drawn:
    """Residues and waves at some poles."""
    m, s, noise = len(at.p), problem.data.window.columns, problem.cluster.noise
    own, width, setups = slice(0, m * s), problem.waves.columns.shape[2], problem.data.setups
    prior = np.repeat(noise / (WIDE * shapes.size) ** 2, width)
    counts = [len(channels) for channels in setups]
    whole = np.repeat(at.own[:, own, own], counts, axis=0)
    b = np.concatenate([by[own, :many].T for by, many in zip(at.by_data, counts, strict=True)])
    L, E = _expected(problem, shapes, np.concatenate(setups))
    whole[:, np.arange(m * s), np.arange(m * s)] += L
    H, pull_to = np.linalg.inv(whole), L[:, :, None] * E
    free, drawn = (H @ b[:, :, None])[:, :, 0], H @ pull_to
    rows = len(prior)
    flat = pull_to.reshape(-1, rows)
    N = np.diag(prior) + (E - drawn).reshape(-1, rows).T @ flat
    r = flat.T @ free.ravel()
    x = np.linalg.solve(N, r)
    off, pull = _pull(problem, at)
    squares = float(problem.data.squares.sum() - np.sum(b * free) + pull * np.sum(off**2) - r @ x)
    apart = np.linalg.slogdet(whole)[1].sum() - np.log(L).sum() + np.linalg.slogdet(N)[1] - np.log(prior).sum()
    cuts = np.cumsum(counts)[:-1]
    parts = list(zip(*(np.split(each, cuts) for each in (H, free, drawn)), strict=True))
    return _Drawn(squares, squares / noise + float(apart), N, x, parts)


def _pull(problem: WaveProblem, at: Products) -> tuple[FloatArray, float]:
    """What ln f of each set-up is off the mode's mean, and what that costs."""
    pull = problem.cluster.noise / problem.shift**2 if at.p.shape[1] > 1 else 0.0
    return at.p - at.p.mean(axis=1, keepdims=True), pull


def _expected(problem: WaveProblem, shapes: Shapes, channels: IntArray) -> tuple[FloatArray, FloatArray]:
    """The noise over the variances of residues (channels, modes x parts), and the means E of x."""
    waves, m, s = problem.waves, len(shapes.kind), problem.data.window.columns
    spread = np.stack([waves.off, waves.lag][:s], axis=2)[shapes.kind][:, channels].transpose(1, 0, 2)
    weight = problem.weight[channels]
    L = problem.cluster.noise / (spread * shapes.size[:, None] * weight[:, None, None]) ** 2
    columns = waves.columns[shapes.kind][:, channels] * weight[:, None]
    E = np.zeros((len(channels), m, s, m, columns.shape[2]))
    E[:, np.arange(m), 0, np.arange(m)] = columns.transpose(1, 0, 2)
    return L.reshape(len(channels), m * s), E.reshape(len(channels), m * s, -1)
