"""Modes of one cluster: how many, each with a frequency of its own in every set-up, damping in common.

A fit by steps does not leave the place that it fell into: a set-up may take one mode for the next, a weak or local
mode may be missed, one mode may be given twice. So a cluster that is fitted is tried again with one set-up put where
the others are, with one more mode where most is left, and without the one that tells least; what lowers the criterion
is kept.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.around import Around
from casingfem.experiment.identify.setups.clusters import TOGETHER, Cluster, best_beside, places
from casingfem.experiment.identify.setups.grouping import matched
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks, Setups, apart, linked, squares_at
from casingfem.io.arrays import BoolArray, FloatArray
from casingfem.io.side_by_side import Each

MOST, FEWER = 14, 3  # modes that a cluster is taken for; from so many fewer on than were found before
GROWN = 3.0  # times the usual residues of a mode, that those of a set-up may well be
WIDER = 2.0  # times the damping of the highest peak: others of the cluster may have that
ROUNDS = 4  # of trying
DAMPINGS = 1.0, 3.0  # times the usual damping, that a further mode is tried with
LEAST_GAIN = 0.5  # of its price, that a further mode must take before it is fitted
MOST_LOSS = 3.0  # of its price, that a mode may take and be tried to be left out
SETTLED = 1.0  # fall of the criterion that counts
MOVED = 0.1  # half-power bandwidths: a set-up that is put elsewhere by less stays


class ClusterModes(NamedTuple):
    """A cluster and its modes, with damping in common."""

    cluster: Cluster
    own: OwnPeaks

    def cost(self, setups: int, noise: float) -> float:
        """The criterion, with damping common to so many set-ups."""
        return self.cluster.cost(self.own.squares, len(self.own.freq), setups + 1, noise)


def read(cluster: Cluster, setups: Setups, damped: float, shift: float) -> OwnPeaks | None:
    """As many modes with own frequencies as the data prefer, none more `damped` than that; None where none is.

    Damping is common to the set-ups or their own, as the data prefer.
    """
    best, misses, damped = None, 0, _most_damped(cluster, damped)
    f, z = cluster.modes.freq.mean(axis=1), np.minimum(cluster.modes.zeta, damped)
    known = cluster.modes.freq.shape[1] > 1  # poles of one set-up are more than there are modes
    starts = places(cluster.window, setups, f, z, min(MOST, len(f) + 1), cluster.span)
    for start in starts[max(len(f) - FEWER, 0) if known else 0 :]:
        zeta = z[np.abs(start.mean(axis=1)[:, None] - f).argmin(axis=1)]
        tried = [fit_apart(cluster, setups, start, zeta)]
        if len(setups) > 1:
            tried.append(_linked(cluster, setups, tried[0], shift))
        if cluster.modes.freq.shape == start.shape:
            tried.append(fit_again(cluster, setups, cluster.modes.freq, z))
        poles = [2 * len(setups), *[len(setups) + 1] * 2]
        reads = [_Read(own, each) for own, each in zip(tried, poles, strict=False)]
        read = min(reads, key=lambda each: each.cost(cluster, min(own.on_peaks for own in tried)))
        kept = _peaks_inside(read.own, cluster.span, damped)
        if not kept.all():
            own = only_peaks(cluster, setups, read.own, damped)
            read = _Read(own, len(setups) + 1)
            kept = _peaks_inside(own, cluster.span, damped)
        noise = read.own.on_peaks
        if kept.all() and (best is None or read.cost(cluster, noise) < best.cost(cluster, noise)):
            best, misses = read, 0
        elif misses and best is not None:
            break
        else:
            misses += 1
    return None if best is None else best.own


class _Read(NamedTuple):
    """Peaks of a cluster, and how many numbers the poles of one mode are."""

    own: OwnPeaks
    poles: int

    def cost(self, cluster: Cluster, noise: float) -> float:
        return cluster.cost(self.own.squares, len(self.own.freq), self.poles, noise)


def read_all(
    found: Sequence[Cluster],
    setups: Setups,
    damped: float,
    shift: float,
    known: Sequence[ClusterModes] = (),
    each: Each = map,
) -> list[ClusterModes]:
    """Clusters with the modes of all set-ups matched, damping in common; those that hold none are left out.

    Those that are `known` were read before, in the same way.
    """
    before = {one.cluster.span: one for one in known}
    new = each(partial(_read_matched, setups, damped, shift), [c for c in found if c.span not in before])
    reads = [before[c.span] if c.span in before else next(new) for c in found]
    return [one for one in reads if one is not None]


def _read_matched(setups: Setups, damped: float, shift: float, c: Cluster) -> ClusterModes | None:
    """The modes of a cluster, matched; None where it holds none."""
    own = read(c, setups, damped, shift)
    if own is None:
        return None
    free = matched(fit_apart(c, setups, own.freq, np.median(own.zeta, axis=1)), setups, shift)
    return ClusterModes(c, only_peaks(c, setups, _in_common(c, setups, free), damped))


def only_peaks(c: Cluster, setups: Setups, own: OwnPeaks, damped: float) -> OwnPeaks:
    """Modes fitted again without those that have run away: out of the span in most set-ups, or too damped."""
    kept = _peaks_inside(own, c.span, _most_damped(c, damped))
    if kept.all() or not kept.any():
        return own
    return fit_again(c, setups, own.freq[kept], np.median(own.zeta[kept], axis=1))


def _most_damped(c: Cluster, damped: float) -> float:
    """Damping ratio beyond which a mode of a cluster is no peak: where its highest is wide, others may be."""
    peaks = np.linalg.norm(c.modes.residues, axis=1) / c.modes.zeta
    return max(damped, WIDER * float(c.modes.zeta[peaks.argmax()]))


def _peaks_inside(own: OwnPeaks, span: tuple[float, float], most: float) -> BoolArray:
    """Which modes are peaks within the span in most set-ups, no more damped than that."""
    inside = (own.freq > span[0]) & (own.freq < span[1])
    return np.asarray((inside.mean(axis=1) > 0.5) & (np.median(own.zeta, axis=1) < most))


def fit_apart(cluster: Cluster, setups: Setups, freq: FloatArray, zeta: FloatArray) -> OwnPeaks:
    """Modes of each set-up by itself, from a start (modes, setups), (modes,)."""
    return apart(cluster.window, setups, freq, zeta, cluster.noise, cluster.span)


def fit_again(
    c: Cluster, setups: Setups, freq: FloatArray, zeta: FloatArray, ridge: FloatArray | None = None
) -> OwnPeaks:
    """Modes matched as they are, damping in common."""
    return linked(c.window, setups, freq, zeta, c.noise, c.span, c.apart, ridge)


def _linked(c: Cluster, setups: Setups, own: OwnPeaks, shift: float) -> OwnPeaks:
    """The modes of all set-ups put together, damping in common."""
    return _in_common(c, setups, matched(own, setups, shift))


def _in_common(c: Cluster, setups: Setups, own: OwnPeaks) -> OwnPeaks:
    """Matched modes with the mean of their damping as a start."""
    weight = 1.0 / (own.zeta_variance + 1e-4)
    zeta = np.exp((weight * np.log(own.zeta)).sum(axis=1) / weight.sum(axis=1))
    return fit_again(c, setups, own.freq, zeta)


def held(c: Cluster, setups: Setups) -> FloatArray:
    """Ridge that keeps the residues of each mode to a few times the size that they have in most set-ups, (modes,)."""
    weighted = c.modes.residues * c.window.weight * c.window.scale**c.window.power
    sizes = np.array([np.mean(np.abs(weighted[:, channels]) ** 2, axis=1) for channels in setups])
    return np.asarray(c.noise / (GROWN**2 * np.median(sizes, axis=0) + 1e-300))


def rematched(each: ClusterModes, setups: Setups, shift: float, around: Around) -> FloatArray:
    """Frequencies of a cluster's modes, exchanged in set-ups where the shapes of all tell that they are others."""
    c, own = each
    free = fit_apart(c, setups, own.freq, own.zeta[:, 0])
    better = matched(free, setups, shift, around)
    order = [(now[:, None] == before).argmax(axis=1) for now, before in zip(better.freq.T, free.freq.T, strict=True)]
    back = np.argsort(order[0])
    return np.take_along_axis(own.freq, np.array([each[back] for each in order]).T, axis=0)


