"""One step of eight rims: free motion, forces of closing contacts, their effect on the modes, and the energy sums."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit_inside
from contact.jit.vector import WIDTH, below_zero, entry, larger, load, put, same
from contact.loop.batch.waves import (
    DAMPING,
    DRAG,
    DRIVE,
    FORCE,
    FREE,
    GAP,
    H_,
    HEAT,
    N_T,
    NORMAL,
    PULL,
    SCALE,
    SLIDE,
    SLIP,
    STRAIN,
    T_N,
    T_T,
    TANGENT,
    TEST,
    BatchState,
    fill_slots,
)
from contact.loop.formulas import damped, free_step, mean_gap, turned_work, works
from contact.loop.rub.free_flight import PAUSE
from contact.model.gaps.limits import REACHED, RIM, TIP
from contact.record.record import Tally
from contact.solver.friction.one_contact import force_and_ratio


@jit_inside
def coefficient(s: BatchState, alike: bool, k: int, values: Array, i: int) -> float:
    """One of the coefficients al, be, c, weight (k = 0 .. 3) of mode i, in every slot."""
    found: float = same(entry(s.alike, k * s.q.shape[0] + i)) if alike else load(values, i * WIDTH)
    return found


@jit_inside
def fly(s: BatchState, Q_next: Array, ahead: Array, old: Array, new: Array) -> bool:
    """Free motion over a step into `new`, the rows at the next angle, and the gaps; returns whether one would close."""
    fill_slots(s.normal, ahead, Q_next)
    alike = s.alike.size > 0
    free = load(Q_next, s.q.shape[0] * WIDTH)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        row, q = load(Q_next, at), load(s.q, at)
        step = free_step(coefficient(s, alike, 0, s.al, i), coefficient(s, alike, 1, s.be, i), load(old, at), q)
        put(new, at, step)
        free = free + row * (q + step)
    now, last, share = load(s.memory, 0), load(s.memory, WIDTH), load(s.averaged, 0)
    mean = mean_gap(same(0.25), free, now, last)
    test = share * mean + (same(1.0) - share) * free  # one of the two, to the bit
    put(s.work, FREE * WIDTH, free)
    put(s.work, TEST * WIDTH, test)
    closes: bool = below_zero(test + load(s.away, 0))
    return closes


@jit_inside
def touch(s: BatchState, Q: Array, Q_next: Array, waves: Array, new: Array, rubs: bool) -> None:
    """Slip, Delassus numbers and forces of the slots whose gap would close."""
    nn, nt, tn, tt, slip, m = same(0.0), same(0.0), same(0.0), same(0.0), same(0.0), s.q.shape[0]
    alike = s.alike.size > 0
    if rubs:
        fill_slots(s.tangent, waves, s.T)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        row, c = load(Q, at), coefficient(s, alike, 2, s.c, i)
        ahead = load(Q_next, at)
        nn = nn + ahead * c * row
        if rubs:
            along = load(s.T, at)
            pull = along * c
            nt, tn, tt, slip = nt + ahead * pull, tn + pull * row, tt + pull * along, slip + along * load(new, at)
    put(s.work, H_ * WIDTH, nn)
    put(s.work, N_T * WIDTH, nt)
    put(s.work, T_N * WIDTH, tn)
    put(s.work, T_T * WIDTH, tt)
    put(s.work, SLIP * WIDTH, slip)
    for k in range(s.step.size):
        force, scale, pull, H, test = 0.0, 1.0, 0.0, 0.0, s.work[TEST, k]
        if s.live[k] == 1 and not test >= 0.0:
            share = 0.25 if s.averaged[k] == 1.0 else 1.0
            S_nn, S_nt, S_tt = Q[m + 1, k], Q[m + 2, k], Q[m + 3, k]
            slide, across, along, t = 0.0, 0.0, 0.0, 0.0
            if s.mu[k] > 0.0:
                slide = s.work[SLIP, k] + s.h[k] * s.surface[k] - s.memory[STRAIN, k]
                across, along, t = share * s.work[N_T, k] + S_nt, s.work[T_N, k] + S_nt, s.work[T_T, k] + S_tt
                s.work[SLIDE, k] = slide
            found, force, pull = force_and_ratio(share * s.work[H_, k] + S_nn, across, along, t, test, slide, s.mu[k])
            if found:
                H = s.work[H_, k] - pull * s.work[N_T, k]
                scale = share * H + S_nn - pull * S_nt
            else:
                s.failed[k], force, pull = 1, 0.0, 0.0
            s.retry[k] = max(s.retry[k], s.step[k] + PAUSE)
        s.work[FORCE, k], s.work[PULL, k], s.work[DRAG, k] = force, pull, pull * force
        s.work[H_, k], s.work[SCALE, k] = H, scale


@jit_inside
def move_slots(s: BatchState, Q: Array, old: Array, new: Array, touching: bool, rubs: bool) -> None:
    """Add the effect of forces to D, and D to q; work of forces and damping along D_n + D_{n+1}."""
    normal, tangent, damping = same(0.0), same(0.0), same(0.0)
    alike = s.alike.size > 0
    force, drag = load(s.work, FORCE * WIDTH), load(s.work, DRAG * WIDTH)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        step, before = load(new, at), load(old, at)
        if touching:
            row, c = load(Q, at), coefficient(s, alike, 2, s.c, i)
            step = step + c * row * force
            if rubs:
                along = load(s.T, at)
                step = step - c * along * drag
                tangent = tangent + along * (before + step)
            normal = normal + row * (before + step)
            put(new, at, step)
        damping = damping + damped(coefficient(s, alike, 3, s.weight, i), before, step)
        put(s.q, at, load(s.q, at) + step)
    put(s.work, NORMAL * WIDTH, normal)
    put(s.work, TANGENT * WIDTH, tangent)
    put(s.work, DAMPING * WIDTH, damping)


@jit_inside
def add_up(s: BatchState, sums: Tally, Q: Array, Q_next: Array) -> bool:
    """Energy sums of one step of every slot, and the gaps for the next step; a slot without force does no work.

    Returns whether a tip has moved against its rim beyond its limit.
    """
    force, H = load(s.work, FORCE * WIDTH), load(s.work, H_ * WIDTH)
    scale, pull = load(s.work, SCALE * WIDTH), load(s.work, PULL * WIDTH)
    free, now, last, h = load(s.work, FREE * WIDTH), load(s.memory, 0), load(s.memory, WIDTH), load(s.h, 0)
    m = s.q.shape[0]
    half, drag = same(0.5), same(0.0) - pull * force
    S_nn, S_nt, S_tt = load(Q, (m + 1) * WIDTH), load(Q, (m + 2) * WIDTH), load(Q, (m + 3) * WIDTH)
    after = free + H * force
    d_nn, d_nt, d_tt = (
        S_nn - load(s.memory, 4 * WIDTH), S_nt - load(s.memory, 5 * WIDTH), S_tt - load(s.memory, 6 * WIDTH)
    )  # fmt: skip
    turned = turned_work(force, drag, d_nn, d_nt, d_tt) * load(s.turns, 0)
    strain, before = S_nt * force + S_tt * drag, load(s.memory, STRAIN * WIDTH)
    soft = drag * (strain - before)
    across, along = force * load(s.work, NORMAL * WIDTH), drag * load(s.work, TANGENT * WIDTH)
    work, rotation, friction = works(half, force * (after - last), turned, across, along, soft)
    put(sums.work, 0, load(sums.work, 0) + work)
    put(sums.rotation, 0, load(sums.rotation, 0) + rotation)
    put(sums.friction, 0, load(sums.friction, 0) + friction)
    slip = load(s.work, SLIDE * WIDTH) + (load(s.work, T_N * WIDTH) + S_nt) * force
    slip = slip + (load(s.work, T_T * WIDTH) + S_tt) * drag
    put(s.memory, HEAT * WIDTH, load(s.memory, HEAT * WIDTH) - drag * slip)
    put(s.memory, DRIVE * WIDTH, load(s.memory, DRIVE * WIDTH) - drag * h * load(s.surface, 0))
    put(s.memory, STRAIN * WIDTH, strain)
    put(sums.damping, 0, load(sums.damping, 0) - load(s.work, DAMPING * WIDTH))
    impulse, none = load(sums.impulse, 0) + force * h, same(0.0)
    put(sums.impulse, 0, impulse)
    put(sums.peak, 0, larger(load(sums.peak, 0), force))
    gap = load(s.work, TEST * WIDTH) + scale * force
    put(s.work, GAP * WIDTH, gap)
    put(sums.penetration, 0, larger(load(sums.penetration, 0), none - gap))
    slack = larger(none - force * scale, none - gap)  # minus the lesser
    put(sums.residual, 0, larger(load(sums.residual, 0), larger(slack, none - slack)))
    put(s.memory, 0, after)
    put(s.memory, WIDTH, now)
    put(s.memory, 2 * WIDTH, force)
    put(s.memory, 3 * WIDTH, pull)
    put(s.memory, 4 * WIDTH, S_nn)
    put(s.memory, 5 * WIDTH, S_nt)
    put(s.memory, 6 * WIDTH, S_tt)
    moved = after - load(Q_next, m * WIDTH)
    reached = larger(load(s.limits, (REACHED + TIP) * WIDTH), larger(moved, none - moved))
    put(s.limits, (REACHED + TIP) * WIDTH, reached)
    rim = load(s.limits, (REACHED + RIM) * WIDTH)
    far: bool = below_zero(load(s.limits, TIP * WIDTH) - reached) or below_zero(load(s.limits, RIM * WIDTH) - rim)
    return far
