"""Compiled step loop of a rub: exact-modal coefficients, K rotating tips, stick and slip by semi-smooth Newton.

Tips meet a rigid surface, the plastic bars of a coating (`coats`), or a surface with a force-depth law (`y`). `blocks`
couple the modes. The rows of `steady` contacts are constant. What a run lacks has no entries, so that one loop is
compiled for all runs. A single tip on a rigid surface whose modes are uncoupled needs no `solver`: the loop without it
is compiled by itself, and is much smaller.
"""

from __future__ import annotations

from contact.jit.compiled import jit, jit_apart, jit_vectors
from contact.loop.formulas import works
from contact.loop.limits import outgrown, tip_motion
from contact.loop.modal.rows import fill_some, move, product, product_of_sum
from contact.loop.rub.alone import DONE, SOLVED, UNSOLVED, alone
from contact.loop.rub.answer import fly_coupled, respond, works_of_coupling
from contact.loop.rub.compliance import fill_few, strains, strains_before
from contact.loop.rub.deflection import (
    add_waves,
    largest_around,
    largest_of_waves,
    matters,
    most_of,
    note_deflection,
    strained,
)
from contact.loop.rub.free_flight import PAUSE, FreeFlight, may_skip, skip_ahead, skip_coupled, untouched
from contact.loop.rub.matrix import enter_cell
from contact.loop.rub.motion import felt, see
from contact.loop.rub.predict import find_near, flow, propagate, stand
from contact.loop.rub.rows import (
    AHEAD,
    BEFORE,
    MIDDLE,
    NOW,
    RubLaws,
    RubRows,
    blade_dot,
    blade_dot_of_sum,
    look_ahead,
    look_at,
    spun,
    turned,
)
from contact.loop.rub.solve import clear, find_gaps, gather, hand_over, others_close, push, solve, update_gaps
from contact.loop.rub.spin import spin_on
from contact.loop.rub.state import ModalBlocks, RubState, Solver, Work, couples, tips
from contact.loop.rub.steady import Steady, frictionless, note_slips
from contact.loop.tally import INSIDE, due, note_contact, note_stick, note_yielding, state_due, store, store_state
from contact.model.gaps.limits import LOOK
from contact.record.record import Samples, Tally
from contact.solver.abradable.tips import Coats, coated
from contact.solver.dense import assign
from contact.solver.yielding.yields import Yielding, gives_way, note_slope, paced

AGAIN = 8  # steps between two checks whether the only tip is near


@jit
def add_works(s: RubState, rows: RubRows, w: Work, count: int, dim: int, slid: float, sums: Tally) -> None:  # fmt: skip
    """Work of the forces along (D_n + D_{n+1})/2: by the gap, by the moving point, by friction; heat and drive.

    Energy stored in the tangential compliance counts as friction's work on the bodies, and as a loss of the contact
    until S returns it. Energy that S stores because the point moves counts for the moving point.
    """
    if rows.turns:
        strains_before(s, rows, w, count, dim)
    if rows.many:
        see(rows, w, s.old, s.d, dim, 0, dim)
        for n in range(count):
            j = w.chosen[n]
            for i in range(dim):
                first, waves = (rows.line[j] * dim + i) * w.turn.size, w.waves[w.side[0], rows.place[j]]
                w.along[w.column[n * dim + i]] = felt(w.motion_waves, first, waves)
    else:
        for a in range(w.slots[0] * dim):
            w.along[a] = product_of_sum(w.rows[a], s.old, s.d)
    for n in range(count):
        j = w.chosen[n]
        R = j * dim
        across, dragged, turned, softened = 0.0, 0.0, 0.0, 0.0
        for i in range(dim):
            row = R + i
            force = s.lam[row]
            along = w.along[w.column[n * dim + i]] + blade_dot_of_sum(rows, rows.apart, row, j, s.old, s.d)
            if rows.turns:
                turned += force * (w.turning[row] - w.before[row])
            if i == 0:
                across = force * along
                continue
            dragged += force * along
            softened += force * (w.strain[row] - s.strain[row])
            s.heat[j] -= force * s.motion[row]
            s.drive[j] -= force * rows.glide[row] * slid
        opened = s.lam[R] * (s.free[j] - s.last[j])
        work, rotation, friction = works(0.5, opened, turned, across, dragged, softened)
        sums.work[j] += work
        sums.rotation[j] += rotation
        sums.friction[j] += friction


