from .read import UniversalFile, read_uff

__all__ = [
    "UniversalFile",
    "read_uff",
]
