"""Exact impact of two one-dimensional bodies by characteristics: unequal rods, point masses, walls.

At its contact end a rod has v = 2 b + s F/Z: b the wave that arrives, s the direction in which F pushes it, Z its
impedance. The leaving wave a = b + s F/Z arrives a travel time 2 L/c later, with reversed sign from a fixed far end. A
mass has m v' = s F. While the contact is closed, both ends have the same v; it opens when F < 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, readonly, require_positive
from contact.base.errors import InputError
from contact.model.bodies.body import Body, PointMass, Rod

ALIGNED = 1e-6  # of a step: how far a travel time may be from whole steps
TOUCHING = 1e-9  # of the distance moved in a step: a gap below is closed


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Impact:
    """Exact `force` (n + 1,) [N], `gap` [m] and end velocities `left`, `right` [m/s] at `time` (n + 1,) [s].

    At a jump the values are those just after it. `step_force` (n,): mean force of each step.

    >>> zeros = np.zeros(3)
    >>> mean = np.array([2.0, 4.0])
    >>> found = Impact(time=np.arange(3.0), force=zeros, step_force=mean, gap=zeros, left=zeros, right=zeros)
    >>> found(np.array([0.5, 1.5])).tolist()
    [2.0, 4.0]
    """

    time: Array
    force: Array
    step_force: Array
    gap: Array
    left: Array
    right: Array

    def __call__(self, time: Array) -> Array:
        """Mean force of the step that contains each time [N]."""
        dt = self.time[1]
        n = np.clip(np.floor(time / dt + 1e-9).astype(int), 0, self.step_force.size - 1)
        return np.where((time >= 0.0) & (time < self.time[-1]), self.step_force[n], 0.0)

    @property
    def impulse(self) -> float:
        """Impulse over the whole history [N s]."""
        return float(self.step_force.sum() * self.time[1])

    @property
    def intervals(self) -> Array:
        """First closing and last opening [s], (1, 2)."""
        closed = np.flatnonzero(self.step_force > 1e-9 * self.step_force.max())
        return np.array([[self.time[closed[0]], self.time[closed[-1] + 1]]])


class _End:
    """A wall at the contact; other bodies override the `velocity` of their end, pushed in direction `sign`."""

    def __init__(self, velocity: float, sign: int) -> None:
        self.velocity, self.sign = velocity, sign

    def offer(self, n: int, after: bool, last_force: float) -> tuple[float, float]:
        """Coefficients r and y of the end's velocity r + s y F just before, or just after, time n."""
        return 0.0, 0.0

    def move(self, n: int, after: bool, r: float, y: float, force: float) -> None:
        """Apply the force, and send the resulting wave."""
        self.velocity = r + self.sign * y * force


class _MassEnd(_End):
    """A point mass."""

    def __init__(self, mass: PointMass, sign: int, dt: float) -> None:
        if mass.stiffness or mass.damping or mass.force:
            raise InputError("mass: found a spring, dashpot or force, expected none for characteristics")
        super().__init__(mass.velocity, sign)
        self.half = 0.5 * dt / mass.mass

    def offer(self, n: int, after: bool, last_force: float) -> tuple[float, float]:
        half = 0.0 if after else self.half
        return self.velocity + self.sign * half * last_force, half


