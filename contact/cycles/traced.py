"""The motion of a periodic orbit over its period, for pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, readonly, require_count
from contact.cycles.driven import Family
from contact.cycles.passage import passage
from contact.cycles.shooting import Orbit

SAMPLES = 240


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Trace:
    """Displacement [m] of each channel over one period of an orbit, (samples,) by channel, at `time` [s] from 0 on.

    >>> import numpy as np
    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> family = driven.over("freq_hz", freq_hz=0.1)
    >>> trace = ct.cycles.traced(family, ct.cycles.orbit(family, 0.1))
    >>> round(float(trace.time[-1]), 6), trace.displacement["x"].shape == trace.time.shape
    (10.0, True)
    """

    orbit: Orbit
    time: Array
    displacement: dict[str, Array]


def traced(family: Family, orbit: Orbit, samples: int = SAMPLES) -> Trace:
    """Follow an orbit over its period: u = D x + E lam of each channel, at equal steps.

    Every sample is a passage from the start of the orbit, so that contacts that are closed in between stay exact.
    Raises as `orbit` does.

    >>> from contact.cycles import DrivenBody, orbit
    >>> from contact import ModalBody, Patch
    >>> mass = ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> family = driven.over("freq_hz", freq_hz=0.2)
    >>> one = orbit(family, 0.16)
    >>> found = traced(family, one).displacement["x"]
    >>> bool(abs(found[-1] - found[0]) < 1e-9), bool(0.999 < abs(found).max() / one.amplitude["x"] <= 1.0 + 1e-9)
    (True, True)
    """
    require_count(samples=samples)
    motion, base = family.at(orbit.value)
    start, first = orbit.start * base, len(motion.plant.C)
    seen = slice(first, first + len(family.channels))
    time = np.linspace(0.0, orbit.period, samples + 1)
    found = np.empty((samples + 1, len(family.channels)))
    for k, after in enumerate(time[1:].tolist(), 1):
        there = passage(motion, orbit.x, start, after, tangent=False, extremes=False)
        driven = motion.phase(there.last)
        forced = driven.watched.at(motion.angle(start + after))
        found[k] = driven.phase.rows[seen] @ there.x + forced[seen]
    found[0] = found[-1]
    return Trace(
        orbit=orbit, time=readonly(time), displacement=dict(zip(family.channels, readonly(found).T, strict=True))
    )
