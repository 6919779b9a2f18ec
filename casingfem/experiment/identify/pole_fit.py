"""Maximum-likelihood fit of a few poles over a window of lines, residues eliminated (variable projection).

    Y = G(p) A + P B + noise,   G_k = sigma_k (1 - e^{-q_k D})/q_k,   q_k = sigma_k + i (omega - omega_k),

p = -sigma + i omega_k the poles, A complex residues (poles, channels), P polynomials for modes outside, D the duration
of the recorded ringing [s] (inf: the ringing decays within the record). With Q an orthonormal basis of [G P] and R = Y
- Q Q^H Y the columns of the Jacobian are J_j = -(1 - Q Q^H) G_j A_j (Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973,
413; the second term after Kaufman, BIT 15, 1975, 49, is left out). J^H J needs only products over lines and products
over channels.

Noise of measured responses is correlated between channels and between neighbouring lines. The scores q_l = Re sum_c J^H
R at line l give the covariance K I^-1 [sum_l q_l q_l^T] I^-1 then (White, Econometrica 48, 1980, 817), K the number of
correlated lines by the residual's autocorrelation. If the model is incomplete, the residual is correlated over many
lines: the effective variance of the noise about a pole is K times the residual's variance. Each standard deviation is
the larger of the two.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import zgeqrf, ztrtrs, zungqr

from casingfem.experiment.identify.merged_lines import merged_lines
from casingfem.experiment.identify.thresholds import USUAL
from casingfem.io.arrays import Array, FloatArray, freeze

STEPS, POLISHING = 40, 5  # most steps with merged lines, and then with all lines
FIRST = 1e-3  # damping of a step
CONVERGED = 1e-3  # gain in variances of the residual, or of the noise, that ends the fit
MOST_LAGS = 12
MANY, FEWER = 200, 0.5  # lines from which on they are merged; largest share of lines that may remain
HANN = (-1.0, 1.0 / 6.0), (0.0, 2.0 / 3.0), (1.0, 1.0 / 6.0)  # lines away, share of the power (Bendat & Piersol, 8.5)


@dataclass(frozen=True, kw_only=True, eq=False)
class Window:
    """Lines and channels of one fit.

    Attributes
    ----------
    freq : [Hz] (lines,)
    Y : (lines, channels) responses over their noise, each line times `along`
    along : (lines,) weights of the lines, 0 where a line is missing
    end : duration of the recorded ringing [s]
    leak : distance of lines [Hz] over which a Hann window leaks, 0 without one
    floor : least standard deviation assumed for an entry's real part
    terms : number of polynomials for the modes outside the window
    """

    freq: FloatArray
    Y: Array
    along: FloatArray
    end: float = np.inf
    leak: float = 0.0
    floor: float = 0.0
    terms: int = USUAL.terms

    def __post_init__(self) -> None:
        freeze(self, "freq", "Y", "along")

    @property
    def step(self) -> float:
        """Distance of lines [rad/s]."""
        return 2.0 * np.pi * float(self.freq[1] - self.freq[0])

    @cached_property
    def merged(self) -> Window:
        """The window with merged lines and the same products if at most half of its lines remain.

        Else the window itself.
        """
        if len(self.freq) < MANY:
            return self
        few = merged_lines(self.freq, self.Y, self.along, self.floor)
        return self if len(few.freq) > FEWER * len(self.freq) else replace(self, **few._asdict())

    def resonances(self, poles: Array) -> tuple[Array, Array]:
        """Columns G of unit peak (lines, poles), and sigma dG/dq."""
        if not self.leak:
            return self._at(poles, self.freq)
        parts = [(share, self._at(poles, self.freq + by * self.leak)) for by, share in HANN]
        columns, by_q = (sum(share * part[k] for share, part in parts) for k in (0, 1))
        return np.asarray(columns), np.asarray(by_q)

    def _at(self, poles: Array, freq: FloatArray) -> tuple[Array, Array]:
        sigma = -poles.real
        off = (2.0 * np.pi * freq[:, None] - poles.imag) / sigma
        size = 1.0 / (1.0 + off * off)
        inverse = np.empty(off.shape, complex)  # sigma/q
        inverse.real, inverse.imag = size, -off * size
        along = self.along[:, None]
        if np.isfinite(self.end):
            late = along * np.exp(-self.end * sigma * (1.0 + 1j * off))
            columns = inverse * (along - late)
            return columns, inverse * late * (self.end * sigma) - columns * inverse
        columns = along * inverse
        return columns, -columns * inverse

    @cached_property
    def polynomials(self) -> Array:
        """Polynomial columns (lines, terms) that represent the modes outside the window."""
        span = (2.0 * self.freq - self.freq[0] - self.freq[-1]) / (self.freq[-1] - self.freq[0])
        return np.asarray(self.along[:, None] * np.polynomial.chebyshev.chebvander(span, self.terms - 1), complex)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleFit:
    """Fitted poles [rad/s] (poles,), ascending, with residues A (poles, channels) over the noise.

    Attributes
    ----------
    B : (terms, channels) coefficients of the polynomials
    rest : (lines, channels) residual
    squares : sum of its squares
    covariance : (2 poles, 2 poles) of (omega/sigma, ln sigma), for white noise of unit variance
    noise : (poles,) effective variance of a real entry about each pole
    scores : the covariance with the noise's correlation
    refined : False if the poles are at visible peaks that no fit explains
    gram : (poles, poles) variance of the residues
    tilt : (poles, 2 poles) change of the residues with the poles
    """

    window: Window
    poles: Array
    A: Array
    B: Array
    rest: Array
    squares: float
    covariance: FloatArray
    scores: FloatArray
    noise: FloatArray
    gram: Array
    tilt: Array
    local: FloatArray
    refined: bool = True

    def __len__(self) -> int:
        return len(self.poles)

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations of (omega/sigma, ln sigma), (2, poles)."""
        count = len(self.poles)
        white = np.diag(self.covariance).reshape(2, count) * self.noise
        return np.asarray(np.sqrt(np.maximum(white, np.diag(self.scores).reshape(2, count))))

    @property
    def peaks(self) -> FloatArray:
        """Size of each mode's peak, rms over the channels in units of the noise of a real part, (poles,)."""
        return np.asarray(np.sqrt(np.mean(np.abs(self.A) ** 2, axis=1) / 2.0))

    def alike(self) -> FloatArray:
        """Modal assurance criterion of the residues of each two poles, (poles, poles)."""
        norms = np.linalg.norm(self.A, axis=1) + 1e-300
        return np.asarray(np.abs(self.A.conj() @ self.A.T) ** 2 / np.outer(norms, norms) ** 2)

    def gains(self) -> FloatArray:
        """Increase of the sum of squares when one pole is removed and the others stay, (poles,)."""
        return np.asarray(np.sum(np.abs(self.A) ** 2, axis=1) / np.maximum(np.diag(self.gram).real, 1e-300))


