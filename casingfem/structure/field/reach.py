"""A field beyond the measured heights: constant from the nearest height, or reduced to zero."""

from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from casingfem.io.arrays import Array

Outside: TypeAlias = Literal["fit", "nearest", "zero"]
FADE = 0.25  # of the measured heights: length over which a field decreases to zero


class Reach(NamedTuple):
    """Heights [m] from low to high where functions of z are valid, and the rule outside.

    "nearest": f(z) = f(low) below and f(high) above; "zero": the same times 1 - (10 u^3 - 15 u^4 + 6 u^5), where u is
    the distance from the nearest end in quarters of high - low, at most 1.
    """

    low: float
    high: float
    rule: Literal["nearest", "zero"] = "nearest"

    def bounded(self, z: Array, held: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        """Functions at z and their two z-derivatives, (z.shape, functions) each, from those at `held(z)`."""
        beyond = (z - self.held(z))[..., None]
        inside = beyond == 0.0
        value, d_z, d_zz = held[0], np.where(inside, held[1], 0.0), np.where(inside, held[2], 0.0)
        if self.rule == "nearest":
            return value, d_z, d_zz
        length = FADE * (self.high - self.low)
        sign = np.where(np.real(beyond) < 0.0, -1.0, 1.0)
        u = sign * beyond / length
        u = np.where(np.real(u) > 1.0, 1.0, u)
        weight = 1.0 - u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
        slope = -30.0 * u**2 * (1.0 - u) ** 2 * sign / length
        bend = -60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / length**2
        return weight * value, weight * d_z + slope * value, weight * d_zz + bend * value

    def held(self, z: Array) -> Array:
        """The nearest height within the valid range."""
        at = np.where(np.real(z) < self.low, self.low, z)
        return np.where(np.real(z) > self.high, self.high, at)
