"""Candidate poles of a band by sdypy-EMA: the one module that knows it (extra `test-data`).

sdypy-EMA's least-squares complex frequency estimator (LSCF) fits a common denominator in z = exp(-i omega dt). Over
a band that starts far above zero its normal equations are weak, because the band fills a small arc of the unit
circle. Here the band is moved down to start at zero: then it fills half the circle, noise gives poles of negative
damping, and structure poles of positive damping.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from casingfem.errors import MissingExtraError
from casingfem.extras import remedy
from casingfem.io.arrays import Array, FloatArray


def lscf_poles(freq: FloatArray, H: Array, order: int) -> list[Array]:
    """Poles [rad/s] of a band by LSCF, one array for each number of modes 1, 2, ... `order`.

    Verboven, Frequency-domain System Identification for Modal Analysis, PhD thesis, Vrije Universiteit Brussel
    (2002), section 5.3, as sdypy-EMA has it. Only poles of positive damping and frequency are kept.

    Parameters
    ----------
    freq : evenly spaced lines [Hz], (lines,)
    H : responses (channels, lines), complex
    order : largest number of modes

    Raises
    ------
    MissingExtraError
        sdypy-EMA is not installed.

    Examples
    --------
    >>> freq = np.arange(90.0, 110.0, 0.1)
    >>> pole = 2 * np.pi * 100.0 * (-0.005 + 1j)
    >>> found = lscf_poles(freq, (1.0 / (2j * np.pi * freq - pole))[None], 6)[-1]
    >>> round(float(abs(found[np.abs(found - pole).argmin()]) / (2 * np.pi)), 2)
    100.0
    """
    model = _ema().Model(
        frf=H,
        freq=freq - freq[0],
        lower=float(freq[1] - freq[0]),  # with 0 its denominator would be wrong: it sums over no lines
        upper=float(freq[-1] - freq[0]),
        pol_order_high=order,
    )
    model.get_poles(method="lscf", show_progress=False)
    swept = []
    for found in model.all_poles:
        kept = found[(found.imag > 0.0) & (found.real < 0.0) & np.isfinite(found)]
        swept.append(kept + 2j * np.pi * freq[0])
    return swept


def _ema() -> Any:
    """sdypy-EMA, or what to install."""
    try:
        import sdypy.EMA
    except ImportError as error:
        message = f"modes are identified with sdypy-EMA, which is not installed: {remedy('test-data')}"
        raise MissingExtraError(message) from error
    return sdypy.EMA
