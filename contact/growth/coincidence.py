"""Where a wave of the turning body meets a mode of the standing one, and what that does: closed forms and words.

A wave e^(i k theta) of frequency w is seen by the blade at nu = +-w - k Omega, and answers near it as c/(nu_c - nu),
c = +-r/(2 w), r the product of its rows with Q and W. A blade mode answers as b/(w_b - nu), b = kappa/(2 w_b). With S
all that is left, H_c + H_b + S = 0 is a quadratic: growth where b c < 0, at most sqrt(-b c)/S, in a band of half width
2 sqrt(-b c)/S of the difference of the two frequencies, its centre (c - b)/S beyond the free coincidence.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.growth.growth_map import StabilityMap
from contact.model.gaps.permanent import ClosedContact, HandPair, equal_modes

Complex = NDArray[np.complex128]
NEAR = 0.05  # of the speed: by how much several contacts may shift a coincidence
COUPLED = 0.05  # of two bodies seen alike: less is what meshes and round-off add


class Waves(NamedTuple):
    """Waves of a body: order k, frequency [rad/s], and product of rows r, (m,) each."""

    order: Array
    omega: Array
    zeta: Array
    product: Complex


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


def waves(contact: ClosedContact, sense: float) -> Waves:
    """Modes as waves e^(i k theta), and what one contact sees of them."""
    U, order = _turning_shapes(contact)
    product = (contact.Q @ U)[0] * (U.conj().T @ contact.pushes(sense).T)[:, 0]
    return Waves(order, contact.omega, contact.zeta, product)


def coincidences(contact: ClosedContact) -> tuple[Coincidence, ...]:
    """Every meeting of a turning wave with a standing mode, at speeds of either sense, ascending.

    Raises InputError for more contacts than one.
    """
    if len(contact.Q) != 1:
        raise InputError(f"contact: found {len(contact.Q)} contacts, expected one")
    found = []
    for sense in (1.0, -1.0):
        seen = waves(contact, sense)
        strong = np.abs(seen.product) > 1e-9 * float(np.abs(seen.product).max(initial=0.0))
        turning = np.flatnonzero((np.abs(seen.order) > 0.5) & strong)
        standing = contact.casing + np.flatnonzero(strong[contact.casing :])
        for j in standing:
            for k in turning:
                for sign in (1.0, -1.0):
                    speed = (sign * seen.omega[k] - seen.omega[j]) / seen.order[k]
                    if np.sign(speed) == sense:
                        found.append(_meeting(contact, seen, int(k), int(j), sign, float(speed)))
    return tuple(sorted(found, key=lambda c: c.speed_hz))


def free_coincidences(contact: ClosedContact) -> tuple[Coincidence, ...]:
    """The meetings that several contacts see, at the speeds they have without contact; what they do, poles tell.

    A wave and a mode meet where the contacts see both alike: |sum of products| above COUPLED of the largest there can
    be, which by n diameters a disk's tuned modes do only with theirs. Modes of one frequency count once.
    """
    U, order = _turning_shapes(contact)
    seen = contact.Q @ U
    size = np.linalg.norm(seen, axis=0)
    found = []
    for j in range(contact.casing, contact.omega.size):
        for k in np.flatnonzero(np.abs(order) > 0.5):
            if abs(np.vdot(seen[:, k], seen[:, j])) <= COUPLED * size[k] * size[j]:
                continue
            for sign in (1.0, -1.0):
                speed = (sign * contact.omega[k] - contact.omega[j]) / order[k]
                if speed != 0.0:
                    found.append(_free(contact, int(k), j, float(order[k]), sign, float(speed)))
    alike = {(c.n, c.branch, round(c.casing_hz, 6), round(c.blade_hz, 6), c.free_hz > 0.0): c for c in found}
    return tuple(sorted(alike.values(), key=lambda c: c.speed_hz))


def _free(contact: ClosedContact, k: int, j: int, order: float, sign: float, speed: float) -> Coincidence:
    turn = 2.0 * math.pi
    return Coincidence(
        n=round(abs(order)), branch=_branch(sign, speed * order), casing_hz=float(contact.omega[k]) / turn,
        blade_hz=float(contact.omega[j]) / turn, free_hz=speed / turn, speed_hz=speed / turn,
        half_hz=NEAR * abs(speed) / turn,
        growth=math.nan, drives=sign < 0.0,
    )  # fmt: skip


def _branch(sign: float, turned: float) -> str:
    return "sum" if sign < 0.0 else "backward" if turned > 0.0 else "forward"


def _turning_shapes(contact: ClosedContact) -> tuple[Complex, Array]:
    """Modes as waves e^(i k theta): eigenvectors of G within groups of equal modes, (m, m), and their orders k (m,)."""
    m = contact.omega.size
    U, order = np.eye(m, dtype=complex), np.zeros(m)
    for group in equal_modes(contact.omega[: contact.casing], contact.zeta[: contact.casing]):
        block = np.ix_(group, group)
        order[group], U[block] = np.linalg.eigh(-1j * contact.G[block])
    return U, order


def _meeting(contact: ClosedContact, seen: Waves, k: int, j: int, sign: float, speed: float) -> Coincidence:
    """The quadratic of one wave and one mode, everything else a compliance S."""
    nu = seen.omega[j]
    gap = seen.omega**2 - (nu + speed * seen.order) ** 2
    others = np.ones(gap.size, dtype=bool)
    others[[k, j]] = False
    S = float(contact.compliance(np.sign(speed))[0, 0]) + float(np.sum((seen.product[others] / gap[others]).real))
    S += float(sum((seen.product[i] / (4.0 * seen.omega[i] ** 2)).real for i in (k, j)))
    c, b = sign * seen.product[k] / (2.0 * seen.omega[k]), seen.product[j] / (2.0 * seen.omega[j])
    shift = float((c - b).real) / S
    coupling = complex(b * c) / S**2
    lost = 1j * (seen.zeta[k] * seen.omega[k] - seen.zeta[j] * seen.omega[j]) + 1j * float(c.imag) / S
    mean = 0.5j * (seen.zeta[k] * seen.omega[k] + seen.zeta[j] * seen.omega[j]) + 0.5j * float(c.imag) / S
    root = np.sqrt(0.25 * lost**2 + coupling)
    growth = float(-min((mean + root).imag, (mean - root).imag))
    centre = speed + shift / float(seen.order[k])
    n, turn = round(abs(float(seen.order[k]))), 2.0 * math.pi
    branch = _branch(sign, speed * float(seen.order[k]))
    return Coincidence(
        n=n, branch=branch, casing_hz=float(seen.omega[k]) / turn, blade_hz=float(nu) / turn, free_hz=speed / turn,
        speed_hz=centre / turn, half_hz=2.0 * abs(coupling) ** 0.5 / n / turn, growth=growth,
        drives=float((b * c).real) < 0.0,
    )  # fmt: skip


def close_speeds(met: tuple[Coincidence, ...]) -> Array:
    """Speeds [Hz] at and around each coincidence that show its band."""
    steps = np.linspace(-2.0, 2.0, 17)
    return np.concatenate([np.zeros(0), *(c.speed_hz + c.half_hz * steps for c in met)])


def in_words(contact: ClosedContact | None, met: tuple[Coincidence, ...], found: StabilityMap) -> str:
    """What applies in the range of a map and why, a few sentences."""
    low, high = float(found.speed_hz[0]), float(found.speed_hz[-1])
    said = [_verdict(found), *_sum_words(met, low, high), *_difference_words(met, low, high)]
    away = any(all(abs(c.speed_hz - speed) > 2.0 * c.half_hz for c in met) for band in found.bands_hz for speed in band)
    if contact is not None and len(contact.Q) == 1 and contact.mu > 0.0 and away:
        said.append(_creep_words(contact))
    return " ".join(said)


def _creep_words(contact: ClosedContact) -> str:
    """Friction on the casing alone: r = (1 -+ i mu/n)/(2 m), so a wave grows at |Im r|/(2 w S), damping aside."""
    seen = waves(contact, 1.0)
    rate = np.abs(seen.product.imag) / (2.0 * seen.omega * float(contact.compliance(1.0)[0, 0]))
    return (
        f"Away from coincidences friction along the casing feeds a travelling wave at up to {rate.max():.2g} 1/s, "
        f"which a damping ratio of {(rate / seen.omega).max():.2g} holds."
    )


def _verdict(found: StabilityMap) -> str:
    low, high = found.speed_hz[0], found.speed_hz[-1]
    if not found.diverges:
        return f"Closed contact does not diverge from {low:.6g} to {high:.6g} Hz."
    bands = ", ".join(f"{a:.5g}-{b:.5g} Hz" for a, b in found.bands_hz)
    return f"Closed contact diverges in {bands}, fastest at {found.peak_speed_hz:.5g} Hz."


def _nearest(met: tuple[Coincidence, ...], low: float, high: float) -> Coincidence:
    """The coincidence in the range, or nearest to it; among several in it the one that grows fastest."""
    return min(met, key=lambda c: (max(low - c.speed_hz, c.speed_hz - high, 0.0), -c.growth))


def _sum_words(met: tuple[Coincidence, ...], low: float, high: float) -> list[str]:
    """The sum condition: met, met elsewhere, or out of reach because n f stays below every f_c."""
    sums = tuple(c for c in met if c.branch == "sum" and c.speed_hz * (low + high) >= 0.0)
    if not sums:
        return []
    c = _nearest(sums, low, high)
    fastest = max(-low, high)
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
