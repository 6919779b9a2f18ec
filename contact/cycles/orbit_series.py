"""Harmonics of an orbit's gaps, from its phases in closed form: a start for harmonic balance."""

from __future__ import annotations

import numpy as np

from contact.base.arrays import Array
from contact.cycles.driven import Family
from contact.cycles.harmonics import in_harmonics, samples_of
from contact.cycles.passage import Motion, passage
from contact.cycles.shooting import Orbit
from contact.cycles.switched import Complex


def gaps_of(family: Family, orbit: Orbit, harmonics: int) -> Complex:
    """The series of `Balanced.y` of an orbit, from its phases in closed form: (k, H + 1)."""
    motion, base = family.at(orbit.value)
    start, samples = orbit.start * base, samples_of(harmonics)
    found = passage(motion, orbit.x, start, orbit.period, tangent=False, extremes=False)
    time = start + orbit.period * np.arange(samples) / samples
    y, x, t, first = np.empty((len(motion.plant.C), samples)), np.array(orbit.x), start, 0
    for number, length in zip(found.stretches.phase.tolist(), found.stretches.time.tolist(), strict=True):
        last = int(np.searchsorted(time, t + length))
        x, y[:, first:last] = _phase(motion, number, x, t, length, time[first:last])
        t, first = t + length, last
    y[:, first:] = y[:, first - 1 : first]  # samples at the end by rounding
    turn = np.exp(-2j * np.pi * start / orbit.period * np.arange(harmonics + 1))
    return np.asarray(in_harmonics(y, harmonics) * turn)


def _phase(motion: Motion, number: int, x: Array, t: float, length: float, time: Array) -> tuple[Array, Array]:
    """State at the end of a phase, and y of the contacts at times within it."""
    closed = motion.known.closed_of(number)
    driven, k = motion.phase(closed), len(motion.plant.C)
    phase, w = driven.phase, motion.drive.w * motion.drive.harmonics[:, None]
    rest = -(phase.U @ driven.b.rest) / phase.lam
    begin = phase.U @ (x - (driven.X @ np.exp(1j * w * t)).real[:, 0]) - rest
    at = np.append(time, t + length)
    free = begin[:, None] * np.exp(phase.lam[:, None] * (at - t)) + rest[:, None]
    state = (phase.V @ free).real + (driven.X @ np.exp(1j * w * at)).real
    forced = driven.watched.rest[:k, None] + (driven.watched.wave[:k] @ np.exp(1j * w * at)).real
    seen = phase.rows[:k] @ state + forced
    chosen = list(closed)
    seen[chosen] *= -np.diag(motion.plant.S)[chosen, None]
    return state[:, -1], seen[:, :-1]
