"""A mass matrix made diagonal by a change of the few dofs that it couples.

Rings off their edge and masses between nodes couple some dofs in M. Each group of coupled dofs is replaced by
combinations of them, x = T y with T = D^-1/2 S^-1/2 D^1/2, D the group's diagonal and S = D^-1/2 M D^-1/2 (Loewdin,
J. Chem. Phys. 18, 1950, 365: of all such changes the one that changes least), so that T^T M T = D.
"""

import numpy as np
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.csgraph import connected_components

from casingfem.io.arrays import FloatArray


def diagonalised(M: csc_array) -> tuple[FloatArray, csc_array]:
    """Diagonal of T^T M T, and the change of dofs T (size, size): the identity where M couples nothing.

    Raises
    ------
    ValueError
        If M is not positive.

    >>> M = csc_array(np.array([[2.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 3.0]]))
    >>> mass, T = diagonalised(M)
    >>> bool(abs(T.T @ M @ T - diags_array(mass)).max() < 1e-14)
    True
    """
    mass = M.diagonal()
    if not np.all(mass > 0.0):
        raise ValueError("the mass matrix is not positive: a dof without mass")
    coupled = csc_array(M - diags_array(mass))
    coupled.eliminate_zeros()
    _, group = connected_components(coupled, directed=False)
    order = np.argsort(group, kind="stable")
    ends = np.flatnonzero(np.diff(group[order])) + 1
    members = [part for part in np.split(order, ends) if len(part) > 1]
    alone = np.setdiff1d(np.arange(len(mass)), np.concatenate([np.zeros(0, dtype=int), *members]))
    rows, columns, values = [alone], [alone], [np.ones(len(alone))]
    for part in members:
        root = np.sqrt(mass[part])
        squares, turn = np.linalg.eigh(M[part][:, part].toarray() / np.outer(root, root))
        if squares[0] <= 0.0:
            raise ValueError("the mass matrix is not positive")
        i, j = np.broadcast_arrays(part[:, None], part[None, :])
        rows.append(i.ravel())
        columns.append(j.ravel())
        values.append(((turn / np.sqrt(squares)) @ turn.T / root[:, None] * root).ravel())
    places = (np.concatenate(rows), np.concatenate(columns))
    return mass, coo_array((np.concatenate(values), places), shape=M.shape).tocsc()
