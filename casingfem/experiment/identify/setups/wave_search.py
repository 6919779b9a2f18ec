"""Which peak of a set-up is whose, and whether all modes are found: by the likelihood of `wave_fit.py`.

A fit by steps stays where the free residues of a set-up put a peak. So other readings of two modes near each other are
tried (`wave_tries.py`), on the lines about them and without the others; then one more mode is tried.
What is more likely is kept. What is nearly as likely says how sure the frequencies are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Setups
from casingfem.experiment.identify.setups.wave_fit import (
    GAIN,
    WaveRead,
    fitted,
    kinds_alone,
    likely_kinds,
    pairs_near,
    rms,
    sized,
    wave_fit,
)
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem, Waves
from casingfem.experiment.identify.setups.wave_tries import one_more, part_about, tries, weak
from casingfem.io.arrays import Array, FloatArray, IntArray

ROUNDS = 3  # of trying
MAY_BE = 0.05  # odds of a reading that may well be
SAME = 1e-5  # of ln f, within which two readings are one
MORE = 2  # modes that a cluster may be found to have beyond those of free residues


class WaveModes(NamedTuple):
    """Frequencies [Hz] (modes, setups), damping, weighted residues (modes, channels); the variances of ln f.

    `mean_freq` (modes,) is that over the set-ups, and over other readings by how likely they are. The standard
    deviations (modes,) are of its ln, of ln zeta, and of its ln once more, by those readings, of which one that may
    well be is as far as `rival` (modes,) away; `worth` what each of the last modes, found here, takes from -2 ln of the
    likelihood over what it must.
    """

    freq: FloatArray
    zeta: FloatArray
    residues: Array
    variance: FloatArray
    mean_freq: FloatArray
    sigma_freq: FloatArray
    sigma_zeta: FloatArray
    sigma_matching: FloatArray
    rival: FloatArray
    worth: FloatArray


def wave_modes(setups: Setups, waves: Waves, shift: float, c: Cluster) -> WaveModes:
    """The modes of a cluster as waves, those found beyond its own last."""
    weight = c.window.weight * c.window.scale**c.window.power
    problem = WaveProblem(c, Problem.of(c.window, setups), weight, waves, shift)
    size, worth = rms(c.modes.residues) + 1e-300, list[float]()
    p, q = np.log(c.modes.freq), np.log(c.modes.zeta)
    shapes = likely_kinds(problem, Shapes(kinds_alone(problem), size), problem.products(p, q), q)
    read, tried = _settled(problem, WaveRead(shapes, fitted(problem, shapes, p, q)), size, set(range(len(q))))
    for _ in range(MORE):
        more = one_more(problem, read)
        if more is None:
            break
        problem, size, worth = more.problem, np.append(size, more.read.shapes.size[-1]), [*worth, more.worth]
        read, new = _settled(problem, more.read, size, _near_last(problem, more.read))
        tried |= new
    if worth:  # skirts that nobody knew of may have said what weak modes are
        read, new = _settled(problem, read, size, set(np.flatnonzero(weak(problem, read).any(axis=1)).tolist()))
        tried |= new
    others = [other for each in tried.values() for other in each]
    return _told(problem, read, others)._replace(worth=np.array(worth))


class _Other(NamedTuple):
    """Another reading of `some` modes: how much less likely, -2 ln, and how far their mean ln f is from the best's."""

    rise: float
    some: IntArray
    moved: FloatArray

    @classmethod
    def of(cls, read: WaveRead, best: WaveRead, some: IntArray) -> _Other:
        """Of some modes, beside their best reading."""
        moved = read.fit.p.mean(axis=1) - best.fit.p.mean(axis=1)
        return cls(read.fit.unlikely - best.fit.unlikely, some, np.asarray(moved))


_Tried = dict[tuple[int, ...], list[_Other]]  # of each pair, and each mode


