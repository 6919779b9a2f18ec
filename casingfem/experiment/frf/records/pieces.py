"""Records cut into hits: start and pulses of each hit, and the reason if it is left out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from casingfem.experiment.frf.records.estimated import Hit, Shown
from casingfem.experiment.frf.records.hits import Pulse, clipped, pulses, quiet, separate
from casingfem.experiment.frf.records.take import LEAST, Take
from casingfem.experiment.frf.records.windows import exponential_window, force_window, ringing_left
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

BEFORE = 0.02  # of a block: the pre-trigger where none is given


class Piece(NamedTuple):
    """One hit in a record: its first sample, the number of samples, its pulses."""

    take: Take
    start: int
    samples: int
    found: list[Pulse]

    @property
    def place(self) -> tuple[int, int]:
        """Point and direction of the hit."""
        return int(self.take.force.response_point[0]), int(self.take.force.response_direction[0])

    def clipped_responses(self, samples: int) -> IntArray:
        """Channels of the responses that are clipped in the first samples."""
        return clipped(self.take.response.responses[:, max(self.start, 0) : self.start + samples], decaying=True)


class Block(NamedTuple):
    """Windowed force (samples,) and responses (channels, samples) of one hit, with data for a picture.

    `whole` (channels,) are the responses that are not clipped.
    """

    force: FloatArray
    responses: FloatArray
    whole: BoolArray
    shown: Shown


def pieces_of(take: Take, seconds: float | None, before: float | None, one: bool) -> Iterator[Piece]:
    """Each hit of a record; with `one` a record has one hit, and a second pulse makes it a double hit."""
    force, count = take.force.responses[0], len(take)
    found = pulses(force)
    hits = [found] if one and seconds is None else separate(found, count)
    if not found or (len(hits) < 2 and seconds is None):
        yield Piece(take, 0, count, found)
        return
    starts = [hit[0].start for hit in hits]
    length = round(seconds * take.fs) if seconds is not None else int(np.diff(starts).min())
    lead = round(before * take.fs) if before is not None else min(max(round(BEFORE * length), 2), starts[0])
    if seconds is None:
        length = min(length, max(count - starts[-1] + lead, length // 2))
    for start, hit in zip(starts, hits, strict=True):
        yield Piece(take, start - lead, length, hit)


def hit_of(piece: Piece) -> Hit:
    """A hit, with the reason if it is left out."""
    take, start, samples, found = piece
    force = take.force.responses[0]
    if not found:
        rest, noise = quiet(force)
        largest = float(np.abs(force - rest).max())
        fault = f"no hit: the largest force is {largest:.3g} N, the noise {noise:.2g} N; check trigger and force cell"
        return Hit(take.name, 0.0, largest, 0.0, 0.0, fault)
    pulse, first = found[0], max(start, 0)
    own = Pulse(pulse.start - first, pulse.end - first, pulse.peak)
    left = ringing_left(take.response.responses[:, first : start + samples], own)
    width = (pulse.end - pulse.start) / take.fs
    return Hit(take.name, pulse.start / take.fs, pulse.peak, width, left, fault_of(piece))


def fault_of(piece: Piece) -> str:
    """Reason why a hit is left out, "" if it is used."""
    take, start, samples, found = piece
    fs, pulse = take.fs, found[0]
    if pulse.start - start < 1 or start < 0:
        return "wrong trigger: the record begins after the start of the pulse; use a pre-trigger"
    if start + samples > len(take):
        seconds = (len(take) - pulse.start) / fs
        return f"the record ends {seconds:.3g} s after the hit, expected at least {samples / fs:.3g} s"
    if pulse.start - start > samples // 2:
        return "wrong trigger: the hit is in the second half of the record; set the pre-trigger"
    inside = [other for other in found[1:] if other.start < start + samples]
    if inside:
        share, delay = abs(inside[0].peak / pulse.peak), (inside[0].start - pulse.start) / fs
        return f"double hit: a second pulse of {100.0 * share:.0f} % comes {1e3 * delay:.3g} ms after the first"
    if len(clipped(take.force.responses[:, start : start + samples])):
        return f"the force is clipped at {abs(pulse.peak):.3g} N: reduce the sensitivity of its channel"
    if len(piece.clipped_responses(samples)) == len(take.response):
        return "every response is clipped: reduce the sensitivity, or hit with less force"
    return ""


def block_of(piece: Piece, samples: int, tau: float | None) -> Block:
    """One hit with its windows; the mean before the pulse is subtracted from the responses."""
    take, start, _, found = piece
    pulse = Pulse(found[0].start - start, found[0].end - start, found[0].peak)
    force = take.force.responses[0, start : start + samples]
    responses = np.array(take.response.responses[:, start : start + samples])
    force = force - float(np.median(force))
    if pulse.start >= LEAST:
        responses -= responses[:, : pulse.start - 1].mean(axis=1, keepdims=True)
    fading = exponential_window(samples, take.fs, pulse, tau)
    kept = force_window(samples, pulse) * fading
    whole = np.ones(len(responses), bool)
    whole[piece.clipped_responses(samples)] = False
    time = (np.arange(samples) - pulse.start) / take.fs
    return Block(force * kept, responses * fading, whole, Shown(time, force, responses, kept, fading))
