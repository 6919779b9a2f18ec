"""A linear problem packed for the compiled loops: bands in a narrow order, contact rows as short lists."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.errors import InputError
from contact.model.arrays import Array, Indices
from contact.model.band import Band, band, combine, diagonal, factor, lower_form
from contact.model.chain import Chain
from contact.model.chain_linear import linear
from contact.model.linear import LinearBody

DENSE = 1500  # coordinates up to which a consistent mass matrix is treated by a dense eigen solver


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LinearSystem:
    """LinearBody in band order: coordinate i of the loops is coordinate order[i] of the body.

    `columns`, `value` (k, w): the entries of Q, padded with zeros.
    """

    body: LinearBody
    order: Indices
    place: Indices
    M: Band
    C: Band
    K: Band
    load: Array
    shapes: Array
    columns: Indices
    value: Array
    gap0: Array

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.order.size

    @property
    def damped(self) -> bool:
        """Whether C has an entry."""
        return bool(self.C.ground.any() or self.C.off.any())

    def rows(self) -> Array:
        """Q in band order, dense (k, N)."""
        Q = np.zeros((self.gap0.size, self.size))
        np.add.at(Q, (np.arange(self.gap0.size)[:, None], self.columns), self.value)
        return Q

    def amplitudes(self, first: int, steps: int, h: float) -> Array:
        """Amplitudes of the forcing at t = first h .. (first + steps) h, (steps + 1, J)."""
        time = h * np.arange(first, first + steps + 1, dtype=np.float64)
        table = np.zeros((time.size, len(self.body.forcing)))
        for j, forcing in enumerate(self.body.forcing):
            table[:, j] = np.asarray(forcing.amplitude(time), dtype=np.float64)
        return table


def linear_system(problem: Chain | LinearBody) -> LinearSystem:
    """Pack a chain or a linear body; raises InputError unless its mass matrix is positive definite."""
    body = linear(problem) if isinstance(problem, Chain) else problem
    n = body.size
    order = np.arange(n) if isinstance(problem, Chain) else _narrow(body)
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    columns, value = _lists(body, place)
    assert body.load is not None
    system = LinearSystem(
        body=body, order=order, place=place, M=band(body.M, order), C=band(body.C, order), K=band(body.K, order),
        load=body.load[order], shapes=np.array([f.shape[order] for f in body.forcing]).reshape(-1, n),
        columns=columns, value=value, gap0=body.gap0,
    )  # fmt: skip
    factor(system.M, "M")
    return system


def _narrow(body: LinearBody) -> Indices:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    pattern = csr_array(abs(body.M)) + csr_array(abs(body.K)) + csr_array(abs(body.C))
    return np.asarray(reverse_cuthill_mckee(pattern, symmetric_mode=True), dtype=np.int64)


def _lists(body: LinearBody, place: Indices) -> tuple[Indices, Array]:
    from scipy.sparse import csr_array

    rows = csr_array(body.Q)
    width = int(np.diff(rows.indptr).max())
    columns, value = np.zeros((body.contacts, width), dtype=np.int64), np.zeros((body.contacts, width))
    for k in range(body.contacts):
        entries = slice(rows.indptr[k], rows.indptr[k + 1])
        count = entries.stop - entries.start
        columns[k, :count], value[k, :count] = place[rows.indices[entries]], rows.data[entries]
    return columns, value


def omega_max(system: LinearSystem, *, contact_stiffness: float = 0.0, free: Array | None = None) -> float:
    """Highest angular frequency [rad/s], with springs of this stiffness closing every contact.

    `free` (N,) marks the coordinates that have mass; the others are held.
    """
    M, K = system.M, system.K
    if contact_stiffness:
        Q = system.rows()
        K = combine((1.0, K), (contact_stiffness, band(Q.T @ Q, np.arange(system.size))))
    if M.off.shape[0] == 0:
        root = 1.0 / np.sqrt(M.ground)
        if free is not None:
            root = np.where(free, root, 0.0)
        return _top_lumped(K, root)
    if system.size > DENSE:
        raise InputError(
            f"M: found a consistent mass matrix of {system.size} coordinates, expected at most {DENSE}, or lumped"
        )
    from scipy.linalg import eigh

    n = system.size
    dense_M, dense_K = _dense(M), _dense(K)
    return math.sqrt(max(float(eigh(dense_K, dense_M, eigvals_only=True, subset_by_index=(n - 1, n - 1))[0]), 0.0))


def _top_lumped(K: Band, root: Array) -> float:
    from scipy.linalg import eigvals_banded

    n = root.size
    scaled = lower_form(K)
    scaled[0] *= root**2
    for d in range(1, scaled.shape[0]):
        scaled[d, : n - d] *= root[: n - d] * root[d:]
    top = (
        scaled[0]
        if scaled.shape[0] == 1
        else eigvals_banded(scaled, lower=True, select="i", select_range=(n - 1, n - 1))
    )
    return math.sqrt(max(float(np.max(top)), 0.0))


def _dense(A: Band) -> Array:
    dense = np.diag(diagonal(A))
    n = A.ground.size
    for d in range(1, A.off.shape[0] + 1):
        dense += np.diag(A.off[d - 1, : n - d], d) + np.diag(A.off[d - 1, : n - d], -d)
    return dense
