"""Peaks of the growth of closed contact over speed: speed, growth, and the growing motion.

Poles s of a contact that stays closed (`closed_contact`) have the growth max Re s at each speed. Each peak of that
curve is refined. The eigenvector of its pole is the growing motion: its energies, the sums of |r q|^2 + |q'|^2 over
modes of rate r, give the share of the casing. In the frame of the contact the casing moves as waves e^(i k theta + s
t). In its own frame their frequency is w = Im s + k Omega. A wave with k w Omega > 0 travels around the casing in the
direction in which the blade passes. Split pairs are replaced by their mean (`perfect_mean`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.base.arrays import Array, Indices, readonly
from contact.base.errors import InputError
from contact.io.reported import Reported
from contact.io.threads import with_one_thread
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, HandPair
from contact.model.gaps.rub import Rub, rub_of
from contact.stability.closed_contact import first_order, floor_of, growth, poles_each
from contact.stability.coincidence import close_speeds, coincidences, overtaken_speeds
from contact.stability.growth_map import StabilityMap, scan
from contact.stability.maxima import maxima, prominence
from contact.stability.mode_groups import largest_mode, mode_numbers
from contact.stability.split_casing import mean_contact
from contact.stability.together import maxima_between
from contact.stability.waves import Waves, waves_of

Vector = NDArray[np.complex128]
MOST = 40  # peaks, the highest ones
PROMINENCE = 0.1  # of its growth, by which a peak rises from what lies between it and a higher one
TRAVELS = 0.8  # of the energy of n diameters, in waves of one sense: less is a standing wave
EQUAL = 1e-6  # of the energy: both waves of a pattern at rest before the blade have the same
ALIKE = 0.5  # squared cosine between two growing motions that are one
SETTLED = 1e-7  # of the pole: distance of the shift of inverse iteration


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """One peak: the speed [turns/s], the growth [1/s] there, and the speeds around it at which its motion grows.

    The casing moves with `n` nodal diameters, the blade mostly in its mode number `mode`. The `wave` runs "with" the
    blade's direction around the casing, "against" it, or is "standing". `casing_share` is the casing's share of the
    energy; the rest is the blade's. `freq_hz` is the frequency in the blade's frame. `overtaken`: the blade is faster
    than the wave.
    """

    speed_hz: float
    growth: float
    from_hz: float
    to_hz: float
    n: int
    wave: str
    casing_share: float
    freq_hz: float
    overtaken: bool
    mode: int | None = None

    @property
    def casing_hz(self) -> float:
        """Frequency of a travelling wave in the casing's frame [Hz]."""
        turned = self.n * abs(self.speed_hz)
        if self.overtaken:
            return turned - self.freq_hz
        return self.freq_hz + (turned if self.wave == "with" else -turned)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Peaks(Reported):
    """All peaks over a range of speeds, by speed; `map` the growth over the range and its bands.

    `averaged` states whether split pairs were averaged. For pictures, `blade_hz` has the frequencies of the blade at
    rest and `wave_hz` (speeds of the map, waves) those of the casing's waves in the blade's frame, both without
    contact. `rotor`: the peaks are those of a rotor without contact, and `wave_hz` has its whirl frequencies.

    >>> import numpy as np
    >>> import contact as ct
    >>> pair = ct.gaps.HandPair(casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                         blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> found = ct.stability.peaks(pair, np.linspace(50.0, 60.0, 11))
    >>> [(row.n, round(row.speed_hz, 2)) for row in found.rows], found.averaged
    ([(8, 52.84)], False)
    """

    rows: tuple[Peak, ...]
    map: StabilityMap
    averaged: bool
    blade_hz: tuple[float, ...]
    wave_hz: Array
    rotor: bool = False

    def records(self) -> list[dict[str, object]]:
        """One plain dictionary for each peak."""
        return [{name: getattr(row, name) for name in Peak.__dataclass_fields__} for row in self.rows]


