from . import edge, field, geometry, imported, shell

__all__ = [
    "edge",
    "field",
    "geometry",
    "imported",
    "shell",
]
