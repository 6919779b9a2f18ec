"""Where to start: the best places of some modes on a grid of frequencies, in each set-up by itself."""

from __future__ import annotations

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.own_shifts import Setups
from casingfem.io.arrays import Array, FloatArray

GRID = 0.25, 120  # step of the places tried, in half-power bandwidths; as many at most
SWEEPS = 3  # over the modes of a set-up, each put to the best place beside the others
APART = 0.02  # least share of a column that the others do not hold


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
