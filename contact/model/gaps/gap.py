"""Gaps of modal bodies: at a fixed point (`PointGap`) and at the moving point of a rotating rim."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Literal

import numpy as np

from contact.base.arrays import Array, readonly, require_finite, require_not_negative, require_positive, require_shape
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.limits import FAR, require_near
from contact.model.gaps.turning import casing_turns


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Side:
    """One modal body at a contact: its part of the gap is sign * (rows[channel] q + S[channel, channel] lam).

    `sign` +1 when a positive displacement opens the gap, -1 when it closes it. `velocity` (m,) initial modal
    velocities, `load` (m,) constant modal forces; zero when left out. `mass` [kg] (for its
    mean velocity) and `potential` [J] of the load at t = 0 are only reported.

    >>> rod = ModalBody(omega=[0.0], zeta=[0.0], channels=("left",), rows=[[1.0]], S=[[0.0]])
    >>> Side(body=rod, channel="left", sign=1, velocity=[-2.0]).velocity.tolist()
    [-2.0]
    """

    body: ModalBody
    channel: str
    sign: int
    velocity: Array | None = None
    load: Array | None = None
    name: str = "body"
    mass: float = math.nan
    potential: float = 0.0

    def __post_init__(self) -> None:
        self.body.channel(self.channel)
        if self.sign not in (1, -1):
            raise InputError(f"sign: found {self.sign!r}, expected 1 (opens the gap) or -1 (closes it)")
        for name in ("velocity", "load"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, readonly(getattr(self, name)))
                require_shape(name, getattr(self, name), (self.body.omega.size,))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PointGap:
    """Gap at a fixed point: g = clearance + the parts of the sides; a missing side is a rigid wall.

    >>> rod = ModalBody(omega=[0.0], zeta=[0.0], channels=("left",), rows=[[1.0]], S=[[0.0]])
    >>> PointGap(sides=(Side(body=rod, channel="left", sign=1),), clearance=0.1).clearance
    0.1
    """

    sides: tuple[Side, ...]
    clearance: float = 0.0

    def __post_init__(self) -> None:
        require_not_negative(clearance=self.clearance)
        if len(self.sides) not in (1, 2):
            raise InputError(f"sides: found {len(self.sides)}, expected one (against a wall) or two")

    @property
    def load_response(self) -> float:
        """f^T M^-1 f of the constant loads [J/s^2]."""
        return sum(float(side.load @ side.load) for side in self.sides if side.load is not None)


@dataclass(frozen=True, eq=False, slots=True)
class RotatingRim:
    """Casing rim and one blade that rotate relative to each other at `speed_hz`; contact at phi = phi_0 - Omega t.

    g = clearance + d(phi) + u_r(phi) - (cos a u_span + sin a u_flap), with the lean a and the out-of-roundness d
    in the casing frame, terms {p, cos, sin} in metres, positive where the radius is larger. The tangent of
    the blade is cos a flap - sin a span, along +theta. `clearance` [m], `angle_deg` = phi_0; modal
    displacements and velocities at t = 0 are zero when left out. `turning`: the side that rotates, as in `Rub`.

    Raises InputError when a basis is of the wrong kind or lacks a channel, or |clearance| exceeds
    a tenth of the radius.

    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": np.zeros((2, 2))}
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.01], **seen)
    >>> rim = ct.RotatingRim(casing, blade, clearance=1e-3, speed_hz=5.0, lean_deg=10.0)
    >>> round(rim.speed, 3)  # turns/s in rad/s
    31.416
    """

    casing: ModalBody
    blade: ModalBody
    _: KW_ONLY
    clearance: float
    speed_hz: float
    lean_deg: float = 0.0
    out_of_roundness: Sequence[Mapping[str, float]] = ()
    angle_deg: float = 0.0
    casing_velocity: Array | None = None
    blade_velocity: Array | None = None
    casing_displacement: Array | None = None
    blade_displacement: Array | None = None
    turning: Literal["casing", "blades"] = "blades"

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.casing.kind != "rim":
            raise InputError(f"casing: found a basis of kind {self.casing.kind!r}, expected 'rim'")
        if self.casing.directions > 2 or self.casing.rim_lines > 1:
            found = f"{self.casing.rim_lines} rim lines in {self.casing.directions} directions"
            raise InputError(f"casing: found {found}, expected one line, radial and tangential: use ct.Rub for others")
        if self.blade.kind != "point":
            raise InputError(f"blade: found a basis of kind {self.blade.kind!r}, expected 'point'")
        if not {"span", "flap"} <= set(self.blade.channels):
            found = f"the channels {', '.join(self.blade.channels)}"
            raise InputError(
                f"blade: found {found}, expected span and flap: use a scene of kind 'rub' and name the channels by span"
                " and flap in [[blade.node]] (in Python ct.Rub)"
            )
        casing_turns(self.turning)
        radius = self.casing.line_radius(0)
        require_positive(radius=radius)
        require_finite(clearance=self.clearance, speed_hz=self.speed_hz, angle_deg=self.angle_deg)
        if abs(self.clearance) > FAR * radius:
            raise InputError(
                f"clearance: found {self.clearance:g} m, expected between -{FAR * radius:g} and {FAR * radius:g} m, "
                f"a tenth of the rim's radius {radius:g} m"
            )
        if not -90.0 < self.lean_deg < 90.0:
            raise InputError(f"lean_deg: found {self.lean_deg!r}, expected an angle between -90 and 90")
        for side, body in (("casing", self.casing), ("blade", self.blade)):
            for name in (f"{side}_velocity", f"{side}_displacement"):
                if getattr(self, name) is not None:
                    object.__setattr__(self, name, readonly(getattr(self, name)))
                    require_shape(name, getattr(self, name), (body.omega.size,))
        terms = tuple(dict(term) for term in self.out_of_roundness)
        for term in terms:
            require_term(term)
        far = sum(math.hypot(term.get("cos", 0.0), term.get("sin", 0.0)) for term in terms)
        require_near(radius, out_of_roundness=far)
        object.__setattr__(self, "out_of_roundness", terms)

    def blade_normal(self) -> tuple[str, Array]:
        """Name of the blade, and the row of its motion along the contact normal, (m,)."""
        a = math.radians(self.lean_deg)
        span, flap = (self.blade.rows[self.blade.channel(name)] for name in ("span", "flap"))
        return "blade", np.asarray(math.cos(a) * span + math.sin(a) * flap)

    @property
    def speed(self) -> float:
        """Omega [rad/s]."""
        return 2.0 * math.pi * self.speed_hz

    @property
    def terms(self) -> list[tuple[int, float, float]]:
        """Out-of-roundness as (harmonic, cos, sin)."""
        return [(int(t["p"]), t.get("cos", 0.0), t.get("sin", 0.0)) for t in self.out_of_roundness]


def require_term(term: Mapping[str, float]) -> None:
    """Raise InputError unless a term of the out-of-roundness has p >= 0 and finite cos, sin."""
    extra = set(term) - {"p", "cos", "sin"}
    if extra or "p" not in term:
        raise InputError(f"out_of_roundness: found keys {sorted(term)}, expected p and cos and/or sin")
    if term["p"] != int(term["p"]) or term["p"] < 0:
        raise InputError(f"out_of_roundness: found p = {term['p']!r}, expected a whole number >= 0")
    require_finite(**{f"out_of_roundness.{name}": term.get(name, 0.0) for name in ("cos", "sin")})
