"""One more mode in a cluster: one that free residues hid, or a local one that moves its neighbours unseen.

With free residues a mode must take from the squares what 2 C numbers cost. As a wave, or seen by few channels, it has
fewer, and the likelihood of `wave_fit.py` holds what residues cost: left are the frequencies of S set-ups and damping,

    price = (S + 1) ln(entries) + 2 C ln 2   of -2 ln of the likelihood,

the last term for any set of channels that see it.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import best_beside
from casingfem.experiment.identify.setups.wave_fit import WaveRead, fitted, pairs_near, rms, sized, solved
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_residues import eliminated, unlikely_kinds, unlikely_local
from casingfem.io.arrays import FloatArray

WIDER = 1.0, 3.0  # times the usual damping, that a further mode is tried with
ASIDE = 0.5  # half-power half-widths from a mode without partner, that its partner is tried at
DAMPED = 5.0  # times that, beyond which it is no peak
LOCAL = 0.5  # share of the channels that see a local mode, at most
STEPS = 8  # of a try
PROMISING, SIZINGS = 2, 2  # tries that are followed further, so many times with sizes and kinds anew


class More(NamedTuple):
    """A cluster with one more mode, the last; what that takes from -2 ln of the likelihood, over the price."""

    problem: WaveProblem
    read: WaveRead
    worth: float


def one_more(problem: WaveProblem, read: WaveRead) -> More | None:
    """The mode that makes a cluster most likely beside those it has; None where none is worth its price.

    The most promising tries are judged when the others, too, have the kinds and sizes that they then have.
    """
    c, fit = problem.cluster, read.fit
    price = (fit.p.shape[1] + 1) * np.log(c.window.Y.size) + 2.0 * len(problem.weight) * np.log(2.0)
    usual = float(np.median(c.modes.zeta))
    tries = list[tuple[WaveProblem, WaveRead]]()
    for start in _starts(problem, read, usual):
        for trying, shapes in _kinds(problem, read, *start):
            tried = fitted(trying, shapes, *start, STEPS)
            if tried.unlikely < fit.unlikely and tried.q[-1] < np.log(DAMPED * usual):
                tries.append((trying, WaveRead(shapes, tried)))
    best: More | None = None
    for trying, tried_read in sorted(tries, key=lambda one: one[1].fit.unlikely)[:PROMISING]:
        for _ in range(SIZINGS):
            tried_read = sized(trying, tried_read, np.append(read.shapes.size, tried_read.shapes.size[-1]))
        more = More(trying, tried_read, float((fit.unlikely - tried_read.fit.unlikely) / price))
        if more.worth > (best.worth if best else 1.0) and tried_read.fit.q[-1] < np.log(DAMPED * usual):
            best = more
    return best


def _starts(problem: WaveProblem, read: WaveRead, usual: float) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Start (ln f, ln zeta) with one more mode where the squares of free residues fall most, or beside a lone one."""
    c, (p, q) = problem.cluster, (read.fit.p, read.fit.q)
    for wider in WIDER:
        at, _ = best_beside(c.window, problem.data.setups, np.exp(p), np.exp(q), wider * usual, c.span)
        yield np.vstack([p, np.full(p.shape[1], np.log(at))]), np.append(q, np.log(wider * usual))
    pairs = pairs_near(problem, p, q)
    for k, kind in enumerate(read.shapes.kind):
        alike = any(k in pair and read.shapes.kind[pair[0]] == read.shapes.kind[pair[1]] for pair in pairs)
        if problem.waves.is_wave[kind] and not alike:  # waves round a circle come in pairs
            for away in (-ASIDE, ASIDE):
                yield np.vstack([p, p[k] + away * np.exp(q[k])]), np.append(q, q[k])


def _kinds(problem: WaveProblem, read: WaveRead, p: FloatArray, q: FloatArray) -> Iterator[tuple[WaveProblem, Shapes]]:
    """The most likely wave, and the most likely set of channels, that the last mode of a start may be."""
    waves, at = problem.waves, problem.products(p, q)
    free = Shapes(np.append(read.shapes.kind, np.flatnonzero(~waves.is_wave)[0]),
                  np.append(read.shapes.size, np.median(read.shapes.size)))  # fmt: skip
    residues = solved(problem, free, at, q).residues[-1:] / problem.weight
    shapes = free._replace(size=np.append(read.shapes.size, rms(residues)))
    unlikely = unlikely_kinds(problem, shapes, at, eliminated(problem, shapes, at), np.array([len(p) - 1]))
    yield problem, _last(shapes, int(np.where(waves.is_wave, unlikely, np.inf).argmin()))
    strongest = np.argsort(-np.abs(residues[0] * problem.weight))
    few = strongest[: int(LOCAL * len(strongest))]
    count = 1 + int(unlikely_local(problem, shapes, at, few).argmin())
    yield problem._replace(waves=waves.seen_by(strongest[:count])), _last(shapes, len(waves.columns))


def _last(shapes: Shapes, kind: int) -> Shapes:
    """The last mode of a kind."""
    return shapes._replace(kind=np.append(shapes.kind[:-1], kind))
