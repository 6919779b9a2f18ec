"""A few modes of a cluster alone on the lines about them: what is tried there costs a tenth."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import AROUND, LEAST_LINES
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import fitted
from casingfem.experiment.identify.setups.wave_kinds import NEAR, WaveRead, pairs_near
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem
from casingfem.io.arrays import FloatArray, IntArray


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
