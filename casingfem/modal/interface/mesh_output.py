"""Outputs at nodes of an imported part: displacement; strain and stress of solids, the mean over the node's cells."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.modal.interface.mesh_rows import node_places
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cells.solid import COMPONENTS, elasticity, strain_table
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions
from casingfem.structure.imported.mesh.collapsed import distinct, native
from casingfem.structure.imported.solid import Solid

INWARD = 1e-6  # of the way to the middle of a cell


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeDisplacement:
    """Displacement [m] of a node, by its number in the file, along x, y or z.

    >>> NodeDisplacement(name="tip", node=6, direction="z").node
    6
    """

    name: str
    node: int
    direction: str

    def row(self, system: MeshSystem) -> FloatArray:
        """Row over the nodal fields, (nodes, dofs)."""
        if self.direction not in ("x", "y", "z"):
            raise ModelError("output-direction", f"output {self.name!r}: found direction {self.direction!r}")
        row = np.zeros((len(system.points), system.dofs))
        row[node_place(system, self.name, self.node), "xyz".index(self.direction)] = 1.0
        return row


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeMean:
    """Strain or stress of a solid at a node, the mean of what each of its cells has there."""

    name: str
    node: int
    component: str
    stress: ClassVar[bool]

    def row(self, system: MeshSystem) -> FloatArray:
        """Row over the nodal fields, (nodes, dofs)."""
        place, solid = node_place(system, self.name, self.node), system.structure
        if not isinstance(solid, Solid):
            found = f"a {type(solid).__name__}, expected a Solid: strains at nodes are those of solids"
            raise ModelError("output-place", f"output {self.name!r}: found {found}")
        if self.component not in COMPONENTS:
            raise ModelError("output-direction", f"output {self.name!r}: found component {self.component!r}")
        mesh = solid.mesh
        cells, local = np.nonzero(mesh.cells == place)
        cells, first = np.unique(cells, return_index=True)
        row = np.zeros((len(system.points), system.dofs))
        for kind, rows, slots in native(mesh.kind, mesh.cells[cells]):
            nodes = mesh.cells[cells[rows]][:, slots]
            at = local[first[rows]] if kind == mesh.kind else (nodes == place).argmax(axis=1)
            D = elasticity(solid.constants()[:, cells[rows]]) if self.stress else None
            table = strains_at(mesh.points, kind, nodes, at, D)[:, COMPONENTS.index(self.component)]
            np.add.at(row[:, :3], nodes, table.reshape(len(nodes), -1, 3) / len(cells))
        return row


class NodeStrain(NodeMean):
    """Strain [-] of a solid at a node: "xx", "yy", "zz", or the shear angle "yz", "xz", "xy" (2 eps_yz, ...).

    >>> NodeStrain(name="root", node=3, component="xx")
    NodeStrain(name='root', node=3, component='xx')
    """

    __slots__ = ()
    stress = False


class NodeStress(NodeMean):
    """Stress [Pa] of a solid at a node: "xx", "yy", "zz", "yz", "xz", "xy".

    >>> NodeStress(name="root", node=3, component="xx")
    NodeStress(name='root', node=3, component='xx')
    """

    __slots__ = ()
    stress = True


def node_place(system: MeshSystem, name: str, node: int) -> int:
    """Index of an output's node; ModelError on a chart, or where no cell has it."""
    if not isinstance(system, MeshSystem):
        raise ModelError("output-place", f"output {name!r}: found node {node} of a chart, whose nodes have no numbers")
    try:
        return int(node_places(system, (node,))[0])
    except ModelError as error:
        raise ModelError("output-place", f"output {name!r}: found node {node}, which no cell has") from error


def strains_at(points: FloatArray, kind: str, nodes: IntArray, local: IntArray, D: FloatArray | None) -> FloatArray:
    """Strains, or stresses of elasticities D (cells, 6, 6), of cells each at one of its nodes, (cells, 6, 3 k)."""
    places = KINDS[kind].places
    if kind == "pyramid13" or (distinct(nodes) < 0).any():  # where the map has no inverse: beside that node it has one
        places = places + INWARD * (places.mean(axis=0) - places)
    _, slopes = shape_functions(kind, np.ascontiguousarray(places.T))
    tangents = np.einsum("dke,ekc->edc", slopes[:, :, local], points[nodes])
    gradients = np.linalg.solve(tangents, slopes[:, :, local].transpose(2, 0, 1))  # dN/dx, (cells, 3, nodes)
    table = strain_table(gradients)
    return table if D is None else np.asarray(D @ table)
