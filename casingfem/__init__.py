"""casingfem: shell modes with imperfections, model updating and modal reduction.

import casingfem as cf

casing = cf.Shell(chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25), thickness=3e-3,
material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
print(cf.modes(casing, count=40))
"""

from casingfem.experiment.circle.lines import ScanError
from casingfem.experiment.circle.record import ScanRecord
from casingfem.experiment.circle.scan import CircleScan, demodulate
from casingfem.experiment.correlation.correlate import Correlation, correlate
from casingfem.experiment.correlation.correlation import Pairing, mac, pair, subspace_mac
from casingfem.experiment.correlation.measured_shapes import MeasuredShapes, ShapeError
from casingfem.experiment.correlation.shape_files import identified_shapes, read_shapes
from casingfem.experiment.frf.frf_set import FrfError, FrfSet
from casingfem.experiment.identify.ema_poles import MissingExtraError
from casingfem.experiment.identify.identification import identify
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.measurement import FrequencyTable, TableError
from casingfem.experiment.rig.rig import Probe, Rig, RigError
from casingfem.experiment.rig.structure import Place, rig_of
from casingfem.experiment.uff.read import UniversalFile, read_uff
from casingfem.experiment.uff.split import UffError
from casingfem.modal.basis import BasisError, ModalBasis
from casingfem.modal.campbell import Campbell, campbell
from casingfem.modal.eigen import EigenError
from casingfem.modal.interaction import BladedDisk, Interactions, interactions
from casingfem.modal.interface import Rim, Tip, TipNodes
from casingfem.modal.mistuning import Mistuning, mistune
from casingfem.modal.modes import MeshModes, Modes, modes
from casingfem.modal.output import Displacement, Strain
from casingfem.modal.reduction import reduce
from casingfem.modal.whirl import WhirlModes, whirl_modes
from casingfem.structure.assembly import System, assemble
from casingfem.structure.blade import Blade
from casingfem.structure.bolts import Bolts
from casingfem.structure.chart import Chart, Cylinder, Frustum, Panel, Plate
from casingfem.structure.field import Field, FourierField, SumField
from casingfem.structure.load import EdgeLoad, Gravity, PointLoad, Pressure, SurfaceLoad
from casingfem.structure.material import Material
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.mesh_data import MeshData
from casingfem.structure.mesh_in import read_mesh
from casingfem.structure.mesh_shell import MeshShell
from casingfem.structure.mesh_support import Fixed
from casingfem.structure.point_mass import PointMass
from casingfem.structure.random_field import RandomField, Spectrum
from casingfem.structure.revolved import Arc, Profile, Revolved, RevolvedPanel
from casingfem.structure.ring import Ring
from casingfem.structure.rotation import Rotation
from casingfem.structure.section import Section
from casingfem.structure.shell import Shell
from casingfem.structure.solid import Solid
from casingfem.structure.spline import Spline
from casingfem.structure.static import Deflection, solve_static
from casingfem.structure.strip import Strip
from casingfem.structure.support import Clamped, ElasticEdge, ShearDiaphragm, Symmetry
from casingfem.structure.survey import SampledField, SurveyError
from casingfem.structure.taper import Taper
from casingfem.structure.twisted import TwistedPlate
from casingfem.updating.localisation import locate
from casingfem.updating.located import Localisation
from casingfem.updating.parameters import Parameter, ParameterError
from casingfem.updating.posterior import Laplace, laplace
from casingfem.updating.prediction import LeftOut, leave_one_out
from casingfem.updating.problem import UpdateError
from casingfem.updating.regularisation import Regularisation
from casingfem.updating.result import UpdateResult
from casingfem.updating.sampling import Sampled, sampled
from casingfem.updating.shapes import SensorShapes
from casingfem.updating.updating import update

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
