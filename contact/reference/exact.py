"""Closed forms and exact characteristics of one-dimensional impacts, for tests of schemes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, readonly, require_count, require_finite, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.model.bodies.body import Rod

Force = Callable[[Array], Array]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ExactContact:
    """Exact contact force: linear from `force[:, 0]` to `force[:, 1]` over `intervals` [s] (n, 2).

    >>> exact = ExactContact(intervals=np.array([[0.0, 2.0]]), force=np.array([[0.0, 10.0]]))
    >>> exact.impulse, exact(np.array([1.0, 3.0])).tolist()
    (10.0, [5.0, 0.0])
    """

    intervals: Array
    force: Array

    @property
    def impulse(self) -> float:
        """Impulse of all intervals [N s]."""
        return float(np.sum((self.intervals[:, 1] - self.intervals[:, 0]) * self.force.mean(axis=1)))

    def __call__(self, time: Array) -> Array:
        """Force at these times [N], zero outside the intervals."""
        total = np.zeros_like(time)
        for (start, end), (a, b) in zip(self.intervals, self.force, strict=True):
            inside = (time >= start) & (time < end)
            total[inside] = a + (b - a) * (time[inside] - start) / (end - start)
        return total


def two_rods(rod: Rod, *, gap: float, velocity: float) -> ExactContact:
    """Two identical free rods, one at rest, the other closing `gap` at `velocity`: F = Z v/2 for 2L/c.

    Afterwards the first is at rest, the second moves at `velocity`, neither vibrates
    (Carpenter, Taylor, Katona, Int. J. Numer. Meth. Eng. 32, 1991, 103).

    >>> rod = Rod(length=0.254, area=6.4516e-4, E=206.8427e9, rho=7844.181)  # 10 in, 30e6 psi
    >>> contact = two_rods(rod, gap=2.54e-4, velocity=5.13588)
    >>> round(float(contact.force[0, 0])), [f"{t:.5g}" for t in contact.intervals[0]]
    (66734, ['4.9456e-05', '0.00014838'])
    """
    require_not_negative(gap=gap)
    require_positive(velocity=velocity)
    start, force = gap / velocity, 0.5 * rod.impedance * velocity
    return _plateau(start, 2.0 * rod.length / rod.wave_speed, force)


def rod_on_wall(rod: Rod, *, gap: float, velocity: float) -> ExactContact:
    """Free rod against a rigid wall, without gravity: F = Z v for 2L/c, rebound at the same speed.

    >>> bar = Rod(length=10.0, area=1.0, E=900.0, rho=1.0)
    >>> contact = rod_on_wall(bar, gap=5.0, velocity=10.0)
    >>> contact.intervals.round(6).tolist(), round(contact.impulse, 9)
    ([[0.5, 1.166667]], 200.0)
    """
    require_not_negative(gap=gap)
    require_positive(velocity=velocity)
    return _plateau(gap / velocity, 2.0 * rod.length / rod.wave_speed, rod.impedance * velocity)


def bouncing_bar(contacts: int) -> ExactContact:
    """Bar dropped on a wall (E = 900, rho = 1, L = 10, A = 1, h_0 = 5, g = 10), period 16/3 s.

    F = 300 + 300 (t - 1) in [1, 5/3], F = 500 - 300 (t - 11/3) in [11/3, 13/3], and so on
    (Doyen, Ern, Piperno, SIAM J. Sci. Comput. 33, 2011, 223).

    >>> round(bouncing_bar(2).impulse, 6)
    533.333333
    """
    require_count(contacts=contacts)
    k = np.arange(contacts)
    start = np.where(k % 2 == 0, 1.0, 11.0 / 3.0) + (k // 2) * (16.0 / 3.0)
    lines = np.where((k % 2 == 0)[:, None], [300.0, 500.0], [500.0, 300.0])
    return ExactContact(intervals=readonly(np.stack([start, start + 2.0 / 3.0], axis=1)), force=readonly(lines))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BarHistory:
    """Exact bar over a wall: `gap` (n + 1,) at `time`, `force` (n,) at the middles of the steps.

    >>> import contact as ct
    >>> bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0)
    >>> history = ct.reference.bar_by_characteristics(bar, gravity=10.0, t_end=5.0, cells=30)
    >>> history.gap.size == history.force.size + 1
    True
    """

    time: Array
    gap: Array
    force: Array


def bar_by_characteristics(rod: Rod, *, gravity: float, t_end: float, cells: int) -> BarHistory:
    """Free rod falling along -x on a wall at x = 0, by characteristics v -+ N/Z shifted by one cell per step.

    Exact at the samples if contacts begin and end on multiples of dt = L/(cells c), as in benchmark B2.

    >>> bar = Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0)
    >>> history = bar_by_characteristics(bar, gravity=10.0, t_end=5.0, cells=30)
    >>> round(float(history.force.sum() * history.time[1]), 4)
    533.3333
    """
    require_positive(t_end=t_end, cells=cells)
    dt = rod.length / rod.wave_speed / cells
    count = math.ceil(t_end / dt - 1e-9)
    up, down = np.full(cells, rod.velocity), np.full(cells, rod.velocity)
    gap, force = np.empty(count + 1), np.zeros(count)
    gap[0] = rod.x
    closed_at = 1e-9 * max(rod.length, abs(rod.x))
    half = 0.5 * gravity * dt
    for n in range(count):
        arriving = down[0] - half
        pressing = gap[n] <= closed_at and arriving < 0.0
        speed = 0.0 if pressing else arriving
        force[n] = -rod.impedance * arriving if pressing else 0.0
        gap[n + 1] = gap[n] + dt * speed
        top = up[-1] - 2.0 * half
        up[1:], down[:-1] = up[:-1] - 2.0 * half, down[1:] - 2.0 * half
        up[0], down[-1] = 2.0 * speed - arriving - half, top
    return BarHistory(time=readonly(dt * np.arange(count + 1)), gap=readonly(gap), force=readonly(force))


def force_error(time: Array, force: Array, dt: float, exact: Force, *, points: int = 16, norm: int = 1) -> float:
    """L1 or L2 error of a force over the same norm of the exact one, with F constant over t_n -+ dt/2.

    >>> time = 0.1 * np.arange(11)
    >>> round(force_error(time, np.full(11, 2.1), 0.1, lambda t: np.full(t.shape, 2.0)), 6)
    0.05
    """
    offsets = ((np.arange(points) + 0.5) / points - 0.5) * dt
    reference = exact((time[:, None] + offsets).ravel()).reshape(time.size, points)
    error = np.sum(np.abs(force[:, None] - reference) ** norm) / np.sum(np.abs(reference) ** norm)
    return float(error ** (1.0 / norm))


def _plateau(start: float, duration: float, force: float) -> ExactContact:
    return ExactContact(intervals=readonly([[start, start + duration]]), force=readonly([[force, force]]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounces:
    """Ball dropped from `height` [m] under `gravity` [m/s^2] with restitution e < 1.

    >>> ball = Bounces(height=1.0, gravity=9.81, restitution=0.8)
    >>> round(ball.first, 6), round(ball.rebound(1), 6), round(ball.rest, 6)
    (0.451524, 3.543558, 4.063713)
    """

    height: float
    gravity: float
    restitution: float

    @property
    def first(self) -> float:
        """Time of the first impact, sqrt(2 h/g) [s]."""
        return math.sqrt(2.0 * self.height / self.gravity)

    @property
    def rest(self) -> float:
        """Time at which the ball rests, first (1 + e)/(1 - e) [s]."""
        return self.first * (1.0 + self.restitution) / (1.0 - self.restitution)

    def rebound(self, n: int) -> float:
        """Speed after the n-th impact, e^n g first [m/s]."""
        return self.restitution**n * self.gravity * self.first

    def instant(self, n: int) -> float:
        """Time of the n-th impact, n >= 1 [s]."""
        e = self.restitution
        return self.first * (1.0 + 2.0 * sum(e**k for k in range(1, n)))


def stopped_period(omega: float, gap: float, amplitude: float) -> float:
    """Period of a free oscillator against a stop at `gap`, e = 1: (pi + 2 asin(gap/amplitude))/omega [s].

    >>> round(stopped_period(1.0, 1.0, 2.0), 6)
    4.18879
    """
    require_positive(omega=omega, amplitude=amplitude)
    if abs(gap) > amplitude:
        raise InputError(f"gap: found {gap:g} m with amplitude {amplitude:g} m, expected a gap below the amplitude")
    return (math.pi + 2.0 * math.asin(gap / amplitude)) / omega


@dataclass(frozen=True, slots=True, kw_only=True)
class ImpactOrbit:
    """Steady motion with one impact every `period`: approach speed, and phase of the drive at the impact [rad].

    >>> ImpactOrbit(speed=0.5, phase=0.1, period=1.0).speed
    0.5
    """

    speed: float
    phase: float
    period: float


def driven_orbit(*, omega: float, drive: float, drive_omega: float, gap: float, restitution: float,
                 cycles: int = 1) -> ImpactOrbit:  # fmt: skip
    """One impact every `cycles` cycles of x'' + omega^2 x = drive cos(drive_omega t + phase), stop at x = gap.

    Exact motion between impacts, periodicity and v+ = -e v-: give a quadratic for the approach speed V, with
    A = -(1 + e) V/(2 omega tan(omega T/2)), c = gap - A, d = V (1 - e)/2, c^2 + (d/drive_omega)^2 = G^2,
    G = drive/(omega^2 - drive_omega^2) (Shaw, Holmes, J. Sound Vib. 90, 1983, 129). `drive` [m/s^2].

    Raises InputError if there is no such orbit, as at resonance, or one for every speed.

    >>> orbit = driven_orbit(omega=1.0, drive=1.0, drive_omega=2.7, gap=0.0, restitution=0.8)
    >>> round(orbit.speed, 6)
    0.407663
    """
    require_positive(omega=omega, drive=drive, drive_omega=drive_omega)
    require_finite(gap=gap)
    require_count(cycles=cycles)
    if not 0.0 <= restitution <= 1.0:
        raise InputError(f"restitution: found {restitution!r}, expected between 0 and 1")
    e, period = restitution, 2.0 * math.pi * cycles / drive_omega
    tan = math.tan(0.5 * omega * period)
    if abs(tan) < 1e-12:
        expected = f"a period that is not a multiple of the oscillator's period, 2 pi/{omega:g} s"
        raise InputError(f"drive_omega: found {drive_omega:g} rad/s with cycles = {cycles}, expected {expected}")
    p = (1.0 + e) / (2.0 * omega * tan)
    q = (1.0 - e) / (2.0 * drive_omega)
    if omega * math.hypot(p, q) < 1e-12:
        expected = "a lower value: here orbits of every speed exist"
        raise InputError(f"restitution: found {e:g} at drive_omega = {drive_omega:g} rad/s, expected {expected}")
    G = drive / (omega**2 - drive_omega**2)
    root = (p * gap) ** 2 - (p * p + q * q) * (gap * gap - G * G)
    speed = (-p * gap + math.sqrt(root)) / (p * p + q * q) if root >= 0.0 else math.nan
    if not speed > 0.0:
        raise InputError(f"drive: found {drive:g} m/s^2, expected a drive that reaches the stop in every period")
    c, d = gap + p * speed, q * speed * drive_omega
    return ImpactOrbit(speed=speed, phase=math.atan2(-d / drive_omega / G, c / G), period=period)