class _RodEnd(_End):
    """A rod; `waves` (2, steps): arriving waves just before and just after each time."""

    def __init__(self, rod: Rod, sign: int, dt: float, steps: int) -> None:
        if rod.end_mass or rod.damping:
            raise InputError("rod: found an end mass or damping, expected neither for characteristics")
        super().__init__(rod.velocity, sign)
        ratio = 2.0 * rod.length / rod.wave_speed / dt
        self.rod, self.delay = rod, round(ratio)
        if abs(ratio - self.delay) > ALIGNED:
            raise InputError(f"dt: found a travel time 2 L/c of {ratio:g} steps, expected a whole number")
        self.waves = np.zeros((2, steps + 1 + self.delay))
        self.waves[:, : self.delay + 1] = 0.5 * rod.velocity
        if rod.fixed != "none":  # the half that meets the fixed end first comes back turned over
            self.waves[0, self.delay // 2 + 1 :] *= -1.0
            self.waves[1, self.delay // 2 :] *= -1.0

    def offer(self, n: int, after: bool, last_force: float) -> tuple[float, float]:
        return 2.0 * float(self.waves[int(after), n]), 1.0 / self.rod.impedance

    def move(self, n: int, after: bool, r: float, y: float, force: float) -> None:
        super().move(n, after, r, y, force)
        sent = float(self.waves[int(after), n]) + self.sign * force / self.rod.impedance
        self.waves[int(after), n + self.delay] = sent if self.rod.fixed == "none" else -sent


def _end(body: Body, sign: int, dt: float, steps: int) -> _End:
    if isinstance(body, PointMass):
        return _MassEnd(body, sign, dt)
    return _RodEnd(body, sign, dt, steps) if isinstance(body, Rod) else _End(body.velocity, sign)


def impact_by_characteristics(left: Body, right: Body, *, dt: float, t_end: float) -> Impact:
    """Impact of `left` with `right` on one axis, without gravity.

    Exact if the travel times 2 L/c of the rods and the first contact are whole steps of dt [s]; second order in dt with
    a point mass. A fixed rod is fixed at its far end.

    Raises InputError where a travel time is not a whole number of steps.

    >>> left = Rod(length=1.0, area=1.0, E=1.0, rho=1.0, x=-1.0, velocity=1.0)
    >>> right = Rod(length=2.0, area=2.0, E=1.0, rho=1.0)
    >>> impact = impact_by_characteristics(left, right, dt=0.1, t_end=6.0)
    >>> round(float(impact.force[0]), 6), round(impact.impulse, 6), impact.intervals.round(6).tolist()
    (0.666667, 1.333333, [[0.0, 2.0]])
    """
    require_positive(dt=dt, t_end=t_end)
    steps = math.ceil(t_end / dt - 1e-9)
    ends = (_end(left, -1, dt, steps), _end(right, 1, dt, steps))
    gap, force, speeds = np.zeros(steps + 1), np.zeros((2, steps + 1)), np.zeros((2, 2, steps + 1))
    gap[0] = right.x - left.end
    closed = False
    for n in range(steps + 1):
        last = float(force[1, n - 1]) if n else 0.0
        if n:
            force[0, n], speeds[0, :, n] = _meet(ends, n, False, last, closed)
            rates = [float(speeds[1, 1, n - 1] - speeds[1, 0, n - 1]), float(speeds[0, 1, n] - speeds[0, 0, n])]
            gap[n] = 0.0 if closed and force[0, n] > 0.0 else gap[n - 1] + 0.5 * dt * sum(rates)
        near = gap[n] <= TOUCHING * dt * max(1e-300, *(abs(end.velocity) for end in ends))
        force[1, n], speeds[1, :, n] = _meet(ends, n, True, last, near)
        closed = bool(force[1, n] > 0.0)
    return Impact(
        time=readonly(dt * np.arange(steps + 1)), force=readonly(force[1]),
        step_force=readonly(0.5 * (force[1, :-1] + force[0, 1:])), gap=readonly(gap),
        left=readonly(speeds[1, 0]), right=readonly(speeds[1, 1]),
    )  # fmt: skip


def _meet(ends: tuple[_End, _End], n: int, after: bool, last: float, closed: bool) -> tuple[float, list[float]]:
    """Force and the ends' speeds just before or just after time n."""
    (ra, ya), (rb, yb) = (end.offer(n, after, last) for end in ends)
    pressing = closed and ra - rb > 1e-12 * max(abs(ra), abs(rb)) and ya + yb > 0.0
    push = (ra - rb) / (ya + yb) if pressing else 0.0
    for end, r, y in zip(ends, (ra, rb), (ya, yb), strict=True):
        end.move(n, after, r, y, push)
    return push, [end.velocity for end in ends]


def lcm_step(*rods: Rod, cells: int) -> float:
    """Time step with `cells` steps along the shortest rod, if every L/c is a whole multiple of it [s].

    >>> a, b = (Rod(length=x, area=1.0, E=1.0, rho=1.0) for x in (1.0, 2.0))
    >>> lcm_step(a, b, cells=10)
    0.1
    """
    return min(rod.length / rod.wave_speed for rod in rods) / cells
