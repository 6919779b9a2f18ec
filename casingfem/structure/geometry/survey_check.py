"""Whether a survey belongs to this shell, and the positions of its points on a curved meridian."""

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
WHOLE = 0.9  # of the shell's height: least part that a survey must cover if the rule is to refuse gaps
Outside = Literal["fit", "nearest", "zero", "refuse"]


ASIDE = 1e-3  # what a distance along the radius counts beside one in height
FLAT = 0.1  # sine of a meridian's slope: below, a radius gives the place of a point, not the shape
STATIONS = 4001  # along a meridian: between two of them it is as good as straight


def mean_radius(chart: Chart, at: float | None = None) -> float:
    """The radius [m] at a value of a chart's first parameter, by default at its middle."""
    middle = np.array([np.mean(chart.bounds[0]) if at is None else at]), np.zeros(1)
    return float(np.real(np.linalg.norm(chart.surface(*middle, None).x[:2])))


def on_meridian(points: SurveyPoints, chart: Chart | None) -> SurveyPoints:
    """The points with arc lengths instead of heights if that is the chart's first parameter; else unchanged.

    Each point keeps its height, since a radius defect moves points along the radius. If the meridian has a height more
    than once, the nearest radius decides. Radii are scaled to a cylinder with the meridian's middle radius, since the
    mean of a fit is straight and its defect relative to the meridian.
    """
    from scipy.spatial import cKDTree

    if not isinstance(chart, Revolved | RevolvedPanel):
        return points
    s = np.linspace(0.0, float(np.real(chart.profile.length)), STATIONS)
    at, radial = chart.profile.at(s), points.quantity == "radius"
    if not (radial or np.all(np.real(at.z1) > 0.0) or np.all(np.real(at.z1) < 0.0)):
        found = (
            f"{Path(points.path).name}: found thicknesses at heights z, and a meridian that has a height more than once"
        )
        raise ModelError("survey-other", f"{found}; expected a meridian that rises everywhere, so that z names a point")
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
        found = (
            f"{Path(points.path).name}: found {len(first)} points on a radial part of the meridian, first at {where}"
        )
        raise ModelError("survey-other", f"{found}; expected points only where the height changes along the meridian")
    radii = np.real(chart.profile.at(np.clip(along, s[0], s[-1])).r)
    return replace(points, z=along, value=points.value * mean_radius(chart) / radii)


def surveys(field: Field) -> list[SurveyField]:
    """The surveys in a field: the field itself, or the terms of a sum; empty if there are none."""
    terms = field.fields if isinstance(field, SumField) else (field,)
    return [term for term in terms if isinstance(term, SurveyField)]


def check_survey(survey: SurveyField, quantity: str, chart: Chart | None, thickness: float | None) -> None:
    """Refuse a survey of another quantity or of another casing; None is accepted."""
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
        expected = "expected at least half of the height, or a rule for the rest (outside)"
        raise ModelError("survey-part", f"{name}: found {over(survey, chart)}, {expected}")


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
    """Part of the shell's height z that a survey covers; negative if it is outside the shell."""
    if chart is None:
        return 1.0
    low, high, start, end = ends_of(survey, chart)
    return (min(high, end) - max(low, start)) / (end - start)


def over(survey: SurveyField, chart: Chart) -> str:
    """Heights that a survey covers, and those of the shell."""
    low, high, start, end = ends_of(survey, chart)
    where = (
        f"z from {low:g} to {high:g} m, {max(covered(survey, chart), 0.0):.0%} of the shell's {start:g} to {end:g} m"
    )
    return f"points at {where}"


def with_rule(survey: SurveyField, outside: Outside | None, chart: Chart | None) -> SurveyField:
    """The survey with its rule for heights outside: as stated, else "fit", or "nearest" below half of the shell.

    Raises
    ------
    ModelError
        `survey-part`: with "refuse", if more than a tenth of the shell has no points.

    Warns
    -----
    ModelWarning
        `survey-part`: the rule used outside, if less than half of the shell is covered.
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
        warn("survey-part", f"{name}: found {over(survey, chart)}; beyond them, {WORDS[rule]}", stacklevel=4)
    return survey.bounded(rule)
