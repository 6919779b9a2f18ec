from .field import Field, FieldValues, SumField
from .fourier import FourierField
from .random import RandomField, Spectrum
from .spline import Spline
from .survey.survey import SurveyField

__all__ = [
    "Field",
    "FieldValues",
    "FourierField",
    "RandomField",
    "Spectrum",
    "Spline",
    "SumField",
    "SurveyField",
]