class State(NamedTuple):
    """Poles [rad/s] of a window, the linear parameters at these poles, and the residual sum of squares."""

    poles: Array
    Q: Array
    T: Array  # [G P] = Q T, of which only the upper triangle is used
    by_q: Array  # sigma dG/dq
    A: Array  # residues, then polynomials
    rest: Array
    squares: float


def widths(poles: Array) -> FloatArray:
    """Half-power bandwidths [rad/s]."""
    return np.asarray(-2.0 * poles.real)


def fit_poles(window: Window, poles: Array, *, steps: int = STEPS) -> PoleFit:
    """Refine poles [rad/s] by Levenberg-Marquardt; residues and polynomials follow by linear least squares.

    Examples
    --------
    >>> lines = np.arange(95.0, 105.0, 0.05)
    >>> pole = 2 * np.pi * 100.0 * (-0.004 + 1j)
    >>> Y = (1e3 / (2j * np.pi * lines - pole))[:, None]
    >>> window = Window(freq=lines, Y=Y, along=np.ones(200))
    >>> fit = fit_poles(window, 2 * np.pi * 100.2 * np.array([-0.003 + 1j]))
    >>> bool(abs(fit.poles[0] / pole - 1.0) < 1e-9)
    True
    """
    return finished(window, refined(window, poles, steps))


