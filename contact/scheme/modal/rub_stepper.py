"""Run of a rub: its arrays for the compiled loop, its limits and its evaluations; see `loop.rub`."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.io.trust import Flag
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import LARGEST, wall_flags
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import RubSystem
from contact.model.law import Law
from contact.record.energy import Stored
from contact.record.record import Samples, tally
from contact.record.spin import SpinBudget
from contact.record.wear import Wear
from contact.scheme.modal.absent import absent
from contact.scheme.modal.at_speeds import AtSpeeds
from contact.scheme.modal.blocks import OF_MODES, narrowed, whole, widened
from contact.scheme.modal.free_flight import free_flight
from contact.scheme.modal.gives_way import memory_of, stored_by, too_long, yielding_of
from contact.scheme.modal.modal_blocks import fill_blocks, modal_blocks
from contact.scheme.modal.propagator import ExactRun, Propagator
from contact.scheme.modal.rub_arrays import LoopArrays, fixed_delassus, joined, rub_state
from contact.scheme.modal.wear_track import Tracks, rub_tracks
from contact.scheme.protocol import Block, Motion, Notes
from contact.solver.friction.inexact import inexact

if TYPE_CHECKING:
    from contact.loop.rub.free_flight import FreeFlight
    from contact.loop.rub.state import ModalBlocks, RubState
    from contact.solver.abradable.tips import Coats
    from contact.solver.yielding.yields import Yielding

PENDING = 2  # entry of `contact.loop.rub.rows.Spin.now`
OUTSIDE = 1e-3  # of the range of speeds: how far beyond it a rotor may go
NAMES = (*OF_MODES, "contact")  # arrays over the modes that loops process in whole blocks


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RubStepper(ExactRun):
    """State of a rub; `state.counts` has the solver's iterations, `state.heat` the heat of slip."""

    rub: Rub
    system: RubSystem
    speeds: AtSpeeds
    coupled: ModalBlocks | None
    values: tuple[Array, ...]  # of the blocks at the nodes of the speeds; none where they do not vary
    state: RubState  # views of `wide`
    wide: RubState  # in whole blocks of eight
    flight: FreeFlight
    dimensions: int
    averaged: bool
    steps: Indices  # taken so far, one entry
    stretch: Indices  # number of the stretch whose coefficients the loop has, one entry
    spun: Array  # if not prescribed: speed of these coefficients, largest excess of the range [rad/s]
    spin_start: tuple[float, float]  # of such a rotor: speed [rad/s] and energy shared with the unbalance at t = 0 [J]
    law: Law
    stiffest: float  # Delassus number [m/N] of a normal with itself, the largest around
    y: Yielding | None = None
    worn: tuple[Tracks, Coats] | None = None
    rim: RotatingRim | None = None  # the scene, where slots may take it
    made: list[LoopArrays] = field(default_factory=list)  # set when the loop first runs; in slots it never runs
    given: list[Any] = field(default_factory=list)  # arguments of the loop, bundled once

    @property
    def size(self) -> int:
        """Number of modes, and of forces on the tips."""
        return self.state.seen.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first mode and one past the last mode of each body, then the forces on the tips.

        The modes of a rotor are the last ones of the casing, and also the block "rotor".
        """
        first = self.system.first.tolist()
        rotor: tuple[Block, ...] = ()
        if self.rub.rotor is not None:
            end = self.rub.flexible + self.rub.rotor.body.omega.size
            rotor = (("rotor", self.rub.flexible, end), ("spin", end, first[1]))[: 1 if self.rub.spin is None else 2]
        return (*zip(self.system.names, first[:-1], first[1:], strict=True), *rotor, ("tips", first[-1], self.size))

    @property
    def arrays(self) -> LoopArrays:
        """Laws, rows and work arrays of the loop."""
        if not self.made:
            self.made.append(
                LoopArrays.of(
                    self.rub,
                    self.system,
                    self.now(),
                    self.wide,
                    0.25 if self.averaged else 1.0,
                    vary=self.speeds.vary,
                    yields=self.worn is not None or self.y is not None,
                    coupled=self.coupled is not None,
                )
            )
        return self.made[0]

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        if self.worn is None:
            failed = self._some(None, out, first, steps)
        else:
            from contact.jit.bundle import bundled

            (tracks, coats), once = self.worn, bundled(out)  # of many calls
            failed = tracks.watch(self.dt, first, steps, lambda start, count: self._some(coats, once, start, count))
        self.steps[0] = first + steps if failed < 0 else failed
        return failed

    def _some(self, coats: Coats | None, out: Samples, first: int, steps: int) -> int:
        from contact.jit.bundle import bundled
        from contact.loop.rub.rub import advance_rub

        if not self.given:
            a = self.arrays
            none = absent()
            parts = (
                self.wide, a.laws, a.rows, coats or none.coats, self.y or none.law, self.coupled or none.blocks,
                none.steady, a.solver, self.flight, a.work, self.sums,
            )  # fmt: skip
            self.given.extend(map(bundled, parts))
        state, laws, rows, coating, y, coupled, steady, solver, flight, work, sums = self.given
        failed, at, end = -1, first, first + steps
        while failed < 0 and (at < end or at == first):
            count = end - at
            if self.values:
                self._turn(at // self.speeds.stretch)
                count = min(count, self.speeds.stretch - at % self.speeds.stretch)
            failed = advance_rub(
                state, laws, rows, coating, y, coupled, steady, solver, flight, work, self.dimensions, self.averaged,
                sums, out, self.dt, at, count,
            )  # fmt: skip
            at += max(count, 1)
        if self.arrays.solver is not None:
            self.arrays.solver.room.otherwise.pass_on()
        return failed

    def _turn(self, stretch: int) -> None:
        """Set the coefficients for the next steps.

        The resulting change of the modes' energy counts as work of the drive.
        """
        assert self.coupled is not None
        if stretch == self.stretch[0]:
            return
        before, s, speeds = self.omega(int(self.stretch[0])), self.state, self.speeds
        if self.rub.spin is not None:
            low, high, speed = float(speeds.nodes.min()), float(speeds.nodes.max()), self._casing_speed()
            self.spun[0] = min(max(speed, low), high)
            self.spun[1] = max(self.spun[1], low - speed, speed - high)
        after = self.omega(stretch)
        taken = speeds.discrete(after, s.q, s.d) - speeds.discrete(before, s.q, s.d)
        self.sums.external[0] += taken
        self.stretch[0] = stretch
        fill_blocks(self.coupled, speeds.weights(after), self.values)
        s.kick[:] = speeds.push(after, self.parts.load)
        if self.rub.spin is not None:
            self.arrays.laws.spin.now[PENDING] += taken
        if any(body.varies for body in self.rub.blades):
            self.arrays.rows.fixed[:] = fixed_delassus(self.system, speeds.at(after))

    def _casing_speed(self) -> float:
        """Speed of the casing against the tips in the last step, for a rotor whose speed is not prescribed [rad/s]."""
        assert self.rub.spin is not None
        ahead = float(self.state.d[self.system.first[1] - 1]) / (self.dt * math.sqrt(self.rub.spin.inertia))
        return float(self.rub.speed.hz[0]) * 2.0 * math.pi - ahead

    def _spin(self) -> SpinBudget | None:
        """Energy and momentum of a rotor whose speed follows from its torques; None for others."""
        if self.rub.spin is None:
            return None
        end, laws = -self._casing_speed(), self.arrays.laws
        angles = self.arrays.work.angles
        d = self.state.d[self.rub.flexible : self.system.first[1] - 1]
        after = shared_energy(self.rub, self.dt, d, angles[1, 0], angles[0, 0], int(self.steps[0]) - 1)
        return SpinBudget.of(
            self.rub.spin.inertia, self.spin_start[0], end, (self.spin_start[1], after), laws.spin.sums
        )

    def omega(self, stretch: int) -> float:
        """Speed [rad/s] in the middle of steps with the same coefficients; at their start if not prescribed."""
        if self.rub.spin is not None:
            return float(self.spun[0])
        return self.rub.speed.omega(self.speeds.middle(stretch))

    def now(self) -> Propagator:
        """Current coefficients of the loop."""
        return self.speeds.at(self.omega(int(self.stretch[0]))) if self.speeds.vary else self.parts

    def wear(self) -> tuple[Wear, ...]:
        """Wear of each track of a coating so far; empty without a coating."""
        return () if self.worn is None else self.worn[0].wear()

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state, work arrays, sums and the coating."""
        coating = () if self.worn is None else (self.worn[0].memory, self.worn[1])
        coupled = () if self.coupled is None else self.coupled
        a = self.arrays
        return (
            self.wide, a.work, a.rows, a.solver or (), self.flight, self.sums, self.steps, self.stretch, self.spun,
            (a.laws.spin.now, a.laws.spin.sums), coupled, coating, memory_of(self.y),
        )  # fmt: skip

    @property
    def limits(self) -> Array:
        """Limits of `motion_limits`."""
        return self.state.limits

    @property
    def overlap(self) -> float:
        """Largest overlap of a tip with the rim at t = 0 [m]."""
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
            return Flag("the motion is not finite", "motion-overflow", failed=True)
        words = "no forces satisfy Coulomb's law at every tip: a tip jams, or dt is too long; reduce dt or mu"
        return Flag(words, "unconverged", failed=True)

    def stored(self) -> Stored:
        """Energy now; energy stored in S, in a coating or in a compliant surface counts as residual."""
        s = self.state
        residual = 0.0
        if s.lam.any():
            turned = self.rub.speed.angle((int(self.steps[0]) - 1) * self.dt)
            turned = turned if self.rub.spin is None else float(self.arrays.work.angles[0, 0])
            residual = 0.5 * float(s.lam @ self.system.compliance(turned) @ s.lam)
        residual += stored_by(self.law, self.y) + (0.0 if self.worn is None else self.worn[0].elastic)
        return self.now().stored(s.q, s.d, s.contact + s.push + (s.body if s.body.size else 0.0), residual, 0.0)

    def motions(self) -> tuple[Motion, ...]:
        """None, since supported bodies have no rigid motion."""
        nan = math.nan
        kinds = ("casing", *("blade",) * len(self.rub.blades))
        return tuple(Motion(kind=k, number=b, mean_velocity=nan, momentum=nan) for b, k in enumerate(kinds))

    def notes(self) -> Notes:
        """Heat and drive of friction, and flags for events outside the theory."""
        deflection, tangential = float(self.limits[LARGEST]), float(self.state.peaks[0])
        flags = (*wall_flags(deflection, self.rub.wall), *_flags(self.rub, self.system, tangential))
        solver = self.made[0].solver if self.made else None
        left = 0.0 if solver is None else float(solver.room.left[0])
        flags += (*inexact(left), *too_long(self.y, self.stiffest, self.dt), *self._outside())
        return Notes(
            flags=flags, heat=readonly(self.state.heat), drive=readonly(self.state.drive), deflection=deflection,
            spin=self._spin(),
        )  # fmt: skip

    def _outside(self) -> tuple[Flag, ...]:
        """A flag if a rotor left the range of speeds for which the coefficients of its modes are known."""
        low, high = self.speeds.nodes.min(), self.speeds.nodes.max()
        if self.spun[1] <= OUTSIDE * (high - low):
            return ()
        ends = sorted(abs(omega) / (2.0 * math.pi) for omega in (low, high))
        words = (
            f"spin: the speed of the rotor is {self.spun[1] / (2.0 * math.pi):.4g} Hz outside {ends[0]:.4g} to "
            f"{ends[1]:.4g} Hz, the range for which its modes were computed: set another spin.most_hz"
        )
        return (Flag(words, "spin-beyond", failed=True),)


