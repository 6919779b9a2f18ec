"""Which wave each mode of a cluster is, and which peak of a set-up is whose: by the likelihood of `wave_fit.py`.

A fit by steps stays where the free residues of a set-up put a peak. So two modes near each other are tried exchanged
in each set-up, or both put where the others have them, with each number of nodal diameters that they may share; what is
more likely is kept. What is nearly as likely says how sure the frequencies are.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.own_shifts import Problem, Setups
from casingfem.experiment.identify.setups.wave_fit import (
    Products,
    Shapes,
    WaveFit,
    WaveProblem,
    Waves,
    fitted,
    solved,
    wave_fit,
)
from casingfem.io.arrays import Array, FloatArray, IntArray

ROUNDS = 3  # of trying
NEAR = 4.0  # usual shifts beyond a bandwidth, within which two modes may be exchanged
GAIN = 2.0  # fall of -2 ln of the likelihood that counts
HOPELESS = 40.0  # rise of it, after a few steps, beyond which a try is given up
STEPS = 3, 8  # of a try, at first and then
GROWN = 10.0  # times its first size, that a mode is taken for at most, or the inverse


class WaveModes(NamedTuple):
    """Frequencies [Hz] (modes, setups), damping, weighted residues (modes, channels); the variances of ln f.

    The standard deviations (modes,) are of the mean ln f, of ln zeta, and of the mean ln f once more, as other readings
    are nearly as likely.
    """

    freq: FloatArray
    zeta: FloatArray
    residues: Array
    variance: FloatArray
    sigma_freq: FloatArray
    sigma_zeta: FloatArray
    sigma_matching: FloatArray


class _Read(NamedTuple):
    shapes: Shapes
    fit: WaveFit


def wave_modes(c: Cluster, setups: Setups, waves: Waves, shift: float) -> WaveModes:
    """The modes of a cluster as waves."""
    weight = c.window.weight * c.window.scale**c.window.power
    problem = WaveProblem(c, Problem.of(c.window, setups), weight, waves, shift)
    size = _rms(c.modes.residues) + 1e-300
    p, q = np.log(c.modes.freq), np.log(c.modes.zeta)
    shapes = _kinds(problem, Shapes(_alone(problem), size), _at(problem, p, q), q)
    read = _Read(shapes, fitted(problem, shapes, p, q))
    others = list[_Read]()
    for _ in range(ROUNDS):
        before, read = read.fit.unlikely, _sized(problem, read, size)
        read, others, moved = _searched(problem, read)
        if not moved and abs(before - read.fit.unlikely) < GAIN:
            break
    return _told(problem, read, others)


def _alone(problem: WaveProblem) -> IntArray:
    """The kind of each mode by its residues alone."""
    waves, residues = problem.waves, problem.cluster.modes.residues.real
    rest = []
    for columns, off in zip(waves.columns[:-1], waves.off[:-1], strict=True):
        Q, scaled = np.linalg.qr(columns / off[:, None])[0], residues / off
        rest.append(np.sum((scaled - (scaled @ Q) @ Q.T) ** 2, axis=1))
    return np.asarray(np.argmin(rest, axis=0))


def _kinds(
    problem: WaveProblem, shapes: Shapes, at: Products, q: FloatArray, pair: tuple[int, int] | None = None
) -> Shapes:
    """Kinds of waves that are more likely at some poles: of single modes, then of neighbours; or of one `pair`."""
    best = solved(problem, shapes, at, q).unlikely
    for which in [pair] if pair else [*((k,) for k in range(len(q))), *_pairs(problem, at.p, q)]:
        for kind in range(len(problem.waves.columns)):
            tried = shapes.kind.copy()
            tried[list(which)] = kind
            if np.any(tried != shapes.kind):
                unlikely = solved(problem, shapes._replace(kind=tried), at, q).unlikely
                if unlikely < best - GAIN:
                    best, shapes = unlikely, shapes._replace(kind=tried)
    return shapes


def _pairs(problem: WaveProblem, p: FloatArray, q: FloatArray) -> list[tuple[int, int]]:
    """Modes so near each other that one may be taken for the other in a set-up."""
    reach = NEAR * problem.shift
    pairs = combinations(range(len(q)), 2)
    return [(a, b) for a, b in pairs if np.abs(p[a] - p[b]).min() < reach + 2.0 * np.exp(q[[a, b]]).max()]


def _sized(problem: WaveProblem, read: _Read, first: FloatArray) -> _Read:
    """Fitted again with the sizes and kinds that modes turn out to have."""
    shapes, fit = read
    means = np.einsum("kcw,kw->kc", problem.waves.columns[shapes.kind], fit.x)
    free = shapes.kind == len(problem.waves.columns) - 1
    size = np.where(free, _rms(fit.residues / problem.weight), _rms(means))
    shapes = shapes._replace(size=np.clip(size, first / GROWN, first * GROWN))
    shapes = _kinds(problem, shapes, _at(problem, fit.p, fit.q), fit.q)
    return _Read(shapes, fitted(problem, shapes, fit.p, fit.q))


def _at(problem: WaveProblem, p: FloatArray, q: FloatArray) -> Products:
    """Inner products at ln f (modes, setups), ln zeta (modes,)."""
    return problem.products(p, np.repeat(q[:, None], p.shape[1], axis=1))


def _rms(parts: Array) -> FloatArray:
    """Over the channels of each mode (modes, channels)."""
    return np.asarray(np.sqrt(np.mean(np.abs(parts) ** 2, axis=1)))


def _searched(problem: WaveProblem, read: _Read) -> tuple[_Read, list[_Read], bool]:
    """The most likely of what can be reached, all else that was tried, and whether it moved."""
    others, moved, count = list[_Read](), False, read.fit.p.shape[1]
    for pair in _pairs(problem, read.fit.p, read.fit.q):
        for s in range(count):
            for p in _starts(read.fit.p, list(pair), s):
                shapes = _kinds(problem, read.shapes, _at(problem, p, read.fit.q), read.fit.q, pair)
                tried = fitted(problem, shapes, p, read.fit.q, STEPS[0])
                if tried.unlikely > read.fit.unlikely + HOPELESS:
                    continue
                other = _Read(shapes, fitted(problem, shapes, tried.p, tried.q, STEPS[1]))
                if other.fit.unlikely < read.fit.unlikely - GAIN:
                    other, read, moved = read, other, True
                others.append(other)
    return read, others, moved


def _starts(p: FloatArray, pair: list[int], s: int) -> Iterator[FloatArray]:
    """Two modes exchanged in a set-up, or both where the other set-ups have them."""
    for own in (p[pair[::-1], s], np.delete(p[pair], s, axis=1).mean(axis=1)):
        start = p.copy()
        start[pair, s] = own
        yield start


def _told(problem: WaveProblem, read: _Read, others: list[_Read]) -> WaveModes:
    """The modes, and how sure they are."""
    fit = wave_fit(problem, read.shapes, read.fit.p, read.fit.q)
    m, count = fit.p.shape
    covariance = fit.covariance(problem.cluster.noise)
    variance = np.maximum(np.diag(covariance), 0.0)
    own = covariance[: m * count, : m * count].reshape(m, count, m, count)
    mean = np.array([max(float(own[k, :, k, :].sum()), 0.0) for k in range(m)]) / count**2
    moved = np.zeros(m)
    for other in others:
        odds = 1.0 / (1.0 + np.exp(np.clip(0.5 * (other.fit.unlikely - fit.unlikely), 0.0, 50.0)))
        moved = np.maximum(moved, odds * (other.fit.p.mean(axis=1) - fit.p.mean(axis=1)) ** 2)
    return WaveModes(
        np.exp(fit.p),
        np.exp(fit.q),
        fit.residues,
        variance[: m * count].reshape(m, count),
        np.sqrt(mean),
        np.sqrt(variance[m * count :]),
        np.sqrt(moved),
    )
