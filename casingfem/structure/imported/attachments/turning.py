"""Effect of rotation on attachments of a part: masses on arms, forces in rigid connections.

A point on an arm r of a node is displaced by u + theta x r + theta x (theta x r)/2, to second order. A mass m there
has, at 1 rad/s and with A v = u + theta x r,

    spin softening  m A^T P A,   Coriolis  2 m A^T [a x] A,   force  F = m P (x + r - c),

and every force F on an arm, of a mass or a connection, adds the stiffness -F.theta x (theta x r) to the rotations:

    theta.S theta,   S = (F.r) 1 - (F r^T + r F^T)/2.

Inertia about the centre of a mass is represented by six points around it. Equations, springs and ties are linear; arms
are those of the shape at rest.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array

from casingfem.io.arrays import FloatArray
from casingfem.structure.geometry.rotation import Rotation, skew
from casingfem.structure.imported.attachments.ties import Motions, Rows, fitted
from casingfem.structure.imported.mesh.attachments import PointMass

Entries = list[tuple[list[dict[int, float]], FloatArray]]  # rows over the motions, and a matrix on them


class AttachedSpin(NamedTuple):
    """Terms of attached masses at 1 rad/s: mass, softening, gyroscopic, stiffness of forces, and force."""

    mass: csc_array
    softening: csc_array
    gyroscopic: csc_array
    stiffness: csc_array
    force: FloatArray


def attached_spin(motions: Motions, rotation: Rotation) -> AttachedSpin:
    """Inertia of the point masses about an axis."""
    P, turn = rotation.plane, np.cross(rotation.direction, np.eye(3)).T
    parts: tuple[Entries, ...] = ([], [], [], [])
    force = np.zeros(motions.size)
    for mass in motions.mesh.attachments.masses:
        felt = motions.felt(mass)
        six = np.zeros((4, 6, 6))
        pull = np.zeros(6)
        for m, r in points_of(mass):
            A = np.hstack([np.eye(3), -skew(r)])
            away = m * P @ (motions.mesh.points[mass.node] + r - np.asarray(rotation.centre))
            six[:3] += m * np.array([A.T @ A, A.T @ P @ A, 2.0 * A.T @ turn @ A])
            six[3, 3:, 3:] += arm_stiffness(away, r)
            pull += A.T @ away
        for entries, matrix in zip(parts, six, strict=True):
            entries.append((felt, matrix[: len(felt), : len(felt)]))
        for row, f in zip(felt, pull, strict=False):
            for dof, value in row.items():
                force[dof] += value * f
    mass, softening, gyroscopic, stiffness = (summed(entries, motions.size) for entries in parts)
    return AttachedSpin(mass, softening, gyroscopic, stiffness, force)


def points_of(mass: PointMass) -> list[tuple[float, FloatArray]]:
    """Masses and arms of points with the mass, centre and inertia of a point mass."""
    centre = np.asarray(mass.offset)
    if not mass.turns:
        return [(mass.mass, centre)]
    J = np.asarray(mass.inertia)
    moments, axes = np.linalg.eigh(0.5 * np.trace(J) * np.eye(3) - J)  # int r r^T dm
    points = [(0.5 * float(e), centre + s * axis) for e, axis in zip(moments, axes.T, strict=True) for s in (-1, 1)]
    return [(mass.mass - float(moments.sum()), centre), *points]


def arm_stiffness(force: FloatArray, r: FloatArray) -> FloatArray:
    """S of a force on an arm, (3, 3).

    >>> arm_stiffness(np.array([5.0, 0.0, 0.0]), np.array([2.0, 0.0, 0.0])).tolist()
    [[0.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]]
    """
    return np.asarray((force @ r) * np.eye(3) - 0.5 * (np.outer(force, r) + np.outer(r, force)))


def carried(motions: Motions, rows: Rows, residual: FloatArray) -> csc_array:
    """Stiffness due to the forces in connections, on all motions.

    `residual` is the difference of loads and inner forces for every motion. For a dependent motion it is the force of
    its connection, including the forces of motions that depend on it.
    """
    forces = np.zeros(motions.size)
    dependent = np.array(sorted(rows.owner), dtype=np.int64)
    forces[dependent] = own = residual[dependent]
    i, j, value = np.array(rows.entries, dtype=float).reshape(-1, 3).T
    upon = csr_array(coo_array((value, (j.astype(np.int64), i.astype(np.int64))), shape=(motions.size, motions.size)))
    for _ in range(len(dependent)):  # forces of what follows a follower
        passed = forces.copy()
        passed[dependent] = own + (upon @ forces)[dependent]
        if np.array_equal(passed, forces):
            break
        forces = passed
    entries: Entries = []
    dofs, x, joints = motions.dofs, motions.mesh.points, motions.joints
    for rigid in motions.mesh.attachments.rigids:
        pivot, total = motions.turn(rigid.reference), np.zeros((3, 3))
        moved = [c for c in rigid.components if c < 3]
        for node in rigid.nodes.tolist():
            pushed = np.zeros(3)
            pushed[moved] = forces[dofs * node + np.array(moved, dtype=np.int64)]
            total += arm_stiffness(pushed, x[node] - x[rigid.reference])
            if joints is not None and len(rigid.components) > len(moved) and len(motions.turns(node)) == 2:
                tilted = forces[dofs * node + 3 : dofs * node + 5] @ joints.frames[node]
                total += arm_stiffness(tilted, joints.normals[node])
        entries.append(([{pivot + k: 1.0} for k in range(3)], total))
    for mean in motions.mesh.attachments.means:
        fit, arms = fitted(motions, mean), x[mean.nodes] - x[mean.reference]
        pivot = motions.turn(mean.reference)
        places = [dofs * mean.reference + c if c < 3 else pivot + c - 3 for c in mean.components]
        moment = np.zeros(6)
        moment[list(mean.components)] = forces[places]
        on = np.einsum("s,sjc->jc", moment, fit)
        total = -np.sum([arm_stiffness(push, r) for push, r in zip(on, arms, strict=True)], axis=0)
        nodes = list(enumerate(mean.nodes.tolist()))
        turns = [{dofs * node + c: float(fit[3 + k, j, c]) for j, node in nodes for c in range(3)} for k in range(3)]
        entries.append((turns, total))
    return summed(entries, motions.size)


def summed(entries: Entries, size: int) -> csc_array:
    """Matrices on combinations of motions, summed into one on all motions."""
    total = csc_array((size, size))
    for rows, matrix in entries:
        of = as_rows(rows, size)
        total = csc_array(total + of.T @ csr_array(matrix) @ of)
    return total


def as_rows(combinations: list[dict[int, float]], size: int) -> csr_array:
    """Combinations of motions, motion -> coefficient, as rows over all of them."""
    places = [(k, dof, value) for k, row in enumerate(combinations) for dof, value in row.items()]
    k, dof, value = np.array(places, dtype=float).reshape(-1, 3).T
    return coo_array((value, (k.astype(np.int64), dof.astype(np.int64))), shape=(len(combinations), size)).tocsr()
