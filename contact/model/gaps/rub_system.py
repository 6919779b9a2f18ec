"""A rub as arrays: rows by harmonic, directions of tips, compliance by angle, gravity and whirl on modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.base.errors import InputError
from contact.base.remembered import remembered
from contact.model.bodies.body_matrices import BodyMatrices
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.body_force import BodyForce
from contact.model.gaps.modal_system import NOISE
from contact.model.gaps.rub import ContactPoint, Rub
from contact.model.trig import harmonics

SPREAD = 10.0  # degrees between the tips of a blade that still is in one place
TURN = math.sqrt(2.0)  # [rad], no part of a turn: an S that is the same after it and after its square is always so


def plane_participation(rub: Rub) -> Array:
    """Participation of all modes in a force along the casing's x and y, with the blades at t = 0, (2, m).

    Span and flap of a blade at phi with lean a are rotated by a from the radial and tangential directions:
    a_span = cos a a_r - sin a a_t, a_flap = sin a a_r + cos a a_t.
    """
    parts = [np.zeros((2, body.omega.size)) for body in rub.bodies]
    for k, body in enumerate(rub.bodies):
        if body.participation is None or not any(f.on == "both" or (f.on == "casing") == (k == 0) for f in rub.forces):
            continue
        if k == 0:
            parts[k] = np.asarray(body.participation[:2])
            continue
        phi, a = place(rub, k - 1)
        turn = np.array([[math.cos(phi), -math.sin(phi)], [math.sin(phi), math.cos(phi)]])
        lean = np.array([[math.cos(a), math.sin(a)], [-math.sin(a), math.cos(a)]])
        parts[k] = turn @ lean @ body.participation[:2]
    return np.ascontiguousarray(np.concatenate(parts, axis=1))


def axial_load(rub: Rub) -> Array:
    """Constant modal forces of loads along the axis, (m,); a blade's chord is along the axis."""
    parts = []
    for k, body in enumerate(rub.bodies):
        pull = sum(f.axial for f in rub.forces if f.on == "both" or (f.on == "casing") == (k == 0))
        has = body.participation is not None
        parts.append(pull * np.asarray(body.participation)[2] if has else np.zeros(body.omega.size))
    return np.concatenate(parts)


def place(rub: Rub, blade: int) -> tuple[float, float]:
    """Angle at t = 0 and lean of one blade [rad]; raises InputError if its tips differ in them."""
    tips = [tip for tip in rub.tips if tip.blade == blade]
    if not tips:
        raise InputError(f"forces: found no tip of blade {blade + 1}, expected at least one to give the blade's angle")
    first, leans = tips[0].angle_deg, [tip.lean_deg for tip in tips]
    away = [(tip.angle_deg - first + 180.0) % 360.0 - 180.0 for tip in tips]  # 359 and 1 degree are near each other
    if np.ptp(away) > SPREAD or np.ptp(leans) > 0.0:
        raise InputError(
            f"forces: found the tips of blade {blade + 1} over {np.ptp(away):g} degrees and leans that differ by "
            f"{np.ptp(leans):g} degrees, expected at most {SPREAD:g} degrees and one lean"
        )
    return math.radians(first + float(np.mean(away))), math.radians(leans[0])


def plane_force(forces: Sequence[BodyForce], angle: float, omega: float, slope: float, t: float) -> Array:
    """Force per mass along x and y on the casing, and on blades in axes that turn with them, (2, 2)."""
    found = np.zeros((2, 2))
    for force in forces:
        amount, radius, per_rev, in_space, rate, phase, *on = force.row
        w = in_space * omega + rate
        along, across = amount + radius * w * w, -radius * in_space * slope
        for k in (0, 1):
            beta = phase + per_rev * angle + rate * t + k * angle
            c, s = math.cos(beta), math.sin(beta)
            found[k] += on[k] * np.array([along * c - across * s, along * s + across * c])
    return found


