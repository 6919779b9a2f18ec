"""The forward, averaged and energy laws on the exact propagation: state, loop and readings; see `exact_modal`."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, aligned, readonly
from contact.base.errors import InputError
from contact.base.remembered import remembered
from contact.io.trust import Flag
from contact.model.gaps.limits import motion_limits
from contact.model.gaps.modal_system import ModalSystem, RowTable
from contact.model.law import Law
from contact.model.trig import Terms, Trig
from contact.record.energy import Stored
from contact.record.record import Samples, Tally, tally
from contact.scheme.modal.blocks import narrowed, row_blocks, whole, widened
from contact.scheme.modal.gives_way import memory_of, stored_by, too_long, yielding_of
from contact.scheme.modal.modal_run import ModalRun, RimRun
from contact.scheme.modal.propagator import Propagator
from contact.scheme.modal.wear_track import Tracks, bare

if TYPE_CHECKING:
    from contact.loop.modal.free_flight import FreeFlight
    from contact.loop.modal.modal import EnergyState, ModalState
    from contact.loop.modal.rows import RimRows
    from contact.solver.yielding.yields import Yielding

Loop = Callable[["ModalState", Tally, Samples, int, int], int]
BITS = 24  # a skip is shorter than 2^BITS steps
CELLS = 720  # of the contact angle
POINTS = 8  # where the clearance is looked at in each cell


def modal_stepper(
    system: ModalSystem, parts: Propagator, *, averaged: bool, law: Law, label: str, skip: bool = False
) -> ModalRun:
    """Stepper at t = 0, with the compiled loop that this scene needs and no other."""
    q = np.zeros(system.omega.size) if system.displacement is None else system.displacement.copy()
    d = parts.backward(q, system.velocity)
    state = _state(system, parts, q, d)
    damped = bool(system.zeta.any())
    mu, tracks = law.mu, None if law.coating is None else Tracks.of(system, law.coating)
    rim, y = None, yielding_of(law, state.memory[:1], state.memory[1:2])
    if system.table is None:
        loop = _point_loop(system, parts, averaged, damped, y)
    else:
        normal, tangent = system.sums()
        flight, limits = (
            rim_free_flight(system, parts, normal, skip=skip), motion_limits(system.radius, system.thickness)
        )  # fmt: skip
        wide = widened(state, padded(q.size))
        state = narrowed(wide, q.size)
        rim = RimRun(
            state=state, wide=wide, mu=mu, reach=rim_reach(system.table, int(system.first[1])), limits=limits,
            normal=normal, tangent=tangent, flight=flight, averaged=averaged, damped=damped,
        )  # fmt: skip
        loop = _rim_loop(rim, system, parts.h, tracks)

    def advance(sums: Tally, out: Samples, first: int, steps: int) -> int:
        return loop(state, sums, out, first, steps)

    return ModalRun(
        system=system, dt=parts.h, sums=tally(1), label=label, loop=advance, steps=np.zeros(1, dtype=np.int64),
        state=state,
        energy=lambda steps: _stored(system, parts, state, steps, tracks, stored_by(law, y)),
        velocity=lambda: state.d / parts.h,
        failure=lambda: _failure(state), rim=rim, tracks=tracks,
        gives_way=memory_of(y), slow=lambda: too_long(y, float(parts.c @ system.Q**2), parts.h),
    )  # fmt: skip


def _stored(
    system: ModalSystem, parts: Propagator, state: ModalState, steps: int, tracks: Tracks | None, in_contact: float
) -> Stored:  # fmt: skip
    """Energy at t_n; lam^2 S/2, what bends the coating and what is `in_contact` count as residual."""
    phi = system.angle - system.speed * steps * parts.h
    force, pull = float(state.memory[2]), float(state.memory[3])
    at_rest = in_contact + (0.0 if tracks is None else tracks.elastic)
    if force == 0.0 and not (state.q.any() or state.d.any() or parts.load.any()):  # as most runs start
        return Stored(kinetic=0.0, strain=0.0, potential=system.potential, residual=at_rest, discrete=system.potential)
    if force == 0.0:
        return parts.stored(state.q, state.d, np.zeros(state.q.size), at_rest, system.potential)
    Q, T = system.table.rows(phi) if system.table is not None else (system.Q, system.Q * 0.0)
    residual = 0.5 * force**2 * (system.S_nn(phi) - 2.0 * pull * system.S_nt(phi) + pull**2 * system.S_tt(phi))
    return parts.stored(state.q, state.d, (Q - pull * T) * force, residual + at_rest, system.potential)


def _failure(state: ModalState) -> Flag:
    if np.isnan(state.q).any() or np.isnan(state.d).any():
        return Flag("the motion is not a number", "motion-overflow", failed=True)
    H, scale = state.memory[2:4]
    words = (
        f"the contact jams: Delassus number {scale:.4g} m/N (modes {H:.4g}), expected > 0; friction "
        "exceeds what the lean of the blade allows: reduce mu or the lean"
    )
    return Flag(words, "unconverged", failed=True)


def _state(system: ModalSystem, parts: Propagator, q: Array, d: Array) -> ModalState:
    from contact.loop.modal.modal import ModalState

    def gap(steps: int, q: Array) -> float:
        phi = system.angle - system.speed * parts.h * steps
        if not q.any():
            return system.clearance(phi)
        rows = system.table.rows(phi)[0] if system.table is not None else system.Q
        return system.clearance(phi) + float(rows @ q)

    before = system.angle + system.speed * parts.h
    return ModalState(
        q=q, d=d, old=np.zeros(q.size), al=parts.al, be=parts.be, c=parts.c, kick=parts.c * system.load,
        weight=(1.0 - parts.al) / (2.0 * parts.c),
        memory=np.array([
            gap(0, q), gap(-1, q - d), 0.0, 0.0, *(S(before) for S in (system.S_nn, system.S_nt, system.S_tt)), 0.0,
            0.0, 0.0,
        ]),
        force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip


def _point_loop(system: ModalSystem, parts: Propagator, averaged: bool, damped: bool, y: Yielding | None) -> Loop:
    from contact.loop.modal.modal import advance_modal

    clearance, S, h, Q = system.clearance(0.0), system.S_nn(0.0), parts.h, system.Q

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_modal(state, Q, clearance, S, averaged, damped, y, sums, out, h, first, steps)

    return loop


def _rim_loop(rim: RimRun, system: ModalSystem, h: float, tracks: Tracks | None) -> Loop:
    from contact.jit.bundle import bundled
    from contact.loop.modal.rim import advance_rim

    @cache
    def given() -> tuple[Any, ...]:
        """What the loop takes, made when it first runs: in lanes it never does."""
        rows = rim_rows(system, rim.mu, rim.normal, rim.tangent, rim.limits)
        coating = bare() if tracks is None else tracks.tracks[0].coating
        return (*map(bundled, (rim.wide, rows, rim.flight, coating)), *aligned(3, rim.wide.q.size))

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        wide, rows, flight, coating, Q, Q_next, T = given()
        return advance_rim(
            wide, rows, flight, coating, Q, Q_next, T, rim.averaged, rim.damped, sums, out, h, first, steps
        )  # fmt: skip

    def watched(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        assert tracks is not None
        return tracks.watch(h, first, steps, lambda start, some: loop(state, sums, out, start, some))

    return loop if tracks is None else watched


@remembered
def rim_reach(table: RowTable, modes: int) -> Array:
    """How far unit motion of each of the first `modes` moves the rim at most, (whole blocks,); zero for others."""
    size = table.start.size - 1
    owner = np.repeat(np.arange(size), np.diff(table.start))
    reach = np.bincount(owner, np.hypot(table.q_cos, table.q_sin), minlength=padded(size))
    reach[modes:] = 0.0
    return readonly(reach)


def padded(modes: int) -> int:
    """Modes, clearance, S_nn, S_nt and S_tt in whole blocks of eight."""
    return whole(modes + 4)


def rim_rows(system: ModalSystem, mu: float, normal: Terms, tangent: Terms, limits: Array) -> RimRows:
    """What the compiled loops need of a rim: its `sums()` in blocks, its speeds, limits, work space."""
    from contact.loop.modal.rows import RimRows, RowBlocks

    assert system.table is not None
    m = system.omega.size
    count = whole(max(int(part.wave.max(initial=0)) for part in (normal, tangent)) // 2 + 1)
    blocks = np.zeros((2, padded(m), 2 * count))
    for block, part in zip(blocks, (normal, tangent), strict=True):
        block[: part.sums] = part.full(2 * count)
    return RimRows(
        normal=RowBlocks(*row_blocks(blocks[:1])), tangent=RowBlocks(*row_blocks(blocks[1:])), modes=m,
        reach=rim_reach(system.table, int(system.first[1])), limits=limits, S_turns=system.compliance_turns,
        angle=system.angle, speed=system.speed, surface=system.radius * system.speed, mu=mu,
        seen=np.zeros(m + (2 if mu > 0.0 else 1)), waves=aligned(2, count), waves_next=aligned(2, count),
    )  # fmt: skip


def energy_stepper(system: ModalSystem, parts: Propagator) -> ModalRun:
    """Stepper of the discrete gradient law: energy kept to round-off at any step, at a fixed undamped contact point.

    Over one step the force is constant and the modes move exactly under it; lam = -(phi(g_1) - phi(g_0))/(g_1 - g_0),
    phi = <-g>^2/(2 S) the energy in the residual compliance (Gonzalez, J. Nonlinear Sci. 6, 1996, 449): a scalar
    quadratic. Exact energy is not exact phase: some (modes, dt) drift in phase after several impacts. In the step of
    closing or opening complementarity holds on average only, which `Result.residual` shows.
    Raises InputError for a rim, damping, or S = 0.
    """
    from contact.loop.modal.modal import EnergyState, advance_energy

    S, h, Q = system.S_nn(0.0), parts.h, system.Q
    if system.table is not None:
        raise InputError("law: found 'energy' on a rotating rim, expected 'averaged' or 'forward'")
    if system.zeta.any():
        raise InputError("law: found 'energy' with damped modes, expected zeta = 0 or another law")
    if S <= 0.0:
        raise InputError(f"law: found 'energy' with S = {S:g} m/N, expected residual compliance > 0")
    turn = parts.turn
    clearance, b = system.clearance(0.0), float(np.sum(0.5 * parts.c * Q * Q))
    state = EnergyState(
        q=np.zeros(Q.size), v=system.velocity.copy(), cos=np.cos(turn), drift=h * np.sinc(turn / np.pi),
        pull=-system.omega * np.sin(turn), lift=0.5 * parts.c, load=system.load, memory=np.array([clearance]),
        force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip

    def loop(sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_energy(state, Q, clearance, S, b, sums, out, h, first, steps)

    top = float(system.omega.max(initial=0.0))
    label = f"exact modal, energy law, dt omega_max = {h * top:.3g} (no limit)"
    return ModalRun(
        system=system, dt=h, sums=tally(1), label=label, loop=loop, steps=np.zeros(1, dtype=np.int64), state=state,
        energy=lambda _: _energy_stored(system, state), velocity=lambda: state.v,
        failure=lambda: Flag("the gap is not a number", "motion-overflow", failed=True),
    )  # fmt: skip


def _energy_stored(system: ModalSystem, state: EnergyState) -> Stored:
    """Energy at t_n; phi(g) counts as residual."""
    q, v = state.q, state.v
    kinetic, strain = 0.5 * float(v @ v), 0.5 * float(np.sum((system.omega * q) ** 2))
    potential = system.potential - float(system.load @ q)
    residual = 0.5 * min(float(state.memory[0]), 0.0) ** 2 / system.S_nn(0.0)
    total = kinetic + strain + potential
    return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=residual, discrete=total)


def rim_free_flight(system: ModalSystem, parts: Propagator, normal: Terms, *, skip: bool) -> FreeFlight:
    """What skipping needs: powers (none unless `skip`), amplitudes (those of `normal`) and clearances of a rim.

    A skip over k steps is the k-th power of the modal map (q, D) -> (q + al D - be q, al D - be q). The powers are
    formed in extended precision from the very coefficients that the steps use, so that a run with skips and a run
    without differ by the round-off of the steps alone.
    """
    from contact.loop.modal.free_flight import FreeFlight

    m = system.omega.size
    rows = normal.first(m)
    return FreeFlight(
        powers=powers(parts.al, parts.be) if skip else readonly(np.zeros((0, 4, m))), fade=parts.fade,
        cos=np.cos(parts.turn), sin=np.sin(parts.turn), start=rows.start, wave=rows.wave,
        row=rows.value, floor=least_clearance(system.clearance),
        reach=np.zeros(2 * (int(rows.wave.max(initial=0)) // 2 + 1)), taken=np.zeros(2, dtype=np.int64),
    )  # fmt: skip


@remembered
def powers(al: Array, be: Array) -> Array:
    """Maps over 1, 2, 4, ... 2^(BITS-1) steps, (BITS, 4, m): entries 11, 12, 21, 22.

    >>> powers(np.array([1.0]), np.array([0.0]))[3, :2].ravel().tolist()
    [1.0, 8.0]
    """
    fade, stiff = al.astype(np.longdouble), be.astype(np.longdouble)
    a, b, c, d = 1 - stiff, fade, -stiff, fade
    found = np.empty((BITS, 4, al.size))
    for j in range(BITS):
        found[j] = np.array([a, b, c, d], dtype=np.float64)
        a, b, c, d = a * a + b * c, a * b + b * d, c * a + d * c, c * b + d * d
    return readonly(found)


@remembered
def least_clearance(clearance: Trig) -> Array:
    """A lower bound of the clearance in each cell of the contact angle, (CELLS,).

    Between two points h apart a function lies above the lower one by no less than -h^2 max|f''|/8.

    >>> from contact.model.trig import fourier
    >>> floor = least_clearance(fourier([(0, 1.0, 0.0), (2, 0.25, 0.0)]))
    >>> round(float(floor.min()), 6), round(float(floor.max()), 6)
    (0.75, 1.249962)
    """
    cos, sin = _waves(tuple(clearance.harmonic.tolist()))
    values = clearance.cos @ cos + clearance.sin @ sin
    bend = float(np.sum(clearance.harmonic**2 * np.hypot(clearance.cos, clearance.sin)))
    low = np.minimum(values[:-1], values[1:]).reshape(CELLS, POINTS).min(axis=1)
    return readonly(low - bend * (2.0 * np.pi / (CELLS * POINTS)) ** 2 / 8.0)


@remembered
def _waves(harmonics: tuple[int, ...]) -> tuple[Array, Array]:
    """Cosines and sines at all points of all cells, (harmonics, points) each."""
    points = CELLS * POINTS
    phases = np.multiply.outer(harmonics, 2.0 * np.pi * np.arange(points + 1) / points)
    return np.cos(phases), np.sin(phases)
