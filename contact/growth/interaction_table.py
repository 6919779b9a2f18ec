"""At which speeds does a rub interact, and how? Coincidences, bands that diverge, wave speeds, pulses: one table.

All of it is linear theory of contacts that stay closed (`closed_contact`, `coincidence`), on the mean of split pairs
(`perfect_mean`), and what keeps them closed: an out-of-round rim passes a closed contact as a force of p per turn,
F_p = -d_p/(S + Q A(i p Omega)^-1 W^T), A(s) = (s + Omega G)^2 + C (s + Omega G) + K. Where these
forces outgrow the one that presses, contact is intermittent: theory then gives an upper bound, and runs decide.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.growth.closed_contact import FirstOrder, first_order, floor_of, poles_each, stability
from contact.growth.coincidence import Coincidence, coincidences, standing_speeds
from contact.growth.growth_map import StabilityMap, between
from contact.growth.split_casing import mean_contact
from contact.growth.waves import waves_of
from contact.io.outfiles import finite
from contact.io.reported import Reported
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, HandPair
from contact.model.gaps.rub import Rub, rub_of

TURNS = 1000.0  # from a ten-thousandth of the wall to a tenth of it
DRAWN = 161  # speeds at which poles are kept for a picture
COLUMNS = {
    "n": "nodal diameters of the casing's wave",
    "condition": "which frequencies meet: f_c of the casing and f_b of the blade, n f the speed in passes of a wave",
    "f_c": "frequency of the casing's wave without contact at that speed, in the casing's frame [Hz]",
    "f_b": "frequency of the blade's mode without contact at that speed, in the blade's frame [Hz]",
    "free": "speed of the coincidence without contact [turns/s]",
    "closed": "speed of the coincidence while one contact stays closed [turns/s]: its stiffness shifts it",
    "f_c/n": "speed of the wave around the casing [turns/s]: a blade that runs as fast sees it stand still",
    "diverges": "speeds at which closed contact grows without bound [turns/s], - where it does not",
    "growth": "largest growth rate there [1/s], by poles; below 0 it decays",
    "at": "speed of the largest growth [turns/s]",
    "turns": "turns in which a vibration of a ten-thousandth of the wall reaches a tenth of it",
    "pulses": "forces of the out-of-round rim over the mean contact force: at 1 and above contact is intermittent",
}
CONDITIONS = {"sum": "f_c + f_b = n f", "backward": "f_b = f_c - n f", "forward": "f_b = f_c + n f"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Interaction:
    """One row: what `COLUMNS` says, speeds [turns/s], growth [1/s]; nan for what there is none of."""

    n: int
    branch: str
    casing_hz: float
    blade_hz: float
    free_hz: float
    closed_hz: float
    wave_hz: float
    from_hz: float
    to_hz: float
    growth: float
    growth_hz: float
    turns: float
    pulses: float

    @property
    def words(self) -> str:
        """One line of the table."""
        band = f"{self.from_hz:.4f}-{self.to_hz:.4f}" if math.isfinite(self.from_hz) else "-"
        numbers = [
            f"{self.n:>3}", f"{CONDITIONS.get(self.branch, self.branch):<16}", f"{self.casing_hz:>9.2f}",
            f"{self.blade_hz:>9.2f}", f"{self.free_hz:>9.4f}", f"{self.closed_hz:>9.4f}", f"{self.wave_hz:>8.3f}",
            f"{band:>19}", f"{self.growth:>9.4g}", f"{self.growth_hz:>9.4f}", f"{self.turns:>8.3g}",
            f"{self.pulses:>7.2g}",
        ]  # fmt: skip
        return " ".join(numbers).replace("nan", "  -")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Interactions(Reported):
    """Every interaction in a range of speeds [turns/s], those that diverge fastest first.

    `map` growth over speed with its bands; `waves` (n, f_c, f_c/n) of the casing; `opens_hz` bands in which an
    out-of-round rim opens the contact; `averaged` whether split pairs were; `pole_hz`, `pole_growth` (speeds, poles)
    at `pole_speed_hz` what the blade sees, and `seen_hz` (speeds, waves) what it sees of the casing's waves without
    contact, for a picture.
    """

    rows: tuple[Interaction, ...]
    map: StabilityMap
    waves: tuple[tuple[int, float, float], ...]
    opens_hz: tuple[tuple[float, float], ...]
    averaged: bool
    blade_hz: tuple[float, ...]
    pole_speed_hz: Array
    pole_hz: Array
    pole_growth: Array
    seen_hz: Array

    @property
    def worst_hz(self) -> float:
        """Speed of the fastest growth [turns/s]."""
        return self.map.peak_speed_hz

    def records(self) -> list[dict[str, object]]:
        """One plain dictionary an interaction; `COLUMNS` says what each entry is."""
        return [asdict(row) for row in self.rows]

    def __repr__(self) -> str:
        head = (
            f"{'n':>3} {'condition':<16} {'f_c':>9} {'f_b':>9} {'free':>9} {'closed':>9} {'f_c/n':>8} {'diverges':>19} "
            f"{'growth':>9} {'at':>9} {'turns':>8} {'pulses':>7}"
        )
        low, high = float(self.map.speed_hz[0]), float(self.map.speed_hz[-1])
        lines = [head, *(row.words for row in self.rows)]
        lines += ["", *(f"{name:>9}: {meaning}" for name, meaning in COLUMNS.items()), ""]
        if self.averaged:
            lines.append("The casing's pairs are split: this is their mean; `casingfem stability` follows every turn.")
        passed = ", ".join(f"{f:.4g} Hz (n = {n})" for n, _, f in self.waves if low <= f <= high)
        lines.append(f"The blade runs as fast as a wave, f_c/n, at {passed or 'no speed of this range'}.")
        opened = ", ".join(f"{a:.4g}-{b:.4g} Hz" for a, b in self.opens_hz)
        lines.append(
            f"Contact cannot stay closed at {opened}: pulses there, growth is less than this table's; runs tell."
            if opened else "Contact stays closed in all of this range until a vibration opens it."
        )  # fmt: skip
        return "\n".join([*lines, repr(self.map)])

    def to_dict(self) -> dict[str, object]:
        """The document of `casingfem interactions --json`."""
        return {
            "interactions": [finite(asdict(row)) for row in self.rows], "columns": COLUMNS, "map": self.map.to_dict(),
            "waves": [{"n": n, "casing_hz": f_c, "wave_hz": f} for n, f_c, f in self.waves],
            "opens_hz": [list(band) for band in self.opens_hz], "averaged": self.averaged,
        }  # fmt: skip


def interactions(what: RotatingRim | Rub | HandPair, speed_hz: ArrayLike, *, mu: float = 0.0) -> Interactions:
    """Where a casing and its blade, or disk, interact over speeds [turns/s] of one sense of rotation.

    `what`: a rim or a rub, whose own speed is not used, with friction `mu`; or a pair by hand, which has its own.

    Raises InputError unless the speeds are two or more, ascending, above 0, or where a contact has no compliance.

    >>> from contact.model.gaps.permanent import ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> row = interactions(pair, np.linspace(52.0, 54.0, 41)).rows[0]
    >>> row.branch, round(row.growth_hz, 3), round(row.growth, 3), round(row.wave_hz, 3)
    ('sum', 52.844, 3.788, 37.5)
    """
    speed = readonly(speed_hz)
    if speed.ndim != 1 or speed.size < 2 or not np.all(np.diff(speed) > 0.0) or speed[0] <= 0.0:
        raise InputError("speed_hz: found speeds that do not ascend from above 0, expected two or more that do")
    contact, averaged = _closed(what, mu)
    met = coincidences(contact, speed)
    here = tuple(c for c in met if c.free_hz > 0.0 and speed[0] <= c.speed_hz <= speed[-1])
    found = stability(contact, speed)
    press, angle, terms = _pressed(what)
    at = np.unique(np.concatenate([np.linspace(speed[0], speed[-1], 61), [c.speed_hz for c in here]]))
    ratio = pulse_ratio(contact, at, press, terms, angle)
    rows = [_row(c, found, contact, float(np.interp(c.speed_hz, at, ratio))) for c in here]
    rows += [
        _band_row(band, found, contact, float(np.interp(np.mean(band), at, ratio)))
        for band in found.bands_hz
        if not any(band[0] <= c.speed_hz <= band[1] for c in here)
    ]
    drawn = np.linspace(speed[0], speed[-1], DRAWN)
    poles = np.array([_seen(every) for every in poles_each(contact, drawn)])
    standing = contact.omega[contact.casing :] / (2.0 * np.pi)
    return Interactions(
        rows=tuple(sorted(rows, key=lambda row: -row.growth)), map=found, waves=standing_speeds(contact, speed),
        opens_hz=_above(at, ratio), averaged=averaged, blade_hz=tuple(float(f) for f in standing),
        pole_speed_hz=readonly(drawn), pole_hz=readonly(poles.imag / (2.0 * np.pi)), pole_growth=readonly(poles.real),
        seen_hz=_waves_seen(contact, drawn),
    )  # fmt: skip


def _seen(poles: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Half of the poles, those of positive frequency, by frequency."""
    return np.asarray(poles[np.argsort(-poles.imag, kind="stable")][: poles.size // 2][::-1])


def _waves_seen(contact: ClosedContact, speed_hz: Array) -> Array:
    """|f_c - n f| [Hz] of the waves that the blade runs after, at speeds above 0 [turns/s], (speeds, waves)."""
    omega = 2.0 * math.pi * speed_hz
    free = waves_of(contact).poles(omega, 1.0)
    if free is None:
        return readonly(np.zeros((speed_hz.size, 0)))
    after = free.casing & (free.sign > 0.0) & (free.order > 0.0)
    return readonly(np.abs(free.met(omega)[:, after]) / (2.0 * math.pi))


def _row(c: Coincidence, found: StabilityMap, contact: ClosedContact, pulses: float) -> Interaction:
    near = np.abs(found.seen_hz - c.speed_hz) <= max(c.half_hz, float(np.diff(found.speed_hz).max()))
    best = int(np.flatnonzero(near)[found.seen_growth[near].argmax()])
    at, rate = float(found.seen_hz[best]), float(found.seen_growth[best])
    band = next((band for band in found.bands_hz if band[0] <= at <= band[1]), (math.nan, math.nan))
    return Interaction(
        n=c.n, branch=c.branch, casing_hz=c.casing_hz, blade_hz=c.blade_hz, free_hz=c.free_hz,
        closed_hz=c.speed_hz if len(contact.Q) == 1 else math.nan,
        wave_hz=c.casing_hz / c.n, from_hz=band[0], to_hz=band[1], growth=rate, growth_hz=at,
        turns=turns(at, rate, floor_of(contact)), pulses=pulses,
    )  # fmt: skip


def _band_row(band: tuple[float, float], found: StabilityMap, contact: ClosedContact, pulses: float) -> Interaction:
    """A band without a coincidence: friction along the casing feeds a wave that travels."""
    inside = (found.seen_hz >= band[0]) & (found.seen_hz <= band[1])
    best = int(np.flatnonzero(inside)[found.seen_growth[inside].argmax()])
    at, rate = float(found.seen_hz[best]), float(found.seen_growth[best])
    nan, branch = math.nan, "friction" if contact.mu > 0.0 else "several at once"
    return Interaction(
        n=0, branch=branch, casing_hz=nan, blade_hz=nan, free_hz=nan, closed_hz=nan, wave_hz=nan,
        from_hz=band[0], to_hz=band[1], growth=rate, growth_hz=at, turns=turns(at, rate, floor_of(contact)),
        pulses=pulses,
    )  # fmt: skip


def turns(speed_hz: float, growth: float, floor: float = 0.0) -> float:
    """Turns in which a vibration grows from a ten-thousandth of the wall to a tenth of it; nan where it does not."""
    return math.log(TURNS) * speed_hz / growth if growth > floor else math.nan


def pulse_ratio(
    contact: ClosedContact, speed_hz: Array, press: Array, terms: list[tuple[int, float, float]], angle: ArrayLike = 0.0
) -> Array:
    """Sum of |F_p| of an out-of-round rim over the least contact force at rest, (speeds,); infinite where none presses.

    `press` (r,) by how much each contact overlaps, `terms` (p, cos, sin) [m] of the rim's deviation, `angle` (r,) [rad]
    where each stands, or one for all: a wave of p meets them one after the other.
    """
    ratio = np.zeros(speed_hz.size)
    at = np.broadcast_to(np.asarray(angle, dtype=float), press.shape)
    deviations = [(p, math.hypot(a, b)) for p, a, b in terms if p > 0 and (a or b)]
    if not (press.min() > 0.0):
        return ratio + math.inf
    for k, hz in enumerate(speed_hz):
        bodies, turn = first_order(contact, 2.0 * math.pi * hz), 2.0 * math.pi * hz
        still = float(np.real(_force(bodies, 0.0, press)).min())
        loads = [size * np.abs(_force(bodies, p * turn, np.exp(-1j * p * at))).max() for p, size in deviations]
        ratio[k] = sum(loads) / still if still > 0.0 else math.inf
    return ratio


def _force(bodies: FirstOrder, w: float, overlap: Array) -> NDArray[np.complex128]:
    """Contact forces of overlaps [m] that vibrate at w [rad/s] in the blade's frame, (r,) [N]."""
    return np.asarray(np.linalg.solve(bodies.S + bodies.receptance(1j * w), overlap.astype(complex)))


def _above(speed: Array, ratio: Array) -> tuple[tuple[float, float], ...]:
    """Bands of speed in which a ratio is 1 or more, ends straight between the speeds looked at."""
    above = ratio >= 1.0
    edges = []
    for k in np.flatnonzero(above[1:] != above[:-1]):
        a, b = ratio[k] - 1.0, ratio[k + 1] - 1.0
        part = a / (a - b) if np.isfinite(a) and np.isfinite(b) else 0.5
        edges.append(float(speed[k] + part * (speed[k + 1] - speed[k])))
    return between(speed, above, edges)


@singledispatch
def _closed(what: RotatingRim | Rub | HandPair, mu: float) -> tuple[ClosedContact, bool]:
    """All contacts closed, and whether split pairs were averaged."""
    return mean_contact(what, mu=mu)  # type: ignore[arg-type]


@_closed.register
def _(what: HandPair, mu: float) -> tuple[ClosedContact, bool]:
    return what.contact(), False


@singledispatch
def _pressed(what: RotatingRim | Rub | HandPair) -> tuple[Array, Array, list[tuple[int, float, float]]]:
    """Overlap of each contact with the mean rim [m], its angle [rad], and the rim's deviation."""
    return np.ones(1), np.zeros(1), []  # a pair by hand is closed by definition


@_pressed.register
def _(what: RotatingRim) -> tuple[Array, Array, list[tuple[int, float, float]]]:
    return _pressed(rub_of(what))


@_pressed.register
def _(what: Rub) -> tuple[Array, Array, list[tuple[int, float, float]]]:
    mean = sum(a for p, a, _ in what.profile.terms if p == 0) - float(what.closing.by[-1])
    press = np.array([-(what.clearance + tip.clearance) - mean for tip in what.tips])
    return press, np.radians([tip.angle_deg for tip in what.tips]), list(what.profile.terms)
