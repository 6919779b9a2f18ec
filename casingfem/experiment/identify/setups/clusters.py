"""Modes near each other, alone in a window of their own: one's shifted peaks may be read as several of them."""

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
GRID = 0.25, 120  # step of the places tried, in half-power bandwidths; as many at most
SWEEPS = 3  # over the modes of a set-up, each put to the best place beside the others
APART = 0.02  # least share of a column that the others do not hold


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
        noise = max(_noise((left[: len(mine)] + 1j * left[len(mine) :]).T), floor_of(mine) ** 2, 1e-300)
        yield Cluster(modes.some(members), window, span, noise, max(MOST_SHIFTS * shift, REACH[0]))


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


def places(
    window: Window, setups: Setups, freq: FloatArray, zeta: FloatArray, most: int, span: tuple[float, float]
) -> list[FloatArray]:
    """The best frequencies (modes, setups) for 1, 2, ... `most` modes within a span [Hz], ascending in each set-up.

    Tried are places with the damping of the nearest of the given poles; they are added one by one, and each is put to
    the best place beside the others a few times.
    """
    step = GRID[0] * 2.0 * float((zeta * freq).min())
    grid = np.linspace(*span, int(np.clip((span[1] - span[0]) / step, 2 * most + 10, GRID[1])))
    nearest = np.abs(grid[:, None] - freq).argmin(axis=1)
    Q = np.linalg.qr(window.residuals())[0]
    g = _across(Q, window.values(grid, zeta[nearest]))
    R = _complex(window.Y - Q @ (Q.T @ window.Y))
    part = np.real if window.columns == 1 else np.asarray
    gram, b = part(g.conj().T @ g), part(g.conj().T @ R)
    chosen = [_chosen(gram, b[:, channels], most) for channels in setups]
    return [grid[np.array([of[m] for of in chosen]).T] for m in range(most)]


def best_beside(
    window: Window, setups: Setups, freq: FloatArray, zeta: FloatArray, damping: float, span: tuple[float, float]
) -> tuple[float, float]:
    """The frequency [Hz] in a span of one more mode of a damping ratio beside modes (modes, setups), (modes,).

    And by how much the sum of squares then falls.
    """
    step = GRID[0] * 2.0 * damping * span[0]
    grid = np.linspace(*span, int(np.clip((span[1] - span[0]) / step, 10, GRID[1])))
    g, data = window.values(grid, np.full(len(grid), damping)), window.as_complex
    polynomials = _complex(window.residuals()[:, :: window.columns])
    size, gain = np.sum(np.abs(g) ** 2, axis=0), np.zeros(len(grid))
    for own, channels in zip(freq.T, setups, strict=True):
        Q = np.linalg.qr(np.concatenate([window.values(own, zeta), polynomials], axis=1))[0]
        across = g - Q @ (Q.conj().T @ g)
        rest = data[:, channels] - Q @ (Q.conj().T @ data[:, channels])
        left = np.maximum(np.sum(np.abs(across) ** 2, axis=0), APART * size)
        gain += np.sum(np.abs(across.conj().T @ rest) ** 2, axis=1) / left
    k = int(gain.argmax())
    return float(grid[k]), float(gain[k])


def _chosen(gram: Array, b: Array, most: int) -> list[list[int]]:
    """Columns that take most from the deviation: the best one, the best two, ... each ascending."""
    found, kept = list[list[int]](), list[int]()
    for _ in range(most):
        kept = [*kept, _best(gram, b, kept)]
        for _ in range(SWEEPS if len(kept) > 1 else 0):
            before = sorted(kept)
            for _ in range(len(kept)):
                kept = [*kept[1:], _best(gram, b, kept[1:])]
            if sorted(kept) == before:
                break
        found.append(sorted(kept))
    return found


def _best(gram: Array, b: Array, beside: list[int]) -> int:
    """The column that takes most beside others."""
    size = np.diag(gram).real
    left, rest = size.copy(), b
    if beside:
        solved = np.linalg.solve(gram[np.ix_(beside, beside)] + 1e-9 * size.max() * np.eye(len(beside)),
                                 np.concatenate([gram[beside], b[beside]], axis=1))  # fmt: skip
        left = size - np.einsum("ij,ij->j", gram[beside].conj(), solved[:, : len(size)]).real
        rest = b - gram[:, beside] @ solved[:, len(size) :]
    gain = np.sum(np.abs(rest) ** 2, axis=1) / np.maximum(left, APART * size)
    gain[beside] = 0.0
    return int(gain.argmax())


def _complex(stacked: FloatArray) -> Array:
    """Real parts over imaginary ones, as complex numbers."""
    half = len(stacked) // 2
    return np.asarray(stacked[:half] + 1j * stacked[half:])


def _across(Q: FloatArray, g: Array) -> Array:
    """Columns without what the basis Q (2 lines, terms) holds."""
    stacked = np.concatenate([g.real, g.imag])
    return _complex(stacked - Q @ (Q.T @ stacked))
