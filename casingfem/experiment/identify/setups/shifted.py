"""A test whose peaks are shifted from set-up to set-up, read as few modes with own frequencies.

Both readings are weighed by the Bayesian information criterion: n common poles of a cluster, each with s residues in C
channels, s C n + 2 n numbers; m modes with own frequencies in S set-ups, (s C + S + 1) m. A test has such shifts or
not, so the evidence of all clusters, those of one pole too, is summed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Around, Places
from casingfem.experiment.identify.setups.cluster_modes import (
    ClusterModes,
    fit_again,
    fit_apart,
    held,
    joined,
    leaking,
    only_peaks,
    read,
    read_all,
    rematched,
    worth,
)
from casingfem.experiment.identify.setups.cluster_moves import improved
from casingfem.experiment.identify.setups.clusters import Cluster, clusters
from casingfem.experiment.identify.setups.grouping import find_setups, matching_sigma
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks, Setups, linked
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

MOST_LINES = 1000  # that a cluster is fitted to last
TOGETHER = 2e-3, 3.0  # `clusters.REACH` of those fitted last: beyond, neighbours hardly move each other
PASSES = 3  # of finding modes
POLISHES = 6  # fits of them beside what their neighbours then are, at most: the last where nothing is left to explain
EXPLAINED = 2.0, 10.0  # times the noise, that is left on the peaks of modes all found; the noise, times that
FIRST = 10, 4, 8  # clusters, of so many poles at most, and channels, that say whether peaks are shifted at all
IMPROVED = 2  # of the last fits, that look for better places at least
CLUSTERS = 12  # that tell which channels are one set-up, at most
ALIVE = 2.0  # rms of a channel over its noise
VOTE = 30.0  # of the log-odds for leakage, or for more set-ups, or against, that one cluster may give
LEAKS = 30.0  # lines in a half-power bandwidth, beyond which leakage changes nothing
DAMPED = 5.0  # times the usual damping, beyond which a mode is no peak


class Shifted(NamedTuple):
    """Modes with own frequencies, the variance of ln f (modes, setups), the channels of each set-up.

    `sigma_zeta` (modes,) is the standard deviation of ln zeta, `sigma_matching` (modes,) that of the mean of ln f from
    not knowing which mode is which in a set-up; `worth` (modes,) what each takes from the squares over what it must.

    `leak` is the distance of lines [Hz] over which a Hann window leaks, or 0; `shift` what set-ups differ by in ln f,
    usually; `evidence` twice the ln of the odds against common frequencies. `sigma_mean` (modes,) is that of the mean
    of ln f, `belongs` (channels,) says which move as they should where they stand: where the last fit was one of waves
    round the circle; None elsewhere.
    """

    modes: Modes
    variance: FloatArray
    sigma_zeta: FloatArray
    sigma_matching: FloatArray
    worth: FloatArray
    setups: Setups
    leak: float
    shift: float
    evidence: float
    sigma_mean: FloatArray | None = None
    belongs: BoolArray | None = None

    @property
    def several(self) -> bool:
        """Whether peaks are shifted at all."""
        return self.evidence > 0.0 and len(self.setups) > 1

    def mean(self) -> tuple[FloatArray, FloatArray]:
        """Mean frequency [Hz] of each mode over the set-ups, and the standard deviation of its ln, (modes,).

        A set-up that does not see a mode has, as far as one can tell, what the others have, within `shift`.
        """
        logs = np.log(self.modes.freq)
        if self.sigma_mean is not None:
            return np.exp(logs.mean(axis=1)), self.sigma_mean
        weight = 1.0 / (self.variance + self.shift**2 + 1e-300)
        centre = (weight * logs).sum(axis=1, keepdims=True) / weight.sum(axis=1, keepdims=True)
        each = centre + self.shift**2 * weight * (logs - centre)
        left = self.variance * self.shift**2 * weight
        return np.exp(each).mean(axis=1), np.sqrt(left.mean(axis=1) / logs.shape[1])

    def seen(self) -> FloatArray:
        """Share of the set-ups that have each mode's energy, (modes,): 1 where all have as much of it."""
        energy = np.abs(self.modes.residues / np.linalg.norm(self.modes.residues, axis=1, keepdims=True)) ** 2
        each = np.array([energy[:, channels].sum(axis=1) for channels in self.setups]).T
        return np.asarray(each.sum(axis=1) ** 2 / np.sum(each**2, axis=1) / len(self.setups))

    def apart(self, one: IntArray, other: IntArray) -> FloatArray:
        """Chi-squared of two modes having the same frequency in every set-up of several channels, (pairs,).

        One channel alone does not tell two modes from one: no other confirms what it shows.
        """
        several = [len(channels) > 1 for channels in self.setups]
        gap = np.log(self.modes.freq[one] / self.modes.freq[other])
        squares = gap**2 / (self.variance[one] + self.variance[other] + 1e-300)
        return np.asarray(squares[:, several].sum(axis=1))

    def aligned(self, whole: Window) -> Window:
        """The data as they would be if every set-up had the mean frequencies."""
        whole = replace(whole, leak=self.leak)
        together = self.modes._replace(freq=self.mean()[0][:, None])
        change = together.response(whole, [np.arange(whole.Y.shape[1])]) - self.modes.response(whole, self.setups)
        return replace(whole, Y=whole.Y + np.concatenate([change.real, change.imag]))


