"""Static loads on imported parts, as nodal forces in Cartesian axes, and the deflection under them, K u = f.

`Gravity`, `EdgeLoad` (per area of a solid's facets, per length of a shell's edge), `Pressure` and `SurfaceLoad` (on the
wall of a shell) are those of the shells on charts; forces at nodes and pressures on a solid's facets are here. A load
of your own has `on_mesh(structure) -> (nodes, 3)`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.linalg.factor import solve_held
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.imported.cells.mapped import Mapped, mapped, mapped_parts
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.shell.loads import EdgeLoad, Gravity, Pressure, SurfaceLoad, Vector
from casingfem.structure.shell.static import NODAL, deflected
from contact.io.reported import Reported


@runtime_checkable
class OnMesh(Protocol):
    """Interface of a load with nodal forces on an imported part."""

    def on_mesh(self, structure: MeshStructure) -> FloatArray:
        """Nodal forces [N], (nodes, 3)."""


MeshLoad: TypeAlias = OnMesh | Gravity | EdgeLoad | Pressure | SurfaceLoad


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeLoad:
    """A force [N] at a node, by its number in the file.

    The displacement at the node grows without limit as the mesh is refined; elsewhere it converges.

    >>> NodeLoad(node=6, force=(0.0, 0.0, 1.0)).node
    6
    """

    node: int
    force: Vector

    def on_mesh(self, structure: MeshStructure) -> FloatArray:
        """Nodal forces [N], (nodes, 3)."""
        mesh = structure.mesh
        place = mesh.present[mesh.node_numbers[mesh.present] == self.node]
        if not len(place):
            found = f"found a load at node {self.node}, expected a node of a cell"
            raise ModelError("load-place", f"{mesh.source}: {found}")
        loads = np.zeros_like(mesh.points)
        loads[place[0]] = self.force
        return loads


@dataclass(frozen=True, slots=True, kw_only=True)
class FacetPressure:
    """A pressure [Pa] on the facets of a solid's group, against their outward normal.

    >>> FacetPressure(group="skin", pressure=1e5).pressure
    100000.0
    """

    group: str
    pressure: float

    def on_mesh(self, structure: MeshStructure) -> FloatArray:
        """Nodal forces [N], (nodes, 3)."""
        mesh = structure.mesh
        if mesh.cell_kind.dim != 3:
            raise ModelError("load-edge", f"{mesh.source}: found a FacetPressure on a shell, expected a Pressure")
        loads = np.zeros_like(mesh.points)
        for on, nodes in group_facets(mesh, self.group):
            normal = np.cross(on.tangents[:, :, 0], on.tangents[:, :, 1])  # of the size of the area
            unit = normal / np.linalg.norm(normal, axis=2, keepdims=True)
            loads += spread(mesh, on, nodes, -self.pressure * unit)
        return loads


def nodal_loads(structure: MeshStructure, load: object) -> FloatArray:
    """Nodal forces of a load, (nodes, 3), or with the moments on directors, (nodes, 5).

    Raises
    ------
    ModelError
        `load-edge` for a load that imported parts do not support.
    """
    mesh = structure.mesh
    match load:
        case OnMesh():
            return load.on_mesh(structure)
        case Gravity():
            loads = weight(structure, load.acceleration)
            for mass in mesh.attachments.masses:
                if any(mass.offset):
                    found = f"{mesh.source}: found Gravity and {mass.where} beside its node, expected it at the node"
                    raise ModelError("load-edge", found)
                loads[mass.node, :3] += mass.mass * np.asarray(load.acceleration)
            return loads
        case EdgeLoad():
            force = np.asarray(load.force)
            parts = (spread(mesh, on, nodes, force) for on, nodes in group_facets(mesh, load.edge))
            return np.asarray(sum(parts, np.zeros_like(mesh.points)))
        case Pressure() | SurfaceLoad() if mesh.cell_kind.dim == 2:
            loads = np.zeros_like(mesh.points)
            for _, nodes, on in mapped_parts(mesh):
                normal = np.cross(on.tangents[:, :, 0], on.tangents[:, :, 1])
                unit = normal / np.linalg.norm(normal, axis=2, keepdims=True)
                force = np.asarray(load.force) if isinstance(load, SurfaceLoad) else load.pressure * unit
                loads += spread(mesh, on, nodes, force)
            return loads
    found = f"found a {type(load).__name__}, which cannot act on a mesh of {mesh.kind} cells"
    raise ModelError("load-edge", f"{mesh.source}: {found}")


def weight(structure: MeshStructure, acceleration: Vector) -> FloatArray:
    """Nodal forces of the cells' mass, (nodes, 3), of a shell with moments on its directors, (nodes, 5)."""
    if isinstance(structure, MeshShell):
        return structure.weight(acceleration)
    loads, density = np.zeros_like(structure.mesh.points), structure.density()
    for rows, nodes, on in mapped_parts(structure.mesh):
        loads += spread(structure.mesh, on, nodes, density[rows, None, None] * np.asarray(acceleration))
    return loads


