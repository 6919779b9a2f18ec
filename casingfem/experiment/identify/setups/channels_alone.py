"""Clusters read with every channel for a set-up of its own: whether peaks are shifted at all, whether a window leaks.

The Bayesian information criterion weighs the readings; of a cluster that is not yet understood the vote is limited.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.cluster_modes import fit_again, leaking, read
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.own_shifts import OwnPeaks, Setups, linked
from casingfem.io.arrays import IntArray
from casingfem.io.side_by_side import Each

VOTE = 30.0  # of the log-odds for leakage, or for more set-ups, or against, that one cluster may give
LEAKS = 30.0  # lines in a half-power bandwidth, beyond which leakage changes nothing


class Alone(NamedTuple):
    """Clusters, the peaks of each channel, the leakage [Hz], and twice the ln of the odds for own frequencies."""

    clusters: list[Cluster]
    peaks: list[OwnPeaks]
    leak: float
    evidence: list[float]


def channels_alone(
    common: Sequence[Cluster], channels: IntArray, damped: float, step: float, each: Each = map
) -> Alone:
    """Read some channels of clusters with own frequencies in each, and without or with leakage over a step [Hz]."""
    some = [_of_channels(c, channels) for c in common]
    both = list(each(partial(_plain_and_leaked, damped, step), some))
    found = [(c, *peaks) for c, peaks in zip(some, both, strict=True) if peaks is not None]
    leak = step if leaks([_gain(c, plain, leaked) for c, plain, leaked in found if _tells(c, step)]) else 0.0
    peaks = [leaked if leak else plain for _, plain, leaked in found]
    evidence = [evidence_of(c, own, len(channels)) for (c, _, _), own in zip(found, peaks, strict=True)]
    return Alone([leaking(c, leak) for c, _, _ in found], peaks, leak, evidence)


def _of_channels(c: Cluster, channels: IntArray) -> Cluster:
    window = replace(c.window, Y=c.window.Y[:, channels], weight=c.window.weight[channels])
    return c._replace(window=window, modes=c.modes._replace(residues=c.modes.residues[:, channels]))


def _plain_and_leaked(damped: float, step: float, c: Cluster) -> tuple[OwnPeaks, OwnPeaks] | None:
    """The peaks of a cluster's channels without and with leakage; None where it holds none."""
    single = [np.array([channel]) for channel in range(c.window.Y.shape[1])]
    own = read(c, single, damped, 0.0)
    if own is None:
        return None
    freq, zeta = own.freq, np.median(own.zeta, axis=1)
    leaked, plain = fit_again(leaking(c, step), single, freq, zeta), fit_again(c, single, freq, zeta)
    return plain, leaked


def evidence_of(c: Cluster, own: OwnPeaks, setups: int) -> float:
    """Twice the ln of the odds of own frequencies against common poles, noise unknown; alike lines count as one.

    A fit that ended in a poor place speaks no more against shifts than one that is as good as common poles.
    """
    shared, price, m = _fit_common(c).squares, np.log(c.window.Y.size), len(own.freq)
    lines = min(c.window.Y.size, shared / c.noise)
    numbers = [k * (c.window.columns * c.window.Y.shape[1] + poles)
               for k, poles in ((m, setups + 1), (len(c.modes.zeta), 2))]  # fmt: skip
    gain = lines * np.log(max(shared, 1e-300) / max(own.squares, 1e-300)) - price * (numbers[0] - numbers[1])
    return float(max(gain, -price * m * (setups - 1)))


def leak_of_common(common: Iterable[Cluster], step: float, each: Each = map) -> float:
    """The step of the lines [Hz] where clusters of common poles are fitted better with leakage over it, else 0."""
    return step if leaks(list(each(partial(_gain_common, step), [c for c in common if _tells(c, step)]))) else 0.0


def leak_of_own(found: Iterable[Cluster], setups: Setups, step: float, each: Each = map) -> float:
    """The same for modes with frequencies of their own in each set-up."""
    return step if leaks(list(each(partial(_gain_own, setups, step), [c for c in found if _tells(c, step)]))) else 0.0


def leaks(gains: Sequence[float]) -> bool:
    """Whether clusters are fitted better with leakage.

    One cluster that is not yet understood may leave more than all others together: its vote is limited.
    """
    return bool(np.sum(np.clip(gains, -VOTE, VOTE)) > 0.0)


def scatter(own: Sequence[OwnPeaks]) -> float:
    """What set-ups differ by in ln f, usually."""
    off = [np.log(one.freq).std(axis=1, ddof=min(1, one.freq.shape[1] - 1)) for one in own]
    return float(np.median(np.concatenate(off)))


def _tells(c: Cluster, step: float) -> bool:
    """Whether a cluster has a peak so narrow that leakage over a step of the lines [Hz] widens it."""
    return bool((2.0 * c.modes.zeta * c.modes.freq.min(axis=1) < LEAKS * step).any())


def _gain(c: Cluster, plain: OwnPeaks, leaked: OwnPeaks) -> float:
    """Twice the ln of the odds for leakage in a cluster, noise unknown."""
    return float(c.window.entries * np.log((plain.squares + 1e-300) / (leaked.squares + 1e-300)))


def _gain_common(step: float, c: Cluster) -> float:
    """`_gain` of common poles by leakage over a step [Hz]."""
    return _gain(c, *(_fit_common(leaking(c, by)) for by in (0.0, step)))


def _gain_own(setups: Setups, step: float, c: Cluster) -> float:
    """`_gain` of the modes of a cluster by leakage over a step [Hz]."""
    return _gain(c, *(fit_again(leaking(c, by), setups, c.modes.freq, c.modes.zeta) for by in (0.0, step)))


def _fit_common(c: Cluster) -> OwnPeaks:
    return linked(c.window, [np.arange(c.window.Y.shape[1])], c.modes.freq, c.modes.zeta, c.noise, c.span)
