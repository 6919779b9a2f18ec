"""Recognise several set-ups: a roving mass or a moved hammer changes the frequencies from set-up to set-up.

If all channels are fitted together, each mode gives one pole for each set-up, which only the channels of that set-up
see. So the channels of one set-up have similar magnitudes of residues over the poles of a window. Average linkage forms
a tree of channels from them. In each window of lines the recurring poles of a branch are fitted alone; none is added,
for weak poles decide nothing here. A branch is cut in two where this saves a tenth of the parameters m, 2 for each pole
and channel and 2 for each pole; or, because one fit may lack poles, a tenth of the information criterion (Schwarz, Ann.
Stat. 6, 1978, 461), summed over the windows,

    N ln max(R/N, 1) + m ln N,

R the sum of squares over the noise of N real numbers. Two set-ups save at least a third of either. With a roving sensor
each channel is a set-up and has its own branch: there most poles are seen by one channel.

Two branches with equally many poles in a window have differences d_k of ln frequency, of standard deviation s_k. Poles
of one test repeat, d_k ~ N(0, s_k^2). Poles of two set-ups are shifted, d_k ~ Cauchy(0, hypot(gamma, s_k)), of any
width gamma. With e the share of poles that are shifted,

    ln L(e, gamma) = sum_k ln[(1 - e) N(d_k) + e Cauchy(d_k)],
    evidence = 2 [max_gamma ln L(1, gamma) - max_(e <= E, gamma) ln L(e, gamma)].

In one test e is not zero: a local mode may be seen by one branch alone, E = 1/4. Two references at one sensor may drive
different members of every second pair, E = 1/2. Two branches whose evidence is below zero are one group. P groups are
set-ups if each has whole sensors, or whole references, and if the mean evidence of all pairs, times P - 1, exceeds the
value that chance exceeds once in a hundred (chi-squared of one degree of freedom: Wilks, Ann. Math. Stat. 9, 1938, 60).
The branches are tested first. If they pass, channels change to the group whose poles fit them best, and the groups are
tested again.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.cluster.hierarchy import ClusterNode, linkage, to_tree
from scipy.spatial.distance import squareform
from scipy.special import chdtri

from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.counting import counted
from casingfem.experiment.identify.groups import SetUp
from casingfem.experiment.identify.lscf import candidates, compressed
from casingfem.experiment.identify.pole_fit import PoleFit, fit_poles
from casingfem.experiment.identify.responses import Responses
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import FloatArray, IntArray

LEAST_CHANNELS = 2  # of a branch
SCREENED, LEVELS = 8, 2  # strongest windows in which branches are searched; levels of the tree in one cut
EVERY = 2  # step of the orders of the poles of a branch
MOVES = 3  # most rounds in which channels change their group
SHIFTED = 0.25, 0.5  # largest share of shifted poles of one test: between sensors, between references of one sensor
CHANCE = 1e-2  # probability that one test is taken for several set-ups
FEWER = 0.9  # of either criterion: a weak pole that one branch lacks saves a few per cent of it
HEARD = 2.0  # least ratio of a channel's residues to their noise; sqrt(2) without signal
SHARES = np.linspace(0.0, 1.0, 6)[:, None, None]  # parts of the largest share that are tried
WIDTHS = np.geomspace(1e-8, 1.0, 50)[:, None]  # gamma


class _Group(NamedTuple):
    """Channels (channels,) and their own fit in each window."""

    channels: IntArray
    fits: list[PoleFit]


def setups_of(whole: SetUp, grid: SensorGrid, rules: Thresholds = USUAL) -> list[IntArray]:
    """Channels of each set-up, from fits of all channels together; an empty list if there is one set-up."""
    data, fits = whole.data, [fit for fit in whole.fits if len(fit) and fit.refined]
    heard = _heard(fits)
    if len(heard) < 2 * LEAST_CHANNELS:
        return []
    far = _distances(fits)
    tree = to_tree(linkage(squareform(far[np.ix_(heard, heard)], checks=False), method="average"))
    strong = sorted(fits, key=lambda fit: -float(np.sum(np.abs(fit.A) ** 2)))[:SCREENED]
    branches = _branches(data, strong, _Group(np.arange(data.Y.shape[1]), strong), heard, tree, rules)
    branches = _each_alone(data, strong, branches, heard, rules)
    if len(branches) < 2:
        return []
    groups = _shifted_groups(data, fits, [_alone(data, fits, each.channels, rules) for each in branches], grid, rules)
    groups = _shifted_groups(data, fits, _by_their_poles(data, fits, groups, rules), grid, rules) if groups else []
    parts = [group.channels for group in groups]
    return parts if all(_whole(grid, part) for part in parts) else []


def _shifted_groups(
    data: Responses, fits: list[PoleFit], groups: list[_Group], grid: SensorGrid, rules: Thresholds
) -> list[_Group]:
    """The groups whose poles are shifted by more than chance, or none; groups whose poles repeat are joined."""
    groups, left, evidence = list(groups), list(range(len(groups))), dict[tuple[int, int], float]()
    while len(left) > 1:
        pairs = list(combinations(left, 2))
        for i, j in pairs:
            if (i, j) not in evidence:
                evidence[i, j] = _evidence(grid, groups[i], groups[j])
        least = min(pairs, key=evidence.__getitem__)
        if evidence[least] >= 0.0:
            break
        left = [k for k in left if k not in least]
        if left:
            joined = np.sort(np.concatenate([groups[k].channels for k in least]))
            left = [*left, len(groups)]
            groups.append(_alone(data, fits, joined, rules))
    total = sum(evidence[pair] for pair in combinations(left, 2))
    return [groups[k] for k in left] if left and 2.0 / len(left) * total >= chdtri(1, 2.0 * CHANCE) else []


def _by_their_poles(data: Responses, fits: list[PoleFit], groups: list[_Group], rules: Thresholds) -> list[_Group]:
    """Regroup the channels: each joins the group whose poles give it the least information criterion."""
    for _ in range(MOVES):
        costs = [[_cost_of_channels(*each) for each in zip(fits, group.fits, strict=True)] for group in groups]
        nearest = np.sum(costs, axis=1).argmin(axis=0)
        parts = [np.flatnonzero(nearest == k) for k in range(len(groups))]
        if all(np.array_equal(part, group.channels) for part, group in zip(parts, groups, strict=True)):
            break
        groups = [
            group if np.array_equal(part, group.channels) else _alone(data, fits, part, rules)
            for part, group in zip(parts, groups, strict=True)
            if len(part)
        ]
    return groups


def _cost_of_channels(whole: PoleFit, own: PoleFit) -> FloatArray:
    """Information criterion of each channel of a window with the poles of a group, (channels,)."""
    rest = fit_poles(whole.window, own.poles, steps=0).rest
    count = 2.0 * len(rest)
    squares = np.sum(np.abs(rest) ** 2, axis=0)
    return np.asarray(count * np.log(np.maximum(squares / count, 1.0)) + 2.0 * len(own) * np.log(count))


def _evidence(grid: SensorGrid, one: _Group, two: _Group) -> float:
    """Evidence that two groups of channels are set-ups; below zero where they measure different directions.

    A beam has a family of modes in each direction, which resemble shifted copies of each other.
    """
    sensors = [np.isin(grid.channels, group.channels).any(axis=1) for group in (one, two)]
    first, second = (np.abs(grid.directions[some]) for some in sensors)
    if not np.isin(first, second).any():
        return -np.inf
    return shifted(*_differences(one, two), SHIFTED[int(np.any(sensors[0] & sensors[1]))])


def _whole(grid: SensorGrid, channels: IntArray) -> bool:
    """Whether the channels are complete: all channels of some sensors, or all of some references."""
    own = np.isin(grid.channels, channels)
    return bool(np.all(own.all(axis=1) == own.any(axis=1)) or np.all(own.all(axis=0) == own.any(axis=0)))


def shifted(d: FloatArray, s: FloatArray, most: float) -> float:
    """Evidence that poles are shifted by d (poles,), of standard deviation s; below zero where most of them repeat.

    In one test a share of the poles up to `most` is shifted.

    >>> s, z = np.full(12, 1e-5), np.linspace(-1.5, 1.5, 12)
    >>> shifted(z * s, s, 0.5) < 0.0, round(shifted(100.0 * z * s, s, 0.5), 1)
    (True, 16.6)
    """
    if not len(d):
        return 0.0
    same = np.exp(-0.5 * (d / s) ** 2) / (s * np.sqrt(2.0 * np.pi))
    wide = np.hypot(WIDTHS, s)
    other = wide / (np.pi * (d**2 + wide**2))
    shares = most * SHARES
    mixed = np.log((1.0 - shares) * same + shares * other + 1e-300).sum(axis=-1)
    return float(2.0 * (np.log(other).sum(axis=-1).max() - mixed.max()))


def _distances(fits: list[PoleFit]) -> FloatArray:
    """Distances of channels (channels, channels).

    1 - cosine of the magnitudes of their residues, mean over the windows.
    """
    windows = [fit for fit in fits if len(fit) > 1]
    far = np.zeros((fits[0].A.shape[1],) * 2)
    for fit in windows:
        sizes = np.abs(fit.A) / (np.linalg.norm(fit.A, axis=0) + 1e-300)
        far += (1.0 - sizes.T @ sizes) / len(windows)
    far = np.clip(0.5 * (far + far.T), 0.0, None)
    np.fill_diagonal(far, 0.0)
    return far


def _heard(fits: list[PoleFit]) -> IntArray:
    """Channels whose residues are above their noise; a dead channel is no set-up."""
    ratios = [np.sqrt(np.sum(np.abs(fit.A) ** 2, axis=0) / np.trace(fit.gram).real) for fit in fits if len(fit) > 1]
    return np.flatnonzero(np.median(ratios, axis=0) > HEARD) if ratios else np.zeros(0, np.int64)


def _branches(
    data: Responses, fits: list[PoleFit], whole: _Group, heard: IntArray, node: ClusterNode, rules: Thresholds
) -> list[_Group]:
    """Branches of a tree of channels, cut while a criterion decreases by a tenth; single channels are excluded.

    If both criteria decrease by less, four branches are tried: each of two branches may still be several set-ups.
    """
    nodes = _sides(node)
    for _ in range(LEVELS):
        if len(nodes) < 2:
            break
        parts = [_alone(data, fits, np.sort(heard[each.pre_order()]), rules) for each in nodes]
        several = sum(_criteria(part, part.channels) for part in parts)
        one = _criteria(whole, np.concatenate([part.channels for part in parts]))
        if np.any(several < FEWER * one):
            cut = [_branches(data, fits, *each, rules) for each in zip(parts, [heard] * len(nodes), nodes, strict=True)]
            return [branch for branches in cut for branch in branches]
        deeper = [side for each in nodes for side in _sides(each)]
        if len(deeper) == len(nodes) or np.any(several >= one):
            break
        nodes = deeper
    return [whole]


def _each_alone(
    data: Responses, fits: list[PoleFit], branches: list[_Group], heard: IntArray, rules: Thresholds
) -> list[_Group]:
    """One branch for each channel, if one channel sees most poles and both criteria decrease by a tenth.

    A roving sensor makes each channel a set-up. A pole is seen by (sum |A|^2)^2/sum |A|^4 channels.
    """
    powers = np.abs(np.concatenate([fit.A for fit in fits])) ** 2
    if np.median(np.sum(powers, axis=1) ** 2 / np.sum(powers**2, axis=1)) >= LEAST_CHANNELS:
        return branches
    single = [_alone(data, fits, heard[[k]], rules) for k in range(len(heard))]
    several = sum(_criteria(part, part.channels) for part in single)
    one = sum(_criteria(branch, np.intersect1d(branch.channels, heard)) for branch in branches)
    return single if np.all(several < FEWER * one) else branches


def _sides(node: ClusterNode) -> list[ClusterNode]:
    """The two branches of a node, without single channels; the node itself if it is too small for two."""
    while node.get_count() >= 2 * LEAST_CHANNELS:
        sides = [node.get_left(), node.get_right()]
        if min(side.get_count() for side in sides) >= LEAST_CHANNELS:
            return sides
        node = max(sides, key=ClusterNode.get_count)
    return [node]


def _criteria(group: _Group, channels: IntArray) -> FloatArray:
    """Number of parameters, and information criterion, of a group's fits for some of its channels (2,)."""
    total, columns = np.zeros(2), np.isin(group.channels, channels)
    for fit in group.fits:
        count = 2.0 * len(fit.rest) * len(channels)
        squares = float(np.sum(np.abs(fit.rest[:, columns]) ** 2))
        parameters = len(fit) * (2.0 * len(channels) + 2.0)
        total += parameters, count * np.log(max(squares / count, 1.0)) + parameters * np.log(count)
    return total


