"""Least-squares fit of poles to frequency responses, residues eliminated (variable projection).

With the columns Phi of a `Window` the residues are linear, and min |Y - Phi Phi^+ Y| is a problem in the poles
p = (ln f, ln zeta) alone (Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973, 413). One column of its Jacobian is

    J_j = -P D_j A - (Phi^+)^H D_j^H R,   D_j = d Phi/d p_j,  A = Phi^+ Y,  R = P Y,  P = 1 - Phi Phi^+;

J^H J needs products over lines and products over channels, never both at once. Where residues are complex all of this
is, with half the work of real columns and j times each. The first term alone, J', gives the
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
from casingfem.io.arrays import Array, FloatArray, freeze

STEPS = 60
TRUST = 2.0, 1.0  # largest step, in half-power half-widths and in ln zeta
CONVERGED = 1e-4  # a gain below this, in units of the noise, ends the fit
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
    standard deviation of ln f from not knowing which peak of a set-up belongs to which mode, `rival` (poles,) how far
    another reading that may well be has it; `seen` (poles,) the share of the set-ups that have the mode's energy;
    `apart` (poles - 1,) the chi-squared of neighbours having the same frequency in every one of several set-ups;
    `worth` (poles,) what each takes there, over what it must.
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
    rival: FloatArray
    seen: FloatArray
    apart: FloatArray
    worth: FloatArray
    converged: bool

    def __post_init__(self) -> None:
        freeze(self, *(name for name in self.__slots__ if isinstance(getattr(self, name), np.ndarray)))

    @property
    def noise(self) -> float:
        """Variance an entry of Y is given when poles are judged."""
        return max(self.variance, self.window.floor**2)

    @property
    def parameters(self) -> int:
        """Number of poles' parameters and residues."""
        return self.A.size + 2 * len(self.freq)


class _Data(NamedTuple):
    """Columns of a window as they are fitted: complex lines, or real parts over imaginary ones for real residues."""

    window: Window
    Y: Array
    polynomials: Array

    @classmethod
    def of(cls, window: Window) -> _Data:
        return cls(window, window.as_columns(window.as_complex), window.as_columns(window.polynomials()))


class _State(NamedTuple):
    """Everything at one set of poles; Phi = Q T, A (columns of Phi, channels), D = d Phi/dp."""

    f: FloatArray
    zeta: FloatArray
    squares: float
    R: Array
    A: Array
    Q: Array
    T: Array
    D: Array


class _System(NamedTuple):
    """J^H J, that of the information, J^H r, and Phi^+ D."""

    full: FloatArray
    information: FloatArray
    gradient: FloatArray
    tilt: Array


def fit_poles(
    window: Window, freq: FloatArray, zeta: FloatArray, *, steps: int = STEPS, settled: float = CONVERGED
) -> PoleFit:
    """Refine poles from a start by Levenberg-Marquardt; residues and residuals follow linearly.

    Ends when a step gains nothing against the noise, of whose variance `settled` is left, or after `steps` (`converged`
    says so).

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
    data = _Data.of(window)
    at = _state(data, np.array(freq, float), np.array(zeta, float))
    damping, converged = 1e-3, len(freq) == 0
    for _ in range(0 if converged else steps):
        new = _step(data, at, damping)
        gain = at.squares - new.squares
        if gain >= 0.0:
            at, damping = new, max(damping * 0.2, 1e-12)
            converged = gain <= max(settled * at.squares / window.Y.size, EXACT * at.squares)
        else:
            damping *= 8.0
            converged = damping > 1e12
        if converged:
            break
    return _finished(data, at, converged)


def _state(data: _Data, f: FloatArray, zeta: FloatArray) -> _State:
    g, slopes = data.window.peaks(f, zeta)
    columns = data.window.as_columns
    Q, T = np.linalg.qr(np.concatenate([columns(g), data.polynomials], axis=1))
    part = Q.conj().T @ data.Y
    R = data.Y - Q @ part
    T = T + 1e-14 * abs(T[0, 0]) * np.eye(len(T))  # coinciding poles have no residues of their own
    squares = float(np.sum(R.real**2) + np.sum(R.imag**2))
    return _State(f, zeta, squares, R, np.linalg.solve(T, part), Q, T, columns(np.concatenate(slopes, axis=1)))


def _system(at: _State) -> _System:
    m = len(at.f)
    inside = at.Q.conj().T @ at.D
    across = at.D - at.Q @ inside
    A = np.tile(at.A[:m], (2, 1))  # residues that belong to each column of D
    information = np.asarray(((across.conj().T @ across) * (A.conj() @ A.T)).real)
    turned = at.D.conj().T @ at.R  # (2 poles, channels)
    gradient = np.asarray(-np.sum((turned * A.conj()).real, axis=1))
    inverse = np.linalg.inv(at.T)[:m]
    bent = (np.tile(inverse @ inverse.conj().T, (2, 2)) * (turned.conj() @ turned.T)).real
    return _System(information + bent, information, gradient, inverse @ inside)


def _step(data: _Data, at: _State, damping: float) -> _State:
    """One damped Gauss-Newton step within the trust limits."""
    system = _system(at)
    m = len(at.f)
    scaled = system.full + damping * np.diag(np.diag(system.full) + 1e-300)
    step = -np.linalg.solve(scaled, system.gradient)
    step /= max(1.0, *np.abs(step[:m] / (TRUST[0] * at.zeta)), *np.abs(step[m:] / TRUST[1]))
    return _state(data, at.f * np.exp(step[:m]), np.clip(at.zeta * np.exp(step[m:]), LEAST, MOST))


def _finished(data: _Data, at: _State, converged: bool) -> PoleFit:
    """The fit with its poles in order of frequency, and its covariance."""
    order, window = np.argsort(at.f), data.window
    at = _state(data, at.f[order], at.zeta[order])
    s, m, half, channels = window.columns, len(at.f), len(window.freq), at.A.shape[1]
    system = _system(at)
    inverse = np.linalg.inv(at.T)[:m]
    free = window.entries - s * at.A.size - 2 * m
    covariance, raised = _covariance(window, at, system.information, at.squares / max(free, 1))
    return PoleFit(
        window=window,
        freq=at.f,
        zeta=at.zeta,
        A=np.stack([at.A[:m].real, at.A[:m].imag][:s], axis=1).reshape(m, s, channels),
        squares=at.squares,
        variance=at.squares / max(free, 1),
        covariance=covariance,
        raised=raised,
        gram=_real_parts(inverse @ inverse.conj().T, s),
        tilt=_real_parts(system.tilt, s),
        spread=at.R if s == 2 else at.R[:half] + 1j * at.R[half:],
        matching=np.zeros(m),
        rival=np.zeros(m),
        seen=np.ones(m),
        apart=np.zeros(max(m - 1, 0)),
        worth=np.zeros(m),
        converged=converged,
    )


def _real_parts(matrix: Array, s: int) -> FloatArray:
    """A complex matrix (n, k) as it turns real and imaginary parts into such, (n, s, k, s)."""
    both = [[matrix.real, -matrix.imag], [matrix.imag, matrix.real]]
    return np.array([row[:s] for row in both[:s]]).transpose(2, 0, 3, 1)


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
    """Sum over the channels of J'^H r at each line, (lines, 2 poles)."""
    across = at.D - at.Q @ (at.Q.conj().T @ at.D)
    A = np.tile(at.A[: len(at.f)], (2, 1))
    rows = np.asarray(-(across * (at.R.conj() @ A.T)).real)
    half = len(window.freq)
    return rows if window.columns == 2 else rows[:half] + rows[half:]
