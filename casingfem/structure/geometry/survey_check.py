"""Whether a survey is one of this shell, and where on a curved meridian its points lie."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.errors import ModelError
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.survey.points import SurveyPoints
from casingfem.structure.field.survey.survey import SurveyField
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.geometry.revolved import Revolved, RevolvedPanel

ALIKE = 0.1  # a survey's mean and the nominal radius or thickness may differ by this part


ASIDE = 1e-3  # what a distance along the radius counts beside one in height
FLAT = 0.1  # sine of a meridian's slope: below, a radius says where it was measured, not what shape it has
STATIONS = 4001  # along a meridian: between two of them it is as good as straight


def mean_radius(chart: Chart, at: float | None = None) -> float:
    """The radius [m] at a value of a chart's first parameter; at its middle if left out."""
    middle = np.array([np.mean(chart.bounds[0]) if at is None else at]), np.zeros(1)
    return float(np.real(np.linalg.norm(chart.surface(*middle, None).x[:2])))


def on_meridian(points: SurveyPoints, chart: Chart | None) -> SurveyPoints:
    """The points with arc lengths for heights, where the chart's first parameter is one; others as they are.

    Each lies at its height, as a radius defect moves points along the radius; where the meridian passes a height more
    than once the nearest radius tells. Radii become those of a cylinder with the radius of the meridian's middle: a
    fit's mean is straight, and its defect is relative to the meridian itself.
    """
    from scipy.spatial import cKDTree

    if not isinstance(chart, Revolved | RevolvedPanel):
        return points
    s = np.linspace(0.0, float(np.real(chart.profile.length)), STATIONS)
    at, radial = chart.profile.at(s), points.quantity == "radius"
    if not (radial or np.all(np.real(at.z1) > 0.0) or np.all(np.real(at.z1) < 0.0)):
        found = f"{Path(points.path).name}: found thicknesses by height on a meridian that is not steep everywhere"
        raise ModelError("survey-other", f"{found}, expected one whose heights tell where they were measured")
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
    """The surveys in a field, be it one or a sum, whose terms are none."""
    terms = field.fields if isinstance(field, SumField) else (field,)
    return [term for term in terms if isinstance(term, SurveyField)]


def check_survey(survey: SurveyField, quantity: str, chart: Chart | None, thickness: float | None) -> None:
    """Refuse a survey of another quantity or of another casing; what is None is not looked at."""
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
    shared, least = min(high, end) - max(low, start), 0.5 if survey.heights > 1 else -ALIKE
    if shared < least * (end - start):
        found = f"{name}: found z from {low:g} to {high:g} m"
        part = "at least half" if survey.heights > 1 else "one"
        raise ModelError("survey-other", f"{found}, expected {part} of the shell's {start:g} to {end:g} m")
