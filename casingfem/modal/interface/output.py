"""Outputs of a reduced structure: displacement, strain or stress at named points, as rows over its nodal fields.

Points are on the chart of a shell, or nodes of an imported part, where strain and stress of solids are averaged over
the node's cells. With nodal fields u, an output is row u = (row Phi) q + (row R) lam. It contains modes and residual,
so it is also valid at the contact. A shell's strain comes from its own kinematics (`structure.kinematics`).
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.modal.interface.mesh_rows import node_places
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cells.solid import COMPONENTS, elasticity, strain_table
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions
from casingfem.structure.imported.mesh.collapsed import distinct, native
from casingfem.structure.imported.solid import Solid
from casingfem.structure.mesh.kinematics import DOFS, frame, strain_slots
from casingfem.structure.mesh.place import place_jets
from casingfem.structure.shell.system import System
from casingfem.structure.shell.wall import curvature, strain_rows

DIRECTIONS = ("x", "y", "z", "normal", "radial", "tangential")
STRAINS = {"11": 0, "22": 1, "12": 2}
INWARD = 1e-6  # of the way to the middle of a cell


@dataclass(frozen=True, slots=True, kw_only=True)
class Displacement:
    """Displacement [m] at parameters `at` of the chart: along x, y, z, the surface's normal, or around the z axis.

    >>> Displacement(name="tip", at=(0.1, 0.0), direction="normal").name
    'tip'
    """

    name: str
    at: tuple[float, float]
    direction: str = "normal"

    def row(self, system: System) -> FloatArray:
        """Row over the nodal fields, (nodes, 5)."""
        if self.direction not in DIRECTIONS:
            raise ModelError("output-direction", f"output {self.name!r}: found direction {self.direction!r}")
        nodes, jets = jets_at(system, self.name, self.at)
        surface = system.shell.geometry(*(np.array([v]) for v in self.at)).surface
        x, y, _ = surface.x[:, 0]
        r = np.hypot(x, y)
        around = {"radial": (x, y, 0.0), "tangential": (-y, x, 0.0)}
        if self.direction in around and r == 0.0:
            raise ModelError("output-direction", f"output {self.name!r}: found {self.direction} on the axis")
        unit = frame(surface).normal[:, 0] if self.direction == "normal" else np.zeros(3)
        if self.direction in around:
            unit = np.array(around[self.direction]) / r
        elif self.direction != "normal":
            unit["xyz".index(self.direction)] = 1.0
        row = np.zeros((system.grid.nodes.shape[1], DOFS))
        row[nodes, :3] = jets[0][:, None] * unit
        return row


@dataclass(frozen=True, slots=True, kw_only=True)
class Strain:
    """Strain [-] at parameters `at` and z = side t/2: component "11" (along the span), "22", "12" (2 eps_12).

    eps + z chi, on a curved wall with the metric there (`structure.shell.wall.strain_rows`). `side` +1 on the face the
    normal points to, -1 on the other, 0 at mid-surface.

    >>> Strain(name="root", at=(0.0, 0.0)).component
    '11'
    """

    name: str
    at: tuple[float, float]
    component: str = "11"
    side: float = 1.0

    def row(self, system: System) -> FloatArray:
        """Row over the nodal fields, (nodes, 5)."""
        if self.component not in STRAINS or not -1.0 <= self.side <= 1.0:
            found = f"component {self.component!r}, side {self.side!r}"
            raise ModelError("output-direction", f"output {self.name!r}: found {found}")
        nodes, jets = jets_at(system, self.name, self.at)
        geometry = system.shell.geometry(*(np.array([v]) for v in self.at))
        L, rates = strain_slots(geometry.surface)
        b = curvature(rates) if system.shell.wall == "curved" else np.zeros((3, 1))
        rows = strain_rows(b, 0.5 * self.side * geometry.thickness)[0, STRAINS[self.component]]
        slots = np.einsum("r,krc->kc", rows, L[:, :6, :, 0])
        row = np.zeros((system.grid.nodes.shape[1], DOFS))
        row[nodes] = jets.T @ slots
        return row


class Output(Protocol):
    """Interface of a quantity stored with a basis: a name, and a row over the nodal fields of the structure."""

    @property
    def name(self) -> str:
        """Name of the output in a run."""

    def row(self, system: Any) -> FloatArray:
        """Row over the nodal fields, (nodes, dofs of a node)."""


def output_rows(system: System | MeshSystem, outputs: tuple[Output, ...]) -> FloatArray:
    """Rows of all outputs, (outputs, dofs * nodes)."""
    names = [output.name for output in outputs]
    if len(set(names)) < len(names):
        raise ModelError("output-name", f"outputs: found the names {', '.join(names)}, expected each once")
    rows = [output.row(system).ravel() for output in outputs]
    return np.array(rows).reshape(len(rows), len(system.points) * system.dofs)


def jets_at(system: System, name: str, at: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Nodes (functions,) and weights of value and slopes (3, functions) at one point."""
    if not isinstance(system, System):
        raise ModelError("output-place", f"output {name!r}: found parameters of a chart on an imported part")
    try:
        nodes, jets = place_jets(system.grid, np.array([at[0]]), np.array([at[1]]))
    except ValueError as error:
        raise ModelError("output-place", f"output {name!r}: {error}") from error
    return nodes[0], jets[:, 0]


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
    """Strain or stress of a solid at a node, averaged over its cells."""

    name: str
    node: int
    component: str
    stress: ClassVar[bool]

    def row(self, system: MeshSystem) -> FloatArray:
        """Row over the nodal fields, (nodes, dofs)."""
        place, solid = node_place(system, self.name, self.node), system.structure
        if not isinstance(solid, Solid):
            found = f"a {type(solid).__name__}, expected a Solid, since strains at nodes are computed for solids only"
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
    """Index of an output's node; ModelError on a chart, or if no cell has it."""
    if not isinstance(system, MeshSystem):
        raise ModelError(
            "output-place", f"output {name!r}: found node {node} on a chart, expected a place by its parameters"
        )
    try:
        return int(node_places(system, (node,))[0])
    except ModelError as error:
        raise ModelError("output-place", f"output {name!r}: found node {node}, expected a node of a cell") from error


def strains_at(points: FloatArray, kind: str, nodes: IntArray, local: IntArray, D: FloatArray | None) -> FloatArray:
    """Strains, or stresses with elasticities D (cells, 6, 6), of cells, each at one of its nodes, (cells, 6, 3 k)."""
    places = KINDS[kind].places
    if kind == "pyramid13" or (distinct(nodes) < 0).any():  # where the map has no inverse: beside that node it has one
        places = places + INWARD * (places.mean(axis=0) - places)
    _, slopes = shape_functions(kind, np.ascontiguousarray(places.T))
    tangents = np.einsum("dke,ekc->edc", slopes[:, :, local], points[nodes])
    gradients = np.linalg.solve(tangents, slopes[:, :, local].transpose(2, 0, 1))  # dN/dx, (cells, 3, nodes)
    table = strain_table(gradients)
    return table if D is None else np.asarray(D @ table)
