"""Frequency responses from a record of the test rig, by averages over its blocks as in an analyser."""

from __future__ import annotations

from casingfem.experiment.frf.records.averages import Estimator, Window
from casingfem.experiment.frf.records.estimate import estimate as of_takes
from casingfem.experiment.frf.records.estimated import Estimate
from casingfem.experiment.rig.record import Record


def estimate(
    record: Record,
    *,
    window: Window = "hann",
    estimator: Estimator = "H1",
    overlap: float = 0.5,
    band: tuple[float, float] | None = None,
) -> Estimate:
    """Averages over the blocks of the record, on lines 1/T apart, without the line at 0 Hz.

    Parameters
    ----------
    window
        "hann" for stationary forces; "rectangular" for bursts and taps that decay within the block.
    overlap
        Overlap of neighbouring blocks, 0 to 0.9; 0 if blocks must begin with their bursts or taps.
    band
        Frequencies kept [Hz]; by default all below fs/2.56.

    Raises
    ------
    InputError
        There are fewer averages than drives, H2 is requested with several drives, or a word is unknown.

    Examples
    --------
    >>> from casingfem.experiment.rig.rig import Rig
    >>> from casingfem.experiment.rig.excitation import BurstRandom
    >>> from casingfem.experiment.rig.record import record
    >>> rig = Rig.of(omega=[600.0], zeta=[0.02], rows=[[1.0]])
    >>> test = record(rig, [BurstRandom(rms=1.0, band=(20.0, 180.0), part=0.3)], drives=[0], sensors=[0], fs=512.0,
    ...               block=1024, blocks=8, seed=11)
    >>> found = estimate(test, window="rectangular", overlap=0.0, band=(90.0, 100.0)).frfs
    >>> exact = rig.frfs(found.x, sensors=[0], drives=[0])
    >>> bool(abs(found.responses / exact.responses - 1.0).max() < 5e-3)
    True
    """
    return of_takes(
        record.take(), test="shaker", seconds=record.block / record.fs, window=window, estimator=estimator,
        overlap=overlap, band=band,
    )  # fmt: skip
