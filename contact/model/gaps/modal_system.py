"""Modal bodies and their gap in the single form that the time integration uses."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.base.remembered import remembered
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import PointGap, RotatingRim
from contact.model.trig import Terms, Trig, fourier, pruned, quadratic, terms

NOISE = 1e-10  # of the largest entry of rows or of S: smaller ones come from the eigen solver, not from the casing


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RowTable:
    """Rows that rotate with the contact point, as a sparse table.

    Q_i(phi) = sum_j q_cos[j] cos(n_j phi) + q_sin[j] sin(n_j phi), j = start[i] .. start[i+1]-1;
    T_i(phi) alike with t_cos, t_sin. A mode of a perfect casing has one entry.
    """

    start: Indices
    harmonic: Indices
    q_cos: Array
    q_sin: Array
    t_cos: Array
    t_sin: Array

    def rows(self, phi: float) -> tuple[Array, Array]:
        """Q(phi) and T(phi), (m,) each: the reference for tests of the compiled loop."""
        c, s = np.cos(self.harmonic * phi), np.sin(self.harmonic * phi)
        total = np.zeros((2, self.harmonic.size + 1))
        total[0, 1:] = np.cumsum(self.q_cos * c + self.q_sin * s)
        total[1, 1:] = np.cumsum(self.t_cos * c + self.t_sin * s)
        Q, T = total[:, self.start[1:]] - total[:, self.start[:-1]]
        return Q, T

    def rows_at(self, angles: Array) -> tuple[Array, Array]:
        """Q and T at many angles [rad], (angles, m) each."""
        phases = angles[:, None] * np.arange(int(self.harmonic.max(initial=0)) + 1)
        c, s = np.cos(phases), np.sin(phases)
        columns = ((self.q_cos, self.q_sin), (self.t_cos, self.t_sin))
        Q, T = (c @ self.by_harmonic(cos) + s @ self.by_harmonic(sin) for cos, sin in columns)
        return Q, T

    @remembered
    def terms(self) -> tuple[Terms, Terms]:
        """Q and T as sums of waves."""
        modes = self.start.size - 1
        owner = np.repeat(np.arange(modes), np.diff(self.start))
        columns = ((self.q_cos, self.q_sin), (self.t_cos, self.t_sin))
        Q, T = (terms(owner, self.harmonic, cos, sin, modes) for cos, sin in columns)
        return Q, T

    def by_harmonic(self, values: Array) -> Array:
        """One of the columns as a full table, (highest harmonic + 1, m)."""
        full = np.zeros((int(self.harmonic.max(initial=0)) + 1, self.start.size - 1))
        full[self.harmonic, np.repeat(np.arange(self.start.size - 1), np.diff(self.start))] = values
        return full


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModalSystem:
    """q'' + 2 zeta omega q' + omega^2 q = load + W^T lam, with one contact.

    Fixed point: g = clearance + Q q + S_nn lam. Rim (`table` is given, Q empty): Q, T, the residual compliances along
    the normal and the tangent and the clearance depend on phi. `radius` and `thickness` of a rim [m], 0 if unknown.
    `first` are the bodies' offsets into q.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[10.0], zeta=[0.01], channels=("x",), rows=[[2.0]], S=[[0.0]])
    >>> gap = ct.PointGap(sides=(ct.gaps.Side(body=mass, channel="x", sign=-1),), clearance=0.01)
    >>> system = ct.gaps.point_system(gap)
    >>> system.Q.tolist(), system.zeta.tolist()
    ([-2.0], [0.01])
    """

    omega: Array
    zeta: Array
    load: Array
    velocity: Array
    first: Indices
    names: tuple[str, ...]
    masses: tuple[float, ...]
    Q: Array
    clearance: Trig
    S_nn: Trig
    S_nt: Trig
    S_tt: Trig = field(default_factory=lambda: fourier([]))
    potential: float = 0.0  # at t = 0
    table: RowTable | None = None
    speed: float = 0.0
    angle: float = 0.0
    radius: float = 0.0
    thickness: float = 0.0
    displacement: Array | None = None  # at t = 0, zero where it is left out

    @property
    def compliance_turns(self) -> bool:
        """Whether the residual compliance depends on the angle."""
        return max(part.degree for part in (self.S_nn, self.S_nt, self.S_tt)) > 0

    def sums(self) -> tuple[Terms, Terms]:
        """Sums of waves of a rim: Q followed by clearance, S_nn, S_nt and S_tt; and T."""
        assert self.table is not None
        return _sums(self.table, self.clearance, self.S_nn, self.S_nt, self.S_tt)


@remembered
def _sums(table: RowTable, *parts: Trig) -> tuple[Terms, Terms]:
    owner = np.repeat(np.arange(len(parts)), [part.harmonic.size for part in parts])
    harmonic = np.concatenate([part.harmonic for part in parts])
    cos, sin = np.concatenate([part.cos for part in parts]), np.concatenate([part.sin for part in parts])
    normal, tangent = table.terms()
    return normal.followed_by(terms(owner, harmonic, cos, sin, len(parts))), tangent


def point_system(gap: PointGap) -> ModalSystem:
    """Concatenate the sides of a gap at a fixed point.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[10.0], zeta=[0.01], channels=("x",), rows=[[1.0]], S=[[0.0]])
    >>> system = point_system(ct.PointGap(sides=(ct.gaps.Side(body=mass, channel="x", sign=1),), clearance=0.01))
    >>> system.omega.tolist(), system.Q.tolist()
    ([10.0], [1.0])
    """
    sides = gap.sides
    Q = np.concatenate([side.sign * side.body.rows[side.body.channel(side.channel)] for side in sides])
    S = sum(float(s.body.S[s.body.channel(s.channel), s.body.channel(s.channel)]) for s in sides)
    sizes = [side.body.omega.size for side in sides]
    return ModalSystem(
        omega=readonly(np.concatenate([s.body.omega for s in sides])),
        zeta=readonly(np.concatenate([s.body.zeta for s in sides])),
        load=readonly(np.concatenate([_given(s.load, n) for s, n in zip(sides, sizes, strict=True)])),
        velocity=readonly(np.concatenate([_given(s.velocity, n) for s, n in zip(sides, sizes, strict=True)])),
        first=np.concatenate(([0], np.cumsum(sizes))).astype(np.int64),
        names=tuple(s.name for s in sides), masses=tuple(s.mass for s in sides), Q=readonly(Q),
        clearance=fourier([(0, gap.clearance, 0.0)]), S_nn=fourier([(0, S, 0.0)]), S_nt=fourier([]),
        potential=sum(s.potential for s in sides),
    )  # fmt: skip


def rim_system(rim: RotatingRim) -> ModalSystem:
    """Casing modes, then blade modes; the blade's rows enter as harmonic 0 with the sign of the gap."""
    still = _still_rim(rim.casing, rim.blade, rim.lean_deg)
    for name in ("velocity", "displacement"):
        sides = [(getattr(rim, f"{side}_{name}"), getattr(rim, side).omega.size) for side in ("casing", "blade")]
        if any(given is not None for given, _ in sides):
            start = readonly(np.concatenate([_given(*side) for side in sides]))
            still = replace(still, velocity=start) if name == "velocity" else replace(still, displacement=start)
    clearance, angle = _clearance(rim.clearance, *rim.terms), math.radians(rim.angle_deg)
    return replace(still, clearance=clearance, speed=rim.speed, angle=angle)