def refined(window: Window, poles: Array, steps: int = STEPS) -> State:
    """Poles [rad/s] after a limited number of steps, first with merged lines; without uncertainties."""
    start = np.asarray(poles, complex)
    if steps and len(start) and window.merged is not window:
        start, steps = _descended(window, window.merged, start, steps).poles, min(steps, POLISHING)
    return _descended(window, window, start, steps)


def tried(window: Window, poles: Array, steps: int) -> tuple[Array, float]:
    """Poles [rad/s] after a limited number of steps with merged lines, and the sum of squares of all lines there."""
    few = window.merged
    left = 0.0 if few is window else float(np.sum(np.abs(window.Y) ** 2) - np.sum(np.abs(few.Y) ** 2))
    at = _descended(window, few, np.asarray(poles, complex), steps)
    return at.poles, left + at.squares


def _descended(window: Window, used: Window, poles: Array, steps: int) -> State:
    """Move poles within a window by a limited number of steps, with the lines that are used.

    The damping of a step follows the ratio of the decrease of the sum of squares to the predicted decrease (Nielsen,
    Damping parameter in Marquardt's method, Technical University of Denmark, IMM-REP-1999-05).
    """
    polynomials = used.polynomials
    at = state(used, poles, polynomials)
    entries, least = 2.0 * used.Y.size + 1.0, 1e-12 * float(np.sum(np.abs(used.Y) ** 2))
    damping, rise, system = FIRST, 2.0, None
    for _ in range(steps if len(at.poles) else 0):
        information, gradient = system = system or _system(at)
        scale = information.diagonal() * 1.0
        scale += 1e-12 * scale.mean() + 1e-300
        damped = information.copy()
        damped.flat[:: len(damped) + 1] += damping * scale
        step = np.asarray(np.linalg.solve(damped, -gradient), np.float64)
        new = state(used, _moved(window, at.poles, step), polynomials)
        gain, predicted = at.squares - new.squares, float(step @ (damping * scale * step - gradient))
        if gain >= 0.0:
            at, system, rise = new, None, 2.0
            ratio = min(gain / max(predicted, 1e-300), 1.0)
            damping = max(damping * max(0.1, 1.0 - (2.0 * ratio - 1.0) ** 3), 1e-10)
            if gain < max(CONVERGED * max(1.0, at.squares / entries), least):
                break
        else:
            damping, rise = damping * rise, 2.0 * rise
            if damping > 1e8:
                break
    return at


def _moved(window: Window, poles: Array, step: FloatArray) -> Array:
    """Poles after a step in (omega/sigma, ln sigma), of bounded length, within the window."""
    count = len(poles)
    sigma = -poles.real
    reach = np.maximum(1.0, 0.5 * window.step / sigma)
    by_omega = np.maximum(np.minimum(step[:count], reach), -reach)
    by_sigma = np.maximum(np.minimum(step[count:], 1.0), -1.0)
    low, high = 2.0 * np.pi * window.freq[[0, -1]]
    omega = np.maximum(np.minimum(poles.imag + sigma * by_omega, high), low)
    widest = 0.5 * (high - low) + window.step
    sigma = np.maximum(np.minimum(sigma * np.exp(by_sigma), widest), 1e-7 * omega)
    return np.asarray(-sigma + 1j * omega)


def state(window: Window, poles: Array, polynomials: Array) -> State:
    """Residues and polynomials by linear least squares at given poles [rad/s]."""
    columns, by_q = window.resonances(poles)
    whole, tau = zgeqrf(np.concatenate([columns, polynomials], axis=1))[:2]
    Q, T = zungqr(whole, tau)[0], whole[: whole.shape[1]]
    seen = Q.conj().T @ window.Y
    rest = window.Y - Q @ seen
    T.flat[:: len(T) + 1] += 1e-13 * np.abs(T.diagonal()).max(initial=0.0)
    return State(poles, Q, T, by_q, ztrtrs(T, seen)[0], rest, float(np.vdot(rest, rest).real))


def _system(at: State) -> tuple[FloatArray, FloatArray]:
    """J^H J (2 poles, 2 poles) and J^H R (2 poles,), real, without the projected derivatives."""
    along, bare = at.Q.conj().T @ at.by_q, at.by_q.conj().T
    A = at.A[: len(at.poles)]
    gradient = np.sum((bare @ at.rest) * A.conj(), axis=1)
    return _information(bare @ at.by_q - along.conj().T @ along, A), np.concatenate([gradient.imag, -gradient.real])


