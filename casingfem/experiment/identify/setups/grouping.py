"""Which channels were measured in one set-up: those whose peaks lie at the same frequencies, in most of the modes.

Every channel is taken for a set-up of its own first (`own_shifts.py`). Modes are not equally well seen by all channels,
and a channel may take one member of a pair for the other: so what counts is in how many modes two channels agree, of
those that could tell them apart. Channels are put together by average linkage.
"""

from collections.abc import Sequence

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import squareform

from casingfem.experiment.identify.setups.around import Around
from casingfem.experiment.identify.setups.own_shifts import OwnPeaks, Setups
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

MODEL = 0.01  # of the damping ratio: what ln f may be off beside the noise
TELLS = 0.3  # of the scatter over the channels: standard deviation of a difference that tells two apart
ALIKE = 3.0  # standard deviations within which they agree
FEW = 3  # modes that must tell a channel from others
SIZES = 1.2  # standard deviation of the ln of a mode's size between channels
DAMPING = 0.02  # of the ln of its damping
MIXED = 0.1  # standard deviation of a distance over it: modes of a set-up so near have residues of each other
SWEEPS = 4
OFTEN = 0.35  # of them, in which channels of one set-up agree at least


def find_setups(peaks: Sequence[OwnPeaks], alive: BoolArray) -> list[IntArray]:
    """Groups of channels, from peaks of which every channel has its own frequencies.

    Channels that see too few modes stay alone; those that are not `alive` are put to the largest group.
    """
    share, told = agreement(peaks)
    np.fill_diagonal(told, 0)
    seen = np.flatnonzero(alive & (np.median(told, axis=1) >= FEW))
    groups = [np.array([c]) for c in np.setdiff1d(np.flatnonzero(alive), seen)]
    if len(seen) > 1:
        apart = 1.0 - share[np.ix_(seen, seen)]
        label = fcluster(linkage(squareform(apart, checks=False), "average"), 1.0 - OFTEN, "distance")
        groups += [seen[label == k] for k in np.unique(label)]
    else:
        groups += [np.array([c]) for c in seen]
    largest = max(range(len(groups)), key=lambda k: len(groups[k]))
    groups[largest] = np.union1d(groups[largest], np.flatnonzero(~alive))
    return groups


def agreement(peaks: Sequence[OwnPeaks]) -> tuple[FloatArray, FloatArray]:
    """Share of the modes in which two channels agree, and how many could tell them apart, both (channels, channels)."""
    logs = np.concatenate([np.log(own.freq) for own in peaks])
    model = MODEL * np.concatenate([np.median(own.zeta, axis=1) for own in peaks])[:, None]
    variance = np.concatenate([own.variance for own in peaks]) + model**2
    scatter = 1.5 * np.median(np.abs(logs - np.median(logs, axis=1, keepdims=True)), axis=1)
    sigma = np.sqrt(variance[:, :, None] + variance[:, None, :])
    tells = sigma < TELLS * scatter[:, None, None]
    alike = np.abs(logs[:, :, None] - logs[:, None, :]) < ALIKE * sigma
    told = tells.sum(axis=0)
    return (tells & alike).sum(axis=0) / np.maximum(told, 1), told


def matched(own: OwnPeaks, setups: Setups, shift: float, around: Around | None = None) -> OwnPeaks:
    """The same modes in the same rows: those of alike frequency, damping and size in all set-ups.

    Squared differences from the mean of the other set-ups, over what the fits leave uncertain and what set-ups differ
    by (`shift` in ln f), are summed; each set-up in turn takes the order of least sum, from ascending frequencies and
    from ascending damping. Where `shift` is not known, 0, the order is that of the frequencies. With `around` the waves
    that shapes are round a circle count, too.
    """
    if shift == 0.0 or len(setups) == 1:
        return own.ordered([np.argsort(each) for each in own.freq.T], setups)
    found = []
    for column in (own.freq, own.zeta):
        now = own.ordered([np.argsort(each) for each in column.T], setups)
        for _ in range(SWEEPS):
            before = now
            for s in range(len(setups)):
                best = linear_sum_assignment(_mismatch(now, setups, shift, [s], around)[0])[1]
                if np.any(best != np.arange(len(best))):
                    order = [np.arange(len(best))] * len(setups)
                    now = now.ordered([*order[:s], best, *order[s + 1 :]], setups)
            if now is before:
                break
        found.append((float(np.einsum("skk->", _mismatch(now, setups, shift, range(len(setups)), around))), now))
    return min(found, key=lambda each: each[0])[1]


