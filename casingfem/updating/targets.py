"""Residuals between paired modes and a frequency table, and their derivatives, each over its standard deviation.

A single mode gives (f_c - f_m)/sigma. A doublet gives the mean, f = sqrt((f1^2 + f2^2)/2), and the split vector

    d = (f2^2 - f1^2)/(2 f) (cos 2 n psi, sin 2 n psi),  psi the antinode of the lower member,

because f1 and f2 themselves are not differentiable at zero split, while d is linear in the 2n harmonics that split the
pair. A table without angles gives the length of d only.

The split vector turns with the phase 2 n psi: with the ring amplitudes c of the lower member at n, 2 n psi = -arg(sum
c^2) and d(2 n psi) = -2 Im(sum c dc/sum c^2), linear in the change of the shape. That change has two parts. The
partner's part grows as the split goes to zero, but its product with the split is finite. The part of all other modes
follows from the adjoint of the reading (`modal.adjoint`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.adjoint import adjoint_space
from casingfem.modal.harmonics import DOUBLE, orientation
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.modal.neighbour import Solution
from casingfem.structure.mesh.place import ring_transform
from casingfem.updating.parameters import Parameter
from casingfem.updating.sensitivity import product_derivatives

HERTZ2 = 4.0 * np.pi**2  # rad^2/s^2 per Hz^2


def pair_state(f1: float, f2: float) -> tuple[float, float]:
    """Mean frequency and split [Hz] of a pair: root mean square, and difference of squares over twice the mean."""
    mean = float(np.sqrt(0.5 * (f1**2 + f2**2)))
    return mean, (f2**2 - f1**2) / (2.0 * mean)


def split_vector(split: float, phase: float) -> FloatArray:
    """The split as a vector in the plane of the phase 2 n psi."""
    return split * np.array([np.cos(phase), np.sin(phase)])


def lower_angle(angles: FloatArray, n: int) -> float:
    """Antinode of the lower member [deg] from the angles of (lower, upper), one of which may be nan.

    The upper member's antinodes lie a quarter wave, 90/n deg, from the lower's.
    """
    low, high = angles
    return float(low) if np.isfinite(low) else float(high) - 90.0 / n


def lower_phase(modes: ModeSet, low: int, high: int, n: int) -> float:
    """2 n psi [rad] of the lower member's antinode; 0 for a perfect pair, which has no antinode."""
    if modes.rings is None or modes.freq[high] - modes.freq[low] <= DOUBLE * modes.freq[high]:
        return 0.0
    return 2.0 * n * orientation(modes.rings.profile(low, n), n)


def radial_amplitudes(modes: ModeSet, mode: int, n: int) -> Array:
    """Radial amplitudes of one mode at n on each ring, times the root of the ring's weight, (rings,) complex."""
    if modes.rings is None:
        raise ValueError("an open shell has no doublets")
    return np.asarray(modes.rings.amplitudes[n, :, 0, mode] * np.sqrt(modes.rings.weights))


def phase_load(modes: Modes, low: int, n: int, rings: IntArray, transform: Array) -> FloatArray:
    """The reading d(2 n psi) of a change of the lower member, as a nodal load (nodes, 5); see `ring_transform`."""
    c = radial_amplitudes(modes, low, n)
    assert modes.rings is not None
    share = -2.0 * np.imag((c * np.sqrt(modes.rings.weights) / np.sum(c**2))[:, None] * transform[n])
    load = np.zeros(modes.fields.shape[:2])
    theta = modes.grid.nodes[1, rings]
    load[rings, 0], load[rings, 1] = share * np.cos(theta), share * np.sin(theta)
    return load


def phase_loads(modes: Modes, matches: Sequence[Match]) -> FloatArray:
    """The readings of several doublets, (nodes, 5, doublets)."""
    rings, transform = ring_transform(modes.shell.chart, modes.grid, max(match.n for match in matches))
    return np.stack([phase_load(modes, match.modes[0], match.n, rings, transform) for match in matches], axis=2)


