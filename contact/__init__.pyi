from .base.errors import InputError, LimitError, NumericsError
from .growth.closed_contact import poles, rim_stability, stability
from .growth.growth_map import StabilityMap
from .model.bodies.beam import BeamInCircle, HingedBeam
from .model.bodies.body import PointMass, Rod, Wall
from .model.bodies.linear import Forcing, LinearBody, Part
from .model.bodies.modal_body import ModalBody
from .model.bodies.patch import Patch
from .model.bodies.ring_modes import ThinRing, ring_elements, ring_modes
from .model.gaps.bladed_disk import BladedDisk
from .model.gaps.body_force import BodyForce
from .model.gaps.cantilever import Cantilever
from .model.gaps.gap import PointGap, RotatingRim, Side
from .model.gaps.permanent import HandPair, ModalPair, rim_contact
from .model.gaps.rod_modes import rod_modes
from .model.gaps.rub import Rub, Start, Stiffening, Tip
from .model.gaps.rub_forces import settled
from .model.gaps.rub_laws import Closing, Profile, Speed, Whirl
from .model.law import Abradable, AugmentedLagrangian, Coulomb, Penalty, Unilateral
from .record.energy import EnergyBudget
from .record.record import Record
from .result import Result
from .run import Scene, run
from .run_many import run_many
from .scene.load import SceneError, load_scene, scene_schema
from .scene.stability import load_stability
from .scheme.linear.cd_lagrange import CDLagrange
from .scheme.linear.central_difference import CentralDifference
from .scheme.linear.hht import HHT
from .scheme.linear.massless_boundary import MasslessBoundary
from .scheme.linear.moreau_jean import MoreauJean
from .scheme.linear.newmark import Newmark
from .scheme.linear.nonsmooth_alpha import NonsmoothAlpha
from .scheme.linear.paoli_schatzman import PaoliSchatzman
from .scheme.linear.penalty import PenaltyDifference
from .scheme.linear.projected_alpha import ProjectedAlpha
from .scheme.linear.stabilised_newmark import StabilisedNewmark
from .scheme.modal.exact_modal import ExactModal
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
