from .friction.coulomb import Friction, coulomb
from .unilateral.active_set import Contacts, unilateral

__all__ = [
    "Contacts",
    "Friction",
    "coulomb",
    "unilateral",
]
