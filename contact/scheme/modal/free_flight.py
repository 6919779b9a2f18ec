"""Data for skipping time without contact in a rub: maps over many steps, amplitudes by wave, least clearances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.base.remembered import remembered
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import RimTable, RubSystem
from contact.model.trig import Terms, Trig, fourier, terms
from contact.scheme.modal.coupled_flight import BITS, no_pairs, pairs_of
from contact.scheme.modal.propagator import Propagator

if TYPE_CHECKING:
    from contact.loop.rub.free_flight import FreeFlight

CELLS = 720  # of the contact angle
POINTS = 8  # where the clearance is examined in each cell


def free_flight(rub: Rub, system: RubSystem, parts: Propagator, *, skip: bool) -> FreeFlight:
    """Data for skipping; without powers if not `skip`, or if the gap does not depend on free modes and one angle alone.

    Skipping needs one tip at constant speed without whirl, closing, gravity, loads and stiffening by speed. Coupled
    modes are skipped by `coupled_flight`. A skip of single modes over k steps is the k-th power of the modal map
    (q, D) -> (q + al D - be q, al D - be q). The powers are formed in extended precision from the coefficients that the
    steps use, so that runs with and without skips differ only by round-off.
    """
    from contact.loop.rub.free_flight import FreeFlight

    m = system.omega.size
    if not (skip and _is_free(rub, system, parts)):
        return no_flight(parts)
    rows = _normal(system.rim, system.blade_rows, system.own, system.line, system.directions, m)
    floor = _floor(rub, float(system.clearance[0]))
    if parts.coupled is not None:
        waves = rows.full(2 * (int(rows.wave.max(initial=0)) // 2 + 1))
        maps, pairs = pairs_of(parts, waves[:, ::2], waves[:, 1::2])
        return no_flight(parts)._replace(powers=maps, floor=floor, pairs=pairs)
    return FreeFlight(
        powers=powers(parts.al, parts.be), fade=parts.fade, cos=np.cos(parts.turn), sin=np.sin(parts.turn),
        start=rows.start, wave=rows.wave, row=rows.value, floor=floor,
        reach=np.zeros(2 * (int(rows.wave.max(initial=0)) // 2 + 1)), taken=np.zeros(2, dtype=np.int64),
        pairs=no_pairs(),
    )  # fmt: skip


def no_flight(parts: Propagator) -> FreeFlight:
    """Data for a run without skips."""
    from contact.loop.rub.free_flight import FreeFlight

    none, whole = np.zeros(0), np.zeros(0, dtype=np.int64)
    return FreeFlight(
        powers=readonly(np.zeros((0, 4, parts.omega.size))), fade=parts.fade, cos=none, sin=none, start=whole,
        wave=whole, row=none, floor=readonly(none), reach=none, taken=np.zeros(2, dtype=np.int64), pairs=no_pairs(),
    )  # fmt: skip


def _is_free(rub: Rub, system: RubSystem, parts: Propagator) -> bool:
    still = len(np.unique(rub.speed.hz)) == len(np.unique(rub.closing.by)) == 1
    return (
        system.contacts == 1 and still and not system.load.any()
        and not (rub.whirl or rub.forces or rub.stiffening or rub.rotor)
    )  # fmt: skip


def _floor(rub: Rub, clearance: float) -> Array:
    """Least clearance in each cell of the angle; for a measured profile its overall minimum."""
    least = clearance - float(rub.closing.by[0])
    if rub.profile.theta is not None:
        return readonly(np.full(CELLS, least + rub.profile.lowest))
    return least_clearance(_clearance(least, *rub.profile.terms))


@remembered
def _clearance(least: float, *terms: tuple[int, float, float]) -> Trig:
    return fourier([(0, least, 0.0), *terms])


@remembered
def _normal(rim: RimTable, blade_rows: Array, own: Indices, line: Indices, directions: int, m: int) -> Terms:
    """Normal row of the only tip as sums of waves, one for each mode of the casing, then of its blade."""
    block, casing = int(line[0]) * directions, rim.cos.shape[2]
    cos, sin = np.zeros((2, m, rim.n_max + 1))
    cos[:casing], sin[:casing] = rim.cos[block].T, rim.sin[block].T
    cos[own[0, 0] : own[0, 1], 0] = blade_rows[0, : own[0, 1] - own[0, 0]]
    mode, n = np.nonzero((cos != 0.0) | (sin != 0.0))
    return terms(mode, n, cos[mode, n], sin[mode, n], m)


@remembered
def powers(al: Array, be: Array) -> Array:
    """Maps over 1, 2, 4, ... 2^(BITS-1) steps, (BITS, 4, m): entries 11, 12, 21, 22.

    >>> powers(np.array([1.0]), np.array([0.0]))[3, :2].ravel().tolist()
    [1.0, 8.0]
    """
    fade, stiff = al.astype(np.longdouble), be.astype(np.longdouble)
    a, b, c, d = 1 - stiff, fade, -stiff, fade
    found = np.empty((BITS, 4, al.size))
    for j in range(BITS):
        found[j] = np.array([a, b, c, d], dtype=np.float64)
        a, b, c, d = a * a + b * c, a * b + b * d, c * a + d * c, c * b + d * d
    return readonly(found)


@remembered
def least_clearance(clearance: Trig) -> Array:
    """A lower bound of the clearance in each cell of the contact angle, (CELLS,).

    Between two points h apart a function is at least the smaller of their values minus h^2 max|f''|/8.

    >>> from contact.model.trig import fourier
    >>> floor = least_clearance(fourier([(0, 1.0, 0.0), (2, 0.25, 0.0)]))
    >>> round(float(floor.min()), 6), round(float(floor.max()), 6)
    (0.75, 1.249962)
    """
    cos, sin = _waves(tuple(clearance.harmonic.tolist()))
    values = clearance.cos @ cos + clearance.sin @ sin
    bend = float(np.sum(clearance.harmonic**2 * np.hypot(clearance.cos, clearance.sin)))
    low = np.minimum(values[:-1], values[1:]).reshape(CELLS, POINTS).min(axis=1)
    return readonly(low - bend * (2.0 * np.pi / (CELLS * POINTS)) ** 2 / 8.0)


@remembered
def _waves(harmonics: tuple[int, ...]) -> tuple[Array, Array]:
    """Cosines and sines at all points of all cells, (harmonics, points) each."""
    points = CELLS * POINTS
    phases = np.multiply.outer(harmonics, 2.0 * np.pi * np.arange(points + 1) / points)
    return np.cos(phases), np.sin(phases)
