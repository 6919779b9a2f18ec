"""Fit of modes whose shapes are waves round a circle, but for what each channel is off, and which wave each is.

Where two members of a pair meet in a set-up, their residues there are hardly known, and so are their frequencies. But
the residues of a mode k of n nodal diameters are, in all set-ups,

    Re A_kc = w_c . x_k + s_k off_c e,   Im A_kc = s_k lag_c e',   e, e' ~ N(0, 1),

w_c the columns cos n theta and sin n theta, s_k its size, off_c and lag_c what channel c shows in most modes; ln f of a
set-up is off the mode's mean by the usual shift. Residues A and waves x are eliminated (`wave_residues.py`).

Slopes by the poles are those of |y - Phi A|^2 at the best A and x; both are eliminated from the equations of Gauss and
Newton, too. All comes from inner products over the lines, as in `own_shifts.py`.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.own_shifts import near_each_other
from casingfem.experiment.identify.setups.wave_model import Products, Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_residues import (
    drawn_to,
    eliminated,
    means,
    pulled,
    squares_held,
    unlikely_at,
    unlikely_kinds,
)
from casingfem.io.arrays import Array, FloatArray, IntArray

STEPS = 25
SETTLED = 0.1  # of the noise's variance: a gain that ends the fit
STEEP = 1e6  # damping of the steps that ends it, too
TRUST = 1.0, 0.7  # largest step: half-power half-widths, ln zeta
ZETA = 1e-6, 0.3
NEAR = 4.0  # usual shifts beyond a bandwidth, within which two modes may be exchanged
GAIN = 2.0  # fall of -2 ln of the likelihood that counts
GROWN = 10.0  # times its first size, that a mode is taken for at most, or the inverse


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


def fitted(
    problem: WaveProblem, shapes: Shapes, p: FloatArray, q: FloatArray, steps: int = STEPS, hopeless: float = np.inf
) -> WaveFit:
    """Levenberg-Marquardt from a start ln f (modes, setups), ln zeta (modes,); none goes on where it is `hopeless`."""
    at, damping = wave_fit(problem, shapes, p, q), 1e-3
    for done in range(steps):
        if done and at.unlikely > hopeless:
            break
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
    return solved(problem, shapes, problem.products(p, q), q)


def _step(problem: WaveProblem, shapes: Shapes, at: WaveFit, damping: float) -> WaveFit:
    """One damped step within the trust limits, peaks within the cluster's span and near each other."""
    size = np.diag(at.normal)
    step = -np.linalg.solve(at.normal + np.diag(damping * size + 1e-12 * size.max() + 1e-300), at.gradient)
    m, count = at.p.shape
    limit = TRUST[0] * np.exp(at.q)[:, None]
    p = at.p + np.clip(step[: m * count].reshape(m, count), -limit, limit)
    p = near_each_other(np.clip(p, *np.log(problem.cluster.span)), problem.cluster.apart)
    q = np.clip(at.q + np.clip(step[m * count :], -TRUST[1], TRUST[1]), *np.log(ZETA))
    return wave_fit(problem, shapes, p, q)


def solved(problem: WaveProblem, shapes: Shapes, at: Products, q: FloatArray) -> WaveFit:
    """Residues and waves at some poles, and the equations of the next step."""
    (m, count), s = at.p.shape, problem.data.window.columns
    rest = eliminated(problem, shapes, at)
    N, r, prior = means(problem, shapes, rest)
    x = np.linalg.solve(N, r)
    squares = squares_held(problem, at, rest) - float(r @ x)
    apart = rest.logs.sum() + np.linalg.slogdet(N)[1] - np.log(prior).sum()
    D, real = drawn_to(problem, shapes.kind), slice(0, m * s, s)
    toward = ((rest.H[:, :, real] * rest.L[:, None, real])[:, :, :, None] * D[:, None]).reshape(*rest.free.shape, -1)
    A = rest.free + toward @ x
    each = A.reshape(len(A), m, s)
    residues = np.zeros((m, len(A)), complex)
    residues[:, problem.order] = (each[:, :, 0] + (1j * each[:, :, 1] if s == 2 else 0.0)).T
    size = m * count + m
    normal, gradient, cross = np.zeros((size, size)), np.zeros(size), np.zeros((size, len(r)))
    ends = np.cumsum(problem.counts)
    for k, (start, end) in enumerate(zip(ends - problem.counts, ends, strict=True)):
        some = _Slopes.of(at.own[k], at.by_data[k], A[start:end], rest.H[start:end], toward[start:end], m, s)
        here = np.r_[np.arange(m) * count + k, m * count + np.arange(m)]
        normal[np.ix_(here, here)] += some.normal
        gradient[here] += some.gradient
        cross[here] += some.cross
    normal -= cross @ np.linalg.solve(N, cross.T)
    off, pull = pulled(problem, at)
    gradient[: m * count] += pull * off.ravel()
    normal[: m * count, : m * count] += pull * np.kron(np.eye(m), np.eye(count) - 1.0 / count)
    unlikely = squares / problem.cluster.noise + float(apart)
    return WaveFit(at.p, q, squares, unlikely, residues, np.asarray(x.reshape(m, -1)), normal, gradient)


