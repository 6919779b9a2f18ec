"""Other readings of two modes near each other: what else their peaks in a set-up may be, fitted.

A fit by steps stays where it is where two modes are exchanged in a set-up, or a weak one has gone to where there is
only noise. So they are put where they may be, with each number of nodal diameters that they may share.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from casingfem.experiment.identify.setups.wave_fit import WaveFit, fitted
from casingfem.experiment.identify.setups.wave_kinds import NEAR, WaveRead, as_one_wave, likely_kinds
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_residues import unlikely_at
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

STEPS = 3, 8  # of a try, at first and then
HOPELESS = 2000.0  # rise of -2 ln of the likelihood after the first, beyond which a try is given up: none came back
WEAK = 0.03  # standard deviation of a mode's ln f in a set-up over its damping ratio, beyond which it is weak there
PLACES = 13  # that a mode is tried at in a set-up
SWEEPS = 2  # over the set-ups, of finding a partner's places


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