def shifted(whole: Window, modes: Modes, places: Places | None = None) -> Shifted:
    """Read a test of common poles (one set-up) as one of several; `whole` has all lines and channels.

    With `places` of channels round a circle the shapes tell, too, which mode of a set-up is which of the others.
    """
    alive = np.mean(whole.Y**2, axis=0) > ALIVE**2
    common = list(clusters(whole, modes, [np.arange(len(alive))]))
    damped = DAMPED * float(np.median(modes.zeta))
    step = float(whole.freq[1] - whole.freq[0])
    some = [c for c in common if len(c.modes.zeta) <= FIRST[1]] or common
    few = np.flatnonzero(alive)
    few = few[_spread(len(few), FIRST[2])]
    if len(few) < 2:
        return _unshifted(common, modes, step, 0.0)
    first = _alone([some[k] for k in _spread(len(some), FIRST[0])], few, damped, step)
    if max(first.evidence, default=0.0) <= 0.0:
        return _unshifted(common, modes, step, sum(first.evidence))
    alone = _alone([common[k] for k in _spread(len(common), CLUSTERS)], np.arange(len(alive)), damped, step)
    if not alone.peaks:
        return _unshifted(common, modes, step, 0.0)
    setups, shift, leak = find_setups(alone.peaks, alive), scatter(alone.peaks), alone.leak
    single, evidence = [np.array([c]) for c in range(len(alive))], sum(alone.evidence)
    grouped = read_all(alone.clusters, setups, damped, shift) if len(setups) < len(single) else []
    if len(setups) > 1:  # with few set-ups own frequencies cost less
        evidence = max(evidence, sum(_evidence(c, own, len(setups)) for c, own in grouped))
    each = [ClusterModes(c, own) for c, own in zip(alone.clusters, alone.peaks, strict=True)]
    if not grouped or not _as_good(grouped, setups, each, single):
        setups, grouped, evidence = single, [], sum(alone.evidence)
    if evidence <= 0.0:
        return _unshifted(common, modes, step, evidence)
    refused, counts = len(setups) == len(single), list[int]()
    for again in range(PASSES):
        if again:
            told = [_gain_again(c, setups, step) for c in clusters(whole, modes, setups) if _tells(c, step)]
            leak = step if _leaks(told) else 0.0
        found = [leaking(c, leak) for c in (clusters(replace(whole, leak=leak), modes, setups) if again else common)]
        own = read_all(found, setups, damped, shift, () if again else grouped)
        merged = [] if refused else find_setups([each.own for each in own], np.ones(len(setups), bool))
        if 0 < len(merged) < len(setups):
            fewer = [np.sort(np.concatenate([setups[k] for k in group])) for group in merged]
            grouped = read_all(found, fewer, damped, shift)
            refused = not _as_good(grouped, fewer, own, setups)
            setups, own = (setups, own) if refused else (fewer, grouped)
        if not own:
            return _unshifted(common, modes, step, 0.0)
        shift, modes = scatter([each.own for each in own]), joined(own)
        counts, before = [len(each.own.freq) for each in own], counts
        if counts == before:
            break
    looking = True
    for again in range(POLISHES):
        near = clusters(replace(whole, leak=leak), modes, setups, MOST_LINES, TOGETHER, shift)
        around = None if places is None or looking else Around.of(places, modes.residues, whole.weight)
        last = [improved(c, setups, damped) if looking else _polished(c, setups, damped, shift, around) for c in near]
        many, modes = len(modes.zeta), joined(last)
        if not looking:
            break
        changed = many != len(modes.zeta) or any(_unsettled(each) for each in last)
        looking = again + 1 < (POLISHES - 1 if changed else IMPROVED)
    free = [fit_apart(each.cluster, setups, each.own.freq, each.own.zeta[:, 0]) for each in last]
    matching = np.concatenate([matching_sigma(own, setups, shift, around) for own in free], axis=1)
    return Shifted(
        modes=modes,
        variance=np.concatenate([each.own.variance for each in last]),
        sigma_zeta=np.hypot(np.sqrt(np.concatenate([each.own.zeta_variance[:, 0] for each in last])), matching[1]),
        sigma_matching=matching[0],
        worth=np.concatenate([worth(each, setups) for each in last]),
        setups=setups,
        leak=leak,
        shift=shift,
        evidence=evidence,
    )


