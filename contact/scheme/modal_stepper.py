"""The exact-modal run in progress: state, loop and readings."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.energy import Stored
from contact.model.arrays import Array
from contact.model.modal_system import ModalSystem
from contact.model.trig import Trig
from contact.record import Samples, Tally, tally
from contact.scheme.propagator import Propagator
from contact.scheme.protocol import Block, Motion

if TYPE_CHECKING:
    from contact.scheme.loop_modal import ModalState
    from contact.scheme.loop_rim import RimRows

FULL = 0.15  # share of entries above which full tables are faster (they vectorise)

Loop = Callable[["ModalState", Tally, Samples, int, int], int]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModalStepper:
    """State of an exact-modal run; see `exact_modal` for the equations."""

    system: ModalSystem
    parts: Propagator
    state: ModalState
    sums: Tally
    loop: Loop
    label: str
    steps: list[int]  # steps taken so far, one entry

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return self.parts.h

    @property
    def window(self) -> float:
        """Period of the highest mode [s]."""
        top = float(self.system.omega.max(initial=0.0))
        return max(2.0 * math.pi / top, self.dt) if top > 0.0 else self.dt

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.state.q.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Modes of each body."""
        return blocks_of(self.system)

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        failed = self.loop(self.state, self.sums, out, first, steps)
        self.steps[0] = first + steps
        return failed

    def why(self) -> str:
        """Explain a failed step."""
        if np.isnan(self.state.q).any() or np.isnan(self.state.d).any():
            return "the motion is not a number"
        H, scale = self.state.memory[2:4]
        return (
            f"the contact jams: Delassus number {scale:.4g} m/N (modes {H:.4g}), expected > 0; friction "
            "exceeds what the lean of the blade allows: reduce mu or the lean"
        )

    def stored(self) -> Stored:
        """Energy at t_n; lam^2 S/2 counts as residual."""
        system, memory = self.system, self.state.memory
        phi = system.angle - system.speed * self.steps[0] * self.dt
        force, pull = float(memory[2]), float(memory[3])
        Q, T = system.table.rows(phi) if system.table is not None else (system.Q, system.Q * 0.0)
        residual = 0.5 * force**2 * (system.S_nn(phi) - pull * system.S_nt(phi))
        return self.parts.stored(self.state.q, self.state.d, (Q - pull * T) * force, residual, system.potential)

    def motions(self) -> tuple[Motion, ...]:
        """Rigid motion of each body: from its mode of frequency zero, NaN without one."""
        return motions_of(self.system, self.state.d / self.dt)


def blocks_of(system: ModalSystem) -> tuple[Block, ...]:
    """Name, first and one past the last mode of each body."""
    first = system.first.tolist()
    return tuple(zip(system.names, first[:-1], first[1:], strict=True))


def motions_of(system: ModalSystem, velocity: Array) -> tuple[Motion, ...]:
    """Mean velocity and momentum of each body that has one rigid mode."""
    found = []
    for b, (name, mass) in enumerate(zip(system.names, system.masses, strict=True)):
        modes = slice(int(system.first[b]), int(system.first[b + 1]))
        rigid = system.omega[modes] == 0.0
        speed = math.nan
        if np.count_nonzero(rigid) == 1 and mass > 0.0:
            speed = float(np.sum(velocity[modes][rigid])) / math.sqrt(mass)
        found.append(Motion(kind=name, number=b, mean_velocity=speed, momentum=speed * mass))
    return tuple(found)


def modal_stepper(system: ModalSystem, parts: Propagator, *, averaged: bool, mu: float, label: str) -> ModalStepper:
    """Stepper at t = 0, with the compiled loop that this scene needs and no other."""
    q = np.zeros(system.omega.size)
    d = parts.backward(q, system.velocity)
    state = _state(system, parts, q, d)
    damped = bool(system.zeta.any())
    loop = (
        _rim_loop(system, parts.h, averaged, damped, mu)
        if system.table
        else _point_loop(system, parts, averaged, damped)
    )
    return ModalStepper(system=system, parts=parts, state=state, sums=tally(1), loop=loop, label=label, steps=[0])


def _state(system: ModalSystem, parts: Propagator, q: Array, d: Array) -> ModalState:
    from contact.scheme.loop_modal import ModalState

    def gap(steps: int, q: Array) -> float:
        phi = system.angle - system.speed * parts.h * steps
        rows = system.table.rows(phi)[0] if system.table is not None else system.Q
        return system.clearance(phi) + float(rows @ q)

    return ModalState(
        q=q, d=d, old=np.zeros(q.size), al=parts.al, be=parts.be, c=parts.c, kick=parts.c * system.load,
        weight=(1.0 - parts.al) / (2.0 * parts.c),
        memory=np.array([gap(0, q), gap(-1, q - d), 0.0, 0.0, system.S_nn(system.angle)]),
        force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip


def _point_loop(system: ModalSystem, parts: Propagator, averaged: bool, damped: bool) -> Loop:
    from contact.scheme.loop_modal import advance_modal

    clearance, S, h, Q = system.clearance(0.0), system.S_nn(0.0), parts.h, system.Q

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_modal(state, Q, clearance, S, averaged, damped, sums, out, h, first, steps)

    return loop


def _rim_loop(system: ModalSystem, h: float, averaged: bool, damped: bool, mu: float) -> Loop:
    from contact.scheme.loop_rim import advance_rim

    rows, m = _rim_rows(system, mu), system.omega.size
    Q, Q_next, T = np.zeros(m), np.zeros(m), np.zeros(m)

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_rim(state, rows, Q, Q_next, T, averaged, damped, sums, out, h, first, steps)

    return loop


def _rim_rows(system: ModalSystem, mu: float) -> RimRows:
    from contact.scheme.loop_rim import RimRows, RowEntries, Terms

    def terms(p: Trig) -> Terms:
        return Terms(p.harmonic, p.cos, p.sin)

    table = system.table
    assert table is not None
    top = int(table.harmonic.max(initial=0))
    full = table.harmonic.size > FULL * (top + 1) * system.omega.size

    def entries(cos: Array, sin: Array) -> RowEntries:
        tables = [table.by_harmonic(values) if full else np.zeros((0, 0)) for values in (cos, sin)]
        return RowEntries(table.start, table.harmonic, cos, sin, *tables)

    degree = max(top, system.clearance.degree, system.S_nn.degree, system.S_nt.degree)
    return RimRows(
        normal=entries(table.q_cos, table.q_sin), tangent=entries(table.t_cos, table.t_sin),
        clearance=terms(system.clearance), S_nn=terms(system.S_nn), S_nt=terms(system.S_nt),
        S_turns=max(system.S_nn.degree, system.S_nt.degree) > 0, angle=system.angle, speed=system.speed,
        surface=system.radius * system.speed, mu=mu, waves=np.zeros((2, degree + 1)),
        waves_next=np.zeros((2, degree + 1)),
    )  # fmt: skip
