"""Where a wave of the casing meets a mode of the blades, and what that does: closed forms and words.

A wave e^(i k theta) of frequency w in the casing's frame is seen by the blade at nu = +-w - k Omega. Of a body that
turns w depends on the speed, on the stiffening and on the sense of the wave: it is taken as it is at each speed. Near
it the receptance is a/(s - i nu), of a blade mode b/(s - i w_b). With S all that is left,
S + a/(s - i nu) + b/(s - i w_b) = 0 is a quadratic: growth where a b > 0, at most sqrt(a b)/S, in a band of half width
2 sqrt(a b)/S of the difference of the two frequencies, its centre where nu + i a/S = w_b + i b/S.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.growth.growth_map import StabilityMap
from contact.growth.waves import FreePoles, Waves, waves_of
from contact.model.gaps.permanent import ClosedContact, HandPair

REACH = 4.0  # times the fastest speed: how far coincidences outside a range are looked for
LOOKS = 65  # speeds at which frequencies are compared up to there
AT_REST = 1e-12  # of a frequency: waves and modes that are nearer at rest are equal there
SECANTS, MET = 40, 1e-13  # steps of a root, and the difference of the frequencies that ends them, relative
SEEN = 1e-9  # of the largest residue: one contact does not see less
NEAR = 0.05  # of the speed: by how much several contacts may shift a coincidence
ALIKE = 0.05  # of two bodies seen alike: less is what meshes and round-off add


@dataclass(frozen=True, slots=True, kw_only=True)
class Coincidence:
    """One wave of n diameters meets one blade mode.

    `branch` "sum" f_b = n f - f_c, "backward" f_b = f_c - n f or "forward" f_b = f_c + n f; `free_hz` the speed without
    contact, `speed_hz` with it, `half_hz` the half width of what it disturbs, `growth` [1/s] at its centre (0 or less:
    none); `drives` whether the two exchange energy so that both grow, damping aside.
    """

    n: int
    branch: str
    casing_hz: float
    blade_hz: float
    free_hz: float
    speed_hz: float
    half_hz: float
    growth: float
    drives: bool


class Loaded(NamedTuple):
    """Loaded frequencies [Hz] of casing and blade, the speed [Hz] of their sum, and the growth there [1/s]."""

    casing_hz: float
    blade_hz: float
    speed_hz: float
    growth: float


def loaded(pair: HandPair) -> Loaded:
    """The frictionless hand calculation: each body on the contact's spring k, then f_c' + f_b' = n f.

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
    """Every meeting of a wave of the casing with a mode of the blades, ascending, at the senses of these speeds [Hz].

    They are looked for up to `REACH` times the fastest speed, by the frequencies that both have at each speed. Several
    contacts meet a wave and a mode that they see alike, |sum of products| above `ALIKE` of the largest there can be,
    which by n diameters a disk's tuned modes do only with theirs; what happens there, poles tell.
    """
    seen = waves_of(contact)
    top = REACH * 2.0 * math.pi * float(np.abs(speed_hz).max())
    found = []
    for sense in (1.0, -1.0):
        if not np.any(np.sign(speed_hz) == sense):
            continue
        for speed, wave, mode in _crossings(seen, sense, top):
            free = seen.poles(np.array([speed]), sense)
            if free is not None and _met(free, wave, mode):
                found.append(_meeting(contact, free, wave, mode, speed, _slope(seen, sense, speed, wave, mode)))
    return tuple(sorted(_each_once(found), key=lambda c: c.speed_hz))


def _crossings(seen: Waves, sense: float, top: float) -> list[tuple[float, int, int]]:
    """(speed [rad/s], wave, mode) at which a wave's frequency in the blade's frame is a mode's, up to a speed `top`."""
    at = sense * np.linspace(0.0, top, LOOKS)
    free = seen.poles(at, sense)
    if free is None:
        return []
    waves = np.flatnonzero(free.casing & (free.order != 0.0))
    modes = np.flatnonzero(~free.casing & (free.sign > 0.0))

    def frequencies(found: FreePoles, speed: Array) -> tuple[Array, Array]:
        """Of waves and of what they shall meet, (speeds, waves), (speeds, modes)."""
        met = found.met(speed)
        return met[:, waves], met[:, modes]

    one, other = frequencies(free, at)
    apart = one[:, :, None] - other[:, None, :]
    apart[0][np.abs(apart[0]) < AT_REST * np.abs(other[0])] = 0.0  # equal at rest, which is no speed
    k, i, j = np.nonzero((apart[:-1] * apart[1:] < 0.0) | ((apart[1:] == 0.0) & (apart[:-1] != 0.0)))
    if not k.size:
        return []
    row, speed = np.arange(k.size), at[k]
    low, high, below, above = at[k], at[k + 1], apart[k, i, j], apart[k + 1, i, j]
    for _ in range(SECANTS):
        speed = (low * above - high * below) / (above - below)
        found = seen.poles(speed, sense)
        if found is None:
            return []
        one, other = frequencies(found, speed)
        middle = one[row, i] - other[row, j]
        if np.all(np.abs(middle) <= MET * np.abs(free.s.imag).max()):
            break
        before = middle * below > 0.0
        low, below = np.where(before, speed, low), np.where(before, middle, below)
        high, above = np.where(before, high, speed), np.where(before, above, middle)
    return list(zip(speed.tolist(), waves[i].tolist(), modes[j].tolist(), strict=True))


