"""Histories that one can look at: forces row by row, the motion of a tip and of the rim before it, stored energy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array
from contact.model.gaps.rub import Rub, rub_of
from contact.model.trig import harmonics
from contact.problem import What
from contact.recovery import at_channels, rub_forces
from contact.result import Result

ROWS = 100_000  # of a table of forces: longer records are summed up


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class TipMotion:
    """Motion of one tip and of the rim where it stands, (ns, 2) each: along the normal and along the rim [m]."""

    time: Array
    tip: Array
    rim: Array


def force_table(result: Result, rows: int = ROWS) -> dict[str, Array]:
    """Columns of the force history: time, and of each contact mean force, largest force and smallest gap of a row.

    A record longer than `rows` is summed up, so many samples to a row: the mean force is that of the impulse, no peak
    is lost.

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
    """Strain energy [J] of each modal body at `result.state_time`, by its name; none of other problems."""
    rub: Rub | None = rub_of(what)
    if rub is None or result.channels.size or not len(result.state):
        return {}
    return {
        name: 0.5 * np.sum((result.state_of(name) * body.omega) ** 2, axis=1)
        for name, body in zip(rub.names, rub.bodies, strict=True)
    }


def tip_motion(what: object, result: Result) -> TipMotion | None:
    """Motion of the first tip of a rim or rub whose states are stored, residual compliance included; else None."""
    rub: Rub | None = rub_of(what)
    if rub is None or len(result.state) < 2 or result.channels.size:
        return None
    tip = rub.tips[0]
    name = rub.names[1 + tip.blade]
    casing, blade = (
        at_channels(body, result.state_of(of), rub_forces(rub, result, of)[1])
        for of, body in (("casing", rub.casing), (name, rub.blades[tip.blade]))
    )
    moved = blade @ tip.directions(rub.blades[tip.blade])[:2].T
    turned = rub.speed.angles(result.state_time)
    phi = math.radians(tip.angle_deg) - turned
    rim = _rim(casing, phi, rub.casing.n_max, tip.line, rub.casing.directions)
    return TipMotion(time=result.state_time, tip=moved, rim=rim)


def _rim(channels: Array, phi: Array, n_max: int, line: int, directions: int) -> Array:
    """Radial and tangential motion (ns, 2) at the angles phi (ns,) from the channels of a rim."""
    size, waves = 2 * n_max + 1, harmonics(n_max, phi)
    first = line * directions * size
    parts = (channels[:, first + i * size : first + (i + 1) * size] for i in (0, 1))
    return np.stack([np.sum(part * waves, axis=1) for part in parts], axis=1)
