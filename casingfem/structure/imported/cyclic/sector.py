"""A wheel of equal sectors, described by one: u of sector j, in its rotated axes, is e^(i n alpha j) times u_0.

The faces are joined by u_high = e^(i n alpha) R u_low, with the rotation R by alpha = 2 pi/N. With T_n, which maps such
motions to the dofs of the sector, K(n) = T_n^H K T_n and M(n) = T_n^H M T_n are Hermitian, one pencil for each nodal
diameter n from 0 to N/2 (D. L. Thomas, Int. J. Numer. Meth. Eng. 14, 1979, 81). For 0 < n < N/2 each of its modes is a
pair of the wheel, cos and sin; for n = 0 and N/2 the pencil is real and each mode is single.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, BoolArray, FloatArray, frozen
from casingfem.structure.geometry.rotation import Rotation, Vector
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cells.shell import directors, tangent_frames
from casingfem.structure.imported.cells.support import Fixed
from casingfem.structure.imported.cyclic.faces import Pairs, Turn, paired_faces
from casingfem.structure.imported.mesh.findings import nodes_named
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.mesh.walls import FOLDED, cell_normals, walls_apart
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.imported.spin import MeshSpin

CLOSE = 1e-9  # round-off in directions and angles


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class CyclicSector:
    """One sector of a wheel: a solid or shell whose two faces match.

    Parameters
    ----------
    structure
        The sector with its supports; its `rotation`, if it has one, must be about the wheel's axis.
    sectors
        Number of sectors in the wheel, N >= 2.
    axis, point
        The wheel's axis, and a point on it [m].
    faces
        Groups of the faces; by default nodes that match after rotation by 2 pi/N.
    tolerance
        Largest distance of paired nodes [m]; by default a thousandth of the shortest edge.

    Raises
    ------
    ModelError
        `cyclic-sectors`, `cyclic-faces`, `cyclic-support` or `cyclic-axis`.

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 2, 2), lambda u: wall(u * [1.0, 0.125, 1.0]))
    >>> steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> wheel = cf.imported.CyclicSector(structure=cf.Solid(mesh=part, material=steel), sectors=8)
    >>> wheel.diameters, len(wheel.pairs.low)
    ((0, 1, 2, 3, 4), 13)
    """

    structure: Solid | MeshShell
    sectors: int
    axis: Vector = (0.0, 0.0, 1.0)
    point: Vector = (0.0, 0.0, 0.0)
    faces: tuple[str, str] | None = None
    tolerance: float | None = None
    pairs: Pairs = field(init=False, repr=False)

    def __post_init__(self) -> None:
        part: object = self.structure
        if not isinstance(part, Solid | MeshShell):
            raise ModelError("structure-unknown", f"cyclic: found {type(part).__name__}, expected a Solid or MeshShell")
        if self.sectors < 2:
            raise ModelError("cyclic-sectors", f"cyclic.sectors: found {self.sectors}, expected 2 or more")
        Rotation(omega=0.0, axis=self.axis, centre=self.point)  # refuses an axis without direction
        for name, support in self.structure.supports.items():
            across = np.diag(np.isin(np.arange(3), support.held).astype(float))
            if isinstance(support, Fixed) and not np.allclose(self.turn.matrix @ across, across @ self.turn.matrix):
                found = f"found fixed {', '.join(support.directions)}, which differ from sector to sector"
                raise ModelError("cyclic-support", f"cyclic: support.{name}: {found}")
        require_axis(self.structure.rotation, self.turn)
        if attached := self.structure.mesh.attachments:
            found = f"found a sector with {attached}, expected none on a sector"
            raise ModelError("mesh-attachment", f"{self.structure.mesh.source}: {found}")
        if isinstance(part, MeshShell) and len(meeting := walls_apart(part.mesh, FOLDED).meeting):
            found = f"found a sector with walls that meet at an angle, at {nodes_named(part.mesh, meeting)}"
            raise ModelError("mesh-branch", f"{part.mesh.source}: {found}")
        pairs = paired_faces(self.structure.mesh, self.turn, self.faces, self.tolerance)
        object.__setattr__(self, "pairs", Pairs(frozen(pairs.low), frozen(pairs.high)))
        if isinstance(self.structure, MeshShell):
            mesh = replace(self.structure.mesh, directors=joint_directors(self.structure.mesh, pairs, self.turn))
            object.__setattr__(self, "structure", replace(self.structure, mesh=mesh))

    @property
    def turn(self) -> Turn:
        """The rotation by one sector's angle."""
        return Turn(self.axis, self.point, 2.0 * np.pi / self.sectors)

    @property
    def diameters(self) -> tuple[int, ...]:
        """Every nodal diameter of the wheel: 0 .. N/2."""
        return tuple(range(self.sectors // 2 + 1))

    def count(self, n: int) -> int:
        """Number of modes of the wheel for one mode of the sector with n diameters: two, or one for n = 0 and N/2."""
        return 1 if 2 * n in (0, self.sectors) else 2


def require_axis(rotation: Rotation | None, turn: Turn) -> None:
    """Refuse a part whose axis of rotation differs from that of the wheel."""
    if rotation is None:
        return
    own = Rotation(omega=0.0, axis=turn.axis, centre=turn.point)
    away = own.plane @ (np.asarray(rotation.centre) - np.asarray(turn.point))
    if abs(own.direction @ rotation.direction) < 1.0 - CLOSE or np.linalg.norm(away) > CLOSE:
        found = f"found axis {rotation.axis} through {rotation.centre}"
        raise ModelError("cyclic-axis", f"rotation: {found}, expected {turn.axis} through {turn.point}, as in cyclic")


def joint_directors(mesh: MeshData, pairs: Pairs, turn: Turn) -> FloatArray:
    """Directors of a shell sector, on its faces averaged over the cells of both sectors, (nodes, 3)."""
    total = np.zeros_like(mesh.points)
    np.add.at(total, mesh.cells, cell_normals(mesh))
    both = total[pairs.low] + total[pairs.high] @ turn.matrix  # the high face's, turned back
    own = pairs.low != pairs.high
    total[pairs.low[own]], total[pairs.high[own]] = both[own], both[own] @ turn.matrix.T
    size = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(size > 0.0, total / np.maximum(size, np.finfo(float).tiny), [0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class CyclicSystem:
    """Matrices of a sector on its free dofs, at its speed, and the connection of its faces.

    Attributes
    ----------
    sector
        The sector that was assembled.
    system
        The sector with its faces free, at its speed.
    spin
        Terms that rotation adds to the matrices at rest; None without rotation.
    turns
        Matrices from the dofs of each low node to those of its partner, (pairs, dofs, dofs).
    """

    sector: CyclicSector
    system: MeshSystem
    spin: MeshSpin | None
    turns: FloatArray

    @property
    def frequency_scale(self) -> float:
        """Bending frequency c t/size^2 [rad/s] of the whole wheel as a flat plate."""
        mesh = self.sector.structure.mesh
        across = 2.0 * np.abs(self.sector.turn.across(mesh.points[mesh.used])).max()
        return float(self.system.frequency_scale * (mesh.size / np.hypot(mesh.size, across)) ** 2)

    def tie(self, n: int) -> csc_array:
        """T_n: motions with n diameters -> free dofs, (free, unknowns); real for n = 0 and N/2."""
        return tie(self.sector, self.system, self.turns, n)

    def matrices(self, n: int) -> tuple[csc_array, csc_array, csc_array]:
        """K(n), M(n) and T_n."""
        T = self.tie(n)
        return tied(self.system.K, T), tied(self.system.M, T), T


def assemble_cyclic(sector: CyclicSector) -> CyclicSystem:
    """Assemble a sector; its prestress, if it rotates, is that of the wheel.

    Raises
    ------
    ModelError
        `cyclic-support` if a support fixes a node of one face and not its partner; `static-loose` as in `spin`.
    """
    structure: Any = sector.structure
    rotation: Rotation | None = structure.rotation
    system = replace(structure, rotation=None).assembled()
    turns = node_turns(sector, system.dofs)
    if rotation is None:
        return CyclicSystem(sector=sector, system=system, spin=None, turns=turns)
    added = structure.spin(replace(system, tie=tie(sector, system, turns, 0)), rotation)
    turning = replace(system, structure=structure, K=csc_array(system.K + added.stiffness(rotation.omega)))
    return CyclicSystem(sector=sector, system=turning, spin=added, turns=turns)


def node_turns(sector: CyclicSector, dofs: int) -> FloatArray:
    """Transformation of the dofs of each low node to those of its partner: displacements, and rotations of shells."""
    R, (low, high) = sector.turn.matrix, sector.pairs
    turns = np.zeros((len(low), dofs, dofs))
    turns[:, :3, :3] = R
    if dofs > 3:
        frames = tangent_frames(directors(sector.structure.mesh))
        turns[:, 3:, 3:] = np.einsum("pac,cd,pbd->pab", frames[high], R, frames[low])
    return turns


def tie(sector: CyclicSector, system: MeshSystem, turns: FloatArray, n: int) -> csc_array:
    """T_n of a sector; see `CyclicSystem.tie`."""
    (low, high), dofs = sector.pairs, system.dofs
    loose = np.zeros((len(system.points), dofs), dtype=bool)
    loose.ravel()[system.free] = True
    require_alike(sector, loose)
    whole = sector.count(n) == 1
    phase: complex | float = np.cos(np.pi * bool(n)) if whole else np.exp(1j * n * sector.turn.angle)
    kept = loose.copy()
    kept[high] = False  # nodes on the axis too
    unknowns = int(np.count_nonzero(kept))
    column = np.full(loose.shape, -1)
    column[kept] = np.arange(unknowns)
    place = np.full(loose.shape, -1)  # of a dof among the free ones
    place.ravel()[system.free] = np.arange(system.size)
    own = low != high
    first, last, R = low[own], high[own], turns[own]
    pair, i, j = np.nonzero(loose[last][:, :, None] & loose[first][:, None, :] & (np.abs(R) > 1e-15))
    rows, columns = [place[kept], place[last[pair], i]], [column[kept], column[first[pair], j]]
    values = [np.ones(unknowns, dtype=type(phase)), phase * R[pair, i, j]]
    for node, turn in zip(low[~own], turns[~own], strict=True):  # u = e^(i n alpha) R u
        moves = still_motions(turn, loose[node], phase)
        rows.append(np.repeat(place[node, loose[node]], moves.shape[1]))
        columns.append(np.tile(unknowns + np.arange(moves.shape[1]), len(moves)))
        values.append(moves.ravel())
        unknowns += moves.shape[1]
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return coo_array(entries, shape=(system.size, unknowns)).tocsc()


def require_alike(sector: CyclicSector, loose: BoolArray) -> None:
    """Refuse supports that fix a node of one face and not its partner; `loose` are the free dofs (nodes, dofs)."""
    low, high = sector.pairs
    uneven = np.flatnonzero((loose[low] != loose[high]).any(axis=1))
    if len(uneven):
        mesh = sector.structure.mesh
        one, other = mesh.labels[low[uneven[0]]], mesh.labels[high[uneven[0]]]
        found = f"node {one} of one face and node {other} of the other have different supports"
        raise ModelError("cyclic-support", f"{mesh.source}: {found}")


def still_motions(turn: FloatArray, loose: BoolArray, phase: complex) -> Array:
    """Motions of a node on the axis that rotation and phase leave unchanged, orthonormal columns."""
    free = np.flatnonzero(loose)
    if not len(free):
        return np.zeros((0, 0))
    _, size, V = np.linalg.svd(np.eye(len(free)) - phase * turn[np.ix_(free, free)])
    return np.asarray(V[size < 1e-6].conj().T)


def tied(A: csc_array, T: csc_array) -> csc_array:
    """T^H A T, exactly Hermitian for a symmetric A."""
    B = csc_array(T.conj().T @ A @ T)
    return csc_array(0.5 * (B + B.conj().T))
