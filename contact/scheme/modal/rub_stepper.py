"""A rub in progress: its arrays for the compiled loop, its limits, and how to read it; see `loop.rub`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, Indices, aligned, readonly
from contact.base.errors import LimitError
from contact.io.trust import Flag
from contact.model.gaps.limits import REACHED, RIM, motion_limits, wall_flags
from contact.model.gaps.modal_system import NOISE
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import RubSystem, force_at_start, plane_participation, waves_of_tips
from contact.model.law import Law
from contact.model.trig import PRUNE, fourier, harmonics, turned_back
from contact.record.energy import Stored
from contact.record.record import Samples, tally
from contact.record.wear import Wear
from contact.scheme.modal.at_speeds import AtSpeeds
from contact.scheme.modal.blocks import OF_MODES, narrowed, row_blocks, rows_of_waves, whole, widened
from contact.scheme.modal.gives_way import memory_of, stored_by, too_long, yielding_of
from contact.scheme.modal.modal_blocks import fill_blocks, modal_blocks
from contact.scheme.modal.propagator import ExactRun, Propagator
from contact.scheme.modal.wear_track import Tracks, rub_tracks
from contact.scheme.protocol import Block, Motion, Notes
from contact.solver.friction.inexact import inexact

if TYPE_CHECKING:
    from contact.loop.rub.rows import RubLaws, RubRows
    from contact.loop.rub.state import ModalBlocks, RubState, Work
    from contact.solver.abradable.tips import Coats
    from contact.solver.yielding.yields import Yielding

FEW = 32  # directions of all tips, up to which S between them is a table by the angle
ANGLES = 60  # where the Delassus numbers are sampled around the rim
NAMES = (*OF_MODES, "contact")  # arrays over the modes that loops take in whole blocks


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RubStepper(ExactRun):
    """State of a rub; `state.counts` tells the solver's iterations, `state.heat` what slip dissipated."""

    rub: Rub
    system: RubSystem
    speeds: AtSpeeds
    coupled: ModalBlocks | None
    values: tuple[Array, ...]  # of the blocks at the nodes of the speeds; none where they do not vary
    state: RubState  # views of `wide`
    wide: RubState  # in whole blocks of eight
    laws: RubLaws
    rows: RubRows
    work: Work
    dimensions: int
    averaged: bool
    steps: Indices  # taken so far, one entry
    stretch: Indices  # number of the stretch whose coefficients the loop has, one entry
    law: Law
    stiffest: float  # Delassus number [m/N] of a normal with itself, the largest around
    y: Yielding | None = None
    worn: tuple[Tracks, Coats] | None = None
    given: list[Any] = field(default_factory=list)  # what the loop takes, bundled once: a coating's runs are short

    @property
    def size(self) -> int:
        """Number of modes, and of forces on the tips."""
        return self.state.seen.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first and one past the last mode of each body, then the forces on the tips."""
        first = self.system.first.tolist()
        return (*zip(self.system.names, first[:-1], first[1:], strict=True), ("tips", first[-1], self.size))

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        if self.worn is None:
            failed = self._some(None, out, first, steps)
        else:
            tracks, coats = self.worn
            failed = tracks.watch(self.dt, first, steps, lambda start, count: self._some(coats, out, start, count))
        self.steps[0] = first + steps if failed < 0 else failed
        return failed

    def _some(self, coats: Coats | None, out: Samples, first: int, steps: int) -> int:
        from contact.jit.bundle import bundled
        from contact.loop.rub.rub import advance_rub

        if not self.given:
            parts = (self.wide, self.laws, self.rows, coats, self.y, self.coupled, self.work, self.sums)
            self.given.extend(map(bundled, parts))
        state, laws, rows, coating, y, coupled, work, sums = self.given
        failed, at, end = -1, first, first + steps
        while failed < 0 and (at < end or at == first):
            count = end - at
            if self.values:
                self._turn(at // self.speeds.stretch)
                count = min(count, self.speeds.stretch - at % self.speeds.stretch)
            failed = advance_rub(
                state, laws, rows, coating, y, coupled, work, self.dimensions, self.averaged, sums, out, self.dt, at,
                count,
            )  # fmt: skip
            at += max(count, 1)
        self.work.room.otherwise.pass_on()
        return failed

    def _turn(self, stretch: int) -> None:
        """Give the loop the coefficients of a stretch of steps; the change of the modes' energy is the drive's work."""
        assert self.coupled is not None
        if stretch == self.stretch[0]:
            return
        before, after, s = self.now(), self.speeds.at(self.omega(stretch)), self.state
        self.sums.external[0] += _discrete(after, s.q, s.d) - _discrete(before, s.q, s.d)
        self.stretch[0] = stretch
        fill_blocks(self.coupled, self.speeds.weights(self.omega(stretch)), self.values)
        s.kick[:] = after.push(after.load)
        self.rows.fixed[:] = _fixed(self.system, after)

    def omega(self, stretch: int) -> float:
        """Speed in the middle of a stretch of steps [rad/s]."""
        return self.rub.speed.omega(self.speeds.middle(stretch))

    def now(self) -> Propagator:
        """Coefficients that the loop has."""
        return self.speeds.at(self.omega(int(self.stretch[0]))) if self.speeds.vary else self.parts

    def wear(self) -> tuple[Wear, ...]:
        """What each track of a coating has lost so far; none without one."""
        return () if self.worn is None else self.worn[0].wear()

    @property
    def memory(self) -> tuple[Any, ...]:
        """State, work arrays, sums and the coating."""
        coating = () if self.worn is None else (self.worn[0].memory, self.worn[1])
        coupled = () if self.coupled is None else self.coupled
        return (
            self.wide, self.work, self.rows, self.sums, self.steps, self.stretch, coupled, coating, memory_of(self.y)
        )  # fmt: skip

    @property
    def limits(self) -> Array:
        """Those of `motion_limits`."""
        return self.state.limits

    @property
    def overlap(self) -> float:
        """How far a tip stands inside the rim at t = 0 at most [m]."""
        rub, system, q = self.rub, self.system, self.system.displacement
        gap = system.clearance - rub.closing.at(0.0) + [rub.profile(float(phi)) for phi in system.angle]
        for w in rub.whirl:
            gap += w.amplitude * np.cos(system.angle - math.radians(w.phase_deg))
        for j, (begin, end) in enumerate(system.own if q.any() else ()):
            row = system.rim.rows(int(system.line[j]) * system.directions, float(system.angle[j]))
            gap[j] += row @ q[: row.size] + system.blade_rows[j * self.dimensions, : end - begin] @ q[begin:end]
        return max(0.0, -float(gap.min()))

    def why(self) -> Flag:
        """Explain a failed step."""
        if not (np.isfinite(self.state.q).all() and np.isfinite(self.state.d).all()):
            return Flag("the motion is not a number", "motion-overflow", failed=True)
        words = "no forces found that obey Coulomb's law at every tip: a tip digs in, or reduce dt or mu"
        return Flag(words, "unconverged", failed=True)

    def stored(self) -> Stored:
        """Energy now; what S stores counts as residual, and what bends a coating or a surface with a law."""
        s = self.state
        turned = self.rub.speed.angle((int(self.steps[0]) - 1) * self.dt)
        residual = 0.5 * float(s.lam @ self.system.compliance(turned) @ s.lam)
        residual += stored_by(self.law, self.y) + (0.0 if self.worn is None else self.worn[0].elastic)
        return self.now().stored(s.q, s.d, s.contact + s.push + (s.body if s.body.size else 0.0), residual, 0.0)

    def motions(self) -> tuple[Motion, ...]:
        """Supported bodies have no rigid motion."""
        nan = math.nan
        kinds = ("casing", *("blade",) * len(self.rub.blades))
        return tuple(Motion(kind=k, number=b, mean_velocity=nan, momentum=nan) for b, k in enumerate(kinds))

    def notes(self) -> Notes:
        """Heat and drive of friction, and what the run went through that its theory does not carry."""
        deflection, tangential = float(self.limits[REACHED + RIM]), float(self.state.peaks[0])
        flags = (*wall_flags(deflection, self.rub.wall), *_flags(self.rub, self.system, tangential))
        flags += (*inexact(float(self.work.room.left[0])), *too_long(self.y, self.stiffest, self.dt))
        return Notes(flags=flags, heat=readonly(self.state.heat), drive=readonly(self.state.drive))


def rub_stepper(rub: Rub, system: RubSystem, speeds: AtSpeeds, *, law: Law, dimensions: int, averaged: bool,
                label: str, stiffest: float = 0.0) -> RubStepper:  # fmt: skip
    """Stepper at t = 0; without friction only the normal rows take part. Raises as `rub_tracks` and `yielding_of`."""
    from contact.loop.rub.state import work_space

    parts = speeds.at(rub.speed.omega(speeds.middle(0)))
    m, rows = system.omega.size, _rows(rub, system, parts)
    blocks, values = modal_blocks(speeds, m, _joined(system))
    if blocks is not None and speeds.vary:
        fill_blocks(blocks, speeds.weights(rub.speed.omega(speeds.middle(0))), values)
    wide = widened(_state(rub, system, parts, law.mu, dimensions), whole(m), NAMES)
    return RubStepper(
        rub=rub, system=system, parts=parts, speeds=speeds, coupled=blocks, values=values if speeds.vary else (),
        state=narrowed(wide, m, NAMES), wide=wide, laws=_laws(rub, system),
        rows=rows, work=work_space(wide, rows), dimensions=dimensions, averaged=averaged,
        sums=tally(system.contacts), label=label, steps=np.zeros(1, dtype=np.int64),
        stretch=np.zeros(1, dtype=np.int64),
        worn=None if law.coating is None else rub_tracks(rub, law.coating), law=law, stiffest=stiffest,
        y=yielding_of(law, system.clearance, system.clearance),
    )  # fmt: skip


def _discrete(parts: Propagator, q: Array, d: Array) -> float:
    """Discrete energy of the coupled modes."""
    assert parts.coupled is not None
    return parts.coupled.discrete(q[parts.coupled.modes], d[parts.coupled.modes])


def _state(rub: Rub, system: RubSystem, parts: Propagator, mu: float, dimensions: int) -> RubState:
    from contact.loop.rub.state import RubState

    K, R, m = system.contacts, system.contacts * dimensions, system.omega.size
    stiff, stiff_at = _stiffening(rub, system)
    q = system.displacement.copy()
    body = force_at_start(rub) if rub.forces else np.zeros(0)
    loaded = replace(parts, load=parts.load + body) if rub.forces else parts  # under what pulls at t = 0

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
    """stiffness_by_speed of all blades' modes, plain and times the squared speed of each basis; empty without any."""
    if not rub.stiffening:
        return np.zeros((0, 0)), np.zeros((0, 0))
    begin = int(system.first[1])
    total = np.zeros((2, system.omega.size - begin, system.omega.size - begin))
    for stiff in rub.stiffening:
        own = slice(int(system.first[stiff.blade + 1]) - begin, int(system.first[stiff.blade + 2]) - begin)
        total[0, own, own] += stiff.stiffness_by_speed
        total[1, own, own] += (2.0 * math.pi * stiff.at_hz) ** 2 * stiff.stiffness_by_speed
    return total[0], total[1]


