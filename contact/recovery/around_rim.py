"""Motion of a rim by harmonics, its largest deflection, contact force over angle and time, Poincare sections."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array
from contact.model.gaps.deflection import ROWS, around
from contact.model.gaps.deflection import rim_motion as by_waves
from contact.model.gaps.limits import WALL
from contact.model.gaps.rub import Rub, rub_of
from contact.problem import What
from contact.recovery.histories import TipMotion, tip_motion
from contact.result import Result

TURNS = 8  # a section of fewer points shows nothing
FINE = 10  # states in a turn: fewer do not show where a motion is at one instant of it


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RimMotion:
    """Radial motion of a rim, residual compliance included (`contact.model.gaps.deflection`).

    Attributes
    ----------
    time
        Instants of the states [s], (ns,).
    waves
        z_n = a_n + i b_n of the deflection sum a_n cos(n theta) + b_n sin(n theta) [m] of the first tip's line, theta
        fixed to the casing, (ns, N + 1). For a wave that travels towards +theta, z_n rotates with a positive frequency.
    deflection
        Largest magnitude around any line of the rim at each instant [m], (ns,).
    largest
        Largest deflection of the run [m], also between the stored times where it exceeds half the wall.
    wall, allowed
        Thickness of the wall, and half of it, to which the linear model is valid [m]; infinite if unknown.
    with_blades
        Sign of the frequencies of z_n that travel with the blades, in the casing's frame; 0 without rotation.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=50.0, turning="casing")
    >>> result = ct.run(rim, t_end=0.01, dt=1e-5, record=ct.Record(state_every=10))
    >>> motion = rim_motion(rim, result)
    >>> isinstance(motion, RimMotion), motion.waves.shape[1], int(abs(motion.waves[-1]).argmax())
    (True, 5, 4)
    """

    time: Array
    waves: Array
    deflection: Array
    largest: float
    wall: float
    allowed: float
    with_blades: int


def rim_motion(what: What, result: Result) -> RimMotion | None:
    """Radial motion of the rim of a run by waves, and its largest deflection around any line.

    u_r(theta) = sum_n a_n cos n theta + b_n sin n theta, (a, b) = rows q + S F with the modal coordinates q and the
    forces F of the tips.

    Parameters
    ----------
    what
        The rim, rub or disk that was run.
    result
        Its result, with stored states (`state_every` of `contact.Record`).

    Returns
    -------
    RimMotion or None
        None for other problems, and for records without states of the modes.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=50.0, turning="casing")
    >>> result = ct.run(rim, t_end=0.01, dt=1e-5, record=ct.Record(state_every=10))
    >>> motion = rim_motion(rim, result)
    >>> bool(motion.largest == motion.deflection.max()), motion.with_blades
    (True, -1)
    """
    rub: Rub | None = rub_of(what)
    if rub is None or len(result.state) < 2 or result.channels.size:
        return None
    time, q, forces, line = result.state_time, result.state_of("casing"), result.tip_force, rub.tips[0].line
    parts = [slice(k, k + ROWS) for k in range(0, time.size, ROWS)]
    motion = [by_waves(rub, time[part], q[part], forces[part]) for part in parts]
    first, N = np.concatenate([part[:, line] for part in motion]), rub.casing.n_max
    waves = first[:, : N + 1].astype(complex)
    waves[:, 1:] += 1j * first[:, N + 1 :]
    moved = np.concatenate([around(part).max(axis=1) for part in motion])
    speed = rub.speed.omega(result.steps * result.dt)
    return RimMotion(
        time=time, waves=waves, deflection=moved, largest=max(float(moved.max()), result.notes.deflection),
        wall=rub.wall, allowed=WALL * rub.wall, with_blades=-int(np.sign(speed)),
    )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ForceMap:
    """Largest force of any tip [N] by time (rows + 1 edges [s]) and place on the casing (bars + 1 edges [degrees]).

    `force` (rows, bars) is nan where no tip passed.

    Examples
    --------
    >>> found = ForceMap(time=np.array([0.0, 0.1]), angle_deg=np.array([0.0, 180.0, 360.0]), force=np.ones((1, 2)))
    >>> found.force.shape
    (1, 2)
    """

    time: Array
    angle_deg: Array
    force: Array


def force_over_angle(what: What, result: Result, *, bars: int = 180, rows: int = 160) -> ForceMap | None:
    """Largest tip force over the angle on the casing and over time.

    A row is a whole number of turns; the last may be longer. Forces are averaged over the model's shortest period
    (`Result.windowed_force`).

    Parameters
    ----------
    what
        The rim, rub or disk that was run.
    result
        Its result, with samples of the forces.
    bars
        Number of places around the casing.
    rows
        Largest number of rows.

    Returns
    -------
    ForceMap or None
        None for other problems, and for less than one turn.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=50.0, turning="casing")
    >>> result = ct.run(rim, t_end=0.05, dt=1e-5)
    >>> found = force_over_angle(rim, result, bars=36)
    >>> found.force.shape, bool(np.nanmax(found.force) > 0.0)
    ((2, 36), True)
    """
    rub: Rub | None = rub_of(what)
    if rub is None or result.time.size < 2 or not result.force.shape[1]:
        return None
    turned = rub.speed.angles(result.time)
    turns = abs(float(turned[-1] - turned[0])) / (2.0 * math.pi)
    if turns < 1.0:
        return None
    each = math.ceil(turns / rows)  # turns of a row; the last has the rest too
    count = int(turns) // each
    row = np.minimum((np.abs(turned - turned[0]) / (2.0 * math.pi * each)).astype(int), count - 1)
    found = np.full((count, bars), -np.inf)
    windowed = result.windowed_force()
    for k, tip in enumerate(rub.tips):
        place = np.mod(math.radians(tip.angle_deg) - turned, 2.0 * math.pi) * (bars / (2.0 * math.pi))
        np.maximum.at(found, (row, np.minimum(place.astype(int), bars - 1)), windowed[:, k])
    starts = result.time[np.searchsorted(row, np.arange(count))]
    return ForceMap(
        time=np.append(starts, result.time[-1]), angle_deg=np.linspace(0.0, 360.0, bars + 1),
        force=np.where(np.isfinite(found), found, np.nan),
    )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Section:
    """Poincare section: once a turn, motion of the tip along its normal [m] and its velocity [m/s].

    A motion with the period of one turn gives one point, of k turns k points; chaotic motion gives a cloud.

    >>> found = Section(time=np.array([0.1, 0.2]), displacement=np.array([1e-4, 1e-4]), velocity=np.zeros(2))
    >>> float(np.ptp(found.displacement))
    0.0
    """

    time: Array
    displacement: Array
    velocity: Array


def once_a_turn(what: What, result: Result, moved: TipMotion | None = None) -> Section | None:
    """Poincare section of the first tip: one point per turn in the second half of a run.

    Parameters
    ----------
    what
        The rim, rub or disk that was run.
    result
        Its result, with stored states (`state_every` of `contact.Record`).
    moved
        Motion of the tip (`contact.recovery.tip_motion`), if it was computed before.

    Returns
    -------
    Section or None
        None for fewer than ten states in a turn or eight turns in the second half.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=50.0, turning="casing")
    >>> result = ct.run(rim, t_end=0.5, dt=1e-5, record=ct.Record(every=20, state_every=20))
    >>> once_a_turn(rim, result).time.round(3).tolist()[:2]
    [0.26, 0.28]
    """
    rub: Rub | None = rub_of(what)
    moved = tip_motion(what, result) if moved is None else moved
    if rub is None or moved is None:
        return None
    turned = np.abs(rub.speed.angles(moved.time)) / (2.0 * math.pi)
    half = 0.5 * (turned[0] + turned[-1])
    numbers = np.arange(math.ceil(half), math.floor(float(turned[-1])) + 1, dtype=float)
    if len(numbers) < TURNS or len(turned) < FINE * (turned[-1] - turned[0]) or np.any(np.diff(turned) < 0.0):
        return None
    at = np.interp(numbers, turned, moved.time)
    normal = moved.tip[:, 0]
    velocity = np.gradient(normal, moved.time)
    return Section(
        time=at, displacement=np.interp(at, moved.time, normal), velocity=np.interp(at, moved.time, velocity)
    )
