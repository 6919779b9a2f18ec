"""Compiled: largest growth with one closed contact for many bodies, by Aberth's iteration for each."""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry


class Varied(NamedTuple):
    """Free poles s_j - i k_j Omega of bodies at one speed, and their changes in each case.

    In case d the poles are scale[d, body[j]] s_j - i k_j Omega, with the residues (a_j + mu[d] b_j)/scale. `real` and
    `imag` are of s, `turned` is k Omega, `a_real`, ... those of the residues, (N,); `body` (N,) is a column of `scale`
    (cases, bodies). The compliance of case d is S[d].
    """

    real: Array
    imag: Array
    turned: Array
    a_real: Array
    a_imag: Array
    b_real: Array
    b_imag: Array
    body: Indices
    scale: Array
    mu: Array
    S: Array


class Work(NamedTuple):
    """Work arrays: poles p, residues a, roots s and steps, (8, N); flags of the roots that still move, (N,)."""

    room: Array
    active: Indices


@jit
def sums_at(x: float, y: float, room: Array, count: int) -> tuple[float, float, float, float, float, float]:
    """Sums over the poles at s = x + i y of a/(s - p), a/(s - p)^2 and 1/(s - p), real and imaginary parts."""
    f_x, f_y, g_x, g_y, h_x, h_y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        u, v = x - room[0, j], y - room[1, j]
        size = 1.0 / (u * u + v * v)
        near_x, near_y = u * size, -v * size
        part_x = room[2, j] * near_x - room[3, j] * near_y
        part_y = room[2, j] * near_y + room[3, j] * near_x
        f_x += part_x
        f_y += part_y
        g_x += part_x * near_x - part_y * near_y
        g_y += part_x * near_y + part_y * near_x
        h_x += near_x
        h_y += near_y
    return f_x, f_y, g_x, g_y, h_x, h_y


@jit
def others(x: float, y: float, room: Array, row: int, own: int, count: int) -> tuple[float, float]:
    """Sum of 1/(s - z_k) over the other points z of two rows, at s = x + i y."""
    sum_x, sum_y = 0.0, 0.0
    for k in range(count):
        u, v = x - room[row, k], y - room[row + 1, k]
        size = u * u + v * v
        part = 0.0 if k == own or size == 0.0 else 1.0 / size
        sum_x += u * part
        sum_y -= v * part
    return sum_x, sum_y


@jit
def begin(room: Array, S: float, size: float, count: int) -> None:
    """First guess of the roots, p - a/(S + sum a_k/(p - p_k)), with the sum over the other poles."""
    for j in range(count):
        x, y = room[0, j], room[1, j]
        f_x, f_y = S, 0.0
        for k in range(count):
            u, v = x - room[0, k], y - room[1, k]
            apart = u * u + v * v
            part = 0.0 if k == j or apart == 0.0 else 1.0 / apart
            f_x += (room[2, k] * u + room[3, k] * v) * part
            f_y += (room[3, k] * u - room[2, k] * v) * part
        below = f_x * f_x + f_y * f_y
        part = 1.0 / below if below > 0.0 else 0.0
        s_x = (room[2, j] * f_x + room[3, j] * f_y) * part
        s_y = (room[3, j] * f_x - room[2, j] * f_y) * part
        if s_x == 0.0 and s_y == 0.0:
            s_x, s_y = 1e-6 * size, 1e-6 * size
        room[4, j], room[5, j] = x - s_x, y - s_y


@jit
def settled(room: Array, active: Indices, S: float, size: float, count: int, rounds: int, least: float) -> bool:
    """Move the roots until none moves by more than `least` times the largest pole; returns whether that was reached."""
    left = count
    for j in range(count):
        active[j] = j
    for _ in range(rounds):
        for i in range(left):
            j = active[i]
            x, y = room[4, j], room[5, j]
            f_x, f_y, g_x, g_y, h_x, h_y = sums_at(x, y, room, count)
            f_x += S
            below = f_x * f_x + f_y * f_y
            r_x = h_x - (g_x * f_x + g_y * f_y) / below
            r_y = h_y - (g_y * f_x - g_x * f_y) / below
            o_x, o_y = others(x, y, room, 4, j, count)
            r_x, r_y = r_x - o_x, r_y - o_y
            below = r_x * r_x + r_y * r_y
            room[6, j], room[7, j] = r_x / below, -r_y / below
        moving = 0
        for i in range(left):
            j = active[i]
            step = room[6, j] * room[6, j] + room[7, j] * room[7, j]
            if not step < 1e300:
                return False
            room[4, j] -= room[6, j]
            room[5, j] -= room[7, j]
            if step > least * least * size * size:
                active[moving] = j
                moving += 1
        left = moving
        if left == 0:
            return True
    return False


@jit_entry
def largest_growths(given: Varied, work: Work, growth: Array, rounds: int, least: float) -> None:
    """Largest real part of the roots of S + sum a/(s - p) of each case, (cases,); nan without convergence."""
    count, room = given.real.size, work.room
    for d in range(growth.size):
        size = 1.0
        for j in range(count):
            ratio = given.scale[d, given.body[j]]
            room[0, j], room[1, j] = ratio * given.real[j], ratio * given.imag[j] - given.turned[j]
            room[2, j] = (given.a_real[j] + given.mu[d] * given.b_real[j]) / ratio
            room[3, j] = (given.a_imag[j] + given.mu[d] * given.b_imag[j]) / ratio
            size = max(size, abs(room[1, j]))
        begin(room, given.S[d], size, count)
        if not settled(room, work.active, given.S[d], size, count, rounds, least):
            growth[d] = float("nan")
            continue
        most = room[4, 0]
        for j in range(count):
            most = max(most, room[4, j])
        growth[d] = most
