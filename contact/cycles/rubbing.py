"""A rotating rim against its blades over speed, clearance or friction; constant coefficients in the blades' frame.

A perfect casing's modes turn into each other, so with G as in `contact.model.gaps.permanent.ClosedContact`
(D + Omega G)^2 q + C (D + Omega G) q + K q = (Q - mu s T)^T lam,
gap = clearance + d(phi_0 - Omega t) + Q q + (S_nn - mu s S_nt) lam + lam/stiffness:
the out-of-roundness d forces the motion, once a turn and at its harmonics.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import reduce
from typing import Literal

import numpy as np

from contact.base.arrays import Array, require_count, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.cycles.driven import looks_of
from contact.cycles.known import Known
from contact.cycles.passage import Motion
from contact.cycles.switched import Complex, Drive, Forcing, Plant
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, rub_contact
from contact.model.gaps.rub import Rub, rub_of
from contact.model.gaps.rub_laws import RimProfile
from contact.model.law import Abradable
from contact.model.speed import Speed
from contact.record.wear import Wear
from contact.stability.closed_contact import first_order

SHOWN = ("casing", "span", "flap")
Parameter = Literal["speed_hz", "clearance", "friction"]
BY_RUNS = "simulate with ct.run or casingfem rub"


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RimFamily:
    """A rim, or a rub of several tips, over its speed [Hz], clearance [m] or friction, sliding all the time.

    Shown are the casing's radial motion at a tip, and the blade's there along span and flap: `casing`, `span`, `flap`,
    of several tips `casing_1` and so on. `stiffness` [N/m] is that of a coating under each tip (`as_worn`). The orbit's
    period is that of the out-of-roundness, one turn over the common divisor of its harmonics; in a casing at rest each
    place sees it at the passing of every blade.

    Raises SplitError for a casing that is not perfect. Raises InputError for problems without a periodic motion in this
    frame, or that are not supported: a closing, gravity, loads, whirl that does not repeat after whole turns, a profile
    by a table, axial friction.

    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0, zeta=0.01), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": 1e-8 * np.eye(2)}
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.01], **seen)
    >>> lobes = [{"p": 2, "cos": 1e-4, "sin": 0.0}]
    >>> rim = ct.RotatingRim(casing, blade, clearance=5e-5, speed_hz=5.0, lean_deg=10.0, out_of_roundness=lobes)
    >>> ct.cycles.RimFamily(rim=rim, mu=0.1).channels
    ('casing', 'span', 'flap')
    """

    rim: RotatingRim | Rub
    name: Parameter = "speed_hz"
    mu: float = 0.0
    stiffness: float = math.inf
    looks: int | None = None

    def __post_init__(self) -> None:
        require_not_negative(friction=self.mu)
        if not self.stiffness > 0.0:
            raise InputError(f"stiffness: found {self.stiffness!r} N/m, expected > 0 (inf: no coating)")
        if self.looks is not None:
            require_count(8, looks=self.looks)
        if self.name not in ("speed_hz", "clearance", "friction"):
            raise InputError(f"name: found {self.name!r}, expected 'speed_hz', 'clearance' or 'friction'")
        _require_periodic(self.rub, self.mu)
        rub_contact(self.rub, mu=self.mu)

    @property
    def rub(self) -> Rub:
        """The rub; a rotating rim as a rub with one tip."""
        rub: Rub = rub_of(self.rim)
        return rub

    @property
    def channels(self) -> tuple[str, ...]:
        """Displacements whose amplitude is reported."""
        tips = len(self.rub.tips)
        return SHOWN if tips == 1 else tuple(f"{name}_{j + 1}" for j in range(tips) for name in SHOWN)

    @property
    def begin(self) -> Array:
        """State in which runs start: the bodies at rest, or as given."""
        rub = self.rub
        parts = [
            [np.zeros(body.omega.size) if part is None else np.asarray(part) / scale
             for part, scale in ((start.displacement, 1.0), (start.velocity, body.omega))]
            for body, start in zip(rub.bodies, rub.starts, strict=True)
        ]  # fmt: skip
        return np.concatenate([part[i] for i in (0, 1) for part in parts])

    def at(self, value: float) -> tuple[Motion, float]:
        """Motion at a value of the parameter, and the period of the out-of-roundness [s]."""
        rub, mu = self.rub, self.mu
        if self.name == "friction":
            mu = value
        elif self.name == "clearance":
            rub = replace(rub, clearance=value)
        else:
            rub = replace(rub, speed=Speed.constant(value))
        speed = rub.speed.omega(0.0)
        if speed == 0.0:
            raise InputError("speed_hz: found 0 Hz, expected another speed")
        contact = rub_contact(rub, mu=mu)
        plant = _plant(rub, contact, speed, self.stiffness)
        waves = _waves(rub, math.copysign(1.0, speed))
        base = reduce(math.gcd, [order for order in waves if order > 0] or [1])
        period = 2.0 * math.pi / (base * abs(speed))
        drive = _drive(rub, contact, speed, waves, base)
        step = looks_of(period, plant.rate, self.looks)
        return Motion(plant=plant, drive=drive, step=step, known=Known(plant)), period


def as_worn(rub: Rub, law: Abradable, wear: Wear, harmonics: int) -> tuple[Rub, float]:
    """The rub with its coating as a run has worn it: profile as `harmonics`, and stiffness of the coating [N/m].

    Under the tip's land the mean of the worn surface acts, and all its bars act together. The coating wears no further.
    Raises InputError for tips on several tracks.

    >>> import contact as ct
    >>> from contact.record.wear import Wear
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0, zeta=0.01), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": 1e-8 * np.eye(2)}
    >>> rub = ct.Rub(casing, (ct.ModalBody(omega=[900.0], zeta=[0.01], **seen),), speed=ct.Speed.constant(20.0))
    >>> coating = ct.Abradable(E=1e8, yield_stress=1e5, hardening=1e5, thickness=3e-3, width=0.02, tip=0.01)
    >>> angle = np.arange(1884) * 2.0 * np.pi / 1884.0  # bars, six under the land of a tip
    >>> flat = np.zeros(angle.size)
    >>> worn = Wear(angle=angle, made=flat, cut=flat, worn=flat + 1e-5, map_time=[], map=[[]], volume=0.0, stated=0.0,
    ...             dissipated=0.0, bare=0)  # as `result.wear` of a run
    >>> rub, stiffness = as_worn(rub, coating, worn, harmonics=3)
    >>> f"{stiffness:.3g} N/m"
    '6.67e+06 N/m'
    """
    require_count(harmonics=harmonics)
    if len(wear.tips) != len(rub.tips):
        raise InputError(
            f"wear: found the wear of {len(wear.tips)} tips, expected one track of all {len(rub.tips)} tips"
        )
    under = np.arange(law.bars) - (law.bars - 1) // 2
    felt = np.mean([np.roll(wear.after, -int(k)) for k in under], axis=0)
    middle = wear.angle + float(under.mean()) * 2.0 * math.pi / felt.size
    orders = np.arange(harmonics + 1)
    share = np.exp(1j * np.outer(orders, middle)) @ felt * np.where(orders == 0, 1.0, 2.0) / felt.size
    profile = RimProfile(tuple((int(p), float(z.real), float(z.imag)) for p, z in zip(orders, share, strict=True)))
    return replace(rub, profile=profile), law.under_tip


def _require_periodic(rub: Rub, mu: float) -> None:
    """Raise InputError for a problem whose period is not a turn, or that is not supported."""
    refused = {
        "closing": bool(np.any(rub.closing.by)), "gravity": bool(rub.forces),
        "profile": rub.profile.theta is not None, "tips.axial": mu > 0.0 and rub.dimensions == 3,
        "load": any(start.load is not None and np.any(start.load) for start in rub.starts),
        "whirl": any(whirl.hz != 0.0 or whirl.per_rev % 1.0 for whirl in rub.whirl),
    }  # fmt: skip
    for name, found in refused.items():
        if found:
            raise InputError(f"{name}: found one, expected none for periodic motions of a rub; {BY_RUNS}")
    for name, body in zip(rub.names, rub.bodies, strict=True):
        require_positive(**{f"{name}.omega, the lowest": float(body.omega.min())})


def _plant(rub: Rub, contact: ClosedContact, speed: float, stiffness: float) -> Plant:
    """State space of `first_order`.

    The outputs are those in `SHOWN`, then the slip of each tip in the direction of rotation.
    """
    k, sense, m = len(contact.Q), math.copysign(1.0, speed), contact.omega.size
    bodies, (C, K) = first_order(contact, speed), contact.matrices(speed)
    shown, pushed = _shown(rub, contact, sense)
    S = bodies.S + np.eye(k) / stiffness
    W = contact.pushes(sense)
    fastest = float(np.linalg.norm(K, 2) + np.linalg.norm(W.T @ np.linalg.solve(S, contact.Q), 2))
    carried = np.linalg.norm(C, 2) + np.abs(speed * contact.G).sum(axis=1).max()
    slips = sense * contact.T * contact.rates
    return Plant(
        A=bodies.A, B=bodies.B, C=bodies.C, S=S, D=np.vstack([shown, np.hstack([np.zeros((k, m)), slips])]),
        E=np.vstack([pushed, np.zeros((k, k))]), restitution=np.zeros(k), rate=math.sqrt(fastest) + float(carried),
        slips=tuple((j, len(shown) + j) for j in range(k)) if contact.mu > 0.0 else (), hidden=k,
    )  # fmt: skip


def _shown(rub: Rub, contact: ClosedContact, sense: float) -> tuple[Array, Array]:
    """Rows of the outputs over the state, and their static response to unit forces at the tips."""
    m, k = contact.omega.size, len(rub.tips)
    rows, pushed = np.zeros((3 * k, 2 * m)), np.zeros((3 * k, k))
    rows[::3, : contact.casing] = contact.Q[:, : contact.casing]
    pushed[::3] = contact.compliance(sense)
    first = np.cumsum([0, *(body.omega.size for body in rub.bodies)])
    for i, tip in enumerate(rub.tips):
        blade = rub.blades[tip.blade]
        seen = [blade.channel(tip.span), blade.channel(tip.flap)]
        rows[3 * i + 1 : 3 * i + 3, first[tip.blade + 1] : first[tip.blade + 2]] = blade.rows[seen]
        normal = tip.directions(blade)[0]
        for j, other in enumerate(rub.tips):
            if other.blade == tip.blade:
                along = other.directions(blade)
                moved = blade.S @ (along[0] - contact.mu * sense * along[1])
                pushed[3 * i, j] -= normal @ moved
                pushed[3 * i + 1 : 3 * i + 3, j] = -moved[seen]
    return rows, pushed


def _waves(rub: Rub, sense: float) -> dict[int, Complex]:
    """Excitation at the tips by order, from out-of-roundness and whirl: sum of Re z e^{i order |Omega| t}, (tips,)."""
    angle = np.radians([tip.angle_deg for tip in rub.tips])
    terms = [(p, (cos + 1j * sin) * np.exp(-1j * p * angle)) for p, cos, sin in rub.profile.terms]
    terms += [
        (1 + int(whirl.per_rev), whirl.amplitude * np.exp(-1j * (angle - math.radians(whirl.phase_deg))))
        for whirl in rub.whirl
    ]
    found: dict[int, Complex] = {}
    for p, z in terms:
        order = int(p * sense)
        found[abs(order)] = found.get(abs(order), 0j) + (z if order >= 0 else z.conj())
    return {order: z for order, z in found.items() if np.any(z)}


def _drive(rub: Rub, contact: ClosedContact, speed: float, waves: dict[int, Complex], base: int) -> Drive:
    """Forcing by the out-of-roundness as it passes the tips, and mean slips."""
    k, n = len(rub.tips), 2 * contact.omega.size
    orders = [order for order in waves if order > 0] or [base]
    wave = np.stack([waves.get(order, np.zeros(k)) + 0j for order in orders], axis=1)
    mean = np.array([rub.clearance + tip.clearance for tip in rub.tips]) + np.real(waves.get(0, np.zeros(k)))
    slip = abs(speed) * np.array([rub.casing.line_radius(tip.line) for tip in rub.tips])

    def still(rest: Array) -> Forcing:
        return Forcing(rest, np.zeros((rest.size, len(orders)), dtype=complex))

    return Drive(
        w=base * abs(speed), harmonics=np.array([order // base for order in orders], dtype=float),
        b=still(np.zeros(n)), c=Forcing(mean, wave), d=still(np.concatenate([np.zeros(3 * k), slip])),
    )  # fmt: skip
