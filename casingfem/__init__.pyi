from .errors import EigenError
from .experiment.circle.lines import ScanError
from .experiment.circle.record import ScanRecord
from .experiment.circle.scan import CircleScan, demodulate
from .experiment.correlation.correlate import Correlation, correlate
from .experiment.correlation.correlation import Pairing, mac, pair, subspace_mac
from .experiment.correlation.measured_shapes import MeasuredShapes, ShapeError
from .experiment.correlation.shape_files import identified_shapes, read_shapes
from .experiment.frf.frf_set import FrfError, FrfSet
from .experiment.identify.ema_poles import MissingExtraError
from .experiment.identify.identification import identify
from .experiment.identify.identified import Identified
from .experiment.measurement import FrequencyTable, TableError
from .experiment.rig.rig import Probe, Rig, RigError
from .experiment.rig.structure import Place, rig_of
from .experiment.uff.read import UniversalFile, read_uff
from .experiment.uff.split import UffError
from .locate.localisation import locate
from .locate.located import Localisation
from .modal.basis import BasisError, ModalBasis
from .modal.campbell import Campbell, campbell
from .modal.interaction import BladedDisk, Interactions, interactions
from .modal.interface import Rim, Tip, TipNodes
from .modal.mistuning import Mistuning, mistune
from .modal.modes import MeshModes, Modes, modes
from .modal.output import Displacement, Strain
from .modal.reduction import reduce
from .modal.whirl import WhirlModes, whirl_modes
from .structure.edge.bolts import Bolts
from .structure.edge.point_mass import PointMass
from .structure.edge.ring import Ring
from .structure.edge.section import Section
from .structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Symmetry
from .structure.field.fourier import Field, FourierField, SumField
from .structure.field.random import RandomField, Spectrum
from .structure.field.spline import Spline
from .structure.field.survey.survey import SampledField, SurveyError
from .structure.geometry.blade import Blade
from .structure.geometry.chart import Chart, Cylinder, Frustum, Panel, Plate
from .structure.geometry.revolved import Arc, Profile, Revolved, RevolvedPanel
from .structure.geometry.rotation import Rotation
from .structure.geometry.strip import Strip
from .structure.geometry.taper import Taper
from .structure.geometry.twisted import TwistedPlate
from .structure.imported.mesh_data import MeshData
from .structure.imported.read import read_mesh
from .structure.imported.shell import MeshShell
from .structure.imported.solid import Solid
from .structure.imported.support import Fixed
from .structure.material import Material
from .structure.mesh.shell_mesh import ShellMesh
from .structure.shell.assembly import assemble
from .structure.shell.load import EdgeLoad, Gravity, PointLoad, Pressure, SurfaceLoad
from .structure.shell.shell import Shell
from .structure.shell.static import Deflection, solve_static
from .structure.shell.system import System
from .updating.parameters import Parameter, ParameterError
from .updating.posterior import Laplace, laplace
from .updating.prediction import LeftOut, leave_one_out
from .updating.problem import UpdateError
from .updating.regularisation import Regularisation
from .updating.result import UpdateResult
from .updating.sampling import Sampled, sampled
from .updating.shapes import SensorShapes
from .updating.updating import update
from .version import __version__

__all__ = [
    "Arc",
    "BasisError",
    "Blade",
    "BladedDisk",
    "Bolts",
    "Campbell",
    "Chart",
    "CircleScan",
    "Clamped",
    "Correlation",
    "Cylinder",
    "Deflection",
    "Displacement",
    "EdgeLoad",
    "EigenError",
    "ElasticEdge",
    "Field",
    "Fixed",
    "FourierField",
    "FrequencyTable",
    "FrfError",
    "FrfSet",
    "Frustum",
    "Gravity",
    "Identified",
    "Interactions",
    "Laplace",
    "LeftOut",
    "Localisation",
    "Material",
    "MeasuredShapes",
    "MeshData",
    "MeshModes",
    "MeshShell",
    "MissingExtraError",
    "Mistuning",
    "ModalBasis",
    "Modes",
    "Pairing",
    "Panel",
    "Parameter",
    "ParameterError",
    "Place",
    "Plate",
    "PointLoad",
    "PointMass",
    "Pressure",
    "Probe",
    "Profile",
    "RandomField",
    "Regularisation",
    "Revolved",
    "RevolvedPanel",
    "Rig",
    "RigError",
    "Rim",
    "Ring",
    "Rotation",
    "Sampled",
    "SampledField",
    "ScanError",
    "ScanRecord",
    "Section",
    "SensorShapes",
    "ShapeError",
    "ShearDiaphragm",
    "Shell",
    "ShellMesh",
    "Solid",
    "Spectrum",
    "Spline",
    "Strain",
    "Strip",
    "SumField",
    "SurfaceLoad",
    "SurveyError",
    "Symmetry",
    "System",
    "TableError",
    "Taper",
    "Tip",
    "TipNodes",
    "TwistedPlate",
    "UffError",
    "UniversalFile",
    "UpdateError",
    "UpdateResult",
    "WhirlModes",
    "__version__",
    "assemble",
    "campbell",
    "correlate",
    "demodulate",
    "identified_shapes",
    "identify",
    "interactions",
    "laplace",
    "leave_one_out",
    "locate",
    "mac",
    "mistune",
    "modes",
    "pair",
    "read_mesh",
    "read_shapes",
    "read_uff",
    "reduce",
    "rig_of",
    "sampled",
    "solve_static",
    "subspace_mac",
    "update",
    "whirl_modes",
]
