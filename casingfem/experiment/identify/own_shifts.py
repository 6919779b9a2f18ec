"""Whether a pole is needed, or whether each channel has its peaks at frequencies of its own.

A roving mass, a moved hammer, a warm afternoon: one mode's peak then lies at slightly different frequencies in
different channels, and two or more common poles fit that well. So does a pair. They differ where it counts: a pair
has two peaks in a channel, or none where the members' shapes cancel; a shifted peak is one peak of that channel's
own. Both are fitted, and the sums of squares compared.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.stats import norm as normal
from scipy.stats import t as student

from casingfem.experiment.identify.bands import line_noise
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.experiment.identify.pole_window import Window
from casingfem.io.arrays import Array, FloatArray, IntArray

REACH = 0.012, 6.0  # largest shift: relative, in damping ratios
GRID = 25  # starts over it
AROUND, LEAST_LINES = 8.0, 40  # damping ratios beyond it that lines are taken from, and so many at least
STEPS = 16
SETTLED = 0.5  # of the noise's variance: a gain that ends the fit
TAIL, LEAST_FREEDOM = 0.025, 1.5  # beyond either end of an interval; degrees of freedom of few set-ups
LEAST, MOST_ZETA = 1e-6, 0.5
TRUST = 0.7  # of a half-power half-width: largest step
MOST = 4  # shifted modes that a cluster of poles is taken for, at most
SHIFTED = 0.006, 6.0  # distance of neighbours that one mode's shifted peaks may have: relative, in damping ratios


class OwnPeaks(NamedTuple):
    """Each channel's own frequencies [Hz] of some poles, (poles, channels), and damping (poles,).

    With residues (poles, channels), the information about ln f in units of the noise, and the sum of squares left.
    """

    freq: FloatArray
    zeta: FloatArray
    residues: Array
    information: FloatArray
    squares: float


def own_peaks(fit: PoleFit, poles: IntArray, starts: FloatArray, noise: float) -> OwnPeaks:
    """Refit poles of a fit, from starts (as many or fewer, 2), with a frequency of their own in each channel.

    What other poles and polynomials have is taken off first, and the lines are those near by. Variable projection as
    in `pole_fit.py`, all channels at once, from the best of a grid of common shifts; damping is common to the
    channels. `noise` is the variance of an entry: a step that gains less is the last.
    """
    window, lines = fit.window, near_lines(fit, poles)
    A = fit.A[poles][:, 0] + (1j * fit.A[poles][:, 1] if fit.window.columns == 2 else 0.0)
    R = fit.spread[lines] + window.peaks(fit.freq[poles], fit.zeta[poles])[0][lines] @ A
    window = replace(window, freq=window.freq[lines], Y=np.concatenate([R.real, R.imag]))
    unit = (fit.window.scale / window.scale) ** window.power
    Q = np.linalg.qr(window.residuals())[0]
    R = _complex(window.Y - Q @ (Q.T @ window.Y))
    real, channels = window.columns == 1, R.shape[1]
    f, z = starts[:, :1], starts[:, 1:]
    reach = min(REACH[0], REACH[1] * float(z.max()))
    best, shift = np.full(channels, -np.inf), np.zeros(channels)
    for by in np.linspace(-reach, reach, GRID).tolist():
        gain = _gain(_across(Q, window.peaks(f[:, 0] * np.exp(by), z[:, 0])[0]), R, real)
        shift, best = np.where(gain > best, by, shift), np.maximum(gain, best)
    p, q = np.log(f) + shift, np.log(z)
    low, high = np.log(f) - reach, np.log(f) + reach
    damping = 1e-3
    at = _state(window, Q, R, p, q, damping)
    for _ in range(STEPS):
        by, bz = np.clip(at.by_freq, -TRUST * np.exp(at.q), TRUST * np.exp(at.q)), np.clip(at.by_zeta, -TRUST, TRUST)
        p, q = np.clip(at.p + by, low, high), np.clip(at.q + bz, np.log(LEAST), np.log(MOST_ZETA))
        new = _state(window, Q, R, p, q, damping)
        if new.squares >= at.squares:
            damping *= 10.0
            at = _state(window, Q, R, at.p, at.q, damping)
            continue
        settled = at.squares - new.squares < SETTLED * noise
        at, damping = new, 0.3 * damping
        if settled:
            break
    return OwnPeaks(np.exp(at.p), np.exp(at.q[:, 0]), unit * at.A, at.information, at.squares)


def near_lines(fit: PoleFit, poles: IntArray) -> slice:
    """Lines about poles, as far as their peaks may be shifted and a few bandwidths more."""
    freq, zeta = fit.freq[poles], float(fit.zeta[poles].max())
    reach = min(REACH[0], REACH[1] * zeta) + AROUND * zeta
    ends = np.searchsorted(fit.window.freq, [freq.min() * (1.0 - reach), freq.max() * (1.0 + reach)]).tolist()
    first = max(min(ends[0], ends[1] - LEAST_LINES, len(fit.window.freq) - LEAST_LINES), 0)
    return slice(first, min(max(ends[1], first + LEAST_LINES), len(fit.window.freq)))


class Reading(NamedTuple):
    """As many poles (poles, 2) as own peaks need, and by how much the data prefer those (ln of odds, doubled)."""

    starts: FloatArray
    evidence: float


def shifted_reading(fit: PoleFit, low: float, high: float) -> Reading:
    """Each cluster of poles read as few modes with peaks shifted from channel to channel, between two frequencies [Hz].

    Both readings of a cluster of n poles are weighed by the Bayesian information criterion: n common poles, each with
    s residues in C channels, s C n + 2 n numbers; m modes with own frequencies, (s + 1) C m + m. A test either has such
    shifts or not, so the evidence of all its clusters, those of one pole too, is to be summed.
    """
    window, evidence, poles = fit.window, 0.0, list[tuple[float, float]]()
    channels, s = window.Y.shape[1], window.columns
    noise = max(noise_squares(fit) / window.Y.size, window.floor**2, 1e-300)
    log = np.log(window.Y.size)
    for cluster in clusters(fit):
        middle = float(fit.freq[cluster].mean())
        if not low <= middle < high:
            poles += [*zip(fit.freq[cluster].tolist(), fit.zeta[cluster].tolist(), strict=True)]
            continue
        squares = float(np.sum(np.abs(fit.spread[near_lines(fit, cluster)]) ** 2))
        common = squares / noise + log * (s * channels + 2) * len(cluster)
        best, least = None, np.inf
        for m in range(1, min(MOST, len(cluster)) + 1):
            own = own_peaks(fit, cluster, merged(fit, cluster, m), noise)
            cost = own.squares / noise + log * ((s + 1) * channels + 1) * m
            if cost >= least:
                break
            best, least = own, cost
        assert best is not None
        evidence += common - least
        poles += [*zip(common_freq(best, noise)[0].tolist(), best.zeta.tolist(), strict=True)]
    return Reading(np.array(sorted(poles)).reshape(-1, 2), evidence)


def common_freq(own: OwnPeaks, noise: float) -> tuple[FloatArray, FloatArray]:
    """Mean frequency [Hz] of each pole over the channels, and its standard deviation, (poles,).

    Channels have their own noise and what the shifts scatter beside it (DerSimonian and Laird, Control. Clin. Trials
    7, 1986, 177). Channels of one set-up share a shift: neighbours that are alike count as fewer, and
    1.96 standard deviations are the 95 % interval of Student's t of so many.
    """
    logs, own_variance = np.log(own.freq), noise / np.maximum(own.information, 1e-300)
    weight = 1.0 / own_variance
    mean = (weight * logs).sum(axis=1) / weight.sum(axis=1)
    channels = logs.shape[1]
    excess = (weight * (logs - mean[:, None]) ** 2).sum(axis=1) - (channels - 1)
    spare = weight.sum(axis=1) - (weight**2).sum(axis=1) / weight.sum(axis=1)
    between = np.maximum(excess / np.maximum(spare, 1e-300), 0.0)
    weight = 1.0 / (own_variance + between[:, None])
    mean = (weight * logs).sum(axis=1) / weight.sum(axis=1)
    off = np.sqrt(weight) * (logs - mean[:, None])
    alike = np.clip((off[:, 1:] * off[:, :-1]).sum(axis=1) / np.maximum((off**2).sum(axis=1), 1e-300), 0.0, 0.9)
    sigma = np.sqrt((1.0 + alike) / (1.0 - alike) / weight.sum(axis=1))
    freedom = np.maximum(channels * (1.0 - alike) / (1.0 + alike) - 1.0, LEAST_FREEDOM)
    sigma *= np.where(between > 0.0, student.isf(TAIL, freedom) / normal.isf(TAIL), 1.0)
    return np.exp(mean), np.exp(mean) * sigma


def aligned(fit: PoleFit) -> tuple[Window, FloatArray]:
    """The window as it would be if no channel had shifted peaks, and the deviations (poles,) of ln f that this leaves.

    From each channel its own resonances are taken, and common ones of the same residues put in their place.
    """
    noise = max(noise_squares(fit) / fit.window.Y.size, fit.window.floor**2, 1e-300)
    correction, sigma = np.zeros(fit.spread.shape, complex), np.zeros(len(fit.freq))
    for cluster in clusters(fit):
        own = own_peaks(fit, cluster, np.column_stack([fit.freq[cluster], fit.zeta[cluster]]), noise)
        mean, sigma[cluster] = common_freq(own, noise)
        sigma[cluster] /= mean
        for k, zeta in enumerate(own.zeta.tolist()):
            there = fit.window.peaks(own.freq[k], np.full(own.freq.shape[1], zeta))[0]
            here = fit.window.peaks(mean[k : k + 1], np.array([zeta]))[0]
            correction += own.residues[k] * (here - there)
    stacked = np.concatenate([correction.real, correction.imag])
    return replace(fit.window, Y=fit.window.Y + stacked), sigma


def clusters(fit: PoleFit) -> list[IntArray]:
    """Poles so near each other that one mode's shifted peaks may be several of them."""
    near = np.minimum(SHIFTED[0], SHIFTED[1] * np.maximum(fit.zeta[:-1], fit.zeta[1:])) * fit.freq[:-1]
    cuts = np.flatnonzero(np.diff(fit.freq) > near) + 1
    return [cluster for cluster in np.split(np.arange(len(fit.freq)), cuts) if len(cluster)]


