"""Static solution of an imported part: K u = f."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, frozen
from casingfem.linalg.factor import solve_held
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.imported.loads import MeshLoad, nodal_loads
from casingfem.structure.shell.static import NODAL, deflected
from contact.io.reported import Reported


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class MeshDeflection(Reported):
    """A static solution at the nodes of an imported mesh.

    Attributes
    ----------
    fields
        u_x, u_y, u_z [m], and w_1, w_2 [rad] of shells, (nodes, 3 or 5).
    energy
        Strain energy u^T K u/2 [J].
    """

    structure: MeshStructure
    fields: FloatArray
    energy: float

    def columns(self) -> dict[str, Any]:
        """One row a node: its number in the file, place and displacement [m], turns [rad]."""
        mesh = self.structure.mesh
        shown = mesh.present
        named = zip(("x_m", "y_m", "z_m", *NODAL), (*mesh.points[shown].T, *self.fields[shown].T), strict=False)
        return {"node": mesh.node_numbers[shown], **dict(named)}

    def __repr__(self) -> str:
        return deflected(self.fields, self.energy)

    def at(self, node: int) -> FloatArray:
        """Displacement (u_x, u_y, u_z) [m] of a node by its number in the file, (3,)."""
        mesh = self.structure.mesh
        place = mesh.present[mesh.node_numbers[mesh.present] == node]
        if not len(place):
            raise ModelError("load-place", f"{mesh.source}: displacement at node {node}, which no cell has")
        return np.asarray(self.fields[place[0], :3])


def solve_mesh_static(
    structure: MeshStructure, loads: Sequence[MeshLoad], *, system: MeshSystem | None = None
) -> MeshDeflection:
    """Displacements of a supported imported part under loads that act together; see `solve_static`."""
    if not loads:
        raise ModelError("load-none", "solve_static: found no loads, expected at least one")
    system = system or structure.assembled()
    nodal = np.zeros((len(system.points), system.dofs, 1))
    nodal[:, :3, 0] = np.sum([nodal_loads(structure, load) for load in loads], axis=0)
    u = solve_held(system.K, system.restrict(nodal)[:, 0])
    energy = 0.5 * float(u @ (system.K @ u))
    return MeshDeflection(structure=structure, fields=frozen(system.expand(u[:, None])[:, :, 0]), energy=energy)
