"""Deflection of a rim: the largest |u_r| around any of its lines, modes and residual compliance together.

u_r(theta) = sum_n a_n cos n theta + b_n sin n theta on each line, (a, b) = rows q + S F, F the forces of the tips by
waves. The maximum over PLACES points per period of the highest harmonic is within 0.5 % of the true one. The limit
of half the wall, the growth of a run, its end state, pages and JSON all use it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.remembered import remembered
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import Rub
from contact.model.trig import harmonics

PLACES = 32  # around the rim, per period of its highest harmonic
ROWS = 4096  # states that are read together
TOGETHER = 256  # motions whose values around the rim fit into the cache of a core


@dataclass(frozen=True, eq=False, slots=True)
class RimRows:
    """Radial rows of the lines of a rim of m modes, waves 1, cos .. cos N, sin .. sin N.

    `S`: static deflection by unit forces, by line and direction; empty without residual compliance. `reach` and `soft`:
    largest motion of a line for unit motion of a mode, and for a unit force.
    """

    rows: Array  # (lines, 2 N + 1, m)
    S: Array  # (lines, 2 N + 1, lines d, 2 N + 1)
    reach: Array  # (lines, m)
    soft: Array  # (lines, lines d)


@remembered
def rim_rows(casing: ModalBody, dimensions: int, flexible: int) -> RimRows:
    """Radial rows of a casing whose contacts have `dimensions` directions.

    Rows of modes from `flexible` on (a rotor's) are 0.
    """
    size, lines, D = 2 * casing.n_max + 1, casing.rim_lines, casing.directions
    rows = casing.rows.reshape(lines, D, size, -1)[:, 0].copy()
    rows[:, :, flexible:] = 0.0
    S = casing.S.reshape(lines, D, size, lines, D, size)[:, 0, :, :, :dimensions]
    S = np.ascontiguousarray(S.reshape(lines, size, lines * dimensions, size))
    N = casing.n_max
    reach = np.abs(rows[:, 0]) + np.hypot(rows[:, 1 : N + 1], rows[:, N + 1 :]).sum(axis=1)
    soft = np.abs(S).sum(axis=(1, 3))
    return RimRows(readonly(rows), readonly(S) if S.any() else np.zeros((0, 0, 0, 0)), readonly(reach), readonly(soft))


def forces_by_wave(rub: Rub, turned: Array, forces: Array) -> Array:
    """Forces of the tips (ns, K d) as waves on the casing's lines and directions, (ns, lines, D, 2 N + 1) [N].

    `turned` (ns,) are the angles turned.
    """
    casing, K = rub.casing, len(rub.tips)
    d = forces.shape[1] // K
    found = np.zeros((len(turned), casing.rim_lines, casing.directions, 2 * casing.n_max + 1))
    for j, tip in enumerate(rub.tips):
        waves = harmonics(casing.n_max, math.radians(tip.angle_deg) - turned)
        for i in range(d):
            found[:, tip.line, i] += forces[:, j * d + i, None] * waves
    return found


def rim_motion(rub: Rub, time: Array, q: Array, forces: Array) -> Array:
    """Radial motion of each line by waves 1, cos .. cos N, sin .. sin N, (ns, lines, 2 N + 1) [m].

    At instants `time` (ns,), from modal coordinates `q` (ns, m) of the casing and forces of the tips (ns, K d).
    """
    d = forces.shape[1] // len(rub.tips)
    rim = rim_rows(rub.casing, d, rub.flexible)
    moved = np.tensordot(q, rim.rows, axes=(1, 2))
    if rim.S.size:
        pressed = forces_by_wave(rub, rub.turned(time, q), forces)[:, :, :d].reshape(len(time), -1, rim.rows.shape[1])
        moved = moved + np.tensordot(pressed, rim.S, axes=([1, 2], [2, 3]))
    return np.asarray(moved)


def places(size: int) -> Array:
    """Angles [rad] in half a turn at which, and at whose negatives, a deflection of `size` waves is evaluated."""
    count = PLACES // 2 * (size // 2 + 1)
    return np.asarray((np.arange(count) + 0.5) * (math.pi / count))


def around(moved: Array) -> Array:
    """Largest magnitude over theta of motions by waves 1, cos .. cos N, sin .. sin N, (..., 2 N + 1).

    At theta and -theta together it is |sum of cosines| + |sum of sines|.

    >>> around(np.array([[1.0, 0.0, 2.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0, 0.0]])).round(2).tolist()
    [3.0, 3.0]
    """
    N = moved.shape[-1] // 2
    waves = harmonics(N, places(moved.shape[-1])).T
    every = moved.reshape(-1, moved.shape[-1])
    found = np.empty(len(every))
    for start in range(0, len(every), TOGETHER):
        part = every[start : start + TOGETHER]
        there, other = part[:, : N + 1] @ waves[: N + 1], part[:, N + 1 :] @ waves[N + 1 :]
        np.abs(there, out=there)
        there += np.abs(other, out=other)
        found[start : start + TOGETHER] = there.max(axis=1)
    return found.reshape(moved.shape[:-1])


def deflection(rub: Rub, time: Array, q: Array, forces: Array) -> Array:
    """Largest magnitude of the radial motion around any line of the rim at each instant, (ns,) [m].

    Arguments as of `rim_motion`.
    """
    found = np.zeros(len(time))
    for start in range(0, len(time), ROWS):
        part = slice(start, start + ROWS)
        found[part] = around(rim_motion(rub, time[part], q[part], forces[part])).max(axis=1)
    return found
