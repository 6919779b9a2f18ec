"""The wall between its faces: its stiffness and inertia at points of the mid-surface.

The curved wall keeps the metric at every depth z and the stretch of its normals. With b the curvature tensor in the
tangent frame, P = (1 - z b)^-1, and the wall's displacement

    u + z w + a3 (z s1 + (z^2 - t^2/12) s2/2)

the strains along the frame are, eps and chi those of the mid-surface (`mesh.kinematics`),

    e(z) = sym[P (2 eps + z chi)] - eps - b P (z s1 + (z^2 - t^2/12) s2/2),   e_33 = s1 + z s2,   g(z) = P gamma

in volumes det(1 - z b) dz, with three-dimensional Hooke's law; s1 and s2 are those of least energy, point by point, so
that eight strains remain. On a flat wall that is plane stress. Terms that vanish in rigid motions and thin shells are
omitted: z^2 times the director's rotation about the normal, and the slopes of s1, s2. In bending waves the shear factor
5/(6 - nu) compensates for them: with it the waves are exact to second order in wave number times thickness (N.G.
Stephen, J. Sound Vib. 202, 1997, 539). The term t^2/12 makes u the mean displacement of the wall, not that of its
middle, so the inertia has no term in s2. Metric: Chapelle & Bathe, The Finite Element Analysis of Shells, 2011, ch. 4.

The linear wall has Naghdi's resultants, strains linear in z in volumes dz: published shell theory. So has a wall of
layers (`plies`).
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.geometry.chart import Surface
from casingfem.structure.material import plane_stress
from casingfem.structure.mesh.element import gauss
from casingfem.structure.mesh.kinematics import STRAINS, Rates, dot, frame
from casingfem.structure.shell.parts import ShellGeometry, ShellParts
from casingfem.structure.shell.plies import layered_inertia, layered_wall

POINTS = 3  # through the wall: what they leave is of fourth order in thickness times curvature


@cache
def depths() -> tuple[FloatArray, FloatArray]:
    """Points and weights of integration through a wall of thickness 1 about its middle."""
    x, weights = gauss(POINTS)
    return x - 0.5, weights


def curvature(rates: Rates) -> Array:
    """b_11, b_22, b_12 of a surface in its tangent frame, (3, ...): b_ij = -e_i . D_j a3."""
    e1, e2 = rates.basis.e1, rates.basis.e2
    return -np.stack([dot(e1, rates.normal[0]), dot(e2, rates.normal[1]), dot(e1, rates.normal[1])])


def constitutive(shell: ShellParts, geometry: ShellGeometry, b: Array) -> Array:
    """Section stiffness on the eight strains at points, (8, 8, ...), of a surface with curvature b (3, ...)."""
    E, nu, t = geometry.E, geometry.nu, geometry.thickness
    if shell.plies:
        return layered_wall(shell.layers, shell.material, E, nu, t, shell.shear_factor(nu))
    shear = shell.shear_factor(nu) * E / (2.0 * (1.0 + nu))
    if shell.wall == "linear":
        return linear_wall(plane_stress(E, nu), shear, t)
    return curved_wall(E, nu, shear, t, b)


def linear_wall(C: Array, shear: Array, t: Array) -> Array:
    """Naghdi's section stiffness: t C on eps, t^3/12 C on chi, t times `shear` on gamma."""
    D = np.zeros((STRAINS, STRAINS, *t.shape), dtype=np.result_type(C, shear, t))
    D[:3, :3] = C * t
    D[3:6, 3:6] = C * t**3 / 12.0
    D[6, 6] = D[7, 7] = shear * t
    return D


def curved_wall(E: Array, nu: Array, shear: Array, t: Array, b: Array) -> Array:
    """The resultants of the curved wall: products of strains summed over the depths, s1 and s2 condensed."""
    x, weights = depths()
    z, b = t[..., None] * x, b[..., None]  # depths last
    volume, (p11, p22, p12) = shifter(b, z)
    share = volume * weights * t[..., None]
    rows = stretched_rows(b, z, t[..., None])
    ones = np.ones_like(nu)
    factors = np.stack([ones, ones, 0.5 * ones, ones, nu / (1.0 - 2.0 * nu)], axis=-1) * (E / (1.0 + nu))[..., None]
    weighted = rows * (share[..., None] * factors[..., None, :])[..., None]  # Hooke's law on e_11 .. e_33 and the trace
    flat = (*t.shape, -1, rows.shape[-1])
    H = np.matmul(weighted.reshape(flat).swapaxes(-1, -2), rows.reshape(flat))
    D = np.zeros((*t.shape, STRAINS, STRAINS), dtype=np.result_type(H, shear))
    D[..., :6, :6] = condensed(H)
    D[..., 6, 6], D[..., 7, 7] = (shear * np.sum(share * (p**2 + p12**2), axis=-1) for p in (p11, p22))
    D[..., 6, 7] = D[..., 7, 6] = shear * np.sum(share * p12 * (p11 + p22), axis=-1)
    return np.moveaxis(D, (-2, -1), (0, 1))


def stretched_rows(b: Array, z: Array, t: Array) -> Array:
    """e_11, e_22, 2 e_12, e_33 and their trace at depths z from eps, chi, s1, s2: (..., depths, 5, 8)."""
    volume, _ = shifter(b, z)
    K = b[0] * b[1] - b[2] ** 2
    rows = np.zeros((*z.shape, 5, 8), dtype=np.result_type(z, b))
    rows[..., :3, :6] = strain_rows(b, z)
    for k, part in enumerate((b[0] - z * K, b[1] - z * K, 2.0 * b[2])):  # b P det(1 - z b)
        rows[..., k, 6] = -z * part / volume
        rows[..., k, 7] = -0.5 * (z**2 - t**2 / 12.0) * part / volume
    rows[..., 3, 6], rows[..., 3, 7] = 1.0, z
    rows[..., 4, :] = rows[..., 0, :] + rows[..., 1, :] + rows[..., 3, :]
    return rows


