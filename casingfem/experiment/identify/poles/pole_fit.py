"""Least-squares fit of poles to frequency responses, residues eliminated (variable projection).

With the columns Phi of a `Window` the residues are linear, and min |Y - Phi Phi^+ Y| is a problem in the poles
p = (ln f, ln zeta) alone (Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973, 413). One column of its Jacobian is

    J_j = -P D_j A - (Phi^+)^T D_j^T R,   D_j = d Phi/d p_j,  A = Phi^+ Y,  R = P Y,  P = 1 - Phi Phi^+;

J^T J needs products over lines and products over channels, never both at once. The first term alone, J', gives the
information about the poles: its inverse, times the variance of the noise, is their covariance where the noise is
white. Noise of estimated responses is not: it rises on the peaks, and a window makes it alike on neighbouring lines.
The scores q_l = sum over channels of J'^T r at line l give what the covariance then is,

    (J'^T J')^-1 [sum_l q_l q_l^T + sum_(k=1,2) (1 - k/3) sum_l (q_l q_(l+k)^T + q_(l+k) q_l^T)] (J'^T J')^-1

(Newey and West, Econometrica 55, 1987, 703). Each standard deviation is the larger of the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.io.arrays import Array, FloatArray, frozen

STEPS = 60
TRUST = 2.0, 1.0  # largest step, in half-power half-widths and in ln zeta
CONVERGED = 1e-2  # a gain below this squared, in units of the noise, ends the fit
EXACT = 1e-13  # so does one below this part of the sum of squares
LEAST, MOST = 1e-6, 0.5  # zeta
LAGS = 2  # lines over which a window makes noise alike


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleFit:
    """Fitted poles: freq [Hz], zeta (poles,), ascending; residues A (poles, columns, channels), weighted.

    `squares` is the sum of squared deviations, `variance` that per degree of freedom; `covariance` (2 poles, 2 poles)
    of (ln f, ln zeta), over `variance`, its standard deviations `raised` (2 poles,) times those of white noise; `gram`
    (poles, columns, poles, columns) of the inverse of Phi^T Phi; `tilt` (poles, columns, 2 poles, columns) = Phi^+ D,
    what residues follow when poles move; `spread` (lines, channels) complex, the deviation; `matching` (poles,) the
    standard deviation of ln f from not knowing which peak of a set-up belongs to which mode; `seen` (poles,) the share
    of the set-ups that have the mode's energy; `apart` (poles - 1,) the chi-squared of neighbours having the same
    frequency in every one of several set-ups; `worth` (poles,) what each takes there, over what it must.
    """

    window: Window
    freq: FloatArray
    zeta: FloatArray
    A: FloatArray
    squares: float
    variance: float
    covariance: FloatArray
    raised: FloatArray
    gram: FloatArray
    tilt: FloatArray
    spread: Array
    matching: FloatArray
    seen: FloatArray
    apart: FloatArray
    worth: FloatArray
    converged: bool

    def __post_init__(self) -> None:
        for name in (
            "freq",
            "zeta",
            "A",
            "covariance",
            "raised",
            "gram",
            "tilt",
            "spread",
            "matching",
            "seen",
            "apart",
            "worth",
        ):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def noise(self) -> float:
        """Variance an entry of Y is given when poles are judged."""
        return max(self.variance, self.window.floor**2)

    @property
    def parameters(self) -> int:
        """Number of poles' parameters and residues."""
        return self.A.size + 2 * len(self.freq)


class _State(NamedTuple):
    """Everything at one set of poles; Phi = Q T, A (columns of Phi, channels), D = d Phi/dp."""

    f: FloatArray
    zeta: FloatArray
    squares: float
    R: FloatArray
    A: FloatArray
    Q: FloatArray
    T: FloatArray
    D: FloatArray


class _System(NamedTuple):
    """J^T J, that of the information, J^T r, and Phi^+ D."""

    full: FloatArray
    information: FloatArray
    gradient: FloatArray
    tilt: FloatArray


def fit_poles(window: Window, freq: FloatArray, zeta: FloatArray, *, steps: int = STEPS) -> PoleFit:
    """Refine poles from a start by Levenberg-Marquardt; residues and residuals follow linearly.

    Ends when a step gains nothing against the noise, or after `steps` (`converged` says so).

    Examples
    --------
    >>> lines = np.arange(95.0, 105.0, 0.05)
    >>> H = 100.0**2 / (100.0**2 - lines**2 + 2j * 0.004 * 100.0 * lines)
    >>> Y = np.concatenate([H.real, H.imag])[:, None]
    >>> window = Window(freq=lines, Y=Y, power=0, residues="real", weight=np.ones(1), floor=0.0, along=np.ones(200))
    >>> fit = fit_poles(window, np.array([100.2]), np.array([0.003]))
    >>> fit.freq.round(6).tolist(), fit.zeta.round(8).tolist()
    ([100.0], [0.004])
    """
    at = _state(window, np.array(freq, float), np.array(zeta, float))
    damping, converged = 1e-3, len(freq) == 0
    for _ in range(0 if converged else steps):
        new = _step(window, at, damping)
        gain = at.squares - new.squares
        if gain >= 0.0:
            at, damping = new, max(damping * 0.2, 1e-12)
            converged = gain <= max(CONVERGED**2 * at.squares / window.Y.size, EXACT * at.squares)
        else:
            damping *= 8.0
            converged = damping > 1e12
        if converged:
            break
    return _finished(window, at, converged)


