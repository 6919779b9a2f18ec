from .assembly import MeshStructure, MeshSystem
from .cyclic.sector import CyclicSector
from .loads import FacetPressure, NodeLoad
from .matrix.matrix_set import MatrixSet
from .matrix.read import read_matrices
from .mesh_data import Group, MeshData
from .read import read_mesh
from .shell import MeshShell
from .solid import Solid
from .static import MeshDeflection
from .support import Fixed

__all__ = [
    "CyclicSector",
    "FacetPressure",
    "Fixed",
    "Group",
    "MatrixSet",
    "MeshData",
    "MeshDeflection",
    "MeshShell",
    "MeshStructure",
    "MeshSystem",
    "NodeLoad",
    "Solid",
    "read_matrices",
    "read_mesh",
]
