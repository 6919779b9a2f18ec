"""A rub as a film: the rim before the tips, gaps and forces at instants that a page can hold."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.model.gaps.rub import Rub, rub_of
from contact.problem import What
from contact.recovery import at_channels, rub_forces
from contact.result import Result

NUMBERS = 150_000  # that a film holds: fewer frames where there are more tips
FRAMES = 2000  # at most
A_PERIOD = 8  # frames in a period of the casing's motion
STRETCHES = 8  # into which a run is cut that is too long to be filmed whole
KEPT = 0.9999  # of the rim's mean square by the harmonics that are kept
MOST = 20  # harmonics at most
Places = NDArray[np.int_]


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
        Tips that stand before other rim lines.
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
    """The film of a rim or a rub whose states are stored; None of other problems and records.

    A run too long for its frames, `A_PERIOD` in a period of the casing's motion, is shown in stretches spread over it.
    """
    rub: Rub | None = rub_of(what)
    if rub is None or len(result.state) < 2 or result.channels.size or not result.time.size:
        return None
    tips = [j for j, tip in enumerate(rub.tips) if tip.line == rub.tips[0].line]
    line = rub.tips[0].line
    at, stretches = frames(rub, result, min(FRAMES, NUMBERS // (2 * MOST + 2 * len(tips))))
    shown = replace(result, state_time=result.state_time[at], state=result.state[at])
    channels = at_channels(rub.casing, shown.state_of("casing"), rub_forces(rub, shown, "casing")[1])
    n_max = rub.casing.n_max
    first = line * rub.casing.directions * (2 * n_max + 1)
    cos = channels[:, first : first + n_max + 1]
    sin = np.hstack([np.zeros((len(at), 1)), channels[:, first + n_max + 1 : first + 2 * n_max + 1]])
    n = largest(cos, sin)
    near = np.minimum(np.searchsorted(result.time, shown.state_time), result.time.size - 1)
    return RubFilm(
        time=shown.state_time,
        turned=rub.speed.angles(shown.state_time),
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
    """Which of the stored states a film shows, and where its stretches begin."""
    stored = len(result.state_time)
    power = np.mean(result.state_of("casing") ** 2, axis=0)
    omega = math.sqrt(float(power @ rub.casing.omega**2) / (float(power.sum()) or 1.0))
    step = float(np.diff(result.state_time).mean())
    every = max(1, int(2.0 * math.pi / (A_PERIOD * step * omega))) if omega > 0.0 else 1
    if stored <= count * every:
        at = np.arange(0, stored, every)
        return at, np.zeros(1, dtype=int)
    length = count // STRETCHES
    starts = np.linspace(0, stored - 1 - (length - 1) * every, STRETCHES).astype(int)
    return (starts[:, None] + every * np.arange(length)).ravel(), length * np.arange(STRETCHES)


def largest(cos: Array, sin: Array) -> Places:
    """The harmonics that carry `KEPT` of the mean square, at most `MOST`, ascending."""
    power = np.mean(cos**2 + sin**2, axis=0)
    order = np.argsort(-power, kind="stable")
    share = np.cumsum(power[order]) / (float(power.sum()) or 1.0)
    return np.sort(order[: min(int(np.searchsorted(share, KEPT)) + 1, MOST)])