def condensed(H: Array) -> Array:
    """The form on eps and chi (..., 6, 6) that is least over s1 and s2, of a form on all eight (..., 8, 8)."""
    a, d, c = H[..., 6, 6], H[..., 7, 7], H[..., 6, 7]
    side = H[..., :6, 6:]
    inverse = np.stack([np.stack([d, -c], axis=-1), np.stack([-c, a], axis=-1)], axis=-1)
    inverse = inverse / (a * d - c**2)[..., None, None]
    return np.asarray(H[..., :6, :6] - side @ inverse @ side.swapaxes(-1, -2))


def shifter(b: Array, z: Array) -> tuple[Array, tuple[Array, Array, Array]]:
    """det(1 - z b) and P_11, P_22, P_12 of P = (1 - z b)^-1, for b_11, b_22, b_12 and depths of one shape."""
    b11, b22, b12 = b
    volume = 1.0 - z * (b11 + b22) + z**2 * (b11 * b22 - b12**2)
    return volume, ((1.0 - z * b22) / volume, (1.0 - z * b11) / volume, z * b12 / volume)


def strain_rows(b: Array, z: Array) -> Array:
    """e_11, e_22, 2 e_12 at depth z from eps and chi, without stretch: sym[P (2 eps + z chi)] - eps, (..., 3, 6).

    >>> strain_rows(np.zeros((3, 1)), np.array([2.0]))[0, 0].tolist()
    [1.0, 0.0, 0.0, 2.0, 0.0, 0.0]
    """
    _, (p11, p22, p12) = shifter(b, z)
    rows = np.zeros((*z.shape, 3, 6), dtype=np.result_type(p11, z))
    half = 0.5 * p12
    rows[..., 0, 3], rows[..., 1, 4], rows[..., 2, 5] = p11, p22, 0.5 * (p11 + p22)
    rows[..., 0, 5] = rows[..., 1, 5] = half
    rows[..., 2, 3] = rows[..., 2, 4] = p12
    rows[..., :3] = 2.0 * rows[..., 3:]
    rows[..., 3:] *= z[..., None, None]
    rows[..., range(3), range(3)] -= 1.0
    return rows


def inertia(shell: ShellParts, geometry: ShellGeometry) -> Array:
    """Moments of the wall's mass per area of mid-surface, (3, ...) [kg/m^2, kg/m, kg]: m0, m1, m2.

    rho int (1, z, z^2) det(1 - z b) dz = rho (t + K t^3/12, -H t^3/6, t^3/12 + K t^5/80), K the Gaussian curvature, H
    the mean one. On a curved wall more mass is on the outer side, so m1 couples u and w. Without it the torsional
    frequency of a tube would be too high by (t/R)^2/12. For layers m1 follows from their densities.
    """
    t, rho = geometry.thickness, geometry.rho
    if shell.plies:
        return layered_inertia(shell.layers, shell.material, rho, t)
    if shell.wall == "linear":
        return np.stack([rho * t, 0.0 * rho * t, rho * t**3 / 12.0])
    return curved_inertia(rho, t, *mean_and_gauss(geometry.surface))


def curved_inertia(rho: Array, t: Array, H: Array, K: Array) -> Array:
    """Moments of the mass of a curved wall, (3, ...), by its mean and Gaussian curvature H, K (`inertia`)."""
    return np.stack([
        rho * t * (1.0 + K * t**2 / 12.0), -rho * H * t**3 / 6.0, rho * t**3 * (1.0 / 12.0 + K * t**2 / 80.0)
    ])  # fmt: skip


class Section(NamedTuple):
    """A wall as a beam, per width: twelve times its bending stiffness, E t^3 [N m], shear [N/m], mass [kg/m^2]."""

    bending: Array
    shear: Array
    mass: Array


def section(shell: ShellParts, geometry: ShellGeometry, way: int) -> Section:
    """The wall as a beam along its direction 0 or 1, otherwise free to deform, so not stiffer than within the shell."""
    at = ShellGeometry(geometry.surface, *(np.real(part) for part in geometry[1:]))
    if not shell.plies:
        shear = np.real(shell.shear_factor(at.nu)) * at.E / (2.0 * (1.0 + at.nu)) * at.thickness
        return Section(at.E * at.thickness**3, shear, at.rho * at.thickness)
    D = constitutive(shell, at, np.zeros((3, *at.thickness.shape)))
    compliance = np.linalg.inv(np.moveaxis(D, (0, 1), (-2, -1)))
    bending, shear = (1.0 / compliance[..., k + way, k + way] for k in (3, 6))
    return Section(12.0 * bending, shear, inertia(shell, at)[0])


def mean_and_gauss(surface: Surface) -> tuple[Array, Array]:
    """H = (b_11 g_22 - 2 b_12 g_12 + b_22 g_11)/(2 g), K = (b_11 b_22 - b_12^2)/g; b_ab = a3 . X,ab, g = det g_ab."""
    basis = frame(surface)
    b11, b22, b12 = (dot(basis.normal, second) for second in (surface.x11, surface.x22, surface.x12))
    g11, g22, g12 = dot(surface.x1, surface.x1), dot(surface.x2, surface.x2), dot(surface.x1, surface.x2)
    g = basis.jacobian**2
    return 0.5 * (b11 * g22 - 2.0 * b12 * g12 + b22 * g11) / g, (b11 * b22 - b12**2) / g