def worth(each: ClusterModes, setups: Setups) -> FloatArray:
    """By how much the squares rise without each mode, over what a mode must bring, (modes,)."""
    c, own = each
    zeta, kept = own.zeta[:, 0], ~np.eye(len(own.freq), dtype=bool)
    left = np.array([squares_at(c.window, setups, own.freq[some], zeta[some]) for some in kept])
    noise = max(own.on_peaks, c.noise)
    rise = left - squares_at(c.window, setups, own.freq, zeta)
    return np.asarray(rise / noise / c.cost(0.0, 1, len(setups) + 1, noise))


def leaking(c: Cluster, leak: float) -> Cluster:
    """The cluster with leakage over lines so far [Hz] apart, 0 where nothing leaks."""
    return c._replace(window=replace(c.window, leak=leak))


def joined(own: Sequence[ClusterModes]) -> Modes:
    """The modes of all clusters, residues in the units of the data."""
    residues = [o.residues / c.window.weight / c.window.scale**c.window.power for c, o in own]
    return Modes(
        np.concatenate([each.own.freq for each in own]),
        np.concatenate([each.own.zeta[:, 0] for each in own]),
        np.concatenate(residues),
    )


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
    found = [best_beside(c.window, setups, own.freq, own.zeta[:, 0], by * usual, c.span) for by in DAMPINGS]
    k = int(np.argmax([gain for _, gain in found]))
    if found[k][1] > LEAST_GAIN * _price(c, setups, own):
        at = np.full((1, len(setups)), found[k][0])
        yield np.concatenate([own.freq, at]), np.append(own.zeta[:, 0], DAMPINGS[k] * usual)


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
