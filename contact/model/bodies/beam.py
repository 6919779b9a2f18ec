"""A beam rotating on a hinge inside a circle, rigid or flexible: a two-dimensional model of a blade in a casing."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import Annotated

import numpy as np

from contact.base.arrays import Array, readonly, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.base.keyed import require_keyed
from contact.io.brief import brief
from contact.io.keys import Key
from contact.model.bodies.modal_body import ModalBody
from contact.model.rate import Rate
from contact.model.trig import harmonics


@dataclass(frozen=True, slots=True, kw_only=True)
class HingedBeam:
    """Straight elastic beam of rectangular section, hinged at the origin, free to turn in the plane.

    `length`, `width` (out of plane), `height` (in plane) [m]; `E` [Pa]; `rho` [kg/m^3]; constant `torque` [N m] at the
    hinge; at t = 0 it points to `angle_deg` and turns at `spin` [rad/s], undeformed. Large rotations, small strains:
    co-rotational Bernoulli elements (Crisfield, Non-linear Finite Element Analysis of Solids and Structures 1, 1991,
    ch. 7), lumped mass.

    Raises InputError for a value that is not physical.

    >>> beam = HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0)
    >>> round(beam.mass, 3), round(beam.inertia, 6)
    (0.39, 0.0325)
    """

    length: Annotated[float, Key("length [m]", "positive", "size")]
    width: Annotated[float, Key("width of the section [m]", "positive", "thickness")]
    height: Annotated[float, Key("height of the section in the plane of motion [m]", "positive", "thickness")]
    E: Annotated[float, Key("Young's modulus [Pa]", "positive", "E")]
    rho: Annotated[float, Key("density [kg/m^3]", "positive", "rho")]
    elements: Annotated[int, Key("number of elements")] = 40
    torque: Annotated[float, Key("torque on the hinge [N m]", "any", "force")] = 0.0
    angle_deg: Annotated[float, Key("angle at t = 0 [degrees]", "turn")] = 0.0
    spin: Annotated[float, Key("angular velocity at t = 0 [rad/s]")] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def area(self) -> float:
        """Section area [m^2]."""
        return self.width * self.height

    @property
    def second_moment(self) -> float:
        """Second moment of area for bending in the plane [m^4]."""
        return self.width * self.height**3 / 12.0

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.rho * self.area * self.length

    @property
    def inertia(self) -> float:
        """Moment of inertia about the hinge, without the section's own part [kg m^2]."""
        return self.mass * self.length**2 / 3.0

    def nodes(self) -> Array:
        """Positions and rotations (x, y, theta) of the nodes at t = 0, (elements + 1, 3)."""
        angle, s = math.radians(self.angle_deg), np.linspace(0.0, self.length, self.elements + 1)
        return np.stack([s * math.cos(angle), s * math.sin(angle), np.full_like(s, angle)], axis=1)

    def lumped(self) -> Array:
        """Mass and rotary inertia of the nodes, (elements + 1, 3) [kg, kg, kg m^2]."""
        cell = self.length / self.elements
        one = np.full(self.elements + 1, cell)
        one[[0, -1]] *= 0.5
        translation = self.rho * self.area * one
        return np.stack([translation, translation, self.rho * self.second_moment * one], axis=1)

    def omega_max(self) -> float:
        """Largest frequency of one lumped element [rad/s]: a bound for the whole beam."""
        cell = self.length / self.elements
        EA, EI = self.E * self.area, self.E * self.second_moment
        B = np.array([[-1.0, 0, 0, 1, 0, 0], [0, 1 / cell, 1, 0, -1 / cell, 0], [0, 1 / cell, 0, 0, -1 / cell, 1]])
        D = np.array([[EA, 0, 0], [0, 4 * EI, 2 * EI], [0, 2 * EI, 4 * EI]]) / cell
        half = 0.5 * cell * self.rho * np.array([self.area, self.area, self.second_moment])
        root = 1.0 / np.sqrt(np.tile(half, 2))
        return math.sqrt(float(np.linalg.eigvalsh(root[:, None] * (B.T @ D @ B) * root)[-1]))