def _as_good(fewer: Sequence[ClusterModes], few: Setups, more: Sequence[ClusterModes], many: Setups) -> bool:
    """Whether clusters are read as well with fewer set-ups, by the criterion and the noise that more of them leave.

    Votes are limited as in `_leaks`: where a neighbour's peaks are not yet understood, more set-ups follow them.
    """
    rich = {each.cluster.span: each for each in more}
    both = [(each, rich[each.cluster.span]) for each in fewer if each.cluster.span in rich]
    rise = [each.cost(len(few), best.own.on_peaks) - best.cost(len(many), best.own.on_peaks) for each, best in both]
    return bool(np.sum(np.clip(rise, -VOTE, VOTE)) <= 0.0)


def _polished(c: Cluster, setups: Setups, damped: float, shift: float, around: Around | None) -> ClusterModes:
    """The modes of a cluster, each of about one size in all set-ups, and of one shape where that tells."""
    ridge = held(c, setups)
    own = fit_again(c, setups, c.modes.freq, c.modes.zeta, ridge)
    if around is not None:
        freq = rematched(ClusterModes(c, own), setups, shift, around)
        if np.any(freq != own.freq):
            own = fit_again(c, setups, freq, own.zeta[:, 0], ridge)
    return ClusterModes(c, only_peaks(c, setups, own, damped))


def _unsettled(each: ClusterModes) -> bool:
    """Whether a cluster's modes leave more than the noise, or much less: then that of its neighbours was no noise."""
    c, own = each
    return bool(own.on_peaks > EXPLAINED[0] * c.noise or c.noise > EXPLAINED[1] * own.on_peaks)


def _unshifted(common: Sequence[Cluster], modes: Modes, step: float, evidence: float) -> Shifted:
    """The common poles, and whether a window leaks over the step of the lines [Hz]."""
    gains = [_gain(c, *(_fit_common(leaking(c, by)) for by in (0.0, step))) for c in common if _tells(c, step)]
    nothing, all_of_them = np.zeros(len(modes.zeta)), np.arange(modes.residues.shape[1])
    leak = step if _leaks(gains) else 0.0
    return Shifted(modes, nothing[:, None], nothing, nothing, nothing, [all_of_them], leak, 0.0, evidence)


