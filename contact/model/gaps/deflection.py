"""Deflection of a rim: the largest |u_r| around any of its lines, modes and residual compliance together.

u_r(theta) = sum_n a_n cos n theta + b_n sin n theta on each line, (a, b) = rows q + S F, F the forces of the tips by
waves. The maximum over PLACES points per period of the highest harmonic is within 0.5 % of the true one. The limit
of half the wall, the growth of a run, its end state, pages and JSON all use it.

The magnitudes of all waves add up to a bound of the deflection, those of all modes and forces to a larger one that
takes less time. The growth of a run needs the largest deflection in parts of the run (`Sizes`): instants whose bound is
below a deflection that was found in their part are not evaluated.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.base.remembered import remembered
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import Rub
from contact.model.trig import harmonics, harmonics_by_powers

PLACES = 32  # around the rim, per period of its highest harmonic
ROWS = 1024  # states that are read together; of more, arrays do not fit into a cache
TOGETHER = 256  # motions whose values around the rim fit into the cache of a core
ABOVE = 1.0 + 1e-12  # times a bound: its round-off


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
        waves = harmonics_by_powers(casing.n_max, math.radians(tip.angle_deg) - turned)
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


@remembered
def _waves(size: int) -> Array:
    """Values of `size` waves at their places, (size, places)."""
    return readonly(harmonics(size // 2, places(size)).T)


def around(moved: Array) -> Array:
    """Largest magnitude over theta of motions by waves 1, cos .. cos N, sin .. sin N, (..., 2 N + 1).

    At theta and -theta together it is |sum of cosines| + |sum of sines|.

    >>> around(np.array([[1.0, 0.0, 2.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0, 0.0]])).round(2).tolist()
    [3.0, 3.0]
    """
    N, waves = moved.shape[-1] // 2, _waves(moved.shape[-1])
    every = moved.reshape(-1, moved.shape[-1])
    found = np.empty(len(every))
    for start in range(0, len(every), TOGETHER):
        part = every[start : start + TOGETHER]
        there, other = part[:, : N + 1] @ waves[: N + 1], part[:, N + 1 :] @ waves[N + 1 :]
        np.abs(there, out=there)
        there += np.abs(other, out=other)
        found[start : start + TOGETHER] = there.max(axis=1)
    return found.reshape(moved.shape[:-1])


def deflection(rub: Rub, time: Array, q: Array, forces: Array, least: Array | None = None) -> Array:
    """Largest magnitude of the radial motion around any line of the rim at each instant, (ns,) [m].

    Arguments as of `rim_motion`. A deflection that is not above `least` (ns,) is replaced by it.
    """
    found = np.zeros(len(time)) if least is None else least.copy()
    for start in range(0, len(time), ROWS):
        part = slice(start, start + ROWS)
        moved = rim_motion(rub, time[part], q[part], forces[part])
        evaluated = slice(None) if least is None else ~(by_magnitudes(moved) <= least[part])
        found[part][evaluated] = np.maximum(around(moved[evaluated]).max(axis=1), found[part][evaluated])
    return found


def by_magnitudes(moved: Array) -> Array:
    """Upper bound of the deflection from the motion of each line by waves, (ns, lines, 2 N + 1), (ns,) [m]."""
    N = moved.shape[-1] // 2
    every = np.abs(moved[..., 0]) + np.hypot(moved[..., 1 : N + 1], moved[..., N + 1 :]).sum(axis=-1)
    return np.asarray(ABOVE * every.max(axis=1))


def by_modes(rub: Rub, q: Array, forces: Array) -> Array:
    """Upper bound of the deflection from modal coordinates (ns, m) and forces (ns, K d) alone, (ns,) [m]."""
    d = forces.shape[1] // len(rub.tips)
    rim = rim_rows(rub.casing, d, rub.flexible)
    every = np.abs(q) @ rim.reach.T
    if rim.S.size:
        on = [tip.line * d + i for tip in rub.tips for i in range(d)]
        every += np.abs(forces) @ rim.soft.T[on]
    return np.asarray(ABOVE * every.max(axis=1))


@dataclass(frozen=True, eq=False, slots=True)
class Sizes:
    """Sizes of a motion at instants (ns,), of which only those are evaluated that matter.

    `bound` (ns,): upper bounds. `some` gives the sizes at some instants; one that is not above a given value may be
    replaced by it.

    >>> size = np.array([1.0, 3.0, 2.0, 0.0, 5.0])
    >>> sizes = Sizes(size + 1.0, lambda at, least: size[at])
    >>> sizes.largest(np.array([0, 3])).tolist(), sizes.first_above(2.5), sizes.first_above(9.0)
    ([3.0, 5.0], 1, None)
    """

    bound: Array
    some: Callable[[Indices, Array], Array]

    def largest(self, starts: Indices) -> Array:
        """Largest size in each part (parts,); part k begins at starts[k] and ends before starts[k + 1], or at the end.

        A part without instants has the size at its start.
        """
        ends = np.maximum(np.append(starts[1:], self.bound.size), starts + 1)
        top = [a + int(self.bound[a:b].argmax()) for a, b in zip(starts.tolist(), ends.tolist(), strict=True)]
        found = self.some(np.array(top), np.zeros(starts.size))
        part = np.repeat(np.arange(starts.size), ends - starts)
        at = np.concatenate([np.arange(a, b) for a, b in zip(starts.tolist(), ends.tolist(), strict=True)])
        more = ~(self.bound[at] <= found[part])
        np.maximum.at(found, part[more], self.some(at[more], found[part[more]]))
        return found

    def first_above(self, limit: float) -> int | None:
        """First instant with a size above a limit."""
        at = np.flatnonzero(~(self.bound <= limit))
        above = at[self.some(at, np.full(at.size, limit)) > limit]
        return int(above[0]) if above.size else None


def sizes(rub: Rub, time: Array, q: Array, forces: Array) -> Sizes:
    """Deflections of a run; arguments as of `rim_motion`."""
    return Sizes(
        by_modes(rub, q, forces), lambda at, least: deflection(rub, time[at], q[at], forces[at], least)
    )  # fmt: skip