def force_at_start(rub: Rub) -> Array:
    """Modal forces at t = 0 from loads that vary in time, (m,)."""
    casing = rub.casing.omega.size
    plane, table = plane_participation(rub), rub.speed.table
    slope = table[max(int(np.searchsorted(table[:, 0], 0.0, side="right")) - 1, 0), 3]
    on_casing, on_blades = plane_force(rub.forces, 0.0, rub.speed.omega(0.0), slope, 0.0)
    return np.concatenate([on_casing @ plane[:, :casing], on_blades @ plane[:, casing:]])


def varying_force(rub: Rub) -> Array | None:
    """Modal forces at t = 0 from varying loads, gravity, whirl and unbalance, (m,); None if there are none."""
    rotor = rub.rotor
    if rotor is None or not (rotor.unbalance.acts or rub.spin is not None):
        return force_at_start(rub) if rub.forces else None
    load = force_at_start(rub) if rub.forces else np.zeros(sum(body.omega.size for body in rub.bodies))
    table = rotor.speed.table
    slope = table[max(int(np.searchsorted(table[:, 0], 0.0, side="right")) - 1, 0), 3]
    push = rotor.unbalance.before * complex(rotor.speed.omega(0.0) ** 2, -slope)
    load[rub.flexible : rub.flexible + rotor.body.omega.size] += np.array([push.real, push.imag]) @ rotor.plane
    return load