def matching_sigma(own: OwnPeaks, setups: Setups, shift: float, around: Around | None = None) -> FloatArray:
    """Standard deviations of each mode's mean ln f and ln zeta, as two modes may be exchanged in a set-up, (2, modes).

    The odds of an exchange are exp(-rise of the mismatch/2). It moves the mean frequency by the distance over the
    number of set-ups, damping by what the exchanged one weighs among those of the set-ups.
    """
    m, count = own.freq.shape
    if m == 1 or count == 1:
        return np.zeros((2, m))
    cost, logs = _mismatch(own, setups, shift, range(count), around), np.log([own.freq, own.zeta])
    same = np.einsum("skk->sk", cost)
    rise = cost + cost.swapaxes(1, 2) - same[:, :, None] - same[:, None, :]
    odds = 1.0 / (1.0 + np.exp(np.clip(0.5 * rise, 0.0, 50.0)))
    odds[:, np.arange(m), np.arange(m)] = 0.0
    noise = np.array([own.variance, own.zeta_variance])
    apart = (logs[:, :, None] - logs[:, None]) ** 2 - noise[:, :, None] - noise[:, None]  # beyond what noise makes
    apart[1] = np.median(apart[1], axis=2, keepdims=True)  # a weak peak's own damping may be anything
    moved = np.maximum(apart, 0.0).transpose(0, 3, 1, 2)
    known = 1.0 / (own.zeta_variance.T + DAMPING**2)
    weight = known[:, None, :] / (known.sum(axis=0) - known)[:, :, None]
    moved *= np.stack([np.full(weight.shape, 1.0 / count), weight / (1.0 + weight)]) ** 2
    return np.asarray(np.sqrt(np.max(odds * moved, axis=3).sum(axis=1)))


def _mismatch(own: OwnPeaks, setups: Setups, shift: float, which: Sequence[int], around: Around | None) -> FloatArray:
    """Cost of each mode of some set-ups (columns) as each mode of the others (rows), (those, modes, modes)."""
    count = np.array([len(c) for c in setups])
    sizes = np.array([np.linalg.norm(own.residues[:, c], axis=1) for c in setups]).T / np.sqrt(count)
    x = np.array([np.log(own.freq), np.log(own.zeta), np.log(sizes + 1e-300)])
    spread = np.array([shift**2 + own.variance, DAMPING**2 + own.zeta_variance, SIZES**2 / count + 0.0 * sizes])
    costs = []
    for s in which:
        others = np.arange(len(setups)) != s
        weight = 1.0 / spread[:, :, others]
        mean, variance = (weight * x[:, :, others]).sum(axis=2) / weight.sum(axis=2), 1.0 / weight.sum(axis=2)
        gap = (mean[:, :, None] - x[:, None, :, s]) ** 2
        cost = (gap / (variance[:, :, None] + spread[:, None, :, s])).sum(axis=0)
        costs.append(cost if around is None else cost + _told(own, s) * around.mismatch(own.residues, setups[s]))
    return np.array(costs)


def _told(own: OwnPeaks, s: int) -> FloatArray:
    """How much the shape of each mode counts in a set-up, (modes,): little where it can hardly be told from another."""
    p, variance = np.log(own.freq[:, s]), own.variance[:, s]
    gap = (p[:, None] - p) ** 2 + 1e3 * np.eye(len(p))
    mixed = (variance[:, None] + variance) / np.maximum(gap, 1e-300)
    return np.asarray(1.0 / (1.0 + mixed.max(axis=1) / MIXED**2))
