from . import bodies, gaps, laws, rotor

__all__ = [
    "bodies",
    "gaps",
    "laws",
    "rotor",
]
