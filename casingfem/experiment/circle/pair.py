"""The two modes of a close pair, both excited, from a circle scan at several tones across the pair.

Real modes of one order n make V_+-n = (C -+ i S)/2 with C and S the cosine and sine parts of the wave, per newton

    C, S = sum_k (a_k, b_k) i omega/(omega_k^2 - omega^2 + 2 i zeta_k omega_k omega) + i omega (c, s)

with a_k, b_k real and (c, s) from other modes, nearly constant across the pair. For given omega_k, zeta_k the rest is
linear: variable projection (Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973, 413). The antinode of member k is at
psi_k = atan2(b_k, a_k)/n.

A single resonance has four unknowns less. Two are accepted if they reduce the sum of squares by more than noise would,
by an F test, since noise can also resemble a second member.
"""

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from scipy.optimize import least_squares
from scipy.special import fdtrc

from casingfem.errors import InputError
from casingfem.experiment.circle.scan import CircleScan
from casingfem.io.arrays import Array, FloatArray

TONES = 6  # at least: ten unknowns, four equations a tone, and something left to judge by
STARTS = 9  # frequencies tried for each member
ZETAS = (1e-3, 4e-3, 1.6e-2)  # damping ratios tried
LEVEL = 1e-3  # how often noise may make two of a double, at most


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair:
    """A pair, lower member first: frequencies [Hz], damping ratios, antinodes [deg], each with its sigma, (2,).

    `split` and `split_sigma` [Hz]; `misfit` is the rms of the residual over the noise: 1 for a correct model.
    """

    n: int
    freq: FloatArray
    freq_sigma: FloatArray
    zeta: FloatArray
    zeta_sigma: FloatArray
    angle_deg: FloatArray
    angle_sigma_deg: FloatArray
    split: float
    split_sigma: float
    misfit: float


def split_pair(scan: CircleScan, n: int) -> Pair:
    """Separate the members of the pair of order n.

    Parameters
    ----------
    scan
        Demodulated at six or more tones across the pair, per newton or at equal forces in phase.
    n
        The pair's order, 1 or more.

    Raises
    ------
    InputError
        There are too few tones, the order was not fitted, or the data do not distinguish two members: a single
        frequency and damping fits equally well within noise.

    Examples
    --------
    >>> import casingfem as cf
    >>> f = np.linspace(98.0, 102.0, 9)
    >>> low, high = (1j * f / (f0**2 - f**2 + 2j * 0.004 * f0 * f) for f0 in (99.5, 100.5))
    >>> V = np.stack([low + 1j * high, low - 1j * high], axis=1) / 2.0  # cos 3 theta by low, sin 3 theta by high
    >>> small = np.full(V.shape, 1e-6)
    >>> scan = cf.circle.CircleScan(tones=f, n=np.array([-3, 3]), V=V, sigma=small, floor=small, rate=2.0, left=1.0)
    >>> pair = cf.circle.split_pair(scan, 3)
    >>> pair.freq.round(3).tolist(), pair.angle_deg.round(2).tolist()
    ([99.5, 100.5], [0.0, 30.0])
    """
    if n < 1 or n not in scan.n:
        raise InputError(f"order n = {n}: expected one of the fitted orders, 1 or more")
    if len(scan.tones) < TONES:
        raise InputError(f"the pair n = {n}: found {len(scan.tones)} tones, expected {TONES} or more across it")
    up, down = (int(np.flatnonzero(scan.n == k)[0]) for k in (n, -n))
    sigma = np.sqrt(scan.sigma[:, up] ** 2 + scan.sigma[:, down] ** 2)
    cosine, sine = scan.V[:, up] + scan.V[:, down], 1j * (scan.V[:, up] - scan.V[:, down])
    data = np.stack([cosine, sine], axis=1) / sigma[:, None]
    poles = fitted_poles(scan.tones, data, sigma)
    parts, residual = linear_part(scan.tones, poles, data, sigma)
    freedom = residual.size - 10
    misfit = float(np.sqrt(residual @ residual / freedom))
    require_two(n, scan.tones, data, sigma, misfit)
    J = jacobian(scan.tones, poles, parts, sigma)
    scaled = J / np.linalg.norm(J, axis=0)
    if np.linalg.cond(scaled) > 1e8:
        help_ = "more of them, closer to the peaks"
        raise InputError(f"the pair n = {n}: the tones do not distinguish two members: {help_}")
    covariance = np.linalg.inv(scaled.T @ scaled) / np.multiply.outer(*[np.linalg.norm(J, axis=0)] * 2)
    return described(n, poles, parts, covariance * max(misfit, 1.0) ** 2, misfit)


