"""A test whose peaks are shifted from set-up to set-up, read as few modes with own frequencies.

Both readings are weighed by the Bayesian information criterion: n common poles of a cluster, each with s residues in C
channels, s C n + 2 n numbers; m modes with own frequencies in S set-ups, (s C + S + 1) m. A test has such shifts or
not, so the evidence of all clusters, those of one pole too, is summed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.bands import line_noise
from casingfem.experiment.identify.own_shifts import Modes, OwnPeaks, Setups, apart, linked
from casingfem.experiment.identify.places import places
from casingfem.experiment.identify.pole_window import Window
from casingfem.experiment.identify.setups import find_setups, label_doubt, matched
from casingfem.io.arrays import Array, FloatArray, IntArray

REACH = 2e-3, 0.5  # beyond the poles of a cluster, that peaks may lie: relative, and damping ratios
AROUND, LEAST_LINES = 8.0, 40  # damping ratios beyond that, that lines are taken from, and so many at least
TOGETHER, MOST = 14, 14  # poles in a cluster, and modes it is taken for, at most
MOST_LINES, ON_PEAK = (300, 1000), 8  # that a cluster is read from, and fitted last; on its narrowest peak at least
PASSES = 3
LAGS = 2  # lines over which a window makes noise alike
SMOOTH = 40.0  # times the noise that neighbouring lines tell: more is no noise
FIRST = 10, 4, 8  # clusters, of so many poles at most, and channels, that say whether peaks are shifted at all
CLUSTERS = 12  # that tell which channels are one set-up, at most
ALIVE = 2.0  # rms of a channel over its noise
DAMPED = 5.0  # times the usual damping, beyond which a mode is no peak


class Cluster(NamedTuple):
    """Modes near each other, alone in their window: `span` [Hz] they may lie in, variance of an entry by the noise."""

    modes: Modes
    window: Window
    span: tuple[float, float]
    noise: float

    def cost(self, squares: float, modes: int, poles: int) -> float:
        """The criterion: squares over the noise, and a price for each number."""
        numbers = modes * (self.window.columns * self.window.Y.shape[1] + poles)
        return float(squares / self.noise + np.log(self.window.Y.size) * numbers)


class Shifted(NamedTuple):
    """Modes with own frequencies, the variance of ln f (modes, setups), the channels of each set-up.

    `sigma_zeta` (modes,) is the standard deviation of ln zeta, `doubt` (modes,) that of the mean of ln f from not
    knowing which mode is which in a set-up.

    `leak` is the distance of lines [Hz] over which a Hann window leaks, or 0; `shift` what set-ups differ by in ln f,
    usually; `evidence` twice the ln of the odds against common frequencies.
    """

    modes: Modes
    variance: FloatArray
    sigma_zeta: FloatArray
    doubt: FloatArray
    setups: Setups
    leak: float
    shift: float
    evidence: float

    @property
    def several(self) -> bool:
        """Whether peaks are shifted at all."""
        return self.evidence > 0.0 and len(self.setups) > 1

    def mean(self) -> tuple[FloatArray, FloatArray]:
        """Mean frequency [Hz] of each mode over the set-ups, and the standard deviation of its ln, (modes,).

        A set-up that does not see a mode has, as far as one can tell, what the others have, within `shift`.
        """
        logs = np.log(self.modes.freq)
        weight = 1.0 / (self.variance + self.shift**2 + 1e-300)
        centre = (weight * logs).sum(axis=1, keepdims=True) / weight.sum(axis=1, keepdims=True)
        each = centre + self.shift**2 * weight * (logs - centre)
        left = self.variance * self.shift**2 * weight
        return np.exp(each).mean(axis=1), np.sqrt(left.mean(axis=1) / logs.shape[1])

    def aligned(self, whole: Window) -> Window:
        """The data as they would be if every set-up had the mean frequencies."""
        whole = replace(whole, leak=self.leak)
        together = self.modes._replace(freq=self.mean()[0][:, None])
        change = together.response(whole, [np.arange(whole.Y.shape[1])]) - self.modes.response(whole, self.setups)
        return replace(whole, Y=whole.Y + np.concatenate([change.real, change.imag]))


def shifted(whole: Window, modes: Modes) -> Shifted:
    """Read a test of common poles (one set-up) as one of several; `whole` has all lines and channels."""
    alive = np.mean(whole.Y**2, axis=0) > ALIVE**2
    common = list(clusters(whole, modes, [np.arange(len(alive))]))
    damped = DAMPED * float(np.median(modes.zeta))
    step = float(whole.freq[1] - whole.freq[0])
    some = [c for c in common if len(c.modes.zeta) <= FIRST[1]] or common
    few = np.flatnonzero(alive)
    few = few[_spread(len(few), FIRST[2])]
    first = _alone([some[k] for k in _spread(len(some), FIRST[0])], few, damped, step)
    if len(few) < 2 or max(first.evidence, default=0.0) <= 0.0:
        return _unshifted(common, modes, step, sum(first.evidence))
    alone = _alone([common[k] for k in _spread(len(common), CLUSTERS)], np.arange(len(alive)), damped, step)
    if sum(alone.evidence) <= 0.0:
        return _unshifted(common, modes, step, sum(alone.evidence))
    setups, shift, leak = find_setups(alone.peaks, alive), scatter(alone.peaks), alone.leak
    for again in range(PASSES):
        found = [_leaking(c, leak) for c in (clusters(replace(whole, leak=leak), modes, setups) if again else common)]
        own = _read_all(found, setups, damped, shift)
        merged = find_setups([each.own for each in own], np.ones(len(setups), bool))
        if len(merged) < len(setups):
            setups = [np.sort(np.concatenate([setups[k] for k in group])) for group in merged]
            own = _read_all(found, setups, damped, shift)
        if not own:
            return _unshifted(common, modes, step, 0.0)
        shift, modes = scatter([each.own for each in own]), _joined(own)
    last = [_polished(c, setups) for c in clusters(replace(whole, leak=leak), modes, setups, MOST_LINES[1])]
    return Shifted(
        modes=_joined(last),
        variance=np.concatenate([each.own.variance for each in last]),
        sigma_zeta=np.sqrt(np.concatenate([each.own.zeta_variance[:, 0] for each in last])),
        doubt=np.concatenate([label_doubt(each.free, setups, shift) for each in last]),
        setups=setups,
        leak=leak,
        shift=shift,
        evidence=sum(alone.evidence),
    )


def _polished(c: Cluster, setups: Setups) -> _Read:
    """The modes of a cluster on more of its lines."""
    f, zeta = c.modes.freq, c.modes.zeta
    return _Read(c, _again(c, setups, f, zeta), _fit(c, setups, f, zeta))


def _unshifted(common: Sequence[Cluster], modes: Modes, step: float, evidence: float) -> Shifted:
    """The common poles, and whether a window leaks over the step of the lines [Hz]."""
    gain = 0.0
    for c in common:
        plain, leaked = (_fit_common(_leaking(c, by)).squares for by in (0.0, step))
        gain += (plain - leaked) / c.noise
    nothing, all_of_them = np.zeros(len(modes.zeta)), np.arange(modes.residues.shape[1])
    leak = step if gain > 0.0 else 0.0
    return Shifted(modes, nothing[:, None], nothing, nothing, [all_of_them], leak, 0.0, evidence)


def _spread(count: int, most: int) -> IntArray:
    """Indices of so many of `count` at most, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.int64))


