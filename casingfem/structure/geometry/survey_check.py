"""Whether a survey is one of this shell, and where on a curved meridian its points lie."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.survey.points import SurveyPoints
from casingfem.structure.field.survey.survey import WORDS, SurveyField
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.geometry.revolved import Revolved, RevolvedPanel

ALIKE = 0.1  # a survey's mean and the nominal radius or thickness may differ by this part
MOST = 0.5  # of the shell's height: a survey over less needs a rule for the rest
WHOLE = 0.9  # of the shell's height: what a survey covers that must leave nothing out
Outside = Literal["fit", "nearest", "zero", "refuse"]


ASIDE = 1e-3  # what a distance along the radius counts beside one in height
FLAT = 0.1  # sine of a meridian's slope: below, a radius gives the place of a point, not the shape
STATIONS = 4001  # along a meridian: between two of them it is as good as straight


def mean_radius(chart: Chart, at: float | None = None) -> float:
    """The radius [m] at a value of a chart's first parameter; at its middle if left out."""
    middle = np.array([np.mean(chart.bounds[0]) if at is None else at]), np.zeros(1)
    return float(np.real(np.linalg.norm(chart.surface(*middle, None).x[:2])))


def on_meridian(points: SurveyPoints, chart: Chart | None) -> SurveyPoints:
    """The points with arc lengths instead of heights if the chart's first parameter is an arc length; else unchanged.

    Each lies at its height, as a radius defect moves points along the radius; where the meridian passes a height more
    than once the nearest radius determines. Radii become those of a cylinder with the radius of the meridian's middle:
    a fit's mean is straight, and its defect is relative to the meridian itself.
    """
    from scipy.spatial import cKDTree

    if not isinstance(chart, Revolved | RevolvedPanel):
        return points
    s = np.linspace(0.0, float(np.real(chart.profile.length)), STATIONS)
    at, radial = chart.profile.at(s), points.quantity == "radius"
    if not (radial or np.all(np.real(at.z1) > 0.0) or np.all(np.real(at.z1) < 0.0)):
        found = f"{Path(points.path).name}: found thicknesses by height on a meridian that is not steep everywhere"
        raise ModelError("survey-other", f"{found}, expected one whose heights show where they were measured")
    weight = np.array([ASIDE if radial else 0.0, 1.0])
    line, slope = weight * np.real([at.r, at.z]).T, weight * np.real([at.r1, at.z1]).T
    place = weight * np.column_stack([points.value, points.z])
    near = cKDTree(line).query(place)[1]
    along = s[near] + np.sum((place - line[near]) * slope[near], axis=1) / np.sum(slope[near] ** 2, axis=1)
    if not radial:
        return replace(points, z=along)
    if (flat := np.abs(np.real(at.z1[near])) < FLAT).any():
        first = points.at(flat)
        where = f"theta {np.degrees(first.theta[0]):.4g} deg, z {first.z[0]:.4g} m"
        found = f"{Path(points.path).name}: found {len(first)} points where the meridian is flat, the first at {where}"
        raise ModelError("survey-other", f"{found}, expected radii of its steep parts alone")
    radii = np.real(chart.profile.at(np.clip(along, s[0], s[-1])).r)
    return replace(points, z=along, value=points.value * mean_radius(chart) / radii)


def surveys(field: Field) -> list[SurveyField]:
    """The surveys in a field: the field itself, or the terms of a sum; empty if there are none."""
    terms = field.fields if isinstance(field, SumField) else (field,)
    return [term for term in terms if isinstance(term, SurveyField)]


def check_survey(survey: SurveyField, quantity: str, chart: Chart | None, thickness: float | None) -> None:
    """Refuse a survey of another quantity or of another casing; None is not examined."""
    name = Path(survey.path).name
    if survey.quantity != quantity:
        raise ModelError("survey-quantity", f"{name}: found a survey of {survey.quantity}, expected one of {quantity}")
    (low, high), (start, end) = survey.z_range, survey.z_range if chart is None else np.real(chart.bounds[0])
    nominal, mean = thickness, survey.mean[0]
    if quantity != "thickness" and chart is not None:
        at = float(np.clip(0.5 * (low + high), start, end))
        nominal, mean = mean_radius(chart, at), float(survey.mean_radius(at))
    elif quantity != "thickness":
        nominal = None
    if nominal is not None and abs(mean / nominal - 1.0) > ALIKE:
        found = f"found a mean {quantity} of {mean:.4g} m, expected about {nominal:.4g} m"
        raise ModelError("survey-other", f"{name}: {found}")
    if chart is None:
        return
    part = covered(survey, chart)
    if part <= (-ALIKE if survey.heights == 1 else 0.0):
        raise ModelError("survey-other", f"{name}: found {over(survey, chart)}, expected points on the shell")
    if survey.heights > 1 and part < MOST and survey.outside == "fit":
        raise ModelError("survey-part", f"{name}: found {over(survey, chart)}, expected at least half of it or a rule")


def axial(chart: Chart, s: float) -> float:
    """The height z [m] at a value of a chart's first parameter, an arc length along a meridian."""
    if isinstance(chart, Revolved | RevolvedPanel):
        return float(np.real(chart.profile.at(np.array([s])).z[0]))
    return s


def ends_of(survey: SurveyField, chart: Chart) -> tuple[float, float, float, float]:
    """Heights [m] of the lowest and highest point and of the shell's lower and upper end."""
    start, end = np.real(chart.bounds[0]).tolist()
    low, high = survey.z_range
    if isinstance(chart, Revolved | RevolvedPanel):  # whose points lie at arc lengths
        low, high = np.clip((low, high), start, end).tolist()
    lowest, highest = sorted((axial(chart, low), axial(chart, high)))
    bottom, top = sorted((axial(chart, start), axial(chart, end)))
    return lowest, highest, bottom, top


def covered(survey: SurveyField, chart: Chart | None) -> float:
    """Part of the shell's height z over which a survey has points; below 0 where it lies beside the shell."""
    if chart is None:
        return 1.0
    low, high, start, end = ends_of(survey, chart)
    return (min(high, end) - max(low, start)) / (end - start)


def over(survey: SurveyField, chart: Chart) -> str:
    """Over which heights a survey has points, and where the shell is."""
    low, high, start, end = ends_of(survey, chart)
    where = (
        f"z from {low:g} to {high:g} m, {max(covered(survey, chart), 0.0):.0%} of the shell's {start:g} to {end:g} m"
    )
    return f"points at {where}"


def with_rule(survey: SurveyField, outside: Outside | None, chart: Chart | None) -> SurveyField:
    """The survey with the rule for heights beyond its points: as stated, else "fit", below half of a shell "nearest".

    Raises
    ------
    ModelError
        `survey-part`: "refuse", and more than a tenth of the shell is without points.

    Warns
    -----
    ModelWarning
        `survey-part`: the rule outside, where it is less than half of the shell.
    """
    part = 1.0 if chart is None or survey.heights == 1 else covered(survey, chart)
    if part <= 0.0 or chart is None:
        return survey  # refused as one of another casing
    name = Path(survey.path).name
    if outside == "refuse":
        if part < WHOLE:
            raise ModelError("survey-part", f"{name}: found {over(survey, chart)}, expected at least {WHOLE:.0%}")
        outside = "fit"
    rule = outside or ("fit" if part >= MOST else "nearest")
    if part < MOST:
        warn("survey-part", f"{name}: found {over(survey, chart)}; outside, {WORDS[rule]}", stacklevel=4)
    return survey.bounded(rule)
