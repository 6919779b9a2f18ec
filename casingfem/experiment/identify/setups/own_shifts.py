"""Modes whose peaks lie at frequencies of their own in each set-up of a test.

A roving mass, a moved hammer, a warm afternoon: one mode's peak then lies at slightly different frequencies in
different channels, and two or more common poles fit that well. So does a pair. They differ where it counts: a pair
has two peaks in a channel, or none where the members' shapes cancel; a shifted peak is one peak of that channel's
own. Here the frequencies belong to the set-ups (groups of channels): each set-up is fitted by itself first, then all
together with damping in common, by Levenberg-Marquardt with the normal equations of `pole_fit.py` of each set-up.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

STEPS = 25
SETTLED = 0.3  # of the noise's variance: a gain that ends the fit
SETTLED_ALONE = 0.03  # the same for a set-up by itself: which are one is told by small differences
LEAST, MOST_ZETA = 1e-6, 0.3
SINGULAR = 1e-13  # of a matrix' trace, beside its diagonal: coinciding poles have no residues of their own
TRUST = 1.0, 0.7  # largest step: half-power half-widths, ln zeta

Setups = Sequence[IntArray]  # channels of each


class Modes(NamedTuple):
    """Modes with frequencies [Hz] of their own in each set-up, (modes, setups), damping (modes,).

    Residues (modes, channels) are those of (j f)^q w^2/(w^2 - f^2 + 2 j zeta w f), f in Hz.
    """

    freq: FloatArray
    zeta: FloatArray
    residues: Array

    def response(self, window: Window, setups: Setups) -> Array:
        """What they add to a window of weighted data, (lines, channels)."""
        added = np.zeros((len(window.freq), self.residues.shape[1]), complex)
        for own, channels in zip(self.freq.T, setups, strict=True):
            added[:, channels] = window.values(own, self.zeta) @ self.residues[:, channels]
        return np.asarray(added * window.weight * window.scale**window.power)

    def some(self, which: IntArray) -> Modes:
        """Some of them."""
        return Modes(self.freq[which], self.zeta[which], self.residues[which])


class OwnPeaks(NamedTuple):
    """Modes in each set-up: frequencies [Hz] and damping, (modes, setups), and the variances of their logarithms.

    Residues (modes, channels) of the weighted data, the sum of squares left, and `on_peaks` the variance of an entry
    that is left where the peaks are: noise of estimated responses rises with them.
    """

    freq: FloatArray
    zeta: FloatArray
    variance: FloatArray
    zeta_variance: FloatArray
    residues: Array
    squares: float
    on_peaks: float = 0.0

    def ordered(self, order: Sequence[IntArray], setups: Setups) -> OwnPeaks:
        """With the modes of each set-up in another order."""
        turned = np.array(order).T
        residues = self.residues.copy()
        for own, channels in zip(order, setups, strict=True):
            residues[:, channels] = self.residues[np.ix_(own, channels)]
        columns = (self.freq, self.zeta, self.variance, self.zeta_variance)
        freq, zeta, variance, zeta_variance = (np.take_along_axis(a, turned, axis=0) for a in columns)
        return OwnPeaks(freq, zeta, variance, zeta_variance, residues, self.squares, self.on_peaks)


def apart(
    window: Window, setups: Setups, freq: FloatArray, zeta: FloatArray, noise: float, span: tuple[float, float]
) -> OwnPeaks:
    """Fit modes in each set-up by itself, from a start (modes, setups), (modes,), within a span [Hz].

    `noise` is the variance of an entry.
    """
    return _fit(Problem.of(window, setups), freq, zeta, noise, span, common=False)


def linked(
    window: Window,
    setups: Setups,
    freq: FloatArray,
    zeta: FloatArray,
    noise: float,
    span: tuple[float, float],
    most: float = np.inf,
    ridge: FloatArray | None = None,
) -> OwnPeaks:
    """Fit modes with damping in common; the rest as in `apart`.

    A `ridge` (modes,), the noise over the squared sizes that residues usually have, is added to the squares for each
    squared residue: where two modes meet in a set-up, theirs would grow against each other.

    ln f of a set-up lies within `most` of the median over the set-ups: where one hardly sees a mode its peak would go
    to what the neighbours leave.
    """
    problem = Problem.of(window, setups)
    if ridge is not None:
        problem = problem._replace(ridge=np.repeat(ridge, window.columns))
    return _fit(problem, freq, zeta, noise, span, common=True, most=most)


def squares_at(window: Window, setups: Setups, freq: FloatArray, zeta: FloatArray) -> float:
    """Sum of squares that modes (modes, setups), (modes,) leave where they are."""
    problem, q = Problem.of(window, setups), np.repeat(np.log(zeta)[:, None], freq.shape[1], axis=1)
    return float((_At.of(problem, np.log(freq), q) if len(freq) else problem).squares.sum())


class _At(NamedTuple):
    """Everything at one set of poles, set-ups first: squares left, residues, normal equations of (ln f, ln zeta).

    `information` is what the normal equations have without the noise, see `pole_fit.py`: its inverse is the covariance.
    """

    squares: FloatArray
    residues: FloatArray
    normal: FloatArray
    information: FloatArray
    gradient: FloatArray

    @classmethod
    def of(cls, problem: Problem, p: FloatArray, q: FloatArray) -> _At:
        """As in `pole_fit.py`, for all set-ups at once, by inner products alone; p, q (modes, setups)."""
        (m, count), s = p.shape, problem.window.columns
        products, by_data = problem.products(p, q)
        own, turns = slice(0, m * s), slice(m * s, None)
        gram, cross = products[:, own, own], products[:, own, turns]
        size = np.einsum("gii->g", gram)[:, None, None]
        inverse = np.linalg.inv(gram + (SINGULAR * size + 1e-300 + problem.ridge) * np.eye(m * s))
        A = inverse @ by_data[:, own]
        both, turned = np.concatenate([A, A], axis=1), by_data[:, turns] - cross.swapaxes(1, 2) @ A
        told = (products[:, turns, turns] - cross.swapaxes(1, 2) @ (inverse @ cross)) * (both @ both.swapaxes(1, 2))
        full = told + np.tile(inverse, (1, 2, 2)) * (turned @ turned.swapaxes(1, 2))
        normal, information = (a.reshape(count, 2 * m, s, 2 * m, s).sum(axis=(2, 4)) for a in (full, told))
        return cls(
            squares=problem.squares
            + np.sum(A * (gram @ A + problem.ridge[:, None] * A - 2.0 * by_data[:, own]), axis=(1, 2)),
            residues=A,
            normal=normal,
            information=information,
            gradient=-np.sum((turned * both).reshape(count, 2 * m, -1), axis=2),
        )

    def moved(self, which: IntArray, other: _At) -> _At:
        """The other's in its set-ups, which are these of all."""
        fields = [field.copy() for field in self]
        for field, new in zip(fields, other, strict=True):
            field[which] = new
        return _At(*fields)

    def some(self, which: IntArray | BoolArray) -> _At:
        return _At(*(field[which] for field in self))


