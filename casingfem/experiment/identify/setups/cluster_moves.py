"""Better places for the modes of a cluster: fits end where they began to, and what is missed moves its neighbours.

A fit by steps does not leave the place that it fell into: a set-up may take one mode for the next, a weak or local
mode may be missed, one mode may be given twice. So a cluster that is fitted is tried again with one set-up put where
the others are, with one more mode where most is left, and without the one that tells least; what lowers the criterion
is kept.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from casingfem.experiment.identify.setups.cluster_modes import ClusterModes, fit_again, only_peaks
from casingfem.experiment.identify.setups.clusters import TOGETHER, Cluster
from casingfem.experiment.identify.setups.own_shifts import OwnPeaks, Setups, squares_at
from casingfem.experiment.identify.setups.places import best_beside
from casingfem.io.arrays import FloatArray

ROUNDS = 4  # of trying
WIDER = 1.0, 3.0  # times the usual damping, that a further mode is tried with
LEAST_GAIN = 0.5  # of its price, that a further mode must take before it is fitted
MOST_LOSS = 3.0  # of its price, that a mode may take and be tried to be left out
SETTLED = 1.0  # fall of the criterion that counts
MOVED = 0.1  # half-power bandwidths: a set-up that is put elsewhere by less stays


def improved(setups: Setups, damped: float, c: Cluster) -> ClusterModes:
    """The modes of a cluster, fitted again from better places as long as the criterion falls.

    Where every channel is a set-up of its own they stay: no other channel confirms there what is found.
    """
    best = only_peaks(c, setups, fit_again(c, setups, c.modes.freq, c.modes.zeta), damped)
    for _ in range(ROUNDS if max(len(channels) for channels in setups) > 1 else 0):
        before = best
        for move in (_together, _one_more, _one_fewer):
            for freq, zeta in move(c, setups, best):
                own = only_peaks(c, setups, fit_again(c, setups, freq, zeta), damped)
                if _better(c, setups, own, best):
                    best = own
        if best is before:
            break
    return ClusterModes(c, best)


def _better(c: Cluster, setups: Setups, new: OwnPeaks, old: OwnPeaks) -> bool:
    """Whether the criterion falls, by the noise that the better of both leaves on the peaks."""
    noise = min(new.on_peaks, old.on_peaks)
    costs = [ClusterModes(c, own).cost(len(setups), noise) for own in (new, old)]
    return costs[0] < costs[1] - SETTLED


def _price(c: Cluster, setups: Setups, own: OwnPeaks) -> float:
    """Squares that one mode must take."""
    one = c.cost(0.0, 1, len(setups) + 1, own.on_peaks)
    return one * max(own.on_peaks, c.noise)


def _together(c: Cluster, setups: Setups, own: OwnPeaks) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Starts with one set-up at the mean frequencies of the others."""
    zeta = own.zeta[:, 0]
    for s in range(len(setups) if len(setups) > 1 else 0):
        freq = own.freq.copy()
        freq[:, s] = np.delete(own.freq, s, axis=1).mean(axis=1)
        if np.any(np.abs(freq[:, s] - own.freq[:, s]) > MOVED * 2.0 * zeta * freq[:, s]):
            yield freq, zeta


def _one_more(c: Cluster, setups: Setups, own: OwnPeaks) -> Iterator[tuple[FloatArray, FloatArray]]:
    """A start with one more mode, where the squares fall most."""
    if len(own.freq) >= TOGETHER:
        return
    usual = float(np.median(own.zeta[:, 0]))
    found = [best_beside(c.window, setups, own.freq, own.zeta[:, 0], by * usual, c.span) for by in WIDER]
    k = int(np.argmax([gain for _, gain in found]))
    if found[k][1] > LEAST_GAIN * _price(c, setups, own):
        at = np.full((1, len(setups)), found[k][0])
        yield np.concatenate([own.freq, at]), np.append(own.zeta[:, 0], WIDER[k] * usual)


def _one_fewer(c: Cluster, setups: Setups, own: OwnPeaks) -> Iterator[tuple[FloatArray, FloatArray]]:
    """A start without the mode that takes least from the squares, where that is not much."""
    if len(own.freq) < 2:
        return
    each = np.arange(len(own.freq))
    zeta = own.zeta[:, 0]
    left = [squares_at(c.window, setups, own.freq[each != k], zeta[each != k]) for k in each]
    k = int(np.argmin(left))
    if left[k] - own.squares < MOST_LOSS * _price(c, setups, own):
        yield own.freq[each != k], zeta[each != k]
