"""Whether a turning structure keeps its shape: its lowest omega^2 beside what round-off makes of a rigid motion's."""

import numpy as np

from casingfem.errors import ModelError
from casingfem.linalg.certificate import round_off
from casingfem.linalg.eigen import EigenResult
from casingfem.linalg.entries import Symmetric


def require_stable(K: Symmetric, found: EigenResult, where: str = "") -> None:
    """Refuse a lowest omega^2 that lies below zero by more than round-off in K(Omega) moves it.

    Raises
    ------
    ModelError
        `rotation-unstable`.
    """
    lowest = found.eigenvalues[:1]  # none in a band without modes
    if np.any(lowest < -round_off(K, found.vectors[:, :1])):
        raise ModelError("rotation-unstable", f"modes: found omega^2 = {lowest[0]:.4g} rad^2/s^2{where}")
