"""Hits in a force record: pulses above the trigger level, second pulses, truncated and clipped pulses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray

TRIGGER = 0.1  # of the largest force: the level at which a pulse begins
ABOVE_NOISE = 8.0  # standard deviations of the quiet force that a pulse must exceed
JOINED = 2.0  # widths of a pulse within which another crossing belongs to it (ringing of the anti-alias filter)
SECOND = 0.25  # of the usual distance of hits: a pulse that follows sooner is a second hit
RUN, STEP = 3, 5.0  # samples at one extreme value, and the step beside them in smallest steps, of a clipped channel
HALF = 0.5  # of the largest value: a flat part below it is the rest of the channel
FINE = 1000.0  # smallest steps of a channel above which three samples of a decaying response do not coincide by chance


class Pulse(NamedTuple):
    """A pulse: its first sample above the trigger level, the one after its last, its peak [N] with its sign."""

    start: int
    end: int
    peak: float


def quiet(force: FloatArray) -> tuple[float, float]:
    """Rest value and standard deviation of a force between its pulses: median and median deviation."""
    rest = float(np.median(force))
    return rest, 1.4826 * float(np.median(np.abs(force - rest)))


def pulses(force: FloatArray) -> list[Pulse]:
    """Pulses of a force record (samples,), ascending in time; empty if nothing exceeds the noise.

    >>> force = np.zeros(100)
    >>> force[20:23], force[60:63] = [2.0, 9.0, 3.0], [1.0, 7.0, 2.0]
    >>> pulses(force)
    [Pulse(start=20, end=23, peak=9.0), Pulse(start=60, end=63, peak=7.0)]
    """
    rest, noise = quiet(force)
    away = force - rest
    largest = float(np.abs(away).max())
    level = max(TRIGGER * largest, ABOVE_NOISE * noise)
    if largest == 0.0 or largest <= level:
        return []
    sign = 1.0 if away[int(np.argmax(np.abs(away)))] > 0.0 else -1.0
    above = np.flatnonzero(sign * away > level)
    found: list[Pulse] = []
    for run in np.split(above, np.flatnonzero(np.diff(above) > 1) + 1):
        start, end = int(run[0]), int(run[-1]) + 1
        if found and start - found[-1].end < JOINED * max(found[-1].end - found[-1].start, 2):
            start = found.pop().start
        found.append(Pulse(start, end, float(sign * (sign * away[start:end]).max())))
    return found


def separate(found: list[Pulse], samples: int) -> list[list[Pulse]]:
    """Pulses of one long record by hit; pulses too soon for another hit belong to the previous one.

    >>> [len(hit) for hit in separate([Pulse(k, k + 3, 1.0) for k in (100, 130, 1100, 2100)], 3000)]
    [2, 1, 1]
    """
    if not found:
        return []
    starts = np.array([pulse.start for pulse in found])
    usual = max(float(np.diff(starts).max(initial=0)), float(samples - starts[-1]))
    hits = [[found[0]]]
    for pulse in found[1:]:
        if pulse.start - hits[-1][0].start < SECOND * usual:
            hits[-1].append(pulse)
        else:
            hits.append([pulse])
    return hits


def clipped(values: FloatArray, *, decaying: bool = False) -> IntArray:
    """Rows of records (channels, samples) that stay at their largest or smallest value, like an overloaded converter.

    The criterion is three consecutive samples with exactly this value, next to a step larger than five of the channel's
    smallest steps. A slow peak of a coarse converter has only small steps there. For a decaying response, three such
    samples anywhere are enough if the channel has a thousand steps or more.

    >>> sine = np.sin(0.3 * np.arange(90))
    >>> clipped(np.array([sine, np.clip(sine, -0.8, 0.8), 0.0 * sine])).tolist()
    [1]
    """
    flat = (_flat(row, decaying) or _flat(-row, decaying) for row in values)
    return np.flatnonzero(np.fromiter(flat, bool, len(values)))


def _flat(row: FloatArray, decaying: bool) -> bool:
    top, away = row == row.max(), row - np.median(row)
    if top.sum() < RUN or float(away.max()) <= HALF * float(np.abs(away).max()):
        return False
    steps = np.abs(np.diff(row))
    least = float(steps[steps > 0.0].min())
    at = np.flatnonzero(top)
    if decaying and float(away.max()) > FINE * least:
        return True
    longest = max(np.split(at, np.flatnonzero(np.diff(at) > 1) + 1), key=len)
    beside = steps[[k for k in (int(longest[0]) - 1, int(longest[-1])) if 0 <= k < len(steps)]]
    return len(longest) >= RUN and float(beside.max(initial=0.0)) > STEP * least
