"""Units in words, such as "mm-t-s": length, mass and time of given matrices, converted to SI."""

from __future__ import annotations

from typing import NamedTuple

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048}
MASSES = {"kg": 1.0, "g": 1e-3, "t": 1e3, "lb": 0.45359237}
TIMES = {"s": 1.0, "ms": 1e-3}
FORCES = {"lbf": 4.4482216152605}  # a force in the place of the mass: then the mass is force times time^2 over length


class Units(NamedTuple):
    """Lengths of the units in SI: length in m, mass in kg, time in s."""

    length: float
    mass: float
    time: float

    @property
    def stiffness(self) -> float:
        """Factor that converts a stiffness to N/m, from the units of mass and time alone.

        The unit of force follows from both.
        """
        return self.mass / self.time**2

    @property
    def damping(self) -> float:
        """Factor that converts a damping to N s/m."""
        return self.mass / self.time


def units_of(words: str) -> Units:
    """Units of a consistent system: length, mass (or force) and time.

    Raises ValueError for words that name no units.

    >>> units_of("mm-t-s").stiffness, round(units_of("in-lbf-s").mass, 4)
    (1000.0, 175.1268)
    """
    parts = words.split("-")
    if len(parts) != 3 or parts[0] not in LENGTHS or parts[1] not in {*MASSES, *FORCES} or parts[2] not in TIMES:
        known = f"length ({', '.join(LENGTHS)}), mass ({', '.join([*MASSES, *FORCES])}), time ({', '.join(TIMES)})"
        raise ValueError(f"units: found {words!r}, expected {known}, as in mm-t-s")
    length, time = LENGTHS[parts[0]], TIMES[parts[2]]
    mass = MASSES[parts[1]] if parts[1] in MASSES else FORCES[parts[1]] * time**2 / length
    return Units(length, mass, time)
