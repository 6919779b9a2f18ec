from . import circle, correlation, frf, rig, uff

__all__ = [
    "circle",
    "correlation",
    "frf",
    "rig",
    "uff",
]
