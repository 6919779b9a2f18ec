"""Tests of several set-ups: a roving mass or a moved hammer gives each set-up frequencies of its own.

Fitted together, each mode leaves one pole for each set-up, and each of these poles is seen by the channels of its
set-up. So channels of one set-up share their poles: the sizes of their residues over the poles of a group are alike
(cosine 0.8 to 0.9 for any shapes), those of two set-ups are not (0.5). Channels are put together by that; each set-up
is identified alone; the description is taken where it needs fewer numbers. Modes of set-ups are then matched by
frequency, damping and, round a circle, by the waves that their shapes are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import squareform

from casingfem.experiment.circle.orientation import Circle, harmonic
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.mode import Found, Residues, found_in
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.experiment.identify.verdict import doubts
from casingfem.io.arrays import Array, FloatArray, IntArray

LEAST_GROUPS = 3  # of two poles or more, that show set-ups
LEAST_CHANNELS = 2  # of a set-up
APART = 0.35  # 1 - cosine between two set-ups, at least
REACH = 5.0  # standard deviations of the shift, within which modes of two set-ups are matched
WIDEST = 0.02  # relative shift beyond which two modes are not one
DAMPING = 0.5  # ln of the ratio of two damping ratios that weighs as one standard deviation
UNLIKE = 2.5  # times the usual spread over the set-ups, beyond which a mode may be two
CLEAR = 0.02  # rise of the shapes' misfit beyond which an exchange is unlikely
SWEEPS = 4


class SetUp(NamedTuple):
    """Channels measured together (channels,), and the fits of their modes."""

    channels: IntArray
    fits: list[PoleFit]


class Track(NamedTuple):
    """One mode over the set-ups: the mean, its frequencies [Hz] and the doubt."""

    found: Found
    freqs: FloatArray
    doubt: str


class _Member(NamedTuple):
    found: Found
    doubt: str


def setups_of(fits: list[PoleFit], channels: int, rules: Thresholds = USUAL) -> list[IntArray]:
    """Channels of each set-up; an empty list where all are one."""
    groups = [fit for fit in fits if len(fit) > 1]
    if len(groups) < LEAST_GROUPS or channels < 2 * LEAST_CHANNELS:
        return []
    alike = np.zeros((channels, channels))
    for fit in groups:
        sizes = np.abs(fit.A) / (np.linalg.norm(fit.A, axis=0) + 1e-300)
        alike += sizes.T @ sizes / len(groups)
    far = np.clip(1.0 - alike, 0.0, None)
    np.fill_diagonal(far, 0.0)
    tree = linkage(squareform(0.5 * (far + far.T), checks=False), method="average")
    heights = tree[:, 2]
    if heights[-1] < APART:
        return []
    first = int(np.argmax(heights >= APART))  # merges from here on join set-ups; the largest gap near by cuts them
    number = fcluster(tree, 0.5 * (heights[first] + (heights[first - 1] if first else 0.0)), criterion="distance")
    parts = [np.flatnonzero(number == k) for k in np.unique(number)]
    parts = [part for part in parts if len(part) >= LEAST_CHANNELS]
    if len(parts) < 2 or len(parts) > channels // LEAST_CHANNELS:
        return []
    for lonely in np.setdiff1d(np.arange(channels), np.concatenate(parts)).tolist():
        nearest = int(np.argmin([far[lonely, part].mean() for part in parts]))
        parts[nearest] = np.sort(np.append(parts[nearest], lonely))
    return parts


def simpler(fits: list[PoleFit], alone: list[SetUp]) -> bool:
    """Whether set-ups need fewer numbers than one common description: 2 for each pole and channel, 2 for each pole."""
    if not alone:
        return False
    channels = sum(len(part.channels) for part in alone)
    common = sum(len(fit) for fit in fits) * (2 * channels + 2)
    apart = sum(sum(len(fit) for fit in part.fits) * (2 * len(part.channels) + 2) for part in alone)
    return apart < common


def tracked(
    alone: list[SetUp], noise: FloatArray, circle: tuple[SensorGrid, Circle] | None, rules: Thresholds = USUAL
) -> list[Track]:
    """Modes of all set-ups, each once, ascending."""
    members = [_members(part, noise, rules) for part in alone]
    table = sorted(_matched(members), key=lambda row: float(np.mean(_logs(row, members))))
    misfit = _wave_misfit(table, members, alone, len(noise), circle)
    exchanged = _exchanged(table, members, misfit)
    shift = _shift(exchanged, members)
    unclear = _unclear(exchanged, members, misfit)
    tracks = [
        _track(row, members, alone, len(noise), shift, more) for row, more in zip(exchanged, unclear, strict=True)
    ]
    return sorted(tracks, key=lambda track: track.found.freq)


def shift_of(tracks: list[Track]) -> float:
    """Standard deviation of ln frequency from set-up to set-up, 0 where there is one."""
    spread = [float(np.var(np.log(track.freqs), ddof=1)) for track in tracks if len(track.freqs) > 1]
    return float(np.sqrt(np.mean(spread))) if spread else 0.0


def setup_notes(tracks: list[Track]) -> tuple[str, ...]:
    """What a test of several set-ups is."""
    if not tracks:
        return ()
    most = max(len(track.freqs) for track in tracks)
    return (
        f"peaks lie at different frequencies in {most} groups of channels (a roving mass, a moved hammer): each was"
        f" identified alone. Frequencies are means; they differ by {100.0 * shift_of(tracks):.2g} % (standard"
        " deviation), and sigma is what one more set-up would show",
    )


def _members(part: SetUp, noise: FloatArray, rules: Thresholds) -> list[_Member]:
    found = []
    for fit in part.fits:
        poles = found_in(fit, noise[part.channels], rules)
        found += [_Member(pole, why) for pole, why in zip(poles, doubts(fit, [1.0] * len(fit), rules), strict=True)]
    return sorted(found, key=lambda member: member.found.freq)


def _matched(members: list[list[_Member]]) -> list[list[int]]:
    """Rows of one index for each set-up, -1 where it lacks the mode: set-ups are added one after the other."""
    order = sorted(range(len(members)), key=lambda k: -len(members[k]))
    table = [[-1] * len(members) for _ in members[order[0]]]
    for k, row in enumerate(table):
        row[order[0]] = k
    for setup in order[1:]:
        mean = np.array([np.mean(_logs(row, members)) for row in table])
        damp = np.array([np.mean(_logs(row, members, damping=True)) for row in table])
        own = np.log([m.found.freq for m in members[setup]])
        own_damp = np.log([m.found.zeta for m in members[setup]])
        if not len(own):
            continue
        gap = np.abs(mean[:, None] - own)
        shift = max(1.5 * float(np.median(gap.min(axis=0))), 1e-6)
        cost = (gap / shift) ** 2 + ((damp[:, None] - own_damp) / DAMPING) ** 2
        allowed = gap < min(REACH * shift, WIDEST)
        rows, columns = linear_sum_assignment(np.where(allowed, np.minimum(cost, 2.0 * REACH**2), 1e6))
        taken = set()
        for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
            if allowed[row, column]:
                table[row][setup] = column
                taken.add(column)
        for column in range(len(own)):
            if column not in taken:
                fresh = [-1] * len(members)
                fresh[setup] = column
                table.append(fresh)
    return table


def _logs(row: list[int], members: list[list[_Member]], damping: bool = False) -> list[float]:
    """Ln f, or ln zeta, of a row's members."""
    some = [members[s][k].found for s, k in enumerate(row) if k >= 0]
    return [float(np.log(found.zeta if damping else found.freq)) for found in some]


