"""Test whether matrices represent rigid motions of their nodes: K R = 0 for a free part, and R^T M R that of one mass.

With wrong axes of nodes, units of length or order of rows, K R is not zero. Each row of K R is compared with its terms,

    |sum_j K_ij R_j| / sum_j |K_ij| |R_j|,

the rotation about the row's own node, so that neither the place of the origin nor the fineness of a mesh matters. A
part is a set of nodes that K connects. Amplitudes of modes (q) that K couples to the nodes are condensed first.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError
from contact.model.bodies.matrices import Matrices

TOLERANCE = 3e-3  # positions of four digits leave 2e-3; axes that are wrong by an angle leave about the angle
SHORTEST = 0.05  # of the size of a part: least arm of a rotation, as positions are rounded in terms of their size
NOISE = 1e-5  # of the median rate times a row's mass: a stiffness below it is round-off, as in free Craig-Bampton sets
COUPLED = 1e-8  # of the diagonals: stiffness between q and nodes that counts
SINGULAR = 1e-6  # of the largest singular value
MASSES = 1e-3  # spread of the masses along x, y, z, and a negative inertia beside the largest
OTHERWISE = 1e-2  # of a rigid mode: what may be left of it beside the rigid motions of the nodes
ALL = 6

ADVICE = (
    "give the axes of the nodes (a .pch with GRID and CORD cards, or xx xy xz yx yy yz in the table of nodes), "
    "positions in the length unit of K, and dofs in the order of the rows"
)


class Rows(NamedTuple):
    """Rows that belong to nodes: their stiffness, indices in the matrices, nodes, directions and positions."""

    K: Any
    rows: Indices
    node: Indices
    along: Array
    turns: Any
    x: Array
    coupled: bool


def rigid_findings(matrices: Matrices, null: Array, rate: float) -> str:
    """Findings of the rigid-body test, in a sentence; `null` (n, r) are the rigid modes, `rate` the median K_ii / M_ii.

    Raises InputError for a free part in which K R is not zero, or whose mass is not one in all directions.
    """
    given = rows_of_nodes(matrices)
    if given is None:
        return "rigid-body motion: not tested, since no row belongs to a node"
    moves, turns = residuals(given, matrices, rate)
    _, parts = np.unique(components(given), return_inverse=True)
    free, worst, otherwise = True, 0.0, False
    for part in range(parts.max() + 1):
        own = parts == part
        left = np.array([moves[own].max(), np.nanmax(turns[own], initial=0.0)])
        if left.max() <= TOLERANCE:
            worst = max(worst, float(left.max()))
            continue
        free = False
        seen, size = scaled(given, own, null)
        count = int(np.count_nonzero(np.linalg.svd(seen, compute_uv=False) > SINGULAR * size)) if null.size else 0
        if count >= ALL:
            refuse(given, matrices, moves, turns, own, count)
        otherwise = otherwise or (count > 0 and not explained(matrices, given, own, seen, count))
    if not free:
        if otherwise:
            return (
                "rigid-body motion: warning: the rigid modes of K are not rigid motions of its nodes. Either the part "
                f"is a mechanism, or its axes or units are wrong; if they are wrong, {ADVICE}"
            )
        return "rigid-body motion: tested in part, since the part has supports"
    if null.shape[1] >= ALL and not given.coupled:
        check_mass(matrices, given)
    unknown = "" if not np.isnan(turns).any() else "; rotations not tested, since positions are unknown"
    return f"rigid-body motion: K R is {worst:.1e} of its terms, expected at most {TOLERANCE:g}{unknown}"


def rows_of_nodes(matrices: Matrices) -> Rows | None:
    """Rows of translations and rotations, with coupled modal amplitudes condensed; None if a model has no such rows."""
    from scipy.sparse import csr_array

    q = np.array([direction == "q" for _, direction in matrices.dofs])
    rows = np.flatnonzero(~q)
    if not rows.size:
        return None
    K, coupled = csr_array(matrices.K), False
    own = csr_array(K[rows][:, rows])
    if q.any():
        across = csr_array(K[np.flatnonzero(q)][:, rows]).toarray()
        diagonal = np.sqrt(np.maximum(np.abs(K.diagonal()), np.finfo(float).tiny))
        coupled = bool((np.abs(across) / np.outer(diagonal[q], diagonal[~q])).max(initial=0.0) > COUPLED)
        coupled = coupled and bool(np.abs(across).max() > COUPLED * np.abs(K.diagonal()).max())
        if coupled:
            modal = K[np.flatnonzero(q)][:, np.flatnonzero(q)].toarray()
            own = csr_array(own.toarray() - across.T @ np.linalg.lstsq(modal, across, rcond=None)[0])
    dofs = [matrices.dofs[k] for k in rows.tolist()]
    _, node = np.unique([n for n, _ in dofs], return_inverse=True)
    x = np.array([matrices.points.get(n, np.full(3, np.nan)) for n, _ in dofs], dtype=float)
    turns = np.array([len(direction) == 2 for _, direction in dofs])
    return Rows(own, rows, node, matrices.along()[rows], turns, x, coupled)


def components(given: Rows) -> Array:
    """The part of each row: nodes that K connects."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    K = coo_array(given.K)
    i, j = (given.node[places] for places in K.coords)
    count = int(given.node.max()) + 1
    labels = connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(count, count)), directed=False)[1]
    return np.asarray(labels[given.node])


