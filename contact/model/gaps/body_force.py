"""Gravity and whirling frames: prescribed forces on the mass of a body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from contact.base.arrays import require_finite
from contact.base.errors import InputError
from contact.model.gaps.rub_laws import Whirl
from contact.model.gaps.turning import casing_turns

Bearer = Literal["casing", "blades", "both"]
BEARERS = ("casing", "blades", "both")


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyForce:
    """Force per mass on a body [m/s^2], in the casing's frame, whose axis is z.

    a(t) = (acceleration + radius w^2) e(beta) - radius w' e'(beta) + axial z, beta = phase + per_rev angle(t) + 2 pi hz
    t as for `Whirl`, e' = de/d beta, and w = d beta/dt, plus Omega if the casing rotates: the rate of that direction in
    space. Gravity is the `acceleration` in a direction fixed in space. The other terms act in a frame whose origin
    moves on a circle of `radius` [m]. The modal forces are f = participation . a.

    Raises InputError for an unknown bearer or numbers that are not finite.

    >>> weight = BodyForce.gravity()
    >>> weight.per_rev, round(weight.acceleration, 2)
    (0.0, 9.81)
    """

    on: Bearer = "both"
    acceleration: float = 0.0
    radius: float = 0.0
    axial: float = 0.0
    per_rev: float = 0.0
    hz: float = 0.0
    phase_deg: float = 0.0
    casing_turns: bool = False

    def __post_init__(self) -> None:
        if self.on not in BEARERS:
            raise InputError(f"on: found {self.on!r}, expected one of {', '.join(BEARERS)}")
        require_finite(
            acceleration=self.acceleration, radius=self.radius, axial=self.axial, per_rev=self.per_rev, hz=self.hz,
            phase_deg=self.phase_deg,
        )  # fmt: skip

    @staticmethod
    def gravity(
        *, turning: str = "blades", acceleration: float = 9.80665, down_deg: float = -90.0, axial: float = 0.0
    ) -> BodyForce:
        """Gravity on all bodies: towards `down_deg` at t = 0 in the casing's angles, and `axial` along its axis."""
        turns = casing_turns(turning)
        return BodyForce(
            acceleration=acceleration, axial=axial, per_rev=-1.0 if turns else 0.0, phase_deg=down_deg,
            casing_turns=turns,
        )  # fmt: skip

    @staticmethod
    def of_whirl(whirl: Whirl, on: Literal["casing", "blades"], *, turning: str = "blades") -> BodyForce:
        """Modal forces of a whirl: outwards on the casing, opposite on the blades.

        >>> BodyForce.of_whirl(Whirl(amplitude=1e-3, hz=10.0), "blades").radius
        -0.001
        """
        if on not in ("casing", "blades"):
            raise InputError(f"on: found {on!r}, expected casing or blades, the side that whirls")
        return BodyForce(
            on=on, radius=whirl.amplitude if on == "casing" else -whirl.amplitude, per_rev=whirl.per_rev, hz=whirl.hz,
            phase_deg=whirl.phase_deg, casing_turns=casing_turns(turning),
        )  # fmt: skip

    @property
    def row(self) -> tuple[float, ...]:
        """Parameters for the compiled loop: acceleration, radius, per_rev, per_rev in space, rad/s, phase, body."""
        return (
            self.acceleration, self.radius, self.per_rev, self.per_rev + float(self.casing_turns),
            2.0 * math.pi * self.hz, math.radians(self.phase_deg), float(self.on != "blades"),
            float(self.on != "casing"),
        )  # fmt: skip
