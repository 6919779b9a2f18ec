"""Spectra averaged over blocks, and the frequency responses estimated from them.

    H1 = G_xf G_ff^-1,  H2 = G_xx G_fx^-1,  Hv = (G_xf/|G_xf|) sqrt(G_xx/G_ff),
    coherence = G_xf G_ff^-1 G_fx/G_xx

(Bendat & Piersol, Random Data, 4th ed., 2010, chapters 6 and 7; Hv: Rocklin, Crowley and Vold, Proc. 3rd IMAC, 1985,
272). H1 is unbiased with noise on the responses, H2 with noise on a single force; Hv, with |Hv| = sqrt(H1 H2), suits
noise on both.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import numpy as np
from scipy.signal.windows import hann

from casingfem.errors import InputError
from casingfem.io.arrays import Array, FloatArray

Estimator = Literal["H1", "H2", "Hv"]
Window = Literal["hann", "rectangular"]


class Averages(NamedTuple):
    """Responses H (drives, channels, lines) and the coherence of each channel with all drives (channels, lines)."""

    H: Array
    coherence: FloatArray


def check_options(window: str, estimator: str, overlap: float, drives: int) -> None:
    """Refuse options that do not allow an estimate."""
    for name, word, words in (("window", window, get_args(Window)), ("estimator", estimator, get_args(Estimator))):
        if word not in words:
            raise InputError(f"{name}: found {word!r}, expected {' or '.join(words)}")
    if not 0.0 <= overlap <= 0.9:
        raise InputError(f"overlap: found {overlap!r}, expected 0 to 0.9")
    if estimator != "H1" and drives > 1:
        raise InputError(f"estimator: found {estimator} with {drives} drives, expected H1, or one drive")


def block_spectra(values: FloatArray, block: int, window: Window, overlap: float) -> Array:
    """Windowed transforms of blocks with this number of samples, (channels, averages, lines)."""
    step = max(1, round(block * (1.0 - overlap)))
    blocks = np.lib.stride_tricks.sliding_window_view(values, block, axis=1)[:, ::step]
    shape = hann(block, sym=False) if window == "hann" else np.ones(block)
    return np.asarray(np.fft.rfft(blocks * shape, axis=-1))


def cross(x: Array, f: Array) -> Array:
    """Cross spectra averaged over blocks, (lines, x channels, f channels)."""
    return np.asarray(np.einsum("xal,fal->lxf", x, f.conj(), optimize=True) / x.shape[1])


def averaged(x: Array, f: Array, estimator: Estimator = "H1") -> Averages:
    """Responses and coherence from spectra x (channels, averages, lines) and f (drives, averages, lines).

    Both are 0 at a line where a force is exactly zero, as the spectrum of a symmetric pulse is at its highest line.

    >>> f = np.array([[[1.0 + 0j], [2.0 + 0j]]])
    >>> averaged(3.0 * f, f).H.real.tolist()
    [[[3.0]]]
    """
    g_ff, g_xf = cross(f, f), cross(x, f)
    g_xx = np.mean(np.abs(x) ** 2, axis=1).T
    silent = np.linalg.slogdet(g_ff)[0] == 0.0
    g_ff[silent], g_xf[silent] = np.eye(len(f)), 0.0
    first = np.linalg.solve(g_ff.transpose(0, 2, 1), g_xf.transpose(0, 2, 1)).transpose(0, 2, 1)
    explained = np.einsum("lsd,lsd->ls", first, g_xf.conj()).real
    with np.errstate(divide="ignore", invalid="ignore"):
        coherence = np.where(g_xx > 0.0, explained / g_xx, 0.0)
        if estimator == "H2":
            first = np.where(g_xf != 0.0, g_xx[:, :, None] / g_xf.conj(), 0.0)
        elif estimator == "Hv":
            size = np.sqrt(g_xx[:, :, None] / g_ff[:, :1, :1].real)
            first = np.where(g_xf != 0.0, g_xf / np.abs(g_xf) * size, 0.0)
    return Averages(first.transpose(2, 1, 0), np.asarray(coherence.T))