def _information(products: Array, A: Array) -> FloatArray:
    """J^H J from the products (poles, poles) of the projected derivatives by q."""
    blocks = products * (A.conj() @ A.T)
    whole = [np.concatenate([blocks.real, -blocks.imag], axis=1), np.concatenate([blocks.imag, blocks.real], axis=1)]
    return np.concatenate(whole)


def finished(window: Window, at: State) -> PoleFit:
    """Complete the fit: poles in ascending order, with residual, covariance and noise."""
    count = len(at.poles)
    along = at.Q.conj().T @ at.by_q
    by_q = at.by_q - at.Q @ along
    information = _information(by_q.conj().T @ by_q, at.A[:count])
    A = at.A[:count]
    inverse = _inverse(information)
    scores = by_q.conj() * (at.rest @ A.conj().T)
    scores = -np.concatenate([-scores.imag, scores.real], axis=1)
    local, noise, alike = _noise_about(window, at)
    root = np.sqrt(np.tile(alike, 2))
    middle = (scores.T @ scores) * np.outer(root, root)
    T = np.triu(at.T)
    rows = np.linalg.inv(T)[:count]
    along = np.concatenate([-1j * along, T[:, :count] + along], axis=1)
    fit = PoleFit(
        window=window, poles=at.poles, A=A, B=at.A[count:], rest=at.rest, squares=at.squares, covariance=inverse,
        scores=inverse @ middle @ inverse, noise=noise, gram=rows @ rows.conj().T, tilt=rows @ along, local=local,
    )  # fmt: skip
    return fit if np.all(np.diff(at.poles.imag) >= 0.0) else _ascending(fit)


def _inverse(information: FloatArray) -> FloatArray:
    """Inverse of a symmetric matrix, without directions that it does not determine."""
    values, vectors = np.linalg.eigh(information)
    known = values > 1e-15 * values.max(initial=0.0)
    return np.asarray((vectors[:, known] / values[known]) @ vectors[:, known].T)


def _ascending(fit: PoleFit) -> PoleFit:
    """The fit with its poles in ascending order."""
    order = np.argsort(fit.poles.imag)
    both = np.r_[order, len(order) + order]
    return replace(
        fit, poles=fit.poles[order], A=fit.A[order], covariance=fit.covariance[np.ix_(both, both)],
        scores=fit.scores[np.ix_(both, both)], noise=fit.noise[order], local=fit.local[order],
        gram=fit.gram[np.ix_(order, order)], tilt=fit.tilt[np.ix_(order, both)],
    )  # fmt: skip


def _noise_about(window: Window, at: State) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Variance of the residual per real entry about each pole, this times K, and K, the number of correlated lines."""
    used = window.along > 0.0
    freedom = max(1.0 - at.Q.shape[1] / max(int(used.sum()), 1), 0.2)
    local, noise, alike = (np.ones(len(at.poles)) for _ in range(3))
    for k, pole in enumerate(at.poles):
        reach = max(-2.0 * pole.real, 4.0 * window.step)
        near = np.abs(2.0 * np.pi * window.freq - pole.imag) < reach
        rest = at.rest[near & used]
        if len(rest) < 4:
            rest = at.rest[used]
        square = 0.5 * float(np.vdot(rest, rest).real) / rest.size / freedom
        local[k] = max(square, window.floor**2)
        alike[k] = alike_lines(rest)
        noise[k] = max(local[k] * alike[k], 1.0, window.floor**2)
    return local, noise, alike


def alike_lines(rest: Array) -> float:
    """Number of lines over which a residual (lines, channels) is correlated: 1 for white noise.

    1 + 2 sum of |rho_k| over the lags whose correlation exceeds chance.
    """
    total = float(np.vdot(rest, rest).real)
    if total == 0.0:
        return 1.0
    chance = 2.5 / np.sqrt(rest.size)
    alike = 1.0
    for lag in range(1, min(MOST_LAGS, len(rest) - 1)):
        rho = abs(complex(np.vdot(rest[:-lag], rest[lag:]))) / total
        if rho < chance:
            break
        alike += 2.0 * rho
    return alike
