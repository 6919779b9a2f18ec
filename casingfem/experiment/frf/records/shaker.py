"""Shaker tests: averages over blocks of stationary, burst or swept forces, one or several at once."""

from __future__ import annotations

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.records.averages import Averages, Estimator, Window, averaged, block_spectra
from casingfem.experiment.frf.records.estimated import Estimate
from casingfem.experiment.frf.records.hits import clipped
from casingfem.experiment.frf.records.lines import kept_lines, lines_of, notes_of, same_channels
from casingfem.experiment.frf.records.sets import sets_of
from casingfem.experiment.frf.records.take import Take
from casingfem.io.arrays import FloatArray

AVERAGES = 20  # blocks of a record where no length is given
QUIETEST = 1e-30  # N
ONE_SIGNAL = 1e-9  # least eigenvalue of the correlation of several forces
SHORTEST = 4  # samples of a block


def shaker_frfs(
    takes: tuple[Take, ...], estimator: Estimator, seconds: float | None, window: Window, overlap: float,
    band: tuple[float, float] | None,
) -> Estimate:  # fmt: skip
    """Responses of a shaker test; see `estimate` for the arguments."""
    fs, drives = takes[0].fs, len(takes[0].force)
    whole = len(takes) > 1 and seconds is None
    samples = min(len(take) for take in takes)
    block = round(seconds * fs) if seconds is not None else samples if whole else samples // AVERAGES
    block -= block % 2
    if not SHORTEST <= block <= samples:
        found = f"blocks of {block} samples in records of {samples}"
        raise InputError(
            takes[0].name, found=found, expected=f"{SHORTEST} samples or more, at most the length of the records"
        )
    same_channels(list(takes))
    for take in takes:
        _check_forces(take)
        off = [*clipped(take.force.responses).tolist(), *clipped(take.response.responses).tolist()]
        if off:
            found = f"clipped channels: {len(clipped(take.force.responses))} forces, {_off(take)}"
            raise InputError(take.name, found=found, expected="channels within their range: reduce their sensitivity")
    x, f = (
        np.concatenate([block_spectra(part, block, window, overlap) for part in parts], axis=1)
        for parts in ([take.response.responses for take in takes], [take.force.responses for take in takes])
    )
    freq = lines_of(block, fs)
    kept = kept_lines(freq, fs, band)
    averages = x.shape[1]
    if averages < drives:
        raise InputError(takes[0].name, found=f"{averages} averages", expected=f"{drives}, one for each force")
    means = averaged(x[..., kept], f[..., kept], estimator)
    words = f"{estimator}, {window} window, {averages} averages of {block} samples at {fs:.6g} Hz, overlap {overlap:g}"
    return _of_drives(takes[0], means, freq[kept], (*takes[0].response.card, words), averages)


def _check_forces(take: Take) -> None:
    """Refuse a constant force, and forces that are the same signal."""
    force = np.asarray(take.force.responses)
    away = force - force.mean(axis=1, keepdims=True)
    rms = np.sqrt(np.mean(away**2, axis=1))
    if float(rms.min()) <= QUIETEST:
        k = int(np.argmin(rms))
        found = f"a force at point {take.force.response_point[k]} that does not change: {force[k, 0]:.3g} N"
        raise InputError(take.name, found=found, expected="a force: check the cable and the list of channels")
    alike = away / rms[:, None] @ (away / rms[:, None]).T / away.shape[1]
    if float(np.linalg.eigvalsh(alike).min()) < ONE_SIGNAL:
        found = f"{len(force)} linearly dependent forces"
        raise InputError(take.name, found=found, expected="independent forces, or one force")


def _off(take: Take) -> str:
    off = clipped(take.response.responses).tolist()
    return f"responses at points {', '.join(str(take.response.response_point[k]) for k in off)}" if off else "none"


def _of_drives(take: Take, found: Averages, freq: FloatArray, card: tuple[str, ...], averages: int) -> Estimate:
    """The estimate for simultaneous forces: all responses to the first force, then to the next."""
    force, response = take.force, take.response
    drives, channels = len(force), len(response)
    frfs, coherence = sets_of(
        take, freq, found.H.reshape(-1, len(freq)), found.coherence, card=card,
        response=(np.tile(response.response_point, drives), np.tile(response.response_direction, drives)),
        reference=(np.repeat(force.response_point, channels), np.repeat(force.response_direction, channels)),
    )  # fmt: skip
    coherent = coherence if averages > drives else None
    return Estimate(frfs=frfs, coherence=coherent, averages=averages, notes=tuple(notes_of(frfs, force.unit)))
