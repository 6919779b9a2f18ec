"""The forward and averaged laws on the exact propagation: state, loop and readings; see `exact_modal`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from contact.energy import Stored
from contact.model.arrays import Array, Indices
from contact.model.law import Abradable
from contact.model.modal_system import ModalSystem, RowTable
from contact.model.trig import Trig
from contact.record import Samples, Tally, tally
from contact.scheme.leap import rim_leap
from contact.scheme.modal_run import ModalRun, RimRun
from contact.scheme.propagator import Propagator
from contact.scheme.wear_track import Track, bare

if TYPE_CHECKING:
    from contact.scheme.loop.modal import ModalState
    from contact.scheme.loop.rim import RimRows

Loop = Callable[["ModalState", Tally, Samples, int, int], int]


def modal_stepper(
    system: ModalSystem, parts: Propagator, *, averaged: bool, mu: float, label: str, law: Abradable | None = None,
    skip: bool = False,
) -> ModalRun:  # fmt: skip
    """Stepper at t = 0, with the compiled loop that this scene needs and no other; `law` a rim's coating."""
    q = np.zeros(system.omega.size)
    d = parts.backward(q, system.velocity)
    state = _state(system, parts, q, d)
    damped = bool(system.zeta.any())
    track = None if law is None else Track.of(system, law)
    rim = None
    if system.table is None:
        loop = _point_loop(system, parts, averaged, damped)
    else:
        rows, leap = rim_rows(system, mu), rim_leap(system, parts, skip=skip)
        rim = RimRun(state=state, rows=rows, leap=leap, averaged=averaged, damped=damped)
        loop = _rim_loop(rim, parts.h, track)

    def advance(sums: Tally, out: Samples, first: int, steps: int) -> int:
        return loop(state, sums, out, first, steps)

    return ModalRun(
        system=system, dt=parts.h, sums=tally(1), label=label, loop=advance, steps=[0],
        energy=lambda steps: _stored(system, parts, state, steps, track), velocity=lambda: state.d / parts.h,
        failure=lambda: _failure(state), rim=rim, track=track,
    )  # fmt: skip


def _stored(system: ModalSystem, parts: Propagator, state: ModalState, steps: int, track: Track | None) -> Stored:
    """Energy at t_n; lam^2 S/2 and what bends the coating count as residual."""
    phi = system.angle - system.speed * steps * parts.h
    force, pull = float(state.memory[2]), float(state.memory[3])
    Q, T = system.table.rows(phi) if system.table is not None else (system.Q, system.Q * 0.0)
    residual = 0.5 * force**2 * (system.S_nn(phi) - pull * system.S_nt(phi))
    residual += 0.0 if track is None else track.elastic
    return parts.stored(state.q, state.d, (Q - pull * T) * force, residual, system.potential)


def _failure(state: ModalState) -> str:
    if np.isnan(state.q).any() or np.isnan(state.d).any():
        return "the motion is not a number"
    H, scale = state.memory[2:4]
    return (
        f"the contact jams: Delassus number {scale:.4g} m/N (modes {H:.4g}), expected > 0; friction "
        "exceeds what the lean of the blade allows: reduce mu or the lean"
    )


def _state(system: ModalSystem, parts: Propagator, q: Array, d: Array) -> ModalState:
    from contact.scheme.loop.modal import ModalState

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
    from contact.scheme.loop.modal import advance_modal

    clearance, S, h, Q = system.clearance(0.0), system.S_nn(0.0), parts.h, system.Q

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_modal(state, Q, clearance, S, averaged, damped, sums, out, h, first, steps)

    return loop


def _rim_loop(rim: RimRun, h: float, track: Track | None) -> Loop:
    from contact.scheme.loop.rim import advance_rim

    Q, Q_next, T = np.zeros((3, rim.state.q.size))
    coating = bare() if track is None else track.coating

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_rim(
            state, rim.rows, rim.leap, coating, Q, Q_next, T, rim.averaged, rim.damped, sums, out, h, first, steps
        )

    def watched(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        assert track is not None
        return track.watch(h, first, steps, lambda start, some: loop(state, sums, out, start, some))

    return loop if track is None else watched


def rim_rows(system: ModalSystem, mu: float) -> RimRows:
    """What the compiled loops need of a rim: rows, polynomials of the angle, work space."""
    from contact.scheme.loop.rim import RimRows
    from contact.scheme.loop.rows import RowBlocks, Series

    table = system.table
    assert table is not None
    top = max(int(table.harmonic.max(initial=0)), system.clearance.degree, system.S_nn.degree, system.S_nt.degree)
    count = -(-(top + 1) // 8) * 8

    def terms(p: Trig) -> Series:
        cos, sin = np.zeros(count), np.zeros(count)
        cos[p.harmonic], sin[p.harmonic] = p.cos, p.sin
        return Series(cos, sin)

    return RimRows(
        normal=RowBlocks(*row_blocks(table, table.q_cos, table.q_sin)),
        tangent=RowBlocks(*row_blocks(table, table.t_cos, table.t_sin)),
        clearance=terms(system.clearance), S_nn=terms(system.S_nn), S_nt=terms(system.S_nt),
        S_turns=max(system.S_nn.degree, system.S_nt.degree) > 0, angle=system.angle, speed=system.speed,
        surface=system.radius * system.speed, mu=mu, waves=np.zeros((2, count)), waves_next=np.zeros((2, count)),
        found=np.zeros(6),
    )  # fmt: skip


def row_blocks(table: RowTable, cos: Array, sin: Array) -> tuple[Indices, Indices, Array, Array]:
    """Rows by blocks of eight modes: starts, harmonics, coefficients (entries, 8), as the compiled loops take them.

    >>> table = RowTable(start=np.array([0, 1, 3]), harmonic=np.array([4, 0, 4]), q_cos=np.ones(3), q_sin=np.zeros(3),
    ...                  t_cos=np.zeros(3), t_sin=np.zeros(3))
    >>> start, harmonic, c, _ = row_blocks(table, table.q_cos, table.q_sin)
    >>> start.tolist(), harmonic.tolist(), c[:, :2].tolist()
    ([0, 2], [0, 4], [[0.0, 1.0], [1.0, 1.0]])
    """
    full = table.by_harmonic(cos), table.by_harmonic(sin)
    m, start, harmonic = full[0].shape[1], [0], []
    blocks: tuple[list[Array], list[Array]] = ([], [])
    for first in range(0, m, 8):
        present = np.unique(table.harmonic[table.start[first] : table.start[min(first + 8, m)]])
        for part, values in zip(blocks, full, strict=True):
            padded = np.zeros((present.size, 8))
            padded[:, : min(8, m - first)] = values[present, first : first + 8]
            part.append(padded)
        harmonic.append(present)
        start.append(start[-1] + present.size)
    return (
        np.array(start, dtype=np.int64), np.concatenate([*harmonic, np.zeros(0)]).astype(np.int64),
        np.concatenate([*blocks[0], np.zeros((0, 8))]), np.concatenate([*blocks[1], np.zeros((0, 8))]),
    )  # fmt: skip
