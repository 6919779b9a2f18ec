"""Frequency responses from time records, as an analyser makes them: blocks, window, overlap, H1 or H2, coherence.

    H1 = G_xf G_ff^-1,  H2 = G_xx G_fx^-1,  coherence = G_xf G_ff^-1 G_fx/G_xx

(Bendat & Piersol, Random Data, 4th ed., 2010, chapters 6 and 7). H1 holds where the noise is on the responses, H2
where it is on a single force. A Hann window lets a line leak as 1/k^3 over k lines, a rectangular one as 1/k.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from scipy.signal.windows import hann

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.rig.record import Record
from casingfem.experiment.rig.rig import UNITS
from casingfem.io.arrays import Array, FloatArray

Window = Literal["hann", "rectangular"]
Estimator = Literal["H1", "H2"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """Estimated responses (`frfs`) and the multiple coherence of each sensor with all drives (`coherence`)."""

    frfs: FrfSet
    coherence: FrfSet
    averages: int


def estimate(
    record: Record,
    *,
    window: Window = "hann",
    estimator: Estimator = "H1",
    overlap: float = 0.5,
    band: tuple[float, float] | None = None,
) -> Estimate:
    """Frequency responses of a record by averages over its blocks, lines 1/T apart, without the line at 0 Hz.

    Parameters
    ----------
    window
        "hann" for stationary forces; "rectangular" for bursts and taps that die out within the block.
    overlap
        Part that neighbouring blocks share, 0 to 0.9; 0 where blocks must begin with their bursts or taps.
    band
        Frequencies kept [Hz]; all below fs/2.56 if left out.

    Raises
    ------
    InputError
        Fewer averages than drives, H2 with several drives, unknown words.

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
    check(record, window, estimator, overlap)
    x, f = spectra(record.response, record, window, overlap), spectra(record.force, record, window, overlap)
    freq = np.fft.rfftfreq(record.block, 1.0 / record.fs)
    low, high = band or (0.0, record.fs / 2.56)
    lines = (freq > 0.0) & (freq >= low) & (freq <= high)
    x, f, freq = x[..., lines], f[..., lines], freq[lines]
    averages = x.shape[1]
    if averages < len(f) or not lines.any():
        raise InputError(f"estimate: found {averages} averages, {len(freq)} lines, expected {len(f)} averages, a line")
    g_ff, g_xf = cross(f, f), cross(x, f)
    g_xx = np.mean(np.abs(x) ** 2, axis=1).T
    first = np.linalg.solve(g_ff.transpose(0, 2, 1), g_xf.transpose(0, 2, 1)).transpose(0, 2, 1)
    explained = np.einsum("lsd,lsd->ls", first, g_xf.conj()).real
    H = first if estimator == "H1" else g_xx[:, :, None] / g_xf.conj()
    note = (
        f"{estimator}, {window} window, {averages} averages of {record.block} samples at {record.fs:g} Hz, "
        f"overlap {overlap:g}"
    )
    places = record.rig.places(record.sensors, record.drives)
    own = record.rig.places(record.sensors, record.drives[:1])
    card = (*record.card, note)
    return Estimate(
        frfs=FrfSet.from_arrays(
            kind="frf",
            x=freq,
            responses=H.transpose(2, 1, 0).reshape(-1, len(freq)),
            unit=UNITS[record.quantity],
            card=card,
            **places,
        ),
        coherence=FrfSet.from_arrays(
            kind="spectrum", x=freq, responses=(explained / g_xx).T, unit="", card=(*card, "multiple coherence"), **own
        ),
        averages=averages,
    )


def check(record: Record, window: str, estimator: str, overlap: float) -> None:
    """Refuse what no estimate is made of."""
    for name, word, words in (("window", window, get_args(Window)), ("estimator", estimator, get_args(Estimator))):
        if word not in words:
            raise InputError(f"{name}: found {word!r}, expected {' or '.join(words)}")
    if not 0.0 <= overlap <= 0.9:
        raise InputError(f"overlap: found {overlap!r}, expected 0 to 0.9")
    if estimator == "H2" and len(record.force) > 1:
        raise InputError(f"estimator: found H2 with {len(record.force)} drives, expected H1, or one drive")


def spectra(values: FloatArray, record: Record, window: Window, overlap: float) -> Array:
    """Windowed transforms of a record's blocks, (channels, averages, lines)."""
    step = max(1, round(record.block * (1.0 - overlap)))
    blocks = np.lib.stride_tricks.sliding_window_view(values, record.block, axis=1)[:, ::step]
    shape = hann(record.block, sym=False) if window == "hann" else np.ones(record.block)
    return np.asarray(np.fft.rfft(blocks * shape, axis=-1))


def cross(x: Array, f: Array) -> Array:
    """Cross spectra averaged over blocks, (lines, x channels, f channels)."""
    return np.asarray(np.einsum("xal,fal->lxf", x, f.conj(), optimize=True) / x.shape[1])
