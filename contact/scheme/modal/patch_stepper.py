"""Run of several contacts of a modal body: a rub with constant rows, with forward law, stick and slip.

D* = al D - be q + c f;  gaps g0 + Q (q + D) + S lam and slips T D + S (lam - lam_old) - slide h of the step obey
Signorini's and Coulomb's law together (`solver.coulomb`), or Signorini's alone (`solver.active_set`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, aligned
from contact.io.trust import Flag
from contact.model.bodies.patch import Patch
from contact.model.law import Law
from contact.record.energy import Stored
from contact.record.record import Samples, tally
from contact.scheme.modal.absent import absent
from contact.scheme.modal.at_speeds import AtSpeeds
from contact.scheme.modal.blocks import OF_MODES, narrowed, row_blocks, rows_of_waves, whole, widened
from contact.scheme.modal.free_flight import no_flight
from contact.scheme.modal.gives_way import memory_of, stored_by, too_long, yielding_of
from contact.scheme.modal.modal_blocks import modal_blocks
from contact.scheme.modal.propagator import ExactRun, Propagator
from contact.scheme.protocol import Block, Motion, Notes
from contact.solver.friction.inexact import inexact

if TYPE_CHECKING:
    from contact.loop.rub.deflection import RimWaves
    from contact.loop.rub.free_flight import FreeFlight
    from contact.loop.rub.rows import RubLaws, RubRows
    from contact.loop.rub.state import ModalBlocks, RubState, Solver, Work
    from contact.loop.rub.steady import Steady
    from contact.solver.yielding.yields import Yielding

NAMES = (*OF_MODES, "contact")
FAR_FETCHED = 1e6  # times what start and load could move a gap: a motion that feeds on itself
STEPS = 1e6
WAVES = 8  # of which a steady row has the first: a block


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PatchStepper(ExactRun):
    """State of a run with several contacts; `state.counts` contains the solver's iterations."""

    problem: Patch
    state: RubState  # views of `wide`
    wide: RubState
    laws: RubLaws
    rows: RubRows
    steady: Steady
    flight: FreeFlight
    work: Work
    solver: Solver
    law: Law
    averaged: bool
    y: Yielding | None
    coupled: ModalBlocks | None

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.state.q.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The body as the only block."""
        return (("body 1", 0, self.size),)

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        from contact.loop.rub.rub import advance_rub

        none = absent()
        failed = advance_rub(
            self.wide, self.laws, self.rows, none.coats, self.y or none.law, self.coupled or none.blocks, self.steady,
            self.solver, self.flight, self.work, self.dimensions, self.averaged, self.sums, out, self.dt, first, steps,
        )  # fmt: skip
        self.solver.room.otherwise.pass_on()
        return failed

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state, work arrays and sums."""
        coupled = () if self.coupled is None else self.coupled
        return self.wide, self.work, self.solver, self.steady, self.sums, coupled, memory_of(self.y)

    @property
    def overlap(self) -> float:
        """Largest overlap [m] at t = 0 of bodies that a load presses together, beyond their modal motion."""
        opening = self.problem.opening + self.problem.rows()[:: self.problem.dimensions] @ np.asarray(
            self.problem.displacement
        )
        return max(0.0, -float(opening.min()))

    @property
    def limits(self) -> Array:
        """Limits of the gaps [m], as in `motion_limits`."""
        return self.state.limits

    def why(self) -> Flag:
        """Explain a failed step."""
        from contact.loop.rub.state import JAMMED, ROUGH, UNSETTLED

        s = self.state
        words = {
            JAMMED: "no motion opens all gaps at once: contacts press against each other; give them a compliance",
            UNSETTLED: "the forces of the springs did not converge: reduce dt",
            ROUGH: "no forces satisfy Coulomb's law in every contact: reduce dt or mu",
        }
        fault = words.get(float(s.counts[3]))
        if fault is None or not (np.isfinite(s.q).all() and np.isfinite(s.d).all()):
            return Flag("the motion is not finite", "motion-overflow", failed=True)
        return Flag(fault, "unconverged", failed=True)

    def notes(self) -> Notes:
        """Flag for friction forces that are inexact at the limit of double precision."""
        long = too_long(self.y, self.stiffest, self.dt)
        return Notes(flags=(*inexact(float(self.solver.room.left[0])), *long))

    @property
    def dimensions(self) -> int:
        """Directions of each contact that are solved for."""
        return self.state.lam.size // self.state.mu.size

    @property
    def stiffest(self) -> float:
        """Largest gap that a unit force opens in one step at its own contact [m/N]."""
        normal = slice(None, None, self.dimensions)
        rows = self.steady.rows[normal, : self.size]
        own = np.sum(self.parts.yields(rows) * rows, axis=1) + np.diag(self.rows.still)[normal]
        return float(own.max())

    def stored(self) -> Stored:
        """Energy at t_n; energy stored in S and in compliant contacts counts as residual."""
        s = self.state
        residual = 0.5 * float(s.lam @ self.rows.still @ s.lam) if s.lam.any() else 0.0
        residual += stored_by(self.law, self.y)
        return self.parts.stored(s.q, s.d, s.contact, residual, 0.0)

    def motions(self) -> tuple[Motion, ...]:
        """NaN, since a modal body among several rigid motions has no single mean velocity."""
        return (Motion(kind="body", number=0, mean_velocity=math.nan, momentum=math.nan),)


