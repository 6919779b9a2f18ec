"""Common parts of compiled loops over linear problems: banded products and solves, gaps, loads, work arrays."""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit
from contact.model.bodies.band import Band, Entries, Factor

TINY = 1e-150


class Parts(NamedTuple):
    """Constant arrays of a run: N coordinates, k contacts, J varying loads; `response` = A^-1 Q^T as rows."""

    M: Band
    C: Band
    K: Band
    damped: bool
    A: Factor
    load: Array
    shapes: Array  # (J, N)
    columns: Indices  # (k, w), entries of Q
    value: Array
    gap0: Array
    response: Array  # (k, N): motion by a unit contact force over a step
    W: Array  # (k, k): gap that unit forces open within a step, the Delassus matrix


class State(NamedTuple):
    """State: u, v and a at t_n (leapfrog schemes keep D = u_n - u_{n-1} in v), force and gap of the last step.

    Work arrays.
    """

    u: Array
    v: Array
    a: Array
    force: Array
    gap: Array
    free: Array  # (k,), gaps without force
    shifted: Array  # (k,)
    closed: Array  # (k,)
    square: Array  # (k, k)
    spare: Array  # (8, N)
    work: Array  # (N + band width,)


@jit
def add_entries(A: Entries, scale: float, u: Array, out: Array) -> None:
    """Add scale sum_j A_ij (u_j - u_i) to `out`; each stored entry counts for both halves of the symmetric matrix."""
    for i in range(u.size):
        here, total = u[i], 0.0
        for p in range(A.start[i], A.start[i + 1]):
            j = A.column[p]
            pull = scale * A.value[p] * (u[j] - here)
            total += pull
            out[j] -= pull
        out[i] += total


@jit
def solve_entries(A: Factor, x: Array) -> None:
    """Overwrite x by A^-1 x, with the factor stored as the entries of L^T."""
    n, start, column, value = x.size, A.sparse.start, A.sparse.column, A.sparse.value
    for i in range(n):
        here = x[i]
        for p in range(start[i], start[i + 1]):
            x[column[p]] -= value[p] * here
    for i in range(n - 1, -1, -1):
        total = x[i] * A.inverse[i]
        for p in range(start[i], start[i + 1]):
            total -= value[p] * x[column[p]]
        x[i] = total


@jit
def add_product(A: Band, scale: float, u: Array, out: Array, work: Array) -> None:
    """Add scale A u to `out`, in contiguous passes; `work` needs space for N plus the bandwidth."""
    n = u.size
    if A.grounded:
        for i in range(n):
            out[i] += scale * A.ground[i] * u[i]
    if A.sparse.start.size > 0:
        add_entries(A.sparse, scale, u, out)
        return
    for d in range(1, A.off.shape[0] + 1):
        row = A.off[d - 1]
        for i in range(d):
            work[i] = 0.0
            work[n + i] = 0.0
        for i in range(n - d):
            work[i + d] = scale * row[i] * (u[i + d] - u[i])
        for i in range(n):
            out[i] += work[i + d] - work[i]


@jit
def flush(x: Array) -> None:
    """Set tiny numbers to zero: ahead of a wave, solutions decay into denormal numbers, which cost 100 cycles each."""
    for i in range(x.size):
        x[i] = 0.0 if abs(x[i]) < TINY else x[i]


@jit
def solve_in_place(A: Factor, x: Array) -> None:
    """Overwrite x by A^-1 x, A = L D L^T."""
    if A.sparse.start.size > 0:
        solve_entries(A, x)
        return
    n, width = A.low.shape
    if width == 1:
        low = A.low[:, 0]
        for i in range(n - 1):
            x[i + 1] -= low[i] * x[i]
        for i in range(n):
            x[i] *= A.inverse[i]
        for i in range(n - 2, -1, -1):
            x[i] -= low[i] * x[i + 1]
        flush(x)
        return
    if width > 0:
        for i in range(n):
            for d in range(min(width, n - 1 - i)):
                x[i + 1 + d] -= A.low[i, d] * x[i]
    for i in range(n):
        x[i] *= A.inverse[i]
    if width > 0:
        for i in range(n - 1, -1, -1):
            total = x[i]
            for d in range(min(width, n - 1 - i)):
                total -= A.low[i, d] * x[i + 1 + d]
            x[i] = total


@jit
def dot(x: Array, y: Array) -> float:
    """x^T y."""
    total = 0.0
    for i in range(x.size):
        total += x[i] * y[i]
    return total


@jit
def along(p: Parts, k: int, x: Array) -> float:
    """Product of row k of Q with x."""
    total = 0.0
    for j in range(p.columns.shape[1]):
        total += p.value[k, j] * x[p.columns[k, j]]
    return total


@jit
def gap_of(p: Parts, k: int, u: Array) -> float:
    """Gap of contact k."""
    return float(p.gap0[k]) + along(p, k, u)


@jit
def add_response(p: Parts, scale: float, force: Array, x: Array) -> None:
    """Add scale A^-1 Q^T force to x, skipping open contacts."""
    for k in range(force.size):
        if force[k] != 0.0:
            factor = scale * force[k]
            row = p.response[k]
            for i in range(x.size):
                x[i] += factor * row[i]


@jit
def add_varying(p: Parts, scale: float, amplitudes: Array, f: Array) -> None:
    """Add scale times the varying loads at one time to f."""
    for j in range(amplitudes.size):
        factor = scale * amplitudes[j]
        for i in range(f.size):
            f[i] += factor * p.shapes[j, i]


@jit
def internal_force(p: Parts, u: Array, v: Array, amplitudes: Array, out: Array, work: Array) -> None:
    """Overwrite `out` by F = f(t) - C v - K u."""
    for i in range(out.size):
        out[i] = p.load[i]
    add_varying(p, 1.0, amplitudes, out)
    add_product(p.K, -1.0, u, out, work)
    if p.damped:
        add_product(p.C, -1.0, v, out, work)


@jit
def varying_work(p: Parts, before: Array, after: Array, du: Array, work: Array) -> float:
    """Work along du of the mean varying loads at two times."""
    if before.size == 0:
        return 0.0
    work[:] = 0.0
    add_varying(p, 0.5, before, work)
    add_varying(p, 0.5, after, work)
    return dot(work, du)


@jit
def damping_work(p: Parts, du: Array, v_mean: Array, out: Array, work: Array) -> float:
    """Work of viscous damping, -du^T C v_mean."""
    if not p.damped:
        return 0.0
    out[:] = 0.0
    add_product(p.C, -1.0, v_mean, out, work)
    return dot(out, du)
