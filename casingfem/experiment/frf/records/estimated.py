"""Result of an estimate of frequency responses: responses, coherence, accepted and rejected hits, notes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.io.arrays import Array, FloatArray
from contact.io.reported import Reported

RECORD = 7  # lines of a header in a universal file


class Hit(NamedTuple):
    """A hit: record and time [s], peak [N], width [s] at a tenth of it, part of the ringing left at the record's end.

    `fault` is the reason why it was left out, "" if it was used.
    """

    take: str
    time: float
    peak: float
    width: float
    left: float
    fault: str


class Shown(NamedTuple):
    """One block for a picture: time from the trigger [s], force, responses, and the two windows.

    time, force, force_window, response_window (samples,); responses (channels, samples).
    """

    time: FloatArray
    force: FloatArray
    responses: FloatArray
    force_window: FloatArray
    response_window: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Estimate(Reported):
    """Frequency responses from time records.

    Attributes
    ----------
    frfs
        The responses; the card names estimator, window and averages, and the line `exponential_window_s` the time
        constant of an exponential window, whose damping `identify` subtracts.
    coherence
        Ordinary coherence of each channel, multiple with several forces; None with fewer than two averages.
    averages
        Number of averages of each reference.
    hits
        Hits of a hammer test, including those that were left out.
    left
        Part of the ringing amplitude that remains when the records end, before any window; 0 for a shaker test.
    notes
        Findings about the records, as text.
    shown
        The first used block.

    Examples
    --------
    >>> import numpy as np
    >>> import casingfem as cf
    >>> one = cf.frf.FrfSet.from_arrays(kind="frf", x=[10.0, 20.0], responses=[1.0, 2.0j], unit="m/N")
    >>> Estimate(frfs=one, coherence=None, averages=1).averages
    1
    """

    frfs: FrfSet
    coherence: FrfSet | None
    averages: int
    hits: tuple[Hit, ...] = ()
    left: float = 0.0
    notes: tuple[str, ...] = ()
    shown: Shown | None = None

    @property
    def kept(self) -> tuple[Hit, ...]:
        """The hits that were used."""
        return tuple(hit for hit in self.hits if not hit.fault)

    def records(self) -> list[dict[str, Any]]:
        """One row for each hit; for a shaker test, one row for each channel."""
        if self.hits:
            return [
                {
                    "hit": k + 1, "take": hit.take, "time_s": hit.time, "peak_n": hit.peak, "width_s": hit.width,
                    "ringing_left": hit.left, "used": not hit.fault, "why": hit.fault,
                }
                for k, hit in enumerate(self.hits)
            ]  # fmt: skip
        return list(self._channels())

    def _channels(self) -> Iterator[dict[str, Any]]:
        for k in range(len(self.frfs)):
            yield {
                "channel": k + 1,
                "point": int(self.frfs.response_point[k]),
                "reference": int(self.frfs.reference_point[k]),
                "median_coherence": self.median_coherence(k),
            }

    def median_coherence(self, channel: int) -> float | None:
        """Median coherence of a channel over the lines, None without coherence."""
        if self.coherence is None:
            return None
        values: Array = self.coherence.responses.real
        return float(sorted(values[channel % len(values)].tolist())[values.shape[1] // 2])

    def __repr__(self) -> str:
        used = f", {len(self.kept)} of {len(self.hits)} hits" if self.hits else ""
        averages = f"{self.averages} average{'s' * (self.averages > 1)}"
        lines = [f"Estimate({self.frfs!r}, {averages}{used})"]
        lines += [f"hit {k + 1} is not used: {hit.fault}" for k, hit in enumerate(self.hits) if hit.fault]
        return "\n".join([*lines, *self.notes])
