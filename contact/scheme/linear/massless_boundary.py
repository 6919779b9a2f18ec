"""The massless boundary: the mass of contact coordinates moves inwards, and these follow statically with contact."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError
from contact.model.bodies.band import Band, band, combine, diagonal, lumped, pairs
from contact.model.bodies.linear_system import LinearSystem, omega_max
from contact.model.law import Law
from contact.scheme.linear.stepper import (
    LinearStepper,
    linear_stepper,
    parts_of,
    product,
    setup,
    start,
    started,
)
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.loop.linear.leapfrog import Massless
    from contact.solver.unilateral.complementarity import LawNumbers


@dataclass(frozen=True, slots=True)
class MasslessBoundary:
    """Leapfrog with the mass of contact coordinates moved inwards, which avoids a first force spike (law: Unilateral).

    The mass (and dashpot) of each contact's coordinates moves to the coordinates to which springs connect them;
    leapfrog for these, statics with contact for the massless ones (Khenous, Laborde, Renard, Eur. J. Mech. A/Solids 27,
    2008, 918; explicit: Chouly, Renard, Adv. Model. Simul. Eng. Sci. 5, 2018, 31). dt omega_max <= 2, with every
    contact closed; order 2 in smooth motion; no penetration; total mass is kept, its centre moves by less than an
    element. The semi-discrete problem keeps its energy through impacts; the steps lose or gain the energy that
    `lost_in_contact` shows.

    >>> MasslessBoundary()
    MasslessBoundary()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises LimitError, and InputError if a contact has no elastic side."""
        from contact.loop.linear.leapfrog import advance_massless

        name = "MasslessBoundary"
        run = setup(name, problem, law, ("Unilateral",), dt, courant)
        full, h = run.system, run.h
        if not (full.M.lumped and full.C.lumped):
            raise InputError(f"M, C: found coupled coordinates, expected lumped mass and damping for {name}")
        bare = _massless_places(full)
        system = replace(full, M=_moved(full.M, full.K, bare), C=_moved(full.C, full.K, bare))
        heavy = np.ones(system.size, dtype=bool)
        heavy[bare] = False
        solid = replace(system, M=lumped(system.M.ground + np.where(heavy, 0.0, 1.0)))
        static = _massless(system, bare)
        omega = omega_max(replace(solid, K=_closed_stiffness(system, static)), free=heavy)
        parts = parts_of(solid, combine((1.0 / h**2, solid.M), (0.5 / h, system.C)), 1.0)._replace(M=system.M)
        u, v, _ = start(solid)
        stepper = linear_stepper(
            replace(run, system=system, omega=omega), parts, advance_massless, (run.law, static),
            "massless boundary, contact closed", limit=2.0, leapfrog=True, begin=(u, v, np.zeros(u.size)),
        )  # fmt: skip
        _settle_start(stepper, static, run.law)
        return started(stepper)


def _massless_places(system: LinearSystem) -> Indices:
    """Contact coordinates that are connected to springs and have no mass beyond that of their neighbours."""
    mass, sprung = system.M.ground, diagonal(system.K) - system.K.ground > 0.0
    neighbours = _neighbour_mass(system)
    bare = []
    for k in range(system.gap0.size):
        columns = system.columns[k][system.value[k] != 0.0]
        soft = [i for i in columns if sprung[i] and mass[i] <= neighbours[i]]
        if not soft:
            raise InputError(
                f"scheme: found contact {k + 1} between point masses, walls or ends with an end mass, expected an "
                "elastic body with a free contact end for MasslessBoundary: use another scheme"
            )
        bare += soft
    return np.unique(np.array(bare, dtype=np.int64))


def _neighbour_mass(system: LinearSystem) -> Array:
    """Largest mass among the neighbours to which springs connect each coordinate."""
    found, mass = np.zeros(system.size), system.M.ground
    rows, columns, _ = pairs(system.K)
    np.maximum.at(found, rows, mass[columns])
    np.maximum.at(found, columns, mass[rows])
    return found


def _pull(K: Band, i: int) -> tuple[Indices, Array]:
    """Coordinates to which springs connect coordinate i, and the stiffnesses of these springs."""
    rows, columns, values = pairs(K)
    after, before = rows == i, columns == i
    return np.concatenate([columns[after], rows[before]]), -np.concatenate([values[after], values[before]])


def _moved(A: Band, K: Band, bare: Indices) -> Band:
    """Diagonal A with the entries of `bare` distributed over their springs in proportion to stiffness."""
    moved = A.ground.copy()
    for i in bare:
        others, springs = _pull(K, int(i))
        share = np.where(np.isin(others, bare), 0.0, np.abs(springs))
        if not share.any():
            raise InputError(
                "scheme: found a contact coordinate with springs only to other contact coordinates, expected one to an "
                "inner coordinate for MasslessBoundary: refine the mesh"
            )
        moved[others] += A.ground[i] * share / share.sum()
    moved[bare] = 0.0
    return lumped(moved)


def _massless(system: LinearSystem, bare: Indices) -> Massless:
    """Rows of K, K_cc^-1, and displacement per contact force."""
    from contact.loop.linear.leapfrog import Massless

    lists = [_pull(system.K, int(i)) for i in bare]
    width = max(others.size for others, _ in lists)
    near, stiff = np.repeat(bare[:, None], width, axis=1), np.zeros((bare.size, width))
    block = np.diag(diagonal(system.K)[bare])
    for m, (others, springs) in enumerate(lists):
        near[m, : others.size], stiff[m, : others.size] = others, -springs
        for j, spring in zip(others, springs, strict=True):
            block[m, bare == j] = -spring
    flex, Q = np.asarray(np.linalg.inv(block), dtype=np.float64), system.rows()[:, bare]
    return Massless(
        place=bare, near=near, stiff=stiff, ground=system.K.ground[bare].copy(), flex=flex,
        lift=np.ascontiguousarray(Q @ flex), S=np.ascontiguousarray(Q @ flex @ Q.T),
        residual=np.zeros(bare.size), force=np.zeros(Q.shape[0]),
    )  # fmt: skip


def _closed_stiffness(system: LinearSystem, static: Massless) -> Band:
    """K of the coordinates with mass while every contact is closed: K_mm - K_mc K_cc^-1 K_cm + B^T S^-1 B.

    B = Q_m - Q_c K_cc^-1 K_cm: motion of the gap per unit of each coordinate, with the massless ones following.
    """
    from scipy.sparse import csr_array

    bare, order = static.place, system.order
    K = csr_array(csr_array(system.body.K)[order][:, order])
    Q = csr_array(system.rows())
    coupling = csr_array(K[bare])
    follow = csr_array(static.lift) @ coupling
    B = csr_array(Q - follow)
    closed = K - coupling.T @ csr_array(static.flex) @ coupling + B.T @ csr_array(np.linalg.pinv(static.S)) @ B
    return band(csr_array(closed), np.arange(system.size), wide=bool(system.K.sparse.start.size))


def _settle_start(stepper: LinearStepper, static: Massless, law: LawNumbers) -> None:
    """Bring the massless coordinates into static equilibrium at t = 0 and one step before; D is of second order."""
    from contact.loop.linear.leapfrog import settle

    system, parts, s, h = stepper.system, stepper.parts, stepper.state, stepper.dt
    load, speed = system.amplitudes(0, 0, h)[0], s.v / h
    settle(parts, static, s, law, load)
    now = s.u.copy()
    net = system.load + load @ system.shapes - product(system.K, now) - product(system.C, speed)
    mass = system.M.ground
    a = np.where(mass > 0.0, (net + s.force @ system.rows()) / np.where(mass > 0.0, mass, 1.0), 0.0)
    s.u[:] = now - h * speed + 0.5 * h * h * a
    settle(parts, static, s, law, load)
    s.v[:] = now - s.u
    s.u[:] = now
    settle(parts, static, s, law, load)
