"""Which wave each mode of a cluster is, at poles that are known: the kinds, and sizes, that are most likely."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.wave_fit import WaveFit, fitted
from casingfem.experiment.identify.setups.wave_model import Products, Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_odds import unlikely_kinds
from casingfem.experiment.identify.setups.wave_residues import eliminated, unlikely_at
from casingfem.io.arrays import Array, FloatArray, IntArray

NEAR = 4.0  # usual shifts beyond a bandwidth, within which two modes may be exchanged
GAIN = 2.0  # fall of -2 ln of the likelihood that counts
GROWN = 10.0  # times its first size, that a mode is taken for at most, or the inverse


class WaveRead(NamedTuple):
    """Kinds and sizes of the modes of a cluster, and the fit with them."""

    shapes: Shapes
    fit: WaveFit


def kinds_alone(problem: WaveProblem) -> IntArray:
    """The kind of each mode by its residues alone."""
    waves, residues = problem.waves, problem.cluster.modes.residues.real
    rest = []
    for kind in np.flatnonzero(waves.is_wave):
        Q, scaled = np.linalg.qr(waves.columns[kind] / waves.off[kind][:, None])[0], residues / waves.off[kind]
        rest.append(np.sum((scaled - (scaled @ Q) @ Q.T) ** 2, axis=1))
    return np.asarray(np.flatnonzero(waves.is_wave)[np.argmin(rest, axis=0)])


def likely_kinds(
    problem: WaveProblem, shapes: Shapes, at: Products, q: FloatArray, some: IntArray | None = None
) -> Shapes:
    """Kinds of waves that are more likely at some poles: of single modes, then of neighbours; or of `some` alone."""
    rest = eliminated(problem, shapes, at)
    best = unlikely_at(problem, shapes, at, rest)
    every = [*((k,) for k in range(len(q))), *pairs_near(problem, at.p, q)] if some is None else [some]
    for which in (np.array(each) for each in every):
        unlikely = unlikely_kinds(problem, shapes, at, rest, which)
        if unlikely.min() < best - GAIN:
            best, kind = float(unlikely.min()), shapes.kind.copy()
            kind[which] = unlikely.argmin()
            shapes = shapes._replace(kind=kind)
            rest = eliminated(problem, shapes, at)
    return shapes


def as_one_wave(problem: WaveProblem, shapes: Shapes, at: Products, some: IntArray) -> Shapes:
    """Some modes as waves of one kind, the likeliest at some poles."""
    unlikely = unlikely_kinds(problem, shapes, at, eliminated(problem, shapes, at), some)
    kind = shapes.kind.copy()
    kind[some] = np.where(problem.waves.is_wave, unlikely, np.inf).argmin()
    return shapes._replace(kind=kind)


def pairs_near(problem: WaveProblem, p: FloatArray, q: FloatArray) -> list[tuple[int, int]]:
    """Modes so near each other that one may be taken for the other in a set-up."""
    reach = NEAR * problem.shift
    pairs = combinations(range(len(q)), 2)
    return [(a, b) for a, b in pairs if np.abs(p[a] - p[b]).min() < reach + 2.0 * np.exp(q[[a, b]]).max()]


def sized(problem: WaveProblem, read: WaveRead, first: FloatArray) -> WaveRead:
    """Fitted again with the sizes and kinds that modes turn out to have."""
    shapes, fit = read
    means = np.einsum("kcw,kw->kc", problem.waves.columns[shapes.kind], fit.x)
    size = np.where(problem.waves.is_wave[shapes.kind], rms(means), rms(fit.residues / problem.weight))
    shapes = shapes._replace(size=np.clip(size, first / GROWN, first * GROWN))
    shapes = likely_kinds(problem, shapes, problem.products(fit.p, fit.q), fit.q)
    return WaveRead(shapes, fitted(problem, shapes, fit.p, fit.q))


def rms(parts: Array) -> FloatArray:
    """Over the channels of each mode (modes, channels)."""
    return np.asarray(np.sqrt(np.mean(np.abs(parts) ** 2, axis=1)))
