from .assembly import MeshStructure, MeshSystem
from .loads import FacetPressure, NodeLoad
from .mesh_data import Group, MeshData
from .read import read_mesh
from .shell import MeshShell
from .solid import Solid
from .static import MeshDeflection
from .support import Fixed

__all__ = [
    "FacetPressure",
    "Fixed",
    "Group",
    "MeshData",
    "MeshDeflection",
    "MeshShell",
    "MeshStructure",
    "MeshSystem",
    "NodeLoad",
    "Solid",
    "read_mesh",
]
