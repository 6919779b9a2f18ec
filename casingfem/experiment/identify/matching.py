"""Match the modes of several set-ups: a joint assignment by frequency, damping and shape.

Mode k of set-up s has ln f = mu_k + c_s + e. The shift c_s, a straight line over ln f, is common to the modes of the
set-up (a mass, the temperature); e scatters from mode to mode. The negative log-likelihood of the members of one mode
is half the sum of

    (ln f - c_s - mean)^2/(tau^2 + sigma^2),   (ln zeta - mean)^2/(tau_z^2 + sigma_z^2),   N ln(1 + chi^2/N),

chi^2 the distance of N residues from one shape (`shared_shape`). The scatters come from the test itself. The sum over
all modes is minimised: the Hungarian algorithm assigns one set-up after the other anew until nothing changes, starting
once from each set-up. If shapes contribute nothing, the frequency term keeps the modes in order. A roving mass may
shift one mode far more than the others; the frequency term then splits it over two rows. Two neighbouring rows that no
set-up shows together are merged if no other mode is near and if damping and shape agree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from casingfem.experiment.identify.shared_shape import Member, Shapes
from casingfem.io.arrays import BoolArray, FloatArray

WIDEST = 0.02  # relative difference, without the common shift, beyond which two modes are not one
REACH = 5.0  # standard deviations of the scatter within which two modes may be one
RESOLUTION = 1.5e-3  # of ln f, at which a first common shift is searched
LACKING = 6.0  # log-likelihood that a set-up without the mode costs
DAMPING = 0.2  # scatter of ln zeta before it is estimated, and at most
LEAST = 1e-7, 0.005  # scatter of ln f and of ln zeta
FEW = 6  # modes from which on a common shift has a slope
ROUNDS, SWEEPS, STEPS = 3, 8, 12
ASIDE = 2.0  # bandwidths within which two rows may be one; times their distance to the nearest other row
Row = tuple[int, ...]  # of each set-up the number of its member, -1 where it lacks the mode


class Shifts(NamedTuple):
    """Common shifts c_s = line[0] + line[1] (x - centre) of ln f at x, of sum zero: `lines` (set-ups, 2)."""

    centre: float
    lines: FloatArray

    def at(self, setup: int, x: FloatArray) -> FloatArray:
        """The shift of a set-up at some ln f."""
        return np.asarray(self.lines[setup, 0] + self.lines[setup, 1] * (x - self.centre))


class Matching(NamedTuple):
    """Modes matched over set-ups, ascending.

    A row has the members of a mode, one a set-up. `middle` is the mean of their ln f without the common shifts. The
    `unclear` part of its variance comes from close modes that may be exchanged in a set-up.
    """

    rows: list[Row]
    middle: FloatArray
    shifts: Shifts
    scatter: float
    unclear: list[float]


class _Likelihood(NamedTuple):
    """Parameters of the likelihood, and of the members of each set-up ln f, ln zeta and their deviations."""

    freq: list[FloatArray]
    sigma: list[FloatArray]
    damp: list[FloatArray]
    sigma_damp: list[FloatArray]
    shifts: Shifts
    common: list[FloatArray]
    tau: float
    tau_damp: float
    shapes: Shapes
    by_shape: bool = False

    def cost(self, row: Row, placed: bool = True) -> float:
        """Negative log-likelihood of a row; without the frequency term if it is not `placed`."""
        some = [(s, k) for s, k in enumerate(row) if k >= 0]
        total = LACKING * (len(row) - len(some))
        if len(some) < 2:
            return total
        own = np.array([self.freq[s][k] - self.common[s][k] for s, k in some])
        if placed:
            total += 0.5 * _scatter(own, np.array([self.tau**2 + self.sigma[s][k] ** 2 for s, k in some]))
        damp = np.array([self.damp[s][k] for s, k in some])
        by_damp = _scatter(damp, np.array([self.tau_damp**2 + self.sigma_damp[s][k] ** 2 for s, k in some]))
        count = float(len(some))
        total += 0.5 * count * float(np.log1p(by_damp / count))
        return total + (self.shapes.cost(row) if self.by_shape else 0.0)

    def near(self, rows: list[Row], setup: int) -> BoolArray:
        """Whether the members of a set-up (columns) are within reach of all members of each row (rows)."""
        moved = [(freq - shift).tolist() for freq, shift in zip(self.freq, self.common, strict=True)]
        there = [[moved[s][k] for s, k in enumerate(row) if k >= 0] for row in rows]
        low, high = (np.array([f(each) for each in there])[:, None] for f in (min, max))
        reach = min(WIDEST, 1.5 * REACH * self.tau)
        return np.asarray((high - moved[setup] < reach) & (np.array(moved[setup]) - low < reach))


def matching(members: list[list[Member]], shapes: Shapes) -> Matching:
    """Assign the modes of all set-ups jointly, in ascending order."""
    at = _first(members, shapes)
    rows: list[Row] = []
    for _ in range(ROUNDS):
        rows = _assigned(at)
        at = _learned(at, rows)
    rows = _joined(at, sorted(rows, key=lambda row: _mean(at, row)))
    middle = np.array([_mean(at, row) for row in rows])
    return Matching(rows, middle, at.shifts, at.tau, _unclear(at, rows))


def _joined(at: _Likelihood, rows: list[Row]) -> list[Row]:
    """Merge rows (ascending) that are one mode seen by different set-ups."""
    middle = [-np.inf, *(_mean(at, row) for row in rows), np.inf, np.inf]
    done, k = list[Row](), 0
    while k < len(rows):
        below, own, above, beyond = middle[k : k + 4]
        alone = ASIDE * (above - own) < min(own - below, beyond - above)
        two = alone and _is_one(at, rows[k], rows[k + 1], above - own)
        done.append(tuple(map(max, rows[k], rows[k + 1])) if two else rows[k])
        k += 1 + two
    return done


def _is_one(at: _Likelihood, one: Row, two: Row, gap: float) -> bool:
    """Whether two rows with this gap of ln f may be one mode: no set-up shows both, damping and shape agree."""
    if any(min(each) >= 0 for each in zip(one, two, strict=True)):
        return False
    both = tuple(map(max, one, two))
    zeta = float(np.exp(np.mean([at.damp[s][k] for s, k in enumerate(both) if k >= 0])))
    near = gap < min(WIDEST, ASIDE * 2.0 * zeta)
    return near and at.cost(both, placed=False) < at.cost(one, placed=False) + at.cost(two, placed=False)


def _first(members: list[list[Member]], shapes: Shapes) -> _Likelihood:
    """Parameters of the likelihood before the first assignment."""
    found = [[member.found for member in part] for part in members]
    freq = [np.log([each.freq for each in part]) for part in found]
    damp = [np.log([each.zeta for each in part]) for part in found]
    most = int(np.argmax([len(part) for part in freq]))
    common, gaps = [], list[FloatArray]()
    for own, own_damp in zip(freq, damp, strict=True):
        gap = own[:, None] - freq[most]
        like = np.exp(-0.5 * ((own_damp[:, None] - damp[most]) / DAMPING) ** 2)[np.abs(gap) < WIDEST]
        tried = np.arange(-WIDEST, WIDEST, 0.25 * RESOLUTION)
        score = np.exp(-0.5 * ((tried[:, None] - gap[np.abs(gap) < WIDEST]) / RESOLUTION) ** 2) @ like
        shift = float(tried[np.argmax(score * np.exp(-0.5 * (tried / WIDEST) ** 2))]) if own is not freq[most] else 0.0
        common.append(np.full(len(own), shift))
        if own is not freq[most] and len(own):
            gaps.append(np.abs(gap - shift).min(axis=1))
    tau = 1.5 * float(np.median(np.concatenate(gaps))) if gaps else 0.0
    sigma = [np.array([each.sigma_freq / each.freq for each in part]) for part in found]
    sigma_damp = [np.array([each.sigma_zeta / each.zeta for each in part]) for part in found]
    shifts = Shifts(0.0, np.zeros((len(freq), 2)))
    return _Likelihood(freq, sigma, damp, sigma_damp, shifts, common, max(tau, LEAST[0]), DAMPING, shapes)


def _learned(at: _Likelihood, rows: list[Row]) -> _Likelihood:
    """Estimate common shifts, scatters and channel weights from an assignment."""
    several = [row for row in rows if sum(k >= 0 for k in row) > 1]
    if not several:
        return at
    middle = np.array([_mean(at, row) for row in several])
    lines = np.zeros((len(at.freq), 2))
    for s, freq in enumerate(at.freq):
        there = np.array([row[s] >= 0 for row in several])
        off = freq[[row[s] for row in several if row[s] >= 0]] - middle[there]
        lines[s] = _line(middle[there] - middle.mean(), off) if there.any() else 0.0
    shifts = Shifts(float(middle.mean()), lines - lines.mean(axis=0))  # a shift common to all set-ups is none
    common = [shifts.at(s, freq) for s, freq in enumerate(at.freq)]
    at = at._replace(shifts=shifts, common=common)
    own = [np.array([at.freq[s][k] - common[s][k] for s, k in enumerate(row) if k >= 0]) for row in several]
    damp = [np.array([at.damp[s][k] for s, k in enumerate(row) if k >= 0]) for row in several]
    tau, tau_damp = (
        float(np.sqrt(np.median([np.var(each, ddof=1) for each in values]) / 0.6)) for values in (own, damp)
    )  # the median of chi-squared of one or two degrees of freedom over its mean is 0.45 or 0.69
    tau, tau_damp = max(tau, LEAST[0]), min(max(tau_damp, LEAST[1]), DAMPING)
    return at._replace(tau=tau, tau_damp=tau_damp, shapes=at.shapes.learned(rows), by_shape=True)


def _line(x: FloatArray, off: FloatArray) -> FloatArray:
    """Fit a line by least absolute deviations: constant and slope; the slope is zero if points are few."""
    columns = np.column_stack([np.ones(len(x)), x])[:, : 2 if len(x) >= FEW else 1]
    weight, fitted = np.ones(len(x)), np.zeros(2)
    for _ in range(STEPS):
        root = np.sqrt(weight)[:, None]
        fitted = np.linalg.lstsq(root * columns, root[:, 0] * off, rcond=None)[0]
        rest = np.abs(off - columns @ fitted)
        weight = 1.0 / (rest + 0.1 * np.median(rest) + 1e-12)
    return np.pad(fitted, (0, 2 - len(fitted)))


def _assigned(at: _Likelihood) -> list[Row]:
    """Rows of least cost: start from each set-up in turn, then reassign the others until nothing changes."""
    known: dict[Row, float] = {}

    def cost(row: Row) -> float:
        if row not in known:
            known[row] = at.cost(row)
        return known[row]

    count, best, least = len(at.freq), list[Row](), np.inf
    for first in range(count):
        rows = [tuple(k if s == first else -1 for s in range(count)) for k in range(len(at.freq[first]))]
        total = np.inf
        for sweep in range(SWEEPS):
            order = np.roll(np.arange(count), -first).tolist()
            for setup in order[1:] if sweep == 0 else order:
                rows = _reassigned(at, rows, setup, cost)
            new = sum(cost(row) for row in rows)
            if new >= total - 1e-9:
                break
            total = new
        if total < least:
            best, least = rows, total
    return best


def _reassigned(at: _Likelihood, rows: list[Row], setup: int, cost: Callable[[Row], float]) -> list[Row]:
    """Assign the members of one set-up anew; keep the others."""
    left = [_with(row, setup, -1) for row in rows]
    left = [row for row in left if max(row) >= 0]
    own, nothing = len(at.freq[setup]), tuple([-1] * len(at.freq))
    rise = np.full((len(left) + own, own + len(left)), 1e9)
    rise[np.arange(len(left)), own + np.arange(len(left))] = 0.0
    for t, k in np.argwhere(at.near(left, setup)).tolist() if left else []:
        rise[t, k] = cost(_with(left[t], setup, k)) - cost(left[t])
    for k in range(own):
        rise[len(left) + k, k] = cost(_with(nothing, setup, k))
    rise[len(left) :, own:] = 0.0
    taken = dict(zip(*(each.tolist() for each in linear_sum_assignment(rise)), strict=True))
    done = [_with(row, setup, taken[t]) if taken[t] < own else row for t, row in enumerate(left)]
    return done + [_with(nothing, setup, taken[t]) for t in range(len(left), len(left) + own) if taken[t] < own]


def _with(row: Row, setup: int, member: int) -> Row:
    return (*row[:setup], member, *row[setup + 1 :])


def _mean(at: _Likelihood, row: Row) -> float:
    return float(np.mean([at.freq[s][k] - at.common[s][k] for s, k in enumerate(row) if k >= 0]))


def _exchanges(at: _Likelihood, rows: list[Row]) -> Iterator[tuple[int, int, int, float]]:
    """Pairs of rows (ascending) and the set-up whose members may be exchanged, with the increase of the cost."""
    middle, own = [_mean(at, row) for row in rows], [at.cost(row) for row in rows]
    reach = min(WIDEST, 2.0 * REACH * at.tau)
    for i, one in enumerate(rows):
        for j in range(i + 1, int(np.searchsorted(middle, middle[i] + reach))):
            for s in range(len(one)):
                if one[s] >= 0 and rows[j][s] >= 0:
                    rise = at.cost(_with(one, s, rows[j][s])) + at.cost(_with(rows[j], s, one[s])) - own[i] - own[j]
                    yield i, j, s, rise


def _unclear(at: _Likelihood, rows: list[Row]) -> list[float]:
    variance = [0.0] * len(rows)
    for i, j, s, rise in _exchanges(at, rows):
        chance = 1.0 / (1.0 + float(np.exp(min(max(rise, 0.0), 50.0))))
        gap = at.freq[s][rows[i][s]] - at.freq[s][rows[j][s]]
        for k in (i, j):
            variance[k] += chance * (1.0 - chance) * (gap / sum(each >= 0 for each in rows[k])) ** 2
    return variance


def _scatter(values: FloatArray, variance: FloatArray) -> float:
    """Chi-squared of values about their weighted mean."""
    weight = 1.0 / variance
    return float(weight @ (values - weight @ values / weight.sum()) ** 2)
