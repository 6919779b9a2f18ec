from .parameters import Parameter, parameters
from .posterior import Laplace, laplace
from .prediction import LeftOut, leave_one_out
from .regularisation import Regularisation
from .result import UpdateResult
from .sampling import PosteriorSamples, sample_posterior
from .shapes import SensorShapes
from .updating import update

__all__ = [
    "Laplace",
    "LeftOut",
    "Parameter",
    "PosteriorSamples",
    "Regularisation",
    "SensorShapes",
    "UpdateResult",
    "laplace",
    "leave_one_out",
    "parameters",
    "sample_posterior",
    "update",
]
