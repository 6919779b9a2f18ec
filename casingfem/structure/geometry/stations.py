"""Laws from root to tip: a constant, or values at equally spaced stations with polynomial interpolation.

A taper is a designed variation of the thickness by such laws, along the first parameter and across the second.
"""

from dataclasses import dataclass
from typing import Annotated, TypeAlias, TypeVar

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.geometry.chart import Bounds
from casingfem.structure.geometry.jet import Jet
from contact.io.keys import Key

Law: TypeAlias = float | tuple[float, ...]
Number = TypeVar("Number", Array, Jet)
MOST = 8  # stations: a polynomial through more, equally spaced, swings between them


def stations(name: str, law: Law) -> Law:
    """A law in its stored form: a number, or stations as a tuple.

    Raises
    ------
    ModelError
        `law-stations`: there is no station or more than `MOST`, or a value is not finite.

    >>> stations("chart.chord", [0.3, 0.2])
    (0.3, 0.2)
    """
    values = np.atleast_1d(np.asarray(law))
    if values.ndim != 1 or not 1 <= values.size <= MOST or values.dtype.kind not in "fiuc":
        raise ModelError("law-stations", f"{name}: found {law!r}")
    if not np.all(np.isfinite(values)):
        raise ModelError("law-stations", f"{name}: found {law!r}, which is not finite")
    return law if np.ndim(law) == 0 else tuple(values.tolist())


def coefficients(law: Law) -> Array:
    """Coefficients of 1, xi, xi^2, ... of the polynomial through the stations at xi = 0 to 1.

    >>> coefficients((1.0, 0.75, 0.0)).round(12).tolist()
    [1.0, 0.0, -1.0]
    """
    values = np.atleast_1d(np.asarray(law))
    places = np.linspace(0.0, 1.0, values.size) if values.size > 1 else np.zeros(1)
    return np.asarray(np.linalg.solve(np.vander(places, increasing=True), values))


def along(law: Law, xi: Number) -> Number:
    """A law at positions xi, 0 at its first station and 1 at its last: an array, or a jet with derivatives.

    >>> along((2.0, 1.0), np.array([0.25])).tolist()
    [1.75]
    """
    total = xi * 0.0
    for c in coefficients(law)[::-1]:
        total = total * xi + c
    return total


def lowest(law: Law) -> float:
    """The smallest value, from samples.

    >>> lowest((1.0, 0.0, 1.0))
    0.0
    """
    return float(np.real(along(law, np.linspace(0.0, 1.0, 129))).min())


@dataclass(frozen=True, slots=True, kw_only=True)
class Taper:
    """Thickness law t(x, y) = thickness * along(x) * across(y), factors at equally spaced stations.

    `along` runs from root to tip (base to top), `across` from left to right; each is one number, or values at equally
    spaced stations with the polynomial through them. It is part of the design, not an imperfection, so it remains when
    fields are removed.

    Raises
    ------
    ModelError
        `law-stations`: invalid stations; `taper-thickness`: the thickness is not positive everywhere.

    Examples
    --------
    >>> wedge = Taper(along=(1.0, 0.5), across=(0.4, 1.0, 0.4))
    >>> wedge.factor(((0.0, 2.0), (-1.0, 1.0)), np.array([2.0]), np.array([0.0])).tolist()
    [0.5]
    """

    along: Annotated[
        Law, Key("factor on the thickness from root to tip, or base to top [-]", least=1e-3, most=1e3, stations=MOST)
    ] = 1.0
    across: Annotated[
        Law, Key("factor on the thickness from left to right [-]", least=1e-3, most=1e3, stations=MOST)
    ] = 1.0

    def __post_init__(self) -> None:
        for name in ("along", "across"):
            law = stations(f"taper.{name}", getattr(self, name))
            object.__setattr__(self, name, law)
            if not lowest(law) > 1e-6:
                raise ModelError("taper-thickness", f"taper.{name} falls to {lowest(law):.3g}")

    @property
    def even(self) -> bool:
        """Whether the factors are constant across (around, for a casing)."""
        return np.size(self.across) == 1

    @property
    def lowest(self) -> float:
        """The least factor."""
        return lowest(self.along) * lowest(self.across)

    def factor(self, bounds: Bounds, a: Array, b: Array) -> Array:
        """The factor at parameters (a, b) of a chart with these bounds."""
        (a0, a1), (b0, b1) = bounds
        return along(self.along, (a - a0) / (a1 - a0)) * along(self.across, (b - b0) / (b1 - b0))
