"""Compiled: the force of a rotor's unbalance, and the torques that change the speed of a rotor.

The unbalance U is a mass times its distance from the centre of the disk, u = U e^(i theta) in the plane x + i y. With
differences over the steps before and after t_n, written - and +, its force on the disk is

    F = -(u_{n+1} - 2 u_n + u_{n-1})/h^2,

of which the momentum of disk and unbalance is the sum to round-off. Both share the kinetic energy
C = Re(conj(Dx) Du)/h^2, so that the disk gets the work F (Dx+ + Dx-)/2 and the spin

    -Re(conj(Dx+ - Dx-) (Du+ + Du-))/(2 h^2)

in this step: the sum of both is the change of -C. The torque that does this work, and that of contacts whose point
moves over the rim, follows from the angle that the rotor turns in the same two steps.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_apart
from contact.loop.rub.rows import AHEAD, BEFORE, NOW, RubLaws, RubRows, Swing
from contact.loop.rub.state import RubState
from contact.record.record import Tally
from contact.record.spin import (
    DRIVE,
    FRICTION,
    GYROSCOPIC,
    MISSED,
    ON_FRICTION,
    ON_OTHERS,
    RELEASED,
    ROTATION,
    UNBALANCE,
)

TORQUE, PASSED, PENDING = 0, 1, 2  # entries of `Spin.now`


@jit
def unbalance(swing: Swing, t: float) -> tuple[float, float]:
    """U at t along the rotor's x and y [kg m].

    In the step of a change, the change is weighted by the part of t - h/2 to t + h/2 after it.
    """
    x, y = 0.0, 0.0
    for k in range(swing.jumps.shape[0]):
        share = min(max((t - swing.jumps[k, 0]) * swing.jumps[k, 1] + 0.5, 0.0), 1.0)
        x += share * swing.jumps[k, 2]
        y += share * swing.jumps[k, 3]
    return x, y


@jit_apart
def add_unbalance(swing: Swing, t: float, h: float, angles: Array, out: Array) -> None:
    """Force of the unbalance on the modes of the rotor, which rotates against the angle of the casing."""
    ux, uy = unbalance(swing, t)
    c = (angles[AHEAD, 1] - angles[NOW, 1]) - (angles[NOW, 1] - angles[BEFORE, 1])
    s = (angles[AHEAD, 2] - angles[NOW, 2]) - (angles[NOW, 2] - angles[BEFORE, 2])
    x, y = -(c * ux + s * uy) / (h * h), -(c * uy - s * ux) / (h * h)
    for i in range(swing.plane.shape[1]):
        out[swing.first + i] += swing.plane[0, i] * x + swing.plane[1, i] * y


@jit
def shared(s: RubState, swing: Swing, t: float, h: float, angles: Array) -> tuple[float, float]:
    """Increase of C by the disk's motion (twice the work taken from the spin), and by a change of U [J]."""
    before_x, before_y, more_x, more_y = 0.0, 0.0, 0.0, 0.0
    for i in range(swing.plane.shape[1]):
        old, new = s.old[swing.first + i], s.d[swing.first + i]
        before_x += swing.plane[0, i] * old
        before_y += swing.plane[1, i] * old
        more_x += swing.plane[0, i] * (new - old)
        more_y += swing.plane[1, i] * (new - old)
    ux, uy = unbalance(swing, t)
    c, n = angles[AHEAD, 1] - angles[BEFORE, 1], angles[AHEAD, 2] - angles[BEFORE, 2]
    gained = more_x * (c * ux + n * uy) + more_y * (c * uy - n * ux)
    was_x, was_y = unbalance(swing, t - h)
    c, n = angles[NOW, 1] - angles[BEFORE, 1], angles[NOW, 2] - angles[BEFORE, 2]
    ux, uy = ux - was_x, uy - was_y
    jumped = before_x * (c * ux + n * uy) + before_y * (c * uy - n * ux)
    return gained / (h * h), jumped / (h * h)


@jit_apart
def spin_on(s: RubState, laws: RubLaws, rows: RubRows, angles: Array, dim: int, base: float, t: float, h: float,
            sums: Tally) -> None:  # fmt: skip
    """Take from the rotor's spin the energy that unbalance and contact absorb in this step.

    The increment already contains the torque of the last step. Friction acts directly on the mode of the spin.
    """
    spin, rotation, taken, jumped = laws.spin, 0.0, 0.0, 0.0
    for j in range(sums.rotation.size):
        rotation += sums.rotation[j]
    rolled = rotation - spin.now[PASSED]
    spin.now[PASSED] = rotation
    if laws.swing.jumps.shape[0] > 0:
        taken, jumped = shared(s, laws.swing, t, h, angles)
    mode, k = spin.mode, spin.scale * spin.scale * s.c[spin.mode]
    given = rolled + 0.5 * taken + spin.now[PENDING]
    turned = spin.scale * (s.d[mode] + s.old[mode]) - 2.0 * base * h
    more = further(k, turned, spin.now[TORQUE], given)
    spin.now[TORQUE] += more
    s.d[mode] += spin.scale * s.c[mode] * more
    s.body[mode] += spin.scale * more
    half = 0.5 * (turned + k * more)
    dragged = 0.0
    for j in range(s.mu.size if dim > 1 else 0):
        R = j * dim + 1
        slid = -rows.glide[R] * k * more
        sums.friction[j] += 0.5 * s.lam[R] * slid
        s.motion[R] += slid
        s.heat[j] -= s.lam[R] * slid
        dragged -= rows.glide[R] * s.lam[R]
    spin.sums[DRIVE] += spin.drive * half
    spin.sums[FRICTION] += dragged * half
    spin.sums[ROTATION] -= rolled
    spin.sums[UNBALANCE] -= 0.5 * taken
    spin.sums[GYROSCOPIC] -= spin.now[PENDING]
    spin.sums[RELEASED] += jumped
    spin.sums[MISSED] += spin.now[TORQUE] * half + given
    spin.sums[ON_FRICTION] += dragged * h
    spin.sums[ON_OTHERS] += (spin.drive + spin.now[TORQUE]) * h
    spin.now[PENDING] = 0.0


@jit
def further(k: float, turned: float, torque: float, given: float) -> float:
    """The change x of a torque such that (torque + x) (turned + k x)/2 = -given; zero for a rotor that hardly turns."""
    b, c = turned + k * torque, torque * turned + 2.0 * given
    root = b * b - 4.0 * k * c
    if not root > 0.0:
        return -torque
    return -2.0 * c / (b + math.copysign(math.sqrt(root), b))
