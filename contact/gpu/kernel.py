"""Kernel for rims with one tip: a thread takes one run over many steps, in double precision.

The steps, the law of contact and the sums are those of `contact.loop.batch`; their scalar functions are the same
Python functions, compiled for the device. The last index of every array is the run, so that neighbouring threads read
neighbouring numbers.
"""

from __future__ import annotations

import math
from typing import Any

import numba.cuda

from contact.gpu.device import on_device
from contact.loop import formulas
from contact.model.gaps.limits import LOOK
from contact.solver.friction import one_contact

cuda: Any = numba.cuda
# rows of `number`
ANGLE, SPEED, H, SURFACE, MU, AVERAGED, TURNS, RIM, TIP, SOFT_N, SOFT_T = range(11)
NOW, LAST, FORCE, PULL, S_NN, S_NT, S_TT, STRAIN, HEAT, DRIVE = range(11, 21)  # `memory` of the slots
NUMBERS = 21
# rows of `sums`
IMPULSE, WORK, ROTATION, FRICTION, DAMPING, PEAK, PENETRATION, RESIDUAL, REACHED = range(9)
SUMS = 9
# rows of `whole`
STEP, END, STATUS, CONTACT_STEPS = range(4)
WHOLE = 4
GOING, NO_FORCE, FAR, MAY_PASS = range(4)  # values of STATUS

free_step = on_device(formulas.free_step)
damped = on_device(formulas.damped)
mean_gap = on_device(formulas.mean_gap)
turned_work = on_device(formulas.turned_work)
works = on_device(formulas.works)
drag_ratio = on_device(one_contact.drag_ratio)
force_and_ratio = on_device(one_contact.force_and_ratio, drag_ratio=drag_ratio)


