"""Time histories for display: forces, motion of a tip and of the rim at the tip, stored energy; a rub as a film."""

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
from contact.recovery import at_channels, casing_motion, rub_forces
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
    """Motion of one tip and of the rim at its place, (ns, 2) each: along the normal and along the rim [m]."""

    time: Array
    tip: Array
    rim: Array


def force_table(result: Result, rows: int = ROWS) -> dict[str, Array]:
    """Columns of the force history: time, and mean force, largest force and smallest gap of each contact.

    A record longer than `rows` is condensed to several samples a row. The mean force keeps the impulse, and no peak is
    lost.

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
    """Strain energy [J] of each modal body at `result.state_time`, by its name; empty for other problems."""
    rub: Rub | None = rub_of(what)
    if rub is None or result.channels.size or not len(result.state):
        return {}
    return {
        name: 0.5 * np.sum((result.state_of(name) * body.omega) ** 2, axis=1)
        for name, body in zip(rub.names, rub.bodies, strict=True)
    }


def tip_motion(what: object, result: Result, casing: Array | None = None) -> TipMotion | None:
    """Motion of the first tip of a rim or rub whose states are stored, residual compliance included; else None.

    `casing` is its `casing_motion` if it was computed before.
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
    """The film of a rim or rub whose states are stored; None for other problems and records.

    With `A_PERIOD` frames in a period of the casing's motion, a long run is shown in parts spread over it.
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