def _fit(
    problem: Problem,
    freq: FloatArray,
    zeta: FloatArray,
    noise: float,
    span: tuple[float, float],
    *,
    common: bool,
    most: float = np.inf,
) -> OwnPeaks:
    """Levenberg-Marquardt; each set-up has its own damping of the steps, and its own end, unless `common`."""
    m, count = freq.shape
    low, high = np.log(span)
    entries = 2 * len(problem.window.freq) * np.array([len(channels) for channels in problem.setups])
    p, q = near_each_other(np.log(freq), most), np.repeat(np.log(zeta)[:, None], count, axis=1)
    at, damping, settled = _At.of(problem, p, q), np.full(count, 1e-3), np.zeros(count, bool)
    for _ in range(STEPS):
        here = np.flatnonzero(~settled)
        old = at.some(here)
        by_freq, by_zeta = (_common_step if common else _own_steps)(old, damping[here])
        limit = TRUST[0] * np.exp(q[:, here])
        p_new = near_each_other(np.clip(p[:, here] + np.clip(by_freq, -limit, limit), low, high), most)
        q_new = np.clip(q[:, here] + np.clip(by_zeta, -TRUST[1], TRUST[1]), np.log(LEAST), np.log(MOST_ZETA))
        new = _At.of(problem.some(here), p_new, q_new)
        gain = old.squares - new.squares
        gain = np.full(count, gain.sum()) if common else gain
        better = gain >= 0.0
        moved = here[better]
        p[:, moved], q[:, moved], at = p_new[:, better], q_new[:, better], at.moved(moved, new.some(better))
        damping[here] *= np.where(better, 0.2, 8.0)
        left = at.squares.sum() / problem.window.Y.size if common else at.squares[here] / entries[here]
        small = gain < (SETTLED if common else SETTLED_ALONE) * np.minimum(noise, left)
        settled[here] = (better & small) | (damping[here] > 1e6)
        if settled.all():
            break
    residues = np.zeros((m, problem.window.Y.shape[1]), complex)
    for channels, A in zip(problem.setups, at.residues.reshape(count, m, problem.window.columns, -1), strict=True):
        part = A[:, :, : len(channels)]
        residues[:, channels] = part[:, 0] + (1j * part[:, 1] if problem.window.columns == 2 else 0.0)
    variance, zeta_variance = (_common_variance if common else _own_variance)(at)
    left = float(np.maximum(at.squares, 0.0).sum()), problem.on_peaks(p, q, at.residues)
    return OwnPeaks(np.exp(p), np.exp(q), noise * variance, noise * zeta_variance, residues, *left)


