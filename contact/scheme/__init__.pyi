from .events.event_driven import EventDriven
from .linear.alpha import HHT, Newmark, StabilisedNewmark
from .linear.cd_lagrange import CDLagrange
from .linear.central_difference import CentralDifference
from .linear.massless_boundary import MasslessBoundary
from .linear.nonsmooth_alpha import MoreauJean, NonsmoothAlpha, ProjectedAlpha
from .linear.paoli_schatzman import PaoliSchatzman
from .linear.penalty_difference import PenaltyDifference
from .modal.exact_modal import ExactModal
from .protocol import Motion, PlainStepper, Scheme, Stepper
from .python_stepper import PythonStepper

__all__ = [
    "HHT",
    "CDLagrange",
    "CentralDifference",
    "EventDriven",
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
