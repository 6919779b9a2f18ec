"""The catalogue of faults, by code: every refusal and warning about a model, its cause and its remedy."""

from collections.abc import Mapping
from types import MappingProxyType

from casingfem.faults.edges import EDGES
from casingfem.faults.fault import Fault
from casingfem.faults.meshes import MESHES
from casingfem.faults.results import RESULTS
from casingfem.faults.surfaces import SURFACES

PARTS = (SURFACES, EDGES, MESHES, RESULTS)
CATALOGUE: Mapping[str, Fault] = MappingProxyType(dict(sorted((code, part[code]) for part in PARTS for code in part)))
