"""Response of a plant at the harmonics of its drive, and forces of contacts that give way.

A periodic vector is a series Re sum_h z_h e^{i h w t}, h = 0 to H, with z_0 real: complex numbers (..., H + 1).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError
from contact.cycles.known import resonance
from contact.cycles.passage import Motion
from contact.cycles.switched import Complex, Forcing

NEAR = 1e-12  # of the drive's frequency: a pole that is nearer to a harmonic has no forced vibration
TIMES = 16  # samples of a period for each harmonic, at least
FEWEST = 512  # samples of a period: shorter touches may be missed
ZERO = 30  # most Newton steps to the zero of a gap between two samples; a step out of its bounds halves them
SETTLED = 1e-13  # rad: a shorter step ends them
TIE = 1e-9  # relative difference of two samples that are equally near an extremum


class Response(NamedTuple):
    """Response of a plant at one drive: gaps without the contacts' forces, and their change by forces.

    y = still + receptance lam for each harmonic, y the gap less the spring of its own contact: gap = y + own lam.
    """

    still: Complex  # (k, H + 1)
    receptance: Complex  # (H + 1, k, k)
    own: Array  # compliance of each contact, (k,)
    w: float  # base frequency [rad/s]


def response(motion: Motion, harmonics: int, periods: int) -> Response:
    """Response to the drive and to the contacts, at multiples of the drive's frequency over `periods`.

    Raises InputError for rigid contacts and for a drive above the last harmonic, NumericsError at a resonance.
    """
    plant, w, phase = motion.plant, motion.drive.w / periods, motion.known.open_phase
    require_compliant(motion)
    seen, pushed, own = plant.C @ phase.V, phase.U @ plant.B, np.diag(plant.S)
    forward, backward = (part[:, None] for part in _poles(motion, w, harmonics))
    swung = 0.5 * ((seen * forward) @ pushed + (seen.conj() * backward) @ pushed.conj())
    free = excited(motion, w, harmonics, periods)
    still = free.seen(seen) + series(motion.drive.c, motion, harmonics, periods)
    return Response(still, swung + (plant.S - np.diag(own)), own, w)


class Excited(NamedTuple):
    """Harmonics of the modal amplitudes of the open phase, (half, H + 1), and of their conjugates."""

    forward: Complex
    backward: Complex

    def seen(self, rows: Complex) -> Complex:
        """Harmonics of what the rows (o, half) see of the eigenvectors, (o, H + 1)."""
        return np.asarray(0.5 * (rows @ self.forward + rows.conj() @ self.backward))


def excited(motion: Motion, w: float, harmonics: int, periods: int, lam: Complex | None = None) -> Excited:
    """Modal amplitudes under the drive and the contacts' forces (k, H + 1)."""
    forward, backward = _poles(motion, w, harmonics)
    push = series(motion.drive.b, motion, harmonics, periods)
    if lam is not None:
        push += motion.plant.B @ lam
    U = motion.known.open_phase.U
    return Excited(forward.T * (U @ push), backward.T * (U.conj() @ push))


def outputs(motion: Motion, w: float, harmonics: int, periods: int, lam: Complex) -> tuple[Array, Complex]:
    """The state at phase 0, and the harmonics of the plant's outputs (o, H + 1), under the contacts' forces."""
    z, plant, V = excited(motion, w, harmonics, periods, lam), motion.plant, motion.known.open_phase.V
    at = Excited(z.forward.sum(axis=1, keepdims=True), z.backward.sum(axis=1, keepdims=True))
    shown = z.seen(plant.D @ V) + plant.E @ lam + series(motion.drive.d, motion, harmonics, periods)
    return at.seen(V)[:, 0].real, shown


def require_compliant(motion: Motion) -> None:
    """Raise InputError for the first rigid contact."""
    rigid = np.flatnonzero(motion.plant.rigid)
    if rigid.size:
        raise InputError(
            f"contact {rigid[0] + 1}: found a rigid contact, expected one with a compliance for harmonic balance, "
            "because the force of an impact has no Fourier series: give it a stiffness, or leave harmonic balance out"
        )


