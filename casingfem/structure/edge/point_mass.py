"""Masses at places of an edge."""

from dataclasses import dataclass

import numpy as np

from casingfem.errors import ModelError


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeMass:
    """A mass [kg] on an edge at an angle [rad]; on the section's centre line where the edge carries a ring.

    On a straight edge `angle` is its own parameter: the width of a plate [m], for example.

    It has no rotary inertia. Heavy ones sink into a shear-deformable edge as the mesh is refined, slowly (as the
    logarithm of the element's size); a mass small beside that of a wave of the wall does not feel it.

    Raises
    ------
    ModelError
        mass-value: a mass that is negative or not finite, an angle that is not finite.

    >>> EdgeMass(angle=0.0, mass=0.012).mass
    0.012
    """

    angle: float
    mass: float

    def __post_init__(self) -> None:
        mass = np.real(self.mass)
        if not (np.isfinite(mass) and mass >= 0.0 and np.isfinite(np.real(self.angle))):
            raise ModelError("mass-value", f"a mass of {self.mass!r} kg at {self.angle!r} rad")
