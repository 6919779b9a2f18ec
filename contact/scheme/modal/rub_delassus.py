"""Response of the tips of a rub to forces within a step: Delassus numbers, and jammed tips."""

from __future__ import annotations

import math

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import LimitError
from contact.base.remembered import remembered
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import RimTable, RubSystem
from contact.model.trig import harmonics, turned_back
from contact.scheme.modal.propagator import Propagator

ANGLES = 60  # where the Delassus numbers are sampled around the rim
TURNED = (0.4, 1.1, 2.7, 4.5)  # [rad] where the contacts' matrix of a round casing must be the same
STEADY = 1e-13  # of its largest entry


def blade_delassus(system: RubSystem, parts: Propagator) -> Array:
    """Response of the blades' modes to unit forces within a step, between all directions of all tips, (K d, K d)."""
    return _of_blades(system.blade_rows, system.own, parts)


@remembered
def _of_blades(blade_rows: Array, own: Indices, parts: Propagator) -> Array:
    d = len(blade_rows) // len(own)
    full = np.zeros((len(blade_rows), parts.c.size))
    for row, values in enumerate(blade_rows):
        begin, end = own[row // d]
        full[row, begin:end] = values[: end - begin]
    return np.ascontiguousarray(parts.yields(full) @ full.T)


def unchanging(rub: Rub, system: RubSystem, parts: Propagator, share: float) -> Array:
    """Contact matrix of one step if it never changes, (K d, K d); else empty.

    At constant speed the angles between tips are constant. For a round casing with modes in pairs the matrix depends
    only on these differences. This is checked at several angles, to 1e-13 of its largest entry. `share` is the fraction
    of the modal response in the gaps: 1, or 1/4 with the averaged law.
    """
    none = np.zeros((0, 0))
    if system.contacts == 1 or system.turns or len(np.unique(rub.speed.hz)) > 1:
        return none
    return _unchanging(
        system.rim, system.directions, system.blade_rows, system.own, system.line, system.angle, system.still, parts,
        share, rub.speed.omega(0.0) * parts.h,
    ).copy()  # fmt: skip


@remembered
def _unchanging(
    rim: RimTable, directions: int, blade_rows: Array, own: Indices, line: Indices, angle: Array, still: Array,
    parts: Propagator, share: float, turn: float,
) -> Array:  # fmt: skip
    K, d, m = angle.size, len(blade_rows) // angle.size, rim.cos.shape[2]

    def rows(turned: float) -> Array:
        found = np.zeros((K, d, parts.c.size))
        for one in np.unique(line):
            here = line == one
            for i in range(d):
                found[here, i, :m] = rim.rows(int(one) * directions + i, angle[here] - turned)
        return found

    def at(turned: float) -> Array:
        law, now = rows(turned), rows(turned)
        law[:, 0] = share * rows(turned + turn)[:, 0]
        return parts.yields(law.reshape(K * d, -1)) @ now.reshape(K * d, -1).T

    first = at(0.0)
    largest = float(np.abs(first).max())
    for turned in TURNED:
        if float(np.abs(at(turned) - first).max()) > STEADY * largest:
            return np.zeros((0, 0))
    blades = _of_blades(blade_rows, own, parts).copy()
    blades[::d] *= share
    return np.ascontiguousarray(first + blades + still)


def rub_delassus(rub: Rub, system: RubSystem, parts: Propagator, mu: float) -> tuple[float, float, float]:
    """H_d, S and rho = |H_d|/S at the tip and angle with the largest rho, for each tip alone, sliding.

    Raises LimitError if sliding friction makes H_d + S negative: then the tip digs in and no force opens the contact.
    """
    fastest = rub.speed.hz[int(np.abs(rub.speed.hz).argmax())]
    pull = math.copysign(mu, fastest) if fastest else 0.0
    s = system
    H, soft = _around_rim(
        s.rim, s.directions, s.blade_rows, s.own, s.line, s.angle, s.S, s.still, parts, pull
    )  # fmt: skip
    jams = np.argwhere(H + soft <= 0.0)
    if jams.size:
        i, j = jams[0]
        raise LimitError(
            f"law: found H_d + S = {H[i, j] + soft[i, j]:.4g} m/N at tip {j}, "
            f"{math.degrees(system.angle[j] - _angles()[i]):.0f} deg, mu = {mu:g}, "
            "expected > 0: the blade jams, since its friction is too high for its lean; reduce mu or lean_deg"
        )
    rho = np.divide(np.abs(H), soft, out=np.full_like(H, math.inf), where=soft > 0.0)
    worst = int(rho.argmax())
    return float(H.flat[worst]), float(soft.flat[worst]), float(rho.flat[worst])


def _angles() -> Array:
    return np.asarray(np.arange(float(ANGLES)) * (2.0 * math.pi / ANGLES))


@remembered
def _around_rim(
    rim: RimTable, directions: int, blade_rows: Array, own: Indices, line: Indices, angle: Array, S: Array,
    still: Array, parts: Propagator, pull: float,
) -> tuple[Array, Array]:  # fmt: skip
    """H_d and S of each tip at each angle, (angles, tips) both."""
    d, m, turned = len(blade_rows) // angle.size, rim.cos.shape[2], _angles()
    T = min(1, d - 1)  # without friction there is no tangent, and no pull
    j = d * np.arange(angle.size)
    parts_at_rest = _of_blades(blade_rows, own, parts), still
    H, soft = (np.tile(A[j, j] - pull * A[j, j + T], (ANGLES, 1)) for A in parts_at_rest)
    for one in np.unique(line):
        here, block = np.flatnonzero(line == one), int(one) * directions
        Q, along = (np.concatenate([rim.cos[b], rim.sin[b, 1:]]) for b in (block, block + 1))
        waves = np.zeros((len(Q), parts.c.size))
        waves[:, :m] = Q
        form = parts.yields(waves)[:, :m] @ (Q - pull * along).T
        H[:, here] += _around(rim.n_max, angle[here], turned, form)
        if S.size:
            across = S[d * one][:, d * one] - pull * S[d * one][:, d * one + T]
            soft[:, here] += _around(S.shape[1] // 2, angle[here], turned, across)
    return H, soft


def _around(n_max: int, angle: Array, turned: Array, form: Array) -> Array:
    """Quadratic form in the waves 1, cos .. cos N, sin .. sin N at the tips, for each angle of rotation."""
    E = turned_back(harmonics(n_max, angle), turned)
    return np.asarray(np.sum(E @ form * E, axis=-1))
