"""A rub brought to arrays: rows of the casing by harmonic, directions of the tips, residual compliance by angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, Indices
from contact.model.gaps.modal_system import NOISE
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_forces import axial_load
from contact.model.trig import harmonics


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RimTable:
    """Rows of the casing's m modes at a turning point, one for each of B = lines x directions.

    row_b,i(phi) = sum_j cos[b, j] cos(n_j phi) + sin[b, j] sin(n_j phi), j = start[i] .. start[i + 1] - 1.
    """

    start: Indices
    harmonic: Indices
    cos: Array  # (B, entries)
    sin: Array

    def by_harmonic(self, values: Array) -> Array:
        """Full tables (B, highest harmonic + 1, m) of `cos` or `sin`."""
        full = np.zeros((len(values), int(self.harmonic.max(initial=0)) + 1, self.start.size - 1))
        full[:, self.harmonic, np.repeat(np.arange(self.start.size - 1), np.diff(self.start))] = values
        return full

    def row(self, block: int, phi: float) -> Array:
        """One row at one angle, (m,): what the compiled loop is tested against."""
        values = self.cos[block] * np.cos(self.harmonic * phi) + self.sin[block] * np.sin(self.harmonic * phi)
        total = np.concatenate(([0.0], np.cumsum(values)))
        return np.asarray(total[self.start[1:]] - total[self.start[:-1]])


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RubSystem:
    """Modes of casing and blades one after the other; K tips with d directions each, normal first.

    `blade_rows` (K d, widest blade): the tip's share of its own blade's modes, as subtracted in the gap;
    `own` (K, 2): first and one past the last of these modes. Residual compliance between all K d directions
    S(angle) = sum_p S_cos[p] cos(harmonic[p] angle) + S_sin[p] sin(harmonic[p] angle), the angle all have turned.
    """

    omega: Array
    zeta: Array
    load: Array
    displacement: Array
    velocity: Array
    first: Indices
    names: tuple[str, ...]
    rim: RimTable
    directions: int  # blocks of `rim` per line
    line: Indices  # (K,)
    radius: Array  # (K,)
    angle: Array  # (K,) at t = 0
    clearance: Array  # (K,)
    blade_rows: Array
    own: Indices
    S_harmonic: Indices
    S_cos: Array  # (P, K d, K d)
    S_sin: Array

    @property
    def contacts(self) -> int:
        """Number of tips."""
        return self.angle.size

    def compliance(self, turned: float) -> Array:
        """Residual compliance when the casing has turned by this angle, (K d, K d)."""
        c, s = np.cos(self.S_harmonic * turned), np.sin(self.S_harmonic * turned)
        return np.asarray(np.tensordot(c, self.S_cos, 1) + np.tensordot(s, self.S_sin, 1))


def rub_system(rub: Rub, dimensions: int) -> RubSystem:
    """Arrays of a rub whose contacts are seen in `dimensions` (1: frictionless, else those of the rub)."""
    sizes = [body.omega.size for body in rub.bodies]
    first = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    tips = rub.tips
    own = np.array([[first[t.blade + 1], first[t.blade + 2]] for t in tips], dtype=np.int64)
    rows = np.zeros((len(tips), dimensions, max(sizes[1:])))
    for j, tip in enumerate(tips):
        body = rub.blades[tip.blade]
        rows[j, :, : body.omega.size] = -(tip.directions(body)[:dimensions] @ body.rows)
    angle = np.radians([t.angle_deg for t in tips])
    S_harmonic, S_cos, S_sin = _residual(rub, dimensions, angle)

    def joined(name: str) -> Array:
        parts = [getattr(start, name) for start in rub.starts]
        return np.concatenate([np.zeros(n) if p is None else p for p, n in zip(parts, sizes, strict=True)])

    return RubSystem(
        omega=np.concatenate([b.omega for b in rub.bodies]), zeta=np.concatenate([b.zeta for b in rub.bodies]),
        load=joined("load") + axial_load(rub), displacement=joined("displacement"), velocity=joined("velocity"),
        first=first,
        names=rub.names, rim=_rim_table(rub), directions=rub.casing.directions,
        line=np.array([t.line for t in tips], dtype=np.int64),
        radius=np.array([rub.casing.line_radius(t.line) for t in tips]), angle=angle,
        clearance=np.array([rub.clearance + t.clearance for t in tips]),
        blade_rows=np.ascontiguousarray(rows.reshape(-1, rows.shape[2])), own=own,
        S_harmonic=S_harmonic, S_cos=S_cos, S_sin=S_sin,
    )  # fmt: skip


def _rim_table(rub: Rub) -> RimTable:
    """Keep, per mode, the harmonics above the noise of an eigen solver."""
    casing, N = rub.casing, rub.casing.n_max
    m = casing.omega.size
    blocks = casing.rows.reshape(-1, 2 * N + 1, m)
    cos = blocks[:, : N + 1]
    sin = np.concatenate([np.zeros((len(blocks), 1, m)), blocks[:, N + 1 :]], axis=1)
    size = np.maximum(np.abs(cos), np.abs(sin)).max(axis=0, initial=0.0)  # (N + 1, m)
    mode, harmonic = np.nonzero(size.T > NOISE * size.max(initial=0.0))
    start = np.concatenate(([0], np.cumsum(np.bincount(mode, minlength=m))))
    return RimTable(
        start=start.astype(np.int64), harmonic=harmonic.astype(np.int64),
        cos=np.ascontiguousarray(cos[:, harmonic, mode]), sin=np.ascontiguousarray(sin[:, harmonic, mode]),
    )  # fmt: skip


def _residual(rub: Rub, d: int, angle: Array) -> tuple[Indices, Array, Array]:
    """Residual compliance of casing and blades as a polynomial of the angle turned; a perfect casing's is constant.

    All tips turn together, so B(angle) S B(angle)^T has degree 2 N: sampled and transformed, exact to round-off.
    """
    N, K = rub.casing.n_max, len(rub.tips)
    size, directions = 2 * N + 1, rub.casing.directions
    points = 4 * N + 4
    samples = np.zeros((points, K * d, K * d))
    for p in range(points):
        at = np.zeros((K * d, len(rub.casing.channels)))
        for j, tip in enumerate(rub.tips):
            h = harmonics(N, angle[j] - 2.0 * math.pi * p / points)
            for i in range(d):
                begin = (tip.line * directions + i) * size
                at[j * d + i, begin : begin + size] = h
        samples[p] = at @ rub.casing.S @ at.T
    spectrum = np.fft.rfft(samples, axis=0)[: 2 * N + 1] / points
    cos, sin = 2.0 * spectrum.real, -2.0 * spectrum.imag
    cos[0] /= 2.0
    noise = NOISE * float(np.abs(samples).max(initial=0.0))
    kept = np.flatnonzero(np.maximum(np.abs(cos), np.abs(sin)).max(axis=(1, 2), initial=0.0) > noise)
    kept = np.union1d([0], kept)
    cos[0] += _blade_residual(rub, d)
    return kept.astype(np.int64), np.ascontiguousarray(cos[kept]), np.ascontiguousarray(sin[kept])


def _blade_residual(rub: Rub, d: int) -> Array:
    """Residual compliance between tips of the same blade, (K d, K d)."""
    total = np.zeros((len(rub.tips) * d,) * 2)
    for b, blade in enumerate(rub.blades):
        here = [j for j, tip in enumerate(rub.tips) if tip.blade == b]
        if here:
            weights = np.concatenate([rub.tips[j].directions(blade)[:d] for j in here])
            place = np.concatenate([np.arange(j * d, (j + 1) * d) for j in here])
            total[np.ix_(place, place)] = weights @ blade.S @ weights.T
    return total
