"""Frequency responses of time records: hammer tests hit by hit, shaker tests block by block.

1. `hits`: pulses of the force are triggers; double, truncated and clipped hits are left out, with the reason. 2.
`windows`: the force is set to zero away from its pulse; an exponential window multiplies force and responses. 3.
`averages`: H1, H2 or Hv over the hits or blocks, and the coherence.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.records.averages import Estimator, Window, check_options
from casingfem.experiment.frf.records.estimated import Estimate
from casingfem.experiment.frf.records.hammer import hammer_frfs
from casingfem.experiment.frf.records.shaker import SHORTEST, shaker_frfs
from casingfem.experiment.frf.records.take import Take

Test = Literal["hammer", "shaker"]
CREST = 9.0  # peak over rms of a force, above which it is a hammer's


def estimate(
    takes: Take | Sequence[Take],
    *,
    test: Test | None = None,
    estimator: Estimator = "H1",
    exponential: float | None = None,
    seconds: float | None = None,
    before: float | None = None,
    window: Window = "hann",
    overlap: float = 0.5,
    band: tuple[float, float] | None = None,
) -> Estimate:
    """Frequency responses of time records of a hammer or a shaker test.

    Parameters
    ----------
    takes
        Forces and responses that were sampled together: a record for each hit, or long records with many.
    test
        "hammer" or "shaker"; None decides by the peak of the force over its rms.
    estimator
        "H1", "H2" or "Hv"; with several forces at once H1.
    exponential
        Time constant [s] of an exponential window; `identify` subtracts its damping. Hammer tests only.
    seconds
        Length of a block [s]. None: a record with one hit is one block, in long records a block ends at the next hit;
        for a shaker a twentieth of the record.
    before
        Pre-trigger [s] of a hit in a long record; None: 2 % of the block.
    window, overlap
        Window and overlap of the blocks of a shaker test: "hann", or "rectangular" for bursts that decay within the
        block.
    band
        Frequencies kept [Hz]; all up to fs/2.56 if None.

    Raises
    ------
    InputError
        Records differ in rate or channels, no hit is usable, or options contradict each other.

    Examples
    --------
    >>> from casingfem.experiment.frf.frf_set import FrfSet
    >>> t = np.arange(4096) / 1024.0
    >>> pulse = np.where(abs(t - 0.05) < 2e-3, np.cos(250.0 * np.pi * (t - 0.05)) ** 2, 0.0)
    >>> ring = np.convolve(pulse, np.exp(-2.0 * t) * np.sin(600.0 * t))[:4096] / 1024.0
    >>> force = FrfSet.from_arrays(kind="time", x=t, responses=[pulse], unit="N")
    >>> found = estimate(Take(response=FrfSet.from_arrays(kind="time", x=t, responses=[ring], unit="m"), force=force))
    >>> float(found.frfs.x[abs(found.frfs.responses[0]).argmax()]), round(found.hits[0].left, 4)  # 95.5 Hz, exp(-7.9)
    (95.5, 0.0004)
    """
    chosen = (takes,) if isinstance(takes, Take) else tuple(takes)
    check_options(window, estimator, overlap, len(chosen[0].force) if chosen else 1)
    _check(chosen, test, exponential, seconds, before)
    kind: Test = test or _kind(chosen)
    if kind == "shaker":
        if exponential is not None:
            raise InputError("exponential", found="an exponential window", expected="none: it is for hammer tests")
        return shaker_frfs(chosen, estimator, seconds, window, overlap, band)
    return hammer_frfs(chosen, estimator, exponential, seconds, before, band)


def _check(
    takes: tuple[Take, ...], test: str | None, exponential: float | None, seconds: float | None, before: float | None
) -> None:
    if not takes:
        raise InputError("takes", found="none", expected="one take or more")
    if test not in (None, *get_args(Test)):
        raise InputError(f"test: found {test!r}, expected {' or '.join(get_args(Test))}")
    for name, value in (("exponential", exponential), ("seconds", seconds), ("before", before)):
        if value is not None and not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name}: found {value!r}, expected a time [s] above 0")
    first = takes[0]
    for name, value in (("exponential", exponential), ("seconds", seconds)):
        if value is not None and value * first.fs < SHORTEST:
            found = f"{value:g} s, {value * first.fs:.2g} samples at {first.fs:g} Hz"
            raise InputError(name, found=found, expected=f"{SHORTEST} samples or more")
    for take in takes[1:]:
        if abs(take.fs - first.fs) > 1e-6 * first.fs:
            found = f"{take.fs:g} samples a second, {first.name} has {first.fs:g}"
            raise InputError(take.name, found=found, expected="one rate: export all records with the same rate")
        for mine, other in ((take.response, first.response), (take.force, first.force)):
            if mine.unit != other.unit:
                found = f"the unit {mine.unit or 'none'!r}, {first.name} has {other.unit or 'none'!r}"
                raise InputError(take.name, found=found, expected="one unit")


def _kind(takes: tuple[Take, ...]) -> Test:
    """Kind of test: hammer if the peak of the force is many times its rms, else shaker."""
    peaks = []
    for take in takes:
        for row in take.force.responses:
            away = row - np.median(row)
            rms = float(np.sqrt(np.mean(away**2)))
            peaks.append(float(np.abs(away).max()) / rms if rms else 0.0)
    return "hammer" if float(np.median(peaks)) > CREST else "shaker"
