"""Turn fitted poles into modes: shape, nodal diameters, orientation, partner, smallest detectable split.

The residues of one mode over sensors o and references i are phi_o phi_i, of rank one. Their first singular vectors are
the shape and the references' share; a second singular value above the noise shows that one pole represents two modes
of the same frequency.
"""

from __future__ import annotations

from collections.abc import Sequence
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
ALIKE = 25.0  # largest chi-squared of differences of fitted poles by chance: 4.5 standard deviations
TWO = 0.1  # least ratio of singular values of residues that contain two shapes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mode:
    """One mode, or an unresolved pair; see `Identified` for the names.

    `double` is True if the residues over several references contain two shapes. The covariance of the shape is
    diag(direct) + moved moved^T, (sensors,) and (sensors, numbers).
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
    direct: FloatArray
    moved: FloatArray
    residues: Array
    residue_scale: float
    collinearity: float
    signal: float
    split_bound: float
    double: bool
    reason: str = ""
    unresolved: bool = False

    @property
    def sigma_shape(self) -> FloatArray:
        """Standard deviation of the shape at each sensor, (sensors,)."""
        return np.asarray(np.sqrt(self.direct + np.sum(self.moved**2, axis=1)))


class Shape(NamedTuple):
    """Real shape of unit norm at the sensors, its errors (see `Mode`), its share in phase, and whether it is double."""

    values: FloatArray
    direct: FloatArray
    moved: FloatArray
    collinearity: float
    double: bool


class Sensors(NamedTuple):
    """Sensors of a test, the power of j omega of its responses, the circle, and the sensors used for labels."""

    grid: SensorGrid
    power: int
    circle: Circle | None
    labelled: IntArray

    @classmethod
    def of(cls, grid: SensorGrid, power: int, circle: Circle | None, kept: IntArray | None = None) -> Sensors:
        """All sensors, or those that are used for labels."""
        return cls(grid, power, circle, np.arange(len(grid)) if kept is None else kept)

    def seeing(self, residues: Array) -> tuple[IntArray, Circle]:
        """Sensors that label a mode with these residues (sensors, references), and their circle.

        Some set-ups may lack the mode; their sensors are left out.
        """
        assert self.circle is not None
        seen = np.intersect1d(self.labelled, np.flatnonzero(np.any(residues, axis=1)))
        if len(seen) == len(self.labelled):
            return seen, self.circle
        return seen, Circle.of(self.grid.theta[seen], max(self.circle.n_max, 0))


class Residues(NamedTuple):
    """Residues of 1/(s - p) at all channels, and their noise.

    `values` (channels,) complex; `direct` (channels,) is the variance of the real part, independent between channels;
    `moved` (channels, numbers), complex, is the change of the residues by independent errors of the poles, each of unit
    variance.
    """

    values: Array
    direct: FloatArray
    moved: Array


class Found(NamedTuple):
    """A pole before its shape is known.

    Frequency [Hz] and damping with uncertainties, residues, peak, bound of a split.
    """

    freq: float
    sigma_freq: float
    zeta: float
    sigma_zeta: float
    residues: Residues
    signal: float
    split_bound: float


def found_in(fit: PoleFit, noise: FloatArray, rules: Thresholds = USUAL) -> list[Found]:
    """The poles of a fit whose channels have this noise (channels,)."""
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
    """Compute the shape, nodal diameters and orientation of a mode."""
    grid = sensors.grid
    shape = _shape(found.residues, grid.channels)
    values = found.residues.values[grid.channels]
    label = Label(-1, NOWHERE, NOWHERE)
    if sensors.circle is not None:
        seen, circle = sensors.seeing(values)
        label = circle.label((shape.values * radial_signs(grid))[seen])
    omega = 2.0 * np.pi * found.freq
    pole = omega * (-found.zeta + 1j * np.sqrt(1.0 - found.zeta**2))
    unit = 2j * pole.imag * (omega / pole) ** sensors.power / omega**2
    return Mode(
        freq=found.freq, sigma_freq=found.sigma_freq, zeta=found.zeta, sigma_zeta=found.sigma_zeta, n=label.n,
        purity=label.purity, angle=label.angle, sigma_angle=NOWHERE, shape=shape.values, direct=shape.direct,
        moved=shape.moved, residues=values * unit, residue_scale=found.freq, collinearity=shape.collinearity,
        signal=found.signal, split_bound=found.split_bound, double=shape.double,
    )  # fmt: skip


def hidden_split(fit: PoleFit, k: int, rules: Thresholds = USUAL) -> float:
    """Largest relative split of a pole into two of the same shape that the data would not show.

    Two poles d apart differ from one at their middle by (d/2)^2 times the second derivative of a resonance, of squares
    (d/2 sigma)^4 times those of its peak; they cannot be distinguished from one pole if this is below the required
    decrease of the sum of squares.
    """
    gain = float(fit.gains()[k]) + 1e-300
    share = float(fit.noise[k]) * asked(fit.window.Y.shape[1], rules) / gain
    return float(2.0 * -fit.poles[k].real * share**0.25 / abs(fit.poles[k]))


def _shape(residues: Residues, channels: IntArray) -> Shape:
    """Compute a shape from residues; `channels` (sensors, references) has the channel number of each."""
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
    return Shape(whole.real / norm, direct / norm**2, slopes / norm, norm**2 / energy, double)


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