class _Alone(NamedTuple):
    """Clusters read with every channel for a set-up of its own."""

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
            leaked, own = _again(_leaking(c, step), single, freq, zeta), _again(c, single, freq, zeta)
            found.append((c, own, leaked))
    leak = step if sum((plain.squares - leaked.squares) / c.noise for c, plain, leaked in found) > 0.0 else 0.0
    evidence = [_evidence(c, leaked if leak else plain, len(single)) for c, plain, leaked in found]
    return _Alone([leaked if leak else plain for _, plain, leaked in found], leak, evidence)


def _evidence(c: Cluster, own: OwnPeaks, setups: int) -> float:
    """Twice the ln of the odds of own frequencies against common poles, noise unknown; alike lines count as one.

    A fit that ended in a poor place speaks no more against shifts than one that is as good as common poles.
    """
    shared, price, m = _fit_common(c).squares, np.log(c.window.Y.size), len(own.freq)
    lines = min(c.window.Y.size, shared / c.noise)
    numbers = [k * (c.window.columns * c.window.Y.shape[1] + poles)
               for k, poles in ((m, setups + 1), (len(c.modes.zeta), 2))]  # fmt: skip
    gain = lines * np.log(shared / max(own.squares, 1e-300)) - price * (numbers[0] - numbers[1])
    return float(max(gain, -price * m * (setups - 1)))


