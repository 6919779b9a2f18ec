"""Modes of all bodies of a problem and their frictionless contacts, as matrices."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.model.bodies.chain import Chain
from contact.model.bodies.patch import Patch
from contact.model.gaps.gap import PointGap
from contact.model.gaps.modal_system import point_system
from contact.model.gaps.rod_modes import chain_gap
from contact.scheme.protocol import Block, Problem

SYMMETRIC = 1e-9  # of the largest entry


@dataclass(frozen=True, eq=False, kw_only=True)
class EventSystem:
    """q'' + C q' + K q = load + N^T lam,  gap = clearance + N q + S lam,  0 <= gap, lam, complementary.

    n modes of unit mass, k contacts: C, K (n, n), N (k, n), S (k, k). A contact with S_ii = 0 is rigid. `q` and `v` at
    t = 0. `masses` [kg] of the bodies in `blocks` that have a rigid motion, else NaN.
    """

    C: Array
    K: Array
    load: Array
    q: Array
    v: Array
    N: Array
    S: Array
    clearance: Array
    omega: Array
    blocks: tuple[Block, ...]
    masses: tuple[float, ...]
    potential: float = 0.0

    @property
    def rigid(self) -> NDArray[np.bool_]:
        """Whether each contact has no compliance, (k,)."""
        return np.asarray(np.diag(self.S) == 0.0)

    @cached_property
    def root(self) -> Array:
        """A root A of K = A^T A, (n, n); raises InputError for an indefinite K."""
        own = np.diag(self.K)
        if not np.any(self.K - np.diag(own)):
            return np.diag(np.sqrt(own))
        square, P = np.linalg.eigh(self.K)
        if square.min() < -SYMMETRIC * square.max():
            raise InputError("stiffness: found an indefinite matrix, expected a positive semidefinite one")
        return np.asarray(np.sqrt(np.maximum(square, 0.0))[:, None] * P.T)


def event_system(problem: Problem, modes: int, stiffness: float) -> EventSystem:
    """Matrices of a problem; `modes` of each rod, `stiffness` [N/m] of springs in the contacts, 0 for none.

    Raises InputError for another kind of problem, and for matrices that are not symmetric.
    """
    if isinstance(problem, Chain):
        problem = chain_gap(problem, modes=modes)
    if isinstance(problem, PointGap):
        system = _of_gap(problem)
    elif isinstance(problem, Patch):
        system = _of_patch(problem)
    else:
        found = type(problem).__name__
        raise InputError(f"scheme: found EventDriven for {found}, expected rods and masses, a PointGap or a Patch")
    for name, matrix in (("damping", system.C), ("stiffness", system.K)):
        if np.abs(matrix - matrix.T).max(initial=0.0) > SYMMETRIC * np.abs(matrix).max(initial=0.0):
            raise InputError(f"{name}: found a matrix that is not symmetric, expected a symmetric one for EventDriven")
    if stiffness > 0.0:
        system = replace(system, S=system.S + np.eye(len(system.S)) / stiffness)
    _require_independent(system)
    return system


def _require_independent(system: EventSystem) -> None:
    """Raise InputError unless the forces of all contacts together are unique."""
    rigid, S = system.rigid, system.S
    if rigid.any() and np.abs(S[rigid]).max() > 0.0:
        raise InputError("S: found a zero on the diagonal with other entries in its row, expected a row of zeros")
    if not rigid.all() and not np.linalg.eigvalsh(S[np.ix_(~rigid, ~rigid)])[0] > 1e-12 * np.diag(S).max():
        raise InputError("S: found a singular compliance of the contacts, expected a positive definite one")
    if rigid.any() and np.linalg.matrix_rank(system.N[rigid]) < int(rigid.sum()):
        raise InputError(
            "contact: found linearly dependent rigid contacts, expected a compliance (S, or a Penalty law)"
        )


def _of_gap(gap: PointGap) -> EventSystem:
    form, sides = point_system(gap), gap.sides
    C, K = (_diagonal([side.body.without_rotation().matrices()[part] for side in sides]) for part in range(2))
    first = form.first.tolist()
    return EventSystem(
        C=C, K=K, load=form.load, q=np.zeros(form.omega.size), v=form.velocity, N=form.Q[None],
        S=np.array([[form.S_nn(0.0)]]), clearance=np.array([form.clearance(0.0)]), omega=form.omega,
        blocks=tuple(zip(form.names, first[:-1], first[1:], strict=True)), masses=form.masses,
        potential=form.potential,
    )  # fmt: skip


def _of_patch(patch: Patch) -> EventSystem:
    C, K = patch.body.without_rotation().matrices()
    d = patch.dimensions
    return EventSystem(
        C=C, K=K, load=np.asarray(patch.load), q=np.asarray(patch.displacement), v=np.asarray(patch.velocity),
        N=patch.rows()[::d], S=patch.compliance()[::d, ::d], clearance=patch.opening, omega=patch.body.omega,
        blocks=(("body 1", 0, patch.body.omega.size),), masses=(math.nan,),
    )  # fmt: skip


def _diagonal(parts: list[Array]) -> Array:
    """A block-diagonal matrix."""
    size = sum(len(part) for part in parts)
    whole, at = np.zeros((size, size)), 0
    for part in parts:
        whole[at : at + len(part), at : at + len(part)] = part
        at += len(part)
    return whole
