"""Common parts of imported solids and shells: the structure on a mesh, and its assembled system.

Dofs are numbered node by node, `dofs` on each: u_x, u_y, u_z, and on shells two rotations. Shells with walls that meet
at an angle have three rotations, of which nodes of a single wall use two (`mesh/joints.py`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from scipy.sparse import csc_array, csr_array

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.rotation import rigid_left
from casingfem.structure.imported.attachments.system import Connected, attached
from casingfem.structure.imported.attachments.ties import motions_of
from casingfem.structure.imported.cells.mapped import cell_dofs, on_free, symmetric
from casingfem.structure.imported.cells.support import MeshSupport
from casingfem.structure.imported.mesh.cell_kind import VTK
from casingfem.structure.imported.mesh.joints import Joints
from casingfem.structure.imported.mesh.mesh_data import MeshData
from contact.io.brief import brief

IDLE = 1e-9  # of the size of a force: its part along an idle motion that is round-off


class MeshStructure(Protocol):
    """Interface of a structure on a mesh: `Solid`, `MeshShell`, or one of your own.

    Modes, statics, reduction and everything based on them accept any object with these members.

    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u)
    >>> part: MeshStructure = cf.Solid(mesh=cube, material=cf.Material(E=210e9, nu=0.3, rho=7800.0))
    >>> part.mesh.kind, part.assembled().size
    ('tetra10', 81)
    """

    @property
    def mesh(self) -> MeshData:
        """Cells and nodes."""

    @property
    def supports(self) -> Mapping[str, MeshSupport]:
        """Group -> support."""

    def density(self) -> FloatArray:
        """Mass per volume or area of each cell, (cells,)."""

    def assembled(self) -> "MeshSystem":
        """The matrices on the free dofs."""


def require_structure(structure: object, what: str) -> None:
    """Refuse an object that does not satisfy `MeshStructure`, and list the missing members.

    Raises
    ------
    ModelError
        `structure-unknown`.
    """
    members = ("mesh", "supports", "density", "assembled")
    if lacking := [name for name in members if not hasattr(structure, name)]:
        found = f"{what}: found {type(structure).__name__}, which has no {', '.join(lacking)}"
        raise ModelError("structure-unknown", found)


class Walls(NamedTuple):
    """Walls of a shell that meet: their joints, and the stiffness on the dofs of the walls' nodes."""

    joints: Joints
    K: csc_array


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshSystem:
    """Matrices of an imported structure on its free dofs.

    Attributes
    ----------
    structure
        The structure.
    K, M
        Stiffness and consistent mass, (free, free), symmetric [SI].
    free
        Numbers of the free dofs among dofs * nodes; with `lift`, those of the unknowns; rotations of nodes are numbered
        after them.
    dofs
        Dofs of a node: 3 in solids, 5 in shells, 6 if walls of a shell meet.
    rigid
        Number of rigid motions that the supports allow, 0 to 6.
    wall
        Wall thickness t [m]; for solids twice the volume over the surface.
    frequency_scale
        Bending frequency c t/size^2 [rad/s] of the body as a flat plate: a lower bound for its elastic modes.
    tie
        Motions (free, unknowns) to which static states are restricted, as for a sector's faces; None if all are free.
    lift
        Dofs of the nodes by the unknowns, (dofs * nodes, free), if attachments tie some; None if each unknown is one of
        them.
    idle
        Motions of the nodes that have neither stiffness nor mass, (dofs * nodes, motions); None without attachments.
    connected
        All motions of a mesh with attachments; None without.
    walls
        If walls of a shell meet: motion of the walls' nodes, and the stiffness on their dofs; else None.

    Examples
    --------
    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u)
    >>> system = cf.Solid(mesh=cube, material=cf.Material(E=210e9, nu=0.3, rho=7800.0)).assembled()
    >>> system.size, system.dofs, system.rigid
    (81, 3, 6)
    """

    structure: MeshStructure
    K: csc_array
    M: csc_array
    free: IntArray
    dofs: int
    rigid: int
    wall: float
    frequency_scale: float
    tie: csc_array | None = None
    lift: csr_array | None = None
    idle: csr_array | None = None
    connected: Connected | None = None
    walls: Walls | None = None

    __repr__ = brief

    @property
    def cells(self) -> IntArray:
        """Cells for pictures: VTK cell type and nodes, (cells, 1 + nodes of a cell)."""
        mesh = self.structure.mesh
        return np.insert(mesh.cells, 0, VTK[mesh.kind], axis=1)

    @property
    def size(self) -> int:
        """Number of free dofs."""
        return len(self.free)

    @property
    def points(self) -> FloatArray:
        """Positions of the nodes, (nodes, 3)."""
        return self.structure.mesh.points

    def expand(self, vectors: Array) -> Array:
        """Free dofs (free, columns) -> nodal fields (nodes, dofs, columns), zero where fixed."""
        if self.lift is not None:
            return np.asarray((self.lift @ vectors).reshape(len(self.points), self.dofs, -1))
        full = np.zeros((len(self.points) * self.dofs, vectors.shape[1]), dtype=vectors.dtype)
        full[self.free] = vectors
        return full.reshape(len(self.points), self.dofs, -1)

    def restrict(self, forces: Array) -> Array:
        """Nodal forces (nodes, dofs, columns) -> free dofs (free, columns).

        Raises
        ------
        ModelError
            `load-idle` for forces that neither stiffness nor mass resists, with node and direction.
        """
        flat = forces.reshape(len(self.points) * self.dofs, -1)
        self.refuse_idle(flat)
        return np.asarray(flat[self.free] if self.lift is None else self.lift.T @ flat)

    def refuse_idle(self, forces: Array) -> None:
        """Refuse forces (dofs, columns) on a motion without stiffness and mass."""
        if self.idle is None or not self.idle.shape[1]:
            return
        size = np.abs(forces).max(axis=1, initial=0.0)
        most = (abs(self.idle).T @ size) * IDLE
        driven = np.flatnonzero(np.abs(self.idle.T @ forces).max(axis=1, initial=0.0) > most)
        if len(driven):
            column = np.abs(self.idle[:, [int(driven[0])]].toarray()[:, 0]) * size
            node, axis = divmod(int(column.argmax()), self.dofs)
            mesh = self.structure.mesh
            found = f"node {mesh.labels[node]} along {'xyz'[axis]}"
            raise ModelError("load-idle", f"{mesh.source}: found a force on {found}")

    def collect(self, fields: Array) -> Array:
        """Free dofs (free, columns) from nodal fields (nodes, dofs, columns) of `expand`."""
        if self.lift is None:
            return np.asarray(fields.reshape(len(self.points) * self.dofs, -1)[self.free])
        flat = fields.reshape(len(self.points) * self.dofs, -1)
        own = self.free < len(flat)
        found = np.zeros((self.size, flat.shape[1]), dtype=flat.dtype)
        found[own] = flat[self.free[own]]
        turns = self.lift[:, ~own].toarray()
        seen = np.flatnonzero(turns.any(axis=1))
        found[~own] = np.linalg.lstsq(turns[seen], (flat - self.lift @ found)[seen], rcond=None)[0]
        alone = np.flatnonzero(~own)[~turns.any(axis=0)]  # turns that move no node: known by statics
        if self.M.diagonal()[alone].any():
            source = self.structure.mesh.source
            raise ModelError(
                "mesh-attachment", f"{source}: found rotary inertia on a rotation that moves no other node"
            )
        if len(alone):
            found[alone] = -np.linalg.solve(self.K[:, alone][alone].toarray(), self.K[alone] @ found)
        return found

    def translations(self, axes: FloatArray) -> FloatArray:
        """Unit translations of the body along the rows of `axes` (k, 3) on the free dofs, (free, k)."""
        shift = np.zeros((len(self.points), self.dofs, len(axes)))
        shift[:, :3] = axes.T
        if self.lift is None:
            return np.asarray(self.restrict(shift))
        still = np.zeros((3 * len(self.points), len(axes)))  # more than there are turns behind the nodes
        return np.vstack([shift.reshape(-1, len(axes)), still])[self.free]

    @property
    def moving(self) -> BoolArray:
        """Whether each dof of the nodes moves, (nodes, dofs)."""
        mask = np.zeros(len(self.points) * self.dofs, dtype=bool)
        mask[self.free if self.lift is None else np.flatnonzero(np.diff(self.lift.indptr))] = True
        return mask.reshape(-1, self.dofs)


