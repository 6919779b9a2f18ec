"""A linear problem packed for the compiled loops: bands in a narrow order, contact rows as short lists."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError
from contact.model.bodies.band import Band, band, combine, factor, fill_order, lower_form, sparse_form
from contact.model.bodies.linear import LinearBody

# places of the band per entry right of the diagonal: beyond, entries win (reports.verification.schemes.sparse_body)
EMPTY = 8
LANCZOS = 1e-8  # tolerance of the highest eigenvalue
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
        """Whether C has any entry."""
        return bool(self.C.ground.any()) or not self.C.lumped

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


class Linear(Protocol):
    """Interface of a problem M u'' + C u' + K u = f + Q^T force for schemes; a class of your own may implement it."""

    @property
    def crossing_time(self) -> float:
        """Shortest time of a wave through an element [s], infinite where there is none."""

    @property
    def in_order(self) -> bool:
        """Whether the given order of coordinates makes narrow bands; else a better order is sought."""

    def linear_form(self) -> LinearBody:
        """Matrices, gaps and loads."""


def linear_system(problem: Linear) -> LinearSystem:
    """Pack a problem's linear form; raises InputError unless its mass matrix is positive definite."""
    body = problem.linear_form()
    n = body.size
    order, wide = (np.arange(n), False) if problem.in_order else _ordered(body)
    place = np.argsort(order)
    columns, value = _lists(body, place)
    assert body.load is not None
    system = LinearSystem(
        body=body, order=order, place=place, M=band(body.M, order, wide=wide),
        C=band(body.C, order, wide=wide), K=band(body.K, order, wide=wide),
        load=body.load[order], shapes=np.array([f.shape[order] for f in body.forcing]).reshape(-1, n),
        columns=columns, value=value, gap0=body.gap0,
    )  # fmt: skip
    factor(system.M, "M")
    return system


def _ordered(body: LinearBody) -> tuple[Indices, bool]:
    """Order of the coordinates, and whether matrices are stored by entries because the narrowest band is too wide."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    pattern = csr_array(abs(body.M)) + csr_array(abs(body.K)) + csr_array(abs(body.C))
    order = np.asarray(reverse_cuthill_mckee(pattern, symmetric_mode=True), dtype=np.int64)
    place = np.argsort(order)
    entries = pattern.tocoo()
    width = int(np.max(np.abs(place[entries.row] - place[entries.col]), initial=0))
    if width * body.size > EMPTY * max(entries.nnz - body.size, 1) // 2:
        return fill_order(pattern), True
    return order, False


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

    `free` (N,) marks the coordinates that have mass; the others are fixed.
    """
    from scipy.sparse import csr_array

    M, K = system.M, system.K
    if contact_stiffness:
        Q = system.rows()
        K = combine((1.0, K), (contact_stiffness, band(csr_array(Q).T @ csr_array(Q), np.arange(system.size))))
    if K.sparse.start.size or M.sparse.start.size:
        return _top_sparse(K, M, free)
    if M.lumped:
        root = 1.0 / np.sqrt(M.ground)
        if free is not None:
            root = np.where(free, root, 0.0)
        return _top_lumped(K, root)
    if system.size > DENSE:
        found = f"a consistent mass matrix of {system.size} coordinates"
        raise InputError(f"M: found {found}, expected at most {DENSE}, or a lumped matrix")
    from scipy.linalg import eigh

    n = system.size
    dense_M, dense_K = sparse_form(M).toarray(), sparse_form(K).toarray()
    return math.sqrt(max(float(eigh(dense_K, dense_M, eigvals_only=True, subset_by_index=(n - 1, n - 1))[0]), 0.0))


def _top_sparse(K: Band, M: Band, free: Array | None) -> float:
    """Largest frequency by Lanczos from a fixed start, raised by its possible error, since limits depend on it."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    n = K.ground.size
    stiff, start = sparse_form(K), np.random.default_rng(7).standard_normal(n)
    if M.lumped:
        root = 1.0 / np.sqrt(M.ground) if free is None else np.where(free, 1.0 / np.sqrt(M.ground), 0.0)
        scale = diags_array(root)
        top = eigsh(scale @ stiff @ scale, k=1, which="LA", v0=start, tol=LANCZOS, return_eigenvectors=False)
    else:
        mass = sparse_form(M)
        inverse = LinearOperator((n, n), matvec=splu(mass).solve)
        top = eigsh(stiff, k=1, M=mass, Minv=inverse, which="LA", v0=start, tol=LANCZOS, return_eigenvectors=False)
    return math.sqrt(max(float(top[0]), 0.0) * (1.0 + 10.0 * LANCZOS))


def _top_lumped(K: Band, root: Array) -> float:
    from scipy.linalg import eigvals_banded

    n = root.size
    scaled = lower_form(K)
    scaled[0] *= root**2
    for d in range(1, scaled.shape[0]):
        scaled[d, : n - d] *= root[: n - d] * root[d:]
    if scaled.shape[0] > 1:
        scaled = eigvals_banded(scaled, lower=True, select="i", select_range=(n - 1, n - 1))
    return math.sqrt(max(float(np.max(scaled)), 0.0))
