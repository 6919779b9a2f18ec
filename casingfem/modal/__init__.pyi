from .basis import ModalBasis
from .campbell import Campbell
from .interaction import DiskFrequencies, Interactions, interactions
from .interface import Rim, Tip, TipNodes
from .mistuning import Mistuning, mistune
from .modes import MeshModes, Modes
from .output import Displacement, Strain
from .reduction import reduce
from .whirl import WhirlModes, whirl_modes

__all__ = [
    "Campbell",
    "DiskFrequencies",
    "Displacement",
    "Interactions",
    "MeshModes",
    "Mistuning",
    "ModalBasis",
    "Modes",
    "Rim",
    "Strain",
    "Tip",
    "TipNodes",
    "WhirlModes",
    "interactions",
    "mistune",
    "reduce",
    "whirl_modes",
]
