"""Supports of the edges of a shell.

A support either fixes motions (in Cartesian directions, or in the edge's own frame) or adds springs.
Springs act on the five dofs of a node: three displacements and two rotations.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, TypeAlias

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, read_only
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.field.field import Field, relative
from casingfem.structure.mesh.edge_form import EdgeLine, PointSprings, along_springs
from contact.io.brief import brief
from contact.io.keys import Key


@dataclass(frozen=True, slots=True, kw_only=True)
class Clamped:
    """All three displacements and both rotations are fixed.

    >>> Clamped().held
    (0, 1, 2, 3, 4)
    """

    held: ClassVar[tuple[int, ...]] = (0, 1, 2, 3, 4)
    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"


@dataclass(frozen=True, slots=True, kw_only=True)
class ShearDiaphragm:
    """Fixed normal to the surface and along the edge: v = w = 0 and no rotation along the edge; N = M = 0.

    v is along the edge and w along the surface's normal (on a cone that is not the radial direction). In the edge's
    frame the dofs are (in-plane normal to the edge, along the edge, surface normal, rotation of the normal across the
    edge, rotation of the normal along the edge); the first and fourth are free.

    >>> ShearDiaphragm().held
    (1, 2, 4)
    """

    held: ClassVar[tuple[int, ...]] = (1, 2, 4)
    frame: ClassVar[Literal["cartesian", "edge"]] = "edge"


@dataclass(frozen=True, slots=True, kw_only=True)
class Symmetry:
    """The edge lies in a plane of symmetry, normal to the surface: no motion crosses the plane.

    The displacement across the edge and the rotation of the normal across it are fixed.

    >>> Symmetry().held
    (0, 3)
    """

    held: ClassVar[tuple[int, ...]] = (0, 3)
    frame: ClassVar[Literal["cartesian", "edge"]] = "edge"


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticEdge:
    """An elastically embedded edge.

    Line springs k_r, k_theta, k_z [N/m per m] along the chart's directions, a rotational spring k_rot [N m/rad per m]
    on both rotations, and k_face [N/m^3], the foundation modulus on the end face: a shell of thickness t on it has the
    energy density k_face int (u + z w)^2 (1 - z b) dz per length, t k_face in all three directions, t^3/12 k_face in
    rotation, and -b t^3/12 k_face between them, with the edge's curvature b towards its normal.

    `around` makes them vary along the edge as k (1 + f): one Field f for all of them, or a mapping from a spring's
    name to its own field; springs that it does not name are uniform.

    Raises
    ------
    ModelError
        If a stiffness is negative or not finite, all are zero, or `around` names an unknown spring.

    >>> from casingfem.structure.field.fourier import FourierField
    >>> edge = ElasticEdge(k_r=1e8, k_z=1e9, around={"k_r": FourierField.of({8: 0.2})})
    >>> float(edge.factor("k_r", np.array(0.0), np.array(0.0))), edge.pattern("k_z")
    (1.2, None)
    """

    k_r: Annotated[float, Key("stiffness of radial springs per length of edge [N/m per m]", "not negative")] = 0.0
    k_theta: Annotated[float, Key("stiffness of tangential springs per length of edge [N/m per m]", "not negative")] = (
        0.0
    )
    k_z: Annotated[float, Key("stiffness of axial springs per length of edge [N/m per m]", "not negative")] = 0.0
    k_rot: Annotated[
        float, Key("stiffness of rotational springs per length of edge [N m/rad per m]", "not negative")
    ] = 0.0
    k_face: Annotated[float, Key("foundation modulus of the end face [N/m^3]", "not negative")] = 0.0
    around: Field | Mapping[str, Field] | None = None

    held: ClassVar[tuple[int, ...]] = ()
    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"
    stiffness_names: ClassVar[tuple[str, ...]] = ("k_r", "k_theta", "k_z", "k_rot", "k_face")

    __repr__ = brief

    def __post_init__(self) -> None:
        values = {name: np.real(getattr(self, name)) for name in self.stiffness_names}
        for name, value in values.items():
            if not (np.isfinite(value) and value >= 0.0):
                raise ModelError("support-springs", f"support.{name} must be finite and not negative, found {value!r}")
        if not any(values.values()):
            raise ModelError("support-no-springs", "found an elastic support whose stiffnesses are all 0")
        if isinstance(self.around, Mapping):
            known = ", ".join(self.stiffness_names)
            for name in self.around:
                if name not in self.stiffness_names:
                    found = f"support.around: found {name!r}, expected springs among {known}"
                    raise ModelError("support-springs", found)
            object.__setattr__(self, "around", read_only(self.around))

    @property
    def uniform(self) -> bool:
        """Whether the springs are uniform along the edge."""
        return not self.patterns

    def springs(self, line: EdgeLine) -> PointSprings:
        """The springs at the nodes of an edge, by its Lobatto rule."""
        at = line.nodal
        length = at.stretch * line.weights
        blocks, rotation = self.line_stiffness(at.directions, at.a, at.b, at.thickness)
        moment = -at.bend * self.k_face * self.factor("k_face", at.a, at.b) * at.thickness**3 / 12.0
        coupling = np.moveaxis(at.tangents * moment * length, -1, 0)
        nodes, values = line.nodes[:, None], np.ones((len(line.nodes), 1))
        return PointSprings(nodes, values, blocks * length[:, None, None], rotation * length, coupling)

    def pattern(self, spring: str) -> Field | None:
        """Relative variation of one spring along the edge; None if it is uniform."""
        return self.around.get(spring) if isinstance(self.around, Mapping) else self.around

    @property
    def patterns(self) -> dict[str, Field]:
        """The fields of the springs that vary, by name."""
        fields = {name: self.pattern(name) for name in self.stiffness_names}
        return {name: field for name, field in fields.items() if field is not None}

    def factor(self, spring: str, a: Array, b: Array) -> Array:
        """1 + f of one spring at parameters (a, b) of the chart."""
        return relative(self.pattern(spring), a, b)

    def line_stiffness(self, directions: Array, a: Array, b: Array, thickness: Array) -> tuple[Array, Array]:
        """Springs per length at parameters (a, b): displacement (..., 3, 3) and rotation (...,) [N/m^2, N]."""
        *k, k_rot, face = (getattr(self, name) * self.factor(name, a, b) for name in self.stiffness_names)
        blocks = along_springs(np.stack(k), directions) + (face * thickness)[..., None, None] * np.eye(3)
        return blocks, k_rot + face * thickness**3 / 12.0


Support: TypeAlias = Clamped | ShearDiaphragm | Symmetry | ElasticEdge | Bolts | Ring


def outer_support(support: object) -> object:
    """Support of the structure from outside: a ring's own support, else the support itself."""
    return support.support if isinstance(support, Ring) else support
