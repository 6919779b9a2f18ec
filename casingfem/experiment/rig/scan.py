"""A circle scan on the test rig: a laser spot moves around the casing under harmonic excitation, in the steady state.

Either the mirror rotates (casing at rest), or the casing rotates on a lathe under a laser at rest: the spot's angle on
the casing is theta = theta_0 + 2 pi (mirror - turning) t. A shaker that rotates with the casing excites at omega. A
force fixed in space (a magnet) moves along a rotating casing and excites it at omega - m 2 pi turning through the m-th
harmonic of each shape. If laser and force are both at rest, all lines of the same m + n coincide and the demodulation
refuses them; then let the mirror rotate too.

Modes are those of the casing at rest: Coriolis forces, which split a thin ring's pair by 4 n/(n^2 + 1) of the rate of
rotation, and the part turning/(n f) of the beam velocity due to hoop motion are left out, since lathes rotate slowly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.circle.record import ScanRecord, turning
from casingfem.experiment.rig.rig import SYNTHETIC, Rig, noise, resonances
from casingfem.io.arrays import Array, FloatArray, IntArray

EVEN = 1e-9  # rad: how evenly a circle's probes are


class Tone(NamedTuple):
    """A force F cos(2 pi f t + phase): frequency [Hz], amplitude [N], phase [rad].

    >>> Tone(freq=120.0, amplitude=2.0).phase
    0.0
    """

    freq: float
    amplitude: float = 1.0
    phase: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Turning:
    """Rotation of mirror and casing during a scan, and the signals that it adds.

    Parameters
    ----------
    mirror, casing
        Turns per second, signed; the spot moves over the casing at their difference.
    first_angle
        The spot's angle on the casing at the start [rad].
    wander
        Relative slow variation of the spot's rate (rms), as a tachometer would show it; only with a casing at rest.
    runout
        Velocities [m/s] at 1, 2, ... times the rate of rotation: (cos, sin) each.
    speckle
        Velocity noise [m/s rms] that is the same every turn.

    >>> Turning(mirror=2.5).spot
    2.5
    """

    mirror: float = 0.0
    casing: float = 0.0
    first_angle: float = 0.0
    wander: float = 0.0
    runout: tuple[tuple[float, float], ...] = ()
    speckle: float = 0.0

    def __post_init__(self) -> None:
        values = (self.mirror, self.casing, self.first_angle, self.wander, self.speckle)
        if not np.isfinite(values).all() or self.spot == 0.0:
            raise InputError(
                f"turning: mirror {self.mirror!r}, casing {self.casing!r}: expected at least one of them to turn"
            )
        if self.wander < 0.0 or self.wander > 0.1 or self.speckle < 0.0 or (self.wander and self.casing):
            raise InputError(f"wander {self.wander!r}, speckle {self.speckle!r}: expected wander 0 to .1 (0 where the "
                           "casing turns), speckle 0 or more")  # fmt: skip

    @property
    def spot(self) -> float:
        """Rate of the spot on the casing [turns/s]."""
        return self.mirror - self.casing


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scan:
    """A record and its exact waves V (tones, orders), at the tones in the casing's frame, orders n ascending."""

    record: ScanRecord
    n: IntArray
    V: Array