def merged(fit: PoleFit, cluster: IntArray, count: int) -> FloatArray:
    """Poles of a cluster put together, nearest ones first, until so many are left: (count, 2) of freq [Hz], zeta."""
    size = np.linalg.norm(fit.A[cluster].reshape(len(cluster), -1), axis=1)[:, None] ** 2
    poles = np.column_stack([fit.freq[cluster], fit.zeta[cluster]])
    while len(poles) > count:
        k = int(np.argmin(np.diff(poles[:, 0])))
        both = slice(k, k + 2)
        poles[k], size[k] = (poles[both] * size[both]).sum(axis=0) / size[both].sum(), size[both].sum()
        poles, size = np.delete(poles, k + 1, axis=0), np.delete(size, k + 1, axis=0)
    return poles


def noise_squares(fit: PoleFit) -> float:
    """Sum of squares that noise alone would have, by the differences between neighbouring lines of the deviation."""
    return float(2.0 * len(fit.spread) * np.sum(line_noise(fit.spread.T) ** 2))


class _State(NamedTuple):
    """Everything at ln f = p (poles, channels), ln zeta = q (poles, 1), with the damped Gauss-Newton step of both."""

    p: FloatArray
    q: FloatArray
    A: Array
    squares: float
    information: FloatArray
    by_freq: FloatArray
    by_zeta: FloatArray


