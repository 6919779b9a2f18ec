"""Walls of layers: plies of orthotropic laminae or of the shell's own material, and their section stiffness.

With z from -t/2 to t/2 along the normal, the resultants of first-order shear deformation theory are

    A, B, D = int (1, z, z^2) C(z) dz,   H = k int G(z) dz

with a ply's plane-stress stiffness C and its transverse shear moduli G, rotated by its angle (J. N. Reddy, Mechanics of
Laminated Composite Plates and Shells, 2004, ch. 3). Plies fill the wall in proportion to their thicknesses.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.material import Material, plane_stress
from contact.io.keys import Key

MIRROR = 1e-12  # coupling of stretch and shear over stiffness below which a wall is its own mirror image


@dataclass(frozen=True, slots=True, kw_only=True)
class Lamina:
    """Orthotropic layer: moduli along fibres, across them, in shear [Pa]; nu12; density [kg/m^3].

    Raises
    ------
    ModelError
        `shell-plies` for moduli that are not positive, or nu12^2 >= E1/E2.

    Examples
    --------
    >>> carbon = Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=5e9, G23=3.8e9, rho=1600.0)
    >>> (carbon.stiffness / 1e9).round(2).tolist()
    [[140.91, 3.02, 0.0], [3.02, 10.06, 0.0], [0.0, 0.0, 5.0]]
    """

    E1: Annotated[float, Key("Young's modulus along the fibres [Pa]", "positive", "E")]
    E2: Annotated[float, Key("Young's modulus across the fibres [Pa]", "positive", "E")]
    nu12: Annotated[float, Key("Poisson's ratio, contraction across over strain along the fibres [-]")]
    G12: Annotated[float, Key("shear modulus in the plane of the layer [Pa]", "positive", "E")]
    G13: Annotated[float, Key("transverse shear modulus along the fibres [Pa]", "positive", "E")]
    G23: Annotated[float, Key("transverse shear modulus across the fibres [Pa]", "positive", "E")]
    rho: Annotated[float, Key("density [kg/m^3]", "positive", "rho")]

    def __post_init__(self) -> None:
        for name in ("E1", "E2", "G12", "G13", "G23", "rho"):
            value = getattr(self, name)
            if not 1e-25 <= value <= 1e25:
                raise ModelError("shell-plies", f"lamina.{name} must lie between 1e-25 and 1e25, found {value!r}")
        if not self.nu12**2 < self.E1 / self.E2:
            raise ModelError("shell-plies", f"lamina.nu12: nu12^2 must be below E1/E2, found nu12 = {self.nu12!r}")

    @property
    def stiffness(self) -> FloatArray:
        """Plane-stress stiffness along the fibres [Pa], (3, 3)."""
        nu21 = self.nu12 * self.E2 / self.E1
        rows = [[self.E1, nu21 * self.E1, 0.0], [self.nu12 * self.E2, self.E2, 0.0], [0.0, 0.0, self.G12]]
        return np.asarray(np.array(rows) / np.array([1.0 - self.nu12 * nu21] * 2 + [1.0]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Ply:
    """A layer of a wall; plies are ordered from the inside of a casing outwards, on plates and blades along z or flap.

    Parameters
    ----------
    thickness
        Its relative thickness: plies fill the shell's thickness in proportion.
    angle_deg
        Angle of its fibres, from the chart's first direction (along axis or span) to the second (around, along the
        chord).
    lamina
        Its material; by default the shell's own, isotropic.

    Raises
    ------
    ModelError
        `shell-plies` for a thickness that is not positive, or an angle that is not finite.

    >>> Ply(thickness=1e-3, angle_deg=90.0).lamina is None
    True
    """

    thickness: Annotated[
        float, Key("thickness of the ply [m]; the plies add up to the shell's thickness", "length", "thickness")
    ]
    angle_deg: Annotated[
        float, Key("angle of the fibres from the axis or span towards the circumference or chord [deg]", "turn")
    ] = 0.0
    lamina: Lamina | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.thickness) and self.thickness > 0.0 and np.isfinite(self.angle_deg)):
            found = f"{self.thickness!r} m at {self.angle_deg!r} degrees"
            raise ModelError("shell-plies", f"ply: found {found}, expected a thickness above 0 and an angle")


def turned(lamina: Lamina, angle_deg: float) -> tuple[FloatArray, FloatArray]:
    """Stiffness on (eps_11, eps_22, 2 eps_12) (3, 3), and on (gamma_1, gamma_2) (2, 2), along the shell's directions.

    >>> E1, E2 = 140e9, 10e9
    >>> carbon = Lamina(E1=E1, E2=E2, nu12=0.3, G12=5e9, G13=5e9, G23=3.8e9, rho=1600.0)
    >>> across, shear = turned(carbon, 90.0)
    >>> (across / 1e9).round(2).tolist(), (shear / 1e9).round(2).tolist()
    ([[10.06, 3.02, 0.0], [3.02, 140.91, 0.0], [0.0, 0.0, 5.0]], [[3.8, 0.0], [0.0, 5.0]])
    """
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    T = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2.0 * c * s, 2.0 * c * s, c * c - s * s]])
    R = np.array([[c, s], [-s, c]])
    C, G = T.T @ lamina.stiffness @ T, R.T @ np.diag([lamina.G13, lamina.G23]) @ R
    return np.where(np.abs(C) > 1e-15 * C.max(), C, 0.0), np.where(np.abs(G) > 1e-15 * G.max(), G, 0.0)


def faces(plies: tuple[Ply, ...]) -> FloatArray:
    """Depths z/t between the plies, from -1/2 to 1/2, (plies + 1,)."""
    thickness = np.array([ply.thickness for ply in plies])
    return np.asarray(np.concatenate([[0.0], np.cumsum(thickness)]) / thickness.sum() - 0.5)


def moments(z: FloatArray) -> FloatArray:
    """Int (1, x, x^2) dx between depths, (plies, 3)."""
    return np.stack([np.diff(z ** (k + 1)) / (k + 1) for k in range(3)], axis=1)


def layered_wall(plies: tuple[Ply, ...], own: Material, E: Array, nu: Array, t: Array, factor: Array) -> Array:
    """Matrix from the eight strains to the resultants of a layered wall at points, (8, 8, ...).

    Laminae are scaled with the ratio of E to the modulus of the shell's own material.
    """
    share = moments(faces(plies))
    field = E / own.E
    D = np.zeros((8, 8, *t.shape), dtype=np.result_type(E, nu, t, factor))
    for ply, (one, first, second) in zip(plies, share, strict=True):
        if ply.lamina is None:
            C, G = plane_stress(E, nu), np.eye(2).reshape(2, 2, *[1] * t.ndim) * (E / (2.0 * (1.0 + nu)))
        else:
            C, G = (part.reshape(*part.shape, *[1] * t.ndim) * field for part in turned(ply.lamina, ply.angle_deg))
        D[:3, :3] += one * t * C
        D[:3, 3:6] += first * t**2 * C
        D[3:6, 3:6] += second * t**3 * C
        D[6:, 6:] += factor * one * t * G
    D[3:6, :3] = D[:3, 3:6].swapaxes(0, 1)
    return D


def layered_inertia(plies: tuple[Ply, ...], own: Material, rho: Array, t: Array) -> Array:
    """Moments of the mass per area about the middle, sum rho int (1, z, z^2) dz, (3, ...)."""
    share = moments(faces(plies))
    density = [rho if ply.lamina is None else ply.lamina.rho * (rho / own.rho) for ply in plies]
    return np.stack([
        sum((x * t ** (k + 1) * part for x, part in zip(share[:, k], density, strict=True)), start=0.0 * t * rho)
        for k in range(3)
    ])  # fmt: skip


def mirrored(plies: tuple[Ply, ...]) -> bool:
    """Whether a wall is symmetric under reflection along its first direction, so that cosine and sine waves do not mix.

    >>> carbon = Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=5e9, G23=3.8e9, rho=1600.0)
    >>> cross = tuple(Ply(thickness=1.0, angle_deg=angle, lamina=carbon) for angle in (0.0, 90.0))
    >>> mirrored(cross), mirrored((*cross, Ply(thickness=1.0, angle_deg=45.0, lamina=carbon)))
    (True, False)
    """
    one = np.ones(1)
    D = layered_wall(plies, Material(E=1.0, nu=0.3, rho=1.0), one, 0.3 * one, one, one)[..., 0]
    odd = [2, 5, 6 + 1]
    even = [i for i in range(8) if i not in odd]
    return bool(np.abs(D[np.ix_(even, odd)]).max() <= MIRROR * np.abs(D).max())
