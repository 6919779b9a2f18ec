"""What an event of rigid contacts changes: Newton's impact law, and which contacts stay closed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.scheme.events.system import EventSystem
from contact.solver.unilateral.pivoting import pressing

Closed = NDArray[np.bool_]
TOUCH = 1e-9  # of the terms of a gap: nearer contacts take part in an impact
REST = 1e-5  # of a contact's fastest impact: a slower one ends a series of impacts


def impact(
    system: EventSystem, q: Array, v: Array, closed: Closed, hit: Closed, restitution: float, fastest: Array
) -> tuple[Array, Array, Closed]:
    """Velocities after an impact, impulses (k,) and the contacts closed after it; `fastest` (k,) is raised.

    Rigid contacts that are closed, are hit or touch take part: u+ = u- + N N^T impulse, u+ + e u- >= 0 and impulse >= 0
    complementary (Newton's law for several contacts, Moreau 1988). Slow impacts (REST) have e = 0. Contacts at rest
    stay closed if the free motion would press them together.
    """
    N, k = system.N, system.clearance.size
    gap = system.clearance + N @ q
    near = gap <= TOUCH * (np.abs(system.clearance) + np.abs(N) @ np.abs(q))
    met = np.flatnonzero(system.rigid & (closed | hit | near))
    H, before = N[met] @ N[met].T, N[met] @ v
    fastest[met] = np.maximum(fastest[met], -before)
    e = np.where(-before > REST * fastest[met], restitution, 0.0)
    push = pressing(H, before + e * np.minimum(before, 0.0))
    after = v + N[met].T @ push
    impulse, still = np.zeros(k), closed & ~system.rigid
    impulse[met] = push
    rests = met[np.abs(N[met] @ after) <= REST * fastest[met]]
    soft = np.flatnonzero(still)
    lam = -np.linalg.solve(system.S[np.ix_(soft, soft)], gap[soft]) if soft.size else np.zeros(0)
    force = system.load - system.K @ q - system.C @ after + N[soft].T @ lam
    pressed = pressing(N[rests] @ N[rests].T, N[rests] @ force) > 0.0
    still[rests[pressed]] = True
    held = rests[pressed]
    if held.size:  # at rest exactly
        stop = -np.linalg.solve(N[held] @ N[held].T, N[held] @ after)
        after, impulse[held] = after + N[held].T @ stop, impulse[held] + stop
    return after, impulse, still
