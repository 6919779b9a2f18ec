"""Displacements of rubbing bodies from modal coordinates: kept modes plus residual compliance.

u = rows q + S F at the channels and u = recovery q + recovery_S F elsewhere, F the forces on the channels. Without the
S term the motion of rim and tip is wrong at the contact.
"""

from __future__ import annotations

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.names import hint
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.deflection import forces_by_wave
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub, rub_of
from contact.on_rotor import rotor_turned
from contact.on_rotor import support_forces as support_forces
from contact.result import Result


def at_channels(body: ModalBody, q: Array, forces: Array) -> Array:
    """Displacement of the channels, (ns, K) [m], from modal coordinates (ns, m) and channel forces (ns, K).

    >>> import contact as ct
    >>> body = ct.ModalBody(omega=[9.0], zeta=[0.0], channels=("x",), rows=[[2.0]], S=[[1e-6]])
    >>> at_channels(body, np.array([[0.5]]), np.array([[100.0]])).round(6).tolist()
    [[1.0001]]
    """
    return np.asarray(q @ body.rows.T + forces @ body.S.T)


def at_points(body: ModalBody, q: Array, forces: Array) -> Array:
    """Displacement in the rows of `recovery`, (ns, R) [m]; raises InputError if the basis has none.

    >>> import contact as ct
    >>> seen = {"channels": ("x",), "rows": [[2.0]], "S": [[0.0]]}
    >>> body = ct.ModalBody(omega=[9.0], zeta=[0.0], recovery=np.array([[3.0], [4.0], [0.0]]), **seen)
    >>> at_points(body, np.array([[0.5]]), np.array([[0.0]])).tolist()
    [[1.5, 2.0, 0.0]]
    """
    if body.recovery is None:
        raise InputError("recovery: found none in this basis, expected rows for the requested points")
    kept = np.asarray(q @ body.recovery.T)
    return kept if body.recovery_S is None else kept + forces @ body.recovery_S.T


def casing_motion(what: object, result: Result) -> Array | None:
    """Displacement of the casing's channels, (ns, K) [m]; None for problems other than rubs, or without states.

    The motion of a rotor is left out.

    >>> import contact as ct
    >>> ball = ct.PointMass(mass=2.0, x=0.01, velocity=-1.0)
    >>> result = ct.run([ct.Wall(), ball], scheme=ct.MoreauJean(), t_end=0.001, dt=1e-4)
    >>> casing_motion([ct.Wall(), ball], result) is None  # no rub
    True
    """
    rub: Rub | None = rub_of(what)
    if rub is None or len(result.state) < 2 or result.channels.size:
        return None
    q = result.state_of("casing").copy()
    q[:, rub.flexible :] = 0.0
    return at_channels(rub.casing, q, rub_forces(rub, result, "casing")[1])


def rub_forces(scene: Rub | RotatingRim, result: Result, name: str) -> tuple[Array, Array]:
    """Times (ns,) and forces on the channels of one body (ns, K), from `result.tip_force`.

    `name` is "casing", "blade" or "blade 2" as in `Rub.names`; feed them to `at_channels`, `at_points` together with
    `result.state_of(name)`. Forces on blades have the sign of -n, the direction in which a tip closes the gap.

    Raises InputError for names that the rub does not have and results without stored states.

    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": 1e-8 * np.eye(2)}
    >>> rim = ct.RotatingRim(casing, ct.ModalBody(omega=[900.0], zeta=[0.01], **seen), clearance=1e-3, speed_hz=5.0)
    >>> result = ct.run(rim, t_end=1e-3, dt=1e-4, record=ct.Record(state_every=5))
    >>> time, forces = rub_forces(rim, result, "blade")
    >>> forces.shape[1], bool(forces.any())  # no contact yet
    (2, False)
    """
    rub: Rub = rub_of(scene)
    if name not in rub.names:
        raise InputError(f"name: found {name!r}, expected one of {', '.join(rub.names)}{hint(name, rub.names)}")
    if result.channels.size:
        raise InputError(f"state: found {len(result.channels)} channels, expected a record without channels")
    forces = result.tip_force
    if not len(forces):
        raise InputError("state: found none in the result, expected a record with state_every or at")
    number, d = rub.names.index(name), forces.shape[1] // len(rub.tips)
    if not number:
        return result.state_time, forces_by_wave(rub, -rotor_turned(rub, result), forces).reshape(len(forces), -1)
    total = np.zeros((len(forces), len(rub.bodies[number].channels)))
    for j, tip in enumerate(rub.tips):
        if tip.blade == number - 1:
            total -= forces[:, j * d : (j + 1) * d] @ tip.directions(rub.bodies[number])[:d]
    return result.state_time, total
