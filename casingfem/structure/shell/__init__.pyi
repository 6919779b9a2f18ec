from . import loads
from .assembly import assemble
from .shell import Shell
from .static import Deflection, solve_static
from .system import System

__all__ = [
    "Deflection",
    "Shell",
    "System",
    "assemble",
    "loads",
    "solve_static",
]
