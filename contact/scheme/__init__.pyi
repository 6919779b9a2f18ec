from .linear.cd_lagrange import CDLagrange
from .linear.central_difference import CentralDifference
from .linear.hht import HHT
from .linear.massless_boundary import MasslessBoundary
from .linear.moreau_jean import MoreauJean
from .linear.newmark import Newmark
from .linear.nonsmooth_alpha import NonsmoothAlpha
from .linear.paoli_schatzman import PaoliSchatzman
from .linear.penalty import PenaltyDifference
from .linear.projected_alpha import ProjectedAlpha
from .linear.stabilised_newmark import StabilisedNewmark
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
