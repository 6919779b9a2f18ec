"""Pairs of modes, and pairs that are not resolved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from casingfem.experiment.circle.orientation import quadrature
from casingfem.experiment.identify.mode import NOWHERE, Mode
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.io.arrays import FloatArray

HALF = 0.5  # bandwidths within which two modes may be one; assurance above which shapes are similar
MANY = 8  # channels from which on shapes are compared
SAME = 2.0  # standard deviations within which two frequencies do not differ
ALIKE = 25.0  # largest chi-squared of differences of fitted poles by chance: 4.5 standard deviations


def neighbours(n: Sequence[int], chi: Sequence[float], most: float) -> list[tuple[int, ...]]:
    """Group neighbouring modes: two form a group if they have one n and their poles differ by no more than chance.

    `chi` (modes - 1,) is chi-squared of the differences in frequency and damping; `most` is the largest value that
    chance explains.
    """
    done, k = list[tuple[int, ...]](), 0
    while k < len(n):
        two = k + 1 < len(n) and n[k] == n[k + 1] and chi[k] <= most
        done.append((k, k + 1) if two else (k,))
        k += len(done[-1])
    return done


def merged(fit: PoleFit, modes: list[Mode]) -> list[Mode]:
    """Merge the modes of a fit whose difference is not resolved."""
    spread = np.sqrt(np.tile(fit.noise, 2))
    covariance = fit.covariance * np.outer(spread, spread)
    differences = [_difference(fit, covariance, k) for k in range(len(modes) - 1)]
    groups = neighbours([mode.n for mode in modes], [chi for chi, _ in differences], ALIKE)
    return [modes[k[0]] if len(k) == 1 else one_of([modes[i] for i in k], differences[k[0]][1]) for k in groups]


def _difference(fit: PoleFit, covariance: FloatArray, low: int) -> tuple[float, float]:
    """Chi-squared between a pole and the next one, and the standard deviation [Hz] of their frequency difference."""
    high, count = low + 1, len(fit)
    sigma = -fit.poles.real
    change = np.zeros((2, 2 * count))
    change[0, low], change[0, high] = -sigma[low], sigma[high]
    change[1, count + low], change[1, count + high] = -1.0, 1.0
    gap = np.array([fit.poles[high].imag - fit.poles[low].imag, np.log(sigma[high] / sigma[low])])
    both = change @ covariance @ change.T
    far = gap[0] > 2.0 * max(sigma[low], sigma[high])
    chi = np.inf if far else float(gap @ np.linalg.pinv(both) @ gap)
    return chi, float(np.sqrt(both[0, 0])) / (2.0 * np.pi)


def one_of(both: list[Mode], gap: float) -> Mode:
    """Mean of two modes that are not resolved as a pair; `gap` [Hz] is the deviation of their difference.

    Half of the split is added to the uncertainty of its frequency.
    """
    stronger = max(both, key=lambda mode: mode.signal)
    weights = np.array([mode.sigma_freq for mode in both]) ** -2.0
    freq = float(weights @ [mode.freq for mode in both] / weights.sum())
    zeta = float(np.mean([mode.zeta for mode in both]))
    bound = (both[1].freq - both[0].freq + 2.0 * gap) / freq
    one = replace(stronger, freq=freq, zeta=zeta, sigma_freq=1.0 / float(np.sqrt(weights.sum())), split_bound=bound)
    one = replace(one, sigma_zeta=max(stronger.sigma_zeta, 0.5 * abs(both[1].zeta - both[0].zeta)))
    return replace(without_antinode(one), unresolved=True)


def without_antinode(mode: Mode) -> Mode:
    """Remove the orientation of a mode that may represent a pair, and add half the largest split to its uncertainty."""
    sigma = float(np.hypot(mode.sigma_freq, 0.5 * mode.split_bound * mode.freq))
    return replace(mode, sigma_freq=sigma, angle=NOWHERE, sigma_angle=NOWHERE)


def paired(modes: list[Mode], span: float = 0.3, apart: float = 0.7) -> tuple[tuple[int, int], ...]:
    """Doublets (lower, upper): neighbours of the same n a quarter wave apart, of a relative split below `span`."""
    pairs, taken = [], set[int]()
    for k, mode in enumerate(modes):
        if k in taken or mode.n < 1 or mode.unresolved:
            continue
        later = (m for m in range(k + 1, len(modes)) if m not in taken and not modes[m].unresolved)
        partner = next((m for m in later if modes[m].n == mode.n), None)
        if partner is None or modes[partner].freq - mode.freq > span * mode.freq:
            continue
        if quadrature(mode.angle, modes[partner].angle, mode.n) > apart:
            pairs.append((k, partner))
            taken |= {k, partner}
    return tuple(pairs)


def settled(modes: list[Mode], doublets: tuple[tuple[int, int], ...]) -> list[Mode]:
    """Mark modes that show two shapes and have no partner as unresolved pairs.

    A mode of n >= 1 without partner may be a pair that the references drive in one plane only. Its antinode is then
    that of the drive, so no antinode is given. Half the largest hidden split is added to the uncertainty of its
    frequency.
    """
    members = {k for pair in doublets for k in pair}
    done = []
    for k, mode in enumerate(modes):
        if k in members or mode.unresolved or (mode.n < 1 and not mode.double):
            done.append(mode)
        else:
            done.append(replace(without_antinode(mode), unresolved=mode.double))
    return done


def pair_notes(modes: list[Mode], doublets: tuple[tuple[int, int], ...]) -> tuple[str, ...]:
    """Describe unresolved pairs and modes without a partner."""
    members = {k for pair in doublets for k in pair}
    alone = [mode for k, mode in enumerate(modes) if mode.n > 0 and k not in members and not mode.unresolved]
    return (
        *unresolved_notes(modes, "a second reference elsewhere around, or a longer record, may resolve it"),
        *(
            f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the references do not drive it, or the split is below"
            f" {mode.split_bound * mode.freq:.2g} Hz; no orientation is given. A second reference elsewhere around"
            " would show it"
            for mode in alone
        ),
    )


def unresolved_notes(modes: list[Mode], remedy: str) -> tuple[str, ...]:
    """Notes on unresolved pairs, and measurements that may resolve them."""
    return tuple(
        f"pair at {mode.freq:.2f} Hz, unresolved: its split is below {mode.split_bound * mode.freq:.2g} Hz; it is given"
        f" as one mode; {remedy}"
        for mode in modes
        if mode.unresolved
    )


def without_twins(modes: list[Mode]) -> list[Mode]:
    """Mark the weaker of two modes (ascending) within half a bandwidth that may be one resonance as doubtful.

    A resonance leaves two poles if its peak moves from hit to hit, or if it is not linear. The shapes of the two poles
    are then similar, or their frequencies do not differ. Shapes of normal modes are nearly orthogonal at many sensors:
    of random shapes at 8 sensors 3 % have an assurance above 0.5. On a circle modes may have one frequency.
    """
    done = list(modes)
    for k, one in enumerate(modes):
        for j in range(k + 1, len(modes)):
            other = modes[j]
            gap = other.freq - one.freq
            if gap > HALF * 2.0 * min(one.zeta * one.freq, other.zeta * other.freq):
                break
            weaker, at = min((k, other), (j, one), key=lambda m: (not modes[m[0]].reason, modes[m[0]].signal))
            alike = len(one.shape) >= MANY and float(one.shape @ other.shape) ** 2 > HALF
            same = gap < SAME * float(np.hypot(one.sigma_freq, other.sigma_freq))
            if not done[weaker].reason and (alike or same):
                what = "shape" if alike else "frequency within its uncertainty"
                text = (
                    f"its {what} is that of the stronger mode at {at.freq:.2f} Hz beside it: one mode that differs from"
                    " hit to hit or with the force? Check for loose parts or level, or add a reference"
                )
                done[weaker] = replace(done[weaker], reason=text)
    return done
