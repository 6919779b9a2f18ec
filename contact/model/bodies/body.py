"""Bodies of one-dimensional scenes: finite element rods and point masses (modal bodies: `modal_body`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from contact.base.arrays import require_finite, require_not_negative, require_positive
from contact.base.errors import InputError

Fixed = Literal["none", "left", "right"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rod:
    """Elastic rod on the x axis, linear elements, lumped mass: rho A u,tt = E A u,xx.

    `length`, `x` (left end) [m]; `area` [m^2]; `E` [Pa]; `rho` [kg/m^3]; `velocity` [m/s] of the whole rod at
    t = 0, unstressed; `end_mass` [kg] sits at the end that faces its neighbour; `damping` [1/s] is viscous, in
    proportion to the mass: force = -damping M v.

    Raises InputError for a value that is not physical.

    >>> rod = Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=100, x=5.0, velocity=-10.0)
    >>> rod.wave_speed, rod.impedance, rod.mass
    (30.0, 30.0, 10.0)
    """

    length: float
    area: float
    E: float
    rho: float
    elements: int = 100
    x: float = 0.0
    velocity: float = 0.0
    fixed: Fixed = "none"
    end_mass: float = 0.0
    damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(length=self.length, area=self.area, E=self.E, rho=self.rho)
        require_finite(x=self.x, velocity=self.velocity)
        require_not_negative(end_mass=self.end_mass, damping=self.damping)
        if not isinstance(self.elements, int) or self.elements < 1:
            raise InputError(f"elements: found {self.elements!r}, expected a whole number >= 1")
        if self.fixed not in ("none", "left", "right"):
            raise InputError(f"fixed: found {self.fixed!r}, expected 'none', 'left' or 'right'")

    @property
    def wave_speed(self) -> float:
        """Speed of longitudinal waves, c = sqrt(E/rho) [m/s]."""
        return math.sqrt(self.E / self.rho)

    @property
    def impedance(self) -> float:
        """Force per particle velocity, Z = rho c A [N s/m]."""
        return self.rho * self.wave_speed * self.area

    @property
    def mass(self) -> float:
        """Mass of the rod without its end mass [kg]."""
        return self.rho * self.area * self.length

    @property
    def crossing_time(self) -> float:
        """Time of a wave through one element, dx/c: the stable step of central differences [s]."""
        return self.length / self.elements / self.wave_speed


@dataclass(frozen=True, slots=True, kw_only=True)
class PointMass:
    """Point of `mass` [kg] at `x` [m], moving at `velocity` [m/s]; on a spring and a dashpot, it is an oscillator.

    m x'' + damping x' + stiffness (x - anchor) = force cos(2 pi force_hz t + force_deg); `anchor` [m] is where the
    spring is at rest, x when left out. `stiffness` [N/m], `damping` [N s/m] to the ground, `force` [N].

    >>> PointMass(mass=2.0, x=-0.1, velocity=3.0).mass
    2.0
    """

    mass: float
    x: float = 0.0
    velocity: float = 0.0
    stiffness: float = 0.0
    anchor: float | None = None
    damping: float = 0.0
    force: float = 0.0
    force_hz: float = 0.0
    force_deg: float = 0.0

    def __post_init__(self) -> None:
        require_positive(mass=self.mass)
        require_finite(x=self.x, velocity=self.velocity, force=self.force, force_deg=self.force_deg)
        require_not_negative(stiffness=self.stiffness, damping=self.damping, force_hz=self.force_hz)
        if self.anchor is not None:
            require_finite(anchor=self.anchor)

    @property
    def stretch(self) -> float:
        """Elongation of the spring at t = 0 [m]."""
        return 0.0 if self.anchor is None else self.x - self.anchor


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """Rigid wall at `x` [m].

    >>> Wall(x=0.0).x
    0.0
    """

    x: float = 0.0

    def __post_init__(self) -> None:
        require_finite(x=self.x)


Body = Rod | PointMass | Wall
