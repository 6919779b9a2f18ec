"""Hammer tests: responses averaged over the hits at each point."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.records.averages import Averages, Estimator, averaged
from casingfem.experiment.frf.records.estimated import Estimate, Hit, Shown
from casingfem.experiment.frf.records.lines import kept_lines, lines_of, notes_of, same_channels
from casingfem.experiment.frf.records.pieces import Block, Piece, block_of, hit_of, pieces_of
from casingfem.experiment.frf.records.sets import sets_of
from casingfem.experiment.frf.records.take import LEAST, Take
from casingfem.experiment.frf.records.windows import longer
from casingfem.io.arrays import BoolArray, FloatArray

WEAK = 1e-2  # of the largest force spectrum: lines below it have little force
ENDED = 0.2  # ringing left from which it is reported
MOST_NAMED = 6


class Point(NamedTuple):
    """Averages at one hit point: point and direction, channels, responses (1, channels, lines), number of hits."""

    place: tuple[int, int]
    channels: FrfSet
    averages: Averages
    hits: int


def hammer_frfs(
    takes: tuple[Take, ...], estimator: Estimator, tau: float | None, seconds: float | None, before: float | None,
    band: tuple[float, float] | None,
) -> Estimate:  # fmt: skip
    """Responses of a hammer test; see `estimate` for the arguments."""
    several = next((take for take in takes if len(take.force) > 1), None)
    if several is not None:
        found = f"{len(several.force)} forces at once"
        raise InputError(several.name, found=found, expected="one force channel of a hammer, or test = shaker")
    pieces = [piece for take in takes for piece in pieces_of(take, seconds, before, len(takes) > 1)]
    hits = [hit_of(piece) for piece in pieces]
    used = [piece for piece, hit in zip(pieces, hits, strict=True) if not hit.fault]
    samples = _samples(used, hits, takes[0])
    points, shown = _points(used, samples, tau, estimator)
    fs, count = takes[0].fs, min(point.hits for point in points)
    freq = lines_of(samples, fs)
    kept = kept_lines(freq, fs, band)
    words = f"{estimator} of {count} hit{'s' * (count > 1)}, {samples} samples at {fs:.6g} Hz, force window"
    window = () if tau is None else (f"exponential_window_s: {tau:g}",)
    frfs, coherence = _sets(takes[0], points, freq, kept, (*takes[0].response.card, *window, words))
    left = float(np.median([hit.left for hit in hits if not hit.fault]))
    notes = (
        *_few(count), *_negative(hits), *_ringing(left, samples / fs, tau), *_weak(shown, fs, freq[kept]),
        *_clipped(used, samples), *notes_of(frfs, takes[0].force.unit),
    )  # fmt: skip
    given, coherent, swapped = _reciprocal(frfs, coherence if count > 1 else None)
    return Estimate(
        frfs=given, coherence=coherent, averages=count, hits=tuple(hits), left=left, notes=(*notes, *swapped),
        shown=shown,
    )  # fmt: skip


def _samples(used: list[Piece], hits: list[Hit], take: Take) -> int:
    """Number of samples of all blocks: an even number, that of the shortest."""
    if not used:
        words = "; ".join(f"hit {k + 1}: {hit.fault}" for k, hit in enumerate(hits[:MOST_NAMED]))
        raise InputError(take.name, found=words, expected="at least one usable hit")
    samples = min(piece.samples for piece in used) // 2 * 2
    if samples < LEAST:
        raise InputError(take.name, found=f"{samples} samples a hit", expected=f"{LEAST} or more")
    return samples


def _points(used: list[Piece], samples: int, tau: float | None, estimator: Estimator) -> tuple[list[Point], Shown]:
    """Averages at every hit point, and the first block."""
    by_place = dict[tuple[int, int], list[Piece]]()
    for piece in used:
        by_place.setdefault(piece.place, []).append(piece)
    points, shown = list[Point](), None
    for place, own in by_place.items():
        channels = same_channels([piece.take for piece in own])
        blocks = [block_of(piece, samples, tau) for piece in own]
        shown = shown or blocks[0].shown
        points.append(Point(place, channels, _averaged(blocks, estimator), len(own)))
    assert shown is not None
    return points, shown


def _averaged(blocks: list[Block], estimator: Estimator) -> Averages:
    """Averages over the hits in which each channel is not clipped; 0 for a channel that is always clipped."""
    whole = np.array([block.whole for block in blocks])  # (hits, channels)
    x = np.fft.rfft(np.stack([block.responses for block in blocks], axis=1), axis=-1)
    f = np.fft.rfft([[block.force for block in blocks]], axis=-1)
    H, coherence = np.zeros((1, len(x), x.shape[2]), complex), np.zeros((len(x), x.shape[2]))
    for pattern in np.unique(whole, axis=1).T:
        same = np.flatnonzero((whole == pattern[:, None]).all(axis=0))
        if pattern.any():
            found = averaged(x[np.ix_(same, np.flatnonzero(pattern))], f[:, pattern], estimator)
            H[:, same], coherence[same] = found
    return Averages(H, coherence)


def _sets(
    take: Take, points: Sequence[Point], freq: FloatArray, kept: BoolArray, card: tuple[str, ...]
) -> tuple[FrfSet, FrfSet]:
    """Responses of all hit points, each with its channels, and their coherence."""
    channels = [point.channels for point in points]
    counts = [len(each) for each in channels]
    return sets_of(
        take, freq[kept], np.concatenate([point.averages.H[0] for point in points])[:, kept],
        np.concatenate([point.averages.coherence for point in points])[:, kept],
        response=(
            np.concatenate([each.response_point for each in channels]),
            np.concatenate([each.response_direction for each in channels]),
        ),
        reference=(
            np.repeat([point.place[0] for point in points], counts),
            np.repeat([point.place[1] for point in points], counts),
        ),
        card=card,
    )  # fmt: skip


def _few(count: int) -> Iterator[str]:
    if count < 2:
        yield "found one hit at a point, from which no coherence follows: hit three to five times at each point"


def _negative(hits: list[Hit]) -> Iterator[str]:
    if np.median([hit.peak for hit in hits if not hit.fault]) < 0.0:
        yield (
            "the pulses of the force are negative, so that all responses have the wrong sign unless the hammer pushes"
            " against its direction: check the sign of the force channel"
        )


def _ringing(left: float, seconds: float, tau: float | None) -> Iterator[str]:
    """Notes on the end of the records, and on the damping that an exponential window adds."""
    if left * (1.0 if tau is None else np.exp(-seconds / tau)) >= ENDED:
        duration, window = longer(left, seconds)
        yield (
            f"the response has decayed only to {100.0 * left:.0f} % at the end: measure {duration:.2g} s, or use an"
            f" exponential window of {window:.2g} s"
        )
    if tau is not None:
        yield (
            f"the exponential window adds 1/(tau omega) to every damping ratio, tau = {tau:g} s; identify subtracts it"
        )


def _weak(shown: Shown, fs: float, lines: FloatArray) -> Iterator[str]:
    """Note on lines at which the hammer gives little force."""
    force = np.abs(np.fft.rfft(shown.force * shown.force_window))
    x = lines_of(len(shown.force), fs)
    weak = x[(force < WEAK * force.max()) & (x >= lines[0]) & (x <= lines[-1])]
    if len(weak):
        yield (
            f"above {weak[0]:.5g} Hz the hammer gives less than {100.0 * WEAK:g} % of its largest force spectrum:"
            " use a harder tip for these lines"
        )


def _clipped(used: list[Piece], samples: int) -> Iterator[str]:
    """Note on channels that are clipped in used hits."""
    found = dict[tuple[int, int], int]()
    for piece in used:
        for k in piece.clipped_responses(samples).tolist():
            place = k + 1, int(piece.take.response.response_point[k])
            found[place] = found.get(place, 0) + 1
    for (channel, point), times in found.items():
        yield (
            f"response channel {channel} (point {point}) is clipped in {times} of {len(used)} hits, which are not"
            " averaged: reduce its sensitivity"
        )


def _reciprocal(frfs: FrfSet, coherence: FrfSet | None) -> tuple[FrfSet, FrfSet | None, tuple[str, ...]]:
    """The set of a roving hammer with hit points as sensors: H_rs = H_sr."""
    hit, fixed = (
        len(np.unique(np.column_stack([getattr(frfs, f"{name}_point"), getattr(frfs, f"{name}_direction")]), axis=0))
        for name in ("reference", "response")
    )
    if hit <= fixed:
        return frfs, coherence, ()

    def exchanged(one: FrfSet) -> FrfSet:
        return replace(
            one, response_point=one.reference_point, response_direction=one.reference_direction,
            reference_point=one.response_point, reference_direction=one.response_direction,
        )  # fmt: skip

    note = f"a roving hammer: {hit} hit points are given as sensors, {fixed} sensor{'s' * (fixed > 1)} as references"
    return exchanged(frfs), None if coherence is None else exchanged(coherence), (f"{note} (reciprocity)",)
