"""Displacements of rubbing bodies from modal coordinates: kept modes plus residual compliance.

u = rows q + S F at the channels and u = recovery q + recovery_S F elsewhere, F the forces on the channels:
on the casing force h(phi) radially and -s mu force h(phi) along theta, on the blade force (-n + s mu t), with
s the sense of rotation. Without the S term the rim and the tip are wrong where it matters, at the contact.
"""

from __future__ import annotations

import math

import numpy as np

from contact.errors import InputError
from contact.model.arrays import Array
from contact.model.gap import RotatingRim
from contact.model.law import Law, Unilateral, friction
from contact.model.modal_body import ModalBody
from contact.model.trig import harmonics
from contact.result import Result


def channel_forces(rim: RotatingRim, result: Result, *, law: Law | None = None) -> tuple[Array, Array]:
    """Forces on the channels of casing (ns, 2(2N+1)) and blade (ns, K) at `result.state_time`."""
    pull = math.copysign(friction(law or Unilateral()), rim.speed) if rim.speed else 0.0
    force = result.state_force()[:, :1]
    phi = math.radians(rim.angle_deg) - rim.speed * result.state_time
    waves = np.array([harmonics(rim.casing.n_max, float(angle)) for angle in phi])
    casing = force * np.concatenate([waves, -pull * waves], axis=1)
    a, blade = math.radians(rim.lean_deg), np.zeros(len(rim.blade.channels))
    blade[rim.blade.channel("span")] = -math.cos(a) - pull * math.sin(a)
    blade[rim.blade.channel("flap")] = -math.sin(a) + pull * math.cos(a)
    return casing, force * blade


def at_channels(body: ModalBody, q: Array, forces: Array) -> Array:
    """Displacement of the channels, (ns, K) [m], from modal coordinates (ns, m) and channel forces (ns, K)."""
    return np.asarray(q @ body.rows.T + forces @ body.S.T)


def at_points(body: ModalBody, q: Array, forces: Array) -> Array:
    """Displacement in the rows of `recovery`, (ns, R) [m]; raises InputError when the basis has none."""
    if body.recovery is None:
        raise InputError("recovery: found none in this basis, expected rows for the points wanted")
    kept = np.asarray(q @ body.recovery.T)
    return kept if body.recovery_S is None else kept + forces @ body.recovery_S.T
