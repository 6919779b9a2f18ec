"""Arrays of a rub for its compiled loop: state at t = 0, laws of time and angle, rows by blocks of waves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array, Indices, aligned, readonly
from contact.base.remembered import remembered
from contact.model.gaps.deflection import places, rim_rows
from contact.model.gaps.limits import motion_limits
from contact.model.gaps.modal_system import NOISE
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import RimTable, RubSystem, plane_participation, varying_force, waves_of_tips
from contact.model.rotor.rotor import Rotor
from contact.model.trig import PRUNE, fourier, turned_back
from contact.record.spin import SUMS
from contact.scheme.modal.blocks import BLOCK, row_blocks, rows_of_waves, whole
from contact.scheme.modal.cells import cell, cells_of_rows
from contact.scheme.modal.propagator import Propagator
from contact.scheme.modal.rub_delassus import blade_delassus, unchanging

if TYPE_CHECKING:
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.deflection import RimWaves
    from contact.loop.rub.rows import RubLaws, RubRows
    from contact.loop.rub.state import RubState, Solver, Work

FEW = 32  # directions of all tips, up to which S between them is a table by the angle
SEVERAL = 12  # tips from which waves represent an interpolated W; for fewer tips, separate rows take less time
NO_CELL = 0.0, readonly(np.zeros((0, 1, 0, 1)))


@dataclass(frozen=True, eq=False, slots=True)
class LoopArrays:
    """Arrays of the compiled loop besides the state."""

    laws: RubLaws
    rows: RubRows
    work: Work
    solver: Solver | None

    @staticmethod
    def of(
        rub: Rub, system: RubSystem, parts: Propagator, state: RubState, share: float, *, vary: bool,
        yields: bool, coupled: bool,
    ) -> LoopArrays:  # fmt: skip
        """The arrays of a rub; `share` as in `unchanging`; `vary`: the speed changes the coefficients of the modes.

        `yields`: the tips are on a coating or have a force-depth law; `coupled`: the modes are coupled.
        """
        from contact.loop.rub.state import NODES, solver_of, work_space

        W = np.zeros((0, 0)) if vary or rub.spin is not None else unchanging(rub, system, parts, share)
        fixed = not W.size and not vary and rub.spin is None
        several = fixed and (system.contacts >= SEVERAL or len(system.still) > FEW)
        rows = rub_rows(rub, system, parts, W, *(cell(rub, system, parts, share, NODES) if several else NO_CELL))
        alone = not (yields or coupled) and state.mu.size == 1 and state.lam.size < 3
        solver = None if alone else solver_of(state, yields=yields)
        return LoopArrays(rub_laws(rub, system, parts.h), rows, work_space(state, rows, newton=not alone), solver)


def rub_state(rub: Rub, system: RubSystem, parts: Propagator, mu: float, dimensions: int) -> RubState:
    """State at t = 0."""
    from contact.loop.rub.state import RubState

    K, R, m = system.contacts, system.contacts * dimensions, system.omega.size
    stiff, stiff_at = _stiffening(rub, system)
    q = system.displacement.copy()
    varying = varying_force(rub)
    body = np.zeros(0) if varying is None else varying
    loaded = parts if varying is None else replace(parts, load=parts.load + varying)  # under what pulls at t = 0

    def none(size: int) -> Array:
        return np.zeros(size)

    return RubState(
        q=q, d=loaded.backward(q, system.velocity), old=none(m), al=parts.al, be=parts.be, c=parts.c,
        kick=parts.push(parts.load), weight=parts.weight, stiff=stiff, stiff_at=stiff_at,
        push=none(m), contact=none(m), body=body, mu=np.full(K, mu), lam=none(R), strain=none(R), motion=none(R),
        scale=none(K), now=none(K),
        last=none(K), known=np.zeros(K, dtype=np.int64), inside=np.zeros(K, dtype=np.int64), free=none(K),
        test=none(K), skin=none(K), force=none(K), gap=none(K), seen=none(m + R), heat=none(K), drive=none(K),
        peaks=none(1), limits=motion_limits(float(system.radius.min()), rub.wall), counts=none(4),
    )  # fmt: skip


def _stiffening(rub: Rub, system: RubSystem) -> tuple[Array, Array]:
    """stiffness_by_speed of all blades' modes, and the same times the squared speed of each basis.

    Empty without stiffening.
    """
    if not rub.stiffening:
        return np.zeros((0, 0)), np.zeros((0, 0))
    begin = int(system.first[1])
    total = np.zeros((2, system.omega.size - begin, system.omega.size - begin))
    for stiff in rub.stiffening:
        own = slice(int(system.first[stiff.blade + 1]) - begin, int(system.first[stiff.blade + 2]) - begin)
        total[0, own, own] += stiff.stiffness_by_speed
        total[1, own, own] += (2.0 * math.pi * stiff.at_hz) ** 2 * stiff.stiffness_by_speed
    return total[0], total[1]


def rub_laws(rub: Rub, system: RubSystem, h: float) -> RubLaws:
    """Speed, closing, whirl, profile, body forces and unbalance."""
    from contact.loop.rub.rows import Pulls, RubLaws, Spin, Swing, Terms

    terms = fourier(list(rub.profile.terms))
    whirl = [[w.amplitude, w.per_rev, 2.0 * math.pi * w.hz, math.radians(w.phase_deg)] for w in rub.whirl]
    pulls = Pulls(
        laws=np.array([force.row for force in rub.forces], dtype=float).reshape(-1, 8),
        plane=plane_participation(rub), casing=int(system.first[1]),
    )  # fmt: skip
    plane = np.zeros((2, 0)) if rub.rotor is None else np.ascontiguousarray(rub.rotor.plane)
    swing = Swing(_jumps(rub.rotor, h), plane, rub.flexible)
    spin, sums = Spin(-1, 0.0, 0.0, np.zeros(3), np.zeros(0)), np.zeros(len(SUMS))
    if rub.spin is not None:
        inertia, torque = rub.spin.inertia, rub.spin.torque
        spin = Spin(int(system.first[1]) - 1, 1.0 / math.sqrt(inertia), torque, np.zeros(3), sums)
    return RubLaws(
        speed=rub.speed.table, closing=np.ascontiguousarray(np.stack([rub.closing.time, rub.closing.by], axis=1)),
        whirl=np.array(whirl, dtype=float).reshape(-1, 4), terms=Terms(terms.harmonic, terms.cos, terms.sin),
        table=rub.profile.table, lowest=rub.profile.lowest, pulls=pulls, swing=swing, spin=spin,
    )  # fmt: skip


def _jumps(rotor: Rotor | None, h: float) -> Array:
    """Jumps of a rotor's unbalance: from the start, and at its release."""
    if rotor is None or not rotor.unbalance.acts:
        return np.zeros((0, 4))
    given = rotor.unbalance
    jumps = [(-math.inf, given.before)]
    if given.release is not None:
        jumps.append((given.release.time, given.after - given.before))
    return np.array([[max(t, -1e300), 1.0 / h, U.real, U.imag] for t, U in jumps])


