"""Rigid motions of any body: six columns, and those of them that reactions leave free."""

from collections.abc import Iterable

import numpy as np
from scipy.sparse import csc_array

from casingfem.io.arrays import FloatArray, IntArray

STILL = 1e-12  # share of the largest reaction below which a support is not felt


def rigid_motions(x: FloatArray, normals: FloatArray | None = None, frames: FloatArray | None = None) -> FloatArray:
    """Three translations and three rotations about the centre as columns (dofs, 6), of the size of one.

    With nodal normals (nodes, 3) and tangents (nodes, 2, 3), the rotations of the normals are appended to each node.
    """
    arms = x - x.mean(axis=0)
    arms = arms / np.abs(arms).max()
    turns = np.stack([np.cross(axis, arms) for axis in np.eye(3)], axis=-1)  # (nodes, 3, 3)
    shifts = np.broadcast_to(np.eye(3), turns.shape)
    motions = np.concatenate([shifts, turns], axis=2)
    if normals is not None and frames is not None:
        size = np.abs(x - x.mean(axis=0)).max()
        tilts = np.stack([np.cross(axis, normals) for axis in np.eye(3)], axis=-1) / size
        rotations = np.einsum("nic,nck->nik", frames, tilts)
        motions = np.concatenate([motions, np.concatenate([np.zeros_like(rotations), rotations], axis=2)], axis=1)
    return motions.reshape(-1, 6)


def unfelt(reactions: Iterable[FloatArray]) -> FloatArray:
    """Combinations of the six motions that no support feels, orthonormal columns (6, k), k from 0 to 6.

    Reactions are the work (6, 6) of each support under the motions; a soft one counts like a stiff one.

    >>> unfelt([np.diag([1e16, 1e16, 0, 0, 0, 0]), np.diag([0, 0, 1e-3, 0, 0, 0])]).shape
    (6, 3)
    """
    total = sum((R / np.trace(R) for R in reactions if np.trace(R) > 0.0), np.zeros((6, 6)))
    size, shares = np.linalg.eigh(total)
    return np.asarray(shares[:, size <= STILL])


def rigid_left(motions: FloatArray, held: IntArray, springs: Iterable[csc_array]) -> int:
    """How many combinations of rigid motions (dofs, 6) neither move a held dof nor strain a spring."""
    moved = motions[held]
    left = unfelt([moved.T @ moved, *(motions.T @ (spring @ motions) for spring in springs)])
    return int(left.shape[1])