def _fit_common(c: Cluster) -> OwnPeaks:
    """The cluster's common poles, refined."""
    return linked(c.window, [np.arange(c.window.Y.shape[1])], c.modes.freq, c.modes.zeta, c.noise, c.span)


def scatter(own: Sequence[OwnPeaks]) -> float:
    """What set-ups differ by in ln f, usually."""
    return float(np.median(np.concatenate([np.log(o.freq).std(axis=1, ddof=min(1, o.freq.shape[1] - 1)) for o in own])))


def _again(c: Cluster, setups: Setups, freq: FloatArray, zeta: FloatArray) -> OwnPeaks:
    """Modes matched as they are, damping in common."""
    return linked(c.window, setups, freq, zeta, c.noise, c.span)


def _linked(c: Cluster, setups: Setups, own: OwnPeaks, shift: float) -> OwnPeaks:
    """The modes of all set-ups put together, damping in common."""
    return _in_common(c, setups, matched(own, setups, shift))


def _in_common(c: Cluster, setups: Setups, own: OwnPeaks) -> OwnPeaks:
    """Matched modes with the mean of their damping as a start."""
    weight = 1.0 / (own.zeta_variance + 1e-4)
    zeta = np.exp((weight * np.log(own.zeta)).sum(axis=1) / weight.sum(axis=1))
    return _again(c, setups, own.freq, zeta)


def _leaking(c: Cluster, leak: float) -> Cluster:
    return c._replace(window=replace(c.window, leak=leak))


def _joined(own: Sequence[_Read]) -> Modes:
    """The modes of all clusters, residues in the units of the data."""
    residues = [o.residues / c.window.weight / c.window.scale**c.window.power for c, o, _ in own]
    return Modes(
        np.concatenate([each.own.freq for each in own]),
        np.concatenate([each.own.zeta[:, 0] for each in own]),
        np.concatenate(residues),
    )


def clusters(whole: Window, modes: Modes, setups: Setups, most_lines: int = MOST_LINES[0]) -> Iterator[Cluster]:
    """Modes so near each other that one's shifted peaks may be several of them, without all others.

    Of many lines every so many are taken, as long as the narrowest peak keeps enough.
    """
    modes = modes.some(np.argsort(modes.freq.min(axis=1)))
    low, high = modes.freq.min(axis=1), np.maximum.accumulate(modes.freq.max(axis=1))
    reach = (REACH[0] + REACH[1] * modes.zeta) * low
    cuts = np.flatnonzero(low[1:] - high[:-1] > reach[1:] + reach[:-1]) + 1
    rest = whole.as_complex - modes.response(whole, setups)
    step = float(whole.freq[1] - whole.freq[0])
    near = np.split(np.arange(len(low)), cuts)
    for members in (part for each in near for part in _few_each(each, low)):
        zeta = modes.zeta[members].max()
        span = float((low - reach)[members].min()), float((modes.freq.max(axis=1) + reach)[members].max())
        a, b = np.searchsorted(whole.freq, [span[0] * (1.0 - AROUND * zeta), span[1] * (1.0 + AROUND * zeta)]).tolist()
        a = max(min(a, b - LEAST_LINES, len(whole.freq) - LEAST_LINES), 0)
        b = min(max(b, a + LEAST_LINES), len(whole.freq))
        narrowest = 2.0 * float((modes.zeta * low)[members].min()) / step
        stride = max(1, int(min((b - a) / most_lines, narrowest / ON_PEAK)))
        lines = slice(a, b, stride)
        bare = replace(whole, freq=whole.freq[lines], Y=np.zeros((0, rest.shape[1])))
        mine = rest[lines] + modes.some(members).response(bare, setups)
        window = replace(bare, Y=np.concatenate([mine.real, mine.imag]))
        left = np.concatenate([rest[lines].real, rest[lines].imag])
        Q = np.linalg.qr(window.residuals())[0]
        left -= Q @ (Q.T @ left)
        noise = _noise((left[: len(mine)] + 1j * left[len(mine) :]).T)
        yield Cluster(modes.some(members), window, span, max(noise, whole.floor**2, 1e-300))