class _Slopes(NamedTuple):
    """Of one set-up, for (ln f, ln zeta): the equations with residues eliminated, and what ties them to the waves."""

    normal: FloatArray
    gradient: FloatArray
    cross: FloatArray

    @classmethod
    def of(
        cls, own: FloatArray, by_data: FloatArray, A: FloatArray, H: FloatArray, toward: FloatArray, m: int, s: int
    ) -> _Slopes:
        """From inner products, and of its channels residues, H, and where waves draw residues to."""
        turns, channels = slice(m * s, None), len(A)
        moved = np.concatenate([A, A], axis=1)  # residues that belong to each slope
        across = own[turns, : m * s]
        left = by_data[turns, :channels].T - A @ across.T
        V = (moved[:, :, None] * across).reshape(channels, 2 * m, s, m * s).sum(axis=2)
        flat, turned = (each.swapaxes(0, 1).reshape(2 * m, -1) for each in (V, V @ H))
        told = (own[turns, turns] * (moved.T @ moved)).reshape(2 * m, s, 2 * m, s).sum(axis=(1, 3))
        gradient = -(left * moved).reshape(channels, 2 * m, s).sum(axis=(0, 2))
        return cls(told - turned @ flat.T, gradient, flat @ toward.reshape(channels * m * s, -1))


class WaveRead(NamedTuple):
    """Kinds and sizes of the modes of a cluster, and the fit with them."""

    shapes: Shapes
    fit: WaveFit


def kinds_alone(problem: WaveProblem) -> IntArray:
    """The kind of each mode by its residues alone."""
    waves, residues = problem.waves, problem.cluster.modes.residues.real
    rest = []
    for kind in np.flatnonzero(waves.is_wave):
        Q, scaled = np.linalg.qr(waves.columns[kind] / waves.off[kind][:, None])[0], residues / waves.off[kind]
        rest.append(np.sum((scaled - (scaled @ Q) @ Q.T) ** 2, axis=1))
    return np.asarray(np.flatnonzero(waves.is_wave)[np.argmin(rest, axis=0)])


def likely_kinds(
    problem: WaveProblem, shapes: Shapes, at: Products, q: FloatArray, some: IntArray | None = None
) -> Shapes:
    """Kinds of waves that are more likely at some poles: of single modes, then of neighbours; or of `some` alone."""
    rest = eliminated(problem, shapes, at)
    best = unlikely_at(problem, shapes, at, rest)
    every = [*((k,) for k in range(len(q))), *pairs_near(problem, at.p, q)] if some is None else [some]
    for which in (np.array(each) for each in every):
        unlikely = unlikely_kinds(problem, shapes, at, rest, which)
        if unlikely.min() < best - GAIN:
            best, kind = float(unlikely.min()), shapes.kind.copy()
            kind[which] = unlikely.argmin()
            shapes = shapes._replace(kind=kind)
            rest = eliminated(problem, shapes, at)
    return shapes


def as_one_wave(problem: WaveProblem, shapes: Shapes, at: Products, some: IntArray) -> Shapes:
    """Some modes as waves of one kind, the likeliest at some poles."""
    unlikely = unlikely_kinds(problem, shapes, at, eliminated(problem, shapes, at), some)
    kind = shapes.kind.copy()
    kind[some] = np.where(problem.waves.is_wave, unlikely, np.inf).argmin()
    return shapes._replace(kind=kind)


def pairs_near(problem: WaveProblem, p: FloatArray, q: FloatArray) -> list[tuple[int, int]]:
    """Modes so near each other that one may be taken for the other in a set-up."""
    reach = NEAR * problem.shift
    pairs = combinations(range(len(q)), 2)
    return [(a, b) for a, b in pairs if np.abs(p[a] - p[b]).min() < reach + 2.0 * np.exp(q[[a, b]]).max()]


def sized(problem: WaveProblem, read: WaveRead, first: FloatArray) -> WaveRead:
    """Fitted again with the sizes and kinds that modes turn out to have."""
    shapes, fit = read
    means = np.einsum("kcw,kw->kc", problem.waves.columns[shapes.kind], fit.x)
    size = np.where(problem.waves.is_wave[shapes.kind], rms(means), rms(fit.residues / problem.weight))
    shapes = shapes._replace(size=np.clip(size, first / GROWN, first * GROWN))
    shapes = likely_kinds(problem, shapes, problem.products(fit.p, fit.q), fit.q)
    return WaveRead(shapes, fitted(problem, shapes, fit.p, fit.q))


def rms(parts: Array) -> FloatArray:
    """Over the channels of each mode (modes, channels)."""
    return np.asarray(np.sqrt(np.mean(np.abs(parts) ** 2, axis=1)))
