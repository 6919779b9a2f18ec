"""Maximum-likelihood fit of a few poles over a window of lines, residues eliminated (variable projection).

    Y = G(p) A + P B + noise,   G_k = sigma_k (1 - e^{-q_k D})/q_k,   q_k = sigma_k + i (omega - omega_k),

p = -sigma + i omega_k the poles, A complex residues (poles, channels), P polynomials for modes outside, D the seconds
of ringing in the record (inf: all of it). With Q an orthonormal basis of [G P] and R = Y - Q Q^H Y the columns of the
Jacobian are J_j = -(1 - Q Q^H) G_j A_j (Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973, 413; the second term
after Kaufman, BIT 15, 1975, 49, is left out). J^H J needs products over lines and products over channels, never both.

Noise of measured responses is alike over channels and on neighbouring lines. The scores q_l = Re sum_c J^H R at line l
give the covariance K I^-1 [sum_l q_l q_l^T] I^-1 then (White, Econometrica 48, 1980, 817), K the number of alike lines
by the residual's autocorrelation. Where the model lacks something, the residual is alike over many lines: its variance
about a pole times K is the variance of the noise that counts. Each standard deviation is the larger of the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.thresholds import USUAL
from casingfem.io.arrays import Array, FloatArray, freeze

STEPS = 40
CONVERGED = 1e-3  # gain in units of the noise that ends the fit
MOST_LAGS = 12
HANN = (-1.0, 1.0 / 6.0), (0.0, 2.0 / 3.0), (1.0, 1.0 / 6.0)  # lines away, share of the power (Bendat & Piersol, 8.5)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """Lines and channels of one fit.

    freq [Hz] (lines,); Y (lines, channels), responses over their noise, each line times `along` (lines,), 0 where a
    line is missing; `end` the seconds of ringing in the record; `leak` [Hz] the distance of lines over which a Hann
    window leaks, 0 without; `floor` the least deviation of an entry's real part that counts; `terms` the number of
    polynomials for the modes outside the window.
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

    def resonances(self, poles: Array) -> tuple[Array, Array]:
        """Columns of unit peak (lines, poles), and their derivatives by omega_k/sigma_k, then ln sigma_k (2 poles)."""
        if not self.leak:
            return self._at(poles, self.freq)
        parts = [(share, self._at(poles, self.freq + by * self.leak)) for by, share in HANN]
        columns, slopes = (sum(share * part[k] for share, part in parts) for k in (0, 1))
        return np.asarray(columns), np.asarray(slopes)

    def _at(self, poles: Array, freq: FloatArray) -> tuple[Array, Array]:
        sigma = -poles.real
        q = sigma + 1j * (2.0 * np.pi * freq[:, None] - poles.imag)
        inverse = sigma / q
        if np.isfinite(self.end):
            late = np.exp(-q * self.end)
            columns = inverse * (1.0 - late)
            by_q = inverse * self.end * late * sigma - columns * inverse  # times sigma
        else:
            columns = inverse
            by_q = -inverse * inverse
        slopes = np.concatenate([-1j * by_q, columns + by_q], axis=1)
        return self.along[:, None] * columns, self.along[:, None] * slopes

    def polynomials(self) -> Array:
        """Columns (lines, terms) of modes outside the window."""
        span = (2.0 * self.freq - self.freq[0] - self.freq[-1]) / (self.freq[-1] - self.freq[0])
        return np.asarray(self.along[:, None] * np.polynomial.chebyshev.chebvander(span, self.terms - 1), complex)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleFit:
    """Fitted poles [rad/s] (poles,), ascending, with residues A (poles, channels) over the noise.

    `B` (terms, channels) of the polynomials; `rest` (lines, channels) the residual; `squares` its sum; `covariance`
    (2 poles, 2 poles) of (omega/sigma, ln sigma) where the noise is white and of unit variance; `noise` (poles,) the
    variance per real entry that counts about each pole; `scores` the covariance with the noise's correlation;
    `refined` is False where the poles are at visible peaks that no fit explains;
    `gram` (poles, poles) of the residues' variance, `tilt` (poles, 2 poles) what residues follow when poles move.
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
    """Poles [rad/s] of a window, the linear parameters that follow from them, and the residual sum of squares."""

    poles: Array
    Q: Array
    T: Array  # [G P] = Q T
    slopes: Array
    A: Array  # residues, then polynomials
    rest: Array
    squares: float


def fit_poles(window: Window, poles: Array, *, steps: int = STEPS) -> PoleFit:
    """Refine poles [rad/s] from a start by Levenberg-Marquardt; residues and polynomials follow linearly.

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
    return _finished(window, refined(window, poles, steps))


def refined(window: Window, poles: Array, steps: int = STEPS) -> State:
    """Poles [rad/s] after a limited number of steps, without uncertainties, for a trial."""
    polynomials = window.polynomials()
    at = _state(window, np.asarray(poles, complex), polynomials)
    damping = 1e-3
    quiet = max(CONVERGED, 1e-12 * float(np.sum(np.abs(window.Y) ** 2)))
    for _ in range(steps if len(at.poles) else 0):
        information, gradient, _, _ = _system(at)
        scale = np.diag(information) + 1e-12 * np.trace(information) / len(information) + 1e-300
        step = np.asarray(np.linalg.solve(information + damping * np.diag(scale), -gradient), np.float64)
        new = _state(window, _moved(window, at.poles, step), polynomials)
        gain = at.squares - new.squares
        if gain >= 0.0:
            at, damping = new, max(damping / 10.0, 1e-10)
            if gain < quiet:
                break
        else:
            damping *= 10.0
            if damping > 1e8:
                break
    return at


