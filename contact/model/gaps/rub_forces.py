"""Gravity and whirl on the bodies of a rub: their modes' share, and the rest they have under it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.model.gaps.body_force import BodyForce
from contact.model.gaps.rub import Rub

SPREAD = 10.0  # degrees between the tips of a blade that still stands in one place


def plane_participation(rub: Rub) -> Array:
    """Participation of all modes in a force along the casing's x and y, for blades as they stand at t = 0, (2, m).

    A blade at phi with the lean a has its span and flap at a from the radial and tangential directions:
    a_span = cos a a_r - sin a a_t, a_flap = sin a a_r + cos a a_t.
    """
    parts = [np.zeros((2, body.omega.size)) for body in rub.bodies]
    for k, body in enumerate(rub.bodies):
        if body.participation is None or not any(f.on == "both" or (f.on == "casing") == (k == 0) for f in rub.forces):
            continue
        if k == 0:
            parts[k] = np.asarray(body.participation[:2])
            continue
        phi, a = place(rub, k - 1)
        turn = np.array([[math.cos(phi), -math.sin(phi)], [math.sin(phi), math.cos(phi)]])
        lean = np.array([[math.cos(a), math.sin(a)], [-math.sin(a), math.cos(a)]])
        parts[k] = turn @ lean @ body.participation[:2]
    return np.ascontiguousarray(np.concatenate(parts, axis=1))


def axial_load(rub: Rub) -> Array:
    """Constant modal forces of what pulls along the axis, (m,): a blade's chord stands along it."""
    parts = []
    for k, body in enumerate(rub.bodies):
        pull = sum(f.axial for f in rub.forces if f.on == "both" or (f.on == "casing") == (k == 0))
        has = body.participation is not None
        parts.append(pull * np.asarray(body.participation)[2] if has else np.zeros(body.omega.size))
    return np.concatenate(parts)


def place(rub: Rub, blade: int) -> tuple[float, float]:
    """Angle at t = 0 and lean of one blade [rad]; raises InputError where its tips stand in several places."""
    tips = [tip for tip in rub.tips if tip.blade == blade]
    if not tips:
        raise InputError(f"forces: found no tip of blade {blade + 1}, expected one that says where it stands")
    first, leans = tips[0].angle_deg, [tip.lean_deg for tip in tips]
    away = [(tip.angle_deg - first + 180.0) % 360.0 - 180.0 for tip in tips]  # 359 and 1 degree are near each other
    if np.ptp(away) > SPREAD or np.ptp(leans) > 0.0:
        raise InputError(
            f"forces: found the tips of blade {blade + 1} over {np.ptp(away):g} degrees and leans that differ by "
            f"{np.ptp(leans):g}, expected one blade in one place (at most {SPREAD:g} degrees, one lean)"
        )
    return math.radians(first + float(np.mean(away))), math.radians(leans[0])


def plane_force(forces: Sequence[BodyForce], angle: float, omega: float, slope: float, t: float) -> Array:
    """Force per mass along x and y on the casing, and on blades in axes that turn with them, (2, 2)."""
    found = np.zeros((2, 2))
    for force in forces:
        amount, radius, per_rev, in_space, rate, phase, *on = force.row
        w = in_space * omega + rate
        along, across = amount + radius * w * w, -radius * in_space * slope
        for k in (0, 1):
            beta = phase + per_rev * angle + rate * t + k * angle
            c, s = math.cos(beta), math.sin(beta)
            found[k] += on[k] * np.array([along * c - across * s, along * s + across * c])
    return found


def force_at_start(rub: Rub) -> Array:
    """Modal forces at t = 0 that vary in time, (m,)."""
    casing = rub.casing.omega.size
    plane, table = plane_participation(rub), rub.speed.table
    slope = table[max(int(np.searchsorted(table[:, 0], 0.0, side="right")) - 1, 0), 3]
    on_casing, on_blades = plane_force(rub.forces, 0.0, rub.speed.omega(0.0), slope, 0.0)
    return np.concatenate([on_casing @ plane[:, :casing], on_blades @ plane[:, casing:]])


def settled(rub: Rub) -> Rub:
    """The same rub, its bodies at rest where gravity and whirl of t = 0 hold them: q = K^-1 f.

    Raises InputError for bodies with rigid modes.
    """
    load, first = force_at_start(rub) + axial_load(rub), 0
    speed2, starts = rub.speed.omega(0.0) ** 2, []
    for k, (body, start) in enumerate(zip(rub.bodies, rub.starts, strict=True)):
        own = load[first : first + body.omega.size]
        first += body.omega.size
        K = np.diag(body.omega**2)
        for stiff in rub.stiffening:
            if stiff.blade == k - 1:
                K += (speed2 - (2.0 * math.pi * stiff.at_hz) ** 2) * stiff.K_omega
        if own.any() and not body.omega.min() > 0.0:
            raise InputError(f"{rub.names[k]}: found rigid modes, which no rest holds against gravity or whirl")
        starts.append(replace(start, displacement=readonly(np.linalg.solve(K, own) if own.any() else 0.0 * own)))
    return replace(rub, casing_start=starts[0], blade_starts=tuple(starts[1:]))