@with_one_thread
def peaks(what: RotatingRim | Rub | HandPair, speed_hz: ArrayLike, *, mu: float = 0.0) -> Peaks:
    """Peaks of the growth of closed contact over speeds [turns/s] of one sense of rotation.

    `what`: a rim or a rub, whose own speed is not used, with friction `mu`; or a pair by hand, which has its own
    friction.

    Raises InputError unless there are at least two ascending speeds above 0, and for a contact without compliance.

    >>> from contact.model.gaps.permanent import ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> (peak,) = peaks(pair, np.linspace(40.0, 60.0, 41)).rows
    >>> peak.n, peak.wave, round(peak.speed_hz, 3), round(peak.growth, 3), round(peak.casing_share, 1)
    (8, 'with', 52.844, 3.788, 0.7)
    """
    speed = readonly(speed_hz)
    if speed.ndim != 1 or speed.size < 2 or not np.all(np.diff(speed) > 0.0) or speed[0] <= 0.0:
        raise InputError("speed_hz: found other numbers, expected two or more ascending speeds above 0 Hz")
    contact, averaged = _closed(what, mu)
    found, turn = growth_map(contact, speed), 2.0 * math.pi
    return Peaks(
        rows=peaks_of(contact, found, _blade_modes(what)), map=found, averaged=averaged,
        blade_hz=tuple((contact.omega[contact.casing :] / turn).tolist()), wave_hz=_waves_seen(contact, speed),
    )  # fmt: skip


def growth_map(contact: ClosedContact, speed_hz: Array) -> StabilityMap:
    """Growth over ascending speeds [turns/s], with additional ones near coincidences and where a wave is overtaken.

    Raises InputError at speeds for which the matrices of a body are not known.
    """
    contact.require_known(2.0 * math.pi * speed_hz)
    seeds = np.concatenate([close_speeds(coincidences(contact, speed_hz)), overtaken_speeds(contact, speed_hz)])
    return scan(lambda at: growth(contact, at), speed_hz, floor=floor_of(contact), seeds=seeds)


def peaks_of(contact: ClosedContact, found: StabilityMap, number: Indices | None = None) -> tuple[Peak, ...]:
    """Peaks of a growth map of this contact, by speed; `number` of the blades' modes, in their order if left out."""
    ordered = np.arange(1, contact.omega.size - contact.casing + 1)
    return _merged(contact, *_refined(contact, found, floor_of(contact)), found, ordered if number is None else number)


@with_one_thread
def growth_at(what: RotatingRim | Rub, speed_hz: Array, *, mu: float = 0.0) -> Array:
    """Growth of closed contact [1/s] at speeds [turns/s] above 0, (speeds,); split pairs are replaced by their mean."""
    return growth(_closed(what, mu)[0], speed_hz)


def _refined(contact: ClosedContact, found: StabilityMap, floor: float) -> tuple[Array, list[complex]]:
    """Speeds of the highest peaks above `floor`, ascending, and their leading poles."""
    at, values = found.seen_hz, found.seen_growth
    padded = np.pad(values, 1, constant_values=min(float(values.min()), 0.0) - 1.0)  # peaks at the ends are peaks too
    places = maxima(padded)
    places = places[padded[places] >= floor]
    places = places[prominence(padded, places) >= PROMINENCE * np.abs(padded[places])]
    k = np.sort(places[np.argsort(-padded[places], kind="stable")][:MOST]) - 1
    near = np.clip(np.stack([k - 1, k, k + 1]), 0, at.size - 1)
    x, y = at[near], values[near]
    speed = maxima_between(lambda hz: growth(contact, hz), x, y)
    leading = [max(every, key=lambda s: (float(s.real), float(s.imag))) for every in poles_each(contact, speed)]
    return speed, [complex(s.real, abs(s.imag)) for s in leading]


def _merged(
    contact: ClosedContact, speed: Array, leading: list[complex], found: StabilityMap, number: Indices
) -> tuple[Peak, ...]:
    """Peaks of different motions: of neighbours in one band with similar eigenvectors the higher one is kept."""
    rows: list[Peak] = []
    motions: list[Vector] = []
    waves = waves_of(contact)
    for hz, pole in zip(speed.tolist(), leading, strict=True):
        peak, motion = _peak(waves, hz, pole, number)
        band = next((band for band in found.bands_hz if band[0] <= hz <= band[1]), (hz, hz))
        peak = replace(peak, from_hz=band[0], to_hz=band[1])
        last = rows[-1] if rows else None
        if last is None or last.from_hz != peak.from_hz or not _alike(last, motions[-1], peak, motion):
            rows.append(peak)
            motions.append(motion)
        elif peak.growth > last.growth:
            rows[-1], motions[-1] = peak, motion
    for k in range(len(rows) - 1):  # peaks of one band share it at the lowest growth between them
        one, next_one = rows[k], rows[k + 1]
        if one.to_hz == next_one.to_hz:
            between = (found.seen_hz > one.speed_hz) & (found.seen_hz < next_one.speed_hz)
            lowest = float(found.seen_hz[between][found.seen_growth[between].argmin()])
            rows[k], rows[k + 1] = replace(one, to_hz=lowest), replace(next_one, from_hz=lowest)
    return tuple(rows)