def _slope(seen: Waves, sense: float, speed: float, wave: int, mode: int) -> float:
    """Derivative of the wave's frequency less the mode's by the speed [-]; -k where neither depends on it."""
    step = 1e-4 * abs(speed)
    at = np.array([speed - step, speed + step])
    free = seen.poles(at, sense)
    if free is None:
        return math.nan
    apart = free.met(at)[:, wave] - free.met(at)[:, mode]
    return float(apart[1] - apart[0]) / (2.0 * step)


def _met(free: FreePoles, wave: int, mode: int) -> bool:
    """Whether the contacts see both: one contact by their residues, several where both move them alike."""
    if free.seen.shape[1] == 1:
        size = np.abs(free.residues[0])
        return bool(size[[wave, mode]].min() > SEEN * float(size.max()))
    one, other = free.seen[0, :, wave], free.seen[0, :, mode]
    return bool(abs(np.vdot(one, other)) > ALIKE * np.linalg.norm(one) * np.linalg.norm(other))


def _meeting(contact: ClosedContact, free: FreePoles, wave: int, mode: int, speed: float, slope: float) -> Coincidence:
    """The quadratic of one wave and one mode, everything else a compliance S."""
    turn, order, sign = 2.0 * math.pi, float(free.order[wave]), float(free.sign[wave])
    own = free.own(np.array([speed]))[0]
    known: dict[str, Any] = {
        "n": round(abs(order)), "branch": _branch(sign, speed * order), "casing_hz": abs(float(own[wave])) / turn,
        "blade_hz": float(own[mode]) / turn, "free_hz": speed / turn,
    }  # fmt: skip
    if len(contact.Q) > 1:
        return Coincidence(
            **known, speed_hz=speed / turn, half_hz=NEAR * abs(speed) / turn, growth=math.nan, drives=sign < 0.0
        )
    s, a, others = free.s[0], free.residues[0], np.ones(free.order.size, dtype=bool)
    others[[wave, mode]] = False
    S = float(contact.compliance(np.sign(speed))[0, 0])
    S += float(np.sum(a[others] / (1j * own[mode] - s[others])).real)
    moved = s - a / S  # poles of wave and mode, each alone on the compliance
    coupling = complex(a[wave] * a[mode]) / S**2
    centre = speed - float((a[mode] - a[wave]).imag) / S / slope
    mean, apart = 0.5 * (moved[wave] + moved[mode]).real, 0.5 * (moved[wave] - moved[mode]).real
    growth = float(mean + abs(np.sqrt(complex(apart**2) + coupling).real))
    return Coincidence(
        **known, speed_hz=centre / turn, half_hz=2.0 * abs(coupling) ** 0.5 / abs(slope) / turn, growth=growth,
        drives=coupling.real > 0.0,
    )  # fmt: skip


def _each_once(found: list[Coincidence]) -> list[Coincidence]:
    """Meetings of modes of one frequency, such as a disk's pairs, count once."""
    return list(
        {(c.n, c.branch, round(c.casing_hz, 6), round(c.blade_hz, 6), c.free_hz > 0.0): c for c in found}.values()
    )


def _branch(sign: float, turned: float) -> str:
    return "sum" if sign < 0.0 else "backward" if turned > 0.0 else "forward"


def close_speeds(met: tuple[Coincidence, ...]) -> Array:
    """Speeds [Hz] at and around each coincidence that show its band."""
    steps = np.linspace(-2.0, 2.0, 17)
    return np.concatenate([np.zeros(0), *(c.speed_hz + c.half_hz * steps for c in met)])


def in_words(contact: ClosedContact | None, met: tuple[Coincidence, ...], found: StabilityMap) -> str:
    """What applies in the range of a map and why, a few sentences."""
    low, high = float(found.speed_hz[0]), float(found.speed_hz[-1])
    said = [_verdict(found), *_sum_words(contact, met, low, high), *_difference_words(met, low, high)]
    away = any(all(abs(c.speed_hz - speed) > 2.0 * c.half_hz for c in met) for band in found.bands_hz for speed in band)
    if contact is not None and len(contact.Q) == 1 and contact.mu > 0.0 and away:
        said += _creep_words(contact, 0.5 * (low + high))
    return " ".join(said)


