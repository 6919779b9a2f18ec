"""Sizes of cells of angle for interpolation of the contact matrix, and for power series of a single tip's rows.

See `contact.loop.rub.matrix` and `contact.loop.rub.series`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import RimTable, RubSystem, waves_of_tips
from contact.model.trig import turned_back
from contact.scheme.modal.propagator import Propagator
from contact.scheme.modal.rub_delassus import blade_delassus

if TYPE_CHECKING:
    from contact.loop.modal.rows import RowBlocks

EXACT = 1e-15  # of the largest entry of W, or of the rows: largest error of interpolation, or of a series
LEAST = 24  # steps in a cell: in fewer, W at the nodes takes more time than W at each step
STAY = 40  # steps in a cell of rows: in fewer, a series takes more time than the sums of waves
MOST = 1 << 20  # numbers at the nodes: more do not fit into the cache


def cell(rub: Rub, system: RubSystem, parts: Propagator, share: float, nodes: int) -> tuple[float, Array]:
    """Width [rad] of a cell in which interpolation of W has an error below `EXACT`, and W between waves.

    0 if it is too small.

    W(phi) is a sum of waves of the angle turned. With Chebyshev points in a cell of width D, the interpolation error of
    a wave p of amplitude A is at most A (p D/2)^n / (2^(n - 1) n!) (n nodes; Trefethen, Approximation Theory and
    Approximation Practice, 2013, ch. 8). `share` as in `unchanging`.
    """
    R, none = len(system.still), np.zeros((0, 1, 0, 1))
    if R * R * nodes > MOST or len(np.unique(rub.speed.hz)) > 1:
        return 0.0, none
    turn = rub.speed.omega(0.0) * parts.h
    form = _form(system, parts, share, turn)
    tips = waves_of_tips(system.angle, system.line, R // system.contacts, form.shape[:2])
    first = tips @ form.reshape(tips.shape[1], -1) @ tips.T + blade_delassus(system, parts)
    allowed = EXACT * float(np.abs(first).max()) * 2.0 ** (nodes - 1) * math.factorial(nodes)
    p, size = _waves(form)
    rough = float(size @ (0.5 * p) ** nodes)
    width = (allowed / rough) ** (1.0 / nodes) if rough > 0.0 else 2.0 * math.pi
    return (width, form) if width >= LEAST * abs(turn) else (0.0, none)


def cells_of_rows(rub: Rub, rim: RimTable, casing: RowBlocks, h: float, terms: int) -> float:
    """Cells per radian in which rows of a single tip are power series; 0 if sums of waves take less time.

    The remainder of a wave n of amplitude A is at most A (n D/2)^terms / terms! in a cell of width D (Taylor).
    """
    vectors = casing.start.size - 1
    size = np.hypot(rim.cos, rim.sin).max(axis=(0, 2))
    rough = float(size @ (0.5 * np.arange(size.size)) ** terms) / math.factorial(terms)
    if rough == 0.0 or casing.wave.size < 2 * terms * vectors:
        return 0.0
    cells = (rough / (EXACT * float(size.max()))) ** (1.0 / terms)
    return cells if STAY * cells * rub.speed.fastest * h <= 1.0 else 0.0


def _form(system: RubSystem, parts: Propagator, share: float, turn: float) -> Array:
    """Response of the casing's modes and residual compliance between waves at t_n, (lines d, 2 N + 1) twice.

    Normal rows are those at t_{n+1}, `turn` further.
    """
    rim, d, N = system.rim, len(system.still) // system.contacts, system.rim.n_max
    lines = len(rim.cos) // system.directions
    blocks = [line * system.directions + i for line in range(lines) for i in range(d)]
    size = max(N, system.S.shape[1] // 2 if system.turns else 0)
    rows = np.zeros((len(blocks), 2 * size + 1, parts.c.size))
    modes = rim.cos.shape[2]
    rows[:, : N + 1, :modes], rows[:, size + 1 : size + N + 1, :modes] = rim.cos[blocks], rim.sin[blocks, 1:]
    law = rows.copy()
    # coefficients turn against their waves
    law[::d] = share * turned_back(law[::d].transpose(0, 2, 1), np.array([-turn]))[0].transpose(0, 2, 1)
    flat = rows.reshape(-1, parts.c.size)
    form: Array = (parts.yields(law.reshape(flat.shape)) @ flat.T).reshape(2 * (len(blocks), 2 * size + 1))
    if system.turns:
        M = system.S.shape[1] // 2
        at = np.concatenate([np.arange(M + 1), size + 1 + np.arange(M)])
        form[:, at[:, None, None], :, at] += system.S.transpose(1, 3, 0, 2)[:, None]
    return form


def _waves(form: Array) -> tuple[Array, Array]:
    """Waves p of the angle turned in the product of waves at any two tips, and bounds of their amplitudes."""
    N = form.shape[1] // 2
    full = np.zeros((2, 2, len(form), N + 1, len(form), N + 1))
    for i, rows in enumerate((slice(0, N + 1), slice(N + 1, None))):
        for k, columns in enumerate((slice(0, N + 1), slice(N + 1, None))):
            full[i, k][:, i:, :, k:] = form[:, rows, :, columns]
    (cc, cs), (sc, ss) = full
    apart, joined = (np.hypot(cc + s * ss, sc - s * cs).max(axis=(0, 2)) / 2.0 for s in (1.0, -1.0))
    n = np.arange(N + 1)
    p = np.concatenate([np.abs(n[:, None] - n).ravel(), (n[:, None] + n).ravel()])
    return p.astype(float), np.concatenate([apart.ravel(), joined.ravel()])
