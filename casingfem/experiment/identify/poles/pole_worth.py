"""What a pole is worth: what it takes from the deviation against the noise about it, and what tells a narrow one."""

from __future__ import annotations

import numpy as np

from casingfem.experiment.identify.poles.pole_fit import PoleFit, fit_poles
from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.io.arrays import Array, FloatArray

NARROW = 1.0  # lines in a half-power bandwidth, below which skirts tell a peak, nothing its damping
SKIRT = 1.5, 3  # lines from a narrow pole, where its skirts begin; lines of a skirt on either side at least
BESIDE, WIDE = 2, 3  # lines from a narrow pole to its peak; lines of half the peak's power, that no narrow one has
LOCAL = 5.0, 12  # about a pole: half-power half-widths, lines at least


def penalty(window: Window) -> float:
    """Fall of the sum of squares, in units of the noise, that a pole must bring."""
    return float((window.Y.shape[1] * window.columns + 2) * np.log(window.Y.size))


def gains(fit: PoleFit) -> FloatArray:
    """Rise of the sum of squares, in units of the noise there, if a pole were left out and the others stayed."""
    each = range(len(fit.freq))
    rise = [np.einsum("sc,st,tc->", fit.A[k], np.linalg.inv(fit.gram[k, :, k, :]), fit.A[k]) for k in each]
    return np.array([rise[k] / noise_at(fit, k) / alike_lines(fit, k) for k in each], float)


def lines_of(fit: PoleFit) -> FloatArray:
    """Lines in the half-power bandwidth of each pole."""
    return np.asarray(2.0 * fit.zeta * fit.freq / float(fit.window.freq[1] - fit.window.freq[0]))


def has_skirts(fit: PoleFit, pole: int) -> bool:
    """Whether a pole explains, beyond the lines next to it, more than its penalty: hum or a wrong line does not."""
    window, step = fit.window, float(fit.window.freq[1] - fit.window.freq[0])
    kept = np.abs(window.freq - fit.freq[pole]) > SKIRT[0] * step
    above = int(np.sum(window.freq[kept] > fit.freq[pole]))
    if min(above, int(kept.sum()) - above) < SKIRT[1]:
        return False
    return bool(gains(fit_poles(window.cut(kept), fit.freq, fit.zeta, steps=0))[pole] > penalty(window))


def lines_high(fit: PoleFit, pole: int) -> int:
    """Lines next to each other about a pole on which the data have half the power of their highest, or more."""
    power = np.sum(np.abs(fit.window.as_complex) ** 2, axis=1)
    at = int(np.abs(fit.window.freq - fit.freq[pole]).argmin())
    low = max(at - BESIDE, 0)
    top = low + int(power[low : at + BESIDE + 1].argmax())
    below = np.flatnonzero(power < 0.5 * power[top])
    ends = np.r_[-1, below, len(power)]
    k = int(np.searchsorted(ends, top))
    return int(ends[k] - ends[k - 1] - 1)


def cut_off(fit: PoleFit, pole: int) -> tuple[float, float]:
    """Standard deviations of ln f and zeta as the record ends before the mode does.

    Of a mode's ring exp(-pi B/step) is left at the end of a record 1/step long, B its half-power bandwidth; without it
    one only knows that the peak lies between two lines, and that B is below their distance; or, where more lines are as
    high, that noise on them hides it.
    """
    ratio, lines = float(fit.window.freq[1] - fit.window.freq[0]) / fit.freq[pole], lines_of(fit)[pole]
    left = float(np.exp(-np.pi * lines))
    high = lines_high(fit, pole) if lines < NARROW else 1
    return float(ratio * left / np.sqrt(12.0)), float(0.5 * ratio * left * (high if high >= WIDE else 1))


def near(fit: PoleFit, pole: int) -> Array:
    """The deviation about a pole, (lines, channels)."""
    lines = fit.window.freq
    at = int(np.searchsorted(lines, fit.freq[pole]))
    width = max(LOCAL[1], int(LOCAL[0] * fit.zeta[pole] * fit.freq[pole] / (lines[1] - lines[0])))
    return np.asarray(fit.spread[max(at - width, 0) : at + width])


def noise_at(fit: PoleFit, pole: int) -> float:
    """Variance of an entry about a pole: noise of estimated responses is larger on peaks than on average."""
    about = near(fit, pole)
    return max(fit.noise, 0.5 * float(np.mean(np.abs(about) ** 2)) if about.size else 0.0)


def alike_lines(fit: PoleFit, pole: int) -> float:
    """Over how many lines the deviation about a pole is alike: 1 for white noise, more for what the model lacks.

    1 + 2 sum_l (1 - l/L) rho_l with the autocorrelation rho over the lines, up to L = a half-power bandwidth.
    """
    about, step = near(fit, pole), float(fit.window.freq[1] - fit.window.freq[0])
    most = min(int(2.0 * fit.zeta[pole] * fit.freq[pole] / step), len(about) // 3)
    whole = float(np.sum(np.abs(about) ** 2))
    if most < 2 or whole == 0.0:
        return 1.0
    spectrum = np.fft.fft(about, 2 * len(about), axis=0)  # so long that no lag comes round the end
    rho = np.fft.ifft(np.sum(spectrum.real**2 + spectrum.imag**2, axis=1)).real[1:most] / whole
    return max(1.0, 1.0 + 2.0 * float(np.sum((1.0 - np.arange(1, most) / most) * rho)))
