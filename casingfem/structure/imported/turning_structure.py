"""Rotation of structures: the protocol of parts that rotate, and the rotation of any structure."""

from typing import Protocol, runtime_checkable

from casingfem.errors import ModelError
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.imported.spin import MeshSpin, MeshTurning
from casingfem.structure.shell.shell import Shell


@runtime_checkable
class TurningStructure(MeshStructure, Protocol):
    """A structure that models its rotation: `Solid`, `MeshShell`, or a frozen dataclass of your own.

    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u)
    >>> part: TurningStructure = cf.Solid(mesh=cube, material=cf.Material(E=210e9, nu=0.3, rho=7800.0))
    >>> part.rotation is None
    True
    """

    @property
    def rotation(self) -> Rotation | None:
        """Speed and axis; None at rest."""

    def spin(self, at_rest: MeshSystem, rotation: Rotation) -> MeshSpin:
        """Stiffness and gyroscopic matrices that rotation adds to the matrices at rest."""

    def turning(self, at_rest: MeshSystem, rotation: Rotation) -> MeshTurning:
        """Centrifugal load, and the matrices that rotation adds between modes."""


def rotation_of(structure: Shell | MeshStructure) -> Rotation | None:
    """Rotation of a structure; None at rest and for a structure without the attribute.

    Raises
    ------
    ModelError
        `structure-unknown` for a structure with a rotation that lacks other members of `TurningStructure`.
    """
    rotation: Rotation | None = getattr(structure, "rotation", None)
    if rotation is None or isinstance(structure, Shell | TurningStructure):
        return rotation
    lacking = [name for name in ("spin", "turning") if not hasattr(structure, name)]
    found = f"rotation: found a rotating {type(structure).__name__} without {' and '.join(lacking)}"
    raise ModelError("structure-unknown", f"{found}, expected the members of cf.imported.TurningStructure")
