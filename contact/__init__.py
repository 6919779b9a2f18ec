"""contact: dynamic unilateral contact on rods, linear structures, modal bodies and rotating rims.

Bodies (Rod, PointMass, Wall, LinearBody, ModalBody, HingedBeam), gaps (PointGap, RotatingRim, Rub, BeamInCircle,
Patch), laws (Unilateral, Penalty, AugmentedLagrangian, Coulomb) and schemes (one file each in `contact.scheme`) are
frozen values; `run` brings them together and returns a Result. Scene files: `load_scene`.

>>> import contact as ct
>>> left = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=-1.1, velocity=1.0)
>>> right = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20)
>>> result = ct.run([left, right], law=ct.Unilateral(), scheme=ct.CentralDifference(), t_end=4.0, courant=0.9)
>>> round(float(result.impulse[0]), 2)
0.98
"""

from contact.energy import EnergyBudget
from contact.errors import InputError, LimitError, NumericsError
from contact.growth_map import StabilityMap
from contact.model.beam import BeamInCircle, HingedBeam
from contact.model.bladed_disk import BladedDisk
from contact.model.body import PointMass, Rod, Wall
from contact.model.body_force import BodyForce
from contact.model.cantilever import Cantilever
from contact.model.gap import PointGap, RotatingRim, Side
from contact.model.law import Abradable, AugmentedLagrangian, Coulomb, Penalty, Unilateral
from contact.model.linear import Forcing, LinearBody, Part
from contact.model.modal_body import ModalBody
from contact.model.patch import Patch
from contact.model.permanent import HandPair, ModalPair, rim_contact
from contact.model.ring_modes import ThinRing, ring_elements, ring_modes
from contact.model.rod_modes import rod_modes
from contact.model.rub import Rub, Start, Stiffening, Tip
from contact.model.rub_forces import settled
from contact.model.rub_laws import Closing, Profile, Speed, Whirl
from contact.record import Record
from contact.result import Result
from contact.run import Scene, run
from contact.run_many import run_many
from contact.scene.load import SceneError, load_scene, scene_schema
from contact.scene.stability import load_stability
from contact.scheme.cd_lagrange import CDLagrange
from contact.scheme.central_difference import CentralDifference
from contact.scheme.exact_modal import ExactModal
from contact.scheme.hht import HHT
from contact.scheme.massless_boundary import MasslessBoundary
from contact.scheme.moreau_jean import MoreauJean
from contact.scheme.newmark import Newmark
from contact.scheme.nonsmooth_alpha import NonsmoothAlpha
from contact.scheme.paoli_schatzman import PaoliSchatzman
from contact.scheme.penalty import PenaltyDifference
from contact.scheme.projected_alpha import ProjectedAlpha
from contact.scheme.stabilised_newmark import StabilisedNewmark
from contact.stability import poles, rim_stability, stability

__all__ = [
    "HHT", "Abradable", "AugmentedLagrangian", "BeamInCircle", "BladedDisk", "BodyForce", "CDLagrange", "Cantilever",
    "CentralDifference", "Closing", "Coulomb", "EnergyBudget", "ExactModal", "Forcing", "HandPair", "HingedBeam",
    "InputError", "LimitError", "LinearBody", "MasslessBoundary", "ModalBody", "ModalPair", "MoreauJean", "Newmark",
    "NonsmoothAlpha", "NumericsError", "PaoliSchatzman", "Part", "Patch", "Penalty", "PenaltyDifference", "PointGap",
    "PointMass", "Profile", "ProjectedAlpha", "Record", "Result", "Rod", "RotatingRim", "Rub", "Scene", "SceneError",
    "Side", "Speed", "StabilisedNewmark", "StabilityMap", "Start", "Stiffening", "ThinRing", "Tip", "Unilateral",
    "Wall", "Whirl", "load_scene", "load_stability", "poles", "rim_contact", "rim_stability", "ring_elements",
    "ring_modes", "rod_modes", "run", "scene_schema", "settled", "stability",
]  # fmt: skip