def settled(rub: Rub) -> Rub:
    """The same rub with its bodies at rest under gravity and whirl at t = 0: q = K^-1 f.

    Raises InputError for bodies with rigid modes.

    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": np.zeros((2, 2))}
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.01], **seen)
    >>> still = settled(ct.Rub(casing, (blade,), clearance=1e-3, speed=ct.Speed.constant(5.0)))  # nothing pulls
    >>> still.casing_start.displacement.tolist()
    [0.0, 0.0]
    """
    load, first = force_at_start(rub) + axial_load(rub), 0
    speed2, starts = rub.speed.omega(0.0) ** 2, []
    stiffness = matrices_of(rub).at(rub.speed.omega(0.0))[1]
    for k, (body, start) in enumerate(zip(rub.bodies, rub.starts, strict=True)):
        here = slice(first, first + body.omega.size)
        own, K = load[here], stiffness[here, here].copy()
        first += body.omega.size
        for stiff in rub.stiffening:
            if stiff.blade == k - 1:
                K += (speed2 - (2.0 * math.pi * stiff.at_hz) ** 2) * stiff.stiffness_by_speed
        live = np.ones(own.size, dtype=bool)
        live[-1:] = k > 0 or rub.spin is None  # the angle of a rotor has no rest
        if own[live].any() and not body.omega[live].min() > 0.0:
            raise InputError(f"{rub.names[k]}: found rigid modes under gravity or whirl, expected a supported body")
        at = np.zeros(own.size)
        if own[live].any():
            at[live] = np.linalg.solve(K[np.ix_(live, live)], own[live])
        starts.append(replace(start, displacement=readonly(at)))
    return replace(rub, casing_start=starts[0], blade_starts=tuple(starts[1:]))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RimTable:
    """Rows of the casing's m modes at a rotating point, one for each of B = lines x directions.

    row_b,i(phi) = sum_n cos[b, n, i] cos(n phi) + sin[b, n, i] sin(n phi).
    """

    cos: Array  # (B, highest harmonic + 1, m)
    sin: Array

    @property
    def n_max(self) -> int:
        """Highest harmonic."""
        return int(self.cos.shape[1]) - 1

    def rows(self, blocks: Indices | int, phi: Array | float) -> Array:
        """Some rows at some angles, (blocks, angles, m); the reference for tests of the compiled loop."""
        phases = np.multiply.outer(phi, np.arange(self.n_max + 1))
        return np.asarray(np.cos(phases) @ self.cos[blocks] + np.sin(phases) @ self.sin[blocks])


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RubSystem:
    """Modes of casing and blades one after the other; K tips with d directions each, normal first.

    `blade_rows` (K d, most modes of a blade): rows of the tip on its own blade's modes, which the gap subtracts; `own`
    (K, 2): first and one past the last of these modes. Residual compliance between all K d directions is E(angle) S
    E(angle)^T + still, with the common angle of rotation and the waves E at the tips. If it does not depend on the
    angle, S is empty and all of it is in `still`.
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
    matrices: BodyMatrices
    S: Array  # (lines d, 2 N + 1) twice, of the casing's lines, directions and waves 1, cos .. cos N, sin .. sin N
    still: Array  # (K d, K d)

    @property
    def contacts(self) -> int:
        """Number of tips."""
        return self.angle.size

    @property
    def turns(self) -> bool:
        """Whether the residual compliance depends on the angle."""
        return self.S.size > 0

    def compliance(self, turned: float) -> Array:
        """Residual compliance when the casing has turned by this angle, (K d, K d)."""
        if not self.turns:
            return self.still
        E = waves_of_tips(self.angle - turned, self.line, len(self.blade_rows) // self.contacts, self.S.shape[:2])
        return np.asarray(E @ self.S.reshape(E.shape[1], -1) @ E.T + self.still)


def rub_system(rub: Rub, dimensions: int) -> RubSystem:
    """Arrays of a rub whose contacts have `dimensions` directions (1: frictionless, else those of the rub)."""
    still = _still_rub(rub.casing, rub.blades, rub.tips, dimensions)
    none, sizes = still.load, np.diff(still.first)

    def joined(name: str) -> Array:
        parts = [getattr(start, name) for start in rub.starts]
        if all(part is None for part in parts):
            return none
        return readonly(np.concatenate([np.zeros(n) if p is None else p for p, n in zip(parts, sizes, strict=True)]))

    load = joined("load")
    return replace(
        still, load=readonly(load + axial_load(rub)) if rub.forces else load, displacement=joined("displacement"),
        velocity=joined("velocity"), names=rub.names, matrices=matrices_of(rub),
        clearance=rub.clearance + still.clearance,
    )  # fmt: skip


@remembered
def _still_rub(
    casing: ModalBody, blades: tuple[ModalBody, ...], tips: tuple[ContactPoint, ...], dimensions: int
) -> RubSystem:
    """Part that all runs of the same bodies share: at rest, round, with only the clearances of the tips."""
    bodies = (casing, *blades)
    sizes = [body.omega.size for body in bodies]
    first = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    own = np.array([[first[t.blade + 1], first[t.blade + 2]] for t in tips], dtype=np.int64)
    rows = np.zeros((len(tips), dimensions, max(sizes[1:])))
    along = [tip.directions(blades[tip.blade])[:dimensions] for tip in tips]
    for j, tip in enumerate(tips):
        body = blades[tip.blade]
        rows[j, :, : body.omega.size] = -(along[j] @ body.rows)
    angle, none = readonly(np.radians([t.angle_deg for t in tips])), readonly(np.zeros(first[-1]))
    line = np.array([t.line for t in tips], dtype=np.int64)
    for whole in (line, own, first):
        whole.setflags(write=False)
    S, still = _residual(casing, blades, tips, along, angle)
    return RubSystem(
        omega=readonly(np.concatenate([b.omega for b in bodies])),
        zeta=readonly(np.concatenate([b.zeta for b in bodies])), load=none, displacement=none, velocity=none,
        first=first, matrices=BodyMatrices(bodies=bodies, senses=(0,) * len(bodies)), names=(),
        rim=_rim_table(casing), directions=casing.directions, line=line,
        radius=readonly([casing.line_radius(t.line) for t in tips]), angle=angle,
        clearance=readonly([t.clearance for t in tips]), own=own,
        blade_rows=readonly(rows.reshape(len(tips) * dimensions, rows.shape[2])),
        S=readonly(S), still=readonly(still),
    )  # fmt: skip


def matrices_of(rub: Rub) -> BodyMatrices:
    """C and K of the bodies by the speed of the side that rotates; blades rotate in the opposite sense."""
    given = {stiff.blade for stiff in rub.stiffening}
    blades = [
        replace(body, stiffness_by_speed=None, stiffness_higher=None) if k in given else body
        for k, body in enumerate(rub.blades)
    ]
    casing, others = (1, 0) if rub.turning == "casing" else (0, -1)
    casing = casing if rub.rotor is None else others
    return BodyMatrices(bodies=(rub.casing, *blades), senses=(casing, *(others for _ in blades)))


def _rim_table(casing: ModalBody) -> RimTable:
    """Table of the harmonics of each mode that exceed the noise of an eigenvalue solver."""
    N = casing.n_max
    m = casing.omega.size
    blocks = casing.rows.reshape(-1, 2 * N + 1, m)
    cos = blocks[:, : N + 1]
    sin = np.concatenate([np.zeros((len(blocks), 1, m)), blocks[:, N + 1 :]], axis=1)
    size = np.maximum(np.abs(cos), np.abs(sin)).max(axis=0, initial=0.0)  # (N + 1, m)
    kept = size > NOISE * size.max(initial=0.0)
    top = int(np.flatnonzero(kept.any(axis=1)).max(initial=0)) + 1
    cos, sin = (readonly(np.where(kept, part, 0.0)[:, :top]) for part in (cos, sin))
    return RimTable(cos=cos, sin=sin)


def _residual(
    casing: ModalBody, blades: Sequence[ModalBody], tips: Sequence[ContactPoint], along: Sequence[Array], angle: Array
) -> tuple[Array, Array]:
    """`S` and `still` of a rub's system; `along`: the directions of each tip over the channels of its blade."""
    size, d = 2 * casing.n_max + 1, len(along[0])
    blocks = [line * casing.directions + i for line in range(casing.rim_lines) for i in range(d)]
    full = casing.S.reshape(-1, size, casing.directions * casing.rim_lines, size)
    S = full[blocks][:, :, blocks]
    S = np.where(np.abs(S) > NOISE * np.abs(S).max(initial=0.0), S, 0.0)
    still, line = _blade_residual(blades, tips, along), np.array([t.line for t in tips], dtype=np.int64)
    if _turned(S, TURN, d, line) or _turned(S, TURN * TURN, d, line):
        return S, still
    E = waves_of_tips(angle, line, d, S.shape[:2])
    return np.zeros((0, 0, 0, 0)), E @ S.reshape(E.shape[1], -1) @ E.T + still


