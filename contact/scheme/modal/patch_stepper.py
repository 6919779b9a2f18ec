"""Several contacts of a modal body, in progress: exact modal coefficients, forward law, stick and slip.

D* = al D - be q + c f;  gaps g0 + Q (q + D) + S lam and slips T D + S (lam - lam_old) - slide h of the step obey
Signorini's and Coulomb's law together (`solver.coulomb`), or Signorini's alone (`solver.active_set`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array
from contact.io.trust import Flag
from contact.model.bodies.patch import Patch
from contact.model.law import Law
from contact.record.energy import Stored
from contact.record.record import Samples, tally
from contact.scheme.modal.gives_way import memory_of, stored_by, too_long, yielding_of
from contact.scheme.modal.propagator import ExactRun, Propagator
from contact.scheme.protocol import Block, Motion, Notes
from contact.solver.friction.inexact import inexact

if TYPE_CHECKING:
    from contact.loop.modal.patch import PatchBlocks, PatchState, PatchWork
    from contact.solver.yielding.yields import Yielding


FAR_FETCHED = 1e6  # times what start and load could move a gap: a motion that feeds on itself
STEPS = 1e6


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PatchStepper(ExactRun):
    """State of a run with several contacts; `state.counts` tells the solver's iterations."""

    problem: Patch
    state: PatchState
    work: PatchWork
    rough: bool
    law: Law
    averaged: bool
    y: Yielding | None
    coupled: PatchBlocks | None

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.state.q.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The body."""
        return (("body 1", 0, self.size),)

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        from contact.loop.modal.patch import advance_patch

        failed = advance_patch(
            self.state, self.work, self.y, self.coupled, self.rough, self.averaged, self.sums, out, self.dt, first,
            steps,
        )  # fmt: skip
        self.work.room.otherwise.pass_on()
        return failed

    @property
    def memory(self) -> tuple[Any, ...]:
        """State, work arrays and sums."""
        return self.state, self.work, self.sums, memory_of(self.y)

    @property
    def overlap(self) -> float:
        """How far a load presses bodies into each other beside their modes at t = 0, at most [m]."""
        opening = self.problem.opening + self.problem.rows()[:: self.problem.dimensions] @ np.asarray(
            self.problem.displacement
        )
        return max(0.0, -float(opening.min()))

    @property
    def limits(self) -> Array:
        """How far the gaps may open or close [m], as those of `motion_limits`."""
        return self.state.limits

    def why(self) -> Flag:
        """Explain a failed step."""
        from contact.loop.modal.patch import JAMMED, ROUGH, UNSETTLED

        fault = self.state.counts[3]
        if fault == JAMMED:
            words = "no motion opens all gaps at once: contacts press against each other without compliance"
            return Flag(words, "unconverged", failed=True)
        if fault == UNSETTLED:
            return Flag("the forces of the springs did not settle: reduce dt", "unconverged", failed=True)
        if fault == ROUGH:
            words = "no forces found that obey Coulomb's law in every contact: reduce dt or mu"
            return Flag(words, "unconverged", failed=True)
        return Flag("the motion is not a number", "motion-overflow", failed=True)

    def notes(self) -> Notes:
        """What friction left of the motion, where double precision does no better."""
        long = too_long(self.y, float(np.max(self.state.own)), self.dt)
        return Notes(flags=(*inexact(float(self.work.room.left[0])), *long))

    def stored(self) -> Stored:
        """Energy at t_n; what S and contacts that give way store counts as residual."""
        s = self.state
        residual = 0.5 * float(s.lam @ s.S @ s.lam) if s.S.size else 0.0
        residual += stored_by(self.law, self.y)
        return self.parts.stored(s.q, s.d, s.rows.T @ s.lam, residual, 0.0)

    def motions(self) -> tuple[Motion, ...]:
        """A modal body among several rigid motions has no one mean velocity."""
        return (Motion(kind="body", number=0, mean_velocity=math.nan, momentum=math.nan),)


def patch_stepper(problem: Patch, parts: Propagator, law: Law, label: str, *, averaged: bool) -> PatchStepper:
    """Stepper at t = 0; without friction only the normal rows take part. `averaged`: for laws with a response."""
    from contact.loop.modal.patch import PatchState, patch_work
    from contact.loop.tally import Sticking
    from contact.solver.unilateral.springs import springs_of

    mu, gives_way = law.mu, law.response is not None
    rough = mu > 0.0 and problem.dimensions > 1
    step = 1 if rough else problem.dimensions
    rows = np.ascontiguousarray(problem.rows()[::step])
    S = np.ascontiguousarray(problem.compliance()[::step, ::step])
    k = problem.contacts
    dim = len(rows) // k
    own = np.sum(parts.yields(rows) * rows, axis=1)[::dim] + np.diag(S)[::dim]
    none = np.zeros((0, 0))
    if not S.any():
        S = none
    scaled = parts.roots(rows)
    newton = rough or gives_way or scaled is None
    springs, roots = np.zeros(0), none
    if scaled is not None and not newton:
        springs = springs_of(scaled, S)
        roots = scaled if springs.size else _roots(scaled, S)
    clearance, slide = problem.opening, np.zeros((k, dim))
    if rough:
        slide[:, 1:] = np.asarray(problem.slide) * parts.h
    q = np.array(problem.displacement, dtype=float)
    d = parts.backward(q, np.asarray(problem.velocity))
    state = PatchState(
        q=q, d=d, al=parts.al, be=parts.be, c=parts.c, kick=parts.push(parts.load), weight=parts.weight, rows=rows,
        S=S, own=own, W=_delassus(rows, parts, S, dim if averaged else 0) if newton else none, roots=roots,
        springs=springs,
        mu=np.full(k, mu), slide=slide.ravel(), lam=np.zeros(len(rows)), moved=rows @ d,
        place=clearance + rows[::dim] @ q, force=np.zeros(k), gap=np.zeros(k),
        past=Sticking(np.zeros((2, len(rows))), np.zeros(k), np.zeros(k), np.zeros(k)), counts=np.zeros(4),
        limits=np.array([math.inf, FAR_FETCHED * _reach(problem, rows[::dim], parts), 0.0, 0.0]),
    )  # fmt: skip
    return PatchStepper(
        problem=problem, parts=parts, state=state, sums=tally(k), rough=rough, averaged=averaged, law=law, label=label,
        work=patch_work(state, newton, rough and gives_way and k > 1),
        y=yielding_of(law, state.place, state.place - state.moved[::dim]), coupled=_blocks(parts),
    )  # fmt: skip


def _reach(problem: Patch, normal: Array, parts: Propagator) -> float:
    """How far start and load could move a gap [m]: of modes that vibrate, and of rigid ones over STEPS steps."""
    elastic, time = parts.omega > 0.0, STEPS * parts.h
    omega = np.where(elastic, parts.omega, 1.0)
    speed, load = (np.abs(np.asarray(part)) for part in (problem.velocity, problem.load))
    moved = np.where(elastic, speed / omega + 2.0 * load / omega**2, speed * time + 0.5 * load * time**2)
    reach = np.abs(problem.opening) + np.abs(normal) @ (np.abs(np.asarray(problem.displacement)) + moved)
    return float(reach.max()) or math.inf


def _blocks(parts: Propagator) -> PatchBlocks | None:
    """What the loop needs of coupled modes."""
    from contact.loop.modal.patch import PatchBlocks

    part = parts.coupled
    if part is None:
        return None
    squares = (part.alpha, part.beta, part.c, part.lost, part.false, part.odd)
    return PatchBlocks(part.modes, *squares, old=np.zeros(part.modes.size), now=np.zeros(part.modes.size))


def _delassus(rows: Array, parts: Propagator, S: Array, mean: int = 0) -> Array:
    """Rows c rows^T + S; a quarter of the first in every `mean`-th row, a normal, where the law is of three gaps."""
    H = parts.yields(rows) @ rows.T
    if mean:
        H[::mean] *= 0.25
    return np.ascontiguousarray(H + S if S.size else H)


def _roots(scaled: Array, S: Array) -> Array:
    """Rows A with A A^T = scaled scaled^T + S, for the active set, of no more columns than contacts."""
    from contact.solver.unilateral.active_set import delassus_rows

    if S.size:
        return np.ascontiguousarray(delassus_rows(scaled @ scaled.T + S))
    if scaled.shape[0] < scaled.shape[1]:
        scaled = np.asarray(np.linalg.qr(scaled.T, mode="r")).T
    return np.ascontiguousarray(scaled)
