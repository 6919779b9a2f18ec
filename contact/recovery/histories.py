"""Time histories of a run for tables and pictures: forces, motion of tip and rim, strain energy, a rub in frames."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.model.gaps.rub import Rub, rub_of
from contact.model.trig import harmonics
from contact.on_rotor import rotor_motion, rotor_turned
from contact.problem import What
from contact.recovery.displacements import at_channels, casing_motion, rub_forces
from contact.result import Result

ROWS = 100_000  # of a table of forces: longer records are summed up
NUMBERS = 150_000  # that a film contains: fewer frames where there are more tips
FRAMES = 2000  # at most
A_PERIOD = 8  # frames in a period of the casing's motion
STRETCHES = 8  # into which a run is cut that is too long to be filmed whole
KEPT = 0.9999  # of the rim's mean square by the harmonics that are kept
MOST = 20  # harmonics at most
Places = NDArray[np.int_]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class TipMotion:
    """Motion of one tip and of the rim at its place, (ns, 2) each: along the normal and along the rim [m].

    `time` (ns,) [s]. While the contact is closed, clearance + rim - tip along the normal is zero.

    >>> motion = TipMotion(time=np.zeros(1), tip=np.array([[3e-4, 0.0]]), rim=np.array([[1e-4, 0.0]]))
    >>> round(float(motion.tip[0, 0] - motion.rim[0, 0]), 9)
    0.0002
    """

    time: Array
    tip: Array
    rim: Array


def force_table(result: Result, rows: int = ROWS) -> dict[str, Array]:
    """Columns of the force history: time, and mean force, largest force and smallest gap of each contact.

    A record longer than `rows` is condensed to several samples a row. The mean force keeps the impulse, and no peak is
    lost.

    Parameters
    ----------
    result
        Result of a run.
    rows
        Largest number of rows.

    Returns
    -------
    dict of str to array
        "time_s" [s], and for contact k from 1 on "force{k}_mean_N", "force{k}_peak_N" [N] and "gap{k}_least_m" [m],
        (rows,) each.

    Examples
    --------
    >>> from contact.model.bodies.body import Rod, Wall
    >>> from contact.run import run
    >>> rod = Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=20, x=5.0, velocity=-10.0)
    >>> table = force_table(run([rod, Wall()], t_end=2.0, courant=0.9), rows=50)
    >>> list(table), len(table["time_s"])
    (['time_s', 'force1_mean_N', 'force1_peak_N', 'gap1_least_m'], 45)
    """
    n = result.time.size
    starts = np.arange(0, n, max(1, -(-n // rows)))
    ends = np.append(starts[1:], n) - 1
    found = {"time_s": result.time[starts]} if n else {"time_s": result.time}
    for k in range(result.force.shape[1] if n else 0):
        total = result.impulse_history[ends, k]
        span = np.diff(np.concatenate([[-0.5 * result.dt], result.time[ends] + 0.5 * result.dt]))
        found[f"force{k + 1}_mean_N"] = np.diff(total, prepend=0.0) / span
        found[f"force{k + 1}_peak_N"] = np.maximum.reduceat(result.force[:, k], starts)
        found[f"gap{k + 1}_least_m"] = np.minimum.reduceat(result.gap[:, k], starts)
    return found


def strain_energy(what: What, result: Result) -> dict[str, Array]:
    """Strain energy of each modal body of a rim or rub at its stored states.

    V = sum_i (omega_i q_i)^2/2 over the mass-normalised modes of a body; its residual compliance is not counted.

    Parameters
    ----------
    what
        The rim, rub or disk that was run.
    result
        Its result, with stored states (`state_every` of `contact.Record`).

    Returns
    -------
    dict of str to array
        Energy [J] at `result.state_time` by the name of the body, such as "casing"; empty for other problems and for
        records without states of the modes.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=5.0)
    >>> result = ct.run(rim, t_end=0.01, dt=1e-5, record=ct.Record(state_every=10))
    >>> energy = strain_energy(rim, result)
    >>> list(energy), bool((energy["blade"] >= 0.0).all())
    (['casing', 'blade'], True)
    """
    rub: Rub | None = rub_of(what)
    if rub is None or result.channels.size or not len(result.state):
        return {}
    return {
        name: 0.5 * np.sum((result.state_of(name) * body.omega) ** 2, axis=1)
        for name, body in zip(rub.names, rub.bodies, strict=True)
    }


def tip_motion(what: object, result: Result, casing: Array | None = None) -> TipMotion | None:
    """Motion of the first tip of a rim or rub and of the rim before it, with residual compliance.

    Parameters
    ----------
    what
        The rim, rub or disk that was run.
    result
        Its result, with stored states (`state_every` of `contact.Record`).
    casing
        Its `contact.recovery.casing_motion`, if it was computed before, (ns, K) [m].

    Returns
    -------
    TipMotion or None
        None for other problems and for records without states.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=5.0)
    >>> result = ct.run(rim, t_end=0.01, dt=1e-5, record=ct.Record(state_every=10))
    >>> motion = tip_motion(rim, result)
    >>> closed = result.tip_force[:, 0] > 1.0
    >>> gap = rim.clearance + motion.rim[:, 0] - motion.tip[:, 0]
    >>> bool(closed.any()), bool(abs(gap[closed]).max() < 1e-7)
    (True, True)
    """
    rub: Rub | None = rub_of(what)
    casing = casing_motion(what, result) if casing is None else casing
    if rub is None or casing is None:
        return None
    tip = rub.tips[0]
    name = rub.names[1 + tip.blade]
    blade = at_channels(rub.blades[tip.blade], result.state_of(name), rub_forces(rub, result, name)[1])
    moved = blade @ tip.directions(rub.blades[tip.blade])[:2].T
    turned = -rotor_turned(rub, result)
    phi = math.radians(tip.angle_deg) - turned
    rim = _rim(casing, phi, rub.casing.n_max, tip.line, rub.casing.directions)
    x, y = rotor_motion(rub, result).T
    moved = moved + np.stack([x * np.cos(phi) + y * np.sin(phi), y * np.cos(phi) - x * np.sin(phi)], axis=1)
    return TipMotion(time=result.state_time, tip=moved, rim=rim)


def _rim(channels: Array, phi: Array, n_max: int, line: int, directions: int) -> Array:
    """Radial and tangential motion (ns, 2) at the angles phi (ns,) from the channels of a rim."""
    size, waves = 2 * n_max + 1, harmonics(n_max, phi)
    first = line * directions * size
    parts = (channels[:, first + i * size : first + (i + 1) * size] for i in (0, 1))
    return np.stack([np.sum(part * waves, axis=1) for part in parts], axis=1)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RubFilm:
    """A rub in frames.

    Attributes
    ----------
    time, turned
        Of each frame: instant [s] and angle that the casing has turned [rad], (frames,).
    stretches
        First frame of each stretch of even steps; one where the whole run is shown.
    n, cos, sin
        Harmonics of the rim's radial motion and their amplitudes [m], (harmonics,) and (frames, harmonics) each.
    profile
        Deviation of the radius as built [m] at equal steps of the angle on the casing, (places,).
    radius
        Of the rim [m].
    left_out
        Tips that are before other rim lines.
    angle
        Angles of the tips at rest [rad], (tips,): those on the rim line of the first.
    gap, force
        Of each tip [m], [N] (averaged over the model's shortest period), (frames, tips).

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=5.0)
    >>> result = ct.run(rim, t_end=0.01, dt=1e-5, record=ct.Record(state_every=10))
    >>> film = rub_film(rim, result)
    >>> isinstance(film, RubFilm), film.n.tolist(), film.radius
    (True, [4], 0.5)
    """

    time: Array
    turned: Array
    stretches: Places
    n: Places
    cos: Array
    sin: Array
    profile: Array
    radius: float
    left_out: int
    angle: Array
    gap: Array
    force: Array


def rub_film(what: What, result: Result, *, places: int = 360) -> RubFilm | None:
    """A rub in frames: harmonics of the rim, positions of the tips, gaps and forces.

    There are eight frames in a period of the casing's motion and at most 2000 of them. A run that is too long for that
    is shown in eight stretches spread over it. The harmonics that are kept have 99.99 % of the rim's mean square, and
    are at most twenty.

    Parameters
    ----------
    what
        The rim, rub or disk that was run.
    result
        Its result, with stored states (`state_every` of `contact.Record`).
    places
        Number of angles at which the radius as built is given.

    Returns
    -------
    RubFilm or None
        None for other problems and for records without states of the modes.

    Examples
    --------
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ct.ModalBody(omega=[600.0], zeta=[0.01], channels=("span", "flap"), rows=[[1.0], [0.0]],
    ...                      S=[[1e-7, 0.0], [0.0, 1e-7]])
    >>> rim = ct.RotatingRim(casing, blade, clearance=-1e-5, speed_hz=5.0)
    >>> result = ct.run(rim, t_end=0.01, dt=1e-5, record=ct.Record(state_every=10))
    >>> film = rub_film(rim, result, places=4)
    >>> film.cos.shape == (film.time.size, 1), film.profile.tolist()
    (True, [0.0, 0.0, 0.0, 0.0])
    """
    rub: Rub | None = rub_of(what)
    if rub is None or len(result.state) < 2 or result.channels.size or not result.time.size:
        return None
    tips = [j for j, tip in enumerate(rub.tips) if tip.line == rub.tips[0].line]
    line = rub.tips[0].line
    at, stretches = frames(rub, result, min(FRAMES, NUMBERS // (2 * MOST + 2 * len(tips))))
    shown = replace(result, state_time=result.state_time[at], state=result.state[at], tip_force=result.tip_force[at])
    channels = at_channels(rub.casing, shown.state_of("casing"), rub_forces(rub, shown, "casing")[1])
    n_max = rub.casing.n_max
    first = line * rub.casing.directions * (2 * n_max + 1)
    cos = channels[:, first : first + n_max + 1]
    sin = np.hstack([np.zeros((len(at), 1)), channels[:, first + n_max + 1 : first + 2 * n_max + 1]])
    n = largest(cos, sin)
    near = np.minimum(np.searchsorted(result.time, shown.state_time), result.time.size - 1)
    return RubFilm(
        time=shown.state_time,
        turned=-rotor_turned(rub, shown),
        stretches=stretches,
        n=n,
        cos=cos[:, n],
        sin=sin[:, n],
        profile=np.array([rub.profile(2.0 * math.pi * k / places) for k in range(places)]),
        radius=rub.casing.line_radius(line),
        left_out=len(rub.tips) - len(tips),
        angle=np.radians([rub.tips[j].angle_deg for j in tips]),
        gap=result.gap[near][:, tips],
        force=result.windowed_force()[near][:, tips],
    )


def frames(rub: Rub, result: Result, count: int) -> tuple[Places, Places]:
    """Stored states that a film shows, and the first frame of each part."""
    stored = len(result.state_time)
    own = slice(0, rub.flexible)  # without the modes of a rotor and its angle, which grows
    power = np.mean(result.state_of("casing")[:, own] ** 2, axis=0)
    omega = math.sqrt(float(power @ rub.casing.omega[own] ** 2) / (float(power.sum()) or 1.0))
    step = float(np.diff(result.state_time).mean())
    every = max(1, int(2.0 * math.pi / (A_PERIOD * step * omega))) if omega > 0.0 else 1
    if stored <= count * every:
        at = np.arange(0, stored, every)
        return at, np.zeros(1, dtype=int)
    length = count // STRETCHES
    starts = np.linspace(0, stored - 1 - (length - 1) * every, STRETCHES).astype(int)
    return (starts[:, None] + every * np.arange(length)).ravel(), length * np.arange(STRETCHES)


def largest(cos: Array, sin: Array) -> Places:
    """The harmonics that contain `KEPT` of the mean square, at most `MOST`, ascending."""
    power = np.mean(cos**2 + sin**2, axis=0)
    order = np.argsort(-power, kind="stable")
    share = np.cumsum(power[order]) / (float(power.sum()) or 1.0)
    return np.sort(order[: min(int(np.searchsorted(share, KEPT)) + 1, MOST)])
