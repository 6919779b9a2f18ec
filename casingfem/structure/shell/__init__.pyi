from . import loads
from .assembly import assemble
from .plies import Lamina, Ply
from .shell import Shell
from .static import Deflection, solve_static
from .system import System

__all__ = [
    "Deflection",
    "Lamina",
    "Ply",
    "Shell",
    "System",
    "assemble",
    "loads",
    "solve_static",
]
