"""Names that stood at the top of the package once, and where they stand now."""

from collections.abc import Mapping
from types import MappingProxyType

ROOMS = {
    "circle": "CircleScan ScanRecord demodulate",
    "correlation": "Correlation MeasuredShapes Pairing identified_shapes mac pair read_shapes subspace_mac",
    "edge": "Section Symmetry",
    "errors": "MissingExtraError",
    "field": "Field RandomField Spectrum Spline SumField",
    "frf": "FrfSet",
    "geometry": "Arc Chart RevolvedPanel",
    "imported": "Fixed MeshData",
    "loads": "EdgeLoad Gravity PointLoad Pressure SurfaceLoad",
    "modal": "Campbell Displacement Interactions MeshModes Mistuning Strain WhirlModes",
    "rig": "Place Probe Rig rig_of",
    "shell": "Deflection System assemble",
    "uff": "UniversalFile read_uff",
    "updating": "Laplace LeftOut Regularisation SensorShapes UpdateResult laplace leave_one_out",
}
RENAMED = {
    "errors.InputError": (
        "BasisError FrfError ParameterError RigError ScanError ShapeError SurveyError TableError UffError UpdateError"
    ),
    "errors.NumericsError": "EigenError",
    "SurveyField": "SampledField",
    "edge.EdgeMass": "PointMass",
    "geometry.Meridian": "Profile",
    "modal.DiskFrequencies": "BladedDisk",
    "updating.PosteriorSamples": "Sampled",
    "updating.sample_posterior": "sampled",
}
FORMER: Mapping[str, str] = MappingProxyType(
    {name: f"{room}.{name}" for room, names in ROOMS.items() for name in names.split()}
    | {name: now for now, names in RENAMED.items() for name in names.split()}
)
