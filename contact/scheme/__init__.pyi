from .linear.alpha import HHT, Newmark, StabilisedNewmark
from .linear.leapfrog import CDLagrange, CentralDifference, MasslessBoundary, PaoliSchatzman, PenaltyDifference
from .linear.nonsmooth_alpha import MoreauJean, NonsmoothAlpha, ProjectedAlpha
from .modal.exact_modal import ExactModal

__all__ = [
    "HHT",
    "CDLagrange",
    "CentralDifference",
    "ExactModal",
    "MasslessBoundary",
    "MoreauJean",
    "Newmark",
    "NonsmoothAlpha",
    "PaoliSchatzman",
    "PenaltyDifference",
    "ProjectedAlpha",
    "StabilisedNewmark",
]
