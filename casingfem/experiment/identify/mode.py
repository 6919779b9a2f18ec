"""From fitted poles to modes: shape, nodal diameters, orientation, partner, and what could have been missed.

The residues of one mode over sensors o and references i are phi_o phi_i, of rank one. Their first singular vectors are
the shape and the references' share; a second singular value above the noise shows that one pole stands for two modes
of the same frequency.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.circle.orientation import Circle, Label, quadrature
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.counting import asked
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray

NOWHERE = float("nan")
TWO = 0.1  # least ratio of the singular values of residues that are two shapes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mode:
    """One mode, or a pair that is not resolved; see `Identified` for the names.

    `double` says that the residues over several references are those of two shapes.
    """

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
    double: bool
    doubt: str = ""
    unresolved: bool = False


class Shape(NamedTuple):
    """Real shape of unit norm at the sensors, its covariance, the share of energy in phase, and whether it is two."""

    values: FloatArray
    covariance: FloatArray
    collinearity: float
    double: bool


class Sensors(NamedTuple):
    """Sensors of a test, the power of j omega of its responses, their circle and those used for labels."""

    grid: SensorGrid
    power: int
    circle: Circle | None
    labelled: IntArray

    @classmethod
    def of(cls, grid: SensorGrid, power: int, circle: Circle | None, kept: IntArray | None = None) -> Sensors:
        """All sensors, or those that are kept for labels."""
        return cls(grid, power, circle, np.arange(len(grid)) if kept is None else kept)


class Residues(NamedTuple):
    """Residues of 1/(s - p) at all channels, and their noise.

    `values` (channels,) complex; `direct` (channels,) the variance of the real part that each channel has alone;
    `moved` (channels, numbers) complex what independent numbers of unit variance, those of the poles, do to them.
    """

    values: Array
    direct: FloatArray
    moved: Array


class Found(NamedTuple):
    """A pole before its shape is known: frequency [Hz] and damping with uncertainties, residues, peak, bound."""

    freq: float
    sigma_freq: float
    zeta: float
    sigma_zeta: float
    residues: Residues
    signal: float
    split_bound: float


def found_in(fit: PoleFit, noise: FloatArray, rules: Thresholds = USUAL) -> list[Found]:
    """The poles of a fit, of channels of that noise (channels,)."""
    spread = np.sqrt(np.tile(fit.noise, 2))
    values, vectors = np.linalg.eigh(fit.covariance * np.outer(spread, spread))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    found = []
    for k, pole in enumerate(fit.poles.tolist()):
        omega, size = abs(pole), -pole.real * noise
        followed = -fit.tilt[k][:, None] * np.concatenate([fit.A, fit.A])
        direct = fit.noise[k] * float(fit.gram[k, k].real) * size**2
        residues = Residues(fit.A[k] * size, direct, size[:, None] * (followed.T @ root))
        by_freq, by_zeta = fit.sigma[:, k].tolist()
        zeta = -pole.real / omega
        found.append(
            Found(omega / (2.0 * np.pi), -pole.real * by_freq / (2.0 * np.pi), zeta, zeta * by_zeta, residues,
                  float(fit.peaks[k]), hidden_split(fit, k, rules))
        )  # fmt: skip
    return found


def mode_of(found: Found, sensors: Sensors) -> Mode:
    """A mode with shape, nodal diameters and orientation."""
    grid = sensors.grid
    shape = _shape(found.residues, grid.channels)
    label = Label(-1, *[NOWHERE] * 3)
    if sensors.circle is not None:
        signs = radial_signs(grid)
        seen = np.intersect1d(sensors.labelled, np.flatnonzero(np.any(found.residues.values[grid.channels], axis=1)))
        circle = sensors.circle
        if len(seen) < len(sensors.labelled):  # a mode that only some set-ups show
            circle = Circle.of(grid.theta[seen], max(circle.n_max, 0))
        covariance = (shape.covariance * np.outer(signs, signs))[np.ix_(seen, seen)]
        label = circle.label((shape.values * signs)[seen], covariance)
    omega = 2.0 * np.pi * found.freq
    pole = omega * (-found.zeta + 1j * np.sqrt(1.0 - found.zeta**2))
    unit = 2j * pole.imag * (omega / pole) ** sensors.power / omega**2
    return Mode(
        freq=found.freq, sigma_freq=found.sigma_freq, zeta=found.zeta, sigma_zeta=found.sigma_zeta, n=label.n,
        purity=label.purity, angle=label.angle, sigma_angle=label.sigma, shape=shape.values,
        sigma_shape=np.sqrt(np.diag(shape.covariance)), residues=(found.residues.values * unit)[grid.channels],
        residue_scale=found.freq, collinearity=shape.collinearity, signal=found.signal,
        split_bound=found.split_bound, double=shape.double,
    )  # fmt: skip


def hidden_split(fit: PoleFit, k: int, rules: Thresholds = USUAL) -> float:
    """Largest relative split of a pole into two of the same shape that the data would not show.

    Two poles d apart differ from one at their middle by (d/2)^2 times the second derivative of a resonance, of squares
    (d/2 sigma)^4 times those of its peak; below the fall of the sum of squares that is asked for, they look like one.
    """
    gain = float(fit.gains()[k]) + 1e-300
    share = float(fit.noise[k]) * asked(fit.window.Y.shape[1], rules) / gain
    return float(2.0 * -fit.poles[k].real * share**0.25 / abs(fit.poles[k]))


def _shape(residues: Residues, channels: IntArray) -> Shape:
    """Shape from residues; `channels` (sensors, references) has the channel of each."""
    matrix = residues.values[channels]
    u, sizes, v = np.linalg.svd(matrix, full_matrices=False)
    turn = np.exp(-0.5j * np.angle(np.sum(u[:, 0] ** 2)))
    factor = v[0].conj() * turn / (sizes[0] + 1e-300)
    whole = matrix @ factor
    factor = factor * (np.sign(whole.real[int(np.argmax(np.abs(whole.real)))]) or 1.0)
    whole = matrix @ factor
    norm = float(np.linalg.norm(whole.real)) + 1e-300
    direct = residues.direct[channels] @ np.abs(factor) ** 2
    slopes = np.einsum("orp,r->op", residues.moved[channels], factor).real
    double = False
    if len(sizes) > 1:
        size = float(np.sqrt(2.0 * np.mean(residues.direct[channels])))
        limit = size * (np.sqrt(matrix.shape[0]) + np.sqrt(matrix.shape[1]) + 3.0)
        limit += 3.0 * float(np.linalg.norm(residues.moved[channels]))
        double = bool(sizes[1] > limit and sizes[1] > TWO * sizes[0])
    energy = float(np.linalg.norm(whole)) ** 2 + 1e-300
    covariance = (np.diag(direct) + slopes @ slopes.T) / norm**2
    return Shape(whole.real / norm, covariance, norm**2 / energy, double)


def merged(fit: PoleFit, modes: list[Mode]) -> list[Mode]:
    """Put neighbours whose poles differ by no more than chance into one: a pair whose members are not resolved.

    Chance: chi-squared of the differences in frequency and damping below 25 (4.5 standard deviations).
    """
    done: list[Mode] = []
    count, k = len(modes), 0
    covariance = _covariance(fit)
    while k < count:
        if k + 1 < count and modes[k].n == modes[k + 1].n and not _distinct(fit, covariance, k):
            done.append(_one_of(fit, covariance, modes, k))
            k += 2
        else:
            done.append(modes[k])
            k += 1
    return done


def _covariance(fit: PoleFit) -> FloatArray:
    spread = np.sqrt(np.tile(fit.noise, 2))
    return np.asarray(fit.covariance * np.outer(spread, spread))


def _distinct(fit: PoleFit, covariance: FloatArray, low: int) -> bool:
    high, count = low + 1, len(fit)
    sigma = -fit.poles.real
    if fit.poles[high].imag - fit.poles[low].imag > 2.0 * max(sigma[low], sigma[high]):
        return True
    change = np.zeros((2, 2 * count))
    change[0, low], change[0, high] = -sigma[low], sigma[high]
    change[1, count + low], change[1, count + high] = -1.0, 1.0
    gap = np.array([fit.poles[high].imag - fit.poles[low].imag, np.log(sigma[high] / sigma[low])])
    return bool(gap @ np.linalg.pinv(change @ covariance @ change.T) @ gap > 25.0)


def _one_of(fit: PoleFit, covariance: FloatArray, modes: list[Mode], low: int) -> Mode:
    """The mean of two poles for a pair that is not resolved; its frequency is uncertain by half of the split."""
    both = [modes[low], modes[low + 1]]
    stronger = max(both, key=lambda mode: mode.signal)
    weights = np.array([mode.sigma_freq for mode in both]) ** -2.0
    freq = float(weights @ [mode.freq for mode in both] / weights.sum())
    zeta = float(np.mean([mode.zeta for mode in both]))
    at = [low, low + 1]
    sigma = -fit.poles.real[at] / (2.0 * np.pi)
    gap = float(np.sqrt(np.array([-1.0, 1.0]) * sigma @ covariance[np.ix_(at, at)] @ (np.array([-1.0, 1.0]) * sigma)))
    bound = (both[1].freq - both[0].freq + 2.0 * gap) / freq
    one = replace(stronger, freq=freq, zeta=zeta, sigma_freq=1.0 / float(np.sqrt(weights.sum())), split_bound=bound)
    one = replace(one, sigma_zeta=max(stronger.sigma_zeta, 0.5 * abs(both[1].zeta - both[0].zeta)))
    return replace(without_antinode(one), unresolved=True)


def without_antinode(mode: Mode) -> Mode:
    """A mode that may stand for a pair: without orientation, and uncertain by half the largest split."""
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
    """The modes, where those that show two shapes and have no partner stand for a pair.

    A mode of n >= 1 without partner may be a pair that the references drive in one plane only. It then has the antinode
    of the drive, so none is given, and its frequency is uncertain by half the split that would be hidden.
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
    """Pairs that are not resolved, and modes without a partner, in words."""
    members = {k for pair in doublets for k in pair}
    notes = []
    for k, mode in enumerate(modes):
        split = mode.split_bound * mode.freq
        if mode.unresolved:
            notes.append(
                f"pair at {mode.freq:.2f} Hz, unresolved: its split is below {split:.2g} Hz; it is given as one mode."
                " A second reference elsewhere around, or a longer record, may resolve it"
            )
        elif mode.n > 0 and k not in members:
            notes.append(
                f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the references do not drive it, or the split is"
                f" below {split:.2g} Hz; no orientation is given. A second reference elsewhere around would show it"
            )
    return tuple(notes)
