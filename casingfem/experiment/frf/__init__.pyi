from .frf_set import FrfSet

__all__ = [
    "FrfSet",
]
