"""A test whose peaks are shifted from set-up to set-up, read as few modes with own frequencies.

Both readings are weighed by the Bayesian information criterion: n common poles of a cluster, each with s residues in C
channels, s C n + 2 n numbers; m modes with own frequencies in S set-ups, (s C + S + 1) m. A test has such shifts or
not, so the evidence of all clusters, those of one pole too, is summed.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Around, Places
from casingfem.experiment.identify.setups.channels_alone import (
    VOTE,
    Alone,
    channels_alone,
    evidence_of,
    leak_of_common,
    leak_of_own,
    scatter,
)
from casingfem.experiment.identify.setups.cluster_modes import (
    ClusterModes,
    fit_again,
    fit_apart,
    held,
    improved,
    joined,
    leaking,
    only_peaks,
    read_all,
    rematched,
    worth,
)
from casingfem.experiment.identify.setups.clusters import Cluster, clusters
from casingfem.experiment.identify.setups.grouping import find_setups, matching_sigma
from casingfem.experiment.identify.setups.own_shifts import Modes, Setups
from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from casingfem.io.side_by_side import Each

MOST_LINES = 1000  # that a cluster is fitted to last
TOGETHER = 2e-3, 3.0  # `clusters.REACH` of those fitted last: beyond, neighbours hardly move each other
PASSES = 3  # of finding modes
POLISHES = 6  # fits of them beside what their neighbours then are, at most: the last where nothing is left to explain
EXPLAINED = 2.0, 10.0  # times the noise, that is left on the peaks of modes all found; the noise, times that
FIRST = 10, 4, 8  # clusters, of so many poles at most, and channels, that say whether peaks are shifted at all
IMPROVED = 2  # of the last fits, that look for better places at least
CLUSTERS = 12  # that tell which channels are one set-up, at most
ALIVE = 2.0  # rms of a channel over its noise
DAMPED = 5.0  # times the usual damping, beyond which a mode is no peak


class Shifted(NamedTuple):
    """Modes with own frequencies, the variance of ln f (modes, setups), the channels of each set-up.

    `sigma_zeta` (modes,) is the standard deviation of ln zeta, `sigma_matching` (modes,) that of the mean of ln f from
    not knowing which mode is which in a set-up; `worth` (modes,) what each takes from the squares over what it must.

    `leak` is the distance of lines [Hz] over which a Hann window leaks, or 0; `shift` what set-ups differ by in ln f,
    usually; `evidence` twice the ln of the odds against common frequencies. Where the last fit was one of waves round
    the circle, `mean_freq` [Hz] (modes,) is the mean over the set-ups, `sigma_mean` (modes,) the standard deviation of
    its ln, `rival` (modes,) how far ln f is off that by another reading that may well be, `belongs` (channels,) says
    which move as they should where they stand; None elsewhere.
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
    mean_freq: FloatArray | None = None
    sigma_mean: FloatArray | None = None
    rival: FloatArray | None = None
    belongs: BoolArray | None = None

    @property
    def several(self) -> bool:
        """Whether peaks are shifted at all."""
        return self.evidence > 0.0 and len(self.setups) > 1

    def mean(self) -> tuple[FloatArray, FloatArray]:
        """Mean frequency [Hz] of each mode over the set-ups, and the standard deviation of its ln, (modes,).

        A set-up that does not see a mode has, as far as one can tell, what the others have, within `shift`.
        """
        if self.mean_freq is not None and self.sigma_mean is not None:
            return self.mean_freq, self.sigma_mean
        logs = np.log(self.modes.freq)
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


class _Reading(NamedTuple):
    """Set-ups, their usual shift in ln f, leakage [Hz], and twice the ln of the odds against common frequencies."""

    setups: Setups
    shift: float
    leak: float
    evidence: float
    grouped: list[ClusterModes]  # the clusters as already read with these set-ups


def shifted(whole: Window, modes: Modes, places: Places | None = None, each: Each = map) -> Shifted:
    """Read a test of common poles (one set-up) as one of several; `whole` has all lines and channels.

    With `places` of channels round a circle the shapes tell, too, which mode of a set-up is which of the others.
    Clusters are worked on `each` by itself.
    """
    alive = np.mean(whole.Y**2, axis=0) > ALIVE**2
    common = list(clusters(whole, modes, [np.arange(len(alive))]))
    damped = DAMPED * float(np.median(modes.zeta))
    step = float(whole.freq[1] - whole.freq[0])
    few = np.flatnonzero(alive)
    few = few[_spread(len(few), FIRST[2])]
    if len(few) < 2:
        return _unshifted(common, modes, step, 0.0, each)
    some = [c for c in common if len(c.modes.zeta) <= FIRST[1]] or common
    first = channels_alone([some[k] for k in _spread(len(some), FIRST[0])], few, damped, step, each)
    if max(first.evidence, default=0.0) <= 0.0:
        return _unshifted(common, modes, step, sum(first.evidence), each)
    several = [common[k] for k in _spread(len(common), CLUSTERS)]
    alone = channels_alone(several, np.arange(len(alive)), damped, step, each)
    if not alone.peaks:
        return _unshifted(common, modes, step, 0.0, each)
    reading = _grouped(alone, find_setups(alone.peaks, alive), damped, each)
    if reading.evidence <= 0.0:
        return _unshifted(common, modes, step, reading.evidence, each)
    found = _found(whole, modes, common, reading, damped, each)
    if found is None:
        return _unshifted(common, modes, step, 0.0, each)
    modes, reading = found
    return _polish(whole, modes, reading, places, damped, each)


