"""Other readings of two modes near each other: what else their peaks in a set-up may be, fitted.

A fit by steps stays where it is where two modes are exchanged in a set-up, or a weak one has gone to where there is
only noise. So they are put where they may be, with each number of nodal diameters that they may share, alone with the
modes near them on the lines about: what is tried there costs a tenth.

Then one more mode may be there: one that free residues hid, or a local one that moves its neighbours unseen. With free
residues a mode must take from the squares what 2 C numbers cost. As a wave, or seen by few channels, it has fewer, and
the likelihood of `wave_fit.py` holds what residues cost: left are the frequencies of S set-ups and damping,

    price = (S + 1) ln(entries) + 2 C ln 2   of -2 ln of the likelihood,

the last term for any set of channels that see it.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import AROUND, LEAST_LINES, best_beside
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
    rms,
    sized,
    solved,
)
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_residues import eliminated, unlikely_at, unlikely_kinds, unlikely_local
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

STEPS = 3, 8  # of a try, at first and then
HOPELESS = 2000.0  # rise of -2 ln of the likelihood after the first, beyond which a try is given up: none came back
WEAK = 0.03  # standard deviation of a mode's ln f in a set-up over its damping ratio, beyond which it is weak there
PLACES = 13  # that a mode is tried at in a set-up
SWEEPS = 2  # over the set-ups, of finding a partner's places
WIDER = 1.0, 3.0  # times the usual damping, that a further mode is tried with
ASIDE = 0.5  # half-power half-widths from a mode without partner, that its partner is tried at
DAMPED = 5.0  # times that, beyond which it is no peak
LOCAL = 0.5  # share of the channels that see a local mode, at most
PROMISING, SIZINGS = 2, 2  # tries that are followed further, so many times with sizes and kinds anew


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
    other = kind[weaker] != kind[stronger] and problem.waves.is_wave[kind[stronger]]
    if not (other and weak(problem, read)[weaker].any()):
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
            tried = fitted(trying, shapes, *start, STEPS[1])
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
    return shapes._replace(kind=np.append(shapes.kind[:-1], kind))