def near_each_other(p: FloatArray, most: float) -> FloatArray:
    """Frequencies ln f (modes, setups) moved to within `most` of each mode's median."""
    if np.isinf(most):
        return p
    middle = np.median(p, axis=1, keepdims=True)
    return np.clip(p, middle - most, middle + most)


def _damped(normal: FloatArray, damping: FloatArray) -> FloatArray:
    """Normal equations with their diagonals raised."""
    size = np.einsum("gii->gi", normal)
    extra = damping[:, None] * size + 1e-12 * size.max(axis=1, keepdims=True) + 1e-300
    return np.asarray(normal + extra[:, :, None] * np.eye(size.shape[1]))


def _own_steps(at: _At, damping: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Steps of ln f and ln zeta (modes, setups), each set-up by itself."""
    step = np.asarray(-np.linalg.solve(_damped(at.normal, damping), at.gradient[:, :, None])[:, :, 0].T, np.float64)
    return step[: len(step) // 2], step[len(step) // 2 :]


def _own_variance(at: _At) -> tuple[FloatArray, FloatArray]:
    """Variances of ln f and ln zeta over that of the noise."""
    inverse = np.linalg.inv(_damped(at.information, np.zeros(len(at.normal))))
    whole = np.maximum(np.einsum("gii->ig", inverse), 0.0)
    return whole[: len(whole) // 2], whole[len(whole) // 2 :]


def _common_step(at: _At, damping: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Steps where damping is common to the set-ups, whose frequencies are eliminated."""
    inner, common = _eliminated(_damped(at.normal, damping), at.gradient)
    m = len(common)
    cross = at.normal[:, :m, m:]
    pull = at.gradient[:, m:].sum(axis=0) - np.einsum("gij,gi->j", cross, inner[:, :, m])
    by_zeta = -np.linalg.solve(common, pull)
    return (-inner[:, :, m] - inner[:, :, :m] @ by_zeta).T, np.repeat(by_zeta[:, None], len(inner), axis=1)


def _common_variance(at: _At) -> tuple[FloatArray, FloatArray]:
    """Variances where damping is common."""
    normal = _damped(at.information, np.zeros(len(at.normal)))
    inner, common = _eliminated(normal, at.gradient)
    m, inverse = len(common), np.linalg.pinv(common)
    own = np.einsum("gii->gi", np.linalg.inv(normal[:, :m, :m]))
    own = own + np.einsum("gij,jk,gik->gi", inner[:, :, :m], inverse, inner[:, :, :m])
    return np.maximum(own.T, 0.0), np.repeat(np.maximum(np.diag(inverse), 0.0)[:, None], len(inner), axis=1)


def _eliminated(normal: FloatArray, gradient: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frequencies' equations solved for damping and gradient, and what they leave of the equations of damping."""
    m = normal.shape[1] // 2
    own, cross = normal[:, :m, :m], normal[:, :m, m:]
    inner = np.linalg.solve(own, np.concatenate([cross, gradient[:, :m, None]], axis=2))
    return inner, normal[:, m:, m:].sum(axis=0) - np.einsum("gij,gik->jk", cross, inner[:, :, :m])