def _few_each(members: IntArray, freq: FloatArray) -> list[IntArray]:
    """Modes near each other in parts of no more than so many, cut at the widest gap that leaves both sides some."""
    if len(members) <= TOGETHER:
        return [members]
    edge = TOGETHER // 4
    cut = edge + 1 + int(np.argmax(np.diff(freq[members])[edge:-edge]))
    return _few_each(members[:cut], freq) + _few_each(members[cut:], freq)


def _noise(rest: Array) -> float:
    """Variance of an entry, from what is left (channels, lines), times the number of lines over which that is alike.

    What modes not yet found leave counts as noise, too, up to a limit: it falls when they are.
    """
    whole = float(np.sum(np.abs(rest) ** 2))
    if whole == 0.0:
        return 0.0
    alike = [float(np.sum((rest[:, k:] * rest[:, :-k].conj()).real)) / whole for k in range(1, LAGS + 1)]
    many = 1.0 + 2.0 * sum((1.0 - k / (LAGS + 1.0)) * rho for k, rho in enumerate(alike, start=1))
    rough = float(np.mean(line_noise(rest) ** 2))
    return max(rough, min(0.5 * whole / rest.size * max(many, 1.0), SMOOTH * rough))


def read(cluster: Cluster, setups: Setups, damped: float, shift: float) -> OwnPeaks | None:
    """As many modes with own frequencies as the data prefer, none more `damped` than that; None where none is.

    Damping is common to the set-ups or their own, as the data prefer.
    """
    best, least, misses = None, np.inf, 0
    f, z = cluster.modes.freq.mean(axis=1), np.minimum(cluster.modes.zeta, damped)
    for start in places(cluster.window, setups, f, z, min(MOST, len(f) + 1), cluster.span):
        zeta = z[np.abs(start.mean(axis=1)[:, None] - f).argmin(axis=1)]
        tried = [_fit(cluster, setups, start, zeta)]
        if len(setups) > 1:
            tried.append(_linked(cluster, setups, tried[0], shift))
        if cluster.modes.freq.shape == start.shape:
            tried.append(_again(cluster, setups, cluster.modes.freq, z))
        poles = [2 * len(setups), *[len(setups) + 1] * 2]
        costs = [cluster.cost(own.squares, len(start), each) for own, each in zip(tried, poles, strict=False)]
        own, cost = tried[int(np.argmin(costs))], min(costs)
        if cost < least and _peaks_inside(own, cluster.span, damped):
            best, least, misses = own, cost, 0
        elif misses:
            break
        else:
            misses += 1
    return best


class _Read(NamedTuple):
    """A cluster, its modes with damping in common, and with damping of their own in each set-up."""

    cluster: Cluster
    own: OwnPeaks
    free: OwnPeaks


def _read_all(found: Sequence[Cluster], setups: Setups, damped: float, shift: float) -> list[_Read]:
    """Clusters with the modes of all set-ups matched, damping in common; those that hold none are left out."""
    read_ones = []
    for c in found:
        if (own := read(c, setups, damped, shift)) is not None:
            free = matched(_fit(c, setups, own.freq, np.median(own.zeta, axis=1)), setups, shift)
            read_ones.append(_Read(c, _in_common(c, setups, free), free))
    return read_ones


def _peaks_inside(own: OwnPeaks, span: tuple[float, float], most: float) -> bool:
    """Whether every mode is a peak within the span in most set-ups, no more damped than that."""
    inside = (own.freq > span[0]) & (own.freq < span[1])
    return bool((inside.mean(axis=1) > 0.5).all() and (np.median(own.zeta, axis=1) < most).all())


def _fit(cluster: Cluster, setups: Setups, freq: FloatArray, zeta: FloatArray) -> OwnPeaks:
    return apart(cluster.window, setups, freq, zeta, cluster.noise, cluster.span)