def _turn_waves(wave: Any, phi: float, k: int) -> None:
    """Cos n phi and sin n phi of run k, wave 2 n and 2 n + 1."""
    c, s, x, y = math.cos(phi), math.sin(phi), 1.0, 0.0
    for n in range(wave.shape[0] // 2):
        wave[2 * n, k], wave[2 * n + 1, k] = x, y
        x, y = x * c - y * s, y * c + x * s


def _fill_rows(start: Any, place: Any, value: Any, wave: Any, rows: Any, k: int) -> None:
    """Rows of run k as sums of its waves."""
    for i in range(start.size - 1):
        part = 0.0
        for j in range(start[i], start[i + 1]):
            part += value[j, k] * wave[place[j], k]
        rows[i, k] = part


turn_waves: Any = cuda.jit(device=True)(_turn_waves)
fill_rows: Any = cuda.jit(device=True)(_fill_rows)


def _advance(
    q: Any, d: Any, new: Any, al: Any, be: Any, c: Any, weight: Any, reach: Any, n_start: Any, n_place: Any,
    n_value: Any, t_start: Any, t_place: Any, t_value: Any, Q: Any, Q_next: Any, T: Any, wave: Any, number: Any,
    sums: Any, whole: Any, steps: int,
) -> None:  # fmt: skip
    """Take each run that goes on over `steps` steps, at most to its end."""
    k = cuda.grid(1)
    if k >= q.shape[1] or whole[STATUS, k] != GOING:
        return
    m, h, mu = q.shape[0], number[H, k], number[MU, k]
    share = 0.25 if number[AVERAGED, k] == 1.0 else 1.0
    angle, turn = number[ANGLE, k], number[SPEED, k]
    turn_waves(wave, float(angle - turn * whole[STEP, k] * h), k)
    fill_rows(n_start, n_place, n_value, wave, Q, k)
    for _ in range(steps):
        step = whole[STEP, k]
        if step >= whole[END, k]:
            return
        turn_waves(wave, float(angle - turn * (step + 1) * h), k)
        fill_rows(n_start, n_place, n_value, wave, Q_next, k)
        free = Q_next[m, k]
        for i in range(m):
            ahead = free_step(al[i, k], be[i, k], d[i, k], q[i, k])
            new[i, k] = ahead
            free += Q_next[i, k] * (q[i, k] + ahead)
        now, last = number[NOW, k], number[LAST, k]
        test = mean_gap(0.25, free, now, last) if share == 0.25 else free
        force, pull, opened, slide, t_n, t_t = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        s_nn, s_nt, s_tt = Q[m + 1, k], Q[m + 2, k], Q[m + 3, k]
        scale = 1.0
        if not test >= 0.0:
            nn, nt, slip = 0.0, 0.0, 0.0
            if mu > 0.0:
                turn_waves(wave, float(angle - turn * step * h), k)
                fill_rows(t_start, t_place, t_value, wave, T, k)
            for i in range(m):
                row, push = Q[i, k], Q_next[i, k] * c[i, k]
                nn += push * row
                if mu > 0.0:
                    along = T[i, k]
                    nt += push * along
                    t_n += along * c[i, k] * row
                    t_t += along * c[i, k] * along
                    slip += along * new[i, k]
            w_nt, w_tn, w_tt = 0.0, 0.0, 0.0
            if mu > 0.0:
                slide = slip + h * number[SURFACE, k] - number[STRAIN, k]
                w_nt, w_tn, w_tt = share * nt + s_nt, t_n + s_nt, t_t + s_tt
            found, force, pull = force_and_ratio(share * nn + s_nn, w_nt, w_tn, w_tt, test, slide, mu)
            if not found:
                whole[STATUS, k] = NO_FORCE
                return
            opened = nn - pull * nt
            scale = share * opened + s_nn - pull * s_nt
        if step % LOOK == 0:
            bound = number[SOFT_N, k] * force + number[SOFT_T, k] * abs(pull * force)
            for i in range(m):
                bound += reach[i, k] * abs(q[i, k])
            if not bound <= number[RIM, k]:
                whole[STATUS, k] = MAY_PASS
                return
        drag, normal, tangent, lost = pull * force, 0.0, 0.0, 0.0
        for i in range(m):
            moved, before = new[i, k], d[i, k]
            if force > 0.0:
                moved += c[i, k] * Q[i, k] * force
                if mu > 0.0:
                    moved -= c[i, k] * T[i, k] * drag
                    tangent += T[i, k] * (before + moved)
                normal += Q[i, k] * (before + moved)
            lost += damped(weight[i, k], before, moved)
            d[i, k] = moved
            q[i, k] += moved
        after = free + opened * force
        changed = (s_nn - number[S_NN, k], s_nt - number[S_NT, k], s_tt - number[S_TT, k])
        turned = turned_work(force, -drag, changed[0], changed[1], changed[2]) * number[TURNS, k]
        strain = s_nt * force - s_tt * drag
        soft = -drag * (strain - number[STRAIN, k])
        work, rotation, friction = works(
            0.5, force * (after - last), turned, force * normal, -drag * tangent, soft
        )  # fmt: skip
        sums[WORK, k] += work
        sums[ROTATION, k] += rotation
        sums[FRICTION, k] += friction
        sums[DAMPING, k] -= lost
        sums[IMPULSE, k] += force * h
        sums[PEAK, k] = max(sums[PEAK, k], force)
        gap = test + scale * force
        sums[PENETRATION, k] = max(sums[PENETRATION, k], -gap)
        sums[RESIDUAL, k] = max(sums[RESIDUAL, k], abs(min(force * scale, gap)))
        slipped = slide + (t_n + s_nt) * force - (t_t + s_tt) * drag
        number[HEAT, k] += drag * slipped
        number[DRIVE, k] += drag * h * number[SURFACE, k]
        number[STRAIN, k] = strain
        number[NOW, k], number[LAST, k], number[FORCE, k], number[PULL, k] = after, now, force, pull
        number[S_NN, k], number[S_NT, k], number[S_TT, k] = s_nn, s_nt, s_tt
        if force > 0.0:
            whole[CONTACT_STEPS, k] += 1
        sums[REACHED, k] = max(sums[REACHED, k], abs(after - Q_next[m, k]))
        for i in range(m + 4):
            Q[i, k] = Q_next[i, k]
        whole[STEP, k] = step + 1
        if not sums[REACHED, k] <= number[TIP, k]:
            whole[STATUS, k] = FAR
            return


advance: Any = cuda.jit(_advance)