def _alike(one: Peak, first: Vector, other: Peak, second: Vector) -> bool:
    """Whether two motions of unit norm are similar."""
    return (one.n, one.wave) == (other.n, other.wave) and float(abs(np.vdot(first, second))) ** 2 > ALIKE


def _peak(waves: Waves, speed_hz: float, pole: complex, number: Indices) -> tuple[Peak, Vector]:
    """A peak and its motion: energy amplitudes of waves and modes, (2 m,) of unit norm."""
    contact, omega = waves.contact, 2.0 * math.pi * speed_hz
    casing = contact.casing
    state = _eigenvector(first_order(contact, omega).closed(), pole).reshape(2, -1) * contact.rates
    motion = state @ waves.U.conj()
    motion /= np.linalg.norm(motion)
    energy, order = np.sum(np.abs(motion) ** 2, axis=0), waves.order
    share = float(energy[:casing].sum())
    by_n = np.bincount(np.abs(order[:casing]).astype(int), weights=energy[:casing], minlength=1)
    n = int(by_n.argmax())
    positive = float(energy[:casing][order[:casing] == n].sum())
    wave, overtaken = _sense(n, positive / float(by_n[n]), pole.imag, omega)
    return Peak(
        speed_hz=speed_hz, growth=pole.real, from_hz=speed_hz, to_hz=speed_hz, n=n, wave=wave, casing_share=share,
        freq_hz=pole.imag / (2.0 * math.pi), overtaken=overtaken,
        mode=largest_mode(number, energy[casing:]) if number.size else None,
    ), motion.ravel()  # fmt: skip


def _sense(n: int, positive: float, freq: float, omega: float) -> tuple[str, bool]:
    """Direction in which the motion of n diameters travels around the casing, and whether the blade overtakes its wave.

    `positive` is the energy share of k = n, the rest is that of k = -n; `freq` [rad/s] is at least 0. The wave ahead of
    the blade travels with it; so does the other one if n |Omega| > freq.
    """
    ahead = positive if omega > 0.0 else 1.0 - positive
    overtakes = freq < n * abs(omega)
    along = 1.0 if overtakes else ahead
    if n == 0 or max(along, 1.0 - along) < TRAVELS:
        return "standing", False
    return ("with" if along > 0.5 else "against"), overtakes and ahead < 0.5 - EQUAL


def _eigenvector(matrix: Array, pole: complex) -> Vector:
    """Eigenvector of an eigenvalue of a matrix, by two steps of inverse iteration."""
    from scipy.linalg import lu_factor, lu_solve

    shifted = matrix - (pole + SETTLED * abs(pole)) * np.eye(len(matrix))
    factors = lu_factor(shifted)
    x = np.exp(1j * np.arange(len(matrix)) ** 2)  # of no symmetry
    for _ in range(2):
        x = lu_solve(factors, x)
        x /= np.linalg.norm(x)
    return np.asarray(x)


def _waves_seen(contact: ClosedContact, speed_hz: Array) -> Array:
    """Frequencies |f_c - n f| [Hz] of waves in the direction of the blade, speeds > 0 [turns/s], (speeds, waves)."""
    omega = 2.0 * math.pi * speed_hz
    free = waves_of(contact).poles(omega, 1.0)
    if free is None:
        return readonly(np.zeros((speed_hz.size, 0)))
    after = free.casing & (free.sign > 0.0) & (free.order > 0.0)
    return readonly(np.abs(free.met(omega)[:, after]) / (2.0 * math.pi))


def _blade_modes(what: RotatingRim | Rub | HandPair) -> Indices | None:
    """Number of each mode of the blades in its body; None for a pair by hand."""
    return None if isinstance(what, HandPair) else mode_numbers(rub_of(what).bodies[1:])


def _closed(what: RotatingRim | Rub | HandPair, mu: float) -> tuple[ClosedContact, bool]:
    """The system with all contacts closed, and whether split pairs were averaged."""
    return (what.contact(), False) if isinstance(what, HandPair) else mean_contact(what, mu=mu)