def _shift(table: list[list[int]], members: list[list[_Member]]) -> float:
    spread = [np.var(logs, ddof=1) for row in table if len(logs := _logs(row, members)) > 1]
    return float(np.sqrt(np.median(spread))) if spread else 0.0


def _joined(row: list[int], members: list[list[_Member]], alone: list[SetUp], channels: int) -> Array:
    """Residues of a row at all channels (channels,)."""
    values = np.zeros(channels, complex)
    for setup, k in enumerate(row):
        if k >= 0:
            values[alone[setup].channels] = members[setup][k].found.residues.values
    return values


Misfit = Callable[[list[int]], float]


def _wave_misfit(
    table: list[list[int]], members: list[list[_Member]], alone: list[SetUp], channels: int,
    circle: tuple[SensorGrid, Circle] | None,
) -> Misfit:  # fmt: skip
    """How far the shape of a row is from the best wave round the circle, of its size; 0 without a circle.

    Channels weigh by how far the shapes of all rows are off there: one that is turned over, or dead, hardly counts.
    """
    if circle is None or not circle[1].orders:
        return lambda _: 0.0
    grid, orders = circle[0], circle[1].orders
    sensor, reference = (np.zeros(channels, int) for _ in range(2))
    for at in np.ndindex(*grid.channels.shape):
        sensor[grid.channels[at]], reference[grid.channels[at]] = at
    signs = radial_signs(grid)[sensor]
    waves = []
    for n in orders:
        own = signs[:, None] * harmonic(grid.theta[sensor], n)
        parts = [np.where((reference == r)[:, None], own, 0.0) for r in np.unique(reference)]
        waves.append(np.concatenate(parts, axis=1))

    def rest(row: list[int], weight: FloatArray) -> Array:
        values = weight * _joined(row, members, alone, channels)
        there = np.abs(values) > 0.0
        if there.sum() <= waves[-1].shape[1] + 1:
            return np.zeros(channels)
        values = values / np.sum(np.abs(values))
        left = []
        for W in waves:
            columns = weight[there, None] * W[there]
            each = np.zeros(channels)
            each[there] = np.abs(values[there] - columns @ np.linalg.lstsq(columns, values[there], rcond=None)[0])
            left.append(each)
        return min(left, key=lambda each: float(np.sum(each)))

    weight = np.ones(channels)
    for _ in range(SWEEPS):
        off = np.median([rest(row, weight) for row in table], axis=0) / weight
        weight = 1.0 / (off + 0.3 * np.median(off) + 1e-12)
        weight = weight / weight.max()

    def misfit(row: list[int]) -> float:
        return float(np.sum(rest(row, weight)))

    return misfit


