"""One contact, frictionless or with Coulomb friction along one line, in closed form: the case of nearly every step.

u = W force + b with b_N < 0. It sticks if the force with W force = -b lies inside the cone. Else it slips with u_N = 0,
force_T = -mu s force_N and force_N = -b_N/(W_NN - mu s W_NT), s the sign of u_T. The solution is unique if W_NN > mu
|W_NT|.
"""

from __future__ import annotations

import math

from contact.jit.compiled import jit, jit_inside

JAMMED = -1.0


@jit_inside
def scalar_force(H: float, gap: float) -> float:
    """Force of one closed contact, -gap/H; JAMMED if H <= 0. Call it only if gap < 0.

    H is the Delassus number Q c W: the gap that a unit force opens within a step. Friction makes it nonsymmetric
    (W = Q - mu s T) and, for a digging blade, negative: then no force opens the gap, and the step has no solution.
    """
    if H > 0.0:
        return -gap / H
    return JAMMED


@jit
def drag_ratio(nn: float, nt: float, tn: float, tt: float, gap: float, slip: float, mu: float) -> float:
    """-force_T/force_N of a closing contact: inside the cone it sticks; NaN if neither stick nor slip is consistent.

    u_N = nn force_N + nt force_T + gap, u_T = tn force_N + tt force_T + slip.
    """
    det = nn * tt - nt * tn
    normal, tangent = nt * slip - tt * gap, tn * gap - nn * slip  # times det
    if det > 0.0 and normal > 0.0 and abs(tangent) <= mu * normal:
        return -tangent / normal
    for sign in (1.0, -1.0):
        ratio = sign * mu
        normal = -gap / (nn - ratio * nt)
        if normal >= 0.0 and sign * ((tn - tt * ratio) * normal + slip) >= 0.0:
            return ratio
    return math.nan


@jit
def one_contact(nn: float, nt: float, tn: float, tt: float, gap: float, slip: float,
                mu: float) -> tuple[bool, float, float]:  # fmt: skip
    """Forces of the contact of `drag_ratio`, open or closed; returns False if the solution may not be unique.

    Without friction all but `nn` and `gap` are zero.
    """
    found, normal, ratio = force_and_ratio(nn, nt, tn, tt, gap, slip, mu)
    return found, normal, -ratio * normal


@jit
def only_contact(nn: float, nt: float, tn: float, tt: float, gap: float, slip: float,
                 mu: float) -> tuple[bool, float, float]:  # fmt: skip
    """Forces of the contact of `drag_ratio`, open or closed; returns False if there is no solution.

    If there are several solutions, sticking is preferred to slipping.
    """
    if gap >= 0.0:
        return True, 0.0, 0.0
    ratio = drag_ratio(nn, nt, tn, tt, gap, slip, mu) if mu > 0.0 else 0.0
    press = scalar_force(nn - ratio * nt, gap)
    return bool(press >= 0.0), press, -ratio * press


@jit
def force_and_ratio(nn: float, nt: float, tn: float, tt: float, gap: float, slip: float,
                    mu: float) -> tuple[bool, float, float]:  # fmt: skip
    """Normal force of `one_contact`, and the ratio of drag to it."""
    if not nn > mu * abs(nt):
        return False, 0.0, 0.0
    if gap >= 0.0:
        return True, 0.0, 0.0
    ratio = 0.0
    if mu > 0.0:
        if not nn * tt > nt * tn:
            return False, 0.0, 0.0
        ratio = drag_ratio(nn, nt, tn, tt, gap, slip, mu)
    normal = -gap / (nn - ratio * nt)
    return bool(normal >= 0.0), normal, ratio
