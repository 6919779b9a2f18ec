"""Closed forms of rigid impacts: bouncing ball, impact oscillator free and driven."""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact.base.arrays import require_count, require_finite, require_positive
from contact.base.errors import InputError


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
        """Instant of the first impact, sqrt(2 h/g) [s]."""
        return math.sqrt(2.0 * self.height / self.gravity)

    @property
    def rest(self) -> float:
        """Instant of rest, first (1 + e)/(1 - e) [s]."""
        return self.first * (1.0 + self.restitution) / (1.0 - self.restitution)

    def rebound(self, n: int) -> float:
        """Speed after the n-th impact, e^n g first [m/s]."""
        return self.restitution**n * self.gravity * self.first

    def instant(self, n: int) -> float:
        """Instant of the n-th impact, n >= 1 [s]."""
        e = self.restitution
        return self.first * (1.0 + 2.0 * sum(e**k for k in range(1, n)))


def stopped_period(omega: float, gap: float, amplitude: float) -> float:
    """Period of a free oscillator against a stop at `gap`, e = 1: (pi + 2 asin(gap/amplitude))/omega [s].

    >>> round(stopped_period(1.0, 1.0, 2.0), 6)
    4.18879
    """
    require_positive(omega=omega, amplitude=amplitude)
    if abs(gap) > amplitude:
        raise InputError(f"gap: found {gap:g} m with amplitude {amplitude:g} m, expected a stop within reach")
    return (math.pi + 2.0 * math.asin(gap / amplitude)) / omega


@dataclass(frozen=True, slots=True, kw_only=True)
class ImpactOrbit:
    """Steady motion with one impact every `period`: speed of approach, and the drive's phase at the impact [rad]."""

    speed: float
    phase: float
    period: float


def driven_orbit(*, omega: float, drive: float, drive_omega: float, gap: float, restitution: float,
                 cycles: int = 1) -> ImpactOrbit:  # fmt: skip
    """One impact every `cycles` drive cycles of x'' + omega^2 x = drive cos(drive_omega t + phase), stop at x = gap.

    Exact motion between impacts, periodicity and v+ = -e v-: a quadratic for the speed of approach V, with
    A = -(1 + e) V/(2 omega tan(omega T/2)), c = gap - A, d = V (1 - e)/2, c^2 + (d/drive_omega)^2 = G^2,
    G = drive/(omega^2 - drive_omega^2) (Shaw, Holmes, J. Sound Vib. 90, 1983, 129). `drive` [m/s^2].

    Raises InputError where there is no such orbit, as at resonance, or where one of any speed would do.

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
        raise InputError(
            f"drive_omega: found {drive_omega:g} rad/s with cycles = {cycles}, expected a period that is no whole "
            f"number of the oscillator's own, 2 pi/{omega:g} s"
        )
    p = (1.0 + e) / (2.0 * omega * tan)
    q = (1.0 - e) / (2.0 * drive_omega)
    if omega * math.hypot(p, q) < 1e-12:
        raise InputError(
            f"restitution: found {e:g} at drive_omega = {drive_omega:g} rad/s, expected less: every impact takes the "
            "oscillator to the next by itself, whatever its speed"
        )
    G = drive / (omega**2 - drive_omega**2)
    root = (p * gap) ** 2 - (p * p + q * q) * (gap * gap - G * G)
    speed = (-p * gap + math.sqrt(root)) / (p * p + q * q) if root >= 0.0 else math.nan
    if not speed > 0.0:
        raise InputError(f"drive: found {drive:g} m/s^2, expected one strong enough to reach the stop in every period")
    c, d = gap + p * speed, q * speed * drive_omega
    return ImpactOrbit(speed=speed, phase=math.atan2(-d / drive_omega / G, c / G), period=period)
