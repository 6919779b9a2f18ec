"""Compiled step loop of the exact-modal scheme on a rotating rim: rows turn with the contact point.

Arrays over the modes are padded with zeros to whole blocks of eight; the places m .. m + 3 of a row hold the
clearance, S_nn, S_nt and S_tt at its angle, where the motion is always zero. `memory` = (g_n, g_{n-1} of q, force, its
drag over it, S_nn, S_nt, S_tt at phi_{n-1}, tangential S lam, heat, work of the drive against friction).
"""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside, jit_vectors
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.limits import outgrown, rim_amplitude, tip_motion
from contact.loop.modal.free_flight import FOREVER, PAUSE, FreeFlight, discrete_energy, skip_free_flight
from contact.loop.modal.modal import ModalState
from contact.loop.modal.rows import RimRows, fill, move, product, rotate, weighted
from contact.loop.tally import INSIDE, note_contact, note_stick, state_due, store, store_state
from contact.model.gaps.limits import LOOK
from contact.record.record import Samples, Tally
from contact.solver.abradable.tips import Coating, crush, first_bar, force_on, machined, surface
from contact.solver.dense import assign
from contact.solver.friction.one_contact import drag_ratio, scalar_force


@jit_inside
def untouched(out: Samples, sums: Tally, step: int) -> int:
    """Steps from `step` to the next that is stored; none when it is one."""
    if out.every == 0:
        row = max(sums.filled[0], sums.filled[1])
        return int(out.at[row] - step) if row < out.at.size else FOREVER
    every = out.every  # state_every is a multiple
    return int(-step % every)


@jit
def skip_on_rim(
    s: ModalState, rows: RimRows, flight: FreeFlight, Q: Array, d: Array, damped: bool, sums: Tally, h: float,
    step: int, room: int,
) -> int:  # fmt: skip
    """Skip from `step` over steps without contact; sets `memory` and `waves` where it lands. Negative: wait."""
    m = rows.modes
    q, own, be, c = s.q[:m], d[:m], s.be[:m], s.c[:m]
    before = discrete_energy(q, own, be, c) if damped else 0.0
    steps = skip_free_flight(flight, q, own, rows.angle - rows.speed * (step + 1) * h, -rows.speed * h, room)
    if steps <= 0:
        return steps
    if damped:
        sums.damping[0] += discrete_energy(q, own, be, c) - before
    rotate(rows.waves_next, rows.angle - rows.speed * (step + steps - 1) * h)
    fill(rows.normal, rows.waves_next, Q)
    s.memory[1] = Q[m] + product(Q, s.q) - product(Q, d)
    put_compliance(s.memory, Q, m)
    s.memory[7] = 0.0
    rotate(rows.waves, rows.angle - rows.speed * (step + steps) * h)
    fill(rows.normal, rows.waves, Q)
    s.memory[0] = Q[m] + product(Q, s.q)
    return steps


@jit_inside
def fly(s: ModalState, Q_next: Array, old: Array, new: Array) -> float:
    """D* = al D - be q into `new`; returns Q (q + D*)."""
    part = same(0.0)
    for i in range(0, s.q.size, WIDTH):
        q = load(s.q, i)
        step = load(s.al, i) * load(old, i) - load(s.be, i) * q
        put(new, i, step)
        part = part + load(Q_next, i) * (q + step)
    result: float = total(part)
    return result


@jit_inside
def put_compliance(memory: Array, Q: Array, m: int) -> None:
    """Keep S_nn, S_nt and S_tt of a row for the next step."""
    memory[4], memory[5], memory[6] = Q[m + 1], Q[m + 2], Q[m + 3]


@jit_inside
def tangential(s: ModalState, Q: Array, Q_next: Array, T: Array, new: Array) -> tuple[float, float, float, float]:
    """Q_next c T, T c Q, T c T, and the slip T D* of the rim."""
    nt, tn, tt, slip = same(0.0), same(0.0), same(0.0), same(0.0)
    for i in range(0, s.q.size, WIDTH):
        along = load(T, i)
        pull = along * load(s.c, i)
        nt, tn, tt = nt + load(Q_next, i) * pull, tn + pull * load(Q, i), tt + pull * along
        slip = slip + along * load(new, i)
    return total(nt), total(tn), total(tt), total(slip)


@jit
def coated_ratio(c: Coating, bar: int, cut: float, nn: float, nt: float, tn: float, tt: float, gap: float,
                 slip: float, mu: float) -> float:  # fmt: skip
    """Return what `drag_ratio` does, of a tip that presses into a coating."""
    normal = force_on(c, bar, cut, nn - nt * tn / tt, gap - nt * slip / tt)
    tangent = -(slip + tn * normal) / tt
    if normal > 0.0 and abs(tangent) <= mu * normal:
        return -tangent / normal
    for sign in (1.0, -1.0):
        normal = force_on(c, bar, cut, nn - sign * mu * nt, gap)
        if sign * ((tn - sign * mu * tt) * normal + slip) >= 0.0:
            return sign * mu
    return math.nan


@jit_inside
def push(s: ModalState, Q: Array, T: Array, old: Array, new: Array, force: float, drag: float) -> tuple[float, float]:
    """Add c (Q force - T drag) to D; returns Q and T times D_n + D_{n+1}."""
    normal, tangent, press, pull = same(0.0), same(0.0), same(force), same(drag)
    for i in range(0, s.q.size, WIDTH):
        row, along = load(Q, i), load(T, i)
        step = load(new, i) + load(s.c, i) * (row * press - along * pull)
        put(new, i, step)
        both = load(old, i) + step
        normal = normal + row * both
        tangent = tangent + along * both
    return total(normal), total(tangent)


