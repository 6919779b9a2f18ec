"""Compiled: contacts with constant rows, such as those of a patch: their matrix is known before the run.

Without friction an active set or Newton's method on the motion finds the forces of all contacts at once.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from numba import types

from contact.base.arrays import Array
from contact.jit.bundle import Bundle
from contact.jit.compiled import MATRIX, VECTOR, ByAddress, VectorPipeline, jit, jit_apart
from contact.loop.modal.rows import product
from contact.loop.rub.rows import RubRows
from contact.loop.rub.state import JAMMED, UNSETTLED, RubState
from contact.loop.tally import Sticking, note_sticking
from contact.record.record import Samples, Tally
from contact.solver.unilateral.active_set import SOLVED, ActiveSpace, active_space, project
from contact.solver.unilateral.springs import SpringSpace, spring_forces, spring_space

kinds: Any = types


def forces_at_once(roots: Array, springs: Array, gap: Array, force: Array, active: ActiveSpace,
                   soft: SpringSpace) -> tuple[int, int]:  # fmt: skip
    """Fill `force` of all frictionless contacts for their free gaps; returns 1 if solved, else 0, and iterations."""
    if springs.size > 0:
        converged, count = spring_forces(roots, springs, gap, force, soft)
        return (1 if converged else 0), count
    status, count = project(roots, gap, gap.size, roots.shape[1], force, active)
    return (1 if status == SOLVED else 0), count


class AtOnce(ByAddress):
    """`forces_at_once` as a function address, so that loops of other contacts do not contain its code."""

    kind: Any = kinds.UniTuple(kinds.int64, 2)(
        MATRIX, VECTOR, VECTOR, VECTOR, Bundle(active_space(1, 1)).kind, Bundle(spring_space(1, 1)).kind
    )  # fmt: skip
    function = staticmethod(forces_at_once)
    pipeline = VectorPipeline


class Steady(NamedTuple):
    """K contacts with d directions each, normal first."""

    rows: Array  # (K d, width)
    roots: Array  # A with A A^T = W, or rows sqrt(c) where there are springs; empty where `RubRows.W` is there
    springs: Array  # (K,) diagonal of S where the contacts are solved as springs, else empty
    at_once: AtOnce
    active: ActiveSpace
    soft: SpringSpace
    past: Sticking
    slip: Array  # (K d,) of the last step
    strain: Array  # (K d,) S lam before this step


@jit
def frictionless(s: RubState, steady: Steady) -> bool:
    """Forces of all contacts, with marks where they press; returns False if not all gaps can open."""
    status, count = steady.at_once(steady.roots, steady.springs, s.test, s.lam, steady.active, steady.soft)
    solved = status == 1
    if not solved:
        s.counts[3] = UNSETTLED if steady.springs.size > 0 else JAMMED
    s.counts[0] = max(s.counts[0], float(count))
    s.counts[1] += float(count)
    for j in range(s.mu.size):
        s.inside[j] = 2 if s.lam[j] > 0.0 else 1
        solved = solved and math.isfinite(s.test[j])
    return bool(solved)


@jit_apart
def note_slips(s: RubState, rows: RubRows, steady: Steady, dim: int, sums: Tally, out: Samples, time: float,
               h: float) -> None:  # fmt: skip
    """Record the slips of all contacts over this step, and where they begin and cease to stick."""
    for j in range(s.mu.size):
        for i in range(1, dim):
            row = j * dim + i
            moved = product(steady.rows[row], s.d)
            steady.slip[row] = moved + s.strain[row] - steady.strain[row] + rows.glide[row]
        note_sticking(steady.past, sums, out, j, time, h, s.mu[j], rows.W, s.lam, steady.slip)
    for row in range(s.strain.size):
        steady.strain[row] = s.strain[row]
