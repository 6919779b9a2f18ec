"""Residuals between paired modes and a frequency table, and their derivatives.

A single mode gives (f_c - f_m)/sigma. A doublet gives the mean, f = sqrt((f1^2 + f2^2)/2), and the split vector

    d = (f2^2 - f1^2)/(2 f) (cos 2 n psi, sin 2 n psi),  psi the antinode of the lower member,

because f1 and f2 themselves have a cone at zero split, while d is linear in the 2n harmonics of whatever
splits the pair. A table without angles gives the length of d only.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from casingfem.arrays import FloatArray
from casingfem.experiment.correlation import Match
from casingfem.experiment.measurement import FrequencyTable
from casingfem.modal.mode_set import Modes

HERTZ2 = 4.0 * np.pi**2  # rad^2/s^2 per Hz^2


@dataclass(frozen=True, slots=True, eq=False)
class Residual:
    """Some weighted residuals of one match and their derivatives: (rows,) and (rows, parameters)."""

    values: FloatArray
    jacobian: FloatArray


def pair_state(f1: float, f2: float) -> tuple[float, float]:
    """Mean frequency and split [Hz] of a pair: sqrt of the mean square, and difference of squares over 2 mean."""
    mean = float(np.sqrt(0.5 * (f1**2 + f2**2)))
    return mean, (f2**2 - f1**2) / (2.0 * mean)


def split_vector(split: float, n: int, angle_deg: float) -> FloatArray:
    """The split as a vector in the plane of 2 n psi; psi = 0 where there is no angle (no split either)."""
    phase = 2.0 * n * np.radians(angle_deg) if np.isfinite(angle_deg) else 0.0
    return split * np.array([np.cos(phase), np.sin(phase)])


def lower_angle(angles: FloatArray, n: int) -> float:
    """Antinode of the lower member [deg] from the angles of (lower, upper), either of which may be nan.

    The upper member's antinodes lie a quarter wave, 90/n deg, from the lower's.
    """
    low, high = angles
    return float(low) if np.isfinite(low) else float(high) - 90.0 / n


def turning(modes: Modes, low: int, high: int, G: FloatArray) -> FloatArray:
    """How the split vector turns: (f2^2 - f1^2) d(2 n psi)/dp [Hz^2 per unit], (parameters,).

    With the ring amplitudes c of the lower member, 2 n psi = -arg(sum c^2), and its shape changes by
    sum_j phi_j G_1j/(omega_1^2 - omega_j^2) over the computed modes; the partner's share stays finite as the
    split goes to zero.
    """
    if modes.rings is None:
        raise ValueError("an open shell has no doublets")
    n = int(modes.nodal_diameters[low])
    radial = modes.rings.amplitudes[n, :, 0] * np.sqrt(modes.rings.weights)[:, None]
    eigenvalues = modes.omega**2
    split = (eigenvalues[high] - eigenvalues[low]) / HERTZ2
    others = np.delete(np.arange(len(modes)), [low, high])
    share = np.zeros((len(G), len(modes)))
    share[:, high] = -G[:, low, high] / HERTZ2
    share[:, others] = split * G[:, low, others] / (eigenvalues[low] - eigenvalues[others])
    change = share @ (radial.T @ radial[:, low])
    return np.asarray(-2.0 * np.imag(change / np.sum(radial[:, low] ** 2)))


def single_residual(modes: Modes, table: FrequencyTable, match: Match, G: FloatArray) -> Residual:
    """(f_c - f_m)/sigma of one row and one mode."""
    row, mode = match.rows[0], match.modes[0]
    f, sigma = modes.freq[mode], table.sigma_hz[row]
    return Residual(
        values=np.array([(f - table.freq_hz[row]) / sigma]),
        jacobian=(G[:, mode, mode] / (2.0 * HERTZ2 * f * sigma))[None, :],
    )


def doublet_residual(modes: Modes, table: FrequencyTable, match: Match, G: FloatArray) -> Residual:
    """Mean and split vector (or its length) of a doublet, over their standard deviations."""
    rows, (low, high) = list(match.rows), match.modes
    n = int(modes.nodal_diameters[low])
    mean_c, split_c = pair_state(modes.freq[low], modes.freq[high])
    mean_m, split_m = pair_state(*table.freq_hz[rows])
    sigma = float(np.hypot(*table.sigma_hz[rows]))

    squares = np.stack([G[:, low, low], G[:, high, high]]) / HERTZ2  # d(f1^2), d(f2^2)
    mean_rate = squares.mean(axis=0) / (2.0 * mean_c)
    rate = np.stack([squares[1] - squares[0], turning(modes, low, high, G)])  # along the vector, across it
    rate = (rate - np.outer([split_c, 0.0], 2.0 * mean_rate)) / (2.0 * mean_c)
    angle = modes.angle_deg[low]
    phase = 2.0 * n * np.radians(angle) if np.isfinite(angle) else 0.0
    turn = np.array([[np.cos(phase), -np.sin(phase)], [np.sin(phase), np.cos(phase)]])

    values, jacobian = [(mean_c - mean_m) / (sigma / 2.0)], [mean_rate / (sigma / 2.0)]
    measured_angle = lower_angle(table.angle_deg[rows], n)
    if np.isfinite(measured_angle):
        gap = split_vector(split_c, n, angle) - split_vector(split_m, n, measured_angle)
        values += list(gap / sigma)
        jacobian += list((turn @ rate) / sigma)
    else:
        values.append((split_c - split_m) / sigma)
        jacobian.append(rate[0] / sigma)
    return Residual(values=np.array(values), jacobian=np.array(jacobian))


def residuals(
    modes: Modes, table: FrequencyTable, matches: Sequence[Match], G: FloatArray, model_error: float = 0.0
) -> Residual:
    """All residuals of a pairing, in the order of its matches.

    `model_error` is what the model itself may be off by, relative; it adds to each sigma in squares.
    """
    if model_error > 0.0:
        table = replace(table, sigma_hz=np.hypot(table.sigma_hz, model_error * table.freq_hz))
    parts = [
        (doublet_residual if len(match.rows) == 2 and len(match.modes) == 2 else single_residual)(
            modes, table, match, G
        )
        for match in matches
    ]
    return Residual(
        values=np.concatenate([part.values for part in parts]),
        jacobian=np.concatenate([part.jacobian for part in parts]),
    )
