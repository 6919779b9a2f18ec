"""From fitted poles to modes: those of each band's core, once, labelled, paired, with what could have been missed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from casingfem.arrays import Array, FloatArray
from casingfem.experiment.circle import Circle, Label, quadrature
from casingfem.experiment.mode_shapes import mode_shape, residue_matrix
from casingfem.experiment.pole_fit import PoleFit
from casingfem.experiment.pole_selection import hidden_split
from casingfem.experiment.sensor_grid import SensorGrid

PAIR_SPAN = 0.3  # relative split beyond which two modes of one n are no pair
APART = 0.7  # least quadrature of partners
CHANCE = 25.0  # chi-squared, two degrees of freedom, below which two poles are not told apart


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FoundMode:
    """One mode, or a pair that is not resolved; see `Identified` for the names."""

    freq: float
    sigma_freq: float
    zeta: float
    sigma_zeta: float
    n: int
    purity: float
    angle: float
    sigma_angle: float
    shape: FloatArray
    sigma_shape: FloatArray
    residues: Array
    residue_scale: float
    collinearity: float
    signal: float
    split_bound: float
    unresolved: bool


def found_modes(
    fits: list[PoleFit],
    cores: list[tuple[float, float]],
    grid: SensorGrid,
    signs: FloatArray,
    circle: Circle | None,
) -> list[FoundMode]:
    """Modes of all bands, ascending; one that two bands found beside their common edge counts once."""
    modes: list[FoundMode] = []
    for fit, (low, high) in zip(fits, cores, strict=True):
        here = [_mode(fit, pole, grid, signs, circle) for pole in range(len(fit.freq))]
        here = _merged(fit, here)
        inside = [mode for mode in here if low <= mode.freq < high]
        modes += [mode for mode in inside if not (modes and _same(modes[-1], mode))]
    return sorted(modes, key=lambda mode: mode.freq)


def _same(first: FoundMode, second: FoundMode) -> bool:
    """Whether two bands found one mode."""
    near = abs(first.freq - second.freq) < 0.5 * first.zeta * first.freq
    return near and abs(float(first.shape @ second.shape)) > 0.9


def _mode(fit: PoleFit, pole: int, grid: SensorGrid, signs: FloatArray, circle: Circle | None) -> FoundMode:
    shape = mode_shape(fit, pole, grid.channels)
    sigma = np.sqrt(fit.noise * np.diag(fit.covariance))
    freq, zeta = float(fit.freq[pole]), float(fit.zeta[pole])
    label = Label(-1, *[float("nan")] * 3)
    if circle is not None:
        label = circle.label(shape.values * signs, shape.covariance * np.outer(signs, signs))
    peak = np.linalg.norm(fit.A[pole]) / (2.0 * zeta) * (freq / fit.window.scale) ** fit.window.power
    unresolved = shape.second > 1.0
    bound = hidden_split(fit, pole) / (shape.balance if unresolved else 1.0)
    return FoundMode(
        freq=freq,
        sigma_freq=freq * float(np.hypot(sigma[pole], 0.5 * bound if unresolved else 0.0)),
        zeta=zeta,
        sigma_zeta=float(sigma[len(fit.freq) + pole] * zeta),
        n=label.n,
        purity=label.purity,
        angle=float("nan") if unresolved else label.angle,
        sigma_angle=float("nan") if unresolved else label.sigma,
        shape=shape.values,
        sigma_shape=np.sqrt(np.diag(shape.covariance)),
        residues=residue_matrix(fit, pole, grid.channels),
        residue_scale=fit.window.scale,
        collinearity=shape.collinearity,
        signal=float(peak / np.sqrt(2.0 * fit.noise * fit.A.shape[2])),
        split_bound=bound,
        unresolved=unresolved,
    )


def _merged(fit: PoleFit, modes: list[FoundMode]) -> list[FoundMode]:
    """Put neighbours whose poles differ by no more than chance into one: a pair is there, its members are not told."""
    told: list[FoundMode] = []
    last = -2
    for k, mode in enumerate(modes):
        if k and last != k - 1 and mode.n == modes[k - 1].n and not _distinct(fit, k - 1, k):
            told[-1] = _one_of(fit, modes, k - 1, k)
            last = k
        else:
            told.append(mode)
    return told


def _distinct(fit: PoleFit, low: int, high: int) -> bool:
    """Whether two poles differ in frequency or damping by more than chance allows."""
    if fit.freq[high] - fit.freq[low] > 2.0 * max(fit.zeta[low], fit.zeta[high]) * fit.freq[low]:
        return True
    m = len(fit.freq)
    change = np.zeros((2, 2 * m))
    change[[0, 1], [low, m + low]], change[[0, 1], [high, m + high]] = -1.0, 1.0
    gap = change @ np.log(np.r_[fit.freq, fit.zeta])
    covariance = fit.noise * change @ fit.covariance @ change.T
    return bool(gap @ np.linalg.solve(covariance, gap) > CHANCE)


def _one_of(fit: PoleFit, modes: list[FoundMode], low: int, high: int) -> FoundMode:
    """The best common pole of two, by their covariance; its uncertainty holds half the largest split."""
    m = len(fit.freq)
    values = []
    for at, logs in (([low, high], np.log(fit.freq)), ([m + low, m + high], np.log(fit.zeta))):
        covariance = fit.noise * fit.covariance[np.ix_(at, at)]
        weights = np.linalg.solve(covariance, np.ones(2))
        gap = np.sqrt(np.array([-1.0, 1.0]) @ covariance @ np.array([-1.0, 1.0]))
        values.append((float(np.exp(weights @ logs[[low, high]] / weights.sum())), 1.0 / np.sqrt(weights.sum()), gap))
    (freq, sigma, gap), (zeta, sigma_zeta, _) = values
    bound = float(np.log(fit.freq[high] / fit.freq[low]) + 2.0 * gap)
    stronger = modes[low] if modes[low].signal > modes[high].signal else modes[high]
    return replace(
        stronger,
        freq=freq,
        sigma_freq=float(freq * np.hypot(sigma, 0.5 * bound)),
        zeta=zeta,
        sigma_zeta=float(zeta * sigma_zeta),
        angle=float("nan"),
        sigma_angle=float("nan"),
        split_bound=bound,
        unresolved=True,
    )


def paired(modes: list[FoundMode]) -> tuple[tuple[tuple[int, int], ...], tuple[int, ...]]:
    """Doublets (lower, upper) of neighbours of the same n a quarter wave apart, and unresolved pairs."""
    pairs, taken = [], set[int]()
    for k, mode in enumerate(modes):
        if k in taken or mode.n < 1 or mode.unresolved:
            continue
        others = (
            m for m in range(k + 1, len(modes)) if modes[m].n == mode.n and m not in taken and not modes[m].unresolved
        )
        partner = next(others, None)
        if partner is None or modes[partner].freq - mode.freq > PAIR_SPAN * mode.freq:
            continue
        if quadrature(mode.angle, modes[partner].angle, mode.n) > APART:
            pairs.append((k, partner))
            taken |= {k, partner}
    unresolved = tuple(k for k, mode in enumerate(modes) if k not in taken and mode.unresolved)
    return tuple(pairs), unresolved


def notes_of(
    modes: list[FoundMode], doublets: tuple[tuple[int, int], ...], unresolved: tuple[int, ...]
) -> tuple[str, ...]:
    """What cannot be told apart, in words."""
    members = {k for pair in doublets for k in pair}
    said = []
    for k, mode in enumerate(modes):
        share = mode.split_bound / (2.0 * mode.zeta)
        if k in unresolved:
            said.append(
                f"pair at {mode.freq:.2f} Hz: split below {share:.2g} of its bandwidth ({mode.split_bound:.1e}"
                " relative), given as one frequency"
            )
        elif mode.n > 0 and k not in members:
            said.append(
                f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the references do not drive it, or the split is"
                f" below {share:.2g} of its bandwidth ({mode.split_bound:.1e} relative)"
            )
    return tuple(said)
