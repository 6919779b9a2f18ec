from . import bodies, gaps, laws

__all__ = [
    "bodies",
    "gaps",
    "laws",
]
