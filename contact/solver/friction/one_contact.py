"""One contact with Coulomb friction along one line, in closed form: what nearly every step of one tip asks for.

u = W force + b with b_N < 0. It sticks where W force = -b lies inside the cone; else it slips, u_N = 0,
force_T = -mu s force_N and force_N = -b_N/(W_NN - mu s W_NT), s the sign of u_T. W_NN > mu |W_NT| leaves one answer.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit


@jit
def drag_ratio(nn: float, nt: float, tn: float, tt: float, gap: float, slip: float, mu: float) -> float:
    """-force_T/force_N of a contact that would close: inside the cone it sticks; NaN where neither way does.

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
def one_contact(W: Array, b: Array, mu: float, dim: int, force: Array) -> bool:
    """Fill `force` (d,), d = 1 or 2; False where this may not be the only answer, or d = 3."""
    if dim > 2 or not W[0, 0] > (mu * abs(W[0, 1]) if dim == 2 else 0.0):
        return False
    if b[0] >= 0.0:
        for i in range(dim):
            force[i] = 0.0
        return True
    if dim == 1:
        force[0] = -b[0] / W[0, 0]
        return bool(force[0] >= 0.0)
    if not W[0, 0] * W[1, 1] > W[0, 1] * W[1, 0]:
        return False
    ratio = drag_ratio(W[0, 0], W[0, 1], W[1, 0], W[1, 1], b[0], b[1], mu)
    force[0] = -b[0] / (W[0, 0] - ratio * W[0, 1])
    force[1] = -ratio * force[0]
    return bool(force[0] >= 0.0)