def _spread(count: int, most: int) -> IntArray:
    """Indices of so many of `count` at most, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.int64))


class _Alone(NamedTuple):
    """Clusters read with every channel for a set-up of its own."""

    clusters: list[Cluster]
    peaks: list[OwnPeaks]
    leak: float
    evidence: list[float]


def _alone(common: Sequence[Cluster], channels: IntArray, damped: float, step: float) -> _Alone:
    """Read some channels of clusters with own frequencies in each, and without or with leakage over a step [Hz]."""
    single = [np.array([c]) for c in range(len(channels))]
    found = []
    for c in common:
        window = replace(c.window, Y=c.window.Y[:, channels], weight=c.window.weight[channels])
        c = c._replace(window=window, modes=c.modes._replace(residues=c.modes.residues[:, channels]))
        if (own := read(c, single, damped, 0.0)) is not None:
            freq, zeta = own.freq, np.median(own.zeta, axis=1)
            leaked, own = fit_again(leaking(c, step), single, freq, zeta), fit_again(c, single, freq, zeta)
            found.append((c, own, leaked))
    leak = step if _leaks([_gain(c, plain, leaked) for c, plain, leaked in found if _tells(c, step)]) else 0.0
    evidence = [_evidence(c, leaked if leak else plain, len(single)) for c, plain, leaked in found]
    peaks = [leaked if leak else plain for _, plain, leaked in found]
    return _Alone([leaking(c, leak) for c, _, _ in found], peaks, leak, evidence)


def _tells(c: Cluster, step: float) -> bool:
    """Whether a cluster has a peak so narrow that leakage over a step of the lines [Hz] widens it."""
    return bool((2.0 * c.modes.zeta * c.modes.freq.min(axis=1) < LEAKS * step).any())


def _leaks(gains: Sequence[float]) -> bool:
    """Whether clusters are fitted better with leakage.

    One cluster that is not yet understood may leave more than all others together: its vote is limited.
    """
    return bool(np.sum(np.clip(gains, -VOTE, VOTE)) > 0.0)


def _gain(c: Cluster, plain: OwnPeaks, leaked: OwnPeaks) -> float:
    """Twice the ln of the odds for leakage in a cluster, noise unknown."""
    return float(c.window.entries * np.log((plain.squares + 1e-300) / (leaked.squares + 1e-300)))


def _evidence(c: Cluster, own: OwnPeaks, setups: int) -> float:
    """Twice the ln of the odds of own frequencies against common poles, noise unknown; alike lines count as one.

    A fit that ended in a poor place speaks no more against shifts than one that is as good as common poles.
    """
    shared, price, m = _fit_common(c).squares, np.log(c.window.Y.size), len(own.freq)
    lines = min(c.window.Y.size, shared / c.noise)
    numbers = [k * (c.window.columns * c.window.Y.shape[1] + poles)
               for k, poles in ((m, setups + 1), (len(c.modes.zeta), 2))]  # fmt: skip
    gain = lines * np.log(max(shared, 1e-300) / max(own.squares, 1e-300)) - price * (numbers[0] - numbers[1])
    return float(max(gain, -price * m * (setups - 1)))


def _fit_common(c: Cluster) -> OwnPeaks:
    """The cluster's common poles, refined."""
    return linked(c.window, [np.arange(c.window.Y.shape[1])], c.modes.freq, c.modes.zeta, c.noise, c.span)


def scatter(own: Sequence[OwnPeaks]) -> float:
    """What set-ups differ by in ln f, usually."""
    return float(np.median(np.concatenate([np.log(o.freq).std(axis=1, ddof=min(1, o.freq.shape[1] - 1)) for o in own])))


def _gain_again(c: Cluster, setups: Setups, step: float) -> float:
    """`_gain` of the modes of a cluster by leakage over a step [Hz]."""
    return _gain(c, *(fit_again(leaking(c, by), setups, c.modes.freq, c.modes.zeta) for by in (0.0, step)))
