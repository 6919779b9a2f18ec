from .assembly import MeshStructure, MeshSystem
from .attachments.glue import Gluing, tied
from .cells.support import Fixed
from .cyclic.sector import CyclicSector
from .grid import grid_mesh, revolved
from .loads import FacetPressure, MeshDeflection, NodeLoad
from .matrix.matrix_set import MatrixSet
from .matrix.read import read_matrices
from .matrix.write import write_matrices
from .mesh.attachments import Attachments, Equation, Mean, PointMass, Rigid, Spring, Term, Tie
from .mesh.mesh_data import Group, MeshData, beside
from .read import read_mesh
from .sections import BladeSections
from .sector_mesh import DiskRing
from .shell import MeshShell
from .solid import Solid
from .turning_structure import TurningStructure

__all__ = [
    "Attachments",
    "BladeSections",
    "CyclicSector",
    "DiskRing",
    "Equation",
    "FacetPressure",
    "Fixed",
    "Gluing",
    "Group",
    "MatrixSet",
    "Mean",
    "MeshData",
    "MeshDeflection",
    "MeshShell",
    "MeshStructure",
    "MeshSystem",
    "NodeLoad",
    "PointMass",
    "Rigid",
    "Solid",
    "Spring",
    "Term",
    "Tie",
    "TurningStructure",
    "beside",
    "grid_mesh",
    "read_matrices",
    "read_mesh",
    "revolved",
    "tied",
    "write_matrices",
]