def series(forcing: Forcing, motion: Motion, harmonics: int, periods: int) -> Complex:
    """The forcing as harmonics of the drive's frequency over `periods`, (n, H + 1); raises InputError for too few."""
    at = np.rint(motion.drive.harmonics).astype(int) * periods
    if at.max() > harmonics:
        raise InputError(f"harmonics: found {harmonics}, expected {at.max()} or more, the highest of the forcing")
    found = np.zeros((forcing.rest.size, harmonics + 1), dtype=complex)
    found[:, at] = forcing.wave
    found[:, 0] += forcing.rest
    return found


def _poles(motion: Motion, w: float, harmonics: int) -> tuple[Complex, Complex]:
    """1/(i h w - lam) of each pole of the open phase, and of their conjugates, (H + 1, half)."""
    s, lam = 1j * w * np.arange(harmonics + 1)[:, None], motion.known.open_phase.lam
    below = s - lam
    if np.abs(below).min() < NEAR * w:
        raise resonance()
    return 1.0 / below, 1.0 / (s - lam.conj())


def samples_of(harmonics: int) -> int:
    """Number of samples of a period: a power of two."""
    return 1 << (max(TIMES * harmonics, FEWEST) - 1).bit_length()


def in_time(z: Complex, samples: int) -> Array:
    """A series at equal steps of its period, (..., samples)."""
    half = 0.5 * samples * z
    half[..., 0] *= 2.0
    return np.asarray(np.fft.irfft(half, samples))


def in_harmonics(values: Array, harmonics: int) -> Complex:
    """The series of samples over a period, (..., H + 1)."""
    found = np.fft.rfft(values)[..., : harmonics + 1] * (2.0 / values.shape[-1])
    found[..., 0] *= 0.5
    return np.asarray(found)


class Pressed(NamedTuple):
    """Forces of the contacts as a series (k, H + 1), and their derivative by the real unknowns (k, H + 1, 2 H + 1)."""

    lam: Complex
    by: Complex


def pressed(y: Complex, own: Array) -> Pressed:
    """Forces max(0, -y/own) of the contacts, integrated exactly between the zeros of y.

    The force is linear in y where the contact is closed: its series is the product of y and of a function kappa that is
    -1/own there and 0 elsewhere. The force is zero at the ends of these parts, so that a shift of them changes nothing
    to first order (Petrov and Ewins, J. Turbomach. 125, 2003, 364).
    """
    kappa, H = _closed(y) / -own[:, None], y.shape[1] - 1
    kappa[:, 1:] *= 0.5
    h, j = np.arange(H + 1)[:, None], np.arange(H + 1)
    after, before = kappa[:, h + j], kappa[:, np.abs(h - j)]
    before = np.where(h >= j, before, before.conj())
    by = np.concatenate([before + after, 1j * (before - after)[..., 1:]], axis=-1)
    by[..., 0] = 2.0 * kappa[:, : H + 1]
    by[:, 0] = 0.5 * by[:, 0].real
    unknowns = np.concatenate([y.real, y.imag[:, 1:]], axis=1)
    return Pressed(np.asarray((by @ unknowns[..., None])[..., 0]), by)


def _closed(y: Complex) -> Complex:
    """The series of the function that is 1 where y < 0, to twice the harmonics: (k, 2 H + 1)."""
    m = np.arange(1, 2 * y.shape[1] - 1)
    free = in_time(y, samples_of(y.shape[1] - 1))
    found = np.zeros((len(y), m.size + 1), dtype=complex)
    found[:, 0] = free[:, 0] < 0.0
    contact, opens, low, angle, high = (np.concatenate(column) for column in zip(*_brackets(y, free), strict=True))
    if not contact.size:
        return found
    for _ in range(ZERO):
        before, (value, slope, _) = angle, _at(y[contact], angle)
        ahead = (value < 0.0) == opens
        low, high = np.where(ahead, angle, low), np.where(ahead, high, angle)
        angle = angle - value / np.where(slope == 0.0, np.inf, slope)
        angle = np.where((angle >= low) & (angle <= high), angle, 0.5 * (low + high))
        if np.abs(angle - before).max() < SETTLED:
            break
    sense = np.where(opens, -1.0, 1.0)
    np.add.at(found[:, 0], contact, -sense * angle / (2.0 * np.pi))
    np.add.at(found[:, 1:], contact, sense[:, None] * np.exp(-1j * angle[:, None] * m) / (1j * np.pi * m))
    return found


