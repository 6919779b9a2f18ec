"""Compiled passage through a period: phases one after another, contacts that close and open, and the derivative.

In a phase x = Re(V y) + Re(sum X e^{i w t}) with y' = lam y + beta (`contact.loop.phase`). Each phase is made for a
drive when it is first met: with the forcing f of its closed contacts, lam = -L^-1 f, b = b_0 + B lam, and X the forced
vibration. A rigid contact's impact, and a phase that is not known, are left to the caller, who calls again.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.period_arrays import Period
from contact.loop.phase import flow, move_to, number_of, pass_phase

DONE, UNKNOWN, IMPACT, CHATTER, NOT_A_NUMBER, SLIP, RESONANCE, INSIDE, TOGETHER = range(9)
START, CLOSED, ON = range(3)
NEAR = 1e-12  # of the drive's frequency: a pole that is nearer to a harmonic has no forced vibration
WITHIN = 1e-9  # of the terms of a gap, or of the drive's reach: smaller penetrations count as zero


@jit
def copy(into: Array, of: Array) -> None:
    """Copy a vector."""
    for i in range(into.size):
        into[i] = of[i]


@jit
def copy_rows(into: Array, of: Array) -> None:
    """Copy a matrix."""
    for i in range(into.shape[0]):
        for j in range(into.shape[1]):
            into[i, j] = of[i, j]


@jit
def drive_phase(s: Period, phase: int) -> int:
    """Compute forcing and forced vibration of a phase under the drive; returns DONE or RESONANCE."""
    drive, closed = s.drive, s.phases.closed[phase]
    copy(drive.rest[phase], drive.watched_rest)
    copy(drive.drive_rest[phase], drive.b_rest)
    for part in range(2):
        copy_rows(drive.wave[phase, part], drive.watched_wave[part])
        copy_rows(drive.drive_wave[phase, part], drive.b_wave[part])
    for i in range(closed.size):
        if closed[i]:
            press(s, phase, i, drive.pull_rest, drive.rest[phase], drive.drive_rest[phase])
            for part in range(2):
                press_wave(s, phase, i, part)
    for i in range(s.phases.lam.shape[2]):
        re, im = 0.0, 0.0
        for j in range(drive.b_rest.size):
            re += s.phases.U[phase, 0, i, j] * drive.drive_rest[phase, j]
            im += s.phases.U[phase, 1, i, j] * drive.drive_rest[phase, j]
        drive.beta[phase, 0, i], drive.beta[phase, 1, i] = re, im
    for h in range(drive.harmonic.size):
        if not vibrates(s, phase, h):
            return RESONANCE
    drive.made[phase] = 1
    return DONE


@jit
def press(s: Period, phase: int, i: int, pull: Array, watched: Array, b: Array) -> None:
    """Add the constant force of a closed contact to the watched quantities and to the state."""
    table, closed = s.phases, s.phases.closed[phase]
    force = 0.0
    for j in range(closed.size):
        force -= table.solve[phase, i, j] * pull[j]
    watched[i] = force
    for row in range(watched.size):
        if row >= closed.size or not closed[row]:
            watched[row] += table.plant.shift[row, i] * force
    for j in range(b.size):
        b[j] += table.plant.push[j, i] * force


@jit
def press_wave(s: Period, phase: int, i: int, part: int) -> None:
    """Add the harmonics of the force of a closed contact."""
    table, drive, closed = s.phases, s.drive, s.phases.closed[phase]
    watched, b = drive.wave[phase, part], drive.drive_wave[phase, part]
    for h in range(drive.harmonic.size):
        force = 0.0
        for j in range(closed.size):
            force -= table.solve[phase, i, j] * drive.pull_wave[part, j, h]
        watched[i, h] = force
        for row in range(watched.shape[0]):
            if row >= closed.size or not closed[row]:
                watched[row, h] += table.plant.shift[row, i] * force
        for j in range(b.shape[0]):
            b[j, h] += table.plant.push[j, i] * force


@jit
def vibrates(s: Period, phase: int, h: int) -> bool:
    """X of one harmonic, from a force that rotates forward and one that rotates backward; False at a resonance."""
    table, drive, sides = s.phases, s.drive, s.work.sides
    w, b, X = drive.harmonic[h], drive.drive_wave[phase], drive.X[phase]
    for i in range(sides.shape[2]):
        down, across = -table.lam[phase, 0, i], table.lam[phase, 1, i]
        near = NEAR * abs(drive.base[0])
        if math.hypot(down, w - across) < near or math.hypot(down, -w - across) < near:
            return False
        a, c, d, e = 0.0, 0.0, 0.0, 0.0  # sums of Re U Re b, Im U Im b, Re U Im b, Im U Re b
        for j in range(b.shape[1]):
            u, v, re, im = table.U[phase, 0, i, j], table.U[phase, 1, i, j], b[0, j, h], b[1, j, h]
            a += u * re
            c += v * im
            d += u * im
            e += v * re
        sides[0, 0, i], sides[1, 0, i] = divided(0.5 * (a - c), 0.5 * (d + e), down, w - across)
        sides[0, 1, i], sides[1, 1, i] = divided(0.5 * (a + c), 0.5 * (e - d), down, -w - across)
    for j in range(b.shape[1]):
        re, im = 0.0, 0.0
        for i in range(sides.shape[2]):
            u, v = table.V[phase, 0, j, i], table.V[phase, 1, j, i]
            re += u * (sides[0, 0, i] + sides[0, 1, i]) - v * (sides[1, 0, i] + sides[1, 1, i])
            im += u * (sides[1, 0, i] - sides[1, 1, i]) + v * (sides[0, 0, i] - sides[0, 1, i])
        X[0, j, h], X[1, j, h] = re, im
    return True


@jit
def divided(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """(a + i b)/(c + i d), without overflow of squares."""
    if abs(c) >= abs(d):
        part = d / c
        below = c + d * part
        return (a + b * part) / below, (b - a * part) / below
    part = c / d
    below = c * part + d
    return (a * part + b) / below, (b * part - a) / below


@jit
def vibration(s: Period, phase: int, t: float, sense: float) -> None:
    """Add `sense` times the forced vibration at time t to the state."""
    X, x = s.drive.X[phase], s.work.x
    for h in range(X.shape[2]):
        c, d = math.cos(s.drive.harmonic[h] * t), math.sin(s.drive.harmonic[h] * t)
        for j in range(x.size):
            x[j] += sense * (X[0, j, h] * c - X[1, j, h] * d)


@jit
def into(s: Period, phase: int, t: float) -> None:
    """Fill the arrays for the passage through a phase, and the state in its eigenvectors."""
    table, drive, now, x = s.phases, s.drive, s.now, s.work.x
    copy(now.rest, drive.rest[phase])
    copy(now.harmonic, drive.harmonic)
    for part in range(2):
        copy_rows(now.rows[part], table.seen[phase, part])
        copy_rows(now.wave[part], drive.wave[phase, part])
    for row in range(now.rest.size):
        for j in range(x.size):
            value = table.rows[phase, row, j]
            for h in range(drive.harmonic.size):
                now.wave[0, row, h] += value * drive.X[phase, 0, j, h]
                now.wave[1, row, h] += value * drive.X[phase, 1, j, h]
    vibration(s, phase, t, -1.0)
    project(s, phase)


@jit
def project(s: Period, phase: int) -> None:
    """Poles, forcing and state of a phase in its eigenvectors."""
    table, now, y, x = s.phases, s.now, s.moving.y, s.work.x
    copy_rows(now.lam, table.lam[phase])
    copy_rows(now.beta, s.drive.beta[phase])
    for i in range(y.shape[1]):
        re, im = 0.0, 0.0
        for j in range(x.size):
            re += table.U[phase, 0, i, j] * x[j]
            im += table.U[phase, 1, i, j] * x[j]
        y[0, i], y[1, i] = re, im


@jit
def out_of(s: Period, phase: int, t: float) -> None:
    """The state from its eigenvectors."""
    table, y, x = s.phases, s.moving.y, s.work.x
    for j in range(x.size):
        total = 0.0
        for i in range(y.shape[1]):
            total += table.V[phase, 0, j, i] * y[0, i] - table.V[phase, 1, j, i] * y[1, i]
        x[j] = total
    vibration(s, phase, t, 1.0)


@jit
def along(s: Period, phase: int, time: float) -> None:
    """M becomes e^(A time) M = Re V e^(lam time) U M."""
    table, M, half = s.phases, s.work.M, s.work.half
    half[:] = 0.0
    for i in range(half.shape[1]):
        c, d, _u, _v = flow(table.lam[phase], i, time)
        for j in range(M.shape[0]):
            re, im = table.U[phase, 0, i, j], table.U[phase, 1, i, j]
            re, im = c * re - d * im, c * im + d * re
            for column in range(M.shape[1]):
                half[0, i, column] += re * M[j, column]
                half[1, i, column] += im * M[j, column]
    M[:] = 0.0
    for j in range(M.shape[0]):
        for i in range(half.shape[1]):
            re, im = table.V[phase, 0, j, i], table.V[phase, 1, j, i]
            for column in range(M.shape[1]):
                M[j, column] += re * half[0, i, column] - im * half[1, i, column]


@jit
def watch(s: Period, phase: int) -> None:
    """Initial extremes for the passage through a phase; of an open contact the least gap counts."""
    most, least, work, closed = s.moving.most, s.moving.least, s.work, s.phases.closed[phase]
    k = closed.size
    for i in range(k):
        most[i], least[i] = (work.force[i], -math.inf) if closed[i] else (math.inf, work.gap[i])
    copy(most[k:], work.most)
    copy(least[k:], work.least)
    for slip in range(s.phases.plant.slips.shape[0]):  # of this phase alone
        row = k + s.phases.plant.slips[slip, 1]
        most[row], least[row] = math.inf, math.inf if closed[s.phases.plant.slips[slip, 0]] else -math.inf


@jit
def watched(s: Period, phase: int) -> int:
    """Store the extremes of a phase; returns the contact whose slip reversed, or -1."""
    most, least, work, closed = s.moving.most, s.moving.least, s.work, s.phases.closed[phase]
    k = closed.size
    for i in range(k):
        if closed[i]:
            work.gap[i], work.force[i] = min(work.gap[i], 0.0), most[i]
        else:
            work.gap[i] = least[i]
    copy(work.most, most[k:])
    copy(work.least, least[k:])
    for slip in range(s.phases.plant.slips.shape[0]):
        contact, row = s.phases.plant.slips[slip, 0], s.phases.plant.slips[slip, 1]
        if closed[contact] and not least[k + row] > 0.0:
            return int(contact)
    return -1


@jit
def closed_at(s: Period, t: float) -> int:
    """Contacts that press at the state; returns DONE, INSIDE a rigid one, or TOGETHER if the caller must find them."""
    table, drive, work, x = s.phases, s.drive, s.work, s.work.x
    found = DONE
    for i in range(work.closed.size):
        gap, size = 0.0, 0.0
        for j in range(x.size):
            gap += table.plant.gaps[i, j] * x[j]
            size += abs(table.plant.gaps[i, j] * x[j])
        moved = drive.watched_rest[i]
        for h in range(drive.harmonic.size):
            angle = drive.harmonic[h] * t
            moved += drive.watched_wave[0, i, h] * math.cos(angle) - drive.watched_wave[1, i, h] * math.sin(angle)
        gap, size = gap + moved, size + abs(moved)
        if table.plant.rigid[i] and gap < -WITHIN * max(size, drive.reach[i]):
            return INSIDE
        work.closed[i] = int(gap < 0.0 and not table.plant.rigid[i])
        if work.closed[i] and table.plant.coupled[0]:
            found = TOGETHER
    return found


@jit
def begin(s: Period, extremes: bool, tangent: bool) -> None:
    """Extremes, events and derivative at the start."""
    work = s.work
    none = math.inf if extremes else -math.inf  # what begins beyond all values is not searched for
    work.gap[:], work.force[:], work.most[:], work.least[:] = none, 0.0 if extremes else math.inf, -none, none
    work.where[:] = 0
    if tangent:
        work.M[:] = 0.0
        for i in range(work.x.size):
            work.M[i, i] = 1.0


@jit_entry
def contacts_at(s: Period, t: float) -> int:
    """`closed_at` for the current phase."""
    return int(closed_at(s, t))


@jit_entry
def pass_period(s: Period, stage: int, t_end: float, longest: float, extremes: bool, tangent: bool) -> int:
    """Continue from `at` to `t_end`; returns the reason for the end: DONE, a task for the caller, or an error.

    `stage` START first finds the contacts that press, CLOSED uses those that the caller found, ON continues. `where`
    has the phase, the contact of the event, the number of events and of stretches.
    """
    work, moving, k = s.work, s.moving, s.work.closed.size
    if stage == START:
        found = closed_at(s, work.at[0])
        if found != DONE:
            return int(found)
    if stage != ON:
        for i in range(k):
            work.first[i] = work.closed[i]
        begin(s, extremes, tangent)
    while True:
        phase = number_of(s.phases.known, s.phases.closed, s.work.closed)
        if phase < 0:
            return UNKNOWN
        work.where[0] = phase
        if not s.drive.made[phase] and drive_phase(s, phase) != DONE:
            return RESONANCE
        before = work.at[0]
        into(s, phase, before)
        watch(s, phase)
        hit = pass_phase(s.now, moving, k, before, t_end, longest)
        time = moving.at[0]
        work.at[0] = time
        out_of(s, phase, time)
        for j in range(work.x.size):
            if not abs(work.x[j]) < math.inf:
                return NOT_A_NUMBER
        if tangent:
            along(s, phase, time - before)
        work.stretch[work.where[3]], work.stretch_time[work.where[3]] = phase, time - before
        work.where[3] += 1
        slipping = watched(s, phase)
        if slipping >= 0:
            work.where[1] = slipping
            return SLIP
        if hit < 0:
            return DONE
        if work.where[2] >= work.event.size:
            return CHATTER
        if not work.closed[hit] and s.phases.plant.rigid[hit]:
            work.where[1] = hit
            return IMPACT
        work.event[work.where[2]], work.event_time[work.where[2]] = -1 - hit if work.closed[hit] else hit, time
        work.where[2] += 1
        work.closed[hit] = 1 - work.closed[hit]


@jit_entry
def pass_beside(s: Period, t: float, stretch: Indices, stretch_time: Array, scale: float) -> int:
    """Follow the state through given phases for given times, multiplied by `scale`; returns DONE or RESONANCE."""
    for k in range(stretch.size):
        phase, time = stretch[k], scale * stretch_time[k]
        if not s.drive.made[phase] and drive_phase(s, phase) != DONE:
            return RESONANCE
        vibration(s, phase, t, -1.0)
        project(s, phase)
        move_to(s.now, s.moving.y, time)
        t += time
        out_of(s, phase, t)
    return DONE


@jit_entry
def drive_alone(s: Period, phase: int) -> int:
    """Compute a phase for the drive; returns DONE or RESONANCE."""
    return DONE if s.drive.made[phase] else int(drive_phase(s, phase))
