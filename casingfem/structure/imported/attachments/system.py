"""Matrices of a mesh with attachments: masses and springs added, tied motions eliminated, K = T^T K T."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import qr
from scipy.sparse import coo_array, csc_array, csr_array, hstack
from scipy.sparse.csgraph import connected_components

from casingfem.errors import warn
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.geometry.rotation import unfelt
from casingfem.structure.imported.attachments.ties import Motions, Rows, eliminated, tied_rows
from casingfem.structure.imported.attachments.turning import as_rows, summed
from casingfem.structure.imported.mesh.findings import nodes_named
from casingfem.structure.imported.mesh.mesh_data import MeshData

ROUND = 1e-9  # motions, of the size of one, below which a spring or an equation does not feel them
LOOSE = 1e-12  # least stiffness and mass of a node's six motions, each scaled to one, below which one of them is free


class Attached(NamedTuple):
    """System of a mesh with attachments.

    K, M on the unknowns, not yet made symmetric; `lift` of the dofs of nodes by unknowns; `unknowns` among dofs of
    nodes and the rotations after them; remaining rigid motions; `idle` motions of nodes without stiffness and mass;
    `connected`, the data for forces in connections.
    """

    K: csc_array
    M: csc_array
    lift: csr_array
    unknowns: IntArray
    rigid: int
    idle: csr_array
    connected: "Connected"


class Connected(NamedTuple):
    """All motions of a mesh with attachments: dependent motions, motions by unknowns, stiffness on all motions."""

    rows: Rows
    whole: csr_array
    K: csc_array


def attached(
    motions: Motions,
    K: csc_array,
    M: csc_array,
    held: IntArray,
    still: IntArray,
    fields: FloatArray,
    supports: Sequence[csc_array] = (),
) -> Attached:
    """Add masses and springs to matrices of all dofs, and eliminate tied dofs.

    Parameters
    ----------
    K, M
        Matrices of the cells with supports, on all dofs of nodes.
    held, still
        Dofs that supports fix; nodes whose rotations supports fix too.
    fields
        Rigid motions on all dofs of nodes, (dofs, 6).
    supports
        Springs of the elastic supports, already in K, on all dofs of nodes.

    Raises
    ------
    ModelError
        `mesh-attachment`, with card and node, for an impossible attachment.
    """
    mesh, size = motions.mesh, motions.size
    turns = np.array([motions.turn(node) for node in still if motions.turn(node) >= 0], dtype=np.int64)
    held = np.concatenate([held, (turns[:, None] + np.arange(3)).ravel()])
    rows = tied_rows(motions, held)
    refuse_held(motions, rows, held)
    R = eliminated(rows)
    warn_floating(mesh, held // motions.dofs)  # turns, behind the dofs of nodes, are of no node
    springs = spring_rows(motions)
    k = np.array([spring.stiffness for spring in mesh.attachments.springs])
    K = csc_array(enlarged(K, size) + springs.T @ (springs * k[:, None]))
    M = csc_array(enlarged(M, size) + mass_matrix(motions))
    active = np.zeros(size, dtype=bool)
    active[(motions.dofs * mesh.used[:, None] + np.arange(motions.dofs)).ravel()] = True
    active[(motions.dofs * motions.turning[:, None] + np.arange(3)).ravel()] = True
    active[motions.dofs * len(mesh.points) :] = True
    active[held] = False
    active[list(rows.owner)] = False
    if motions.joints is not None:
        active[motions.joints.absent] = False
    unknowns = np.flatnonzero(active)
    T = csr_array(R[:, unknowns])
    every, K, M = K, csc_array(T.T @ K @ T), csc_array(T.T @ M @ T)
    lift = csr_array(T[: motions.dofs * len(mesh.points)])
    kept, still = without_mass(K, np.flatnonzero(M.diagonal() == 0.0))
    K, M, unknowns = csc_array(K[:, kept][kept]), csc_array(M[:, kept][kept]), unknowns[kept]
    refuse_loose(motions, K, M, unknowns)
    reactions = [np.asarray(fields.T @ (support @ fields)) for support in supports]
    rigid = rigid_left(rows, R, springs, held, fields, reactions)
    connected = Connected(rows, csr_array(T[:, kept]), every)
    return Attached(K, M, csr_array(lift[:, kept]), unknowns, rigid, csr_array(lift @ still), connected)


def without_mass(K: csc_array, bare: IntArray) -> tuple[IntArray, csc_array]:
    """Unknowns to keep, and idle motions (unknowns, motions) of those without mass (`bare`).

    Nodes between springs follow statically. If springs support fewer directions than a node has, the other motions are
    idle: as many unknowns are fixed as there are such motions, without other effects.
    """
    inner = csc_array(K[:, bare][bare])
    idle = csc_array((K.shape[0], 0))
    dropped = []
    for part in np.split(*sorted_parts(inner)):
        block = inner[:, part][part].toarray()
        scale = 1.0 / np.sqrt(np.where(np.diagonal(block) > 0.0, np.diagonal(block), 1.0))
        size, V = np.linalg.eigh(scale[:, None] * block * scale)
        still = scale[:, None] * V[:, size < LOOSE]
        if still.shape[1]:
            dropped.append(bare[part[qr(still.T, mode="r", pivoting=True)[1][: still.shape[1]]]])
            place = np.repeat(bare[part], still.shape[1]), np.tile(np.arange(still.shape[1]), len(part))
            added = coo_array((still.ravel(), place), shape=(K.shape[0], still.shape[1]))
            idle = csc_array(hstack([idle, added.tocsc()]))
    return np.setdiff1d(np.arange(K.shape[0]), np.concatenate([np.zeros(0, dtype=np.int64), *dropped])), idle


def sorted_parts(A: csc_array) -> tuple[IntArray, IntArray]:
    """Rows in the order of connected parts, and the start of each part except the first."""
    part = connected_components(A, directed=False)[1]
    return np.argsort(part, kind="stable"), np.cumsum(np.bincount(part))[:-1]


def warn_floating(mesh: MeshData, held: IntArray) -> None:
    """Warn of nodes without mass, support or connection whose springs all lead to one other node, without effect."""
    given = mesh.attachments
    masses = np.array([mass.node for mass in given.masses], dtype=np.int64)
    tied = [node for equation in given.equations for node in equation.nodes]
    others = [masses, held, mesh.used, np.array(tied, dtype=np.int64), *given.bodies]
    ends: dict[int, set[int]] = {}
    for spring in given.springs:
        joined = set(spring.nodes)
        for node in joined:
            ends.setdefault(node, set()).update(joined - {node} or {-1})  # -1: the ground
    alone = np.setdiff1d(list(ends), np.concatenate(others)).astype(np.int64)
    floating = [node for node in alone.tolist() if len(ends[node]) == 1 and -1 not in ends[node]]
    if floating:
        found = nodes_named(mesh, np.array(floating))
        warn("mesh-floating-spring", f"{mesh.source}: found {found} with springs to one other node only", stacklevel=6)


def enlarged(A: csc_array, size: int) -> csc_array:
    """A matrix with additional empty rows and columns."""
    A = A.copy()
    A.resize((size, size))
    return A


def spring_rows(motions: Motions) -> csr_array:
    """Rows that give the deformation of each spring from the dofs, (springs, dofs)."""
    springs = motions.mesh.attachments.springs
    return as_rows([motions.combined(spring.terms, spring.where) for spring in springs], motions.size)


def mass_matrix(motions: Motions) -> csc_array:
    """Mass of the point masses on all dofs."""
    masses = [(motions.felt(mass), mass.matrix) for mass in motions.mesh.attachments.masses]
    return summed([(felt, matrix[: len(felt), : len(felt)]) for felt, matrix in masses], motions.size)


def refuse_held(motions: Motions, rows: Rows, held: IntArray) -> None:
    """Refuse motions that a support fixes and a connection prescribes; motions tied to a fixed node are fixed too."""
    for dof in held.tolist():
        if dof in rows.owner and dof not in rows.own:
            found = "a support on a node that follows another one, expected the support on that other node"
            raise motions.fault(rows.owner[dof], motions.place(dof)[0], found)


def refuse_loose(motions: Motions, K: csc_array, M: csc_array, unknowns: IntArray) -> None:
    """Refuse nodes with own rotations of which one motion has neither stiffness nor mass."""
    first = motions.dofs * len(motions.mesh.points)
    for k, node in enumerate(motions.turning.tolist()):
        own = np.isin(unknowns, [*(motions.dofs * node + np.arange(3)), *(first + 3 * k + np.arange(3))])
        place = np.flatnonzero(own)
        if not len(place):
            continue
        both = [A[:, place][place].toarray() for A in (K, M)]
        size = sum(block / max(float(np.trace(block)), np.finfo(float).tiny) for block in both)
        scale = 1.0 / np.sqrt(np.diagonal(size))
        if np.linalg.eigvalsh(scale[:, None] * size * scale)[0] < LOOSE:
            found = "a rotation with neither stiffness nor mass, expected connected nodes that are not all in one line"
            raise motions.fault("connections", node, found)


def rigid_left(
    rows: Rows, R: csr_array, springs: csr_array, held: IntArray, fields: FloatArray, reactions: Sequence[FloatArray]
) -> int:
    """Number of rigid motions that no support, spring or equation restrains."""
    motions, mesh = rows.motions, rows.motions.mesh
    reach = np.abs(mesh.points - mesh.points.mean(axis=0)).max()
    turns = np.hstack([np.zeros((3, 3)), np.eye(3) / reach])
    whole = np.vstack([fields, np.tile(turns, (len(motions.turning), 1))])
    felt = [springs @ whole, whole[held]]
    tied = np.array(list(rows.owner), dtype=np.int64)
    felt.append(whole[tied] - (R @ whole)[tied])
    clear = [np.where(np.abs(part) > ROUND, part, 0.0) for part in felt]
    return int(unfelt([*reactions, *(part.T @ part for part in clear)]).shape[1])