def _creep_words(contact: ClosedContact, speed_hz: float) -> list[str]:
    """Friction on the casing alone: its residue a has a real part, so that a wave grows at |Re a|/S, damping aside."""
    sense, speed = math.copysign(1.0, speed_hz), np.array([2.0 * math.pi * speed_hz])
    free = waves_of(contact).poles(speed, sense)
    if free is None:
        return []
    waves = free.casing & (free.order != 0.0)
    rate = np.abs(free.residues[0, waves].real) / float(contact.compliance(sense)[0, 0])
    damping = rate / np.abs(free.own(speed)[0, waves])
    return [
        f"Away from coincidences friction along the casing feeds a travelling wave at up to {rate.max():.2g} 1/s, "
        f"which a damping ratio of {damping.max():.2g} holds."
    ]


def _verdict(found: StabilityMap) -> str:
    low, high = found.speed_hz[0], found.speed_hz[-1]
    if not found.diverges:
        return f"Closed contact does not diverge from {low:.6g} to {high:.6g} Hz."
    bands = ", ".join(f"{a:.5g}-{b:.5g} Hz" for a, b in found.bands_hz)
    return f"Closed contact diverges in {bands}, fastest at {found.peak_speed_hz:.5g} Hz."


def _nearest(met: tuple[Coincidence, ...], low: float, high: float) -> Coincidence:
    """The coincidence in the range, or nearest to it; among several in it the one that grows fastest."""
    return min(met, key=lambda c: (max(low - c.speed_hz, c.speed_hz - high, 0.0), -c.growth))


def _sum_words(
    contact: ClosedContact | None, met: tuple[Coincidence, ...], low: float, high: float
) -> list[str]:  # fmt: skip
    """The sum condition: met, met elsewhere, or out of reach because n f stays below every f_c."""
    sums, fastest = tuple(c for c in met if c.branch == "sum" and c.speed_hz * (low + high) >= 0.0), max(-low, high)
    if not sums:
        return _no_sum_words(contact, fastest)
    c = _nearest(sums, low, high)
    if low <= c.speed_hz <= high:
        return [
            f"The sum condition f_c + f_b = n f (n = {c.n}) is met at {c.speed_hz:.5g} Hz "
            f"({c.free_hz:.5g} Hz without contact): {_effect(c)}."
        ]
    if all(other.n * fastest < other.casing_hz for other in sums):
        return [
            f"n f = {c.n * fastest:.4g} Hz < f_c = {c.casing_hz:.4g} Hz: the sum condition f_c + f_b = n f cannot be "
            "met in this range, whatever the blade."
        ]
    return [f"The sum condition f_c + f_b = n f (n = {c.n}) is met at {c.speed_hz:.5g} Hz, outside this range."]


def _no_sum_words(contact: ClosedContact | None, fastest: float) -> list[str]:
    """Why the sum condition is not met up to `REACH` times the fastest speed [Hz]."""
    if contact is None or len(contact.Q) > 1:
        return []
    speed = np.array([2.0 * math.pi * fastest])
    free = waves_of(contact).poles(speed, 1.0)
    if free is None or not np.any(waves := free.casing & (free.order > 0.0) & (free.sign > 0.0)):
        return []
    casing_hz, n = free.own(speed)[0, waves] / (2.0 * math.pi), free.order[waves]
    k, reach = int(np.argmax(n / casing_hz)), f"{REACH * fastest:.4g} Hz"
    said = [f"The sum condition f_c + f_b = n f is not met up to {reach}."]
    if n[k] * fastest < casing_hz[k]:
        said = [
            f"n f = {n[k] * fastest:.4g} Hz < f_c = {casing_hz[k]:.4g} Hz: the sum condition f_c + f_b = n f cannot be "
            "met in this range, whatever the blade."
        ]
    if contact.turns == "casing" and contact.gyroscopic is not None:
        said.append(f"The casing turns: the blade overtakes none of its waves up to {reach}.")
    return said


def _difference_words(met: tuple[Coincidence, ...], low: float, high: float) -> list[str]:
    """The difference condition: a forced resonance unless the blade digs."""
    differences = tuple(c for c in met if c.branch != "sum" and c.speed_hz * (low + high) >= 0.0)
    if not differences:
        return []
    c = _nearest(differences, low, high)
    sign = "-" if c.branch == "backward" else "+"
    place = "" if low <= c.speed_hz <= high else ", outside this range"
    return [
        f"The difference condition f_b = f_c {sign} n f (n = {c.n}) is met at {c.speed_hz:.5g} Hz{place}: {_effect(c)}."
    ]


def _effect(c: Coincidence) -> str:
    """What a coincidence does."""
    if c.branch == "sum":
        if not c.drives:
            return "no flutter, because friction drives the blade into the casing (mu > tan(lean))"
        return "flutter, even without friction" if c.growth > 0.0 else "flutter, which damping holds down"
    if not c.drives:
        return "a forced resonance, no flutter unless mu > tan(lean)"
    return (
        "flutter, mu > tan(lean)" if c.growth > 0.0 else "mu > tan(lean) would drive flutter, which damping holds down"
    )
