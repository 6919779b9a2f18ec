from .basis import ModalBasis
from .campbell import Campbell
from .imported.output import NodeDisplacement, NodeStrain, NodeStress
from .interaction import DiskFrequencies, Interactions, interactions
from .interface import AtNodes, Rim, Tip, TipNodes
from .matrices import basis_matrices, structure_matrices
from .mistuning import Mistuning, mistune
from .modes import MeshModes, Modes
from .output import Displacement, Strain
from .reduction import reduce
from .whirl import WhirlModes, whirl_modes

__all__ = [
    "AtNodes",
    "Campbell",
    "DiskFrequencies",
    "Displacement",
    "Interactions",
    "MeshModes",
    "Mistuning",
    "ModalBasis",
    "Modes",
    "NodeDisplacement",
    "NodeStrain",
    "NodeStress",
    "Rim",
    "Strain",
    "Tip",
    "TipNodes",
    "WhirlModes",
    "basis_matrices",
    "interactions",
    "mistune",
    "reduce",
    "structure_matrices",
    "whirl_modes",
]
