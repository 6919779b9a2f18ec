"""Compiled: gravity and whirl on the modes of a rub."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit


class Pulls(NamedTuple):
    """Body forces by their rows (`BodyForce.row`), and the modes' share of them along x and y."""

    laws: Array  # (forces, 8)
    plane: Array  # (2, m)
    casing: int  # modes of the casing, which come first


@jit
def body_force(pulls: Pulls, speed: Array, t: float, angle: float, omega: float, out: Array) -> None:
    """Modal forces at t, when the casing has turned by `angle`; the blades' axes turn against it."""
    segment = speed.shape[0] - 1
    while segment > 0 and t < speed[segment, 0]:
        segment -= 1
    slope = speed[segment, 3]
    x, y, blade_x, blade_y = 0.0, 0.0, 0.0, 0.0
    for k in range(pulls.laws.shape[0]):
        law = pulls.laws[k]
        w = law[3] * omega + law[4]
        along, across = law[0] + law[1] * w * w, -law[1] * law[3] * slope
        beta = law[5] + law[2] * angle + law[4] * t
        c, s = math.cos(beta), math.sin(beta)
        x += law[6] * (along * c - across * s)
        y += law[6] * (along * s + across * c)
        c, s = math.cos(beta + angle), math.sin(beta + angle)
        blade_x += law[7] * (along * c - across * s)
        blade_y += law[7] * (along * s + across * c)
    for i in range(pulls.casing):
        out[i] = pulls.plane[0, i] * x + pulls.plane[1, i] * y
    for i in range(pulls.casing, out.size):
        out[i] = pulls.plane[0, i] * blade_x + pulls.plane[1, i] * blade_y
