"""Other readings of two modes near each other: what else their peaks in a set-up may be, fitted.

A fit by steps stays where it is where two modes are exchanged in a set-up, or a weak one has gone to where there is
only noise. So they are put where they may be, with each number of nodal diameters that they may share, alone with the
modes near them on the lines about: what is tried there costs a tenth.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import AROUND, LEAST_LINES
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import (
    NEAR,
    WaveFit,
    WaveRead,
    as_one_wave,
    fitted,
    likely_kinds,
    pairs_near,
)
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_residues import unlikely_at
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

STEPS = 3, 8  # of a try, at first and then
HOPELESS = 2000.0  # rise of -2 ln of the likelihood after the first, beyond which a try is given up: none came back
WEAK = 0.03  # standard deviation of a mode's ln f in a set-up over its damping ratio, beyond which it is weak there
PLACES = 13  # that a mode is tried at in a set-up
SWEEPS = 2  # over the set-ups, of finding a partner's places


class Part(NamedTuple):
    """The modes `some` of a cluster without the others, which stay as they are, and the fit there."""

    some: IntArray
    problem: WaveProblem
    read: WaveRead

    def put_into(self, problem: WaveProblem, read: WaveRead, own: WaveRead) -> WaveRead:
        """The cluster fitted with what was found for its part."""
        p, q, kind = read.fit.p.copy(), read.fit.q.copy(), read.shapes.kind.copy()
        p[self.some], q[self.some], kind[self.some] = own.fit.p, own.fit.q, own.shapes.kind
        shapes = read.shapes._replace(kind=kind)
        return WaveRead(shapes, fitted(problem, shapes, p, q))


def part_about(problem: WaveProblem, read: WaveRead, which: tuple[int, ...]) -> Part:
    """A mode or two, those near them, and the lines about."""
    fit, kept = read.fit, set(which)
    for near in pairs_near(problem, fit.p, fit.q):
        kept |= set() if set(which).isdisjoint(near) else set(near)
    some = np.array(sorted(kept))
    modes = Modes(np.exp(fit.p), np.exp(fit.q), fit.residues / problem.weight)
    window = problem.cluster.window.cut(_lines_about(problem, modes.some(some)))
    others = modes.some(np.setdiff1d(np.arange(len(fit.q)), some))
    left = window.as_complex - others.response(window, problem.data.setups)
    window = replace(window, Y=np.concatenate([left.real, left.imag]))
    cluster = problem.cluster._replace(window=window, modes=modes.some(some))
    weight = window.weight * window.scale**window.power
    own = problem._replace(cluster=cluster, data=Problem.of(window, problem.data.setups), weight=weight)
    shapes = Shapes(read.shapes.kind[some], read.shapes.size[some])
    return Part(some, own, WaveRead(shapes, fitted(own, shapes, fit.p[some], fit.q[some])))


def _lines_about(problem: WaveProblem, modes: Modes) -> slice:
    """As many lines beside some modes as beside a cluster."""
    freq: FloatArray = problem.cluster.window.freq
    beyond = AROUND * float(modes.zeta.max()) + NEAR * problem.shift
    a, b = np.searchsorted(freq, [modes.freq.min() * (1.0 - beyond), modes.freq.max() * (1.0 + beyond)]).tolist()
    a = max(min(a, b - LEAST_LINES, len(freq) - LEAST_LINES), 0)
    return slice(a, max(b, a + LEAST_LINES))


def tries(problem: WaveProblem, read: WaveRead, which: IntArray) -> Iterator[WaveRead]:
    """Two modes, or one where it is weak, found elsewhere in a set-up, fitted; a weaker one as the other's partner.

    Free shapes follow any exchange: where they are likelier before the poles are fitted, waves are tried too.
    """
    starts, alone = list[tuple[Shapes, FloatArray]](), len(which) == 1
    for s in np.flatnonzero(weak(problem, read)[which[0]]).tolist() if alone else range(read.fit.p.shape[1]):
        for p in _moved(problem, read, int(which[0]), s) if alone else _exchanged(read.fit.p, which, s):
            at = problem.products(p, read.fit.q)
            starts.append((likely_kinds(problem, read.shapes, at, read.fit.q, which), p))
            if not problem.waves.is_wave[starts[-1][0].kind[which]].all():
                starts.append((as_one_wave(problem, starts[-1][0], at, which), p))
    if not alone:
        starts += _partners(problem, read, which)
    for shapes, p in starts:
        tried = fitted(problem, shapes, p, read.fit.q, STEPS[0])
        if tried.unlikely < read.fit.unlikely + HOPELESS:
            yield WaveRead(shapes, fitted(problem, shapes, tried.p, tried.q, STEPS[1]))


def weak(problem: WaveProblem, read: WaveRead) -> BoolArray:
    """Which modes have a frequency in a set-up that is known to a part of their width alone, (modes, setups)."""
    p, q = read.fit.p, read.fit.q
    variance = np.diag(read.fit.covariance(problem.cluster.noise))[: p.size].reshape(p.shape)
    return np.asarray(variance > (WEAK * np.exp(q[:, None])) ** 2)


def _exchanged(p: FloatArray, pair: IntArray, s: int) -> Iterator[FloatArray]:
    """Two modes exchanged in a set-up, or both where the other set-ups have them."""
    for own in (p[pair[::-1], s], np.delete(p[pair], s, axis=1).mean(axis=1)):
        start = p.copy()
        start[pair, s] = own
        yield start


def _moved(problem: WaveProblem, read: WaveRead, mode: int, s: int) -> Iterator[FloatArray]:
    """One mode of a set-up in the likeliest valley but that where it is, where there is another."""
    starts, unlikely = _along(problem, read.shapes, read.fit, mode, s)
    beside = np.pad(unlikely, 1, constant_values=np.inf)
    valleys = np.flatnonzero((unlikely <= beside[:-2]) & (unlikely <= beside[2:]))
    others = np.delete(valleys, np.abs(starts[valleys, mode, s] - read.fit.p[mode, s]).argmin())
    if len(others):
        yield starts[others[unlikely[others].argmin()]]


def _partners(problem: WaveProblem, read: WaveRead, pair: IntArray) -> Iterator[tuple[Shapes, FloatArray]]:
    """The weaker of two modes of other kinds as one of the stronger's, in each set-up where it is then likeliest.

    Waves round a circle come in pairs; what a weak one is said to be its noise may have said.
    """
    weaker, stronger = pair[np.argsort(read.shapes.size[pair])].tolist()
    shapes, fit, kind = read.shapes, read.fit, read.shapes.kind.copy()
    if (
        kind[weaker] == kind[stronger]
        or not problem.waves.is_wave[kind[stronger]]
        or not weak(problem, read)[weaker].any()
    ):
        return
    kind[weaker] = kind[stronger]
    shapes = shapes._replace(kind=kind)
    for _ in range(SWEEPS):
        for s in range(fit.p.shape[1]):
            starts, unlikely = _along(problem, shapes, fit, weaker, s)
            fit = fit._replace(p=starts[unlikely.argmin()])
    yield shapes, fit.p


def _along(problem: WaveProblem, shapes: Shapes, fit: WaveFit, mode: int, s: int) -> tuple[FloatArray, FloatArray]:
    """Starts with a mode of a set-up at places about where the others have it, and -2 ln of the likelihood there."""
    starts = np.repeat(fit.p[None], PLACES, axis=0)
    starts[:, mode, s] = np.delete(fit.p[mode], s).mean() + NEAR * problem.shift * np.linspace(-1.0, 1.0, PLACES)
    return starts, np.array([unlikely_at(problem, shapes, problem.products(start, fit.q)) for start in starts])
