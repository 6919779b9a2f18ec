"""Whether a survey is one of this shell: the same quantity, about the same mean, along the same heights."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from casingfem.errors import ModelError
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.survey.survey import SurveyField
from casingfem.structure.geometry.chart import Chart

ALIKE = 0.1  # a survey's mean and the nominal radius or thickness may differ by this part


def mean_radius(chart: Chart) -> float:
    """The radius at the middle of a chart's first parameter [m]."""
    middle = np.array([np.mean(chart.bounds[0])]), np.zeros(1)
    return float(np.real(np.linalg.norm(chart.surface(*middle, None).x[:2])))


def surveys(field: Field) -> Iterator[SurveyField]:
    """The surveys in a field, be it one or a sum."""
    if isinstance(field, SumField):
        for term in field.fields:
            yield from surveys(term)
    elif isinstance(field, SurveyField):
        yield field


def check_survey(survey: SurveyField, quantity: str, chart: Chart | None, thickness: float | None) -> None:
    """Refuse a survey of another quantity or of another casing; what is None is not looked at."""
    name = Path(survey.path).name
    if survey.quantity != quantity:
        found = f"{name}: found a survey of {survey.quantity}, expected one of {quantity}"
        raise ModelError("survey-quantity", found)
    nominal, mean = thickness, float(survey.mean[0])
    if quantity != "thickness":
        nominal = None if chart is None else mean_radius(chart)
        mean = mean if chart is None else float(survey.mean_radius(np.real(np.mean(chart.bounds[0]))))
    if nominal is not None and abs(mean / nominal - 1.0) > ALIKE:
        raise ModelError(
            "survey-other", f"{name}: found a mean {quantity} of {mean:.4g} m, expected about {nominal:.4g} m"
        )
    if chart is not None and survey.heights > 1:
        (low, high), (z0, z1) = survey.z_range, np.real(chart.bounds[0])
        if min(high, z1) - max(low, z0) < 0.5 * (z1 - z0):
            raise ModelError(
                "survey-other",
                f"{name}: found z from {low:g} to {high:g} m, expected at least half of the shell's {z0:g} to {z1:g} m",
            )
