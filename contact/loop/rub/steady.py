"""Compiled: contacts with constant rows, such as those of a patch: their matrix is known before the run.

Without friction an active set or Newton's method on the motion finds the forces of all contacts at once.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit
from contact.loop.modal.rows import product
from contact.loop.rub.rows import RubRows
from contact.loop.rub.state import JAMMED, UNSETTLED, RubState
from contact.loop.tally import Sticking, note_sticking
from contact.record.record import Samples, Tally
from contact.solver.unilateral.active_set import SOLVED, ActiveSpace, project
from contact.solver.unilateral.springs import SpringSpace, spring_forces


class Steady(NamedTuple):
    """K contacts with d directions each, normal first."""

    rows: Array  # (K d, width)
    roots: Array  # A with A A^T = W, or rows sqrt(c) where there are springs; empty where `RubRows.W` is there
    springs: Array  # (K,) diagonal of S where the contacts are solved as springs, else empty
    active: ActiveSpace
    soft: SpringSpace
    past: Sticking
    slip: Array  # (K d,) of the last step
    strain: Array  # (K d,) S lam before this step


@jit
def frictionless(s: RubState, steady: Steady) -> bool:
    """Forces of all contacts, with marks where they press; returns False if not all gaps can open."""
    if steady.springs.size > 0:
        solved, count = spring_forces(steady.roots, steady.springs, s.test, s.lam, steady.soft)
        if not solved:
            s.counts[3] = UNSETTLED
    else:
        status, count = project(steady.roots, s.test, s.mu.size, steady.roots.shape[1], s.lam, steady.active)
        solved = status == SOLVED
        if not solved:
            s.counts[3] = JAMMED
    s.counts[0] = max(s.counts[0], float(count))
    s.counts[1] += float(count)
    for j in range(s.mu.size):
        s.inside[j] = 2 if s.lam[j] > 0.0 else 1
        solved = solved and math.isfinite(s.test[j])
    return solved


@jit
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