def rub_rows(rub: Rub, system: RubSystem, parts: Propagator, W: Array, cell: float, form: Array) -> RubRows:
    """Rows of the casing, tips and residual compliance; W, or `cell` and `form` from which it is computed."""
    from contact.loop.rub.rows import RubRows
    from contact.loop.rub.state import TERMS

    rim, m = system.rim, int(system.first[1])
    width = joined(system)
    top = max([rim.n_max, *(p for p, _, _ in rub.profile.terms)])
    size = np.hypot(rim.cos, rim.sin)[:: system.directions].sum(axis=1)
    _, place = np.unique(np.stack([system.line, system.angle], axis=1), axis=0, return_inverse=True)
    reach = aligned(len(size), whole(m))
    reach[:, : rub.flexible] = size[:, : rub.flexible]  # the motion of a rotor is known at each tip
    few = len(system.still) <= FEW and cell == 0.0
    count = whole(max(top, system.S.shape[1] // 2 if system.turns else 0) + 1)
    harmonic, S_cos, S_sin = np.zeros(0, dtype=np.int64), np.zeros((0, 0, 0)), np.zeros((0, 0, 0))
    if system.turns:
        if few:
            harmonic, S_cos, S_sin = _between_tips(system.S, system.still, system.angle, system.line)
        else:
            harmonic, S_cos, S_sin = _between_waves(system.S, count)
        count = max(count, whole(int(harmonic.max(initial=0)) + 1))
    glide = np.zeros((system.contacts, len(system.still) // system.contacts))
    glide[:, 1:2] = system.radius[:, None]
    apart = system.own if width == m else 0 * system.own
    apart.setflags(write=False)
    casing = _casing(rim, system.blade_rows, system.own, system.line, system.directions, width, count)
    return RubRows(
        casing=casing,
        width=whole(width), reach=reach, rim=rim_of(rub, len(system.still) // system.contacts, reach.shape[1]),
        many=not few, seen=_seen(rim, width, count) if not few else _no_blocks(),
        directions=system.directions, line=system.line,
        place=place.reshape(-1).astype(np.int64), glide=glide.ravel(), angle=system.angle,
        heading=np.stack([np.cos(system.angle), np.sin(system.angle)], axis=1),
        clearance=system.clearance, blade=system.blade_rows, own=system.own,
        apart=apart, fixed=fixed_delassus(system, parts),
        still=system.still, turns=system.turns, steady=False, W=W,
        cell=cell,
        form=_blocks(*_between_waves(form, count), count) if cell > 0.0 else _no_blocks(),
        cells=cells_of_rows(rub, rim, casing, parts.h, TERMS) if system.contacts == 1 else 0.0, few=few,
        S=_blocks(harmonic, S_cos, S_sin, count),
        harmonics=count,
    )  # fmt: skip


def rim_of(rub: Rub, dimensions: int, width: int) -> RimWaves:
    """Arrays for the deflection of a rim; rows have `width` entries."""
    from contact.loop.rub.deflection import RimWaves

    rim = rim_rows(rub.casing, dimensions, rub.flexible)
    lines, size, m = rim.rows.shape
    rows, reach = aligned(lines, size, width), aligned(lines, width)
    rows[:, :, :m], reach[:, :m] = rim.rows, rim.reach
    S = aligned(*rim.S.shape[:3], whole(size)) if rim.S.size else rim.S
    S[..., :size] = rim.S
    theta = places(size)
    theta = theta[: theta.size // 2]
    return RimWaves(
        reach=reach, soft=rim.soft, rows=rows, S=S, places=np.array([np.cos(theta), np.sin(theta)]),
        force=aligned(lines * dimensions, whole(size)), z=np.zeros(size), top=aligned(BLOCK),
    )  # fmt: skip


def joined(system: RubSystem) -> int:
    """Number of modes in the rows of the casing, including those of its blade for a single tip."""
    return system.omega.size if system.contacts == 1 else int(system.first[1])


@remembered
def _casing(
    rim: RimTable, blade_rows: Array, own: Indices, line: Indices, directions: int, width: int, count: int
) -> RowBlocks:
    """Rows of the casing's modes; for a single tip, also those of its blade, which do not rotate."""
    m = rim.cos.shape[2]
    cos, sin = np.zeros((2, *rim.cos.shape[:2], width))
    cos[..., :m], sin[..., :m] = rim.cos, rim.sin
    if width > m:
        begin, end = own[0]
        first = int(line[0]) * directions
        cos[first : first + len(blade_rows), 0, begin:end] = blade_rows[:, : end - begin]
    return _blocks(np.arange(rim.n_max + 1), cos, sin, count)


@remembered
def _blocks(harmonic: Indices, cos: Array, sin: Array, count: int) -> RowBlocks:
    from contact.loop.modal.rows import RowBlocks

    return RowBlocks(*row_blocks(rows_of_waves(harmonic, cos, sin, count)))


@remembered
def _seen(rim: RimTable, width: int, count: int) -> RowBlocks:
    """Waves of each row of the casing by mode, from the waves that `_casing` has."""
    from contact.loop.modal.rows import RowBlocks

    (rows, harmonics, m), even = rim.cos.shape, width + width % 2
    table = np.zeros((rows, 2, count, even))
    table[:, 0, :harmonics, :m], table[:, 1, :harmonics, :m] = rim.cos, rim.sin
    halves = table.reshape(rows, 2 * count, 2, even // 2)  # `row_blocks` takes their columns in turns
    return RowBlocks(*row_blocks(np.ascontiguousarray(halves.transpose(0, 1, 3, 2)).reshape(rows, 2 * count, even)))


def _no_blocks() -> RowBlocks:
    from contact.loop.modal.rows import RowBlocks

    none = np.zeros(0, dtype=np.int64)
    return RowBlocks(none, none, aligned(0, BLOCK), none)


def fixed_delassus(system: RubSystem, parts: Propagator) -> Array:
    """Motion of the blades due to unit forces, without a blade that the casing's rows contain."""
    found = blade_delassus(system, parts)
    return 0.0 * found if system.contacts == 1 else found


def _between_waves(S: Array, harmonics: int) -> tuple[Indices, Array, Array]:
    """Harmonics, and cos and sin as in `rows_of_waves`, of the rows of S between waves, padded to `harmonics`."""
    blocks, N = len(S), S.shape[1] // 2
    rows = np.zeros((blocks, 2 * N + 1, blocks, 2, harmonics))
    rows[..., 0, : N + 1], rows[..., 1, 1 : N + 1] = S[..., : N + 1], S[..., N + 1 :]
    rows = rows.reshape(blocks, 2 * N + 1, -1)
    sin = np.concatenate([np.zeros((blocks, 1, rows.shape[2])), rows[:, N + 1 :]], axis=1)
    return np.arange(N + 1), rows[:, : N + 1], sin


@remembered
def _between_tips(S: Array, still: Array, angle: Array, line: Indices) -> tuple[Indices, Array, Array]:
    """The d rows of S of each tip as one, polynomials of its angle in the form of `_between_waves`.

    Sampled, exact to round-off.
    """
    blocks, N, contacts = len(S), S.shape[1] // 2, angle.size
    K, points = len(still), 4 * N + 4
    phi = np.arange(points) * (2.0 * math.pi / points)
    tips = waves_of_tips(angle, line, K // contacts, S.shape[:2])
    E = turned_back(tips.reshape(K, blocks, -1), phi).reshape(points, K, -1)
    turned = E @ S.reshape(E.shape[2], -1) @ E.transpose(0, 2, 1)
    some = _products(S)
    waves = np.multiply.outer(some, phi)
    cos, sin = (np.tensordot(part, turned, axes=1) * (2.0 / points) for part in (np.cos(waves), np.sin(waves)))
    cos[some == 0] /= 2.0
    size = np.maximum(np.abs(cos), np.abs(sin)).max(axis=(1, 2))
    kept = size > NOISE * np.abs(turned).max()
    d = K // contacts
    cos, sin = (part[kept].reshape(-1, contacts, d * K).transpose(1, 0, 2) for part in (cos, sin))
    turn = np.multiply.outer(angle, some[kept])[..., None]
    c, s, least = np.cos(turn), np.sin(turn), PRUNE * np.abs(turned).max()
    cos, sin = c * cos + s * sin, s * cos - c * sin
    cos, sin = (readonly(np.where(np.abs(part) > least, part, 0.0)) for part in (cos, sin))
    some = some[kept]
    some.setflags(write=False)
    return some, cos, sin


def _products(S: Array) -> Indices:
    """Waves of the angle turned that occur in S: sums and differences of the waves that it couples."""
    N = S.shape[1] // 2
    first, second = (np.where(i > N, i - N, i) for i in np.nonzero(S.any(axis=(0, 2))))
    return np.unique(np.concatenate([first + second, np.abs(first - second)]))
