"""Nodes of a shell where walls meet at an angle: one rotation theta for all of them, a rigid joint.

The director n of a wall rotates there by w = theta x n. Such a node has six dofs: its displacements, and theta along n
x e_1, n x e_2 and n of its first wall. The first two are the rotations w_1, w_2 of that wall. A wall does not resist
the rotation about its normal, but the other walls resist it by bending, so no drilling stiffness is added. If any walls
of a mesh meet, all nodes have six dofs, otherwise five. The sixth dof of a node of a single wall is never free.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.geometry.rotation import rigid_motions
from casingfem.structure.imported.mesh.attachments import Tie
from casingfem.structure.imported.mesh.walls import Apart

WALL = 5  # dofs of a node of one wall


class Joints(NamedTuple):
    """Motion of the nodes of walls with the nodes of a shell.

    Attributes
    ----------
    nodes
        The node of the shell that each node of a wall is, (walls' nodes,).
    cells
        Walls' nodes of each cell, (cells, nodes of a cell).
    normals, frames
        Directors (walls' nodes, 3) and their tangents (walls' nodes, 2, 3).
    axes
        Rotation vector of each rotational dof of a node, (nodes, 2, 3), or (nodes, 3, 3) if walls meet; 0 for the third
        of a node of one wall.
    motions
        Dofs of walls' nodes by dofs of nodes, (5 walls' nodes, 6 nodes); None where no walls meet.
    glued
        Ties of nodes; the master nodes are nodes of walls.
    """

    nodes: IntArray
    cells: IntArray
    normals: FloatArray
    frames: FloatArray
    axes: FloatArray
    motions: csr_array | None = None
    glued: tuple[Tie, ...] = ()

    @property
    def dofs(self) -> int:
        """Dofs of a node."""
        return 3 + int(self.axes.shape[1])

    @property
    def absent(self) -> IntArray:
        """The sixth dof of every node of one wall."""
        return np.asarray(self.dofs * np.flatnonzero(~self.axes[:, -1].any(axis=1)) + self.dofs - 1)

    def on_nodes(self, A: csc_array) -> csc_array:
        """A matrix on the dofs of walls' nodes, transformed to the dofs of nodes."""
        return A if self.motions is None else csc_array(self.motions.T @ A @ self.motions)

    def onto_nodes(self, forces: FloatArray) -> FloatArray:
        """Forces on the dofs of walls' nodes, transformed to the dofs of nodes."""
        return forces if self.motions is None else np.asarray(self.motions.T @ forces)

    def of_walls(self, fields: FloatArray) -> FloatArray:
        """Fields of nodes (nodes, dofs) at the walls' nodes, (walls' nodes, 5)."""
        return fields if self.motions is None else np.asarray((self.motions @ fields.ravel()).reshape(-1, WALL))

    def rigid(self, x: FloatArray) -> FloatArray:
        """Translations and rotations of nodes at x (nodes, 3), (dofs nodes, 6), as `rigid_motions` gives them."""
        count = len(x)
        plain = rigid_motions(x, self.normals[:count], self.frames[:count])
        if self.motions is None:
            return plain
        turns = np.zeros((count, 1, 6))
        turns[:, 0, 3:] = self.axes[:, 2] / np.abs(x - x.mean(axis=0)).max()
        return np.concatenate([plain.reshape(count, WALL, 6), turns], axis=1).reshape(-1, 6)

    def arms(self, forces: FloatArray) -> csc_array:
        """Stiffness (6 nodes, 6 nodes) at joints due to forces on the rotations of directors.

        `forces` is on all dofs of walls' nodes.

        With w = theta x n, a director turns to n + w - |w|^2 n/2 + (theta.n) n x w/2, to second order. The cells have
        all but the last term; a force f along the wall does work on it, theta.S theta/2 with S = -(f n^T + n f^T)/2.
        """
        count = len(self.axes)
        more = np.arange(count, len(self.nodes))
        of_joints = np.concatenate([np.unique(self.nodes[more]), more])
        n, at = self.normals[of_joints], self.nodes[of_joints]
        f = np.einsum("na,nac->nc", forces.reshape(-1, WALL)[of_joints, 3:], self.frames[of_joints])
        axes = self.axes[at]
        along, across = np.einsum("nac,nc->na", axes, f), np.einsum("nac,nc->na", axes, n)
        S = -0.5 * (along[:, :, None] * across[:, None, :] + across[:, :, None] * along[:, None, :])
        turns = dofs(at, 6, 3, 4, 5)
        i, j = np.broadcast_arrays(turns[:, :, None], turns[:, None, :])
        return coo_array((S.ravel(), (i.ravel(), j.ravel())), shape=(6 * count, 6 * count)).tocsc()


def joints_of(apart: Apart, normals: FloatArray, frames: FloatArray) -> Joints:
    """The joints of a shell taken apart, with directors and frames of its walls' nodes."""
    meeting, count, glued = apart.meeting, apart.whole, apart.mesh.attachments.glued
    axes = np.cross(normals[:count, None], frames[:count])
    if not len(meeting):
        return Joints(apart.nodes, apart.mesh.cells, normals, frames, axes, None, glued)
    third = np.zeros((count, 1, 3))
    third[meeting, 0] = normals[meeting]
    axes = np.concatenate([axes, third], axis=1)
    every, own, more = np.arange(len(apart.nodes)), np.arange(count), np.arange(count, len(apart.nodes))
    at = apart.nodes[more]
    lean = np.einsum("sbc,sac->sab", axes[at], np.cross(normals[more, None], frames[more]))
    rows, columns = np.broadcast_arrays(dofs(more, WALL, 3, 4)[:, :, None], dofs(at, 6, 3, 4, 5)[:, None, :])
    i = np.concatenate([dofs(every, WALL, 0, 1, 2).ravel(), dofs(own, WALL, 3, 4).ravel(), rows.ravel()])
    j = np.concatenate([dofs(apart.nodes, 6, 0, 1, 2).ravel(), dofs(own, 6, 3, 4).ravel(), columns.ravel()])
    values = np.concatenate([np.ones(len(i) - lean.size), lean.ravel()])
    motions = coo_array((values, (i, j)), shape=(WALL * len(every), 6 * count)).tocsr()
    return Joints(apart.nodes, apart.mesh.cells, normals, frames, axes, motions, glued)


def dofs(nodes: IntArray, width: int, *which: int) -> IntArray:
    """Numbers of some dofs of nodes with `width` dofs each, (nodes, some)."""
    return np.asarray(width * nodes[:, None] + np.array(which))
