"""State of a rub in its compiled loop, and its work arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices, aligned
from contact.jit.compiled import jit_inside
from contact.jit.vector import WIDTH
from contact.loop.modal.rows import RowBlocks
from contact.loop.rub.rows import RubRows
from contact.solver.friction.all_sliding import AllSliding
from contact.solver.friction.coulomb import solver_room
from contact.solver.friction.room import Room, staggered
from contact.solver.yielding.several import YieldingForces

NODES = 8  # angles in a cell between which W is interpolated
TERMS = 12  # of the power series of a row, an even number
NOWHERE = -(1 << 62)  # number of no cell
TOGETHER = 8  # rows that `solve.casing` takes at a time
JAMMED, ROUGH, UNSETTLED = 1.0, 2.0, 3.0  # `fault`: no motion opens all gaps; friction, springs not solved


class ModalBlocks(NamedTuple):
    """Coupling of modes, as rows by blocks of eight, over w entries of all modes or `width` of the casing's.

    For coupled modes, `al`, `be`, `c` and `weight` of the state are zero. Without any the blocks have no entries.
    """

    free: RowBlocks  # (w, 2 w): D and q to the increment without forces
    yields: RowBlocks  # (w, w): c
    casing: RowBlocks  # (width, width): c of the casing's modes alone
    others: RowBlocks  # (w, w): c without these
    turned: RowBlocks  # transpose of `casing`
    lost: RowBlocks  # (w, w): P, for the work of damping
    false: RowBlocks  # (w, w): P of what does no work, for what the discrete energy errs by
    odd: RowBlocks  # (w, w): skew part of the stiffness


class RubState(NamedTuple):
    """Modes (m,), the casing's first; tips (K,); and their d directions each (K d,), normal first.

    In loops the arrays over modes are padded with zeros to whole blocks of eight, except `push` and `body`.
    """

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    kick: Array
    weight: Array
    stiff: Array  # (b, b) of all blades' modes, empty without stiffening
    stiff_at: Array  # the same times Omega^2 of each basis
    push: Array  # (m,) force of the stiffening
    contact: Array  # (m,) force of the tips
    body: Array  # (m,) gravity and whirl, empty without any
    mu: Array
    lam: Array
    strain: Array  # S lam of the last step
    motion: Array  # gaps and slips that obey the law
    scale: Array  # (K,) Delassus number of each normal with itself
    now: Array  # gap of q at t_n, valid where `known`
    last: Array  # at t_{n-1}
    known: Indices
    inside: Indices  # 2 in the solve, 1 near, 0 far
    free: Array
    test: Array
    skin: Array  # (K,) depth of the surface that a coating has left [m]
    force: Array
    gap: Array
    seen: Array  # (m + K d,) what a record stores, `Result.state` and `tip_force`: q and lam of one instant
    heat: Array  # dissipated by slip
    drive: Array  # work of the drive against friction
    peaks: Array  # (1,) largest tangential motion of a tip
    limits: Array  # of `motion_limits`
    counts: Array  # most iterations of one step, their sum, steps with contact, fault


class Work(NamedTuple):
    """Work arrays for K tips at P positions: rows at t_{n+1} and t_n, the problem of one step, modal forces.

    `chosen` are the tips to solve for, with their directions in rows `row` of `lam`. Each of their positions has a
    slot, row `column` of `rows`.
    """

    side: Indices  # (1,) which half of the next four is that of t_n, the other that of t_{n+1}
    normal: Array  # (2, P, width) normal rows, where `filled`
    waves: Array  # (2, P, 2, harmonics) and the waves at the places
    fresh: Indices  # (2, P) whether the waves are there
    filled: Indices  # (2, P) and the row
    bound: Array  # (lines,) of |u_r| at t_{n+1}, negative if not computed
    disk: Array  # (2,) position of the disk of a rotor at t_{n+1}, along x and y
    rigid: Array  # (P,) gap of the rigid casing at t_{n+1}
    moved: Array  # (P,) motion of the casing there
    series: Array  # (d terms, width) power series of the rows of a single tip, by direction
    series_at: Indices  # (d,) number of the cell of each
    spare: Array  # (width,) any other row
    turn: Array  # (2, harmonics) and its waves
    angles: Array  # (4, 3) what is turned at t_{n-1}, t_n and t_{n+1}, and the middle of a cell; cosine and sine
    slot: Indices  # (P,) -1 for a place without a chosen tip
    slots: Indices  # (1,) how many
    rows: Array  # (P d, width) all rows at t_n, by slot
    tests: Array  # (P d and more, width) rows of the law, times c
    soft: Array  # (P d and more, waves) static deflection of the casing by a unit force, by waves, d lines of them
    row_columns: Array  # (d width, P and more) `rows` once more, by direction and mode
    wave_columns: Array  # (lines 2 harmonics, P and more) waves at the slots, zeros for other lines
    along: Array  # (P d,) motion of the casing along them
    pull: Array  # (P d,) sum of the forces of one place
    chosen: Indices  # (K,)
    row: Indices  # (K d,)
    column: Indices  # (K d,)
    across: Indices  # (K d,) and its column of `casing`
    casing: Array  # (P d and more, d P and more) response of the casing between slots, columns by direction
    W: Array  # (K d, K d) Delassus matrix of the chosen
    nodes: Array  # (K d, nodes, K d and more), flat: that of all tips at the nodes of a cell, rows of one tip together
    cell: Indices  # (1,) number of the cell
    weights: Array  # (nodes,) of the nodes' values at t_n
    node_angles: Array  # as `angles`
    line: Array  # (K d and more,) a row of W of all tips
    b: Array  # (K d,) free gaps and slips of the chosen
    lam: Array
    motion: Array
    mu: Array  # (K,)
    depth: Array  # (K,) of the tips in a coating
    pushed: Array  # (width,)
    both: Array  # (2 w,) D and q of coupled modes, or forces on them
    moved_by: Array  # (w,) response of a coupled body
    normal_moves: Array  # (width,) response of the casing's coupled modes to a unit force along the normal
    tangent_moves: Array  # (width,) and along the tangent
    response: Array  # (width,) and to the forces of this step
    strained: Array  # (waves,) static deflection of the casing by the forces
    spread: Array  # (waves,)
    pressed: Array  # (lines d, 2, harmonics) forces by waves
    motion_waves: Array  # (lines d, 2, harmonics) some motion of the casing by waves
    S: Array  # (2, K, d K d and zeros) compliance of few tips at phi_n, at phi_{n-1}; stale where not solved for
    S_at: Indices  # (K,) the step in which a row of S was filled
    turning: Array  # (K d,) part of S lam that turns
    before: Array  # (K d,) with S at phi_{n-1}
    strain: Array  # (K d,) S lam


class Solver(NamedTuple):
    """Solver for the forces of several tips. A loop without it has a single tip, whose force has a closed formula."""

    all_sliding: AllSliding
    yielding: YieldingForces
    room: Room  # of the friction solver


@jit_inside
def couples(blocks: ModalBlocks) -> bool:
    """Whether modes are coupled."""
    return bool(blocks.casing.start.size > 0)


@jit_inside
def tips(s: RubState, solver: Solver | None) -> int:
    """Number of tips; a compile-time constant if it is one."""
    if solver is None:
        return 1
    return s.mu.size


def solver_of(s: RubState, *, newton: bool = True, yields: bool) -> Solver:
    """Work arrays of the solver; `newton`: Newton's method on the forces; `yields`: on a coating or with a law."""
    K, R = s.mu.size, s.lam.size
    return Solver(
        all_sliding=AllSliding(used=R > K > 1), yielding=YieldingForces(used=yields),
        room=solver_room(K if newton else 0, R // K),
    )  # fmt: skip


def work_space(s: RubState, rows: RubRows, *, newton: bool) -> Work:
    """Work arrays of a run; `newton`: Newton's method on the forces solves for the tips."""
    K, R, width, n = s.mu.size, s.lam.size, rows.width, rows.harmonics
    P, d = int(rows.place.max()) + 1, R // K
    D, slots, lines = -(-P * d // TOGETHER) * TOGETHER, staggered(-(-P // WIDTH) * WIDTH), len(rows.reach)
    made = (
        (0, 0, 0) if rows.steady or rows.W.size else (D, d * width, slots)
    )  # where the loop fills the matrix of the contacts
    solved = R if newton else 0
    wide = -(-R // WIDTH) * WIDTH if rows.cell > 0.0 else 0
    few, spread = (K if rows.turns and rows.few else 0), (d * lines if rows.many else 0)
    waves, of_tip = 2 * n * spread, -(-d * R // WIDTH) * WIDTH

    def whole(*shape: int) -> Indices:
        return np.zeros(shape, dtype=np.int64)

    return Work(
        side=whole(1), normal=aligned(2, P, width), waves=aligned(2, P, 2, n), fresh=whole(2, P),
        filled=whole(2, P), motion_waves=aligned(d * lines if rows.many else 0, 2, n),
        bound=aligned(lines), disk=aligned(2), rigid=aligned(P), moved=aligned(P), spare=aligned(width),
        series=aligned(d * TERMS if rows.cells > 0.0 else 0, width), series_at=whole(d) + NOWHERE, turn=aligned(2, n),
        angles=aligned(4, 3), slot=whole(P), slots=whole(1), rows=aligned(D, width), tests=aligned(made[0], width),
        soft=aligned(D, waves), row_columns=aligned(made[1], made[2]), wave_columns=aligned(2 * n * lines, slots),
        along=aligned(D), pull=aligned(D), chosen=whole(K), row=whole(R), column=whole(R), across=whole(R),
        casing=aligned(made[0], d * made[2]), W=aligned(solved, solved),
        nodes=aligned(R * NODES * wide), cell=whole(1) + NOWHERE, weights=aligned(NODES), node_angles=aligned(3, 3),
        line=aligned(wide), b=aligned(R), lam=aligned(R),
        motion=aligned(R), mu=aligned(K),
        depth=aligned(K), pushed=aligned(width), both=aligned(2 * s.q.size), moved_by=aligned(s.q.size),
        normal_moves=aligned(width), tangent_moves=aligned(width), response=aligned(width),
        strained=aligned(waves), spread=aligned(waves),
        pressed=aligned(spread, 2, n), S=aligned(2, few, of_tip), S_at=whole(few) - 2,
        turning=aligned(R), before=aligned(R), strain=aligned(R),
    )  # fmt: skip