@dataclass(frozen=True, eq=False, slots=True)
class BeamInCircle:
    """A hinged beam inside a circle of `radius` [m] whose centre lies `offset` [m] from the hinge along +x.

    Gap of node i: g_i = R + w(theta_i) - |x_i - centre|; w = 0 for a rigid circle, else the radial displacement of
    `ring`, a modal basis of kind "rim" (`ring_modes`, or a reduced casing), a smooth function of theta.

    Raises InputError if the beam starts outside, or the radii of ring and circle differ.

    >>> beam = HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0)
    >>> round(math.degrees(BeamInCircle(beam, radius=0.502, offset=6e-3).first_contact_angle), 2)
    109.15
    """

    beam: HingedBeam
    _: KW_ONLY
    radius: Annotated[float, Key("radius [m]", "positive", "size")]
    offset: Annotated[float, Key("distance of the circle's centre from the hinge [m]", "not negative", "reach")] = 0.0
    ring: ModalBody | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        require_positive(radius=self.radius)
        require_not_negative(offset=self.offset)
        if self.offset >= self.radius:
            raise InputError(f"offset: found {self.offset:g} m, expected less than the radius {self.radius:g} m")
        gaps = self.gaps(self.beam.nodes())
        if gaps.min() < 0.0:
            raise InputError(
                f"beam: node {int(gaps.argmin())} starts {-gaps.min():.4g} m outside the circle, expected gaps >= 0"
            )
        if self.ring is None:
            return
        if self.ring.kind != "rim":
            raise InputError(f"ring: found a basis of kind {self.ring.kind!r}, expected 'rim'")
        if abs(self.ring.radius / self.radius - 1.0) > 0.1:
            raise InputError(f"ring: found radius {self.ring.radius:g} m, expected about {self.radius:g} m")

    def rates(self) -> tuple[Rate, ...]:
        """Rates for the choice of the step: the initial turns of the beam."""
        hz = abs(self.beam.spin) / (2.0 * math.pi)
        return (Rate(key="beam.spin", hz=hz, words=f"{self.beam.spin:.6g} rad/s"),) if hz > 0.0 else ()

    def gaps(self, nodes: Array) -> Array:
        """Gaps of nodes (nodes, 3) to the undeformed circle, (nodes,) [m]."""
        return np.asarray(self.radius - np.hypot(nodes[:, 0] - self.offset, nodes[:, 1]))

    @property
    def first_contact_angle(self) -> float:
        """Angle at which the tip of a rigid beam meets a rigid circle [rad]: |L e(theta) - centre| = R.

        Raises InputError when it never does.
        """
        L, c, R = self.beam.length, self.offset, self.radius
        if not L - c < R < L + c:
            expected = f"between {L - c:g} and {L + c:g} m for the tip to meet it"
            raise InputError(f"radius: found {R:g} m, expected {expected}")
        return math.acos((L * L + c * c - R * R) / (2.0 * L * c))

    @property
    def first_contact_time(self) -> float:
        """Time at which a rigid beam first touches [s].

        Spin t + torque t^2/(2 J) is the angle from `angle_deg` to the contact.

        Raises InputError where torque or spin turns the beam away from that angle, or both are 0.
        """
        require_not_negative(torque=self.beam.torque, spin=self.beam.spin)
        if not self.beam.torque and not self.beam.spin:
            raise InputError("torque: found 0 N m and a spin of 0 rad/s, expected one of them > 0 to reach the circle")
        start = math.remainder(math.radians(self.beam.angle_deg), 2.0 * math.pi)
        way = max(self.first_contact_angle - start, 0.0)
        last = math.sqrt(self.beam.spin**2 + 2.0 * way * self.beam.torque / self.beam.inertia)
        return 2.0 * way / (self.beam.spin + last) if way else 0.0


def ring_table(ring: ModalBody | None) -> tuple[Array, Array]:
    """Radial rows by interface function, (2N + 1, m), and their residual compliance (2N + 1, 2N + 1)."""
    if ring is None:
        return readonly(np.zeros((1, 0))), readonly(np.zeros((1, 1)))  # as a ring's: one type compiles once
    size = harmonics(ring.n_max, 0.0).size
    return readonly(ring.rows[:size]), readonly(ring.S[:size, :size])
