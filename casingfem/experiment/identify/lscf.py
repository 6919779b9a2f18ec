"""Poles that recur over increasing model orders, in bands of a few visible peaks: the p-LSCF estimator in NumPy.

Over the lines of a band, with z_k = exp(i a k/(L - 1)) on an arc a, each response is N_c(z)/D(z) with one denominator
for all channels. The equation error w_k (N_c - H_c D) is linear in the coefficients; with the numerators eliminated,

    M = sum_c U_c - S_c^H R^-1 S_c,   min d^H M d,   d_n = 1,

and the leading blocks of the one M give the denominators of all orders (Peeters, Van der Auweraer, Guillaume and
Leuridan, Shock and Vibration 11, 2004, 395). With the highest coefficient fixed, computational poles come out
unstable and are dropped. Coefficients are complex: nothing is mirrored at the lower end of a band.

A record that ends D seconds after the hit, before the ringing has decayed, adds -e^{(p - i omega) D}/(i omega - p) to
each mode: a second numerator, multiplied by e^{-i omega D}, makes the model exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.responses import Responses
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray, freeze
from contact.io.progress import each

ARC = 1.5 * np.pi  # of the unit circle; a whole circle would require equal values at both ends of the band
OUTSIDE = 0.05  # of a band, beyond its ends, where poles are kept
EMPTY_LINES = 1500  # of a band without visible peaks


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stabilisation:
    """Poles of all orders: freq [Hz], zeta, order, stable, each (poles,)."""

    freq: FloatArray
    zeta: FloatArray
    order: IntArray
    stable: BoolArray

    def __post_init__(self) -> None:
        freeze(self, "freq", "zeta", "order", "stable")

    def __repr__(self) -> str:
        return f"Stabilisation({len(self.freq)} poles, {int(self.stable.sum())} stable)"

    @classmethod
    def join(cls, parts: list[Stabilisation]) -> Stabilisation:
        """One diagram of several bands."""
        kinds = {"freq": np.float64, "zeta": np.float64, "order": np.int64, "stable": np.bool_}
        joined: dict[str, Array] = {
            name: np.concatenate([np.zeros(0, kind), *(getattr(part, name) for part in parts)]).astype(kind)
            for name, kind in kinds.items()
        }
        return cls(**joined)


class Candidates(NamedTuple):
    """Poles [rad/s] that recur, ascending, and the diagram of all."""

    poles: Array
    diagram: Stabilisation


class Band(NamedTuple):
    """Lines within which poles count, lines of the window around them, and the number of visible peaks there."""

    core: slice
    window: slice
    peaks: int


def normal_matrix(Y: Array, order: int, late: Array | None = None) -> Array:
    """M (order + 1, order + 1) of the denominators, from responses Y (lines, channels) over their noise.

    `late` (lines,) is e^{-i omega D} if the record ends before the ringing has decayed, D seconds after the hit.
    """
    lines = len(Y)
    powers = np.exp(1j * ARC * np.arange(lines) / (lines - 1))[:, None] ** np.arange(order + 1)
    numerators = powers if late is None else np.concatenate([powers, late[:, None] * powers], axis=1)
    Q = np.linalg.qr(numerators)[0]
    M = np.zeros((order + 1, order + 1), complex)
    for response in Y.T:
        columns = response[:, None] * powers
        rest = columns - Q @ (Q.conj().T @ columns)
        M += rest.conj().T @ rest
    return M


def swept_poles(freq: FloatArray, M: Array, orders: range) -> list[Array]:
    """Stable poles [rad/s] of a band for each order, from M."""
    arc = ARC / (2.0 * np.pi * (freq[-1] - freq[0]))  # seconds
    band = 2.0 * np.pi * (freq[-1] - freq[0])
    swept = []
    for order in orders:
        block = M[:order, :order] + 1e-15 * np.trace(M[:order, :order]).real / order * np.eye(order)
        coefficients = np.r_[np.linalg.solve(block, -M[:order, order]), 1.0]
        z = np.roots(coefficients[::-1])
        s = np.log(z[np.abs(z) > 0.0]) / arc
        imag = np.mod(s.imag + OUTSIDE * band, 2.0 * np.pi / arc) - OUTSIDE * band
        keep = (s.real < 0.0) & (imag < (1.0 + OUTSIDE) * band)
        swept.append(s.real[keep] + 1j * (imag[keep] + 2.0 * np.pi * freq[0]))
    return swept


def recurring(swept: list[Array], orders: range, rules: Thresholds = USUAL) -> Candidates:
    """Cluster the poles of growing orders by frequency and damping; clusters that recur are the candidates.

    Examples
    --------
    >>> pole = 2 * np.pi * 100.0 * (-0.005 + 1j)
    >>> found = recurring([np.array([pole, 2 * np.pi * (-1.0 + 1j * (70.0 + k))]) for k in range(8)], range(1, 9))
    >>> found.poles.round(3).tolist(), found.diagram
    ([(-3.142+628.319j)], Stabilisation(16 poles, 8 stable))
    """
    poles = np.concatenate([np.zeros(0, complex), *swept])
    order = np.repeat(np.array(orders), [len(each) for each in swept])
    freq, zeta = np.abs(poles) / (2.0 * np.pi), -poles.real / np.maximum(np.abs(poles), 1e-300)
    free, stable = zeta < rules.zeta_most, np.zeros(len(poles), bool)
    found: list[complex] = []
    for k in np.argsort(-order, kind="stable").tolist():
        if not free[k]:
            continue
        width = 2.0 * zeta[k] * freq[k]
        like = free & (np.abs(poles.imag - poles.imag[k]) < 2.0 * np.pi * rules.same_freq * width)
        like &= np.abs(poles.real - poles.real[k]) < -rules.same_zeta * poles.real[k]
        if len(np.unique(order[like])) >= max(2.0, rules.recurs * len(orders)):
            found.append(complex(np.median(poles.real[like]), np.median(poles.imag[like])))
            stable |= like
            free &= ~like
    some = np.array(sorted(found, key=lambda pole: pole.imag), complex)
    return Candidates(some, Stabilisation(freq=freq, zeta=zeta, order=order, stable=stable))


def candidates(
    freq: FloatArray,
    Y: Array,
    peaks: int,
    end: float = np.inf,
    most: int | None = None,
    rules: Thresholds = USUAL,
    every: int = 1,
) -> Candidates:
    """Poles that recur over the orders in a band with that many visible peaks.

    Y (lines, channels) are responses over their noise, `end` is the duration of the recorded ringing [s]. `most` is
    the largest order; None takes it from the number of peaks. `every` is the step of the orders.

    Examples
    --------
    >>> freq = np.arange(90.0, 110.0, 0.1)
    >>> poles = 2 * np.pi * np.array([-0.5 + 100.0j, -0.3 + 101.0j])
    >>> rng = np.random.default_rng(2)
    >>> Y = (1.0 / (2j * np.pi * freq[:, None] - poles)) @ np.array([[1.0, -1.0, 2.0], [1.0, 1.0, 1.0]])
    >>> Y += 1e-5 * rng.normal(size=Y.shape) * (1 + 1j)
    >>> bool(np.abs(candidates(freq, Y, 1).poles - poles).max() < 1e-3)
    True
    """
    largest = most or min(rules.order_a_peak * peaks + rules.order_extra, rules.order_most)
    largest = max(2, min(largest, len(freq) // 4))
    late = None if not np.isfinite(end) else np.exp(-2j * np.pi * freq * end)
    M = normal_matrix(compressed(Y), largest, late)
    orders = range(max(1, largest // 4), largest + 1, every)
    return recurring(swept_poles(freq, M, orders), orders, rules)


def compressed(Y: Array) -> Array:
    """Compress responses to (lines, components) with the same products over the channels, without noise.

    Components below the largest singular value that noise of unit variance (real part) gives are dropped:
    sqrt(2) (sqrt(lines) + sqrt(channels)).
    """
    lines, channels = Y.shape
    if channels <= 8:
        return Y
    values, vectors = np.linalg.eigh(Y.conj().T @ Y if channels < lines else Y @ Y.conj().T)
    keep = values > 2.0 * (np.sqrt(lines) + np.sqrt(channels)) ** 2
    keep[-8:] = True
    if channels < lines:
        return np.asarray(Y @ vectors[:, keep])
    return np.asarray(vectors[:, keep] * np.sqrt(np.maximum(values[keep], 0.0)))


def bands(power: FloatArray, at: IntArray, rules: Thresholds = USUAL) -> list[Band]:
    """Divide lines of a mode indicator `power` (lines,) into bands of a few visible peaks, which are `at` these lines.

    The limits are in the deepest valleys between groups of peaks.
    """
    most = rules.peaks_a_band
    cuts = [0]
    start = 0
    while len(at) - start > most:
        choices = range(start + most // 2, start + most)
        valleys = [int(at[k - 1] + np.argmin(power[at[k - 1] : at[k] + 1])) for k in choices]
        best = int(np.argmin([power[v] for v in valleys]))
        cuts.append(valleys[best])
        start += most // 2 + best
    cuts.append(len(power))
    whole = []
    for low, high in pairwise(cuts):
        pieces = max(1, -(-(high - low) // (4 * EMPTY_LINES)))
        edges = np.linspace(low, high, pieces + 1).astype(int).tolist()
        for first, end in pairwise(edges):
            margin = max(rules.reach_lines, (end - first) // 12)
            window = slice(max(0, first - margin), min(len(power), end + margin))
            inside = int(np.sum((at >= window.start) & (at < window.stop)))
            whole.append(Band(slice(first, end), window, inside))
    return whole


def bands_of(data: Responses, rules: Thresholds = USUAL) -> list[Band]:
    """Bands of a few visible peaks."""
    return bands(np.sum(np.abs(data.Y) ** 2, axis=1), data.peaks.at, rules)


def recurring_poles(data: Responses, most: int | None, rules: Thresholds = USUAL) -> Candidates:
    """Poles that recur in any band, and the diagram of all bands."""
    poles, diagrams = [np.zeros(0, complex)], list[Stabilisation]()
    for core, window, count in each(bands_of(data, rules), "poles: band"):
        Y = data.along[window, None] * data.Y[window]
        found = candidates(data.freq[window], Y, count, data.end, most, rules)
        low = data.freq[core.start] if core.start else -np.inf
        high = data.freq[core.stop] if core.stop < len(data.freq) else np.inf
        inside = (found.poles.imag >= 2.0 * np.pi * low) & (found.poles.imag < 2.0 * np.pi * high)
        drawn = (found.diagram.freq >= low) & (found.diagram.freq < high)
        poles.append(found.poles[inside])
        diagrams.append(
            Stabilisation(**{name: getattr(found.diagram, name)[drawn] for name in found.diagram.__slots__})
        )
    return Candidates(np.concatenate(poles), Stabilisation.join(diagrams))