def waves_of_tips(angle: Array, line: Indices, d: int, shape: tuple[int, ...]) -> Array:
    """Waves at tips on lines of the casing, (K d, lines d (2 N + 1)): 1, cos .. cos N, sin ..

    sin N in each tip's block.
    """
    h = harmonics(shape[1] // 2, angle)
    E = np.zeros((angle.size, d, *shape))
    for i in range(d):
        E[np.arange(angle.size), i, line * d + i] = h
    return E.reshape(angle.size * d, -1)


def _turned(S: Array, by: float, d: int, line: Indices) -> bool:
    """Whether rotation of the casing by this angle changes the residual compliance on the lines of the tips."""
    N = S.shape[1] // 2
    n = np.arange(1, N + 1)
    R = np.eye(2 * N + 1)
    R[n, n] = R[N + n, N + n] = np.cos(n * by)
    R[n, N + n], R[N + n, n] = np.sin(n * by), -np.sin(n * by)
    blocks = np.unique(np.concatenate([line * d + i for i in range(d)]))
    seen = S[blocks][:, :, blocks]
    return bool(
        np.abs(np.einsum("wu,aubv,xv->awbx", R, seen, R, optimize=True) - seen).max()
        > NOISE * seen.max(initial=0.0)  # on the diagonal of a compliance, as no other entry is larger
    )


def _blade_residual(blades: Sequence[ModalBody], tips: Sequence[ContactPoint], along: Sequence[Array]) -> Array:
    """Residual compliance between tips of the same blade, (K d, K d)."""
    d, K = len(along[0]), len(along)
    total = np.zeros((K * d, K * d))
    own: dict[int, list[int]] = {}
    for j, tip in enumerate(tips):
        own.setdefault(tip.blade, []).append(j)
    for blade, here in own.items():
        weights = np.concatenate([along[j] for j in here])
        place = (d * np.array(here)[:, None] + np.arange(d)).ravel()
        total[np.ix_(place, place)] = weights @ blades[blade].S @ weights.T
    return total
