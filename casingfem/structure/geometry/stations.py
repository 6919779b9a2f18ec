"""Laws from root to tip: one number, or values at equally spaced stations with the polynomial through them."""

from typing import TypeAlias, TypeVar

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.geometry.jet import Jet

Law: TypeAlias = float | tuple[float, ...]
Number = TypeVar("Number", Array, Jet)
MOST = 8  # stations: a polynomial through more, equally spaced, swings between them


def stations(name: str, law: Law) -> Law:
    """A law as it is kept: a number as it stands, stations as a tuple.

    Raises
    ------
    ModelError
        `law-stations`: no station or more than `MOST`, or a value that is not finite.

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
    """Coefficients of 1, xi, xi^2, ... of the polynomial through the stations of xi = 0 to 1.

    >>> coefficients((1.0, 0.75, 0.0)).round(12).tolist()
    [1.0, 0.0, -1.0]
    """
    values = np.atleast_1d(np.asarray(law))
    places = np.linspace(0.0, 1.0, values.size) if values.size > 1 else np.zeros(1)
    return np.asarray(np.linalg.solve(np.vander(places, increasing=True), values))


def along(law: Law, xi: Number) -> Number:
    """A law at places xi, 0 at its first station and 1 at its last: an array, or a jet that keeps its derivatives.

    >>> along((2.0, 1.0), np.array([0.25])).tolist()
    [1.75]
    """
    total = xi * 0.0
    for c in coefficients(law)[::-1]:
        total = total * xi + c
    return total


def lowest(law: Law) -> float:
    """The least value, by sampling.

    >>> lowest((1.0, 0.0, 1.0))
    0.0
    """
    return float(np.real(along(law, np.linspace(0.0, 1.0, 129))).min())
