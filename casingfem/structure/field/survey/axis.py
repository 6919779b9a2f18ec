"""The axis of a surveyed part: the line through the centres of its circles, and its points relative to it.

A part that is off the centre of the turntable, or inclined, shows one wave around, which is not part of its shape.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray
from casingfem.structure.field.survey.fit import SurveyFit
from casingfem.structure.field.survey.points import SurveyPoints

STEPS = 8  # the first leaves the square of the offset over the radius
SETTLED = 1e-10  # of the radius
FAR = 0.5  # of the radius: no part is so far beside the middle of its turntable
SMALL = 1e-5  # of the radius: an offset that changes nothing


@dataclass(frozen=True, slots=True)
class Axis:
    """The line x + i y = offset + tilt (z - z_mid) [m, -] in the coordinates of the survey.

    Examples
    --------
    >>> print(Axis(offset=3e-4j, tilt=0.0, z_mid=0.1))
    0.3 mm off the axis towards 90 deg at z = 0.1 m
    """

    offset: complex
    tilt: complex
    z_mid: float

    def __add__(self, other: Axis) -> Axis:
        return Axis(self.offset + other.offset, self.tilt + other.tilt, self.z_mid)

    def __str__(self) -> str:
        towards = round(np.degrees(np.angle(self.offset))) % 360
        lean = f", leaning by {1e3 * abs(self.tilt):.3g} mm/m" if self.tilt else ""
        return f"{1e3 * abs(self.offset):.3g} mm off the axis towards {towards} deg at z = {self.z_mid:.3g} m{lean}"

    def seen_from(self, points: SurveyPoints) -> SurveyPoints:
        """The points (theta, z, radius) about this axis, whose inclination is assumed small."""
        place = points.value * np.exp(1j * points.theta) - self.offset - self.tilt * (points.z - self.z_mid)
        return replace(points, theta=np.angle(place) % (2.0 * np.pi), value=np.abs(place))


def axis_of(fit: SurveyFit, z: FloatArray) -> Axis:
    """The straight line nearest to a fit's first harmonic, cos theta towards x and sin theta towards y."""
    field = fit.field if fit.without is None else fit.without
    zeta, z_mid = (z - field.z_mid) / field.z_half, field.z_mid
    first = int(np.flatnonzero(field.p == 1)[0])
    wave = np.real(field.cos[first]) + 1j * np.real(field.sin[first])
    middle = (fit.mean[0] + fit.mean[1] * z) * np.polynomial.polynomial.polyval(zeta, wave)
    if fit.heights == 1:
        return Axis(complex(np.mean(middle)), 0.0, z_mid)
    tilt, offset = np.polyfit(z - z_mid, middle, 1)
    return Axis(complex(offset), complex(tilt), z_mid)


def rough_axis(points: SurveyPoints) -> Axis:
    """The axis of the circles nearest to the points, at any position, by linear least squares (Kasa).

    |p|^2 = 2 Re(conj(c + t (z - z_mid)) p) + k0 + k1 z + k2 z^2 with p = x + i y: accurate up to the waves of the shape
    and the square of the inclination.
    """
    place, high = points.value * np.exp(1j * points.theta), points.z - 0.5 * (points.z.min() + points.z.max())
    around = np.column_stack([place.real, place.imag])
    columns = [2.0 * around, np.ones((len(points), 1))]
    if points.rings().any():
        columns += [2.0 * around * high[:, None], high[:, None], high[:, None] ** 2]
    found = np.linalg.lstsq(np.hstack(columns), np.abs(place) ** 2, rcond=None)[0]
    tilt = complex(*found[3:5]) if len(found) > 3 else 0.0
    return Axis(complex(*found[:2]), tilt, float(points.z[0] - high[0]))


Fit = Callable[[SurveyPoints, bool], SurveyFit]  # arguments: points, whether to search for stray ones


def centred_points(points: SurveyPoints, fitted: Fit) -> tuple[SurveyPoints, Axis]:
    """The points about their own axis, and that axis: alternate fits and shifts until the first harmonic vanishes.

    The search for outliers, by far the longest part, is made once; the axis is then that of the other points.
    """
    if points.quantity != "radius":
        expected = "a survey of radii; leave centred out for a thickness, which has no axis"
        raise InputError(points.path, found="centred = true for a survey of thickness", expected=expected)
    axis = settled_axis(points, rough_axis(points), fitted, search=False)
    fit = fitted(axis.seen_from(points), True)
    if fit.stray is not None:
        axis = settled_axis(points.at(~fit.stray), axis, fitted, search=False)
    elif not settled(axis_of(fit, points.z), fit, points):  # weights, which take stray points out
        axis = settled_axis(points, axis, fitted, search=True)
    return axis.seen_from(points), axis


def settled_axis(points: SurveyPoints, axis: Axis, fitted: Fit, search: bool) -> Axis:
    """The axis that does not change when a fit is made about it, from a nearby start."""
    for _ in range(STEPS):
        fit = fitted(axis.seen_from(points), search)
        rest = axis_of(fit, points.z)
        axis = axis + rest
        if settled(rest, fit, points):
            break
    return axis


def settled(rest: Axis, fit: SurveyFit, points: SurveyPoints) -> bool:
    """Whether the remaining offset and inclination are within round-off."""
    return bool(abs(rest.offset) + abs(rest.tilt) * np.ptp(points.z) < SETTLED * fit.mean[0])


def refuse_outside(points: SurveyPoints) -> None:
    """Refuse radii about an axis that is far from the middle of the part."""
    axis = rough_axis(points)
    radius = float(np.median(axis.seen_from(points).value))
    if points.quantity == "radius" and abs(axis.offset) > FAR * radius:
        found = f"points with their centre {axis} and a median radius of {radius:.4g} m"
        raise InputError(points.path, found=found, expected="points about the axis of the part, or centred = true")


def eccentric(fit: SurveyFit, points: SurveyPoints) -> Axis | None:
    """The axis of radii whose first harmonic is larger than all others together; else None."""
    if points.quantity != "radius":
        return None
    axis, field, z = axis_of(fit, points.z), fit.field, points.z
    others = np.sqrt(sum(field.amplitude(p) ** 2 for p in field.harmonics if p > 1))
    reach = max(abs(axis.offset + axis.tilt * (end - axis.z_mid)) for end in (z.min(), z.max()))
    noise = 3.0 * float(np.sqrt(np.mean(fit.residual**2)))
    return axis if reach > max(others, noise, SMALL) * fit.mean[0] else None
