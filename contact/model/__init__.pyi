from . import bodies, gaps

__all__ = [
    "bodies",
    "gaps",
]
