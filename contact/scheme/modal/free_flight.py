"""Free flight of a rim: what skipping it needs.

A skip over k steps is the k-th power of the modal map (q, D) -> (q + al D - be q, al D - be q). The powers are formed
in extended precision from the very coefficients that the steps use, so that a run with skips and a run without differ
by the round-off of the steps alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.remembered import remembered
from contact.model.gaps.modal_system import ModalSystem
from contact.model.trig import Terms, Trig
from contact.scheme.modal.propagator import Propagator

if TYPE_CHECKING:
    from contact.loop.modal.free_flight import FreeFlight

BITS = 24  # a skip is shorter than 2^BITS steps
CELLS = 720  # of the contact angle
POINTS = 8  # where the clearance is looked at in each cell


def rim_free_flight(system: ModalSystem, parts: Propagator, normal: Terms, *, skip: bool) -> FreeFlight:
    """Powers (none, so nothing is skipped, unless `skip`), amplitudes (those of `normal`) and clearances of a rim."""
    from contact.loop.modal.free_flight import FreeFlight

    m = system.omega.size
    rows = normal.first(m)
    return FreeFlight(
        powers=powers(parts.al, parts.be) if skip else readonly(np.zeros((0, 4, m))), fade=parts.fade,
        cos=np.cos(parts.turn), sin=np.sin(parts.turn), start=rows.start, wave=rows.wave,
        row=rows.value, floor=least_clearance(system.clearance),
        reach=np.zeros(2 * (int(rows.wave.max(initial=0)) // 2 + 1)), taken=np.zeros(2, dtype=np.int64),
    )  # fmt: skip


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

    Between two points h apart a function lies above the lower one by no less than -h^2 max|f''|/8.

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