def _laws(rub: Rub, system: RubSystem) -> RubLaws:
    from contact.loop.rub.rows import Pulls, RubLaws, Terms

    terms = fourier(list(rub.profile.terms))
    whirl = [[w.amplitude, w.per_rev, 2.0 * math.pi * w.hz, math.radians(w.phase_deg)] for w in rub.whirl]
    pulls = Pulls(
        laws=np.array([force.row for force in rub.forces], dtype=float).reshape(-1, 8),
        plane=plane_participation(rub), casing=int(system.first[1]),
    )  # fmt: skip
    return RubLaws(
        speed=rub.speed.table, closing=np.ascontiguousarray(np.stack([rub.closing.time, rub.closing.by], axis=1)),
        whirl=np.array(whirl, dtype=float).reshape(-1, 4), terms=Terms(terms.harmonic, terms.cos, terms.sin),
        table=rub.profile.table, lowest=rub.profile.lowest, pulls=pulls,
    )  # fmt: skip


def _rows(rub: Rub, system: RubSystem, parts: Propagator) -> RubRows:
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.rows import RubRows

    rim, m = system.rim, int(system.first[1])
    width = _joined(system)
    cos, sin = np.zeros((2, *rim.cos.shape[:2], width))
    cos[..., :m], sin[..., :m] = rim.cos, rim.sin
    if width > m:
        begin, end = system.own[0]
        cos[_of_line(system), 0, begin:end] = system.blade_rows[:, : end - begin]
    top = max([rim.n_max, *(p for p, _, _ in rub.profile.terms)])
    size = np.hypot(rim.cos, rim.sin)[:: system.directions].sum(axis=1)
    _, place = np.unique(np.stack([system.line, system.angle], axis=1), axis=0, return_inverse=True)
    reach = aligned(len(size), whole(m))
    reach[:, :m] = size
    few, count = len(system.still) <= FEW, whole(max(top, system.S.shape[1] // 2 if system.turns else 0) + 1)
    harmonic, S_cos, S_sin = np.zeros(0, dtype=np.int64), np.zeros((0, 0, 0)), np.zeros((0, 0, 0))
    if system.turns:
        harmonic, S_cos, S_sin = _between_tips(system) if few else _between_waves(system.S, count)
        count = max(count, whole(int(harmonic.max(initial=0)) + 1))
    S = rows_of_waves(harmonic, S_cos, S_sin, count)
    return RubRows(
        casing=RowBlocks(*row_blocks(rows_of_waves(np.arange(rim.n_max + 1), cos, sin, count))),
        width=whole(width), reach=reach, directions=system.directions, line=system.line,
        place=place.reshape(-1).astype(np.int64), radius=system.radius, angle=system.angle,
        heading=np.stack([np.cos(system.angle), np.sin(system.angle)], axis=1),
        clearance=system.clearance, blade=system.blade_rows, own=system.own,
        apart=system.own if width == m else 0 * system.own, fixed=_fixed(system, parts),
        still=np.ascontiguousarray(system.still), turns=system.turns, few=few, S=RowBlocks(*row_blocks(S)),
        harmonics=count,
    )  # fmt: skip


def _joined(system: RubSystem) -> int:
    """How many modes the rows of the casing take: of a single tip, its blade's with them."""
    return system.omega.size if system.contacts == 1 else int(system.first[1])


def _of_line(system: RubSystem) -> slice:
    """Blocks of a single tip's directions."""
    first = int(system.line[0]) * system.directions
    return slice(first, first + len(system.blade_rows))


def _fixed(system: RubSystem, parts: Propagator) -> Array:
    """What the blades yield, but for a blade that the casing's rows hold."""
    found = blade_delassus(system, parts)
    return 0.0 * found if system.contacts == 1 else found


def _between_waves(S: Array, harmonics: int) -> tuple[Indices, Array, Array]:
    """Harmonics, and cos and sin as in `rows_of_waves`, of the rows of S; all its waves filled up to `harmonics`."""
    blocks, N = len(S), S.shape[1] // 2
    rows = np.zeros((blocks, 2 * N + 1, blocks, 2, harmonics))
    rows[..., 0, : N + 1], rows[..., 1, 1 : N + 1] = S[..., : N + 1], S[..., N + 1 :]
    rows = rows.reshape(blocks, 2 * N + 1, -1)
    sin = np.concatenate([np.zeros((blocks, 1, rows.shape[2])), rows[:, N + 1 :]], axis=1)
    return np.arange(N + 1), rows[:, : N + 1], sin


def _between_tips(system: RubSystem) -> tuple[Indices, Array, Array]:
    """The same of the d rows of S of each tip, as one, polynomials of its angle: sampled, exact to round-off."""
    blocks, N = len(system.S), system.S.shape[1] // 2
    K, points = len(system.still), 4 * N + 4
    phi = np.arange(points) * (2.0 * math.pi / points)
    tips = waves_of_tips(system.angle, system.line, K // system.contacts, system.S.shape[:2])
    E = turned_back(tips.reshape(K, blocks, -1), phi).reshape(points, K, -1)
    turned = E @ system.S.reshape(E.shape[2], -1) @ E.transpose(0, 2, 1)
    some = _products(system.S)
    waves = np.multiply.outer(some, phi)
    cos, sin = (np.tensordot(part, turned, axes=1) * (2.0 / points) for part in (np.cos(waves), np.sin(waves)))
    cos[some == 0] /= 2.0
    size = np.maximum(np.abs(cos), np.abs(sin)).max(axis=(1, 2))
    kept = size > NOISE * np.abs(turned).max()
    d = K // system.contacts
    cos, sin = (part[kept].reshape(-1, system.contacts, d * K).transpose(1, 0, 2) for part in (cos, sin))
    turn = np.multiply.outer(system.angle, some[kept])[..., None]
    c, s, least = np.cos(turn), np.sin(turn), PRUNE * np.abs(turned).max()
    cos, sin = c * cos + s * sin, s * cos - c * sin
    return some[kept], np.where(np.abs(cos) > least, cos, 0.0), np.where(np.abs(sin) > least, sin, 0.0)


def _products(S: Array) -> Indices:
    """Waves of the angle turned that S can make: sums and differences of those that it couples."""
    N = S.shape[1] // 2
    first, second = (np.where(i > N, i - N, i) for i in np.nonzero(S.any(axis=(0, 2))))
    return np.unique(np.concatenate([first + second, np.abs(first - second)]))


def blade_delassus(system: RubSystem, parts: Propagator) -> Array:
    """What the blades' modes yield to unit forces within a step, between all directions of all tips, (K d, K d)."""
    d = len(system.blade_rows) // system.contacts
    full = np.zeros((len(system.blade_rows), system.omega.size))
    for row, values in enumerate(system.blade_rows):
        begin, end = system.own[row // d]
        full[row, begin:end] = values[: end - begin]
    return np.ascontiguousarray(parts.yields(full) @ full.T)


def rub_delassus(rub: Rub, system: RubSystem, parts: Propagator, mu: float) -> tuple[float, float, float]:
    """Return H_d, S and rho = |H_d|/S where rho is largest over tips and angles, for each tip alone, sliding.

    Raises LimitError where sliding friction turns H_d + S negative: that tip digs in and no force opens it.
    """
    fastest = rub.speed.hz[int(np.abs(rub.speed.hz).argmax())]
    pull = math.copysign(mu, fastest) if fastest else 0.0
    d, m = len(system.blade_rows) // system.contacts, int(system.first[1])
    T = min(1, d - 1)  # without friction there is no tangent, and no pull
    turned: Array = np.arange(float(ANGLES)) * (2.0 * math.pi / ANGLES)
    j = d * np.arange(system.contacts)
    H, soft = (
        np.tile(A[j, j] - pull * A[j, j + T], (ANGLES, 1)) for A in (blade_delassus(system, parts), system.still)
    )
    for line in np.unique(system.line):
        here, block = np.flatnonzero(system.line == line), int(line) * system.directions
        Q, along = (np.concatenate([system.rim.cos[b], system.rim.sin[b, 1:]]) for b in (block, block + 1))
        waves = np.zeros((len(Q), system.omega.size))
        waves[:, :m] = Q
        form = parts.yields(waves)[:, :m] @ (Q - pull * along).T
        H[:, here] += _around(system.rim.n_max, system.angle[here], turned, form)
        if system.turns:
            own = system.S[d * line]
            across = own[:, d * line] - pull * own[:, d * line + T]
            soft[:, here] += _around(system.S.shape[1] // 2, system.angle[here], turned, across)
    jams = np.argwhere(H + soft <= 0.0)
    if jams.size:
        i, j = jams[0]
        raise LimitError(
            f"law: found H_d + S = {H[i, j] + soft[i, j]:.4g} m/N at tip {j}, "
            f"{math.degrees(system.angle[j] - turned[i]):.0f} deg, mu = {mu:g}, "
            "expected > 0: the blade jams (friction exceeds the lean); reduce mu, or trail the blade"
        )
    rho = np.divide(np.abs(H), soft, out=np.full_like(H, math.inf), where=soft > 0.0)
    worst = int(rho.argmax())
    return float(H.flat[worst]), float(soft.flat[worst]), float(rho.flat[worst])


def _around(n_max: int, angle: Array, turned: Array, form: Array) -> Array:
    """Quadratic form in the waves 1, cos .. cos N, sin .. sin N at tips, by the angles turned."""
    E = turned_back(harmonics(n_max, angle), turned)
    return np.asarray(np.sum(E @ form * E, axis=-1))


def _flags(rub: Rub, system: RubSystem, tangential: float) -> tuple[Flag, ...]:
    radius = float(system.radius.min())
    if tangential > 0.0 and tangential**2 / (2.0 * radius) > 0.1 * _play(rub):
        words = (
            f"a tip moved {tangential:.3g} m along the rim, whose curvature changes the gap there by "
            f"{tangential**2 / (2.0 * radius):.3g} m: the gap law leaves this out"
        )
        return (Flag(words, "tip-moves-along"),)
    return ()


def _play(rub: Rub) -> float:
    """Length that the gap is measured by: the larger of clearance, interference and whirl there is [m]."""
    amounts = [abs(rub.clearance + t.clearance) for t in rub.tips] + [abs(w.amplitude) for w in rub.whirl]
    return max(max(amounts), float(np.abs(rub.closing.by).max()), abs(rub.profile.lowest), 1e-9)