@jit
def advance_modes(s: RubState, sums: Tally) -> None:
    """Add the increments, and the work of damping, stiffening, gravity and whirl."""
    for i in range(s.body.size):
        sums.body_force[0] += 0.5 * s.body[i] * (s.old[i] + s.d[i])
    given = 0.0
    for i in range(s.push.size - s.stiff.shape[0], s.push.size):
        given += 0.5 * s.push[i] * (s.old[i] + s.d[i])
    sums.external[0] += given
    sums.damping[0] += move(s, s.old, s.d)


@jit
def pace(s: RubState, y: Yielding, h: float) -> None:
    """Rate of depth of the near tips in this step; of tips that were far, from their gaps of the last two steps."""
    for j in range(s.mu.size):
        if s.inside[j] > 0:
            if s.known[j] == 0:
                y.past[j, 0], y.past[j, 1] = -s.last[j], s.now[j] - 2.0 * s.last[j]
            paced(y, j, h)


@jit
def note(s: RubState, rows: RubRows, w: Work, solver: Solver | None, y: Yielding, steady: Steady,
         dim: int, slid: float, sums: Tally, out: Samples, h: float, time: float) -> None:  # fmt: skip
    """Record forces, gaps and events of this step; advance the gaps of q."""
    law = False
    if solver is not None:
        law = gives_way(y)
    for j in range(tips(s, solver)):
        if not law and s.inside[j] == 0 and sums.closed[j] == 0 and sums.stuck[j] == 0:
            continue  # far without force in the last step, too
        R = j * dim
        s.force[j] = s.lam[R]
        before, predicted = 0.0, 0.0
        if s.inside[j] > 0:
            s.gap[j] = s.motion[R]
            before, predicted = s.now[j] + s.skin[j], s.test[j]
            s.last[j], s.now[j], s.known[j] = s.now[j], s.free[j], 1
        if s.inside[j] == 2 or rows.steady:
            if dim > 1:
                s.peaks[0] = max(s.peaks[0], abs(blade_dot(rows, rows.own, R + 1, j, s.q)))
            tip_motion(s.limits, s.free[j] - rows.clearance[j] - w.rigid[rows.place[j]])
        if not law:
            if rows.steady and s.force[j] > 0.0:
                s.gap[j] = 0.0  # what is left of it is round-off
            note_contact(sums, out, j, h, time, s.force[j], s.gap[j], s.scale[j], before, predicted)
        else:
            depth = y.depth[j] if s.inside[j] == 2 else 0.0
            s.gap[j] -= depth
            note_yielding(sums, out, y, j, h, time, s.force[j], s.gap[j], depth, before, predicted)
            note_slope(y, j, depth if s.force[j] > 0.0 else 0.0)
        if dim > 1 and not rows.steady:
            stuck = sticks(s, R, dim, j)
            note_stick(sums, out, j, int(stuck), time)
            if tips(s, solver) == 1 and not stuck and s.force[j] > 0.0 and s.lam[R + 1] * slid > 0.0:
                sums.reversals[j] += 1
    if solver is not None:
        if rows.steady and dim > 1:
            note_slips(s, rows, steady, dim, sums, out, time, h)


@jit_apart
def note_rim(s: RubState, rows: RubRows, w: Work, dim: int, ends: bool) -> None:
    """Update the largest deflection of the rim from q and the forces of this step."""
    rim = rows.rim
    for line in range(rim.reach.shape[0]):
        strain = 0.0
        for j in range(s.mu.size):
            for i in range(dim):
                strain += rim.soft[line, rows.line[j] * dim + i] * abs(s.lam[j * dim + i])
        if matters(s.limits, most_of(rim.reach[line], s.q) + strain, ends):
            note_line(s, rows, w, dim, line, strain, ends)


