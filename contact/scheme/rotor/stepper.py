"""Run of a rotor: exact steps at constant speed, of second order if the speed varies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.trust import Flag
from contact.model.gaps.limits import rotor_limits
from contact.model.law import Law
from contact.model.rotor.rotor import Rotor
from contact.record.energy import Stored
from contact.record.orbit import TURNS, orbit
from contact.record.record import Samples, Tally, tally
from contact.scheme.protocol import Block, Motion, Notes, PlainStepper, window
from contact.scheme.rotor.propagation import generator, highest, step_of, stored_stiffness

if TYPE_CHECKING:
    from contact.loop.rotor import RotorLaws, RotorState

FINE = 1e-3  # change of A h between nodes of the speed
LEAST, MOST = 8, 64  # nodes


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RotorStepper(PlainStepper):
    """State of a rotor's run."""

    rotor: Rotor
    dt: float
    sums: Tally
    label: str
    state: RotorState
    laws: RotorLaws
    top: float
    stiff: Array

    @property
    def window(self) -> float:
        """Period of the highest mode [s]."""
        return window(self.top, self.dt)

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.state.q.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The single block, the rotor: name, first and last coordinate."""
        return (("rotor", 0, self.size),)

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        from contact.loop.rotor import advance_rotor

        return advance_rotor(self.state, self.laws, self.sums, out, self.dt, first, steps)

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state and sums."""
        return self.state, self.sums

    @property
    def limits(self) -> Array:
        """The largest motion of a node."""
        return self.state.limits

    def why(self) -> Flag:
        """Explain a failed step."""
        return Flag("the motion is not finite", "motion-overflow", failed=True)

    def notes(self) -> Notes:
        """The orbit so far."""
        unbalance = self.rotor.unbalance
        unbalanced = unbalance.before != 0.0 or unbalance.after != 0.0
        return Notes(orbit=orbit(self.state.turns, int(self.state.turn[0]), float(self.state.hz[0]), unbalanced))

    def stored(self) -> Stored:
        """Energy at t_n; the weight has a potential."""
        m = self.size
        q, v = self.state.z[:m], self.state.z[m : 2 * m]
        kinetic, strain = 0.5 * float(v @ v), 0.5 * float(q @ self.stiff @ q)
        potential = -float(self.rotor.load @ q)
        return Stored(
            kinetic=kinetic, strain=strain, potential=potential, residual=0.0, discrete=kinetic + strain + potential
        )

    def motions(self) -> tuple[Motion, ...]:
        """None, since a rotor on bearings has no rigid motion."""
        return (Motion(kind="body", number=0, mean_velocity=math.nan, momentum=math.nan),)


def rotor_stepper(rotor: Rotor, law: Law, h: float) -> RotorStepper:
    """Stepper at t = 0. Raises InputError for a contact law, since a rotor alone has no contact."""
    from contact.loop.rotor import RotorLaws, RotorState

    if law.mu > 0.0 or law.stiffness > 0.0 or law.response is not None or law.coating is not None:
        raise InputError(f"law: found {law!r} for a rotor without contact, expected none")
    m, table = rotor.body.omega.size, rotor.speed.table
    ends = table[1:, 2]
    low, high = float(ends.min()), float(ends.max())
    speeds = _nodes(rotor, low, high, h)
    found = [step_of(rotor, omega, h) for omega in speeds.tolist()]
    release, until = _release(rotor, h)
    parts = [found[0], found[0]]
    if release >= 0:
        omega = (rotor.speed.angle((release + 1) * h) - rotor.speed.angle(release * h)) / h
        parts = [step_of(rotor, omega, length) for length in (until, h - until)]
    before, after = (np.array([U.real, U.imag]) for U in (rotor.unbalance.before, rotor.unbalance.after))
    start = rotor.sagged
    d = 2 * m + 3
    z = np.zeros(d)
    z[:m], z[m : 2 * m], z[-1] = start + np.asarray(rotor.displacement), rotor.velocity, 1.0
    state = RotorState(
        z=z, new=np.zeros(d), q=np.zeros(m), P=np.zeros((d, d)), W=np.zeros((3, d, d)), share=np.zeros(4),
        turns=np.zeros((TURNS + 1, 5)), turn=np.zeros(1, dtype=np.int64), hz=np.array([rotor.speed.hz[0]]),
        force=np.zeros(0), gap=np.zeros(0), limits=rotor_limits(rotor.limit),
    )  # fmt: skip
    laws = RotorLaws(
        first=float(speeds[0]), spacing=float(speeds[1] - speeds[0]) if speeds.size > 1 else 1.0,
        P=np.array([P for P, _ in found]), W=np.array([W for _, W in found]),
        step_parts=np.array([P for P, _ in parts]), work_parts=np.array([W for _, W in parts]),
        release=release, until=until, before=before if release >= 0 else after, after=after, speed=table,
        plane=np.ascontiguousarray(rotor.plane), rest=rotor.plane @ start,
        places=np.ascontiguousarray(rotor.places),
    )  # fmt: skip
    top = max(highest(generator(rotor, omega)[0][: 2 * m, : 2 * m]) for omega in (low, high))
    words = "exact at a constant speed"
    if speeds.size > 1:
        error = float(np.abs(table[:, 3]).max()) * h * h / 8.0
        words += f", of second order while it varies: phase of the unbalance within {error:.2g} rad in a step"
    return RotorStepper(
        rotor=rotor, dt=h, sums=tally(0)._replace(rotation=np.zeros(1)), state=state, laws=laws, top=top,
        label=f"exact steps of {m} modes of a rotor, {words}", stiff=stored_stiffness(rotor),
    )  # fmt: skip


def _nodes(rotor: Rotor, low: float, high: float, h: float) -> Array:
    """Speeds [rad/s] between which steps are interpolated; a single one if the speed is constant."""
    if high == low:
        return np.array([low])
    m = rotor.body.omega.size
    slope = generator(rotor, high)[0][m : 2 * m, : 2 * m] - generator(rotor, low)[0][m : 2 * m, : 2 * m]
    scale = np.concatenate([1.0 / np.maximum(rotor.body.omega, 1e-9 + 0.01 * rotor.body.omega.max(initial=1.0)),
                            np.ones(m)])  # fmt: skip
    change = max(float(np.linalg.norm(slope * scale, 2)), high - low) * h
    return np.linspace(low, high, min(max(LEAST, math.ceil(change / FINE)), MOST))


def _release(rotor: Rotor, h: float) -> tuple[int, float]:
    """The step that contains the release, and the time since its start; -1 without a release."""
    if rotor.unbalance.release is None:
        return -1, 0.0
    time = rotor.unbalance.release.time
    step = int(time / h)
    step += int((step + 1) * h <= time)
    return step, min(max(time - step * h, 0.0), h)
