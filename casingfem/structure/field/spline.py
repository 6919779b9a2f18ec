"""B-splines along the axis: a basis in z with exact derivatives, as an alternative to powers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


@dataclass(frozen=True, slots=True, kw_only=True)
class Spline:
    """Cubic (or other) B-splines on equal intervals from z_low to z_high, clamped: the end knots are repeated.

    The functions sum to one. A natural spline has no curvature at its ends and continues linearly beyond them (two
    functions less); otherwise the end polynomials continue.

    Parameters
    ----------
    z_low, z_high : m, the ends
    intervals : between knots, 1 or more
    degree : 2 or more, so that second derivatives exist; a natural spline is cubic
    natural : no curvature at the ends

    Raises
    ------
    ModelError
        `field-spline`: ends are out of order, there is no interval, or the degree is not allowed.

    Examples
    --------
    >>> basis = Spline(z_low=0.0, z_high=0.25, intervals=4)
    >>> basis.size, basis.evaluate(0.1)[0].sum().round(12).item()
    (7, 1.0)
    """

    z_low: float
    z_high: float
    intervals: int
    degree: int = 3
    natural: bool = False

    def __post_init__(self) -> None:
        ordered = np.isfinite(self.z_low) and np.isfinite(self.z_high) and self.z_low < self.z_high
        if not ordered or self.intervals < 1 or self.degree < 2 or (self.natural and self.degree != 3):
            found = f"z_low = {self.z_low!r}, z_high = {self.z_high!r}, intervals = {self.intervals}"
            natural = ", natural = True" if self.natural else ""
            raise ModelError("field-spline", f"Spline: found {found}, degree = {self.degree}{natural}")

    @property
    def size(self) -> int:
        """Number of functions."""
        return self.intervals + self.degree - 2 * self.natural

    @property
    def means(self) -> FloatArray:
        """Mean of each function from end to end, (size,); they sum to one."""
        curves, mixing = _curves(self)
        t, k = curves.t, self.degree
        return np.asarray((t[k + 1 :] - t[: -k - 1]) / (k + 1) / (self.z_high - self.z_low) @ mixing)

    def evaluate(self, z: ArrayLike) -> tuple[Array, Array, Array]:
        """The functions and their first and second derivatives at z [m], (z.shape, size) each.

        A complex z passes through to first order in its imaginary part, which is what a complex step needs.
        """
        curves, mixing = _curves(self)
        place = np.asarray(np.real(z), float)
        inside = np.clip(place, self.z_low, self.z_high) if self.natural else place
        value, first, second, third = (curves(inside, nu) @ mixing for nu in range(4))
        if self.natural:
            beyond = (place - inside)[..., None]
            value = value + beyond * first
            second, third = (np.where(beyond == 0.0, part, 0.0) for part in (second, third))
        if not np.iscomplexobj(z):
            return value, first, second
        step = 1j * np.imag(z)[..., None]
        return value + step * first, first + step * second, second + step * third


@cache
def _curves(basis: Spline) -> tuple[BSpline, FloatArray]:
    """All B-splines as one vector-valued curve, and the matrix (clamped, size) to natural splines."""
    from scipy.interpolate import BSpline  # loaded with the first spline, not by every study

    k = basis.degree
    inner = np.linspace(basis.z_low, basis.z_high, basis.intervals + 1)
    knots = np.concatenate([np.full(k, inner[0]), inner, np.full(k, inner[-1])])
    count = basis.intervals + k
    curves = BSpline(knots, np.eye(count), k, extrapolate=True)
    if not basis.natural:
        return curves, np.eye(count)
    mixing = np.eye(count)[:, 1:-1]
    for end, row, place in ((0, 0, inner[0]), (-1, count - 1, inner[-1])):
        bend = curves(place, 2)  # the curvature vanishes there, which determines the coefficient at the end
        mixing[row] = -bend[1:-1] / bend[end]
    return curves, mixing
