from .linear.alpha import HHT, Newmark, StabilisedNewmark
from .linear.leapfrog import CDLagrange, CentralDifference, MasslessBoundary, PaoliSchatzman, PenaltyDifference
from .linear.nonsmooth_alpha import MoreauJean, NonsmoothAlpha, ProjectedAlpha
from .modal.exact_modal import ExactModal
from .protocol import Motion, PlainStepper, Scheme, Stepper
from .python_stepper import PythonStepper

__all__ = [
    "HHT",
    "CDLagrange",
    "CentralDifference",
    "ExactModal",
    "MasslessBoundary",
    "MoreauJean",
    "Motion",
    "Newmark",
    "NonsmoothAlpha",
    "PaoliSchatzman",
    "PenaltyDifference",
    "PlainStepper",
    "ProjectedAlpha",
    "PythonStepper",
    "Scheme",
    "StabilisedNewmark",
    "Stepper",
]