@jit_vectors
def advance_rim(
    s: ModalState, rows: RimRows, flight: FreeFlight, coating: Coating, Q: Array, Q_next: Array, T: Array,
    averaged: bool, damped: bool, sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps at the moving point phi = phi_0 - Omega t: force at phi_n, gap at phi_{n+1}.

    Contact-free time is skipped to the next step that is stored; what a coating has lost only widens the gap.
    """
    old, new, m = s.old, s.d, rows.modes
    coated, rubs = coating.worn.size > 0, rows.mu > 0.0
    bar, cut, skin = 0, 0.0, 0.0  # first bar under the tip, depths there of the cut and of the surface
    end, step, taken, retry = first + steps, first, 0, first if flight.powers.shape[0] else first + steps
    waves, ahead, stopped = rows.waves, rows.waves_next, False
    rotate(waves, rows.angle - rows.speed * first * h)
    fill(rows.normal, waves, Q)
    now, last = s.memory[0], s.memory[1]
    while step < end:
        if step >= retry and now > 0.0 and last > 0.0 and sums.closed[0] == 0:
            room = min(end - step, untouched(out, sums, step))
            skipped = skip_on_rim(s, rows, flight, Q, new, damped, sums, h, step, room) if room > 0 else -1
            retry = step - skipped
            if skipped > 0:
                step += skipped
                retry = step
                now, last = s.memory[0], s.memory[1]
                s.memory[2], s.memory[3] = 0.0, 0.0
                waves, ahead = rows.waves, rows.waves_next
                continue
        old, new = new, old
        rotate(ahead, rows.angle - rows.speed * (step + 1) * h)
        fill(rows.normal, ahead, Q_next)
        free = Q_next[m] + fly(s, Q_next, old, new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        force, scale, pull, H = 0.0, 1.0, 0.0, 0.0
        if coated:
            bar = first_bar(coating, (rows.angle - rows.speed * step * h) / (2.0 * math.pi))
            cut = machined(coating, Q[m])
            skin = surface(coating, bar, cut)
            coating.memory[1], coating.memory[2] = 0.0, skin
        if not test + skin >= 0.0:
            nn, nt, tn, tt, slip = weighted(Q_next, s.c, Q), 0.0, 0.0, 0.0, 0.0
            if rubs:
                fill(rows.tangent, waves, T)
                nt, tn, tt, slip = tangential(s, Q, Q_next, T, new)
            share, slide = 0.25 if averaged else 1.0, slip + h * rows.surface - s.memory[7]
            S_nn, S_nt, S_tt = Q[m + 1], Q[m + 2], Q[m + 3]
            if rubs:
                n, across, along, t = share * nn + S_nn, share * nt + S_nt, tn + S_nt, tt + S_tt
                if coated:
                    pull = coated_ratio(coating, bar, cut, n, across, along, t, test, slide, rows.mu)
                else:
                    pull = drag_ratio(n, across, along, t, test, slide, rows.mu)
            H = nn - pull * nt
            scale = share * H + S_nn - pull * S_nt
            force = crush(coating, bar, cut, scale, test) if coated else scalar_force(scale, test)
            if not force >= 0.0:
                s.memory[2], s.memory[3] = H, scale
                return step
            normal, tangent = push(s, Q, T, old, new, force, pull * force)
            drag = -pull * force
            work = 0.5 * force * (free + H * force - last)
            if rows.S_turns:  # what S(phi) stores changes because the point moves, not because force does
                d_nn, d_nt, d_tt = S_nn - s.memory[4], S_nt - s.memory[5], S_tt - s.memory[6]
                work += 0.5 * (force * (d_nn * force + d_nt * drag) + drag * (d_nt * force + d_tt * drag))
            sums.rotation[0] += 0.5 * force * normal - work
            strain = S_nt * force + S_tt * drag
            soft = drag * (strain - s.memory[7])
            sums.work[0] += work - soft
            sums.friction[0] += 0.5 * drag * tangent + soft
            s.memory[7] = strain
            s.memory[8] -= drag * (slide + (tn + S_nt) * force + (tt + S_tt) * drag)
            s.memory[9] -= drag * h * rows.surface
            if rubs and pull * rows.surface < 0.0 and abs(pull) == rows.mu:
                sums.reversals[0] += 1
            retry = max(retry, step + PAUSE)
        else:
            s.memory[7] = 0.0
        if state_due(sums, out, step):
            assign(rows.seen, s.q, m)
            rows.seen[m] = force
            if rubs:
                rows.seen[m + 1] = -pull * force
            store_state(sums, out, step, step * h, rows.seen)
        sums.damping[0] += move(s, old, new)
        s.gap[0] = test + scale * force
        if coated:
            s.gap[0] += coating.memory[2]  # from the surface as it is worn and pressed
        s.force[0] = force
        s.memory[2] = force
        s.memory[3] = pull
        note_contact(sums, out, 0, h, step * h, force, s.gap[0], scale, now + skin, free + skin)
        if rubs:
            note_stick(sums, out, 0, int(force > 0.0 and abs(pull) < rows.mu * (1.0 - INSIDE)), step * h)
        last, now = now, free + H * force
        store(sums, out, step, step * h, s.force, s.gap)
        put_compliance(s.memory, Q, m)
        if step % LOOK == 0:
            rim_amplitude(rows.limits, rows.reach, s.q)
        tip_motion(rows.limits, now - Q_next[m])
        if outgrown(rows.limits):
            stopped, end = True, step + 1
        Q, Q_next = Q_next, Q
        waves, ahead = ahead, waves
        step += 1
        taken += 1
    s.memory[0], s.memory[1] = now, last
    if taken % 2 == 1:  # the two buffers changed places an odd number of times
        for i in range(s.d.size):
            s.d[i] = s.old[i]
    return step if stopped else -1