def circle_content(rig: Rig, circle: Sequence[int]) -> tuple[IntArray, Array]:
    """Orders -N..N and the harmonics exp(-i n theta)/P over a circle of evenly spaced probes, (orders, probes).

    Raises
    ------
    InputError
        The probes are not evenly spaced around, or fewer than three.
    """
    chosen = rig.checked(circle)
    angles = np.unwrap([rig.probes[k].angle for k in chosen])
    count = len(angles)
    even = angles[0] + 2.0 * np.pi * np.arange(count) / count
    if count < 3 or np.abs(angles - even).max() > EVEN:
        raise InputError(f"circle: found {count} probes at uneven angles, expected 3 or more, evenly spaced around")
    n = np.arange(-((count - 1) // 2), (count - 1) // 2 + 1)
    return n, np.exp(-1j * np.multiply.outer(n, even)) / count


def wave_of(rig: Rig, circle: Sequence[int], push: Array, residual: Array, freq: float) -> Array:
    """Velocity harmonics V_n [m/s] around a circle under modal forces `push` at one frequency, (orders,)."""
    _, transform = circle_content(rig, circle)
    omega = np.array([2.0 * np.pi * freq])
    q = resonances(rig, omega)[:, 0] * push
    return np.asarray(2j * np.pi * freq * (transform @ (rig.rows[list(circle)] @ q + residual)))


def scan(
    rig: Rig,
    turn: Turning,
    tones: Sequence[Tone],
    *,
    circle: Sequence[int],
    drive: int | None = None,
    drive_circle: Sequence[int] = (),
    drive_angle: float = 0.0,
    fs: float,
    seconds: float,
    seed: int,
    snr_db: float | None = None,
    highest: int | None = None,
    card: Sequence[str] = (),
) -> Scan:
    """A circle scan in the steady state.

    Parameters
    ----------
    turn
        Rotation of mirror and casing.
    tones
        The forces; several excite several modes at once.
    circle
        Probes of the laser's circle, evenly spaced.
    drive
        Probe of a shaker fixed to the casing.
    drive_circle, drive_angle
        Instead: the circle along which a force fixed in space moves, and its angle at the start.
    snr_db
        Level of white noise below the signal's rms [dB].
    highest
        Highest harmonic m of the shapes that a force fixed in space excites; by default all of its circle.

    Raises
    ------
    InputError
        There is neither or both kinds of drive, or probes do not exist or are not evenly spaced.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, supports={"base": cf.Clamped()},
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> spots = cf.rig.circle(0.1, 6)
    >>> rig = cf.rig.rig_of(cf.modes(casing, 2), [cf.rig.Place(at=(0.1, 0.5)), *spots], zeta=0.002)
    >>> found = scan(rig, Turning(mirror=2.0), [Tone(freq=400.0)], circle=range(1, 7), drive=0, fs=1024.0, seconds=1.0,
    ...              seed=1)
    >>> found.record.velocity.size
    1024
    """
    if (drive is None) == (not drive_circle):
        raise InputError("drive: expected a probe fixed to the casing, or a circle for a force fixed in space")
    count = round(fs * seconds)
    if not (fs > 0.0 and count > 1):
        raise InputError(f"fs {fs!r}, seconds {seconds!r}: expected a record of two samples or more")
    rng = np.random.default_rng(seed)
    n, _ = circle_content(rig, circle)
    if drive is not None:
        felt = {tone.freq: on_casing(rig, circle, rig.checked([drive])[0], tone) for tone in tones}
    else:
        felt = in_space(rig, circle, turn, tones, drive_circle, drive_angle, highest)
    freq = np.array(sorted(felt))
    V = np.array([felt[f] for f in freq.tolist()])
    angle = spot_angle(turn, fs, count, rng)
    velocity = velocity_at_spot(V, freq, n, angle, fs) + repeating_noise(turn, angle, rng)
    notes = [SYNTHETIC, *card, f"circle scan: {turn!r}; tones {[tuple(tone) for tone in tones]}; seed {seed}"]
    if turn.casing:
        split = 1.6 * abs(turn.casing)
        notes.append(f"neglected: Coriolis forces, which split a thin ring's pair n = 2 by {split:.3g} Hz")
    if snr_db is not None:
        velocity = velocity + noise(velocity[None], snr_db, rng)[0]
        notes.append(f"noise: {snr_db:g} dB below the rms")
    record = ScanRecord(fs=fs, velocity=velocity, angle=angle, tones=tuple(freq.tolist()), card=tuple(notes))
    return Scan(record=record, n=n, V=V)


def on_casing(rig: Rig, circle: Sequence[int], drive: int, tone: Tone) -> Array:
    """V_n of a shaker fixed to the casing, (orders,)."""
    force = tone.amplitude * np.exp(1j * tone.phase)
    return wave_of(rig, circle, rig.rows[drive] * force, rig.S[list(circle), drive] * force, tone.freq)


def in_space(
    rig: Rig,
    circle: Sequence[int],
    turn: Turning,
    tones: Sequence[Tone],
    drive_circle: Sequence[int],
    drive_angle: float,
    highest: int | None,
) -> dict[float, Array]:
    """V_n at the frequencies in the casing's frame, omega - m turning, for forces fixed in space."""
    m, transform = circle_content(rig, drive_circle)
    kept = np.abs(m) <= (m.max() if highest is None else highest)
    at = rig.checked(drive_circle)
    shapes = transform[kept] @ rig.rows[at]
    beyond = transform[kept] @ rig.S[np.ix_(at, rig.checked(circle))]
    felt: dict[float, Array] = {}
    for tone in tones:
        force = tone.amplitude * np.exp(1j * tone.phase)
        for k, order in enumerate(m[kept].tolist()):
            turned = force * np.exp(1j * order * drive_angle)
            freq = round(tone.freq - order * turn.casing, 9)
            wave = wave_of(rig, circle, shapes[k] * turned, beyond[k] * turned, freq)
            felt[freq] = felt.get(freq, 0.0) + wave
    return felt


def spot_angle(turn: Turning, fs: float, count: int, rng: np.random.Generator) -> FloatArray:
    """Angle of the spot on the casing [rad], with the slow random variation of its rate."""
    even = turning(turn.spot, fs, count, first_angle=turn.first_angle)
    if not turn.wander:
        return even
    slow = rng.standard_normal((2, 4))
    phase = 2.0 * np.pi * np.multiply.outer(np.arange(1, 5), np.arange(count) / count)
    variation = turn.wander * (slow[0] @ np.cos(phase) + slow[1] @ np.sin(phase)) / 2.0
    return np.asarray(even + 2.0 * np.pi * turn.spot / fs * (np.cumsum(variation) - variation))


def velocity_at_spot(V: Array, freq: FloatArray, n: IntArray, angle: FloatArray, fs: float) -> FloatArray:
    """v(t) = Re sum V_n e^(i (omega t + n theta)), (samples,)."""
    around = np.exp(1j * angle)
    time = np.arange(len(angle)) / fs
    velocity = np.zeros(len(angle))
    for waves, f in zip(V, freq.tolist(), strict=True):  # Horner's rule in e^(i theta)
        total = np.zeros(len(angle), complex)
        for amplitude in waves[::-1]:
            total = total * around + amplitude
        velocity += np.real(total * around ** int(n[0]) * np.exp(2j * np.pi * f * time))
    return velocity


def repeating_noise(turn: Turning, angle: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Velocities that repeat with the spot's angle: run-out and speckle [m/s], (samples,)."""
    velocity = np.zeros(len(angle))
    for k, (cos, sin) in enumerate(turn.runout, start=1):
        velocity += cos * np.cos(k * angle) + sin * np.sin(k * angle)
    if turn.speckle:
        grain = rng.standard_normal(4096)
        at = np.mod(angle / (2.0 * np.pi), 1.0) * len(grain)
        velocity += turn.speckle * np.interp(at, np.arange(len(grain) + 1), np.r_[grain, grain[0]]) * np.sqrt(1.5)
    return velocity
