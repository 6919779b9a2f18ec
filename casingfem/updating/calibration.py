"""Match a reduced casing to its baseline: the pairs measured before bolts were loosened or masses added.

Manufacturing splits and shifts every pair. If this was measured before, the modal stiffness in the plane of a pair is
set to the values of the table,

    diag(omega_1^2, omega_2^2) + D,   D = T diag(omega_1m^2, omega_2m^2) T^T - diag(omega_1^2, omega_2^2),

where the rotation T gives the lower member its measured antinode. A later change then acts on the casing as it was, to
all orders, except for the unknown couplings between different n.

Faults mix shapes: a mode that is half n = 5 and half n = 8 may have different labels in test and model. So rows are
assigned to modes by the least total of |log(f/f_m)|/0.05 + 1 - share, with the share of a mode's circumferential energy
at the row's n: a wrong n costs as much as 5 % in frequency.
"""

from dataclasses import replace

import numpy as np

from casingfem.experiment.correlation.frequency_unit import refuse_unpaired
from casingfem.experiment.correlation.matches import Match, Pairing
from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.linalg.assignment import assignment
from casingfem.modal.affine import AffineModel, AffineModes
from casingfem.modal.harmonics import quadrature
from casingfem.modal.mode_set import ModeSet
from casingfem.updating.targets import HERTZ2, lower_angle

WRONG = 0.05  # relative frequency error that costs as much as another n
QUARTER = 0.5  # least quadrature at n of the members of a doublet


def paired_baseline(model: AffineModel, baseline: FrequencyTable, *, reach: float = 0.2) -> tuple[AffineModes, Pairing]:
    """The model's modes, unchanged, and the rows of a baseline table that pair with them.

    Raises
    ------
    InputError
        If no row pairs.
    """
    found = model.modes(np.zeros(model.changes), len(model.nominal))
    pairing = pair(found, baseline, reach=reach)
    if not pairing.matches:
        refuse_unpaired(baseline, found.freq, found.nodal_diameters, reach)
    return found, pairing


def calibrated(model: AffineModel, baseline: FrequencyTable, *, reach: float = 0.2) -> AffineModel:
    """The model with the measured modes of a baseline table in place of the modes with which they pair.

    A measured doublet without an orientation, and a single row of a computed pair, change only the mean.

    Raises
    ------
    InputError
        If no row pairs.
    """
    found, pairing = paired_baseline(model, baseline, reach=reach)
    K = model.K.copy()
    for match in pairing.matches:
        modes, block = correction(found, baseline, match)
        y = model.M @ found.coordinates[:, modes]
        K += y @ block @ y.T
    return replace(model, K=0.5 * (K + K.T))


def correction(found: AffineModes, baseline: FrequencyTable, match: Match) -> tuple[list[int], FloatArray]:
    """The modes of a match, including a partner, and the correction of their modal stiffness."""
    own = found.doublet_of(match.modes[0])
    modes = list(match.modes) if own < 0 else list(found.doublets[own])
    computed = found.omega[modes] ** 2
    measured = HERTZ2 * baseline.freq_hz[list(match.rows)] ** 2
    if len(modes) == 2 and len(match.rows) == 2:
        n = int(found.nodal_diameters[modes[0]])
        angle = lower_angle(baseline.angle_deg[list(match.rows)], n)
        if np.isfinite(angle):
            T = turned_to(found, modes, n, np.radians(angle))
            return modes, T @ np.diag(measured) @ T.T - np.diag(computed)
    shift = measured.mean() - computed[[modes.index(mode) for mode in match.modes]].mean()
    return modes, np.asarray(shift * np.eye(len(modes)))


def turned_to(found: AffineModes, modes: list[int], n: int, angle: float) -> FloatArray:
    """Rotation (2, 2) of a pair whose first column has an antinode at an angle [rad].

    The members' radial amplitudes at n are a_k e^(-i n psi_k); on the strongest ring, real combinations of the two
    reach any antinode.
    """
    assert found.rings is not None
    radial = found.rings.amplitudes[n, :, 0][:, modes]
    strongest = radial[np.abs(radial).sum(axis=1).argmax()]
    parts = np.array([strongest.real, strongest.imag])
    first = np.linalg.solve(parts, [np.cos(n * angle), -np.sin(n * angle)])
    first /= np.linalg.norm(first)
    return np.array([[first[0], -first[1]], [first[1], first[0]]])


def paired_by_shares(found: ModeSet, table: FrequencyTable, reach: float) -> tuple[list[Match], list[int]]:
    """Matches in ascending order, with doublets if both sides have them, and the rows without a mode within reach."""
    assert found.rings is not None
    shares = found.rings.shares()
    known = (table.n >= 0) & (table.n < len(shares))
    like = np.where(known[:, None], shares[np.minimum(np.maximum(table.n, 0), len(shares) - 1)], 0.0)
    error = np.abs(np.log(table.freq_hz[:, None] / np.maximum(found.freq, 1e-9)))
    error[:, : found.rigid] = np.inf
    cost = np.where(error <= np.log1p(reach), error / WRONG - like, 1e3)
    rows, modes = assignment(cost)
    mode_of = {int(row): int(mode) for row, mode in zip(rows, modes, strict=True) if cost[row, mode] < 1e3}
    matches: list[Match] = []
    for group in table.groups():
        there = sorted((row for row in group.rows if row in mode_of), key=lambda row: mode_of[row])
        whole = len(there) == 2 and quadrature(*(found.rings.profile(mode_of[row], group.n) for row in there)) > QUARTER
        ordered = sorted(there, key=lambda row: float(table.freq_hz[row]))
        planes = [(ordered, [mode_of[row] for row in there])] if whole else [([row], [mode_of[row]]) for row in there]
        matches += [match_of(found, table, rows, modes, group.n) for rows, modes in planes]
    return matches, sorted(set(range(len(table))) - set(mode_of))


def match_of(found: ModeSet, table: FrequencyTable, rows: list[int], modes: list[int], n: int) -> Match:
    """Match of rows and modes, each in ascending order."""
    return Match(
        rows=tuple(rows),
        modes=tuple(modes),
        n=n,
        confidence=float("nan"),
        measured_hz=tuple(float(table.freq_hz[row]) for row in rows),
        computed_hz=tuple(float(found.freq[mode]) for mode in modes),
    )