def _state(window: Window, f: FloatArray, zeta: FloatArray) -> _State:
    g, slopes = window.peaks(f, zeta)
    Q, T = np.linalg.qr(np.concatenate([window.as_real(g), window.residuals()], axis=1))
    part = Q.T @ window.Y
    R = window.Y - Q @ part
    T = T + 1e-14 * abs(T[0, 0]) * np.eye(len(T))  # coinciding poles have no residues of their own
    return _State(
        f, zeta, float(np.sum(R * R)), R, np.linalg.solve(T, part), Q, T, window.as_real(np.concatenate(slopes, axis=1))
    )


def _system(window: Window, at: _State) -> _System:
    s, m = window.columns, len(at.f)
    D = at.D
    inside = at.Q.T @ D
    across = D - at.Q @ inside
    A = np.tile(at.A[: s * m], (2, 1))  # residues that belong to each column of D
    information = _blocks((across.T @ across) * (A @ A.T), s)
    turned = D.T @ at.R  # (2 poles x columns, channels)
    gradient = -np.sum((turned * A).reshape(2 * m, s * A.shape[1]), axis=1)
    inverse = np.linalg.inv(at.T)[: s * m]
    bent = np.tile(inverse @ inverse.T, (2, 2)) * (turned @ turned.T)
    return _System(information + _blocks(bent, s), information, gradient, inverse @ inside)


def _blocks(matrix: FloatArray, s: int) -> FloatArray:
    """Sums over s x s blocks."""
    n = len(matrix) // s
    return np.asarray(matrix.reshape(n, s, n, s).sum(axis=(1, 3)))


def _step(window: Window, at: _State, damping: float) -> _State:
    """One damped Gauss-Newton step within the trust limits."""
    system = _system(window, at)
    m = len(at.f)
    scaled = system.full + damping * np.diag(np.diag(system.full) + 1e-300)
    step = -np.linalg.solve(scaled, system.gradient)
    step /= max(1.0, *np.abs(step[:m] / (TRUST[0] * at.zeta)), *np.abs(step[m:] / TRUST[1]))
    return _state(window, at.f * np.exp(step[:m]), np.clip(at.zeta * np.exp(step[m:]), LEAST, MOST))


def _finished(window: Window, at: _State, converged: bool) -> PoleFit:
    """The fit with its poles in order of frequency, and its covariance."""
    order = np.argsort(at.f)
    at = _state(window, at.f[order], at.zeta[order])
    s, m, half = window.columns, len(at.f), len(window.freq)
    system = _system(window, at)
    inverse = np.linalg.inv(at.T)[: s * m]
    free = window.entries - at.A.size - 2 * m
    covariance, raised = _covariance(window, at, system.information, at.squares / max(free, 1))
    return PoleFit(
        window=window,
        freq=at.f,
        zeta=at.zeta,
        A=at.A[: s * m].reshape(m, s, at.A.shape[1]),
        squares=at.squares,
        variance=at.squares / max(free, 1),
        covariance=covariance,
        raised=raised,
        gram=(inverse @ inverse.T).reshape(m, s, m, s),
        tilt=system.tilt.reshape(m, s, 2 * m, s),
        spread=at.R[:half] + 1j * at.R[half:],
        matching=np.zeros(m),
        seen=np.ones(m),
        apart=np.zeros(max(m - 1, 0)),
        worth=np.zeros(m),
        converged=converged,
    )


def _covariance(window: Window, at: _State, information: FloatArray, variance: float) -> tuple[FloatArray, FloatArray]:
    """Covariance of the poles over the variance: that of white noise, raised where there is other; and how much."""
    white = np.asarray(np.linalg.pinv(information, hermitian=True), np.float64)
    scores = _scores(window, at)
    meat = scores.T @ scores
    for lag in range(1, LAGS + 1):
        near = scores[lag:].T @ scores[:-lag]
        meat = meat + (1.0 - lag / (LAGS + 1.0)) * (near + near.T)
    diagonal = np.diag(white) + 1e-300
    raised = np.sqrt(np.maximum(np.diag(white @ meat @ white) / (max(variance, 1e-300) * diagonal), 1.0))
    return np.asarray(white * np.outer(raised, raised)), np.asarray(raised)


def _scores(window: Window, at: _State) -> FloatArray:
    """Sum over the channels of J'^T r at each line, (lines, 2 poles)."""
    s, m = window.columns, len(at.f)
    D = at.D
    across = D - at.Q @ (at.Q.T @ D)
    A = np.tile(at.A[: s * m], (2, 1))
    rows = -(across * (at.R @ A.T)).reshape(len(D), 2 * m, s).sum(axis=2)
    return np.asarray(rows[: len(window.freq)] + rows[len(window.freq) :])
