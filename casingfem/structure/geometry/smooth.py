"""A meridian through given points: a cubic spline in the plane of r and z."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.geometry.pieces import Point
from casingfem.structure.geometry.revolved import MeridianPoints

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

CORNER = np.radians(30.0)  # between neighbouring chords: a spline would swing on both sides of a sharper bend
SAMPLES = 20  # of each chord, where the spline is examined


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SmoothMeridian:
    """A meridian through points, the profile of a `Revolved` chart.

    r(s) and z(s) are cubic splines with continuous curvature (not-a-knot ends); s is the sum of chords from point to
    point, the arc length to second order in the angle of a chord.

    Parameters
    ----------
    points
        (r, z) [m] from the base to the top, two or more.

    Raises
    ------
    ModelError
        `meridian-points` for fewer than two points, a repeated point, or a corner of more than 30 degrees;
        `meridian-axis` if the meridian reaches the axis.

    Examples
    --------
    >>> bell = SmoothMeridian(points=((0.30, 0.0), (0.29, 0.1), (0.27, 0.2)))
    >>> round(bell.length, 4), float(bell.at(np.array(0.0)).r)
    (0.2025, 0.3)
    """

    points: tuple[Point, ...]
    chords: FloatArray = field(init=False, repr=False)
    spline: "CubicSpline" = field(init=False, repr=False)

    def __post_init__(self) -> None:
        places = np.array(self.points, dtype=float)
        if places.ndim != 2 or places.shape[1] != 2 or len(places) < 2 or not np.isfinite(places).all():
            found = f"{len(self.points)} points" if len(self.points) < 2 else f"an array {places.shape}"
            raise ModelError("meridian-points", f"chart.points: found {found}, expected two points [r, z] or more")
        steps = np.diff(places, axis=0)
        sizes = np.linalg.norm(steps, axis=1)
        if not np.all(sizes > 0.0):
            k = int(np.argmin(sizes)) + 1
            raise ModelError("meridian-points", f"chart.points: found points {k} and {k + 1} at one place")
        turns = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
        if turns.size and np.abs(turns).max() > CORNER:
            k = int(np.abs(turns).argmax()) + 2
            found = f"a corner of {np.degrees(np.abs(turns).max()):.3g} degrees at point {k}"
            raise ModelError("meridian-points", f"chart.points: found {found}, expected at most 30 degrees")
        object.__setattr__(self, "points", tuple((float(r), float(z)) for r, z in places))
        from scipy.interpolate import CubicSpline

        object.__setattr__(self, "chords", np.append(0.0, np.cumsum(sizes)))
        object.__setattr__(self, "spline", CubicSpline(self.chords, places))
        lowest = float(self.at(np.linspace(0.0, self.length, SAMPLES * len(places))).r.min())
        if lowest <= 1e-9 * self.length:
            raise ModelError("meridian-axis", f"chart.points: found a radius of {lowest:.3g} m on the meridian")

    @property
    def length(self) -> float:
        """End of s [m]."""
        return float(self.chords[-1])

    def at(self, s: Array) -> MeridianPoints:
        """Radius, height and their derivatives at s."""
        value, slope, bend = (self.spline(s, nu) for nu in range(3))
        return MeridianPoints(value[..., 0], slope[..., 0], bend[..., 0], value[..., 1], slope[..., 1], bend[..., 1])