@remembered
def _still_rim(casing: ModalBody, blade: ModalBody, lean_deg: float) -> ModalSystem:
    """Part that all runs of the same bodies share: the rim at rest, round, without clearance."""
    N = casing.n_max
    size = 2 * N + 1
    a = math.radians(lean_deg)
    span, flap = blade.channel("span"), blade.channel("flap")
    normal, tangent = np.zeros(len(blade.channels)), np.zeros(len(blade.channels))
    normal[[span, flap]] = math.cos(a), math.sin(a)
    tangent[[span, flap]] = -math.sin(a), math.cos(a)
    table = _table(casing.rows[:size], casing.rows[size:], -normal @ blade.rows, -tangent @ blade.rows, N)
    nn, nt, tt = _compliances(casing)
    S_nn = _raised(nn, float(normal @ blade.S @ normal))
    S_nt = _raised(nt, float(normal @ blade.S @ tangent))
    S_tt = _raised(tt, float(tangent @ blade.S @ tangent))
    noise, none = NOISE * max(S_nn.largest, S_tt.largest), readonly(np.zeros(casing.omega.size + blade.omega.size))
    return ModalSystem(
        omega=readonly(np.concatenate([casing.omega, blade.omega])),
        zeta=readonly(np.concatenate([casing.zeta, blade.zeta])), load=none, velocity=none,
        first=np.array([0, casing.omega.size, none.size]), names=("casing", "blade"), masses=(math.nan, math.nan),
        Q=none[:0], clearance=fourier([]), S_nn=pruned(S_nn, noise), S_nt=pruned(S_nt, noise),
        S_tt=pruned(S_tt, noise), table=table, radius=casing.line_radius(0), thickness=casing.line_wall(0),
    )  # fmt: skip