def rub_stepper(rub: Rub, system: RubSystem, speeds: AtSpeeds, *, law: Law, dimensions: int, averaged: bool,
                label: str, stiffest: float = 0.0, skip: bool = False,
                rim: RotatingRim | None = None) -> RubStepper:  # fmt: skip
    """Stepper at t = 0; without friction only the normal rows are used.

    Raises the errors of `rub_tracks` and `yielding_of`.
    """
    first = rub.speed.omega(speeds.middle(0))
    parts = speeds.at(first)
    m, y = system.omega.size, yielding_of(law, system.clearance, system.clearance)
    blocks, values = modal_blocks(speeds, m, joined(system))
    if blocks is not None and speeds.vary:
        fill_blocks(blocks, speeds.weights(first), values)
    wide = widened(rub_state(rub, system, parts, law.mu, dimensions), whole(m), NAMES)
    started = 0.0, 0.0
    if rub.spin is not None:
        d, end = wide.d, int(system.first[1]) - 1
        ahead, turn = float(d[end]) / math.sqrt(rub.spin.inertia), rub.speed.omega(0.0) * parts.h
        started = ((ahead - turn) / parts.h, shared_energy(rub, parts.h, d[rub.flexible : end], 0.0, ahead - turn, -1))
    return RubStepper(
        rub=rub, system=system, parts=parts, speeds=speeds, coupled=blocks, values=values if speeds.vary else (),
        state=narrowed(wide, m, NAMES), wide=wide, flight=free_flight(rub, system, parts, skip=skip and y is None),
        dimensions=dimensions, averaged=averaged,
        sums=tally(system.contacts), label=label, steps=np.zeros(1, dtype=np.int64),
        stretch=np.zeros(1, dtype=np.int64), spun=np.array([rub.speed.omega(0.0), 0.0]),
        spin_start=started,
        worn=None if law.coating is None else rub_tracks(rub, law.coating), law=law, stiffest=stiffest,
        y=y, rim=rim,
    )  # fmt: skip