def _state(window: Window, Q: FloatArray, R: Array, p: FloatArray, q: FloatArray, damping: float) -> _State:
    """Squares left, and the step."""
    m, channels = p.shape
    g, slopes = window.peaks(np.exp(p).ravel(), np.repeat(np.exp(q[:, 0]), channels))
    both = _across(Q, np.concatenate([g, *slopes], axis=1)).reshape(len(R), 3, m, channels)
    g, d = both[:, 0], both[:, 1:].reshape(len(R), 2 * m, channels)
    part = np.real if window.columns == 1 else np.asarray
    gram = part(np.einsum("lic,ljc->cij", g.conj(), g, optimize=True))
    gram = gram + 1e-10 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(m)
    A = np.linalg.solve(gram, part(np.einsum("lic,lc->ci", g.conj(), R))[..., None])[..., 0]
    rest = R - np.einsum("lic,ci->lc", g, A)
    along = np.linalg.solve(gram, part(np.einsum("lic,ljc->cij", g.conj(), d, optimize=True)))
    J = (np.einsum("lic,cij->ljc", g, along, optimize=True) - d) * np.tile(A.T, (2, 1))
    normal = np.einsum("lic,ljc->cij", J.conj(), J, optimize=True).real
    information = np.einsum("cii->ic", normal)[:m].copy()
    normal = normal + (damping * np.einsum("cii->ci", normal) + 1e-300)[:, :, None] * np.eye(2 * m)
    gradient = np.einsum("lic,lc->ci", J.conj(), rest).real
    own, cross = normal[:, :m, :m], normal[:, :m, m:]
    inner = np.linalg.solve(own, np.concatenate([cross, gradient[:, :m, None]], axis=2))
    common = normal[:, m:, m:].sum(axis=0) - np.einsum("cij,cik->jk", cross, inner[:, :, :m])
    pull = gradient[:, m:].sum(axis=0) - np.einsum("cij,ci->j", cross, inner[:, :, m])
    by_zeta = -np.linalg.solve(common, pull)
    by_freq = -inner[:, :, m] - inner[:, :, :m] @ by_zeta
    return _State(p, q, A.T, float(np.sum(np.abs(rest) ** 2)), information, by_freq.T, by_zeta[:, None])


def _complex(stacked: FloatArray) -> Array:
    """Real parts over imaginary ones, as complex numbers."""
    half = len(stacked) // 2
    return np.asarray(stacked[:half] + 1j * stacked[half:])


def _across(Q: FloatArray, g: Array) -> Array:
    """Columns without what the basis Q (2 lines, terms) holds."""
    stacked = np.concatenate([g.real, g.imag])
    return _complex(stacked - Q @ (Q.T @ stacked))


def _gain(g: Array, R: Array, real: bool) -> FloatArray:
    """Fall of each channel's sum of squares by resonances g (lines, poles)."""
    if real:
        q, r = np.linalg.qr(np.concatenate([g.real, g.imag]))[0], np.concatenate([R.real, R.imag])
        return np.asarray(np.sum((q.T @ r) ** 2, axis=0))
    return np.asarray(np.sum(np.abs(np.linalg.qr(g)[0].conj().T @ R) ** 2, axis=0))