class Bracket(NamedTuple):
    """Zeros of gaps: contact, whether it opens, bounds of the angle and a guess between them [rad]."""

    contact: Indices
    opens: NDArray[np.bool_]
    low: Array
    guess: Array
    high: Array


def _at(z: Complex, angle: Array) -> tuple[Array, Array, Array]:
    """Value, slope and curvature of series (m, H + 1) at one angle each."""
    h = np.arange(z.shape[1])
    turned = z * np.exp(1j * angle[:, None] * h)
    return turned.real.sum(axis=1), -(turned.imag @ h), -(turned.real @ h**2)


def _brackets(y: Complex, free: Array) -> list[Bracket]:
    """Zeros of series: between samples of different sign, and two on both sides of an extremum between samples."""
    after, before, step = np.roll(free, -1, axis=1), np.roll(free, 1, axis=1), 2.0 * np.pi / free.shape[1]
    shut = free < 0.0
    contact, at = np.nonzero(shut != (after < 0.0))
    part = free[contact, at] / (free[contact, at] - after[contact, at])
    found = [Bracket(contact, shut[contact, at], step * at, step * (at + part), step * (at + 1))]
    bend, tilt = before - 2.0 * free + after, before - after
    alone = (shut == (before < 0.0)) & (shut == (after < 0.0)) & (np.abs(tilt) <= (1.0 + TIE) * np.abs(bend))
    near = (free * bend > 0.0) & (8.0 * free * bend < tilt**2 + 8.0 * bend**2)  # nearer to zero than a step's bend
    contact, at = np.nonzero(alone & near)
    if not contact.size:
        return found
    inside, low, high = shut[contact, at], step * (at - 1), step * (at + 1)
    middle = step * (at + 0.5 * tilt[contact, at] / bend[contact, at])
    for _ in range(ZERO):
        before, (value, slope, curve) = middle, _at(y[contact], middle)
        middle = np.clip(middle - slope / np.where(curve == 0.0, np.inf, curve), low, high)
        if np.abs(middle - before).max() < SETTLED:
            break
    value, _, curve = _at(y[contact], middle)
    crosses = ((value < 0.0) != inside) & _once(contact, middle, step)
    half = np.sqrt(np.abs(2.0 * value / np.where(curve == 0.0, np.inf, curve)))
    pair = Bracket(contact, inside, low, middle - half, middle), Bracket(contact, ~inside, middle, middle + half, high)
    return [*found, *(Bracket(*(part[crosses] for part in one)) for one in pair)]


def _once(contact: Indices, middle: Array, step: float) -> NDArray[np.bool_]:
    """Whether each extremum is the first one of its place: one midway between two samples is near both."""
    place = np.mod(middle / step, round(2.0 * np.pi / step))
    apart = np.abs(place - place[:, None])
    return np.asarray(~np.tril((contact == contact[:, None]) & (apart < 0.01), -1).any(axis=1))


def reals(y: Complex) -> Array:
    """Real unknowns of a series: real parts of all harmonics, then imaginary parts of all but the constant."""
    return np.concatenate([y.real, y.imag[:, 1:]], axis=1).T.ravel()


def complexes(v: Array, contacts: int) -> Complex:
    """The series of real unknowns."""
    parts = v.reshape(-1, contacts).T
    last = parts.shape[1] // 2
    y = parts[:, : last + 1].astype(complex)
    y[:, 1:] += 1j * parts[:, last + 1 :]
    return y
