"""Spectral lines of a circle scan: frequencies, resolution, fit, and the noise around them."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from casingfem.errors import InputError
from casingfem.experiment.circle.record import ScanRecord
from casingfem.io.arrays import Array, FloatArray, IntArray

TURNS = 1.5  # of the spot in a record, at least
RESOLVED = 1.0  # bins (1/T) between two lines, at least
TRIED = np.linspace(0.7, 1.4, 281)  # rates tried, over the one that failed
BLOCK = 8192  # samples whose equations are made at once
APART = 1e-4  # least eigenvalue of the lines' correlations: below it the record does not distinguish them
BESIDE = (3, 30)  # bins beside a line whose residual is its noise floor


def line_frequencies(tones: Sequence[float], n: IntArray, rate: float, runout: int) -> FloatArray:
    """Frequencies |f + n W| of all tones and orders, then k W of the run-out [Hz].

    >>> line_frequencies([100.0], np.array([-2, 2]), 3.0, runout=1).tolist()
    [94.0, 106.0, 0.0, 3.0]
    """
    waves = np.add.outer(np.asarray(tones, np.float64), n * rate).ravel()
    return np.asarray(np.abs(np.r_[waves, np.arange(runout + 1) * rate if runout else []]))


def closest(freq: FloatArray) -> tuple[int, int, float]:
    """The two closest lines, and their distance [Hz]."""
    rank = np.argsort(freq, kind="stable")
    gaps = np.diff(freq[rank])
    k = int(gaps.argmin()) if len(gaps) else 0
    return (int(rank[k]), int(rank[k + 1]), float(gaps[k])) if len(gaps) else (0, 0, np.inf)


def clear_rate(
    tones: Sequence[float], n: IntArray, rate: float, seconds: float, fs: float, runout: int = 0
) -> float | None:
    """The rate nearest to `rate` at which all lines are at least two bins apart; None if there is none nearby."""
    for factor in sorted(TRIED, key=lambda f: abs(np.log(f))):
        freq = line_frequencies(tones, n, rate * factor, runout)
        if closest(freq)[2] * seconds >= 2.0 * RESOLVED and freq.max() < 0.5 * fs:
            return float(rate * factor)
    return None


def require_clear(tones: Sequence[float], n: IntArray, rate: float, seconds: float, fs: float, runout: int) -> None:
    """Refuse a record whose lines cannot be distinguished, and name the remedy.

    Raises
    ------
    InputError
        The record has too few turns, lines above fs/2, or two lines closer than one bin.
    """
    turns = abs(rate) * seconds
    if turns < TURNS:
        need = (
            f"{TURNS / abs(rate):.3g} s, or a higher speed of mirror or casing"
            if rate
            else "a turning mirror or casing"
        )
        raise InputError(f"the record is too short: found {turns:.2f} turns of the spot, expected {TURNS} ({need})")
    freq = line_frequencies(tones, n, rate, runout)
    if freq.max() >= 0.5 * fs:
        found, most = f"found a line at {freq.max():.2f} Hz", f"fs/2 = {0.5 * fs:g} Hz"
        raise InputError(f"{found}, expected all below {most}: fit lower orders")
    low, high, gap = closest(freq)
    if gap * seconds >= RESOLVED:
        return
    one, other = (name(k, tones, n) for k in sorted((low, high)))
    better = clear_rate(tones, n, rate, seconds, fs, runout)
    help_ = f"turn at {better:.4g} turns/s" if better else "excite fewer tones at a time, or search for fewer orders"
    raise InputError(
        f"lines cannot be separated: {one} and {other} are {gap:.3g} Hz apart at {freq[low]:.3f} Hz, "
        f"a record of {seconds:g} s resolves {RESOLVED / seconds:.3g} Hz: {help_}"
    )


def name(line: int, tones: Sequence[float], n: IntArray) -> str:
    """Description of a line."""
    if line >= len(tones) * len(n):
        return f"the run-out's harmonic {line - len(tones) * len(n)}"
    order = int(n[line % len(n)])
    return f"n = {abs(order)} of {tones[line // len(n)]:.3f} Hz ({'+' if order >= 0 else '-'}nW)"


class LineFit(NamedTuple):
    """Complex amplitudes of lines, their uncertainty, the noise floor near them, (lines,), and the residual.

    `left` is the residual's rms over that of white noise with the residual's median spectrum: 1 if only noise remains,
    more if there are lines that were not fitted.
    """

    amplitude: Array
    sigma: FloatArray
    floor: FloatArray
    left: float


def fit_lines(record: ScanRecord, omega: FloatArray, order: FloatArray) -> LineFit:
    """Fit lines e^(i (omega t + n theta)) to the velocity."""
    G, b = np.zeros((2 * len(omega),) * 2), np.zeros(2 * len(omega))
    for part, waves in columns(record, omega, order):
        G += waves.T @ waves
        b += waves.T @ record.velocity[part]
    live = np.diag(G) > 1e-9 * G.max()  # the imaginary part of a constant is nothing
    correlations = G[np.ix_(live, live)] / np.sqrt(np.multiply.outer(np.diag(G)[live], np.diag(G)[live]))
    least = float(np.linalg.eigvalsh(correlations)[0])
    if least < APART:
        help_ = "a longer one, fewer orders"
        raise InputError(f"the record does not distinguish its lines (least eigenvalue {least:.1e}): {help_}")
    factor = cho_factor(G[np.ix_(live, live)])
    x, variance = np.zeros(len(b)), np.zeros(len(b))
    x[live] = cho_solve(factor, b[live])
    variance[live] = np.diag(cho_solve(factor, np.eye(int(live.sum()))))
    residual = record.velocity.copy()
    for part, waves in columns(record, omega, order):
        residual[part] -= waves @ x
    power = white_level(residual)
    level = noise_beside(power, len(residual), record.fs, np.abs(omega / (2.0 * np.pi) + order * record.rate))
    real, imag = x.reshape(2, -1)
    sigma = np.sqrt(level * variance.reshape(2, -1).max(axis=0))
    left = float(np.sqrt(np.mean(residual**2) * np.log(2.0) / max(float(np.median(power)), 1e-300)))
    return LineFit(real + 1j * imag, sigma, np.sqrt(2.0 * level / len(residual)), left)  # count/2 bins share it


def columns(record: ScanRecord, omega: FloatArray, order: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
    """Blocks of the record, each with Re and -Im of e^(i (omega t + n theta)), (samples, 2 lines)."""
    for start in range(0, len(record.velocity), BLOCK):
        part = slice(start, min(start + BLOCK, len(record.velocity)))
        time = np.arange(part.start, part.stop) / record.fs
        phase = np.multiply.outer(time, omega) + np.multiply.outer(record.angle[part], order)
        yield part, np.hstack([np.cos(phase), -np.sin(phase)])


def white_level(residual: FloatArray) -> FloatArray:
    """Power spectrum (Hann), scaled so that white noise has its variance, (count/2 + 1,)."""
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(len(residual)) / len(residual))
    return np.asarray(np.abs(np.fft.rfft(residual * window)) ** 2 / np.sum(window**2))


def noise_beside(power: FloatArray, count: int, fs: float, freq: FloatArray) -> FloatArray:
    """Variance of white noise as strong as the residual around each line, (lines,).

    The median of the spectrum around the line is used, which ignores other lines.
    """
    centre = np.rint(freq * count / fs).astype(np.int64)
    away = np.arange(BESIDE[0], BESIDE[1] + 1)
    bins = np.clip(centre[:, None] + np.r_[-away[::-1], away], 1, len(power) - 1)
    return np.asarray(np.median(power[bins], axis=1) / np.log(2.0))