@remembered
def _clearance(least: float, *terms: tuple[int, float, float]) -> Trig:
    return fourier([(0, least, 0.0), *terms])


@remembered
def _compliances(casing: ModalBody) -> tuple[Trig, Trig, Trig]:
    """S of a casing between normal and normal, normal and tangent, tangent and tangent, over the angle."""
    N = casing.n_max
    r, t = slice(0, 2 * N + 1), slice(2 * N + 1, None)
    return quadratic(casing.S[r, r], N), quadratic(casing.S[r, t], N), quadratic(casing.S[t, t], N)


def _given(values: Array | None, size: int) -> Array:
    return np.zeros(size) if values is None else values


def _raised(polynomial: Trig, constant: float) -> Trig:
    terms = zip(polynomial.harmonic, polynomial.cos, polynomial.sin, strict=True)
    return fourier([(0, constant, 0.0), *((int(n), float(c), float(s)) for n, c, s in terms)])


def _table(radial: Array, tangential: Array, blade_n: Array, blade_t: Array, N: int) -> RowTable:
    """Table of the cosines and sines of each mode that exceed the noise of an eigenvalue solver."""
    scale = max(float(np.abs(radial).max(initial=0.0)), float(np.abs(tangential).max(initial=0.0)))
    none = np.zeros((1, radial.shape[1]))
    full = [
        part for rows in (radial, tangential) for part in (rows[: N + 1], np.concatenate([none, rows[N + 1 :]]))
    ]  # q_cos, q_sin, t_cos, t_sin: (N + 1, m) each
    entry = np.array([part.T for part in full])
    entry[np.abs(entry) <= NOISE * scale] = 0.0
    mode, n = np.nonzero(entry.any(axis=0))
    count = np.bincount(mode, minlength=radial.shape[1])
    start = np.concatenate(([0], np.cumsum(np.concatenate([count, np.ones(blade_n.size)]))))
    harmonic = np.concatenate([n, np.zeros(blade_n.size)])
    still = np.zeros(blade_n.size)
    columns = [
        np.concatenate([part[mode, n], blade])
        for part, blade in zip(entry, (blade_n, still, blade_t, still), strict=True)
    ]  # fmt: skip
    return RowTable(
        start=start.astype(np.int64), harmonic=harmonic.astype(np.int64),
        q_cos=readonly(columns[0]), q_sin=readonly(columns[1]), t_cos=readonly(columns[2]),
        t_sin=readonly(columns[3]),
    )  # fmt: skip