def patch_stepper(problem: Patch, speeds: AtSpeeds, law: Law, label: str, *, averaged: bool) -> PatchStepper:
    """Stepper at t = 0; without friction only the normal rows are used. `averaged`: for laws with a response."""
    from contact.loop.rub.state import solver_of, work_space

    parts, mu = speeds.parts[0], law.mu
    rough = mu > 0.0 and problem.dimensions > 1
    step = 1 if rough else problem.dimensions
    given, k = np.ascontiguousarray(problem.rows()[::step]), problem.contacts
    S = np.ascontiguousarray(problem.compliance()[::step, ::step])
    slide = np.zeros((k, len(given) // k))
    if rough:
        slide[:, 1:] = np.asarray(problem.slide) * parts.h
    newton = rough or law.response is not None or parts.roots(given) is None
    W = _delassus(given, S, parts, k if averaged else 0) if newton else np.zeros((0, 0))
    rows = _rows(given, S, W, problem.opening, -slide.ravel())
    wide = widened(_state(problem, parts, given, mu), rows.width, NAMES)
    steady = _steady(given, S, parts, k, newton=newton)
    work = work_space(wide, rows, newton=newton)
    work.normal[:, :, : parts.omega.size] = given[:: len(given) // k]
    work.waves[:, :, 0, 0], work.fresh[:] = 1.0, 1
    coupled, _ = modal_blocks(speeds, parts.omega.size, parts.omega.size)
    state = narrowed(wide, parts.omega.size, NAMES)
    state.limits[1] = FAR_FETCHED * _reach(problem, given[:: len(given) // k], parts)
    return PatchStepper(
        problem=problem, parts=parts, state=state, wide=wide, laws=_laws(), rows=rows, steady=steady,
        flight=no_flight(parts), work=work, sums=tally(k), averaged=averaged, law=law, label=label, coupled=coupled,
        solver=solver_of(wide, newton=newton, yields=law.response is not None),
        y=yielding_of(law, state.now, state.last),
    )  # fmt: skip


def _state(problem: Patch, parts: Propagator, rows: Array, mu: float) -> RubState:
    """State at t = 0 of contacts with these rows."""
    from contact.loop.rub.state import RubState

    k, R, m = problem.contacts, len(rows), parts.omega.size
    q = np.array(problem.displacement, dtype=float)
    d = parts.backward(q, np.asarray(problem.velocity))
    now, moved = problem.opening + rows[:: R // k] @ q, rows[:: R // k] @ d

    def none(size: int) -> Array:
        return np.zeros(size)

    return RubState(
        q=q, d=d, old=none(m), al=parts.al, be=parts.be, c=parts.c, kick=parts.push(parts.load), weight=parts.weight,
        stiff=np.zeros((0, 0)), stiff_at=np.zeros((0, 0)), push=none(m), contact=none(m), body=none(0),
        mu=np.full(k, mu), lam=none(R), strain=none(R), motion=none(R), scale=none(k), now=now, last=now - moved,
        known=np.ones(k, dtype=np.int64), inside=np.ones(k, dtype=np.int64), free=none(k), test=none(k), skin=none(k),
        force=none(k), gap=none(k), seen=none(m), heat=none(k), drive=none(k), peaks=none(1),
        limits=np.array([math.inf, math.inf, 0.0, 0.0, math.inf, 0.0]), counts=none(4),
    )  # fmt: skip


def _rows(rows: Array, S: Array, W: Array, opening: Array, glide: Array) -> RubRows:
    """Constant rows, each a sum of one wave, cos 0."""
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.rows import RubRows

    (R, m), k = rows.shape, opening.size
    none, first = np.zeros((1, 1, 1)), np.zeros(1, dtype=np.int64)
    empty = RowBlocks(first[:0], first[:0], aligned(0, 8), first[:0])
    return RubRows(
        casing=RowBlocks(*row_blocks(rows_of_waves(first, rows[:, None], 0.0 * rows[:, None], WAVES))),
        width=whole(m), many=False, seen=empty,
        reach=aligned(0, whole(m)), rim=_no_rim(whole(m)), directions=R // k,
        line=np.arange(k), place=np.arange(k), glide=glide, angle=np.zeros(k),
        heading=np.tile([1.0, 0.0], (k, 1)), clearance=opening,
        blade=np.zeros((R, 0)), own=np.zeros((k, 2), dtype=np.int64), apart=np.zeros((k, 2), dtype=np.int64),
        fixed=np.zeros((R, R)), still=S, turns=False, steady=True, W=W, cell=0.0, form=empty, cells=0.0, few=False,
        S=RowBlocks(*row_blocks(rows_of_waves(first, none, none, WAVES))), harmonics=WAVES,
    )  # fmt: skip


def _no_rim(width: int) -> RimWaves:
    """A rim without lines."""
    from contact.loop.rub.deflection import RimWaves

    none = np.zeros(0)
    return RimWaves(
        reach=aligned(0, width), soft=np.zeros((0, 0)), rows=np.zeros((0, 0, width)), S=np.zeros((0, 0, 0, 0)),
        places=np.zeros((2, 0)), force=np.zeros((0, 0)), z=none, top=aligned(8),
    )  # fmt: skip


def _laws() -> RubLaws:
    """Ground at rest."""
    from contact.loop.rub.rows import Pulls, RubLaws, Spin, Swing, Terms

    none = np.zeros(0)
    return RubLaws(
        speed=np.zeros((1, 4)), closing=np.zeros((1, 2)), whirl=np.zeros((0, 4)),
        terms=Terms(np.zeros(0, dtype=np.int64), none, none), table=np.zeros((0, 3)), lowest=0.0,
        pulls=Pulls(laws=np.zeros((0, 8)), plane=np.zeros((2, 0)), casing=0),
        swing=Swing(np.zeros((0, 4)), np.zeros((2, 0)), 0), spin=Spin(-1, 0.0, 0.0, np.zeros(3), np.zeros(0)),
    )  # fmt: skip


def _delassus(rows: Array, S: Array, parts: Propagator, mean: int) -> Array:
    """Rows c rows^T + S.

    Normal rows of `mean` contacts get a quarter of the first term, as their law averages three gaps.
    """
    H = parts.yields(rows) @ rows.T
    if mean:
        H[:: len(rows) // mean] *= 0.25
    return np.ascontiguousarray(H + S)


def _steady(rows: Array, S: Array, parts: Propagator, k: int, *, newton: bool) -> Steady:
    """Solver data for contacts that do not need Newton's method on the forces, and data for their events."""
    from contact.loop.rub.steady import AtOnce, Steady
    from contact.loop.tally import Sticking
    from contact.solver.unilateral.active_set import active_space
    from contact.solver.unilateral.springs import spring_space, springs_of

    R, scaled, springs, roots = len(rows), parts.roots(rows), np.zeros(0), np.zeros((0, 0))
    if scaled is not None and not newton:
        springs = springs_of(scaled, S)
        roots = scaled if springs.size else _roots(scaled, S)
    columns, soft = roots.shape[1], springs.size
    full = aligned(R, whole(rows.shape[1]))
    full[:, : rows.shape[1]] = rows
    return Steady(
        rows=full, roots=roots, springs=springs, at_once=AtOnce(used=roots.size > 0),
        active=active_space(k, 0 if soft else columns), soft=spring_space(soft, columns if soft else 0),
        past=Sticking(np.zeros((2, R)), np.zeros(k), np.zeros(k), np.zeros(k)), slip=np.zeros(R), strain=np.zeros(R),
    )  # fmt: skip


def _reach(problem: Patch, normal: Array, parts: Propagator) -> float:
    """Largest motion of the gaps [m] due to start and load: of vibrating modes, and of rigid ones over STEPS steps."""
    elastic, time = parts.omega > 0.0, STEPS * parts.h
    omega = np.where(elastic, parts.omega, 1.0)
    speed, load = (np.abs(np.asarray(part)) for part in (problem.velocity, problem.load))
    moved = np.where(elastic, speed / omega + 2.0 * load / omega**2, speed * time + 0.5 * load * time**2)
    reach = np.abs(problem.opening) + np.abs(normal) @ (np.abs(np.asarray(problem.displacement)) + moved)
    return float(reach.max()) or math.inf


def _roots(scaled: Array, S: Array) -> Array:
    """Rows A with A A^T = scaled scaled^T + S for the active set, with no more columns than contacts."""
    from contact.solver.unilateral.active_set import delassus_rows

    if S.any():
        return np.ascontiguousarray(delassus_rows(scaled @ scaled.T + S))
    if scaled.shape[0] < scaled.shape[1]:
        scaled = np.asarray(np.linalg.qr(scaled.T, mode="r")).T
    return np.ascontiguousarray(scaled)