def _near_last(problem: WaveProblem, read: WaveRead) -> set[int]:
    """The last mode and those near it: what was tried with the others is as likely as before."""
    last = len(read.fit.q) - 1
    return {last}.union(*(pair for pair in pairs_near(problem, read.fit.p, read.fit.q) if last in pair))


def _settled(problem: WaveProblem, read: WaveRead, size: FloatArray, among: set[int]) -> tuple[WaveRead, _Tried]:
    """The most likely of what other readings of some modes lead to, and what else was tried last.

    `size` (modes,) as first seen. What was tried with modes beside which nothing has moved since is as likely as then.
    """
    tried = _Tried()
    for _ in range(ROUNDS):
        read, new, among = _searched(problem, _resized(problem, read, size), among)
        tried |= new
        if not among:
            break
    return read, tried


def _resized(problem: WaveProblem, read: WaveRead, size: FloatArray) -> WaveRead:
    """With sizes and kinds of its modes that lead to each other: a search costs more than to have them first."""
    for _ in range(ROUNDS):
        before, read = read.fit.unlikely, sized(problem, read, size)
        if abs(before - read.fit.unlikely) < GAIN:
            break
    return read


def _searched(problem: WaveProblem, read: WaveRead, among: set[int]) -> tuple[WaveRead, _Tried, set[int]]:
    """The most likely of what can be reached, all else that was tried with each pair and mode, and which moved."""
    tried, changed = _Tried(), set[int]()
    pairs = pairs_near(problem, read.fit.p, read.fit.q)
    for which in [*pairs, *((k,) for k in range(len(read.fit.q)))]:
        if among.isdisjoint(which):
            continue
        part = part_about(problem, read, which)
        known = [part.read, *tries(part.problem, part.read, np.searchsorted(part.some, which))]
        best = min(known, key=lambda one: one.fit.unlikely)
        if best.fit.unlikely < part.read.fit.unlikely - GAIN:
            new = part.put_into(problem, read, best)
            if new.fit.unlikely < read.fit.unlikely - GAIN:
                read, changed = new, changed.union(part.some.tolist())
            else:  # beside the others it is not
                known, best = [one for one in known if one is not best], part.read
        tried[which] = [_Other.of(one, best, part.some) for one in known if one is not best]
    return read, tried, changed


def _told(problem: WaveProblem, read: WaveRead, others: list[_Other]) -> WaveModes:
    """The modes, and how sure they are."""
    fit = wave_fit(problem, read.shapes, read.fit.p, read.fit.q)
    m, count = fit.p.shape
    covariance = fit.covariance(problem.cluster.noise)
    variance = np.maximum(np.diag(covariance), 0.0)
    own = covariance[: m * count, : m * count].reshape(m, count, m, count)
    mean = np.array([max(float(own[k, :, k, :].sum()), 0.0) for k in range(m)]) / count**2
    off, scatter, rival = _by_odds(others, m)
    return WaveModes(
        np.exp(fit.p),
        np.exp(fit.q),
        fit.residues,
        variance[: m * count].reshape(m, count),
        np.exp(fit.p.mean(axis=1) + off),
        np.sqrt(mean),
        np.sqrt(variance[m * count :]),
        scatter,
        rival,
        np.zeros(0),
    )


def _by_odds(others: list[_Other], modes: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean and standard deviation of what the best reading's ln f is off, by the odds of all readings, (modes,).

    Then how far from the mean it is in those that may well be.

    Of readings that have each mode in the same place, which several tries lead to, the likeliest counts.
    """
    moved, rise = np.zeros((1, modes)), [0.0]
    for other in sorted(others, key=lambda one: one.rise):
        new = np.zeros(modes)
        new[other.some] = other.moved
        if np.abs(moved - new).max(axis=1).min() > SAME:
            moved, rise = np.vstack([moved, new]), [*rise, other.rise]
    odds = np.exp(-0.5 * np.clip(rise, 0.0, 100.0))
    odds /= odds.sum()
    mean = odds @ moved
    return mean, np.sqrt(odds @ (moved - mean) ** 2), np.abs(moved - mean)[odds > MAY_BE].max(axis=0)
