"""A turning rim against its blade over speed, clearance or friction, in the blade's frame: coefficients are constant.

A perfect casing's modes turn into each other, so with G as in `contact.model.gaps.permanent.ClosedContact`
(D + Omega G)^2 q + 2 zeta omega (D + Omega G) q + omega^2 q = (Q - mu s T)^T lam,
gap = clearance + d(phi_0 - Omega t) + Q q + (S_nn - mu s S_nt) lam:
the out-of-roundness d forces the motion, once a turn and at its harmonics.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import reduce
from typing import Literal

import numpy as np

from contact.base.arrays import Array, require_count, require_not_negative
from contact.base.errors import InputError
from contact.growth.cycles.driven import looks_of
from contact.growth.cycles.passage import Motion
from contact.growth.cycles.switched import Drive, Forcing, Plant
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, rim_contact

SHOWN = ("casing", "span", "flap")
Parameter = Literal["speed_hz", "clearance", "friction"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RimFamily:
    """A rim against its blade over its speed [Hz], clearance [m] or coefficient of friction, sliding all the time.

    Shown are the casing's radial motion at the tip, and the blade's span and flap. The orbit's period is that of the
    out-of-roundness, one turn over the common divisor of its harmonics. Raises SplitError for a casing that is not
    perfect, InputError for other fields.
    """

    rim: RotatingRim
    name: Parameter = "speed_hz"
    mu: float = 0.0
    looks: int | None = None

    def __post_init__(self) -> None:
        require_not_negative(friction=self.mu)
        if self.looks is not None:
            require_count(8, looks=self.looks)
        if self.name not in ("speed_hz", "clearance", "friction"):
            raise InputError(f"name: found {self.name!r}, expected 'speed_hz', 'clearance' or 'friction'")
        rim_contact(self.rim, mu=self.mu)

    @property
    def channels(self) -> tuple[str, ...]:
        """What is shown."""
        return SHOWN

    @property
    def begin(self) -> Array:
        """State from which runs start: the bodies at rest, or at the velocities given."""
        sizes = self.rim.casing.omega.size, self.rim.blade.omega.size
        given = self.rim.casing_velocity, self.rim.blade_velocity
        velocity = [np.zeros(n) if v is None else np.asarray(v) for n, v in zip(sizes, given, strict=True)]
        omega = np.concatenate([self.rim.casing.omega, self.rim.blade.omega])
        return np.concatenate([np.zeros(sum(sizes)), np.concatenate(velocity) / omega])

    def at(self, value: float) -> tuple[Motion, float]:
        """Motion at a value of the parameter, and the period of the out-of-roundness [s]."""
        rim, mu = self.rim, self.mu
        if self.name == "friction":
            mu = value
        elif self.name == "clearance":
            rim = replace(rim, clearance=value)
        else:
            rim = replace(rim, speed_hz=value)
        if rim.speed == 0.0:
            raise InputError("speed_hz: found 0, expected a rim that turns")
        contact = rim_contact(rim, mu=mu)
        plant = _plant(rim, contact)
        orders = [p for p, cos, sin in rim.terms if p > 0 and (cos or sin)] or [1]
        base = reduce(math.gcd, orders)
        period = 2.0 * math.pi / (base * abs(rim.speed))
        drive = _drive(rim, contact, base)
        step = looks_of(period, plant.rate, self.looks)
        return Motion(plant=plant, drive=drive, step=step, phases={}), period


def _plant(rim: RotatingRim, contact: ClosedContact) -> Plant:
    """State (q, (D + Omega G) q/omega); shown is what is in `SHOWN`, then the slip in the direction of the turn."""
    omega, m = contact.omega, contact.omega.size
    if not omega.min() > 0.0:
        raise InputError("casing, blade: found a mode at 0 rad/s, expected bodies that are held")
    sense = math.copysign(1.0, rim.speed)
    turn = -rim.speed * contact.G
    W, S = contact.pushes(sense), contact.compliance(sense)
    across = (turn / omega[:, None]) * omega  # of q'/omega
    A = np.block([[turn, np.diag(omega)], [-np.diag(omega), across - np.diag(2.0 * contact.zeta * omega)]])
    none = np.zeros_like(contact.Q)
    held = omega.max() ** 2 + float(np.linalg.norm(contact.Q) * np.linalg.norm(W)) / float(S[0, 0])
    shown, pushed = _shown(rim, contact, sense)
    slip = np.concatenate([np.zeros(m), sense * contact.T[0] * omega])
    slips = ((0, len(shown)),) if contact.mu > 0.0 else ()
    return Plant(
        A=A, B=np.vstack([none.T, W.T / omega[:, None]]), C=np.hstack([contact.Q, none]), S=S,
        D=np.vstack([shown, slip]), E=np.vstack([pushed, np.zeros((1, 1))]), restitution=np.zeros(1),
        rate=math.sqrt(held) + float(np.abs(turn).sum(axis=1).max()), slips=slips, hidden=1,
    )  # fmt: skip


def _shown(rim: RotatingRim, contact: ClosedContact, sense: float) -> tuple[Array, Array]:
    """Rows of what is shown over the state, and what a unit force adds by the residual compliances."""
    m, casing, blade = contact.omega.size, contact.casing, rim.blade
    rows, pushed = np.zeros((3, 2 * m)), np.zeros((3, 1))
    rows[0, :casing] = contact.Q[0, :casing]
    a = math.radians(rim.lean_deg)
    span, flap = blade.channel("span"), blade.channel("flap")
    normal = np.array([math.cos(a), math.sin(a)]) - contact.mu * sense * np.array([-math.sin(a), math.cos(a)])
    own = blade.S[np.ix_([span, flap], [span, flap])]
    rows[1:, casing:m] = blade.rows[[span, flap]]
    pushed[1:, 0] = -own @ normal
    straight = np.array([math.cos(a), math.sin(a)])
    pushed[0, 0] = float(contact.compliance(sense)[0, 0]) - float(straight @ own @ normal)
    return rows, pushed


def _drive(rim: RotatingRim, contact: ClosedContact, base: int) -> Drive:
    """The out-of-roundness as it passes the tip; the slip's mean."""
    terms = [(p, cos, sin) for p, cos, sin in rim.terms if p > 0 and (cos or sin)]
    harmonics = np.array([p // base for p, _, _ in terms] or [1], dtype=float)
    wave = np.zeros((1, harmonics.size), dtype=complex)
    angle, sense = math.radians(rim.angle_deg), math.copysign(1.0, rim.speed)
    for k, (p, cos, sin) in enumerate(terms):
        passing = (cos + 1j * sin) * np.exp(-1j * p * angle)  # d = Re passing e^{i p Omega t}
        wave[0, k] = passing if sense > 0.0 else np.conj(passing)
    mean = rim.clearance + sum(cos for p, cos, _ in rim.terms if p == 0)
    n = 2 * contact.omega.size
    still = np.zeros((len(SHOWN) + 1, harmonics.size), dtype=complex)
    slip = rim.casing.radius * abs(rim.speed)
    return Drive(
        w=base * abs(rim.speed), harmonics=harmonics,
        b=Forcing(np.zeros(n), np.zeros((n, harmonics.size), dtype=complex)),
        c=Forcing(np.array([mean]), wave), d=Forcing(np.array([0.0] * len(SHOWN) + [slip]), still),
    )  # fmt: skip
