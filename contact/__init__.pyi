from . import cycles, io, record, recovery, reference, scene, scheme, stability
from .base.errors import InputError, LimitError, NumericsError
from .interacting import interactions
from .model import bodies, gaps, laws, rotor
from .model.bodies.body import PointMass, Rod, Wall
from .model.bodies.linear import LinearBody
from .model.bodies.modal_body import ModalBody
from .model.bodies.patch import Patch
from .model.gaps.gap import PointGap, RotatingRim
from .model.gaps.rub import ContactPoint, Rub
from .model.law import Abradable, Coulomb, Penalty, Unilateral
from .model.speed import Speed
from .prepared import Scene
from .record.record import Record
from .result import Result
from .run import run
from .run_many import run_many
from .scene.load import load_scene
from .scheme.linear.central_difference import CentralDifference
from .scheme.linear.nonsmooth_alpha import MoreauJean
from .scheme.modal.exact_modal import ExactModal

__version__: str

__all__ = [
    "Abradable",
    "CentralDifference",
    "ContactPoint",
    "Coulomb",
    "ExactModal",
    "InputError",
    "LimitError",
    "LinearBody",
    "ModalBody",
    "MoreauJean",
    "NumericsError",
    "Patch",
    "Penalty",
    "PointGap",
    "PointMass",
    "Record",
    "Result",
    "Rod",
    "RotatingRim",
    "Rub",
    "Scene",
    "Speed",
    "Unilateral",
    "Wall",
    "bodies",
    "cycles",
    "gaps",
    "interactions",
    "io",
    "laws",
    "load_scene",
    "record",
    "recovery",
    "reference",
    "rotor",
    "run",
    "run_many",
    "scene",
    "scheme",
    "stability",
]
