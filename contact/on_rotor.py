"""Results of a rotor: motion of the disk, angle, orbit, forces of bearings and mounts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.model.gaps.rub import Rub, rub_of
from contact.model.gaps.rub_system import matrices_of
from contact.model.rotor.rotor import Rotor
from contact.record.orbit import Orbit, orbit_of_states
from contact.result import Result


def rotor_motion(rub: Rub, result: Result) -> Array:
    """Motion of the disk along x and y, (ns, 2) [m]; zero without a rotor."""
    if rub.rotor is None:
        return np.zeros((len(result.state), 2))
    return np.asarray(result.state_of("rotor") @ rub.rotor.plane.T)


def rotor_turned(rub: Rub, result: Result) -> Array:
    """Angle turned by a rotor at the stored times, from x to y, (ns,) [rad]."""
    return -rub.turned(result.state_time, result.state_of("casing"))


def rotor_orbit(what: object, result: Result) -> Orbit | None:
    """Orbit at the end of the run of a rotor in a casing; None for other problems, or without states."""
    rub: Rub | None = rub_of(what)
    if rub is None or rub.rotor is None or result.channels.size or len(result.state) < 3:
        return None
    angle, disk = rotor_turned(rub, result), rotor_motion(rub, result) @ np.array([1.0, 1j])
    hz = np.gradient(angle, result.state_time, edge_order=2) / (2.0 * math.pi)
    return orbit_of_states(result.state_time, disk, angle, hz, rub.rotor.unbalance.after)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RotorHistory:
    """A rotor at the stored times `time` (ns,): its speed (ns,), vectors along x and y (ns, 2).

    `disk` and `casing` [m]: the motion of the disk, and the mean motion of the casing's first line as a rigid ring,
    None without a casing. `bearings` and `mounts` [N] as in `support_forces`, None without a casing or where a basis
    has no participation.
    """

    time: Array
    speed_hz: Array
    disk: Array
    casing: Array | None
    bearings: Array | None
    mounts: Array | None


def rotor_history(what: object, result: Result) -> RotorHistory | None:
    """Speed and motion of a rotor, in a casing support forces too; None for other problems, or without states.

    >>> import contact as ct
    >>> scene = ct.load_scene("data/scenes/blade_off/rigid.toml")
    >>> result = ct.run(scene, t_end=1e-3, record=ct.Record(every=10, state_every=10))
    >>> rotor_history(scene.what, result).disk.shape
    (10, 2)
    """
    if isinstance(what, Rotor) and len(result.state) >= 3:
        return RotorHistory(
            time=result.state_time, speed_hz=np.interp(result.state_time, what.speed.time, what.speed.hz),
            disk=np.asarray(result.state @ what.plane.T), casing=None, bearings=None, mounts=None,
        )  # fmt: skip
    rub: Rub | None = rub_of(what)
    if rub is None or rub.rotor is None or result.channels.size or len(result.state) < 3:
        return None
    turned = rotor_turned(rub, result)
    q = result.state_of("casing")[:, : rub.flexible]
    n = 2 * rub.casing.n_max + 1
    rows = rub.casing.rows.reshape(-1, n, rub.casing.omega.size)[:, :, : rub.flexible]
    cos, sin = rows[0, [1, n // 2 + 1]], rows[1, [1, n // 2 + 1]]
    ring = 0.5 * np.stack([q @ (cos[0] - sin[1]), q @ (cos[1] + sin[0])], axis=1)
    known = rub.casing.participation is not None
    forces = support_forces(rub, result) if known else {"bearings": None, "mounts": None}
    return RotorHistory(
        time=result.state_time, speed_hz=np.gradient(turned, result.state_time, edge_order=2) / (2.0 * math.pi),
        disk=rotor_motion(rub, result), casing=ring, **forces,
    )  # fmt: skip


def support_forces(rub: Rub, result: Result) -> dict[str, Array]:
    """Forces of all bearings on the rotor and of all mounts on the casing, along x and y, (ns, 2) [N] each.

    F = -r^T (K q + C q'), r = Phi^T M e the participation of the modes: the forces of springs and dampers to the
    ground. Velocities are differences of the stored states, which should therefore be only a few steps apart. Raises
    InputError for a basis without participation and results without states.

    >>> import contact as ct
    >>> disk = ct.rotor.Jeffcott(mass=10.0, stiffness=4e6)
    >>> rotor = ct.rotor.Rotor.of(disk, 10.0, displacement=[0.01, 0.0])
    >>> casing = ct.rotor.rigid_casing(radius=0.25, mass=20.0, stiffness=2e8)
    >>> rub = ct.rotor.rotor_rub(rotor, casing, [ct.rotor.rigid_tip()], clearance=0.02)
    >>> result = ct.run(rub, t_end=1e-2, dt=1e-4, record=ct.Record(state_every=1))
    >>> ct.recovery.support_forces(rub, result)["bearings"][0].round(1).tolist()  # -k x, x = 0.01/sqrt(10)
    [-12649.1, 0.0]
    """
    if rub.casing.participation is None:
        raise InputError("participation: found none in the bases of rotor and casing, expected one in each")
    if result.channels.size or len(result.state) < 3:
        raise InputError("state: found none in the result, expected a record with state_every")
    C, K = matrices_of(rub).at(float(rub.speed.omega(0.0)))
    m, q = rub.casing.omega.size, result.state_of("casing")
    v = np.gradient(q, result.state_time, axis=0, edge_order=2)
    force = -(q @ K[:m, :m].T + v @ (0.5 * (C + C.T))[:m, :m])
    r = np.asarray(rub.casing.participation)[:2]
    own = slice(rub.flexible, m)
    return {"bearings": force[:, own] @ r[:, own].T, "mounts": force[:, : rub.flexible] @ r[:, : rub.flexible].T}
