"""Bodies of one-dimensional scenes: finite element rods, point masses, walls (modal bodies are in `modal_body`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.base.keyed import require_keyed
from contact.io.brief import brief
from contact.io.keys import Key
from contact.model.rate import Rate

Fixed = Literal["none", "left", "right"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Nodes:
    """Nodes of one body from left to right: positions [m], masses [kg], fixed ones, springs to the next node [N/m].

    `ground` [N/m] and `damping` [N s/m] to the ground, `stretch` [m] of the ground springs at t = 0; the last spring
    is zero.
    """

    position: Array
    mass: Array
    held: NDArray[np.bool_]
    springs: Array
    ground: Array
    damping: Array
    stretch: Array


class Body(Protocol):
    """A body of a chain between `x` and `end` [m], moving at `velocity` [m/s].

    `force` [N] varies at its first node, with `force_hz` and `force_deg`. `moves` is false for a rigid body that is
    fixed.
    """

    moves: ClassVar[bool]

    @property
    def x(self) -> float:
        """Left end [m]."""

    @property
    def end(self) -> float:
        """Right end [m]."""

    @property
    def velocity(self) -> float:
        """At t = 0 [m/s]."""

    @property
    def crossing_time(self) -> float:
        """Time of a wave through one element [s], infinite for bodies without elements."""

    @property
    def force(self) -> float:
        """Amplitude of the force on the body [N]."""

    @property
    def force_hz(self) -> float:
        """Frequency of the force [Hz]."""

    def rates(self, key: str) -> tuple[Rate, ...]:
        """Rates of the loads on the body, under names that begin with its key."""

    @property
    def force_deg(self) -> float:
        """Phase of the force [degrees]."""

    def nodes(self, *, has_left: bool, has_right: bool) -> Nodes:
        """Nodes of the body, given whether it has neighbours on its left and right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rod:
    """Elastic rod on the x axis, linear elements, lumped mass: rho A u,tt = E A u,xx.

    `length`, `x` (left end) [m]; `area` [m^2]; `E` [Pa]; `rho` [kg/m^3]; `velocity` [m/s] of the whole rod at t = 0,
    unstressed; `end_mass` [kg] sits at the end that faces its neighbour; `damping` [1/s] is viscous, proportional to
    the mass: force = -damping M v.

    Raises InputError for a value that is not physical.

    >>> rod = Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=100, x=5.0, velocity=-10.0)
    >>> rod.wave_speed, rod.impedance, rod.mass
    (30.0, 30.0, 10.0)
    """

    length: Annotated[float, Key("length [m]", "positive")]
    area: Annotated[float, Key("area of the cross-section [m^2]", "positive")]
    E: Annotated[float, Key("Young's modulus [Pa]", "positive")]
    rho: Annotated[float, Key("density [kg/m^3]", "positive")]
    elements: Annotated[int, Key("number of elements")] = 100
    x: Annotated[float, Key("position of the left end at t = 0 [m]")] = 0.0
    velocity: Annotated[float, Key("velocity at t = 0 [m/s]")] = 0.0
    fixed: Annotated[Fixed, Key("fixed end")] = "none"
    end_mass: Annotated[float, Key("mass at the end that faces the neighbour [kg]", "not negative")] = 0.0
    damping: Annotated[float, Key("mass-proportional damping [1/s]", "not negative")] = 0.0
    moves: ClassVar[bool] = True
    force: ClassVar[float] = 0.0
    force_hz: ClassVar[float] = 0.0
    force_deg: ClassVar[float] = 0.0

    __repr__ = brief

    def __post_init__(self) -> None:
        require_keyed(self)

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

    @property
    def end(self) -> float:
        """Right end [m]."""
        return self.x + self.length

    def rates(self, key: str) -> tuple[Rate, ...]:
        """Rates of its damping and of the passage of a wave from end to end; `key` names the body."""
        time = self.length / self.wave_speed
        damping = (Rate.of_decay(f"{key}.damping", self.damping),) if self.damping > 0.0 else ()
        return (*damping, Rate.of_passage(f"a wave through {key}", time, f"{time:.4g} s"))

    def contact_end(self, *, has_left: bool, has_right: bool) -> str:
        """The end with the end mass: the free end, or the one that faces a neighbour."""
        if self.fixed != "none":
            return "right" if self.fixed == "left" else "left"
        if has_left and has_right:
            raise InputError(
                "end_mass: found one on a free rod between two bodies, expected a rod with one contact end"
            )
        return "left" if has_left else "right"

    def nodes(self, *, has_left: bool, has_right: bool) -> Nodes:
        """Nodes of equal elements with lumped masses."""
        n = self.elements
        mass = np.full(n + 1, self.mass / n)
        mass[[0, n]] *= 0.5
        if self.end_mass > 0.0:
            mass[0 if self.contact_end(has_left=has_left, has_right=has_right) == "left" else n] += self.end_mass
        held = np.zeros(n + 1, dtype=bool)
        if self.fixed != "none":
            held[0 if self.fixed == "left" else n] = True
        springs = np.full(n + 1, self.E * self.area * n / self.length)
        springs[n] = 0.0
        none = np.zeros(n + 1)
        return Nodes(
            position=self.x + self.length * np.arange(n + 1) / n, mass=mass, held=held, springs=springs, ground=none,
            damping=self.damping * mass, stretch=none,
        )  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class PointMass:
    """Point of `mass` [kg] at `x` [m], moving at `velocity` [m/s]; on a spring and a dashpot, it is an oscillator.

    m x'' + damping x' + stiffness (x - anchor) = force cos(2 pi force_hz t + force_deg); `anchor` [m] is where the
    spring is at rest, x when left out. `stiffness` [N/m], `damping` [N s/m] to the ground, `force` [N].

    >>> PointMass(mass=2.0, x=-0.1, velocity=3.0).mass
    2.0
    """

    mass: Annotated[float, Key("mass [kg]", "positive")]
    x: Annotated[float, Key("position at t = 0 [m]")] = 0.0
    velocity: Annotated[float, Key("velocity at t = 0 [m/s]")] = 0.0
    stiffness: Annotated[float, Key("stiffness of a spring to the ground [N/m]", "not negative")] = 0.0
    anchor: Annotated[float | None, Key("position at which this spring has no force [m]; x if left out")] = None
    damping: Annotated[float, Key("damping constant of a dashpot to the ground [N s/m]", "not negative")] = 0.0
    force: Annotated[float, Key("amplitude of a harmonic force [N]")] = 0.0
    force_hz: Annotated[float, Key("frequency of this force [Hz]", "not negative")] = 0.0
    force_deg: Annotated[float, Key("phase of this force [degrees]", "turn")] = 0.0
    moves: ClassVar[bool] = True
    crossing_time: ClassVar[float] = math.inf

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def stretch(self) -> float:
        """Elongation of the spring at t = 0 [m]."""
        return 0.0 if self.anchor is None else self.x - self.anchor

    @property
    def end(self) -> float:
        """Position [m]."""
        return self.x

    def rates(self, key: str) -> tuple[Rate, ...]:
        """Rates of its force, its dashpot and its own frequency; a scheme needs at least two steps a period of it."""
        found = []
        if self.force and self.force_hz > 0.0:
            found.append(Rate(key=f"{key}.force_hz", hz=self.force_hz, words=f"{self.force_hz:.6g} Hz"))
        if self.damping > 0.0:
            found.append(Rate.of_decay(f"{key}.damping over its mass", self.damping / self.mass))
        if self.stiffness > 0.0:
            hz = math.sqrt(self.stiffness / self.mass) / (2.0 * math.pi)
            found.append(Rate(key=f"the frequency of {key} on its spring", hz=hz, words=f"{hz:.6g} Hz", most=1.0))
        return tuple(found)

    def nodes(self, *, has_left: bool, has_right: bool) -> Nodes:
        """The single node."""
        return _node(self.x, self.mass, self.stiffness, self.damping, self.stretch)


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """Rigid wall at `x` [m].

    >>> Wall(x=0.0).x
    0.0
    """

    x: Annotated[float, Key("position of the wall [m]")] = 0.0
    moves: ClassVar[bool] = False
    velocity: ClassVar[float] = 0.0
    crossing_time: ClassVar[float] = math.inf
    force: ClassVar[float] = 0.0
    force_hz: ClassVar[float] = 0.0
    force_deg: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def end(self) -> float:
        """Position [m]."""
        return self.x

    def rates(self, key: str) -> tuple[Rate, ...]:
        """Empty, since nothing varies."""
        return ()

    def nodes(self, *, has_left: bool, has_right: bool) -> Nodes:
        """One fixed node without mass."""
        return _node(self.x, 0.0, 0.0, 0.0, 0.0)


def _node(x: float, mass: float, ground: float, damping: float, stretch: float) -> Nodes:
    one = (np.array([value]) for value in (x, mass, 0.0, ground, damping, stretch))
    position, point, springs, to_ground, dashpot, pulled = one
    return Nodes(
        position=position, mass=point, held=point == 0.0, springs=springs, ground=to_ground, damping=dashpot,
        stretch=pulled,
    )  # fmt: skip
