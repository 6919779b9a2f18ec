"""A rotor on its casing over speed: growth of the free rotor, synchronous rub and its growth, dry backward whirl.

Circular motion of the disk r and of the casing s at the contact, at the angle of r - s:

    r = U Omega^2 A_r - F (1 + i mu) A_r,   r - s_1 = (c + F d) e^(i alpha),

with the receptance A_r of the rotor, the casing's wave s_1 of one nodal diameter, and the compliance d of the casing's
other waves, the blade and the law. With D = (1 + i mu) A_r + s_1/F, rotated by alpha, a synchronous rub satisfies

    |U Omega^2 A_r| = |c + F (D + d)|,

a quadratic equation for F (Black, J. Mech. Eng. Sci. 10, 1968, 1). Its growth is that of small motions p = xi + i eta
of r - s in the frame of the rotor, which change the force by (1 + i mu)(xi/d + i F eta/(c + F d)). The other waves
follow quasi-statically, so the model gives the growth of slow motions.

Without unbalance the same equations hold with a ratio tau of tangential to normal force and backward whirl at -w: Im D
= 0 gives tau(w), F = -c/(Re D + d) must be positive. If tau <= mu the rotor can roll on the casing, w = R Omega/c.
Beyond the highest such w it slips, at the w with tau = mu.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.io.columns import Column, table_lines
from contact.io.outfiles import finite
from contact.io.progress import each
from contact.io.reported import Reported
from contact.io.threads import with_one_thread
from contact.model.gaps.rub import Rub
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.rotor_rub import casing_of
from contact.model.rotor.whirl import critical_speeds, modes_at, sense_of
from contact.stability.circular import (
    Seen,
    blade_give,
    casing_receptance,
    circular_casing,
    circular_rotor,
    rotor_receptance,
)
from contact.stability.growth_map import StabilityMap, ascending
from contact.stability.rotor import of_rotor

STIFF = 1e-4  # of |D|: the least give of a contact, so that its force has a slope
BEYOND = 1.25  # times the highest frequency: whirl examined
PLACES = 2_000  # whirl frequencies examined

COLUMNS = (
    Column("speed_hz", "Speed of rotation.", lambda found: found.speed_hz, head="speed", unit="Hz", format=".6g"),
    Column("growth_1_s", "Growth of the rotor without contact, by its poles; a positive rate is unstable.",
           lambda found: found.free.growth, head="free rotor", unit="1/s", format=".4g"),
    Column("whirl_hz", "Whirl frequency of the motion that grows most or decays least, at rest.",
           lambda found: found.whirl_hz, head="whirl", unit="Hz", format=".5g"),
    Column("sense", "forward: with the rotation; backward: against it; planar: neither.",
           lambda found: found.sense, format=str),
    Column("rub_force_n", "Normal force of a synchronous rub; empty where there is none.",
           lambda found: found.rub_force, head="rub force", unit="N", format=".4g"),
    Column("rub_orbit_m", "Radius of the disk's orbit in a synchronous rub.",
           lambda found: found.rub_orbit, head="rub orbit", unit="m", format=".4g"),
    Column("rub_growth_1_s", "Growth of a small disturbance of the synchronous rub.",
           lambda found: found.rub_growth, head="rub growth", unit="1/s", format=".4g"),
    Column("dry_hz", "Frequency of dry backward whirl; empty where friction is too low for it.",
           lambda found: found.dry_hz, head="dry whirl", unit="Hz", format=".5g"),
    Column("dry", "rolling: without slip; slipping: with it.", lambda found: found.dry, head="dry whirl is",
           format=str, where="files"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RotorStability(Reported):
    """Growth of a rotor over speed (speeds,), free and on its casing; nan where there is no such motion.

    `free` has the growth of the rotor without contact [1/s] and its bands; `whirl_hz` and `sense` the motion with the
    largest growth. `rub_force` [N], `rub_orbit` [m], `rub_growth` [1/s] of the synchronous rub; `dry_hz` of dry
    backward whirl and whether it is "rolling" or "slipping". `least_friction` is the least one with which dry whirl is
    possible, `dry_from_hz` the lowest speed of dry whirl with the given friction; nan if it is impossible.

    >>> import contact as ct
    >>> rotor = ct.rotor.Rotor.of(ct.rotor.Jeffcott(mass=1.0, stiffness=100.0, zeta=0.02), 1.0)
    >>> found = ct.stability.rotor_stability(rotor, [1.0, 2.0])
    >>> found.free.growth.round(6).tolist(), found.in_casing
    ([-0.2, -0.2], False)
    """

    COLUMNS: ClassVar = COLUMNS

    free: StabilityMap
    whirl_hz: Array
    sense: tuple[str, ...]
    critical: tuple[dict[str, Any], ...]
    rub_force: Array
    rub_orbit: Array
    rub_growth: Array
    dry_hz: Array
    dry: tuple[str, ...]
    mu: float = 0.0
    dry_from_hz: float = math.nan
    least_friction: float = math.nan
    in_casing: bool = False

    @property
    def speed_hz(self) -> Array:
        """Examined speeds [turns/s]."""
        return self.free.speed_hz

    @property
    def words(self) -> str:
        """Findings over the range, in sentences."""
        low, high = float(self.speed_hz[0]), float(self.speed_hz[-1])
        inside = [one for one in self.critical if low <= one["speed_hz"] <= high]
        named = ", ".join(f"{_speed(one['speed_hz'])} {one['sense']}" for one in inside)
        words = [f"{self.free.words} Critical speeds in the range: {named or 'none'}."]
        if self.in_casing:
            words += [self._rub_words(), self._dry_words()]
        return " ".join(words)

    def _rub_words(self) -> str:
        there = np.isfinite(self.rub_force)
        if not there.any():
            return "There is no synchronous rub: the orbit stays within the clearance."
        k = int(np.where(there, self.rub_force, -1.0).argmax())
        size = f"up to {self.rub_force[k]:.3g} N and an orbit of {1e3 * self.rub_orbit[k]:.3g} mm"
        words = f"A synchronous rub exists {_ranges(self.speed_hz, there)}, with {size} at {_speed(self.speed_hz[k])}"
        if not np.isfinite(self.rub_growth[there]).any():
            return f"{words}; the rotor is not isotropic: simulate to find the growth."
        grows = there & (self.rub_growth > 0.0)
        return f"{words}; it grows {_ranges(self.speed_hz, grows)}." if grows.any() else f"{words}; it is stable."

    def _dry_words(self) -> str:
        if not math.isfinite(self.dry_from_hz):
            if not math.isfinite(self.least_friction):
                return "Dry backward whirl is impossible at any friction."
            return f"Dry backward whirl is impossible: the friction is {self.mu:g}, below {self.least_friction:.3g}."
        words = f"Dry backward whirl is possible from {_speed(self.dry_from_hz)} on"
        slips = np.array([one == "slipping" for one in self.dry])
        if not slips.any():
            return f"{words}, rolling at up to {np.nanmax(self.dry_hz):.4g} Hz."
        top = float(np.nanmax(self.dry_hz[slips]))
        return f"{words}; it slips {_ranges(self.speed_hz, slips)}, backward at up to {top:.4g} Hz."

    def to_dict(self) -> dict[str, object]:
        """The document of `casingfem stability --json`."""
        return self.free.to_dict() | {
            "rows": [finite(row) for row in self.records()], "critical_speeds": list(self.critical),
            "friction": self.mu,
            "dry_whirl": finite({"from_hz": self.dry_from_hz, "least_friction": self.least_friction}),
            "words": self.words,
        }  # fmt: skip

    def __repr__(self) -> str:
        rows = list(self.records())
        shown = rows[:: max(1, len(rows) // 20)]
        kept = [column for column in COLUMNS if any(row[column.name] not in (None, "") for row in shown)]
        return "\n".join([*table_lines(tuple(kept), shown), self.words])


@with_one_thread
def rotor_stability(what: Rotor | Rub, speed_hz: ArrayLike, *, mu: float = 0.0) -> RotorStability:
    """Growth of a rotor over speeds [turns/s]; for a rub on a rotor also that of its contact with friction `mu`.

    The unbalance is that after a release. For anisotropic bodies the mean of their circles is used.

    Raises InputError for a rub without a rotor, a casing without a pair of one nodal diameter, and unless there are at
    least two ascending speeds above 0.

    >>> import contact as ct
    >>> disk = ct.rotor.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.05)
    >>> rotor = ct.rotor.Rotor.of(disk, 70.0, unbalance=ct.rotor.Unbalance(moment=2.5e-2))
    >>> casing = ct.rotor.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1)
    >>> rub = ct.rotor.rotor_rub(rotor, casing, [ct.rotor.rigid_tip()], clearance=5e-4)
    >>> found = rotor_stability(rub, np.linspace(20.0, 100.0, 5), mu=0.1)
    >>> found.rub_force.round().tolist()
    [nan, nan, 1953.0, 5037.0, 9660.0]
    """
    speed = ascending(np.asarray(speed_hz, dtype=float))
    if not speed[0] > 0.0:
        raise InputError(f"speed_hz: found {speed[0]:g} turns/s, expected speeds above 0")
    rotor = what if isinstance(what, Rotor) else what.rotor
    if rotor is None:
        raise InputError("rub: found one without a rotor, expected one of ct.rotor.rotor_rub")
    none = np.full(speed.size, math.nan)
    freq, sense = _leading(rotor, speed)
    parts: dict[str, Any] = {
        "free": of_rotor(rotor, speed), "whirl_hz": freq, "sense": sense, "critical": tuple(critical_speeds(rotor)),
        "rub_force": none, "rub_orbit": none, "rub_growth": none, "dry_hz": none, "dry": ("",) * speed.size,
    }  # fmt: skip
    if isinstance(what, Rub):
        pair = _Pair(what, rotor, mu)
        force, orbit, rate = np.array([pair.synchronous(2.0 * math.pi * hz) for hz in each(speed.tolist(), "speed")]).T
        parts |= {"rub_force": force, "rub_orbit": orbit, "rub_growth": rate, "mu": mu, "in_casing": True}
        parts |= pair.dry_over(speed)
    return RotorStability(**parts)


def _leading(rotor: Rotor, speed_hz: Array) -> tuple[Array, tuple[str, ...]]:
    """Frequency [Hz] and sense of the whirl with the largest real part at each speed."""
    freq, senses = np.full(speed_hz.size, math.nan), []
    for k, hz in enumerate(speed_hz.tolist()):
        s, shape = modes_at(rotor, 2.0 * math.pi * hz)
        senses.append("")
        if s.size:
            most = int(s.real.argmax())
            freq[k] = s[most].imag / (2.0 * math.pi)
            senses[-1] = sense_of(rotor, shape[:, most : most + 1], math.copysign(1.0, hz))[0]
    return readonly(freq), tuple(senses)


class _Pair:
    """Rotor and casing of a rub, with one rotating contact."""

    def __init__(self, rub: Rub, rotor: Rotor, mu: float) -> None:
        self.rub, self.rotor, self.mu = rub, rotor, mu
        self.casing, self.line = casing_of(rub), rub.tips[0].line
        self.ring = circular_casing(rub)
        self.clearance = rub.clearance + min(tip.clearance for tip in rub.tips)
        self.radius = self.casing.line_radius(self.line)
        self.places = self._whirls()
        self.seen = self._casing(self.places)

    def gives(self, whirl: Array, speed: float) -> tuple[NDArray[np.complex128], Array]:
        """D with friction mu, and d, at whirl frequencies [rad/s], (w,) [m/N]."""
        seen = casing_receptance(self.casing, self.line, whirl, self.mu)
        circle = (1.0 + 1j * self.mu) * rotor_receptance(self.rotor, whirl, speed)
        return circle + seen.whirl, seen.local + blade_give(self.rub, speed, self.mu)

    def synchronous(self, speed: float) -> tuple[float, float, float]:
        """Force [N], orbit [m] and growth [1/s] of a synchronous rub at a speed [rad/s]; nan without such a rub."""
        at = np.array([speed])
        (D,), (d,) = self.gives(at, speed)
        free = abs(self.rotor.unbalance.after) * speed**2 * abs(rotor_receptance(self.rotor, at, speed)[0])
        a, b, e = abs(D + d) ** 2, self.clearance * (D + d).real, self.clearance**2 - free**2
        if not b * b - a * e >= 0.0:
            return (math.nan,) * 3
        force = (-b + math.sqrt(b * b - a * e)) / a  # the larger of two solutions, which a rub reaches
        if not force > 0.0:
            return (math.nan,) * 3
        # U Omega^2 A_r e^(-i alpha) = c + F (D + d), so that r e^(-i alpha) follows
        own = (1.0 + 1j * self.mu) * rotor_receptance(self.rotor, at, speed)[0]
        orbit = abs(self.clearance + force * (D + d) - force * own)
        return force, orbit, self._growth(speed, force, float(max(d, STIFF * abs(D))))

    def _growth(self, speed: float, force: float, give: float) -> float:
        """Growth [1/s] of small motions of a synchronous rub in the frame of the rotor."""
        shaft = circular_rotor(self.rotor, speed)
        if shaft is None:
            return math.nan
        m = len(shaft.K)
        n = m + len(self.ring.K)
        C, K = _both(shaft.C, self.ring.C), _both(shaft.K, self.ring.K)
        b = np.concatenate([-shaft.w, self.ring.w])[:, None]
        C, K = C + 2j * speed * np.eye(n), K - speed**2 * np.eye(n) + 1j * speed * C
        around = force / (self.clearance + force * give)
        slope = np.array([[1.0 / give, -self.mu * around], [self.mu / give, around]])
        stiff = _real(K) + _real(b) @ slope @ _real(2.0 * b.conj().T)
        state = np.block([[np.zeros((2 * n, 2 * n)), np.eye(2 * n)], [-stiff, -_real(C)]])
        return float(np.linalg.eigvals(state).real.max())

    def dry_over(self, speed_hz: Array) -> dict[str, Any]:
        """Dry whirl at each speed [turns/s], the least friction and the lowest speed."""
        nothing = {"dry_hz": np.full(speed_hz.size, math.nan), "dry": ("",) * speed_hz.size}
        if not self.clearance > 0.0:
            return nothing
        hz, kind = np.full(speed_hz.size, math.nan), [""] * speed_hz.size
        ratio = self.clearance / self.radius
        still = self._bands(0.0)
        found: dict[str, Any] = {"least_friction": self._least(0.0)}
        if still:
            found["dry_from_hz"] = ratio * still[0][0] / (2.0 * math.pi)
        for k, at in enumerate(speed_hz.tolist()):
            rolling, bands = 2.0 * math.pi * at / ratio, self._bands(2.0 * math.pi * at)
            below = [band for band in bands if band[0] <= rolling]
            if below:
                high = below[0][1]
                hz[k] = min(rolling, high) / (2.0 * math.pi)
                kind[k] = "rolling" if rolling <= high else "slipping"
        return found | {"dry_hz": readonly(hz), "dry": tuple(kind)}

    def _ratio(self, whirl: Array, speed: float) -> tuple[Array, NDArray[np.bool_]]:
        """tau(w) of backward whirl at `whirl` > 0 [rad/s], and whether its contact force is positive."""
        plain, dragged = self.seen if whirl is self.places else self._casing(whirl)
        rotor = rotor_receptance(self.rotor, -whirl, speed)
        whole, more = rotor + plain.whirl, 1j * rotor + dragged.whirl - plain.whirl
        tau = -whole.imag / more.imag
        give = plain.local + tau * (dragged.local - plain.local) + blade_give(self.rub, speed, self.mu)
        return tau, ((whole + tau * more).real + give < 0.0) & (tau >= 0.0)

    def _casing(self, whirl: Array) -> tuple[Seen, Seen]:
        """The casing's motion due to a normal force, and due to a tangential force of the same size."""
        plain, dragged = (casing_receptance(self.casing, self.line, -whirl, tau) for tau in (0.0, 1.0))
        return plain, dragged

    def _whirls(self) -> Array:
        """Examined whirl frequencies [rad/s], dense near those of both bodies."""
        rates = np.concatenate([self.rotor.body.omega, np.abs(np.linalg.eigvals(self.ring.K)) ** 0.5])
        top = BEYOND * float(rates.max())
        near = (rates[:, None] * (1.0 + np.linspace(-0.05, 0.05, 41))).ravel()
        places = np.concatenate([np.linspace(top / PLACES, top, PLACES), near[near > 0.0]])
        return np.unique(places)

    def _least(self, speed: float) -> float:
        tau, pushes = self._ratio(self.places, speed)
        return float(tau[pushes].min()) if pushes.any() else math.nan

    def _bands(self, speed: float) -> list[tuple[float, float]]:
        """Whirl frequencies [rad/s] with tau <= mu, ascending; roots at their ends, else points between."""
        from scipy.optimize import brentq

        def beyond(w: float) -> float:
            tau, pushes = self._ratio(np.array([w]), speed)
            return float(tau[0]) - self.mu if pushes[0] else math.inf

        places = self.places
        tau, pushes = self._ratio(places, speed)
        inside = pushes & (tau <= self.mu)
        edges = np.flatnonzero(np.diff(inside.astype(int)))
        cut = []
        for k in edges.tolist():
            a, b = float(places[k]), float(places[k + 1])
            if pushes[k] and pushes[k + 1] and speed == 0.0:
                cut.append(float(brentq(beyond, a, b, xtol=1e-10 * b)))
            elif pushes[k] and pushes[k + 1]:
                share = (self.mu - tau[k]) / (tau[k + 1] - tau[k])
                cut.append(float(a + share * (b - a)))
            else:
                cut.append(a if inside[k] else b)
        ends = [*([float(places[0])] if inside[0] else []), *cut, *([float(places[-1])] if inside[-1] else [])]
        return list(zip(ends[::2], ends[1::2], strict=True))


def _both(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> NDArray[np.complex128]:
    m, n = len(first), len(second)
    found = np.zeros((m + n, m + n), dtype=complex)
    found[:m, :m], found[m:, m:] = first, second
    return found


def _real(X: NDArray[Any]) -> Array:
    """A complex matrix as a real one on real and imaginary parts."""
    return np.block([[X.real, -X.imag], [X.imag, X.real]])


def _speed(hz: float) -> str:
    return f"{hz:.4g} Hz ({60.0 * hz:,.5g} rpm)"


def _ranges(speed: Array, there: NDArray[np.bool_]) -> str:
    """Intervals of speed with a property."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], there.astype(int), [0]])))
    parts = zip(speed[edges[::2]], speed[edges[1::2] - 1], strict=True)
    return " and ".join(
        f"at {_speed(a)}" if a == b else f"from {a:.4g} to {b:.4g} Hz ({60.0 * a:,.5g} to {60.0 * b:,.5g} rpm)"
        for a, b in parts
    )
