"""Poles of growing model orders by sdypy-EMA, and which of them stay: the stabilisation diagram, read by a rule.

A pole of one order is stable if the next lower order has one with the same frequency, damping and shape; poles that
come back in most orders are the start of the fit. Nobody has to click.

sdypy-EMA (extra `test-data`, known here alone) has the least-squares complex frequency estimator (LSCF), which fits a
common denominator in z = exp(-i omega dt). Over a band that starts far above zero its normal equations are weak,
because the band fills a small arc of the unit circle. Here the band is moved down to start at zero: then it fills half
the circle, noise gives poles of negative damping, and structure poles of positive damping.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from casingfem.errors import MissingExtraError
from casingfem.extras import remedy
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray, freeze

SAME_FREQ, SAME_ZETA, SAME_SHAPE = 0.3, 0.3, 0.9  # of a half-power bandwidth; relative; MAC
OFTEN = 0.4  # of the orders in the upper half
ZETA_MAX = 0.1


def lscf_poles(freq: FloatArray, H: Array, order: int) -> list[Array]:
    """Poles [rad/s] of a band by LSCF, one array for each number of modes 1, 2, ... `order`.

    Verboven, Frequency-domain System Identification for Modal Analysis, PhD thesis, Vrije Universiteit Brussel
    (2002), section 5.3, as sdypy-EMA has it. Only poles of positive damping and frequency are kept.

    Parameters
    ----------
    freq : evenly spaced lines [Hz], (lines,)
    H : responses (channels, lines), complex
    order : largest number of modes

    Raises
    ------
    MissingExtraError
        sdypy-EMA is not installed.

    Examples
    --------
    >>> freq = np.arange(90.0, 110.0, 0.1)
    >>> pole = 2 * np.pi * 100.0 * (-0.005 + 1j)
    >>> found = lscf_poles(freq, (1.0 / (2j * np.pi * freq - pole))[None], 6)[-1]
    >>> round(float(abs(found[np.abs(found - pole).argmin()]) / (2 * np.pi)), 2)
    100.0
    """
    model = _ema().Model(
        frf=H,
        freq=freq - freq[0],
        lower=float(freq[1] - freq[0]),  # with 0 its denominator would be wrong: it sums over no lines
        upper=float(freq[-1] - freq[0]),
        pol_order_high=order,
    )
    model.get_poles(method="lscf", show_progress=False)
    swept = []
    for found in model.all_poles:
        kept = found[(found.imag > 0.0) & (found.real < 0.0) & np.isfinite(found)]
        swept.append(kept + 2j * np.pi * freq[0])
    return swept


def _ema() -> Any:
    """sdypy-EMA, or what to install."""
    try:
        import sdypy.EMA
    except ImportError as error:
        message = f"modes are identified with sdypy-EMA, which is not installed: {remedy('test-data')}"
        raise MissingExtraError(message) from error
    return sdypy.EMA


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


def join(parts: list[Stabilisation], cores: list[tuple[float, float]]) -> Stabilisation:
    """One diagram of several bands, each with its poles in [from, to) Hz."""
    kept = [(part.freq >= low) & (part.freq < high) for part, (low, high) in zip(parts, cores, strict=True)]
    arrays: dict[str, Array] = {
        name: np.concatenate(
            [np.zeros(0, kind), *(getattr(part, name)[k] for part, k in zip(parts, kept, strict=True))]
        )
        for name, kind in (("freq", float), ("zeta", float), ("order", np.int64), ("stable", bool))
    }
    return Stabilisation(**arrays)


def residues(poles: Array, freq: FloatArray, H: Array) -> Array:
    """Complex residues (poles, channels) of H with a constant and a slope beside them, by least squares (LSFD)."""
    s = 2j * np.pi * freq[:, None]
    span = np.linspace(-1.0, 1.0, len(freq))[:, None]
    columns = np.concatenate([abs(poles.real) / (s - poles), np.ones_like(span), span], axis=1)
    return np.asarray(np.linalg.lstsq(columns, H.T, rcond=None)[0][: len(poles)])


def stabilise(swept: list[Array], freq: FloatArray, H: Array) -> tuple[Stabilisation, FloatArray]:
    """The diagram of poles [rad/s] of orders 1, 2, ..., and the poles that come back: (modes, 2) of freq [Hz], zeta.

    Examples
    --------
    >>> freq = np.arange(95.0, 105.0, 0.05)
    >>> pole = 2 * np.pi * 100.0 * (-0.005 + 1j)
    >>> chance = [2 * np.pi * (-1.0 + 1j * (96.0 + k)) for k in range(8)]
    >>> H = (1.0 / (2j * np.pi * freq - pole))[None]
    >>> diagram, starts = stabilise([np.array([pole, other]) for other in chance], freq, H)
    >>> diagram, starts.round(4).tolist()
    (Stabilisation(16 poles, 7 stable), [[100.0012, 0.005]])
    """
    all_poles: list[FloatArray] = []
    clusters: list[list[tuple[float, float]]] = []
    before = np.zeros((0, 2)), np.zeros((0, len(H)), complex)
    shapes: list[Array] = []
    upper = len(swept) // 2
    for order, poles in enumerate(swept, start=1):
        here = np.column_stack([np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles)])
        good = here[:, 1] < ZETA_MAX
        here, poles = here[good], poles[good]
        shape = residues(poles, freq, H)
        same = _alike(here, shape, *before)
        stays = same.any(axis=1)
        all_poles.append(np.column_stack([here, np.full(len(here), order), stays]))
        if order > upper:
            _collect(clusters, shapes, here[stays], shape[stays])
        before = here, shape
    often = [np.median(cluster, axis=0) for cluster in clusters if len(cluster) >= OFTEN * (len(swept) - upper)]
    starts = np.array(sorted(often, key=lambda pole: float(pole[0]))).reshape(-1, 2)
    freqs, zetas, orders, stable = np.concatenate(all_poles).T
    diagram = Stabilisation(freq=freqs, zeta=zetas, order=orders.astype(np.int64), stable=stable == 1.0)
    return diagram, starts


def _alike(a: FloatArray, a_shape: Array, b: FloatArray, b_shape: Array) -> BoolArray:
    """Which poles of a have the frequency, damping and shape of which poles of b, (a, b)."""
    width = 2.0 * (a[:, 1] * a[:, 0])[:, None]
    close = np.abs(a[:, None, 0] - b[None, :, 0]) < SAME_FREQ * width
    damped = np.abs(a[:, None, 1] - b[None, :, 1]) < SAME_ZETA * a[:, None, 1]
    norms = np.outer(np.sum(np.abs(a_shape) ** 2, axis=1), np.sum(np.abs(b_shape) ** 2, axis=1)) + 1e-300
    shaped = np.abs(a_shape.conj() @ b_shape.T) ** 2 > SAME_SHAPE * norms
    return np.asarray(close & damped & shaped)


def _collect(
    clusters: list[list[tuple[float, float]]], shapes: list[Array], found: FloatArray, found_shapes: Array
) -> None:
    """Put each pole into the cluster whose last member it is like, or into one of its own."""
    last = np.array([cluster[-1] for cluster in clusters]).reshape(-1, 2)
    last_shapes = np.array(shapes).reshape(-1, found_shapes.shape[1])
    same = _alike(found, found_shapes, last, last_shapes)
    for k, (f, zeta) in enumerate(found.tolist()):
        at = int(np.argmax(same[k])) if same.shape[1] and same[k].any() else -1
        if at >= 0:
            same[:, at] = False
            clusters[at].append((f, zeta))
            shapes[at] = found_shapes[k]
        else:
            clusters.append([(f, zeta)])
            shapes.append(found_shapes[k])
