"""Tests of several set-ups: a roving mass or a moved hammer gives each set-up frequencies of its own.

Fitted together, each mode leaves one pole for each set-up, and each of these poles is seen by the channels of its
set-up. So channels of one set-up share their poles: the sizes of their residues over the poles of a group are alike
(cosine 0.8 to 0.9 for any shapes), those of two set-ups are not (0.5). Channels are put together by that; each set-up
is identified alone; the description is taken where it needs fewer numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform

from casingfem.experiment.identify.clusters import Responses
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.io.arrays import IntArray

LEAST_GROUPS = 3  # of two poles or more, that show set-ups
LEAST_CHANNELS = 2  # of a set-up
APART, PERHAPS = 0.35, 0.25  # 1 - cosine between two set-ups, usual; of two that are tried
ALONE = 0.75  # share of a pole's energy in its set-up, median; two references that drive pairs apart give 0.65 to 0.74
MULTIPLIED = 1.25  # poles of the common description over those of one set-up, at least
HEARD = 2.0  # residues of a channel over their noise; sqrt(2) without signal


class SetUp(NamedTuple):
    """Channels measured together (channels,), their responses, and the fits of their modes."""

    channels: IntArray
    data: Responses
    fits: list[PoleFit]


def setups_of(fits: list[PoleFit], channels: int) -> list[IntArray]:
    """Channels of each set-up; an empty list where all are one."""
    groups = [fit for fit in fits if len(fit) > 1]
    if len(groups) < LEAST_GROUPS or channels < 2 * LEAST_CHANNELS:
        return []
    heard = _heard(groups)
    alike = np.zeros((channels, channels))
    for fit in groups:
        sizes = np.abs(fit.A) / (np.linalg.norm(fit.A, axis=0) + 1e-300)
        alike += sizes.T @ sizes / len(groups)
    far = np.clip(1.0 - alike, 0.0, None)
    np.fill_diagonal(far, 0.0)
    near = 0.5 * (far + far.T)[np.ix_(heard, heard)]
    if len(heard) < 2 * LEAST_CHANNELS:
        return []
    tree = linkage(squareform(near, checks=False), method="average")
    heights = tree[:, 2]
    if heights[-1] < PERHAPS:
        return []
    first = int(np.argmax(heights >= min(APART, heights[-1])))  # merges from here on join set-ups
    number = fcluster(tree, 0.5 * (heights[first] + (heights[first - 1] if first else 0.0)), criterion="distance")
    parts = [heard[number == k] for k in np.unique(number)]
    parts = [part for part in parts if len(part) >= LEAST_CHANNELS]
    if len(parts) < 2 or len(parts) > channels // LEAST_CHANNELS or _alone(fits, parts) < ALONE:
        return []
    for lonely in np.setdiff1d(np.arange(channels), np.concatenate(parts)).tolist():
        nearest = int(np.argmin([far[lonely, part].mean() for part in parts]))
        parts[nearest] = np.sort(np.append(parts[nearest], lonely))
    return parts


def _heard(groups: list[PoleFit]) -> IntArray:
    """Channels whose residues are above their noise: a dead one has no set-up of its own."""
    ratios = [np.sqrt(np.sum(np.abs(fit.A) ** 2, axis=0) / np.trace(fit.gram).real) for fit in groups]
    return np.flatnonzero(np.median(ratios, axis=0) > HEARD)


def _alone(fits: list[PoleFit], parts: list[IntArray]) -> float:
    """Median over the poles of the largest share of a pole's energy that is in one part."""
    energy = np.abs(np.concatenate([fit.A for fit in fits])) ** 2
    shares = np.array([energy[:, part].sum(axis=1) for part in parts]) / (energy.sum(axis=1) + 1e-300)
    return float(np.median(shares.max(axis=0)))


def simpler(fits: list[PoleFit], alone: list[SetUp]) -> bool:
    """Whether set-ups describe the same with fewer numbers, 2 for each pole and channel and 2 for each pole.

    Two references that drive different members of pairs split the channels too, but they do not multiply the poles of
    the common description: these are then hardly more than those of one part.
    """
    if not alone:
        return False
    channels = sum(len(part.channels) for part in alone)
    poles, most = sum(len(fit) for fit in fits), max(sum(len(fit) for fit in part.fits) for part in alone)
    apart = sum(sum(len(fit) for fit in part.fits) * (2 * len(part.channels) + 2) for part in alone)
    return apart < poles * (2 * channels + 2) and poles > MULTIPLIED * most
