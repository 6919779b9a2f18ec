"""Modes of the bodies of a rub: to which body each belongs, its nodal diameters, its number in its body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.base.remembered import remembered
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import ContactPoint

EVEN = 1e-6  # of a turn


class Groups(NamedTuple):
    """Group number of each mode (m,); body and nodal diameters of each group."""

    of: Indices
    named: tuple[tuple[str, int | None], ...]


class Parts(NamedTuple):
    """Frequencies [rad/s], groups, and numbers of the modes in their bodies from 1 on, (m,)."""

    omega: Array
    groups: Groups
    number: Indices


@remembered
def parts_of(bodies: tuple[ModalBody, ...], tips: tuple[ContactPoint, ...], flexible: int) -> Parts:
    """Part that all runs of the same bodies share; modes of the first body from `flexible` on are those of a rotor."""
    omega = readonly(np.concatenate([body.omega for body in bodies]))
    return Parts(omega, groups_of(bodies, tips, flexible), mode_numbers(bodies))


def mode_numbers(bodies: Sequence[ModalBody]) -> Indices:
    """Number of each mode in its body, from 1 on, (m,)."""
    return np.concatenate([np.arange(1, body.omega.size + 1) for body in bodies])


def largest_mode(number: Indices, energy: Array) -> int:
    """The mode number with most energy; equal numbers of several bodies, such as blades, are added.

    >>> largest_mode(np.array([1, 2, 1, 2]), np.array([3.0, 2.0, 0.0, 2.0]))
    2
    """
    return int(np.bincount(number, weights=energy).argmax())


def groups_of(bodies: Sequence[ModalBody], tips: Sequence[ContactPoint], flexible: int | None = None) -> Groups:
    """Modes by body and nodal diameters: the harmonic with most motion of a rim, or of tips evenly spaced around."""
    casing, *blades = bodies
    keys: list[tuple[str, int | None]] = [("casing", int(n)) for n in casing_diameters(casing)[:flexible]]
    keys += [("rotor", None)] * (casing.omega.size - len(keys))
    for b, body in enumerate(blades):
        keys += [("blades", n) for n in blade_diameters(body, [tip for tip in tips if tip.blade == b])]
    named = tuple(dict.fromkeys(keys))
    number = {key: k for k, key in enumerate(named)}
    return Groups(np.array([number[key] for key in keys], dtype=np.int64), named)


def casing_diameters(body: ModalBody) -> Indices:
    """Nodal diameters of a rim's modes, (m,): the harmonic with the largest square over all directions and lines."""
    N = body.n_max
    rows = body.rows.reshape(-1, 2 * N + 1, body.omega.size)
    power = np.sum(rows[:, : N + 1] ** 2, axis=0)
    power[1:] += np.sum(rows[:, N + 1 :] ** 2, axis=0)
    return np.asarray(power.argmax(axis=0))


def blade_diameters(body: ModalBody, tips: Sequence[ContactPoint]) -> list[int | None]:
    """Nodal diameters of the modes of one body with several tips evenly around; None for each other mode."""
    tips = sorted(tips, key=lambda tip: tip.angle_deg % 360.0)
    K = len(tips)
    turned = np.diff([tip.angle_deg % 360.0 for tip in tips]) / 360.0
    if K < 3 or np.abs(turned - 1.0 / K).max() > EVEN:
        return [None] * body.omega.size
    rows = np.array([tip.directions(body)[:2] @ body.rows for tip in tips])  # (K, 2, m)
    power = np.sum(np.abs(np.fft.rfft(rows, axis=0)) ** 2, axis=1)
    return [int(n) for n in power.argmax(axis=0)]
