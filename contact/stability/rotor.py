"""Stability of a rotor over its speed: internal damping and cross-coupled bearings."""

from __future__ import annotations

from dataclasses import replace

from contact.base.arrays import Array
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.whirl import growth
from contact.stability.closed_contact import FLOOR
from contact.stability.growth_map import StabilityMap, ascending, scan


def of_rotor(rotor: Rotor, speed_hz: Array) -> StabilityMap:
    """Largest growth of a rotor's free motion over speed, with the edges of the unstable bands as roots.

    Raises InputError unless the speeds [turns/s] are two or more and ascend.

    >>> import numpy as np
    >>> from contact.model.rotor import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=1.0, stiffness=100.0, zeta=0.02, zeta_internal=0.01), 1.0)
    >>> found = of_rotor(rotor, np.linspace(0.0, 10.0, 21))
    >>> f"{2.0 * np.pi * found.bands_hz[0][0]:.4f} rad/s"  # 10 rad/s (1 + 0.02/0.01)
    '30.0000 rad/s'
    """
    floor = FLOOR * max(float(rotor.body.omega.max(initial=0.0)), 1.0)
    found = scan(lambda at: growth(rotor, at), ascending(speed_hz), floor=floor)
    if not found.diverges:
        words = f"The rotor is stable from {found.speed_hz[0]:.5g} to {found.speed_hz[-1]:.5g} Hz."
    else:
        low, high = found.bands_hz[0]
        words = f"The free motion grows from {low:.6g} to {high:.6g} Hz ({60.0 * low:,.5g} to {60.0 * high:,.5g} rpm)."
    return replace(found, words=words)
