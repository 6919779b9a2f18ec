"""Speeds at which a wave of the casing coincides with a mode of the blades, and the affected width, in closed form.

A wave e^(i k theta) of frequency w in the casing's frame has the frequency nu = +-w - k Omega in the blade's frame. For
a rotating body w depends on the speed, on the stiffening and on the sense of the wave; its value at each speed is used.
Near it the receptance is a/(s - i nu), for a blade mode b/(s - i w_b). With S for the rest, S + a/(s - i nu) + b/(s - i
w_b) = 0 is a quadratic: growth where a b > 0, at most sqrt(a b)/S, in a band of half width 2 sqrt(a b)/S of the
difference of the two frequencies, its centre where nu + i a/S = w_b + i b/S.

A blade faster than a wave, Omega > w/k, pushes the wave before itself: there nu passes 0. With the wave's conjugate,
S + a/(s - i nu) + a*/(s + i nu) = 0. Growth without oscillation is at most |a|/S, in a band of half width |a|/S around
nu = -|a|/S.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.model.gaps.permanent import ClosedContact, HandPair
from contact.stability.together import roots
from contact.stability.waves import FreePoles, Waves, waves_of

REACH = 4.0  # times the fastest speed: coincidences up to there, whose bands may extend into the range
LOOKS = 65  # speeds at which frequencies are compared
AT_REST = 1e-12  # of a frequency: waves and modes that are nearer at rest are equal there
MET = 1e-13  # of the largest frequency: difference of two that coincide
SEEN = 1e-9  # of the largest residue: one contact does not see less
TOGETHER = 1e-6  # of a blade mode's frequency: modes that are nearer meet a wave together, as a disk's pairs do
ALIKE = 0.05  # of two bodies seen alike: less is what meshes and round-off add
STEP = 1e-4  # of the speed, for a derivative by it
WITHIN = readonly(np.linspace(-2.0, 2.0, 17))  # speeds that resolve a band, in half widths from its centre
STILL = -1  # in place of a blade mode: a motion that stands still in the blade's frame


@dataclass(frozen=True, slots=True, kw_only=True)
class Coincidence:
    """Coincidence of one wave of n diameters with one blade mode.

    `branch` "sum" f_b = n f - f_c, "backward" f_b = f_c - n f or "forward" f_b = f_c + n f; `free_hz` the speed without
    contact, `speed_hz` with it, `half_hz` the half width of the affected speeds.
    """

    n: int
    branch: str
    casing_hz: float
    blade_hz: float
    free_hz: float
    speed_hz: float
    half_hz: float


class Loaded(NamedTuple):
    """Loaded frequencies [Hz] of casing and blade, speed [Hz] of their sum, and the growth there [1/s]."""

    casing_hz: float
    blade_hz: float
    speed_hz: float
    growth: float


def loaded(pair: HandPair) -> Loaded:
    """Frictionless hand calculation: each body on the contact's spring k, then f_c' + f_b' = n f.

    w_b'^2 = w_b^2 + k/m_b, w_c'^2 = w_c^2 + k/(2 m_c), s = k/sqrt(8 m_b m_c w_b' w_c'), and with damping
    growth = -(a + b)/2 + sqrt(((a - b)/2)^2 + s^2), a = zeta_b w_b, b = zeta_c w_c.

    >>> from contact.model.gaps.permanent import ModalPair
    >>> found = loaded(HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                         blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4))
    >>> round(found.growth, 4), round(found.speed_hz, 3)
    (3.7868, 52.844)
    """
    k, casing, blade = 1.0 / pair.compliance, pair.casing, pair.blade
    w_c = math.sqrt(casing.omega**2 + 0.5 * k / casing.modal_mass)
    w_b = math.sqrt(blade.omega**2 + k / blade.modal_mass)
    s = k / math.sqrt(8.0 * blade.modal_mass * casing.modal_mass * w_b * w_c)
    a, b = blade.zeta * blade.omega, casing.zeta * casing.omega
    growth = -0.5 * (a + b) + math.hypot(0.5 * (a - b), s)
    turn = 2.0 * math.pi
    return Loaded(w_c / turn, w_b / turn, (w_c + w_b) / turn / casing.n, growth)


def coincidences(contact: ClosedContact, speed_hz: Array) -> tuple[Coincidence, ...]:
    """All coincidences of casing waves with blade modes, ascending, for the senses of rotation of these speeds [Hz].

    The frequencies of both are those at each speed. Contact moves a coincidence and has a band around it, so that
    coincidences are sought up to `REACH` times the fastest speed. Where the matrices of a body are not known
    (`ClosedContact.known_speeds`), those of the nearest known speed are used. With several contacts a wave and a mode
    coincide only if their motions there are similar: |sum of products| above `ALIKE` of its largest possible value. So
    a wave of n diameters coincides only with a tuned disk's modes of n diameters. The poles decide whether the motion
    grows there.
    """
    found = [
        _meeting(contact, free, wave, mode, at, slope)
        for at, wave, mode, free, slope in _places(contact, speed_hz, modes=True)
        if _met(free, wave, mode)
    ]
    return tuple(sorted(_each_once(found), key=lambda c: c.speed_hz))


def overtaken_speeds(contact: ClosedContact, speed_hz: Array) -> Array:
    """Speeds [Hz] in and around each band in which the contacts may drive a wave that they overtake.

    Several contacts: their compliances and the response of all else are a matrix S, the wave's motion there is seen and
    the force that drives it pushed. With g = pushed S^-1 seen the wave has the frequency nu + |g|, and it may grow by
    at most |h|, h = pushed S^-1 seen* from its conjugate: 0 for a tuned disk, unless its blades see both alike.
    """
    found = [np.zeros(0)]
    for at, wave, _, free, slope in _places(contact, speed_hz, modes=False):
        centre, half = _overtaken(contact.compliance(math.copysign(1.0, at)), free, wave)
        found.append((at + (centre + half * WITHIN) / slope) / (2.0 * math.pi))
    return np.concatenate(found)


class Place(NamedTuple):
    """A speed [rad/s] where a wave meets a mode, the free poles there, and the slope of their difference by speed."""

    at: float
    wave: int
    mode: int
    free: FreePoles
    slope: float


def _places(contact: ClosedContact, speed_hz: Array, *, modes: bool) -> Iterator[Place]:
    """Where waves meet modes or, without `modes`, stand still, in the senses of rotation of these speeds [Hz]."""
    seen = waves_of(contact)
    for sense in (1.0, -1.0):
        speeds = 2.0 * math.pi * np.abs(speed_hz[np.sign(speed_hz) == sense])
        if not speeds.size:
            continue
        crossings = _crossings(seen, sense, REACH * float(speeds.max()), modes=modes)
        speed = np.array([at for at, _, _ in crossings])
        near = (seen.poles_each(speed * by, sense) for by in (1.0 - STEP, 1.0, 1.0 + STEP))
        for (at, wave, mode), below, here, above in zip(crossings, *near, strict=True):
            if here is not None:
                yield Place(at, wave, mode, here, _slope(below, above, at, wave, mode))


def _overtaken(compliance: Array, free: FreePoles, wave: int) -> tuple[float, float]:
    """Centre and half width of the frequencies nu [rad/s] at which a wave grows; see `overtaken_speeds`."""
    s, seen, pushed = free.s[0], free.seen[0], free.pushed[0]
    conjugate = int(np.argmin(np.abs(s - np.conj(s[wave])) + np.abs(s).max() * (free.order != -free.order[wave])))
    others = np.ones(s.size, dtype=bool)
    others[[wave, conjugate]] = False
    S = compliance - (seen[:, others] / s[others]) @ pushed[others]
    both = pushed[wave] @ np.linalg.solve(S, seen[:, [wave, conjugate]])
    return float(both[0].imag), float(abs(both[1]))


def _crossings(seen: Waves, sense: float, fastest: float, *, modes: bool) -> list[tuple[float, int, int]]:
    """(speed [rad/s], wave, mode) where a wave has a mode's frequency in the blade's frame, up to the fastest [rad/s].

    Without `modes`, where a wave stands still there; its mode is `STILL`.
    """
    at = sense * np.linspace(0.0, fastest, LOOKS)
    free = seen.poles(at, sense)
    if free is None:
        return []
    waves = np.flatnonzero(free.casing & (free.order != 0.0))
    if modes:
        others = np.flatnonzero(~free.casing & (free.sign > 0.0))
    else:
        waves, others = waves[free.sign[waves] > 0.0], np.array([STILL])  # the conjugate passes 0 at the same speed

    def frequencies(found: FreePoles, speed: Array) -> tuple[Array, Array]:
        """Frequencies of waves, and of the modes with which they may coincide, (speeds, waves), (speeds, modes)."""
        met = _met_or_still(found, speed)
        return met[:, waves], met[:, others]

    one, other = frequencies(free, at)
    apart = one[:, :, None] - other[:, None, :]
    apart[0][np.abs(apart[0]) < AT_REST * np.abs(other[0])] = 0.0  # equal at rest, which is no speed
    k, i, j = np.nonzero((apart[:-1] * apart[1:] < 0.0) | ((apart[1:] == 0.0) & (apart[:-1] != 0.0)))
    if not k.size:
        return []

    def between(speed: Array, which: Indices) -> Array:
        found = seen.poles(speed, sense)
        if found is None:
            return np.full(which.size, math.nan)
        one, other = frequencies(found, speed)
        row = np.arange(which.size)
        return np.asarray(one[row, i[which]] - other[row, j[which]])

    ends, values = (at[k], at[k + 1]), (apart[k, i, j], apart[k + 1, i, j])
    speed = roots(between, ends, values, MET * float(np.abs(free.s.imag).max()))
    if np.isnan(speed).any():
        return []
    return list(zip(speed.tolist(), waves[i].tolist(), others[j].tolist(), strict=True))


def _met_or_still(free: FreePoles, speed: Array) -> Array:
    """Frequencies in the frame of the contact points, (speeds, 2 m + 1): the last, at `STILL`, is 0."""
    return np.pad(free.met(speed), ((0, 0), (0, 1)))


def _slope(below: FreePoles | None, above: FreePoles | None, speed: float, wave: int, mode: int) -> float:
    """Derivative of the wave's frequency minus the mode's with respect to speed [-]; -k if neither depends on it."""
    if below is None or above is None:
        return math.nan
    apart = [
        float(met[wave] - met[mode])
        for free, at in ((below, (1.0 - STEP) * speed), (above, (1.0 + STEP) * speed))
        for met in _met_or_still(free, np.array([at]))
    ]
    return (apart[1] - apart[0]) / (2.0 * STEP * speed)


def _met(free: FreePoles, wave: int, mode: int) -> bool:
    """Whether the contacts couple both: a single contact by residues, several if both move them alike."""
    if free.seen.shape[1] == 1:
        size = np.abs(free.residues[0])
        return bool(size[[wave, mode]].min() > SEEN * float(size.max()))
    one, other = free.seen[0, :, wave], free.seen[0, :, mode]
    return bool(abs(np.vdot(one, other)) > ALIKE * np.linalg.norm(one) * np.linalg.norm(other))


def _meeting(contact: ClosedContact, free: FreePoles, wave: int, mode: int, speed: float, slope: float) -> Coincidence:
    """The quadratic equation of one wave and one mode, or its equals, with everything else as compliances S.

    With g = pushed S^-1 seen between these motions, s - i nu + g = 0 alone, and together at most sqrt(g_wb g_bw).
    """
    turn, order, sign = 2.0 * math.pi, float(free.order[wave]), float(free.sign[wave])
    own = free.own(np.array([speed]))[0]
    known: dict[str, Any] = {
        "n": round(abs(order)), "branch": _branch(sign, speed * order), "casing_hz": abs(float(own[wave])) / turn,
        "blade_hz": float(own[mode]) / turn, "free_hz": speed / turn,
    }  # fmt: skip
    s, seen, pushed = free.s[0], free.seen[0], free.pushed[0]
    equal = ~free.casing & (np.abs(free.s[0] - s[mode]) < TOGETHER * abs(s[mode]))
    both = np.concatenate([[wave], np.flatnonzero(equal)])
    others = ~np.isin(np.arange(s.size), both)
    S = contact.compliance(np.sign(speed)) + (seen[:, others] / (1j * own[mode] - s[others])) @ pushed[others]
    g = pushed[both] @ np.linalg.solve(S, seen[:, both])
    there, back = g[0, 1:], g[1:, 0]
    coupling = complex(there @ back)
    blade = complex(there @ g[1:, 1:] @ back) / coupling if coupling else complex(g[1, 1])
    centre = speed - (blade - complex(g[0, 0])).imag / slope
    return Coincidence(**known, speed_hz=centre / turn, half_hz=2.0 * abs(coupling) ** 0.5 / abs(slope) / turn)


def _each_once(found: list[Coincidence]) -> list[Coincidence]:
    """Coincidences with modes of equal frequency, such as a disk's pairs, counted once."""
    return list(
        {(c.n, c.branch, round(c.casing_hz, 6), round(c.blade_hz, 6), c.free_hz > 0.0): c for c in found}.values()
    )


def _branch(sign: float, turned: float) -> str:
    return "sum" if sign < 0.0 else "backward" if turned > 0.0 else "forward"


def close_speeds(met: tuple[Coincidence, ...]) -> Array:
    """Speeds [Hz] at and around each coincidence that resolve its band."""
    return np.concatenate([np.zeros(0), *(c.speed_hz + c.half_hz * WITHIN for c in met)])
