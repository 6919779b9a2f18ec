"""Recognise several set-ups: a roving mass or a moved hammer gives each set-up frequencies of its own.

Fitted together, each mode leaves one pole for each set-up, which only the channels of that set-up see. So the sizes of
residues over the poles of a window are alike in channels of one set-up, and average linkage makes a tree of channels.
In each window of lines the poles of a branch are fitted alone. A branch is cut in two where this saves a tenth of the
parameters m, 2 for each pole and channel and 2 for each pole; or, because one fit may lack poles, a tenth of the
information criterion (Schwarz, Ann. Stat. 6, 1978, 461), summed over the windows,

    N ln max(R/N, 1) + m ln N,

R the sum of squares over the noise of N real numbers. Two set-ups save a third and more of either.

Two branches with equally many poles in a window have differences d_k of ln frequency, of standard deviation s_k. Poles
of one test repeat, d_k ~ N(0, s_k^2). Poles of two set-ups are shifted, d_k ~ Cauchy(0, hypot(gamma, s_k)), of any
width gamma. With e the share of poles that are shifted,

    ln L(e, gamma) = sum_k ln[(1 - e) N(d_k) + e Cauchy(d_k)],
    evidence = 2 [max_gamma ln L(1, gamma) - max_(e <= 1/2, gamma) ln L(e, gamma)].

In one test e is not zero: a local mode, or one of a pair, may be seen by one branch alone. Two branches whose evidence
is below zero are one group. P groups are set-ups where the mean evidence of all pairs, times P - 1, exceeds what chance
exceeds once in a thousand (chi-squared of one degree of freedom: Wilks, Ann. Math. Stat. 9, 1938, 60).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.cluster.hierarchy import ClusterNode, linkage, to_tree
from scipy.spatial.distance import squareform
from scipy.special import chdtri

from casingfem.experiment.identify.clusters import Responses
from casingfem.experiment.identify.counting import counted
from casingfem.experiment.identify.lscf import candidates, compressed
from casingfem.experiment.identify.pole_fit import PoleFit, fit_poles
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import FloatArray, IntArray

LEAST_CHANNELS = 2  # of a set-up
REPEATING = 0.5  # least share of poles that two groups of channels of one test have in common
CHANCE = 1e-3  # that one test is taken for several set-ups
FEWER = 0.9  # of either criterion: a weak pole that one branch lacks saves a few per cent of it
HEARD = 2.0  # residues of a channel over their noise; sqrt(2) without signal
SHARES = np.linspace(0.0, 1.0 - REPEATING, 6)[:, None, None]
WIDTHS = np.geomspace(1e-8, 1.0, 50)[:, None]  # gamma


class SetUp(NamedTuple):
    """Channels measured together (channels,), their responses, and the fits of their modes."""

    channels: IntArray
    data: Responses
    fits: list[PoleFit]


class _Group(NamedTuple):
    """Channels (channels,) and their own fit in each window."""

    channels: IntArray
    fits: list[PoleFit]


def setups_of(data: Responses, fits: list[PoleFit], rules: Thresholds = USUAL) -> list[IntArray]:
    """Channels of each set-up; an empty list where all are one."""
    fits = [fit for fit in fits if len(fit) and fit.refined]
    heard = _heard(fits)
    if len(heard) < 2 * LEAST_CHANNELS:
        return []
    far = _distances(fits)
    tree = linkage(squareform(far[np.ix_(heard, heard)], checks=False), method="average")
    whole = _Group(np.arange(data.Y.shape[1]), fits)
    groups = _branches(data, fits, whole, heard, to_tree(tree), rules)
    left, evidence = list(range(len(groups))), dict[tuple[int, int], float]()
    while len(left) > 1:
        pairs = list(combinations(left, 2))
        evidence |= {(i, j): shifted(*_differences(groups[i], groups[j])) for i, j in pairs if (i, j) not in evidence}
        least = min(pairs, key=evidence.__getitem__)
        if evidence[least] >= 0.0:
            break
        joined = np.sort(np.concatenate([groups[k].channels for k in least]))
        left = [*(k for k in left if k not in least), len(groups)]
        groups.append(_alone(data, fits, joined, rules))
    total = sum(evidence[pair] for pair in combinations(left, 2))
    if len(left) < 2 or 2.0 / len(left) * total < chdtri(1, 2.0 * CHANCE):
        return []
    parts = [groups[k].channels for k in left]
    for lonely in np.setdiff1d(np.arange(data.Y.shape[1]), np.concatenate(parts)).tolist():
        nearest = int(np.argmin([far[lonely, groups[k].channels].mean() for k in left]))
        parts[nearest] = np.sort(np.append(parts[nearest], lonely))
    return parts


def shifted(d: FloatArray, s: FloatArray) -> float:
    """Evidence that poles are shifted by d (poles,), of standard deviation s; below zero where most of them repeat.

    >>> s, z = np.full(12, 1e-5), np.linspace(-1.5, 1.5, 12)
    >>> shifted(z * s, s) < 0.0, round(shifted(100.0 * z * s, s), 1)
    (True, 16.6)
    """
    if not len(d):
        return 0.0
    same = np.exp(-0.5 * (d / s) ** 2) / (s * np.sqrt(2.0 * np.pi))
    wide = np.hypot(WIDTHS, s)
    other = wide / (np.pi * (d**2 + wide**2))
    mixed = np.log((1.0 - SHARES) * same + SHARES * other + 1e-300).sum(axis=-1)
    return float(2.0 * (np.log(other).sum(axis=-1).max() - mixed.max()))


def _distances(fits: list[PoleFit]) -> FloatArray:
    """1 - cosine of the sizes of residues over the poles of a window, mean over the windows (channels, channels)."""
    windows = [fit for fit in fits if len(fit) > 1]
    far = np.zeros((fits[0].A.shape[1],) * 2)
    for fit in windows:
        sizes = np.abs(fit.A) / (np.linalg.norm(fit.A, axis=0) + 1e-300)
        far += (1.0 - sizes.T @ sizes) / len(windows)
    far = np.clip(0.5 * (far + far.T), 0.0, None)
    np.fill_diagonal(far, 0.0)
    return far


def _heard(fits: list[PoleFit]) -> IntArray:
    """Channels whose residues are above their noise: a dead one has no set-up of its own."""
    ratios = [np.sqrt(np.sum(np.abs(fit.A) ** 2, axis=0) / np.trace(fit.gram).real) for fit in fits if len(fit) > 1]
    return np.flatnonzero(np.median(ratios, axis=0) > HEARD) if ratios else np.zeros(0, np.int64)


def _branches(
    data: Responses, fits: list[PoleFit], whole: _Group, heard: IntArray, node: ClusterNode, rules: Thresholds
) -> list[_Group]:
    """The branches of a tree of channels, cut while a criterion falls by a tenth; single channels are in none."""
    sides = [node.get_left(), node.get_right()]
    while min(side.get_count() for side in sides) < LEAST_CHANNELS:
        node = max(sides, key=ClusterNode.get_count)
        if node.get_count() < 2 * LEAST_CHANNELS:
            return [whole]
        sides = [node.get_left(), node.get_right()]
    parts = [_alone(data, fits, np.sort(heard[side.pre_order()]), rules) for side in sides]
    together = np.concatenate([part.channels for part in parts])
    two, one = sum(_criteria(part, part.channels) for part in parts), _criteria(whole, together)
    if np.all(two >= FEWER * one):
        return [whole]
    return [
        each
        for part, side in zip(parts, sides, strict=True)
        for each in _branches(data, fits, part, heard, side, rules)
    ]


def _criteria(group: _Group, channels: IntArray) -> FloatArray:
    """Number of parameters, and information criterion, of the fits of a group for some of its channels (2,)."""
    total, columns = np.zeros(2), np.isin(group.channels, channels)
    for fit in group.fits:
        count = 2.0 * len(fit.rest) * len(channels)
        squares = float(np.sum(np.abs(fit.rest[:, columns]) ** 2))
        parameters = len(fit) * (2.0 * len(channels) + 2.0)
        total += parameters, count * np.log(max(squares / count, 1.0)) + parameters * np.log(count)
    return total


def _alone(data: Responses, fits: list[PoleFit], channels: IntArray, rules: Thresholds) -> _Group:
    """Fits of some channels in the windows of all, with as many poles as they justify."""
    own, seen = [], data.freq[data.peaks.at]
    for fit in fits:
        whole = replace(fit.window, Y=fit.window.Y[:, channels])
        small = replace(whole, Y=compressed(whole.Y))
        here = seen[(seen >= whole.freq[0]) & (seen <= whole.freq[-1])]
        start = candidates(whole.freq, small.Y, len(here), data.end, rules=rules).poles
        inside = (start.imag > 2.0 * np.pi * whole.freq[0]) & (start.imag < 2.0 * np.pi * whole.freq[-1])
        found = counted(small, start[inside], here, rules=rules)
        own.append(fit_poles(whole, found.poles, steps=0))
    return _Group(channels, own)


def _differences(one: _Group, two: _Group) -> tuple[FloatArray, FloatArray]:
    """Differences of ln frequency and their deviations (poles,), of windows with equally many poles in both groups."""
    pairs = [(a, b) for a, b in zip(one.fits, two.fits, strict=True) if len(a) == len(b)]
    d = [np.log(a.poles.imag / b.poles.imag) for a, b in pairs]
    s = [np.hypot(*(fit.sigma[0] * fit.poles.real / fit.poles.imag for fit in pair)) for pair in pairs]
    return np.concatenate([np.zeros(0), *d]), np.concatenate([np.zeros(0), *s])