def residuals(given: Rows, matrices: Matrices, rate: float) -> tuple[Array, Array]:
    """Residuals of each row under translations and rotations; NaN where a rotation needs unknown positions."""
    from scipy.sparse import coo_array

    K = coo_array(given.K)
    i, j = K.coords
    size = np.abs(K.data)
    shift = ~given.turns
    a = np.where(shift[:, None], given.along, 0.0)
    noise = NOISE * rate * matrices.M.diagonal()[given.rows]
    n = len(given.rows)

    def summed(terms: Array) -> Array:
        return np.asarray(np.bincount(i, terms, minlength=n))

    def vectors(terms: Array) -> Array:
        return np.stack([summed(K.data * terms[:, k]) for k in range(3)], axis=1)

    extent = np.nanmax(np.ptp(given.x, axis=0), initial=0.0) if not np.isnan(given.x).all() else 0.0
    arm = given.x[j] - given.x[i]
    turn = np.where(shift[j][:, None], np.cross(arm, given.along[j]), given.along[j])
    reach = np.where(shift[j], np.maximum(np.linalg.norm(arm, axis=1), SHORTEST * extent), 1.0)
    of_moves = np.linalg.norm(vectors(a[j]), axis=1), summed(size * shift[j]) + noise
    unit = np.where(shift, SHORTEST * extent, 1.0)
    of_turns = np.linalg.norm(vectors(turn), axis=1), summed(size * reach) + noise * unit
    return ratio(*of_moves), ratio(*of_turns)


def ratio(left: Array, terms: Array) -> Array:
    """Ratio, zero if there are no terms."""
    return np.divide(left, terms, out=np.zeros_like(left), where=~(terms <= 0.0))


def scaled(given: Rows, own: Array, null: Array) -> tuple[Array, float]:
    """Rigid modes in the rows of a part, rotations times its size, and the largest singular value of all rows."""
    x = given.x[own]
    extent = 1.0 if np.isnan(x).any() or not np.ptp(x, axis=0).max() > 0.0 else float(np.ptp(x, axis=0).max())
    weight = np.where(given.turns, extent, 1.0)[:, None]
    every = weight * null[given.rows]
    return every[own], float(np.linalg.norm(every, 2)) if null.size else 0.0


def explained(matrices: Matrices, given: Rows, own: Array, seen: Array, count: int) -> bool:
    """Whether the rigid modes of a part are rigid motions of its nodes."""
    if np.isnan(given.x[own]).any():
        return True
    middle = given.x[own].mean(axis=0)
    extent = float(np.ptp(given.x[own], axis=0).max()) or 1.0
    R = matrices.rigid_motions(middle)[given.rows][own] * np.where(given.turns[own], extent, 1.0)[:, None]
    modes = np.linalg.svd(seen, full_matrices=False)[0][:, :count]
    left = modes - R @ np.linalg.lstsq(R, modes, rcond=None)[0]
    return bool(np.linalg.norm(left, axis=0).max() <= OTHERWISE)


def refuse(given: Rows, matrices: Matrices, moves: Array, turns: Array, own: Array, count: int) -> None:
    """Raise for a free part that deforms under rigid motions of its nodes."""
    rows = np.flatnonzero(own)
    shifted = float(moves[own].max()) > TOLERANCE
    of = moves if shifted else turns
    node, direction = matrices.dofs[int(given.rows[rows[np.nanargmax(of[own])]])]
    what = "translation" if shifted else "rotation"
    found = f"found {count} rigid modes, but a {what} of all nodes causes {np.nanmax(of[own]):.2g} of the terms of row"
    why = "the axes of nodes" if shifted else "the positions of nodes, their length unit or their axes"
    raise InputError(f"K: {found} {node}.{direction}, expected at most {TOLERANCE:g}: {why} do not fit K; {ADVICE}")


def check_mass(matrices: Matrices, given: Rows) -> None:
    """Refuse a free part whose masses along x, y, z differ, or whose inertia about its centre is negative."""
    known = not np.isnan(given.x).any()
    middle = given.x.mean(axis=0) if known else np.zeros(3)
    R = matrices.rigid_motions(middle)
    inertia = R.T @ (matrices.M @ R)
    mass = np.diag(inertia)[:3][np.abs(R[:, :3]).max(axis=0) > 0.0]
    if mass.size and np.ptp(mass) > MASSES * mass.max():
        found = f"found the masses {' '.join(f'{m:.6g}' for m in np.diag(inertia)[:3])} kg along x, y, z"
        raise InputError(
            f"M: {found} of a free part, expected equal masses: the rows of M do not fit those of K; {ADVICE}"
        )
    if not known or mass.size < 3:
        return
    cross = inertia[3:, :3]
    about = inertia[3:, 3:] - cross @ np.linalg.solve(inertia[:3, :3], cross.T)
    least, *_, most = np.linalg.eigvalsh(0.5 * (about + about.T)).tolist()
    # the inertia of a body exceeds none of the sums of the others, as of masses at places
    if least < -MASSES * most or np.abs(cross + cross.T).max() > MASSES * np.sqrt(mass.max() * max(most, 0.0)):
        found = f"found the moments of inertia {least:.3g} to {most:.3g} kg m^2, expected those of a body"
        raise InputError(f"M: {found}: positions or axes do not fit M; {ADVICE}")