def _swaps(
    table: list[list[int]], members: list[list[_Member]], misfit: Misfit
) -> Iterator[tuple[int, int, int, list[int], list[int], float]]:
    """Two close rows and a set-up whose members may be exchanged: both rows then, and what the misfit rises by."""
    reach = 4.0 * _shift(table, members)
    mean = np.array([np.mean(_logs(row, members)) for row in table])
    for k in range(len(table)):
        for m in range(len(table)):
            if m <= k or abs(mean[m] - mean[k]) > reach:
                continue
            for setup in range(len(table[k])):
                one, other = list(table[k]), list(table[m])
                one[setup], other[setup] = other[setup], one[setup]
                if one != table[k] and max(one) >= 0 and max(other) >= 0:
                    rise = misfit(one) + misfit(other) - misfit(table[k]) - misfit(table[m])
                    yield k, m, setup, one, other, rise


def _exchanged(table: list[list[int]], members: list[list[_Member]], misfit: Misfit) -> list[list[int]]:
    """Members of close rows exchanged where the shapes of both then are better waves."""
    table = [list(row) for row in table]
    for _ in range(len(table) * SWEEPS):
        best = min(_swaps(table, members, misfit), key=lambda swap: swap[-1], default=None)
        if best is None or best[-1] > -CLEAR:
            break
        table[best[0]], table[best[1]] = best[3], best[4]
    return table


def _unclear(table: list[list[int]], members: list[list[_Member]], misfit: Misfit) -> list[float]:
    """Variance [Hz^2] of each row's mean frequency from not knowing which of two close modes a member is, (rows,)."""
    variance = [0.0] * len(table)
    for k, m, setup, _, _, rise in _swaps(table, members, misfit):
        first, second = table[k][setup], table[m][setup]
        if first < 0 or second < 0:
            continue
        chance = 0.5 * float(np.exp(-max(rise, 0.0) / CLEAR))
        gap = members[setup][first].found.freq - members[setup][second].found.freq
        for row in (k, m):
            variance[row] += chance * (1.0 - chance) * (gap / sum(each >= 0 for each in table[row])) ** 2
    return variance


def _track(
    row: list[int], members: list[list[_Member]], alone: list[SetUp], channels: int, shift: float, unclear: float
) -> Track:
    """The mean of a row: its set-ups weigh alike, for each has a frequency of its own."""
    some = [(setup, members[setup][k]) for setup, k in enumerate(row) if k >= 0]
    found = [member.found for _, member in some]
    freqs = np.array([each.freq for each in found])
    count, whole = len(found), len(row)
    own = float(np.sqrt(np.sum([each.sigma_freq**2 for each in found]))) / count
    lacking = shift * float(freqs.mean()) * np.sqrt((whole - count) / (whole * count))
    weights = np.array([each.sigma_zeta for each in found]) ** -2.0
    zeta = float(weights @ [each.zeta for each in found] / weights.sum())
    scatter = float(np.sum(weights * (np.array([each.zeta for each in found]) - zeta) ** 2)) / max(count - 1, 1)
    sigma_zeta = float(np.sqrt(max(scatter, 1.0) / weights.sum()))
    direct, parts = np.zeros(channels), []
    for setup, member in some:
        residues = member.found.residues
        direct[alone[setup].channels] = residues.direct
        moved = np.zeros((channels, residues.moved.shape[1]), complex)
        moved[alone[setup].channels] = residues.moved
        parts.append(moved)
    residues = Residues(_joined(row, members, alone, channels), direct, np.concatenate(parts, axis=1))
    mean = Found(
        float(freqs.mean()), float(np.linalg.norm([own, lacking, np.sqrt(unclear)])), zeta, sigma_zeta, residues,
        max(each.signal for each in found), max(each.split_bound for each in found),
    )  # fmt: skip
    reasons = [member.doubt for _, member in some if member.doubt]
    doubt = reasons[0] if len(reasons) == count else ""  # one set-up that shows it clearly is enough
    if 2 * count <= whole:
        seen = f"it is seen in {count} of {whole} set-ups: a local mode, or one that two set-ups share? Measure again"
        doubt = "; ".join(each for each in (seen, doubt) if each)
    spread = float(np.std(np.log(freqs), ddof=1)) if count > 1 else 0.0
    if spread > UNLIKE * shift > 0.0:
        unlike = (
            f"its frequency differs by {100.0 * spread:.2g} % between set-ups, other modes' by {100.0 * shift:.2g} %:"
            " two modes exchanged? Give the sensors' angles, or measure in one set-up"
        )
        doubt = "; ".join(each for each in (unlike, doubt) if each)
    return Track(mean, freqs, doubt)