def group_facets(mesh: MeshData, name: str) -> list[tuple[Mapped, IntArray]]:
    """The facets of a group, mapped, and their nodes, kind by kind."""
    check_groups(mesh, [name])
    facets = mesh.group_facets(name)
    if not len(facets):
        raise ModelError("mesh-group-no-facets", f"{mesh.source}: found a load on group {name!r} without facets")
    nodes = mesh.facet_nodes(facets)
    parts = [(kind, nodes[rows][:, slots]) for kind, rows, slots in native(mesh.cell_kind.facet, nodes)]
    return [(mapped(kind, mesh.points, own), own) for kind, own in parts]


def spread(mesh: MeshData, on: Mapped, nodes: IntArray, density: FloatArray) -> FloatArray:
    """Nodal forces of a force per volume, area or length, given at the points (cells, q, 3) or uniform."""
    loads, density = np.zeros_like(mesh.points), np.broadcast_to(density, on.x.shape)
    np.add.at(loads, nodes, np.einsum("kq,eq,eqc->ekc", on.values, np.abs(on.measure), density, optimize=True))
    return loads


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class MeshDeflection(Reported):
    """A static solution at the nodes of an imported mesh.

    Attributes
    ----------
    fields
        u_x, u_y, u_z [m], for shells also w_1, w_2 [rad], and a third rotation if walls meet, (nodes, 3, 5 or 6).
    energy
        Strain energy u^T K u/2 [J].

    Examples
    --------
    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u, groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=cube, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> found = cf.solve_static(held, [cf.imported.FacetPressure(group="top", pressure=1e6)])
    >>> found.fields.shape[1], bool(found.energy > 0.0)
    (3, True)
    """

    structure: MeshStructure
    fields: FloatArray
    energy: float

    def columns(self) -> dict[str, Any]:
        """One row for each node: its number in the file, position and displacement [m], rotations [rad]."""
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
            raise ModelError("load-place", f"{mesh.source}: found node {node}, expected a node of a cell")
        return np.asarray(self.fields[place[0], :3])


def solve_mesh_static(
    structure: MeshStructure, loads: Sequence[MeshLoad], *, system: MeshSystem | None = None
) -> MeshDeflection:
    """Displacements of a supported imported part under simultaneous loads; see `solve_static`."""
    if not loads:
        raise ModelError("load-none", "solve_static: found no loads, expected at least one")
    system = system or structure.assembled()
    nodal = np.zeros((len(system.points), system.dofs, 1))
    for load in loads:
        felt = nodal_loads(structure, load)
        nodal[:, : felt.shape[1], 0] += felt
    u = solve_held(system.K, system.restrict(nodal)[:, 0])
    energy = 0.5 * float(u @ (system.K @ u))
    return MeshDeflection(structure=structure, fields=frozen(system.expand(u[:, None])[:, :, 0]), energy=energy)
