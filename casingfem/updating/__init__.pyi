from .addresses import get_value, with_value
from .parameters import Parameter, parameters
from .regularisation import Regularisation
from .result import UpdateResult
from .sensitivity import eigen_derivatives
from .shape_fit import shape_fit
from .shapes import SensorShapes
from .uncertainty.posterior import Laplace, laplace
from .uncertainty.prediction import LeftOut, leave_one_out
from .uncertainty.sampling import PosteriorSamples, sample_posterior
from .updating import update

__all__ = [
    "Laplace",
    "LeftOut",
    "Parameter",
    "PosteriorSamples",
    "Regularisation",
    "SensorShapes",
    "UpdateResult",
    "eigen_derivatives",
    "get_value",
    "laplace",
    "leave_one_out",
    "parameters",
    "sample_posterior",
    "shape_fit",
    "update",
    "with_value",
]
