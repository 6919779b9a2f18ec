"""Modes near each other, alone in a window of their own: one's shifted peaks may be read as several of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.bands import line_noise
from casingfem.experiment.identify.poles.pole_window import Window, floor_of
from casingfem.experiment.identify.setups.own_shifts import Modes, Setups
from casingfem.io.arrays import Array, FloatArray, IntArray

REACH = 2e-3, 0.5  # beyond the poles of a cluster, that peaks may lie: relative, and damping ratios
AROUND, LEAST_LINES = 8.0, 40  # damping ratios beyond that, that lines are taken from, and so many at least
TOGETHER = 14  # poles in a cluster at most
MOST_LINES, ON_PEAK = 300, 8  # that a cluster is read from; on its narrowest peak at least
LAGS = 2  # lines over which a window makes noise alike
MOST_SHIFTS = 5.0  # usual shifts, that a set-up is off the others at most
SMOOTH = 40.0  # times the noise that neighbouring lines tell: more is no noise


class Cluster(NamedTuple):
    """Modes near each other, alone in their window: `span` [Hz] they may lie in, variance of an entry by the noise.

    `apart` is the most that ln f of a set-up may be from the others'.
    """

    modes: Modes
    window: Window
    span: tuple[float, float]
    noise: float
    apart: float = np.inf

    def cost(self, squares: float, modes: int, poles: int, noise: float) -> float:
        """The criterion: squares over the noise of an entry, if that is above the cluster's; a price for each number.

        What a richer model leaves on the peaks is no less than the noise there.
        """
        numbers = modes * (self.window.columns * self.window.Y.shape[1] + poles)
        return float(squares / max(noise, self.noise) + np.log(self.window.Y.size) * numbers)


def clusters(
    whole: Window,
    modes: Modes,
    setups: Setups,
    most_lines: int = MOST_LINES,
    beyond: tuple[float, float] = REACH,
    shift: float = np.inf,
) -> Iterator[Cluster]:
    """Modes so near each other that one's shifted peaks may be several of them, without all others.

    Of many lines every so many are taken, as long as the narrowest peak keeps enough. `shift` is what set-ups usually
    differ by in ln f.
    """
    modes = modes.some(np.argsort(modes.freq.min(axis=1)))
    low, high = modes.freq.min(axis=1), np.maximum.accumulate(modes.freq.max(axis=1))
    reach = (beyond[0] + beyond[1] * modes.zeta) * low
    cuts = np.flatnonzero(low[1:] - high[:-1] > reach[1:] + reach[:-1]) + 1
    rest = whole.as_complex - modes.response(whole, setups)
    step = float(whole.freq[1] - whole.freq[0])
    near = np.split(np.arange(len(low)), cuts)
    for members in (part for each in near for part in _few_each(each, low)):
        zeta = modes.zeta[members].max()
        span = float((low - reach)[members].min()), float((modes.freq.max(axis=1) + reach)[members].max())
        a, b = np.searchsorted(whole.freq, [span[0] * (1.0 - AROUND * zeta), span[1] * (1.0 + AROUND * zeta)]).tolist()
        a = max(min(a, b - LEAST_LINES, len(whole.freq) - LEAST_LINES), 0)
        b = min(max(b, a + LEAST_LINES), len(whole.freq))
        narrowest = 2.0 * float((modes.zeta * low)[members].min()) / step
        stride = max(1, int(min((b - a) / most_lines, narrowest / ON_PEAK)))
        lines = slice(a, b, stride)
        bare = whole.cut(lines)
        mine = rest[lines] + modes.some(members).response(bare, setups)
        window = replace(bare, Y=np.concatenate([mine.real, mine.imag]))
        left = np.concatenate([rest[lines].real, rest[lines].imag])
        Q = np.linalg.qr(window.residuals())[0]
        left -= Q @ (Q.T @ left)
        noise = _noise((left[: len(mine)] + 1j * left[len(mine) :]).T)
        yield Cluster(
            modes.some(members),
            window,
            span,
            max(noise, floor_of(mine) ** 2, 1e-300),
            max(MOST_SHIFTS * shift, REACH[0]),
        )


def _few_each(members: IntArray, freq: FloatArray) -> list[IntArray]:
    """Modes near each other in parts of no more than so many, cut at the widest gap that leaves both sides some."""
    if len(members) <= TOGETHER:
        return [members]
    edge = TOGETHER // 4
    cut = edge + 1 + int(np.argmax(np.diff(freq[members])[edge:-edge]))
    return _few_each(members[:cut], freq) + _few_each(members[cut:], freq)


def _noise(rest: Array) -> float:
    """Variance of an entry, from what is left (channels, lines), times the number of lines over which that is alike.

    What modes not yet found leave counts as noise, too, up to a limit: it falls when they are.
    """
    whole = float(np.sum(np.abs(rest) ** 2))
    if whole == 0.0:
        return 0.0
    alike = [float(np.sum((rest[:, k:] * rest[:, :-k].conj()).real)) / whole for k in range(1, LAGS + 1)]
    many = 1.0 + 2.0 * sum((1.0 - k / (LAGS + 1.0)) * rho for k, rho in enumerate(alike, start=1))
    rough = float(np.mean(line_noise(rest) ** 2))
    return max(rough, min(0.5 * whole / rest.size * max(many, 1.0), SMOOTH * rough))
