from . import chance, errors, modal, plot, study, updating
from .experiment import circle, correlation, frf, rig, uff
from .experiment.correlation.correlate import correlate
from .experiment.frequency_table import FrequencyTable
from .experiment.identify.identification import identify
from .experiment.identify.identified import Identified
from .locate.localisation import locate, search_model
from .locate.located import Localisation
from .modal.basis import ModalBasis
from .modal.campbell import campbell
from .modal.interaction import interactions
from .modal.interface.kinds import Rim, Tip, TipNodes
from .modal.modes import Modes, modes
from .modal.reduction import reduce
from .modal.whirl import whirl_modes
from .structure import edge, field, geometry, imported, shell
from .structure.edge.bolts import Bolts
from .structure.edge.ring import Ring
from .structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm
from .structure.field.fourier import FourierField
from .structure.field.survey.survey import SurveyField
from .structure.geometry.blade import Blade
from .structure.geometry.chart import Cylinder, Frustum, Panel, Plate
from .structure.geometry.revolved import Revolved
from .structure.geometry.rotation import Rotation
from .structure.geometry.stations import Taper
from .structure.geometry.strip import Strip
from .structure.imported.read import read_mesh
from .structure.imported.shell import MeshShell
from .structure.imported.solid import Solid
from .structure.material import Material
from .structure.mesh.shell_mesh import ShellMesh
from .structure.shell import loads
from .structure.shell.shell import Shell
from .structure.static import solve_static
from .study.load import load_study
from .updating.parameters import Parameter
from .updating.updating import update
from .version import __version__

__all__ = [
    "Blade",
    "Bolts",
    "Clamped",
    "Cylinder",
    "ElasticEdge",
    "FourierField",
    "FrequencyTable",
    "Frustum",
    "Identified",
    "Localisation",
    "Material",
    "MeshShell",
    "ModalBasis",
    "Modes",
    "Panel",
    "Parameter",
    "Plate",
    "Revolved",
    "Rim",
    "Ring",
    "Rotation",
    "ShearDiaphragm",
    "Shell",
    "ShellMesh",
    "Solid",
    "Strip",
    "SurveyField",
    "Taper",
    "Tip",
    "TipNodes",
    "__version__",
    "campbell",
    "chance",
    "circle",
    "correlate",
    "correlation",
    "edge",
    "errors",
    "field",
    "frf",
    "geometry",
    "identify",
    "imported",
    "interactions",
    "load_study",
    "loads",
    "locate",
    "modal",
    "modes",
    "plot",
    "read_mesh",
    "reduce",
    "rig",
    "search_model",
    "shell",
    "solve_static",
    "study",
    "uff",
    "update",
    "updating",
    "whirl_modes",
]
