"""A measured surface as a field: the survey of a casing's radius or thickness, fitted."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import warn
from casingfem.io.arrays import FloatArray
from casingfem.structure.field.field import Field
from casingfem.structure.field.fourier import FourierField, SeriesBehind
from casingfem.structure.field.reach import Outside, Reach
from casingfem.structure.field.survey.axis import Axis, centred_points, eccentric, refuse_outside
from casingfem.structure.field.survey.fit import SurveyFit, fit_points, resolved_harmonic
from casingfem.structure.field.survey.points import Quantity, SurveyPoints, read_points
from casingfem.structure.field.survey.stray import passes_words, pure_error, refuse_impossible

WORDS: dict[Outside, str] = {
    "fit": "the fitted polynomial continues",
    "nearest": "the shape of the nearest height continues",
    "zero": "the shape goes down to zero over a quarter of the measured heights",
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurveyField(SeriesBehind):
    """The relative defect of a measured surface, by least squares on scattered points.

    r(z, theta) = (a + b z) (1 + f),  f = sum_{p >= 1} (cos_pd cos p theta + sin_pd sin p theta) zeta^d

    A thickness is t = a (1 + f), where f may also contain p = 0, d >= 1 (a taper).

    It is a Field for ``radius_defect`` or ``thickness_defect`` of a Shell.

    Parameters
    ----------
    fit : the relative defect f, a FourierField
    mean : (a [m], b [-]) of the mean cone; b = 0 for a thickness
    quantity : "radius" or "thickness"
    residual_rms, residual_max : relative residuals of the measured points
    coverage_deg : largest gap in theta between measured points
    z_range : m, lowest and highest point
    set_aside : points that a robust fit excluded: (theta [deg], z [m], relative residual) of each
    pure_error : standard deviation [m] of points measured repeatedly at one place, None without repeats
    repeats : number of repeats
    doubted : points of a plain fit that contradict all others, in the form of `set_aside`
    without : the fit without them, None if there are none
    axis : the part's own axis, to which the points refer; None if they were used as given

    Examples
    --------
    >>> theta = np.radians(np.arange(0.0, 360.0, 5.0))
    >>> survey = SurveyField.from_points(theta, 0.0 * theta, 0.5 * (1 + 0.004 * np.cos(8 * theta)), n_max=12)
    >>> round(survey.fit.amplitude(8), 9), round(float(survey.mean_radius(0.0)), 9), survey.n_resolved
    (0.004, 0.5, 35)
    """

    fit: FourierField
    mean: tuple[float, float]
    quantity: Quantity
    points: int
    heights: int
    residual_rms: float
    residual_max: float
    coverage_deg: float
    z_range: tuple[float, float]
    path: str
    card: tuple[str, ...]
    set_aside: tuple[tuple[float, float, float], ...] = ()
    pure_error: float | None = None
    repeats: int = 0
    doubted: tuple[tuple[float, float, float], ...] = ()
    without: FourierField | None = None
    axis: Axis | None = None

    @classmethod
    def from_csv(
        cls,
        path: str | os.PathLike[str],
        n_max: int | None = None,
        degree: int | None = None,
        *,
        robust: bool = False,
        centred: bool = False,
        outside: Outside = "fit",
    ) -> SurveyField:
        """Read and fit a survey CSV: theta_deg|theta_rad, z_m|z_mm, radius_m|radius_mm (or thickness).

        Or x_m|x_mm, y_m|y_mm, z_m|z_mm, as measuring machines write them; other columns are ignored.

        Parameters
        ----------
        n_max
            Highest harmonic fitted; by default .8 of what the largest gap resolves, at most 40.
        degree
            Degree of the polynomial in z; by default 0 for one height, 1 below four, else 2. The default degree, then
            `n_max`, is lowered while the points cannot determine it.
        robust
            Reduce the weight of outliers (Huber, then bisquare weights, scale from the median deviation), and list
            those excluded.
        centred
            Use the part's own axis, with fitted offset and inclination, not that of the measurement.
        outside
            Beyond the lowest and highest point the polynomial continues ("fit"), the shape of the nearest height
            continues ("nearest"), or it decreases to zero over a quarter of the measured heights ("zero").

        Warns
        -----
        ModelWarning
            `survey-outliers`: a robust fit excluded points. `survey-stray`: a plain fit has points that contradict all
            others. `survey-passes`: repeated measurements differ significantly. `survey-eccentric`: the part was off
            the axis of the survey by more than its out-of-roundness.

        Raises
        ------
        InputError
            The table is malformed or implausible, the circle is not covered for the requested n_max, or there are too
            few points. Without `robust`: a point lies further from the surface through the others than an imperfection
            can, a tenth of the radius or the whole thickness.
        """
        survey = cls.fitted(read_points(path), n_max=n_max, degree=degree, robust=robust, centred=centred)
        return survey.bounded(outside)

    @classmethod
    def from_points(
        cls,
        theta: ArrayLike,
        z: ArrayLike,
        value: ArrayLike,
        *,
        quantity: Quantity = "radius",
        n_max: int | None = None,
        degree: int | None = None,
        robust: bool = False,
        centred: bool = False,
    ) -> SurveyField:
        """Fit points given as arrays (points,): theta [rad], z [m], radius or thickness [m]."""
        theta, z, value = (np.asarray(array, float) for array in (theta, z, value))
        points = SurveyPoints(theta=theta, z=z, value=value, quantity=quantity)
        return cls.fitted(points, n_max=n_max, degree=degree, robust=robust, centred=centred)

    @classmethod
    def fitted(
        cls,
        points: SurveyPoints,
        *,
        n_max: int | None = None,
        degree: int | None = None,
        robust: bool = False,
        centred: bool = False,
        placed: Callable[[SurveyPoints], SurveyPoints] | None = None,
    ) -> SurveyField:
        """Fit points that were read; options as in from_csv.

        If a shell's fields use another coordinate than the height z, `placed` has the points with it.
        """
        axis: Axis | None = None
        if centred:

            def fitted(moved: SurveyPoints, search: bool) -> SurveyFit:
                return fit_points(moved, n_max, degree, robust, search)

            points, axis = centred_points(points, fitted)
        else:
            refuse_outside(points)
        points = points if placed is None else placed(points)
        fit = fit_points(points, n_max, degree, robust)
        if fit.stray is not None and fit.apart is not None:
            refuse_impossible(points, fit.apart, fit.stray)
        none, name = np.zeros(len(points), bool), Path(points.path).name
        table = np.column_stack([np.degrees(points.theta), points.z, fit.residual])
        stray = (~fit.kept, none if fit.stray is None else fit.stray)
        set_aside, doubted = (tuple((theta, z, r) for theta, z, r in table[which].tolist()) for which in stray)
        if set_aside:
            warn("survey-outliers", f"{name}: {stray_words(set_aside, len(points))}", stacklevel=4)
        if fit.without is not None:
            effect = largest_change(fit.field, fit.without)
            outliers = stray_words(doubted, len(points), "are outliers")
            warn("survey-stray", f"{name}: {outliers}; {effect}", stacklevel=4)
        if words := passes_words(points.at(fit.kept)):
            warn("survey-passes", f"{name}: {words}", stacklevel=4)
        if axis is None and (beside := eccentric(fit, points)) is not None:
            warn("survey-eccentric", f"{name}: found a part {beside}", stacklevel=4)
        residual, (scatter, repeats) = fit.residual[fit.kept], pure_error(points.at(fit.kept))
        return cls(
            fit=fit.field,
            mean=fit.mean,
            quantity=points.quantity,
            points=len(points),
            heights=fit.heights,
            residual_rms=float(np.sqrt(np.mean(residual**2))),
            residual_max=float(np.max(np.abs(residual))),
            coverage_deg=fit.gap_deg,
            z_range=(float(points.z.min()), float(points.z.max())),
            path=points.path,
            card=points.card,
            set_aside=set_aside,
            doubted=doubted,
            without=fit.without,
            pure_error=scatter,
            repeats=repeats,
            axis=axis,
        )

    def bounded(self, outside: Outside) -> SurveyField:
        """The same survey with a rule for heights beyond its points; see `from_csv`."""
        reach = None if outside == "fit" else Reach(*self.z_range, outside)
        return replace(self, fit=replace(self.fit, reach=reach))

    @property
    def outside(self) -> Outside:
        """The rule for heights beyond the points."""
        return "fit" if self.fit.reach is None else self.fit.reach.rule

    def mean_radius(self, z: ArrayLike) -> FloatArray:
        """Return the mean cone's radius a + b z [m] at z [m]."""
        if self.quantity != "radius":
            raise ValueError("a thickness survey has no mean radius; see mean_thickness")
        return np.asarray(self.mean[0] + self.mean[1] * np.asarray(z, float))

    @property
    def mean_thickness(self) -> float:
        """Mean thickness [m] of a thickness survey."""
        if self.quantity != "thickness":
            raise ValueError("a radius survey has no mean thickness; see mean_radius")
        return self.mean[0]

    @property
    def n_resolved(self) -> int:
        """The highest harmonic that the largest gap in theta still resolves (Nyquist)."""
        return resolved_harmonic(self.coverage_deg)

    @property
    def residual_rms_m(self) -> float:
        """Root mean square of the residuals of the fit, in m at mid height."""
        return self.residual_rms * (self.mean[0] + self.mean[1] * sum(self.z_range) / 2)

    def __add__(self, other: Field) -> Field:
        return self.fit + other

    def __repr__(self) -> str:
        (a, b), (low, high) = self.mean, self.z_range
        mean = f"{a:.6g} m" + (f" {b:+.6g} z" if b else "")
        lines = [
            f"SurveyField({self.quantity}, {self.points} points, {self.heights} heights, {Path(self.path).name})",
            f"  mean      {mean} for z from {low:g} to {high:g} m",
            f"  fit       to harmonic {self.max_harmonic}, degree {self.fit.cos.shape[1] - 1} along z",
            f"  coverage  largest gap {self.coverage_deg:.3g} deg, resolves harmonic {self.n_resolved}",
            f"  residual  rms {self.residual_rms:.2e} ({self.residual_rms_m * 1e6:.3g} um),"
            f" max {self.residual_max:.2e}",
        ]
        if self.fit.reach is not None:
            lines.append(f"  outside   {WORDS[self.outside]}")
        if self.axis is not None:
            lines.append(f"  centred   the part was {self.axis}")
        if self.pure_error is not None:
            lines.append(f"  repeats   {self.repeats}, pure error {self.pure_error * 1e6:.3g} um")
        if self.set_aside:
            lines.append(f"  outliers  {stray_words(self.set_aside, self.points)}")
        if self.without is not None:
            lines.append(f"  outliers  {stray_words(self.doubted, self.points, 'included in the fit')}")
            lines.append(f"            {largest_change(self.fit, self.without)}; robust = true leaves them out")
        return "\n".join([*lines, repr(self.fit)])


def largest_change(plain: FourierField, without: FourierField) -> str:
    """The harmonic that the outliers change most."""
    p = max(plain.harmonics, key=lambda p: abs(plain.amplitude(p) - without.amplitude(p)))
    return f"harmonic {p} is {plain.amplitude(p):.3g} with them, {without.amplitude(p):.3g} without"


def stray_words(stray: Sequence[tuple[float, float, float]], points: int, what: str = "left out") -> str:
    """Number of outliers that were excluded, and the places of the worst."""
    worst = sorted(stray, key=lambda point: -abs(point[2]))[:5]
    places = "; ".join(f"theta {theta:.4g} deg, z {z:.4g} m: {100.0 * r:+.3g} %" for theta, z, r in worst)
    more = f"; and {len(stray) - len(worst)} more" if len(stray) > len(worst) else ""
    return f"{len(stray)} of {points} points {what} ({places}{more})"
