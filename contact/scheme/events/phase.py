"""Exact motion in one phase: the modes of the system with some of its contacts closed.

A closed contact with compliance is a spring: K + N^T S^-1 N. A closed rigid contact is a constraint, N q + clearance =
0: the motion is that of the modes in the null space of N, and the force keeps N q'' = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.scheme.events.system import EventSystem

Complex = NDArray[np.complex128]
RIGID = 1e-12  # of the highest frequency: a lower one is none
DEFECT = 6e6  # condition of the eigenvectors of damped modes: round-off of a double root leaves 1/sqrt(eps), 6.7e7
APART = 1e-12  # of the largest damping: couplings of modes below are none


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Phase:
    """q = rest + R s + Re(V z), q' = R s' + Re(V lam z), s'' = pull, z' = lam z, z = U (q - rest, q').

    A watched quantity (gap of an open contact, force of a closed one) is level + place (q - rest) + speed q'. `terms`:
    the sizes of what adds up to `level`. `damping` (n, n) is C, or None where no mode is damped.
    """

    closed: tuple[int, ...]
    rest: Array
    R: Array
    pull: Array
    lam: Complex
    V: Complex
    U: Complex
    level: Array
    terms: Array
    place: Array
    speed: Array
    damping: Array | None


def phase_of(system: EventSystem, closed: tuple[int, ...]) -> Phase:
    """The phase of these closed contacts; raises InputError for damping that has no exact form."""
    N, S, g, rigid = system.N, system.S, system.clearance, system.rigid
    soft = [i for i in closed if not rigid[i]]
    held = [i for i in closed if rigid[i]]
    K, load, roots = system.K.copy(), system.load.copy(), [system.root]
    level, place, speed = g.copy(), N.copy(), np.zeros_like(N)
    if soft:
        L = np.linalg.cholesky(S[np.ix_(soft, soft)])
        roots.append(np.linalg.solve(L, N[soft]))
        pressed, at_rest = (np.linalg.solve(L.T, part) for part in (roots[1], np.linalg.solve(L, g[soft])))
        K += N[soft].T @ pressed
        load -= N[soft].T @ at_rest
        place -= S[:, soft] @ pressed
        level -= S[:, soft] @ at_rest
        place[soft], level[soft] = -pressed, -at_rest
    Z, fixed = _free(N[held], g[held])
    if held:
        H = N[held] @ N[held].T
        level[held] = -np.linalg.solve(H, N[held] @ load)
        place[held], speed[held] = np.linalg.solve(H, N[held] @ K), np.linalg.solve(H, N[held] @ system.C)
    _, w, P = np.linalg.svd(np.vstack(roots) @ Z)  # K = root^T root: low modes beside stiff contacts stay exact
    still = np.concatenate([w, np.zeros(len(P) - w.size)]) <= RIGID * w.max(initial=0.0)
    R, modes = Z @ P[still].T, Z @ P[~still].T
    if R.size and np.abs(R.T @ system.C).max(initial=0.0) > APART * np.abs(system.C).max(initial=0.0):
        raise InputError("damping: found damping of a rigid motion, expected none")
    w = w[: len(modes.T)]
    rest = fixed + modes @ (modes.T @ (load - K @ fixed) / w**2)
    lam, V, U, damped = _poles(w, modes, system.C)
    return Phase(
        closed=closed, rest=rest, R=R, pull=R.T @ (load - K @ fixed), lam=lam, V=V, U=U, level=level + place @ rest,
        terms=np.abs(level) + np.abs(place) @ np.abs(rest),
        place=place, speed=speed, damping=system.C if damped else None,
    )  # fmt: skip


def _free(rows: Array, clearance: Array) -> tuple[Array, Array]:
    """Orthonormal basis of the null space of rows (c, n), and the smallest q with rows q = -clearance."""
    count, n = rows.shape
    if not count:
        return np.eye(n), np.zeros(n)
    left, size, right = np.linalg.svd(rows)
    return right[count:].T, -right[:count].T @ ((left.T @ clearance) / size)


def _poles(w: Array, modes: Array, C: Array) -> tuple[Complex, Complex, Complex, bool]:
    """Poles, V and U of elastic `modes` (n, m) with frequencies w, and whether they are damped."""
    D = modes.T @ C @ modes
    own, largest = np.diag(D), float(np.abs(C).max(initial=0.0))
    if not largest > 0.0 or np.abs(D).max(initial=0.0) <= APART * largest:
        return np.asarray(1j * w), modes.astype(complex), np.hstack([modes.T, -1j * modes.T / w[:, None]]), False
    if np.abs(D - np.diag(own)).max() <= APART * largest and np.all(0.5 * own < 0.999 * w):
        turn = np.sqrt(w**2 - 0.25 * own**2)
        lam = -0.5 * own + 1j * turn
        U = np.hstack([(1.0 - 0.5j * own / turn)[:, None] * modes.T, -1j * modes.T / turn[:, None]])
        return lam, modes.astype(complex), U, True
    m = w.size
    A = np.block([[np.zeros((m, m)), np.diag(w)], [-np.diag(w), -D * w / w[:, None]]])  # of eta and eta'/w
    lam, X = np.linalg.eig(A)
    if not np.linalg.cond(X) < DEFECT:
        raise InputError("zeta: found critically damped modes, expected a damping ratio other than 1")
    upper = np.flatnonzero(lam.imag >= 0.0)
    twice = np.where(lam[upper].imag > 0.0, 2.0, 1.0)
    Y = np.linalg.inv(X)[upper]
    return lam[upper], modes @ (X[:m, upper] * twice), np.hstack([Y[:, :m] @ modes.T, (Y[:, m:] / w) @ modes.T]), True