def _grouped(alone: Alone, setups: Setups, damped: float, each: Each) -> _Reading:
    """The channels in set-ups, where that reads the clusters as well as every channel alone does."""
    shift, evidence = scatter(alone.peaks), sum(alone.evidence)
    single = [np.array([c]) for c in range(alone.clusters[0].window.Y.shape[1])]
    grouped = read_all(alone.clusters, setups, damped, shift, each=each) if len(setups) < len(single) else []
    apart = [ClusterModes(c, own) for c, own in zip(alone.clusters, alone.peaks, strict=True)]
    if not grouped or not _as_good(grouped, setups, apart, single):
        return _Reading(single, shift, alone.leak, evidence, [])
    if len(setups) > 1:  # with few set-ups own frequencies cost less
        evidence = max(evidence, sum(evidence_of(c, own, len(setups)) for c, own in grouped))
    return _Reading(setups, shift, alone.leak, evidence, grouped)


def _found(
    whole: Window, modes: Modes, common: list[Cluster], reading: _Reading, damped: float, each: Each
) -> tuple[Modes, _Reading] | None:
    """Modes with own frequencies, in as few set-ups as read them as well; None where no cluster holds any."""
    setups, shift, leak, evidence, known = reading
    step = float(whole.freq[1] - whole.freq[0])
    refused, counts = len(setups) == whole.Y.shape[1], list[int]()
    for again in range(PASSES):
        if again:
            leak = leak_of_own(clusters(whole, modes, setups), setups, step, each)
        near = clusters(replace(whole, leak=leak), modes, setups) if again else common
        found = [leaking(c, leak) for c in near]
        own = read_all(found, setups, damped, shift, () if again else known, each)
        merged = [] if refused else find_setups([one.own for one in own], np.ones(len(setups), bool))
        if 0 < len(merged) < len(setups):
            fewer = [np.sort(np.concatenate([setups[k] for k in group])) for group in merged]
            grouped = read_all(found, fewer, damped, shift, each=each)
            refused = not _as_good(grouped, fewer, own, setups)
            setups, own = (setups, own) if refused else (fewer, grouped)
        if not own:
            return None
        shift, modes = scatter([one.own for one in own]), joined(own)
        counts, before = [len(one.own.freq) for one in own], counts
        if counts == before:
            break
    return modes, _Reading(setups, shift, leak, evidence, [])


def _polish(
    whole: Window, modes: Modes, reading: _Reading, places: Places | None, damped: float, each: Each
) -> Shifted:
    """The modes fitted from better places, then beside what their neighbours have become."""
    setups, shift, leak, evidence, _ = reading
    looking = True
    for again in range(POLISHES):
        near = clusters(replace(whole, leak=leak), modes, setups, MOST_LINES, TOGETHER, shift)
        around = None if places is None or looking else Around.of(places, modes.residues, whole.weight)
        fit = partial(improved, setups, damped) if looking else partial(_polished, setups, damped, shift, around)
        last = list(each(fit, near))
        many, modes = len(modes.zeta), joined(last)
        if not looking:
            break
        changed = many != len(modes.zeta) or any(_unsettled(one) for one in last)
        looking = again + 1 < (POLISHES - 1 if changed else IMPROVED)
    told = list(each(partial(_told, setups, shift, around), last))
    matching = np.concatenate([matching for matching, _ in told], axis=1)
    return Shifted(
        modes=modes,
        variance=np.concatenate([one.own.variance for one in last]),
        sigma_zeta=np.hypot(np.sqrt(np.concatenate([one.own.zeta_variance[:, 0] for one in last])), matching[1]),
        sigma_matching=matching[0],
        worth=np.concatenate([gains for _, gains in told]),
        setups=setups,
        leak=leak,
        shift=shift,
        evidence=evidence,
    )


def _as_good(fewer: Sequence[ClusterModes], few: Setups, more: Sequence[ClusterModes], many: Setups) -> bool:
    """Whether clusters are read as well with fewer set-ups, by the criterion and the noise that more of them leave.

    Votes are limited as in `leaks`: where a neighbour's peaks are not yet understood, more set-ups follow them.
    """
    rich = {each.cluster.span: each for each in more}
    both = [(each, rich[each.cluster.span]) for each in fewer if each.cluster.span in rich]
    rise = [each.cost(len(few), best.own.on_peaks) - best.cost(len(many), best.own.on_peaks) for each, best in both]
    return bool(np.sum(np.clip(rise, -VOTE, VOTE)) <= 0.0)


def _polished(setups: Setups, damped: float, shift: float, around: Around | None, c: Cluster) -> ClusterModes:
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


def _told(setups: Setups, shift: float, around: Around | None, one: ClusterModes) -> tuple[FloatArray, FloatArray]:
    """What exchanged modes would change in a cluster, and what each of its modes is worth."""
    free = fit_apart(one.cluster, setups, one.own.freq, one.own.zeta[:, 0])
    return matching_sigma(free, setups, shift, around), worth(one, setups)


def _unshifted(common: Sequence[Cluster], modes: Modes, step: float, evidence: float, each: Each) -> Shifted:
    """The common poles, and whether a window leaks over the step of the lines [Hz]."""
    nothing, all_of_them = np.zeros(len(modes.zeta)), np.arange(modes.residues.shape[1])
    leak = leak_of_common(common, step, each)
    return Shifted(modes, nothing[:, None], nothing, nothing, nothing, [all_of_them], leak, 0.0, evidence)


def _spread(count: int, most: int) -> IntArray:
    """Indices of so many of `count` at most, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.int64))
