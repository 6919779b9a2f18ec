"""Identify the modes of one band, and their uncertainty by jackknife over the blocks of the record.

The modes of the whole record are found again without each block in turn (Efron and Stein, Ann. Stat. 9, 1981, 586). The
deviations are no less than the true ones on average, and larger for the shapes of close pairs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.experiment.identify.mode import Found, Residues
from casingfem.experiment.identify.output_only.bands import Band
from casingfem.experiment.identify.output_only.correlations import Correlations, zoomed
from casingfem.experiment.identify.output_only.subspace import Cluster, Swept, again, clusters, fits_in, swept
from casingfem.experiment.identify.thresholds import Thresholds
from casingfem.io.arrays import Array, FloatArray

PRESENT = 0.8  # of the records without a block, in which a mode must be found again
KNOWN = 0.5  # of a bandwidth: largest standard deviation of a frequency without a visible peak


class Estimated(NamedTuple):
    """A mode, and the share of the model orders in which it recurs."""

    found: Found
    recurs: float


def modes_of(
    found: Correlations, band: Band, most: int | None, rules: Thresholds
) -> tuple[list[Estimated], Stabilisation]:
    """Modes of a band and its diagram; `most` is the largest order, None takes it from the number of peaks."""
    zoom = zoomed(found.mean, found.fs, *band.ends)
    usual = min(rules.order_a_peak * max(len(band.seen), 1) + rules.order_extra, rules.order_most)
    largest = fits_in(zoom, most or usual)
    if largest < 2:
        return [], Stabilisation.join([])
    orders = range(max(1, largest // 4), largest + 1)
    whole = swept(zoom, orders)
    candidates, diagram = clusters(whole, orders, rules)
    parts = [swept(zoomed(found.without(block), found.fs, *band.ends), orders) for block in range(len(found.R))]
    found_again = [_jackknifed(cluster, whole, parts, len(orders), rules) for cluster in candidates]
    every = [estimated for estimated in found_again if estimated is not None]
    modes = [estimated for estimated in every if _known(estimated.found, rules)]
    for peak in band.seen.tolist():  # the nearest mode of each peak without a well-known mode
        near = [each for each in every if abs(each.found.freq - peak) < each.found.zeta * peak]
        if near and not any(each in modes for each in near):
            modes.append(min(near, key=lambda each: abs(each.found.freq - peak)))
    inside = [mode for mode in modes if band.low <= mode.found.freq < band.high]
    return sorted(inside, key=lambda each: each.found.freq), diagram


def _jackknifed(cluster: Cluster, whole: Swept, parts: list[Swept], orders: int, rules: Thresholds) -> Estimated | None:
    """Add the jackknife uncertainty to a mode; return None if too few of the records without a block contain it."""
    mode = again(whole, cluster, rules)
    others = [other for part in parts if (other := again(part, cluster, rules)) is not None]
    count = len(others)
    if mode is None or count < PRESENT * len(parts):
        return None
    poles = np.array([other.pole for other in others])
    factor = float(np.sqrt((count - 1) / count))
    freq, zeta = _numbers(np.array([mode.pole]))
    spread = [factor * float(np.sqrt(np.sum((v - v.mean()) ** 2))) for v in _numbers(poles)]
    A = np.array([other.A for other in others])
    moved = (factor * (A - A.mean(axis=0))).reshape(count, -1).T
    residues = Residues(mode.A.ravel(), np.zeros(mode.A.size), moved)
    signal = float(np.linalg.norm(mode.A) / (np.linalg.norm(moved) + 1e-300))
    found = Found(float(freq[0]), spread[0], float(zeta[0]), spread[1], residues, signal, float("nan"))
    return Estimated(found, len(mode.orders) / orders)


def _numbers(poles: Array) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and damping ratios."""
    size: FloatArray = np.hypot(poles.real, poles.imag)
    return np.asarray(size / (2.0 * np.pi), np.float64), np.asarray(-poles.real / size, np.float64)


def _known(found: Found, rules: Thresholds) -> bool:
    """Whether a mode without a visible peak is well determined: precise frequency, and damping above zero."""
    wide = 2.0 * found.zeta * found.freq
    return found.sigma_freq < KNOWN * wide and rules.above_zero * found.sigma_zeta < found.zeta
