"""Supports: what holds an edge of a shell.

A support either removes motions (in Cartesian directions, or in the edge's own frame) or adds springs.
Springs act on the five dofs of a node: three displacements and two rotations.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from casingfem.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Clamped:
    """All three displacements and both rotations are held.

    >>> Clamped().held
    (0, 1, 2, 3, 4)
    """

    held: ClassVar[tuple[int, ...]] = (0, 1, 2, 3, 4)
    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"


@dataclass(frozen=True, slots=True, kw_only=True)
class ShearDiaphragm:
    """Held across the surface, free along it: v = w = 0 and no rotation along the edge; N = M = 0.

    v is along the edge and w along the surface's normal (on a cone that is not the radial direction). In the edge's
    frame the dofs are (in-plane normal to the edge, along the edge, surface normal, rotation of the normal across the
    edge, rotation of the normal along the edge); the first and fourth stay free.

    >>> ShearDiaphragm().held
    (1, 2, 4)
    """

    held: ClassVar[tuple[int, ...]] = (1, 2, 4)
    frame: ClassVar[Literal["cartesian", "edge"]] = "edge"


@dataclass(frozen=True, slots=True, kw_only=True)
class Circumferential:
    """How a spring varies along an edge: 1 + sum_p cos_p cos(p theta) + sin_p sin(p theta).

    >>> pattern = Circumferential(harmonics=((4, 0.5, 0.0),))
    >>> float(pattern(np.array(0.0)))
    1.5
    """

    harmonics: tuple[tuple[int, float, float], ...] = ()

    def __call__(self, theta: Array) -> Array:
        """Factor at theta, shape of theta."""
        factor = 1.0 + 0.0 * np.asarray(theta)
        for p, cos, sin in self.harmonics:
            factor = factor + cos * np.cos(p * theta) + sin * np.sin(p * theta)
        return factor

    def coefficient(self, p: int, part: str) -> float:
        """The cos or sin coefficient of harmonic p (0 where there is none)."""
        return sum({"cos": c, "sin": s}[part] for q, c, s in self.harmonics if q == p)

    def with_coefficient(self, p: int, part: str, value: float) -> "Circumferential":
        """The same pattern with one coefficient replaced."""
        kept = {"cos": self.coefficient(p, "cos"), "sin": self.coefficient(p, "sin")} | {part: value}
        others = tuple(h for h in self.harmonics if h[0] != p)
        return Circumferential(harmonics=(*others, (p, kept["cos"], kept["sin"])))


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticEdge:
    """An elastically embedded edge.

    Line springs k_r, k_theta, k_z [N/m per m] along the chart's directions, a rotational spring k_rot
    [N m/rad per m] on both rotations, and k_face [N/m^3], the foundation modulus on the end face: a shell of
    thickness t resting on it feels t k_face per length in all three directions and t^3/12 k_face in rotation.
    `around` makes all of them vary along the edge.

    Raises
    ------
    ValueError
        If a stiffness is negative or not finite, all are zero, or the pattern makes one negative.

    >>> ElasticEdge(k_face=1e13).held
    ()
    """

    k_r: float = 0.0
    k_theta: float = 0.0
    k_z: float = 0.0
    k_rot: float = 0.0
    k_face: float = 0.0
    around: Circumferential = Circumferential()

    held: ClassVar[tuple[int, ...]] = ()
    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"
    stiffness_names: ClassVar[tuple[str, ...]] = ("k_r", "k_theta", "k_z", "k_rot", "k_face")

    def __post_init__(self) -> None:
        values = {name: np.real(getattr(self, name)) for name in self.stiffness_names}
        for name, value in values.items():
            if not (np.isfinite(value) and value >= 0.0):
                raise ValueError(f"support.{name} must be finite and not negative, found {value!r}")
        if not any(values.values()):
            raise ValueError("an elastic support needs at least one of k_r, k_theta, k_z, k_rot, k_face above zero")
        finest = max((p for p, _, _ in self.around.harmonics), default=0)
        theta = np.linspace(0.0, 2.0 * np.pi, 721 + 16 * finest)
        lowest = float(np.real(self.around(theta)).min())
        if lowest < 0.0:
            raise ValueError(f"support.around makes the springs negative (factor {lowest:.3g}): reduce its harmonics")

    def line_stiffness(self, directions: Array, theta: Array, thickness: Array) -> tuple[Array, Array]:
        """Springs per length at points: displacement (..., 3, 3) and rotation (...,) [N/m^2, N]."""
        factor = self.around(theta)
        springs = np.array([self.k_r, self.k_theta, self.k_z])
        blocks = np.einsum("k,ki...,kj...->...ij", springs, directions, directions)
        face = self.k_face * thickness * factor
        blocks = blocks * factor[..., None, None] + face[..., None, None] * np.eye(3)
        return blocks, self.k_rot * factor + self.k_face * thickness**3 / 12.0 * factor


Support: TypeAlias = Clamped | ShearDiaphragm | ElasticEdge