def require_two(n: int, tones: FloatArray, data: Array, sigma: FloatArray, misfit: float) -> None:
    """Refuse data that one resonance fits as well as two, whose fit leaves `misfit`.

    A second resonance could be at many frequencies, of which the fit takes the best, so each counts as a separate test.
    """
    residual = linear_part(tones, fitted_poles(tones, data, sigma, 1), data, sigma)[1]
    one, freedom = float(residual @ residual), residual.size - 10
    gain = (one - freedom * misfit**2) / 4.0 / max(misfit, 1.0) ** 2
    if gain <= 0.0 or STARTS * len(ZETAS) * fdtrc(4, freedom, gain) > LEVEL:
        raise InputError(
            f"the pair n = {n}: the tones do not distinguish two members: found a misfit of {misfit:.3g} with two and "
            f"{np.sqrt(one / (freedom + 4)):.3g} with one, expected one to misfit by more than noise: less noise, or "
            "more tones, closer to the peaks"
        )


def described(n: int, poles: FloatArray, parts: FloatArray, covariance: FloatArray, misfit: float) -> Pair:
    """The pair from poles (f1, f2, ln zeta1, ln zeta2) and linear parts (3, 2), with their joint covariance."""
    order = np.argsort(poles[:2])
    a, b = parts[:2, 0], parts[:2, 1]
    turn = np.zeros((2, 10))  # d psi/d(a, b), columns as in `jacobian`
    size = a**2 + b**2
    for k in range(2):
        turn[k, 4 + k], turn[k, 7 + k] = -b[k] / size[k] / n, a[k] / size[k] / n
    angle = np.mod(np.degrees(np.arctan2(b, a)) / n, 180.0 / n)
    sigma = np.sqrt(np.diag(covariance))
    apart = covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1]
    zeta = np.exp(poles[2:])
    return Pair(
        n=n,
        freq=poles[order],
        freq_sigma=sigma[order],
        zeta=zeta[order],
        zeta_sigma=(zeta * sigma[2:4])[order],
        angle_deg=angle[order],
        angle_sigma_deg=np.degrees(np.sqrt(np.einsum("ki,ij,kj->k", turn, covariance, turn)))[order],
        split=float(np.ptp(poles[:2])),
        split_sigma=float(np.sqrt(apart)),
        misfit=misfit,
    )


def basis(tones: FloatArray, poles: FloatArray, sigma: FloatArray) -> Array:
    """The resonances and the slow remainder, over the noise, (tones, members + 1)."""
    freq, log_zeta = np.split(poles, 2)
    omega, own, zeta = 2.0 * np.pi * tones[:, None], 2.0 * np.pi * freq, np.exp(log_zeta)
    h = 1j * omega / (own**2 - omega**2 + 2j * zeta * own * omega)
    return np.asarray(np.hstack([h, 1j * omega]) / sigma[:, None])


def real(values: Array) -> FloatArray:
    """Real parts above imaginary parts."""
    return np.concatenate([values.real, values.imag])


def linear_part(tones: FloatArray, poles: FloatArray, data: Array, sigma: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Best real (a, c), (b, s) for given poles, (members + 1, 2), and the residual over the noise."""
    A, y = real(basis(tones, poles, sigma)), real(data)
    scale = np.linalg.norm(A, axis=0)
    x = np.linalg.lstsq(A / scale, y, rcond=None)[0] / scale[:, None]
    return np.asarray(x), np.asarray((A @ x - y).ravel())


def fitted_poles(tones: FloatArray, data: Array, sigma: FloatArray, members: int = 2) -> FloatArray:
    """Frequencies [Hz], then ln zeta, of the best fit with a number of members, from a grid of starting points."""
    grid = np.linspace(tones[0], tones[-1], STARTS)
    starts = [np.r_[freq, np.log([zeta] * members)] for freq, zeta in product(combinations(grid, members), ZETAS)]
    cost = [np.sum(linear_part(tones, start, data, sigma)[1] ** 2) for start in starts]
    span = tones[-1] - tones[0]
    low, high = (np.repeat(ends, members) for ends in ([tones[0] - span, -14.0], [tones[-1] + span, -0.7]))
    found = [
        least_squares(
            lambda p: linear_part(tones, p, data, sigma)[1],
            starts[k],
            jac="3-point",
            bounds=(low, high),
            x_scale=np.repeat([span / STARTS, 0.5], members),
            xtol=1e-12,
            ftol=1e-12,
        )
        for k in np.argsort(cost)[:4]
    ]
    return np.asarray(min(found, key=lambda fit: float(fit.cost)).x)


def jacobian(tones: FloatArray, poles: FloatArray, parts: FloatArray, sigma: FloatArray) -> FloatArray:
    """Jacobian of the model over the noise: f1, f2, ln zeta1, ln zeta2, then a1, a2, c, b1, b2, s; (equations, 10)."""
    columns = []
    for k in range(4):
        step = np.zeros(4)
        step[k] = 1e-6 * (poles[k] if k < 2 else 1.0)
        change = real((basis(tones, poles + step, sigma) - basis(tones, poles - step, sigma)) @ parts) / (2.0 * step[k])
        columns.append(change.ravel())
    A = real(basis(tones, poles, sigma))
    columns += [np.multiply.outer(A[:, k], part).ravel() for part in np.eye(2) for k in range(3)]
    return np.stack(columns, axis=1)
