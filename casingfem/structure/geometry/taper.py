"""Taper: how a wall is meant to change its thickness, along the first parameter and across the second."""

from dataclasses import dataclass

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.geometry.chart import Bounds
from casingfem.structure.geometry.stations import Law, along, lowest, stations


@dataclass(frozen=True, slots=True, kw_only=True)
class Taper:
    """Thickness law t(x, y) = thickness * along(x) * across(y), factors at equally spaced stations.

    `along` runs from root to tip (base to top), `across` from left to right; each is one number, or values at equally
    spaced stations with the polynomial through them. A design, not an imperfection: it stays when fields are left out.

    Raises
    ------
    ModelError
        `law-stations`: no such law; `taper-thickness`: it leaves no wall somewhere.

    Examples
    --------
    >>> wedge = Taper(along=(1.0, 0.5), across=(0.4, 1.0, 0.4))
    >>> wedge.factor(((0.0, 2.0), (-1.0, 1.0)), np.array([2.0]), np.array([0.0])).tolist()
    [0.5]
    """

    along: Law = 1.0
    across: Law = 1.0

    def __post_init__(self) -> None:
        for name in ("along", "across"):
            law = stations(f"taper.{name}", getattr(self, name))
            object.__setattr__(self, name, law)
            if not lowest(law) > 0.0:
                raise ModelError("taper-thickness", f"taper.{name} falls to {lowest(law):.3g}")

    @property
    def even(self) -> bool:
        """Whether it is the same all across: around a casing, that is."""
        return np.size(self.across) == 1

    @property
    def lowest(self) -> float:
        """The least factor."""
        return lowest(self.along) * lowest(self.across)

    def factor(self, bounds: Bounds, a: Array, b: Array) -> Array:
        """The factor at parameters (a, b) of a chart with these bounds."""
        (a0, a1), (b0, b1) = bounds
        return along(self.along, (a - a0) / (a1 - a0)) * along(self.across, (b - b0) / (b1 - b0))
