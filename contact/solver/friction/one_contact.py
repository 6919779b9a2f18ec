"""One contact with Coulomb friction along one line, in closed form: what nearly every step of one tip asks for.

u = W force + b with b_N < 0. It sticks where W force = -b lies inside the cone; else it slips, u_N = 0,
force_T = -mu s force_N and force_N = -b_N/(W_NN - mu s W_NT), s the sign of u_T. W_NN > mu |W_NT| leaves one answer.
"""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit


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
    det = W[0, 0] * W[1, 1] - W[0, 1] * W[1, 0]
    if not det > 0.0:
        return False
    normal, tangent = (W[0, 1] * b[1] - W[1, 1] * b[0]) / det, (W[1, 0] * b[0] - W[0, 0] * b[1]) / det
    if normal >= 0.0 and abs(tangent) <= mu * normal:
        force[0], force[1] = normal, tangent
        return True
    for sign in (1.0, -1.0):
        normal = -b[0] / (W[0, 0] - mu * sign * W[0, 1])
        tangent = -mu * sign * normal
        if sign * (W[1, 0] * normal + W[1, 1] * tangent + b[1]) >= 0.0:
            force[0], force[1] = normal, tangent
            return True
    return False
