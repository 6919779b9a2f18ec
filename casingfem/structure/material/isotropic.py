"""Material of a wall: isotropic, linear elastic."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from contact.io.keys import Key

NAMES = {"E": "modulus", "rho": "density"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """Isotropic material: Young's modulus E [Pa], Poisson's ratio nu, density rho [kg/m^3].

    Raises
    ------
    ModelError
        If E or rho is not positive or too large for a float, or nu is outside (-1, 0.5).

    Examples
    --------
    >>> steel = Material(E=210e9, nu=0.3, rho=7800.0)
    >>> round(steel.shear_modulus / 1e9, 2)
    80.77
    """

    E: Annotated[float, Key("Young's modulus [Pa]", "positive", "E")]
    nu: Annotated[float, Key("Poisson's ratio [-]", "poisson", "nu")]
    rho: Annotated[float, Key("density [kg/m^3]", "positive", "rho")]

    def __post_init__(self) -> None:
        for name in ("E", "rho"):
            value = np.real(getattr(self, name))
            if not 1e-25 <= value <= 1e25:  # beyond, products of stiffness and mass leave the range of floats
                found = f"material.{name} must lie between 1e-25 and 1e25, found {value!r}"
                raise ModelError(f"material-{NAMES[name]}", found)
        nu = np.real(self.nu)
        if not -1.0 < nu < 0.5:
            raise ModelError("material-poisson", f"material.nu must lie between -1 and 0.5 (exclusive), found {nu!r}")

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [Pa]."""
        return self.E / (2.0 * (1.0 + self.nu))

    def plane_stress(self) -> Array:
        """Plane-stress stiffness from (eps_11, eps_22, 2 eps_12) to stress [Pa], shape (3, 3).

        C = E / (1 - nu^2) [[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu)/2]]
        """
        return plane_stress(np.asarray(self.E), np.asarray(self.nu))


def plane_stress(E: Array, nu: Array) -> Array:
    """`Material.plane_stress` for moduli at points (...): (3, 3, ...)."""
    zero, one = np.zeros_like(nu), np.ones_like(nu)
    shape = np.array([[one, nu, zero], [nu, one, zero], [zero, zero, (1.0 - nu) / 2.0]])
    return np.asarray(shape * (E / (1.0 - nu**2)))
