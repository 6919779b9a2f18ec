from .basis import ModalBasis
from .campbell import Campbell
from .cyclic.bladed import BladedWheel, Influence
from .cyclic.engine_orders import Amplification, EngineOrderResponse, amplification, engine_order_response
from .cyclic.mistuned import MistunedModes, mistuned_modes
from .cyclic.modes import CyclicModes, cyclic_modes, wheel_modes
from .cyclic.reduction import cyclic_reduce
from .cyclic.whirl import CyclicWhirl, cyclic_whirl
from .family.splits import SplitMap
from .interaction import DiskFrequencies, Interactions, interactions
from .interface.chart_rows import out_of_roundness
from .interface.kinds import AtNodes, Rim, Tip, TipNodes
from .interface.output import Displacement, NodeDisplacement, NodeStrain, NodeStress, Strain
from .matrices import basis_matrices, structure_matrices
from .mesh_modes import mesh_modes
from .mistuning import Mistuning, mistune
from .modes import MeshModes, Modes
from .reduction import reduce
from .whirl import WhirlModes, whirl_modes

__all__ = [
    "Amplification",
    "AtNodes",
    "BladedWheel",
    "Campbell",
    "CyclicModes",
    "CyclicWhirl",
    "DiskFrequencies",
    "Displacement",
    "EngineOrderResponse",
    "Influence",
    "Interactions",
    "MeshModes",
    "MistunedModes",
    "Mistuning",
    "ModalBasis",
    "Modes",
    "NodeDisplacement",
    "NodeStrain",
    "NodeStress",
    "Rim",
    "SplitMap",
    "Strain",
    "Tip",
    "TipNodes",
    "WhirlModes",
    "amplification",
    "basis_matrices",
    "cyclic_modes",
    "cyclic_reduce",
    "cyclic_whirl",
    "engine_order_response",
    "interactions",
    "mesh_modes",
    "mistune",
    "mistuned_modes",
    "out_of_roundness",
    "reduce",
    "structure_matrices",
    "wheel_modes",
    "whirl_modes",
]