def shared_energy(rub: Rub, h: float, d: Array, now: float, before: float, step: int) -> float:
    """Kinetic energy that disk and unbalance share after a step [J]: Re(conj(Dx) Du)/h^2.

    `d` increments of the rotor's modes in the step; `now`, `before` the casing's angle against it [rad].
    """
    rotor = rub.rotor
    if rotor is None or not rotor.unbalance.acts:
        return 0.0
    moved = complex(*(rotor.plane @ d))
    turned = rotor.unbalance.at(step * h, h) * (cmath.exp(-1j * now) - cmath.exp(-1j * before))
    return float((moved.conjugate() * turned).real / h**2)


def _flags(rub: Rub, system: RubSystem, tangential: float) -> tuple[Flag, ...]:
    radius = float(system.radius.min())
    if tangential > 0.0 and tangential**2 / (2.0 * radius) > 0.1 * _play(rub):
        words = (
            f"a tip moved {tangential:.3g} m along the rim; there the curvature changes the gap by "
            f"{tangential**2 / (2.0 * radius):.3g} m, which the gap law neglects"
        )
        return (Flag(words, "tip-moves-along"),)
    return ()


def _play(rub: Rub) -> float:
    """Reference length of the gap: the larger of clearance, interference and whirl [m]."""
    amounts = [abs(rub.clearance + t.clearance) for t in rub.tips] + [abs(w.amplitude) for w in rub.whirl]
    return max(max(amounts), float(np.abs(rub.closing.by).max()), abs(rub.profile.lowest), 1e-9)
