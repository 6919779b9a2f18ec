from .mesh_data import MeshData
from .read import read_mesh
from .shell import MeshShell
from .solid import Solid
from .support import Fixed

__all__ = [
    "Fixed",
    "MeshData",
    "MeshShell",
    "Solid",
    "read_mesh",
]