def _alone(data: Responses, fits: list[PoleFit], channels: IntArray, rules: Thresholds) -> _Group:
    """Fit some channels alone in all windows, with the poles that recur over model orders and that they justify."""
    own, seen = [], data.freq[data.peaks.at]
    for fit in fits:
        whole = replace(fit.window, Y=fit.window.Y[:, channels])
        few = compressed(whole.Y)
        small = whole if few is whole.Y else replace(whole, Y=few)
        here = seen[(seen >= whole.freq[0]) & (seen <= whole.freq[-1])]
        start = candidates(whole.freq, small.Y, len(here), data.end, rules=rules, every=EVERY).poles
        inside = (start.imag > 2.0 * np.pi * whole.freq[0]) & (start.imag < 2.0 * np.pi * whole.freq[-1])
        found = counted(small, start[inside], here, more=False, rules=rules)
        own.append(found if few is whole.Y else fit_poles(whole, found.poles, steps=0))
    return _Group(channels, own)


def _differences(one: _Group, two: _Group) -> tuple[FloatArray, FloatArray]:
    """Differences of ln frequency and their deviations (poles,), in windows with equally many poles of both groups."""
    pairs = [(a, b) for a, b in zip(one.fits, two.fits, strict=True) if len(a) == len(b)]
    d = [np.log(a.poles.imag / b.poles.imag) for a, b in pairs]
    s = [np.hypot(*(fit.sigma[0] * fit.poles.real / fit.poles.imag for fit in pair)) for pair in pairs]
    return np.concatenate([np.zeros(0), *d]), np.concatenate([np.zeros(0), *s])
