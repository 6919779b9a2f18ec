"""A rub whose blades are on a flexible rotor: the rotor's modes are added to those of the casing.

A disk motion (x, y) moves the tip at phi by x cos phi + y sin phi towards the casing and by -x sin phi + y cos phi
along it. For the gap this equals the opposite motion of the casing. Its waves of one nodal diameter are

    radial cos1 = -x,   radial sin1 = -y,   tangential cos1 = -y,   tangential sin1 = x.

So the rotor's modes have rows like a rim, on all its lines, and the same contact step applies.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.body_force import BodyForce
from contact.model.gaps.rub import ContactPoint, Rub, Start, Stiffening
from contact.model.gaps.rub_laws import Closing, RimProfile
from contact.model.rotor.rotor import Rotor, Spin
from contact.model.speed import Speed

SQUARES = ("damping", "stiffness", "gyroscopic", "stiffness_by_speed")
HIGHER = ("gyroscopic_higher", "stiffness_higher")
PADDED = ("recovery", "output_rows")  # (k, m) of a casing


def rotor_rub(
    rotor: Rotor,
    casing: ModalBody,
    blades: Sequence[ModalBody],
    tips: Sequence[ContactPoint] = (ContactPoint(),),
    *,
    clearance: float = 0.0,
    profile: RimProfile | None = None,
    closing: Closing | None = None,
    thickness: float = math.inf,
    stiffening: Sequence[Stiffening] = (),
    spin: Spin | None = None,
) -> Rub:
    """Make the rub of blades on a rotor in a casing at rest.

    The tips are at their angles at t = 0 and turn with the rotor, from x to y at a positive speed. Speed, unbalance,
    gravity and motion at t = 0 are those of the rotor; gravity acts on the casing too, and on blades if each has a
    participation. Forces on the tips act on the disk at `rotor.at`. The inertia of the blades' own motion on the disk
    is left out: the disk includes the mass of the blades, and blades vibrate as on a fixed root.

    Parameters
    ----------
    rotor
        Shaft, disks and bearings; its mass includes that of the blades.
    casing
        Basis of kind rim with n_max >= 1.
    blades, tips, clearance, profile, closing, thickness, stiffening
        As in `Rub`; `rigid_tip()` is a blade that does not deform.
    spin
        Inertia and drive of a rotor whose speed follows from its torques; if left out, the speed is that of the rotor.

    Raises
    ------
    InputError
        For a casing without waves of one nodal diameter, tips with axial friction, a rotor with internal damping whose
        speed varies, a spin beside a closing gap or a speed over time, and for the errors of `Rub`.

    >>> from contact.model.rotor.jeffcott import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02), 30.0)
    >>> casing = rigid_casing(radius=0.25, mass=20.0, stiffness=2e8, zeta=0.02)
    >>> rotor_rub(rotor, casing, [rigid_tip()], clearance=1e-3).casing.omega.size
    4
    """
    if casing.kind == "rim" and casing.n_max < 1:
        raise InputError(
            f"casing: found n_max = {casing.n_max}, expected n_max >= 1, since a rotor moves the rim with n = 1"
        )
    if any(tip.axial is not None for tip in tips):
        raise InputError(
            "tips: found axial friction on a rotor, expected none, since the disk does not move along the axis"
        )
    varies = len(np.unique(rotor.speed.hz)) > 1
    if spin is not None and (varies or closing is not None or not rotor.speed.hz.any()):
        what = "a speed over time" if varies else "a closing gap" if closing is not None else "a rotor at rest"
        raise InputError(f"spin: found it with {what}, expected one initial speed other than 0 and no closing gap")
    varies = varies or spin is not None
    if rotor.internal is not None and varies:
        raise InputError("rotor: found internal damping and a speed that varies, expected one of them")
    turned = Speed(rotor.speed.time, readonly(-rotor.speed.hz))
    hanging: Literal["both", "casing"] = "both" if all(one.participation is not None for one in blades) else "casing"
    weight = replace(BodyForce.gravity(acceleration=rotor.gravity), on=hanging)
    forces = () if rotor.gravity == 0.0 else (weight,)
    rub = Rub(
        joined(casing, rotor, spin), tuple(blades), tuple(tips), clearance=clearance, speed=turned,
        profile=profile or RimProfile(), closing=closing or Closing.none(), thickness=thickness, forces=forces,
        stiffening=tuple(stiffening), rotor=rotor, spin=spin,
    )  # fmt: skip
    return _started(rub)


def _started(rub: Rub) -> Rub:
    """The rub with the rotor in its own state at t = 0."""
    from contact.model.gaps.rub_system import settled

    rotor = rub.rotor
    assert rotor is not None
    if rub.forces and rotor.settled:
        rub = settled(rub)
    given = rub.casing_start.displacement
    q = np.zeros(rub.casing.omega.size) if given is None else np.array(given)
    v, load = np.zeros(q.size), np.zeros(q.size)
    own = slice(rub.flexible, rub.flexible + rotor.body.omega.size)
    q[own] += np.asarray(rotor.displacement)
    v[own] = np.asarray(rotor.velocity)
    if rub.spin is not None:
        load[-1] = rub.spin.torque / math.sqrt(rub.spin.inertia)
    start = Start(displacement=readonly(q), velocity=readonly(v), load=readonly(load))
    return replace(rub, casing_start=start)


def joined(casing: ModalBody, rotor: Rotor, spin: Spin | None = None) -> ModalBody:
    """The modes of a casing at rest, of the rotor and of its spin, as one rim that rotates against the tips."""
    found = _with_rotor(casing, rotor)
    return found if spin is None else _with_spin(found, spin)


def rotor_of(what: object) -> Rotor | None:
    """The rotor of a problem; None without one.

    >>> rotor_of("no rotor") is None
    True
    """
    return what if isinstance(what, Rotor) else what.rotor if isinstance(what, Rub) else None


def casing_of(rub: Rub) -> ModalBody:
    """The casing of a rub without the modes of rotor and spin.

    >>> from contact.model.rotor.jeffcott import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=10.0, stiffness=4e6), 30.0)
    >>> casing = rigid_casing(radius=0.25, mass=20.0, stiffness=2e8)
    >>> casing_of(rotor_rub(rotor, casing, [rigid_tip()], clearance=1e-3, spin=Spin(inertia=0.3))).omega.size
    2
    """
    if rub.rotor is None:
        return rub.casing
    whole, m, body = rub.casing, rub.flexible, rub.rotor.body
    seen = [body.channel(f"{rub.rotor.at}.{axis}") for axis in "xy"]
    moved = _rim_motion(whole)
    parts: dict[str, Any] = {
        name: None if (part := getattr(whole, name)) is None or not part[..., :m, :m].any() else part[..., :m, :m]
        for name in (*SQUARES, *HIGHER)
    }
    parts |= {
        name: None if (rows := getattr(whole, name)) is None else rows[:, :m] for name in (*PADDED, "participation")
    }
    return replace(
        whole, omega=whole.omega[:m], zeta=whole.zeta[:m], rows=whole.rows[:, :m], spin=0.0,
        S=whole.S - moved @ body.S[np.ix_(seen, seen)] @ moved.T, **parts,
    )  # fmt: skip


def at_constant_speed(rub: Rub, hz: float) -> Rub:
    """The same rotor, blades and casing at one constant speed [turns/s] of the rotor.

    >>> from contact.model.rotor.jeffcott import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=10.0, stiffness=4e6), 30.0)
    >>> casing = rigid_casing(radius=0.25, mass=20.0, stiffness=2e8)
    >>> rub = rotor_rub(rotor, casing, [rigid_tip()], clearance=1e-3, spin=Spin(inertia=0.3))
    >>> at_constant_speed(rub, 50.0).spin, at_constant_speed(rub, 50.0).speed.hz.tolist()
    (None, [-50.0])
    """
    assert rub.rotor is not None
    return rotor_rub(
        replace(rub.rotor, speed=Speed.constant(hz)), casing_of(rub), rub.blades, rub.tips, clearance=rub.clearance,
        profile=rub.profile, closing=rub.closing, thickness=rub.thickness, stiffening=rub.stiffening,
    )  # fmt: skip


def _with_spin(casing: ModalBody, spin: Spin) -> ModalBody:
    """One more mode without stiffness, sqrt(inertia) times an angle by which the tips move along the rim."""
    m, size = casing.omega.size, 2 * casing.n_max + 1
    row = np.zeros((casing.rim_lines, casing.directions, size))
    for line in range(casing.rim_lines):
        row[line, 1, 0] = -casing.line_radius(line) / math.sqrt(spin.inertia)
    more: dict[str, Any] = {name: _beside(getattr(casing, name), None, m, 1) for name in SQUARES}
    for name in HIGHER:
        parts = getattr(casing, name)
        more[name] = None if parts is None else np.array([_beside(part, None, m, 1) for part in parts])
    for name in (*PADDED, "participation"):
        rows = getattr(casing, name)
        more[name] = None if rows is None else np.hstack([rows, np.zeros((len(rows), 1))])
    return replace(
        casing, omega=np.append(casing.omega, 0.0), zeta=np.append(casing.zeta, 0.0),
        rows=np.hstack([casing.rows, row.reshape(-1, 1)]), **more,
    )  # fmt: skip


def _with_rotor(casing: ModalBody, rotor: Rotor) -> ModalBody:
    """The modes of a casing at rest, then those of the rotor."""
    body, m, own = rotor.body, casing.omega.size, rotor.body.omega.size
    moved = _rim_motion(casing)
    seen = [body.channel(f"{rotor.at}.{axis}") for axis in "xy"]
    still = casing.matrices(0.0)[1] - np.diag(casing.omega**2)
    stiffness = np.zeros((own, own)) if body.stiffness is None else np.array(body.stiffness)
    if rotor.internal is not None:
        stiffness += rotor.speed.omega(0.0) * np.asarray(rotor.internal)
    squares: dict[str, Any] = {
        "damping": _beside(casing.damping, body.damping, m, own),
        "stiffness": _beside(still if still.any() else None, stiffness if stiffness.any() else None, m, own),
        "gyroscopic": _beside(None, body.gyroscopic, m, own),
        "stiffness_by_speed": _beside(None, body.stiffness_by_speed, m, own),
        **{
            name: None if (parts := getattr(body, name)) is None
            else np.array([_beside(None, part, m, own) for part in parts])
            for name in HIGHER
        },
    }  # fmt: skip
    padded: dict[str, Any] = {
        name: None if (rows := getattr(casing, name)) is None else np.hstack([rows, np.zeros((len(rows), own))])
        for name in PADDED
    }
    weights = [casing.participation, body.participation]
    none = any(part is None for part in weights)
    return replace(
        casing, omega=np.concatenate([casing.omega, body.omega]), zeta=np.concatenate([casing.zeta, body.zeta]),
        rows=np.hstack([casing.rows, moved @ body.rows[seen]]),
        S=casing.S + moved @ body.S[np.ix_(seen, seen)] @ moved.T, spin=body.spin,
        participation=None if none else np.hstack([np.asarray(part) for part in weights]), **squares, **padded,
    )  # fmt: skip


def _rim_motion(casing: ModalBody) -> Array:
    """Channels of a rim that moves against a disk by unit motions x and y of the disk, (channels, 2)."""
    found, N = np.zeros((len(casing.channels), 2)), casing.n_max
    blocks = found.reshape(casing.rim_lines, casing.directions, 2 * N + 1, 2)
    blocks[:, 0, 1, 0] = blocks[:, 0, N + 1, 1] = blocks[:, 1, 1, 1] = -1.0
    blocks[:, 1, N + 1, 0] = 1.0
    return found


def _beside(first: Array | None, second: Array | None, m: int, own: int) -> Array | None:
    """Two square matrices along the diagonal; None if both are."""
    if first is None and second is None:
        return None
    found = np.zeros((m + own, m + own))
    if first is not None:
        found[:m, :m] = first
    if second is not None:
        found[m:, m:] = second
    return found


def rigid_tip() -> ModalBody:
    """Make a blade that does not deform, with the channels span and flap.

    >>> rigid_tip().omega.size
    0
    """
    none = np.zeros(0)
    return ModalBody(omega=none, zeta=none, channels=("span", "flap"), rows=np.zeros((2, 0)), S=np.zeros((2, 2)))


def rigid_casing(*, radius: float, mass: float, stiffness: float, zeta: float = 0.0) -> ModalBody:
    """Make a casing that does not deform on mounts of one stiffness [N/m] in both directions of its plane.

    Raises InputError for a radius, mass or stiffness that is not positive.

    >>> casing = rigid_casing(radius=0.25, mass=20.0, stiffness=2e8)
    >>> casing.channels[:3], casing.rows[:3].round(3).tolist()
    (('radial.cos0', 'radial.cos1', 'radial.sin1'), [[0.0, 0.0], [0.224, 0.0], [0.0, 0.224]])
    """
    for name, value in (("radius", radius), ("mass", mass), ("stiffness", stiffness)):
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name}: found {value!r}, expected a positive number")
    from contact.model.bodies.channels import rim_channels

    rows = np.zeros((6, 2))
    rows[[1, 5], 0] = 1.0, -1.0
    rows[[2, 4], 1] = 1.0
    rate = math.sqrt(stiffness / mass)
    return ModalBody(
        omega=np.full(2, rate), zeta=np.full(2, zeta), channels=rim_channels(1), rows=rows / math.sqrt(mass),
        S=np.zeros((6, 6)), kind="rim", n_max=1, radius=radius, participation=math.sqrt(mass) * np.eye(3, 2),
    )  # fmt: skip