def assembled(
    structure: MeshStructure,
    K: csc_array,
    M: csc_array,
    springs: Sequence[csc_array],
    motions: FloatArray,
    wall: float,
    sound: float,
    joints: Joints | None = None,
) -> MeshSystem:
    """The system reduced to the free dofs, from matrices of the cells without supports, after attachments.

    Parameters
    ----------
    K, M
        Stiffness without springs, and mass, (all, all); for shells on the dofs of walls' nodes.
    springs
        Matrices of the elastic supports, (all, all) each.
    motions
        Rigid motions on the dofs of nodes, (dofs * nodes, 6).
    wall, sound
        Wall thickness [m], and the least speed of sound c = sqrt(E/rho) [m/s].
    joints
        For a shell: motion of the walls' nodes with its nodes.
    """
    mesh, size = structure.mesh, len(motions)
    dofs = size // len(mesh.points)
    held = held_dofs(structure, dofs)
    K = csc_array(sum(springs, K))
    walls = None
    if joints is not None and joints.motions is not None:
        walls = Walls(joints, K)
        K, M, *springs = (joints.on_nodes(A) for A in (K, M, *springs))
    scale = sound * wall / mesh.size**2
    if mesh.attachments:
        own, added = float(M[::dofs, ::dofs].sum()), sum(mass.mass for mass in mesh.attachments.masses)
        scale *= float(np.sqrt(own / (own + added)))
        joined = attached(motions_of(mesh, dofs, joints), K, M, held, still_nodes(structure), motions, springs)
        return MeshSystem(
            structure=structure, K=symmetric(joined.K), M=symmetric(joined.M), free=joined.unknowns, dofs=dofs,
            rigid=joined.rigid, wall=wall, frequency_scale=scale,
            lift=joined.lift if mesh.attachments.ties or joined.unknowns.max() >= size else None, idle=joined.idle,
            connected=joined.connected, walls=walls,
        )  # fmt: skip
    loose = np.zeros(size, dtype=bool)
    loose[cell_dofs(mesh.used[None], dofs)] = True
    loose[held] = False
    if walls is not None:
        loose[walls.joints.absent] = False
    free = np.flatnonzero(loose)
    return MeshSystem(
        structure=structure, K=on_free(K, free), M=on_free(M, free), free=free, dofs=dofs,
        rigid=rigid_left(motions, held, list(springs)), wall=wall, frequency_scale=scale,
        walls=walls,
    )  # fmt: skip


def still_nodes(structure: MeshStructure) -> IntArray:
    """Nodes whose rotation a support fixes, if they have rotations."""
    clamped = [name for name, support in structure.supports.items() if isinstance(support, Clamped)]
    groups = [structure.mesh.groups[name].nodes for name in clamped]
    return np.unique(np.concatenate([*groups, np.zeros(0, dtype=np.int64)]))


def held_dofs(structure: MeshStructure, dofs: int) -> IntArray:
    """Dofs fixed by clamps and fixed directions, `dofs` for each node."""
    held = [
        (name, range(dofs) if isinstance(support, Clamped) else support.held)
        for name, support in structure.supports.items()
    ]
    parts = [
        (structure.mesh.groups[name].nodes[:, None] * dofs + np.array(own, dtype=np.int64)).ravel()
        for name, own in held
    ]
    return np.unique(np.concatenate([*parts, np.zeros(0, dtype=np.int64)])).astype(np.int64)
