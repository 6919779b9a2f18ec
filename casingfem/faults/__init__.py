"""The catalogue of faults, by code: every refusal and warning about a model or a run, its cause and its remedy."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from casingfem.faults.edges import EDGES
from casingfem.faults.meshes import MESHES
from casingfem.faults.results import RESULTS
from casingfem.faults.runs import RUNS
from casingfem.faults.surfaces import SURFACES

PARTS = (SURFACES, EDGES, MESHES, RESULTS, RUNS)


class Fault(NamedTuple):
    """Cause of an error or a warning about a model, and the remedy."""

    cause: str
    remedy: str


CATALOGUE: Mapping[str, Fault] = MappingProxyType(
    dict(sorted((code, Fault(*part[code])) for part in PARTS for code in part))
)