def partner_turn(modes: ModeSet, low: int, high: int, n: int) -> float:
    """Change of 2 n psi of the lower member by a unit share of its partner [rad]."""
    c, partner = radial_amplitudes(modes, low, n), radial_amplitudes(modes, high, n)
    return float(-2.0 * np.imag(np.sum(c * partner) / np.sum(c**2)))


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Derivatives of modes with respect to the parameters.

    Attributes
    ----------
    G
        phi_i^T (K_p - omega_i^2 M_p) phi_j, (parameters, modes, modes) [rad^2/s^2 per unit].
    turning
        For each doublet with a measured angle, by its modes: change of the phase 2 n psi of the lower member due to all
        modes except its partner, (parameters,) [rad per unit].
    """

    G: FloatArray
    turning: Mapping[tuple[int, ...], FloatArray]


def is_doublet(match: Match) -> bool:
    """Whether a match is of two rows with two modes."""
    return len(match.rows) == 2 and len(match.modes) == 2


def has_angle(match: Match, table: FrequencyTable) -> bool:
    """Whether a match is a doublet with a measured orientation."""
    return is_doublet(match) and bool(np.isfinite(table.angle_deg[list(match.rows)]).any())


def residual_count(match: Match, table: FrequencyTable) -> int:
    """Number of residuals of a match: 1, or 2 to 3 of a doublet."""
    return 1 if not is_doublet(match) else 3 if has_angle(match, table) else 2


def rates(
    modes: Modes | MeshModes,
    solution: Solution | None,
    vary: Sequence[Parameter],
    table: FrequencyTable,
    matches: Sequence[Match],
) -> Rates:
    """Derivatives that all residuals need, from one evaluation of the energies for each parameter.

    Without a solution pairs are taken as perfect: only the partner changes their orientation.
    """
    turned = [match for match in matches if has_angle(match, table)]
    if not turned or solution is None:
        K, M = product_derivatives(modes, vary, modes.fields, getattr(modes, "own", None))
        still = np.zeros(len(vary))
        return Rates(G=K - modes.omega[:, None] ** 2 * M, turning={match.modes: still for match in turned})
    assert not isinstance(modes, MeshModes)  # which have no solution to start from
    space = adjoint_space(solution, phase_loads(modes, turned))
    adjoints = np.stack([space.weights(k, match.modes[0], match.modes) for k, match in enumerate(turned)], axis=1)
    fields = np.concatenate([modes.fields, space.fields @ adjoints], axis=2)
    K, M = product_derivatives(modes, vary, fields, np.concatenate([modes.own, space.own @ adjoints], axis=1))
    G = K - np.append(modes.omega, np.zeros(len(turned)))[:, None] ** 2 * M
    count = len(modes)
    turning = {}
    for k, match in enumerate(turned):
        low = match.modes[0]
        turning[match.modes] = K[:, count + k, low] - modes.omega[low] ** 2 * M[:, count + k, low]
    return Rates(G=G[:, :count, :count], turning=turning)


def doublet_values(modes: ModeSet, table: FrequencyTable, match: Match) -> FloatArray:
    """Mean and split vector (or its length) of a doublet, over their standard deviations."""
    rows, (low, high) = list(match.rows), match.modes
    mean, split = pair_state(modes.freq[low], modes.freq[high])
    measured_mean, measured_split = pair_state(*table.freq_hz[rows])
    sigma = float(np.hypot(*table.sigma_hz[rows]))
    angle = lower_angle(table.angle_deg[rows], match.n)
    if not np.isfinite(angle):
        gap = np.array([split - measured_split])
    else:
        measured = split_vector(measured_split, 2.0 * match.n * np.radians(angle))
        gap = split_vector(split, lower_phase(modes, low, high, match.n)) - measured
    return np.append((mean - measured_mean) / (sigma / 2.0), gap / sigma)


def doublet_jacobian(modes: ModeSet, table: FrequencyTable, match: Match, at: Rates) -> FloatArray:
    """Derivatives of `doublet_values`, (2 or 3, parameters).

    Along the split vector the derivative is the difference of the members' rates. Across it the derivative is the split
    times the rate of the phase. The partner's part of the latter is G_12, without a division by the split.
    """
    low, high = match.modes
    mean, split = pair_state(modes.freq[low], modes.freq[high])
    sigma = float(np.hypot(*table.sigma_hz[list(match.rows)]))
    squares = np.stack([at.G[:, low, low], at.G[:, high, high]]) / HERTZ2  # d(f1^2), d(f2^2)
    mean_rate = squares.mean(axis=0) / (2.0 * mean)
    along = (squares[1] - squares[0] - 2.0 * split * mean_rate) / (2.0 * mean)
    if match.modes not in at.turning:
        return np.stack([mean_rate / (sigma / 2.0), along / sigma])
    partner = -at.G[:, low, high] / HERTZ2 * partner_turn(modes, low, high, match.n)
    across = partner / (2.0 * mean) + split * at.turning[match.modes]
    phase = lower_phase(modes, low, high, match.n)
    turn = np.array([[np.cos(phase), -np.sin(phase)], [np.sin(phase), np.cos(phase)]])
    return np.vstack([mean_rate / (sigma / 2.0), turn @ np.stack([along, across]) / sigma])


def values(modes: ModeSet, table: FrequencyTable, matches: Sequence[Match]) -> FloatArray:
    """All residuals of a pairing, in the order of its matches."""
    parts = [
        doublet_values(modes, table, match)
        if is_doublet(match)
        else (modes.freq[list(match.modes)] - table.freq_hz[list(match.rows)]) / table.sigma_hz[list(match.rows)]
        for match in matches
    ]
    return np.concatenate(parts)


def jacobian(modes: ModeSet, table: FrequencyTable, matches: Sequence[Match], at: Rates) -> FloatArray:
    """Derivatives of `values`, (residuals, parameters)."""
    parts = []
    for match in matches:
        if is_doublet(match):
            parts.append(doublet_jacobian(modes, table, match, at))
        else:
            mode, sigma = match.modes[0], table.sigma_hz[match.rows[0]]
            parts.append((at.G[:, mode, mode] / (2.0 * HERTZ2 * modes.freq[mode] * sigma))[None, :])
    return np.concatenate(parts)


def with_model_error(table: FrequencyTable, model_error: float) -> FrequencyTable:
    """The table with the model's own relative error added to each sigma in squares.

    Raises
    ------
    InputError
        A sigma would then be as large as its frequency.
    """
    sigma = np.hypot(table.sigma_hz, model_error * table.freq_hz)
    large = np.flatnonzero(~(sigma < table.freq_hz))
    if large.size:
        row = int(large[0])
        raise InputError(
            "model_error",
            found=f"{model_error!r}, with which sigma_hz of row {row + 1} becomes {sigma[row]:.4g} Hz, at a frequency "
            f"of {table.freq_hz[row]:.4g} Hz",
            expected="a model_error with which each sigma_hz is below its frequency",
        )
    return replace(table, sigma_hz=sigma) if model_error else table
