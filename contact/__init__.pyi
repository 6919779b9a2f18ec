from .energy import EnergyBudget
from .errors import InputError, LimitError, NumericsError
from .growth_map import StabilityMap
from .model.beam import BeamInCircle, HingedBeam
from .model.bladed_disk import BladedDisk
from .model.body import PointMass, Rod, Wall
from .model.body_force import BodyForce
from .model.cantilever import Cantilever
from .model.gap import PointGap, RotatingRim, Side
from .model.law import Abradable, AugmentedLagrangian, Coulomb, Penalty, Unilateral
from .model.linear import Forcing, LinearBody, Part
from .model.modal_body import ModalBody
from .model.patch import Patch
from .model.permanent import HandPair, ModalPair, rim_contact
from .model.ring_modes import ThinRing, ring_elements, ring_modes
from .model.rod_modes import rod_modes
from .model.rub import Rub, Start, Stiffening, Tip
from .model.rub_forces import settled
from .model.rub_laws import Closing, Profile, Speed, Whirl
from .record import Record
from .result import Result
from .run import Scene, run
from .run_many import run_many
from .scene.load import SceneError, load_scene, scene_schema
from .scene.stability import load_stability
from .scheme.cd_lagrange import CDLagrange
from .scheme.central_difference import CentralDifference
from .scheme.exact_modal import ExactModal
from .scheme.hht import HHT
from .scheme.massless_boundary import MasslessBoundary
from .scheme.moreau_jean import MoreauJean
from .scheme.newmark import Newmark
from .scheme.nonsmooth_alpha import NonsmoothAlpha
from .scheme.paoli_schatzman import PaoliSchatzman
from .scheme.penalty import PenaltyDifference
from .scheme.projected_alpha import ProjectedAlpha
from .scheme.stabilised_newmark import StabilisedNewmark
from .stability import poles, rim_stability, stability
from .version import __version__

__all__ = [
    "HHT", "Abradable", "AugmentedLagrangian", "BeamInCircle", "BladedDisk", "BodyForce", "CDLagrange",
    "Cantilever", "CentralDifference", "Closing", "Coulomb", "EnergyBudget", "ExactModal", "Forcing", "HandPair",
    "HingedBeam", "InputError", "LimitError", "LinearBody", "MasslessBoundary", "ModalBody", "ModalPair",
    "MoreauJean", "Newmark", "NonsmoothAlpha", "NumericsError", "PaoliSchatzman", "Part", "Patch", "Penalty",
    "PenaltyDifference", "PointGap", "PointMass", "Profile", "ProjectedAlpha", "Record", "Result", "Rod",
    "RotatingRim", "Rub", "Scene", "SceneError", "Side", "Speed", "StabilisedNewmark", "StabilityMap", "Start",
    "Stiffening", "ThinRing", "Tip", "Unilateral", "Wall", "Whirl", "__version__", "load_scene", "load_stability",
    "poles", "rim_contact", "rim_stability", "ring_elements", "ring_modes", "rod_modes", "run", "run_many",
    "scene_schema", "settled", "stability",
]  # fmt: skip