@jit
def note_line(s: RubState, rows: RubRows, w: Work, dim: int, line: int, strain: float, ends: bool) -> None:
    """Update the largest deflection of one line; the forces deflect it by at most `strain`."""
    rim, c, t = rows.rim, w.angles[NOW, 1], w.angles[NOW, 2]
    for a in range(rim.z.size):
        rim.z[a] = product(rim.rows[line, a], s.q)
    if strain > 0.0:  # the modes' deflection bounds the sum, and has few waves
        if not matters(s.limits, largest_of_waves(rim.z) + strain, ends):
            return
        if not matters(s.limits, largest_around(rim.z, rim.places, rim.top) + strain, ends):
            return
        rim.force[:] = 0.0
        for j in range(s.mu.size):
            cos, sin = rows.heading[j, 0], rows.heading[j, 1]
            for i in range(dim):
                force = rim.force[rows.line[j] * dim + i]
                add_waves(force, rim.z.size // 2, s.lam[j * dim + i], cos * c + sin * t, sin * c - cos * t)
        strained(rim, line)
    note_deflection(s.limits, rim, ends)


@jit
def sticks(s: RubState, row: int, dim: int, j: int) -> bool:
    """Whether a contact presses and its tangential force lies inside the friction cone."""
    pull, radius = 0.0, s.mu[j] * s.lam[row] * (1.0 - INSIDE)
    for i in range(row + 1, row + dim):
        pull += s.lam[i] * s.lam[i]
    return bool(s.lam[row] > 0.0 and pull < radius * radius)


@jit
def close(s: RubState, rows: RubRows, coats: Coats, y: Yielding, blocks: ModalBlocks,
          steady: Steady, w: Work, solver: Solver, dim: int, share: float, slid: float, solved: bool,
          step: int) -> int:  # fmt: skip
    """Forces of the marked tips and of the tips that these forces close; returns their number, -1 without solution.

    `solved`: the force of the first one is known already.
    """
    while True:
        count = 1
        if not solved and steady.roots.size > 0:
            return close_all(s, rows, blocks, steady, w, share)
        if not solved:
            interpolated = False
            if not rows.steady:
                interpolated = enter_cell(s, rows, w, dim, share)
            count = gather(s, rows, blocks, w, dim, share, interpolated)
            if rows.turns and rows.few:
                fill_few(rows, w, count, step)
            if not solve(s, rows, w, solver, coats, y, count, dim, share, slid, interpolated):
                return -1
            if couples(blocks):
                fill_some(blocks.casing, w.pushed, 0, w.response)
        if not others_close(s, rows, blocks, w, count, dim, share):
            return count
        solved = False


@jit
def close_all(s: RubState, rows: RubRows, blocks: ModalBlocks, steady: Steady, w: Work,
              share: float) -> int:  # fmt: skip
    """Forces of all frictionless contacts at once; returns the number that press, -1 without solution."""
    if not frictionless(s, steady):
        return -1
    count = gather(s, rows, blocks, w, 1, share, False)
    for a in range(count):
        w.lam[a], w.motion[a] = s.lam[w.row[a]], 0.0
    hand_over(s, rows, w, count, 1)
    if couples(blocks):
        fill_some(blocks.casing, w.pushed, 0, w.response)
    find_gaps(s, rows, blocks, w, count, 1, share)
    return count


@jit_apart
def settle(s: RubState, rows: RubRows, coats: Coats, blocks: ModalBlocks, w: Work, count: int, dim: int,
           share: float, slid: float, sums: Tally) -> None:  # fmt: skip
    """Add the forces to the increments, the gaps and the sums."""
    strains(s, rows, w, count, dim)
    if coated(coats):
        flow(s, w, coats, count, dim)
    push(s, rows, w, count, dim)
    if couples(blocks):
        respond(s, blocks, w)
    update_gaps(s, w, count, dim, share)
    add_works(s, rows, w, count, dim, slid, sums)
    assign(s.strain, w.strain, w.strain.size)


@jit_apart
def skip(s: RubState, rows: RubRows, blocks: ModalBlocks, solver: Solver | None, flight: FreeFlight, w: Work,
         angle: float, turn: float, room: int, sums: Tally) -> int:  # fmt: skip
    """Take steps without contact at once; returns how many, or what `skip_ahead` returns where there are none."""
    if solver is not None:
        if couples(blocks):
            return skip_coupled(s, rows, flight, w, angle, turn, room, sums)
    return skip_ahead(s, rows, flight, w, angle, turn, room, sums)


@jit_vectors
def advance_rub(s: RubState, laws: RubLaws, rows: RubRows, coats: Coats, y: Yielding,
                blocks: ModalBlocks, steady: Steady, solver: Solver | None, flight: FreeFlight, w: Work,
                dim: int, averaged: bool, sums: Tally, out: Samples, h: float, first: int,
                steps: int) -> int:  # fmt: skip
    """Take whole steps: bars and force at phi_n, gap at phi_{n+1}, slip over the step.

    Without `solver` there is a single tip with at most one slip direction, on a rigid surface, of uncoupled modes. Time
    without contact is skipped up to the next stored step; wear of a coating only widens the gap.
    """
    share, pressed = 0.25 if averaged else 1.0, True
    before, _ = turned(laws.speed, (first - 1) * h)
    angle, omega = turned(laws.speed, first * h)
    base = omega
    if laws.spin.mode >= 0:
        q, d = s.q[laws.spin.mode], s.d[laws.spin.mode]
        before, angle = spun(laws.spin, before, q - d), spun(laws.spin, angle, q)
        if w.angles[NOW, 1] != 0.0 or w.angles[NOW, 2] != 0.0:  # the run goes on
            before, angle = w.angles[BEFORE, 0], w.angles[NOW, 0]
        omega = base - laws.spin.scale * s.d[laws.spin.mode] / h
    look_at(w.angles, BEFORE, before)
    look_at(w.angles, NOW, angle)
    look_at(w.angles, MIDDLE, 0.0)
    step, end, retry = first, first + steps, first if flight.powers.shape[0] > 0 else first + steps
    while step < end:
        if step >= retry and may_skip(s, sums):
            room = min(end - step, untouched(out, sums, step))
            skipped = -1
            if room > 0:
                skipped = skip(s, rows, blocks, solver, flight, w, angle, omega * h, room, sums)
            retry = step - skipped
            if skipped > 0:
                step += skipped
                retry = step
                before, _ = turned(laws.speed, (step - 1) * h)
                angle, omega = turned(laws.speed, step * h)
                look_at(w.angles, BEFORE, before)
                look_at(w.angles, NOW, angle)
                continue
        t = step * h
        ahead, omega_ahead = turned(laws.speed, (step + 1) * h)  # not t + h, which is rounded: runs may be split
        base = omega if laws.spin.mode < 0 else base
        if laws.spin.mode >= 0:
            ahead = spun(laws.spin, ahead, s.q[laws.spin.mode] + s.d[laws.spin.mode])
            omega = base - laws.spin.scale * s.d[laws.spin.mode] / h
        look_ahead(w.angles, ahead)
        propagate(s, laws, w.angles, t, omega, h)
        if solver is not None:
            if couples(blocks):
                fly_coupled(s, blocks, w)
        slid = 1.0 if rows.steady else base * h
        every = due(step, out.every, out.at, sums.filled[0])
        closing = find_near(s, laws, rows, w, solver, dim, share, every, step % AGAIN == 0 or tips(s, solver) > 1, t, h)
        rigid = True
        if solver is not None:
            if coated(coats):
                rigid = False
                closing -= stand(s, laws, rows, w, coats, dim, angle)
            if gives_way(y):
                rigid = False
                pace(s, y, h)
        done = UNSOLVED
        if rigid and closing == 1:
            done = alone(s, rows, blocks, w, solver, dim, share, slid, step, sums)
        if solver is None:
            if closing > 0 and done != DONE:
                return step
        elif closing > 0 and done != DONE:
            count = close(s, rows, coats, y, blocks, steady, w, solver, dim, share, slid, done == SOLVED, step)
            if count < 0:
                return step
            settle(s, rows, coats, blocks, w, count, dim, share, slid, sums)
        if pressed and closing == 0:
            clear(s.contact, 0)
            for a in range(s.strain.size):
                s.strain[a] = 0.0
        if closing > 0:
            s.counts[2] += 1.0
            retry = max(retry, step + PAUSE)
        pressed = closing > 0
        stored = every and state_due(sums, out, step)  # states are stored with forces
        if not rows.steady and (stored or step % LOOK == 0):
            note_rim(s, rows, w, dim, step % LOOK == 0)
        if stored:
            modes = s.seen.size - (0 if rows.steady else s.lam.size)
            assign(s.seen, s.q, modes)
            for i in range(s.seen.size - modes):
                s.seen[modes + i] = s.lam[i]
            store_state(sums, out, step, t, s.seen)
        if solver is not None:
            if couples(blocks):
                works_of_coupling(s, blocks, w, sums)
        if laws.spin.mode >= 0:
            spin_on(s, laws, rows, w.angles, dim, base, t, h, sums)
        advance_modes(s, sums)
        note(s, rows, w, solver, y, steady, dim, slid, sums, out, h, t)
        if every:
            store(sums, out, step, t, s.force, s.gap)
        angle, omega = ahead, omega_ahead
        for i in range(3):
            w.angles[BEFORE, i], w.angles[NOW, i] = w.angles[NOW, i], w.angles[AHEAD, i]
        w.side[0] = 1 - w.side[0]
        step += 1
        if outgrown(s.limits):
            return step
    return -1
