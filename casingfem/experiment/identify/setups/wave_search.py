"""Which peak of a set-up is whose, and whether all modes are found: by the likelihood of `wave_fit.py`.

A fit by steps stays where the free residues of a set-up put a peak. So two modes near each other are tried exchanged
in each set-up, or both put where the others have them, with each number of nodal diameters that they may share; then
one more mode is tried. What is more likely is kept. What is nearly as likely says how sure the frequencies are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Setups
from casingfem.experiment.identify.setups.wave_fit import fitted, wave_fit
from casingfem.experiment.identify.setups.wave_kinds import (
    GAIN,
    WaveRead,
    as_one_wave,
    kinds_alone,
    likely_kinds,
    pairs_near,
    rms,
    sized,
)
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem, Waves
from casingfem.experiment.identify.setups.wave_more import one_more
from casingfem.io.arrays import Array, FloatArray, IntArray

ROUNDS = 3  # of trying
MORE = 2  # modes that a cluster may be found to have beyond those of free residues
HOPELESS = 200.0, 40.0  # rise of it, after a step and after a few, beyond which a try is given up
STEPS = 3, 8  # of a try, at first and then


class WaveModes(NamedTuple):
    """Frequencies [Hz] (modes, setups), damping, weighted residues (modes, channels); the variances of ln f.

    The standard deviations (modes,) are of the mean ln f, of ln zeta, and of the mean ln f once more, as other readings
    are nearly as likely; `worth` what each of the last modes, found here, takes from -2 ln of the likelihood over what
    it must.
    """

    freq: FloatArray
    zeta: FloatArray
    residues: Array
    variance: FloatArray
    sigma_freq: FloatArray
    sigma_zeta: FloatArray
    sigma_matching: FloatArray
    worth: FloatArray


def wave_modes(setups: Setups, waves: Waves, shift: float, c: Cluster) -> WaveModes:
    """The modes of a cluster as waves, those found beyond its own last."""
    weight = c.window.weight * c.window.scale**c.window.power
    problem = WaveProblem(c, Problem.of(c.window, setups), weight, waves, shift)
    size, worth = rms(c.modes.residues) + 1e-300, list[float]()
    p, q = np.log(c.modes.freq), np.log(c.modes.zeta)
    shapes = likely_kinds(problem, Shapes(kinds_alone(problem), size), problem.products(p, q), q)
    read, others = _settled(problem, WaveRead(shapes, fitted(problem, shapes, p, q)), size, range(len(q)))
    for _ in range(MORE):
        more = one_more(problem, read)
        if more is None:
            break
        problem, size, worth = more.problem, np.append(size, more.read.shapes.size[-1]), [*worth, more.worth]
        read, new = _settled(problem, more.read, size, _near_last(problem, more.read))
        others = [other.beside_more(len(size)) for other in others] + new
    return _told(problem, read, others)._replace(worth=np.array(worth))


class _Other(NamedTuple):
    """Another reading: how much less likely, -2 ln, and where it has the mean ln f of each mode, from the best."""

    rise: float
    moved: FloatArray

    def beside_more(self, modes: int) -> _Other:
        """The same beside further modes, which it leaves where they are."""
        return self._replace(moved=np.pad(self.moved, (0, modes - len(self.moved))))


def _near_last(problem: WaveProblem, read: WaveRead) -> IntArray:
    """The last mode and those near it: what was tried with the others is as likely as before."""
    last = len(read.fit.q) - 1
    return np.unique([last, *(k for pair in pairs_near(problem, read.fit.p, read.fit.q) if last in pair for k in pair)])


def _settled(
    problem: WaveProblem, read: WaveRead, size: FloatArray, among: Iterable[int]
) -> tuple[WaveRead, list[_Other]]:
    """The most likely of what exchanges of some modes lead to, and what else was tried last.

    `size` (modes,) as first seen; one of each pair is `among` some modes.
    """
    others, some = list[WaveRead](), set(among)
    for _ in range(ROUNDS):
        read, others, moved = _searched(problem, _resized(problem, read, size), some)
        if not moved:
            break
    best = read.fit
    return read, [
        _Other(one.fit.unlikely - best.unlikely, one.fit.p.mean(axis=1) - best.p.mean(axis=1)) for one in others
    ]


def _resized(problem: WaveProblem, read: WaveRead, size: FloatArray) -> WaveRead:
    """With sizes and kinds of its modes that lead to each other: a search costs more than to have them first."""
    for _ in range(ROUNDS):
        before, read = read.fit.unlikely, sized(problem, read, size)
        if abs(before - read.fit.unlikely) < GAIN:
            break
    return read


def _searched(problem: WaveProblem, read: WaveRead, among: set[int]) -> tuple[WaveRead, list[WaveRead], bool]:
    """The most likely of what can be reached, all else that was tried, and whether it moved."""
    others, moved = list[WaveRead](), False
    for pair in pairs_near(problem, read.fit.p, read.fit.q):
        if among.isdisjoint(pair):
            continue
        tried = list(_exchanged(problem, read, pair))
        best = min(tried, key=lambda one: one.fit.unlikely, default=read)
        if best.fit.unlikely < read.fit.unlikely - GAIN:
            tried = [read if one is best else one for one in tried]
            read, moved = best, True
        others += tried
    return read, others, moved


def _exchanged(problem: WaveProblem, read: WaveRead, pair: tuple[int, int]) -> Iterator[WaveRead]:
    """Two modes found elsewhere in one set-up, fitted.

    Free shapes follow any exchange: where they are likelier before the poles are fitted, waves are tried too.
    """
    for s in range(read.fit.p.shape[1]):
        for p in _starts(read.fit.p, list(pair), s):
            at = problem.products(p, read.fit.q)
            kinds = [likely_kinds(problem, read.shapes, at, read.fit.q, pair)]
            if not problem.waves.is_wave[kinds[0].kind[list(pair)]].all():
                kinds.append(as_one_wave(problem, kinds[0], at, pair))
            for shapes in kinds:
                tried = fitted(problem, shapes, p, read.fit.q, STEPS[0], read.fit.unlikely + HOPELESS[0])
                if tried.unlikely < read.fit.unlikely + HOPELESS[1]:
                    yield WaveRead(shapes, fitted(problem, shapes, tried.p, tried.q, STEPS[1]))


def _starts(p: FloatArray, pair: list[int], s: int) -> Iterator[FloatArray]:
    """Two modes exchanged in a set-up, or both where the other set-ups have them."""
    for own in (p[pair[::-1], s], np.delete(p[pair], s, axis=1).mean(axis=1)):
        start = p.copy()
        start[pair, s] = own
        yield start


def _told(problem: WaveProblem, read: WaveRead, others: list[_Other]) -> WaveModes:
    """The modes, and how sure they are."""
    fit = wave_fit(problem, read.shapes, read.fit.p, read.fit.q)
    m, count = fit.p.shape
    covariance = fit.covariance(problem.cluster.noise)
    variance = np.maximum(np.diag(covariance), 0.0)
    own = covariance[: m * count, : m * count].reshape(m, count, m, count)
    mean = np.array([max(float(own[k, :, k, :].sum()), 0.0) for k in range(m)]) / count**2
    moved = np.zeros(m)
    for other in others:
        odds = 1.0 / (1.0 + np.exp(np.clip(0.5 * other.rise, 0.0, 50.0)))
        moved = np.maximum(moved, odds * other.moved**2)
    return WaveModes(
        np.exp(fit.p),
        np.exp(fit.q),
        fit.residues,
        variance[: m * count].reshape(m, count),
        np.sqrt(mean),
        np.sqrt(variance[m * count :]),
        np.sqrt(moved),
        np.zeros(0),
    )
