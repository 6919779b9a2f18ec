"""How the split vector of a doublet turns: the phase 2 n psi of its lower member as a reading of its shape.

With the ring amplitudes c of the lower member at n, 2 n psi = -arg(sum c^2) and d(2 n psi) = -2 Im(sum c dc/sum c^2),
linear in the change of the shape. Two parts of that change: the partner's, which grows as the split goes to zero but
stays finite times the split, and that of all other modes, by the adjoint of the reading (`modal.adjoint`).
"""

from collections.abc import Sequence

import numpy as np

from casingfem.experiment.correlation.matches import Match
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.harmonics import DOUBLE, orientation
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.structure.mesh.place import ring_transform


def lower_phase(modes: ModeSet, low: int, high: int, n: int) -> float:
    """2 n psi [rad] of the lower member's antinode; 0 for a perfect pair, which has none."""
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
    """How 2 n psi of the lower member changes by a unit share of its partner [rad]."""
    c, partner = radial_amplitudes(modes, low, n), radial_amplitudes(modes, high, n)
    return float(-2.0 * np.imag(np.sum(c * partner) / np.sum(c**2)))
