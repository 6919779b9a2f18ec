"""A reduced casing brought to its own baseline: what its pairs measured before anything was loosened or added.

Manufacture splits every pair and shifts it. Measured before, that is known: in the plane of a pair the modal stiffness
is made what the table says,

    diag(omega_1^2, omega_2^2) + D,   D = T diag(omega_1m^2, omega_2m^2) T^T - diag(omega_1^2, omega_2^2),

T the turn that gives the lower member its measured antinode. A later change then acts on the casing as it was, to
all orders, except that the couplings which manufacture makes between different n stay unknown.
"""

from dataclasses import replace

import numpy as np

from casingfem.experiment.correlation.matches import Match, Pairing, refuse_unpaired
from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.affine import AffineModel, AffineModes
from casingfem.updating.targets import HERTZ2, lower_angle


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
    """The model with the modes of a baseline table that pair with its own put in their place.

    A measured doublet without an orientation, and a single row of a computed pair, move the mean alone.

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
    """The modes of a match, its partner included, and what to add to their modal stiffness."""
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