def _moved(window: Window, poles: Array, step: FloatArray) -> Array:
    """Poles after a step in (omega/sigma, ln sigma), of bounded length, within the window."""
    count = len(poles)
    sigma = -poles.real
    reach = np.maximum(1.0, 0.5 * window.step / sigma)
    by_omega = np.clip(step[:count], -reach, reach)
    by_sigma = np.clip(step[count:], -1.0, 1.0)
    low, high = 2.0 * np.pi * window.freq[[0, -1]]
    omega = np.clip(poles.imag + sigma * by_omega, low, high)
    sigma = np.clip(sigma * np.exp(by_sigma), 1e-7 * omega, 0.5 * (high - low) + window.step)
    return np.asarray(-sigma + 1j * omega)


def _state(window: Window, poles: Array, polynomials: Array) -> State:
    columns, slopes = window.resonances(poles)
    Q, T = np.linalg.qr(np.concatenate([columns, polynomials], axis=1))
    seen = Q.conj().T @ window.Y
    rest = window.Y - Q @ seen
    T = T + 1e-13 * np.max(np.abs(np.diag(T))) * np.eye(len(T))
    return State(poles, Q, T, slopes, np.linalg.solve(T, seen), rest, float(np.sum(np.abs(rest) ** 2)))


def _system(at: State) -> tuple[FloatArray, FloatArray, Array, Array]:
    """J^H J and J^H R, real; the projected slopes (lines, 2 poles), and Q^H times the slopes."""
    along = at.Q.conj().T @ at.slopes
    slopes = at.slopes - at.Q @ along
    A = np.concatenate([at.A[: len(at.poles)]] * 2)
    information = np.real((slopes.conj().T @ slopes) * (A.conj() @ A.T))
    gradient = -np.real(np.sum((slopes.conj().T @ at.rest) * A.conj(), axis=1))
    return information, gradient, slopes, along


def _finished(window: Window, at: State) -> PoleFit:
    """Everything about the poles in ascending order."""
    count = len(at.poles)
    information, _, slopes, along = _system(at)
    A = at.A[:count]
    inverse = np.linalg.pinv(information + 1e-300 * np.eye(2 * count), hermitian=True) if count else information
    scores = -np.real(slopes.conj() * (at.rest @ np.concatenate([A, A]).conj().T))
    local, noise, alike = _noise_about(window, at)
    root = np.sqrt(np.tile(alike, 2))
    middle = (scores.T @ scores) * np.outer(root, root)
    inverse_t = np.linalg.inv(at.T)
    order = np.argsort(at.poles.imag)
    both = np.r_[order, count + order]
    return PoleFit(
        window=window, poles=at.poles[order], A=A[order], B=at.A[count:], rest=at.rest, squares=at.squares,
        covariance=inverse[np.ix_(both, both)], scores=(inverse @ middle @ inverse)[np.ix_(both, both)],
        noise=noise[order], gram=(inverse_t @ inverse_t.conj().T)[np.ix_(order, order)],
        tilt=(inverse_t @ along)[np.ix_(order, both)], local=local[order],
    )  # fmt: skip


def _noise_about(window: Window, at: State) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Variance of the residual per real entry about each pole, that times the number of alike lines, this number."""
    used = window.along > 0.0
    freedom = max(1.0 - at.Q.shape[1] / max(int(used.sum()), 1), 0.2)
    local, noise, alike = (np.ones(len(at.poles)) for _ in range(3))
    for k, pole in enumerate(at.poles):
        reach = max(-2.0 * pole.real, 4.0 * window.step)
        near = np.abs(2.0 * np.pi * window.freq - pole.imag) < reach
        rest = at.rest[near & used]
        if len(rest) < 4:
            rest = at.rest[used]
        square = 0.5 * float(np.mean(np.abs(rest) ** 2)) / freedom
        local[k] = max(square, window.floor**2)
        alike[k] = alike_lines(rest)
        noise[k] = max(local[k] * alike[k], 1.0, window.floor**2)
    return local, noise, alike


def alike_lines(rest: Array) -> float:
    """Over how many lines a residual (lines, channels) is alike: 1 for white noise.

    1 + 2 sum of |rho_k| over the lags whose correlation is beyond what chance gives.
    """
    total = float(np.sum(np.abs(rest) ** 2))
    if total == 0.0:
        return 1.0
    chance = 2.5 / np.sqrt(rest.size)
    alike = 1.0
    for lag in range(1, min(MOST_LAGS, len(rest) - 1)):
        rho = abs(complex(np.sum(rest[lag:] * rest[:-lag].conj()))) / total
        if rho < chance:
            break
        alike += 2.0 * rho
    return alike
