"""A curved Timoshenko beam in space, by spectral line elements: axial force, shears, torsion and two bendings.

With the centre line x(s), tangent t, displacement u and rotation phi, all Cartesian, the strains are (Simo & Vu-Quoc,
Comput. Methods Appl. Mech. Eng. 58, 1986, 79, linearised)

    Gamma = u' - phi x t   (stretch and two shears),   kappa = phi'   (twist and two curvatures),

in the section's axes (t, a2, a3). Rigid motions cause no strain, also on the interpolated line. The section's depth is
assumed small compared with the radius: terms of order (depth/radius)^2/12 of its stiffness are omitted.
"""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, IntArray
from casingfem.structure.edge.section import Section
from casingfem.structure.geometry.rotation import skew
from casingfem.structure.material import Material
from casingfem.structure.mesh.element import gauss, lagrange, lobatto

MOTIONS = 6  # u_x, u_y, u_z, phi_x, phi_y, phi_z


class Beam(NamedTuple):
    """A beam's matrices on the motions of its nodes.

    Stiffness at Gauss points: `strain` (elements, points, 6, order + 1, 6), section stiffness `D` (elements, points,
    6, 6). Mass at the nodes of each element: `inertia` (elements, order + 1, 6, 6).
    """

    strain: Array
    D: Array
    inertia: Array


def section_axes(tangent: Array, towards: Array) -> tuple[Array, Array]:
    """Length of tangents (..., 3), and section axes as rows t, a2, a3 (..., 3, 3), a2 closest to `towards`."""
    length = np.sqrt(np.einsum("...i,...i->...", tangent, tangent))
    t = tangent / length[..., None]
    a2 = towards - np.einsum("...i,...i->...", towards, t)[..., None] * t
    a2 = a2 / np.sqrt(np.einsum("...i,...i->...", a2, a2))[..., None]
    return length, np.stack([t, a2, np.cross(t, a2)], axis=-2)


def beam_strain(axes: Array, value: Array, slope: Array) -> Array:
    """Strains in the section's axes (..., 6, m, 6) of motions with shape values and slopes per length (..., m)."""
    strain = np.zeros((*slope.shape[:-1], 6, slope.shape[-1], MOTIONS), dtype=np.result_type(axes, slope))
    turn = np.matmul(axes, skew(axes[..., 0, :]))  # - phi x t = t x phi
    strain[..., :3, :, :3] = np.einsum("...ij,...m->...imj", axes, slope)
    strain[..., 3:, :, 3:] = strain[..., :3, :, :3]
    strain[..., :3, :, 3:] = np.einsum("...ij,...m->...imj", turn, value)
    return strain


def section_stiffness(section: Section, material: Material) -> Array:
    """E A, the two shear stiffnesses, G J, E I_r, E I_z on the diagonal, (6, 6)."""
    G = material.shear_modulus
    shear = section.shear * G * section.area
    stretch, bend = material.E * section.area, (material.E * section.I_r, material.E * section.I_z)
    return np.diag(np.array([stretch, shear, shear, G * section.J, *bend]))


def section_inertia(section: Section, material: Material, axes: Array) -> Array:
    """Mass per length on (u, phi) in Cartesian axes, (..., 6, 6): rho A, and rho (I_r + I_z, I_r, I_z) in `axes`."""
    turning = np.array([section.I_r + section.I_z, section.I_r, section.I_z])
    inertia = np.zeros((*axes.shape[:-2], 6, 6), dtype=np.result_type(axes, section.area, turning))
    inertia[..., :3, :3] = section.area * np.eye(3)
    inertia[..., 3:, 3:] = np.einsum("...ki,k,...kj->...ij", axes, turning, axes)
    return np.asarray(material.rho * inertia)


def make_beam(points: Array, towards: Array, cells: IntArray, order: int, section: Section, material: Material) -> Beam:
    """A beam along nodes (nodes, 3) with the section's second axis `towards` (nodes, 3) and elements `cells`."""
    x, w = gauss(order + 1)
    value, slope = (table.T for table in lagrange(order, x))
    length, axes = section_axes(slope @ points[cells], value @ towards[cells])
    strain = beam_strain(axes, np.broadcast_to(value, (len(cells), *value.shape)), slope / length[..., None])
    D = section_stiffness(section, material) * (length * w)[..., None, None]
    at, share = lobatto(order)
    length, axes = section_axes(lagrange(order, at)[1].T @ points[cells], towards[cells])
    inertia = section_inertia(section, material, axes) * (length * share)[..., None, None]
    return Beam(strain=strain, D=D, inertia=inertia)


def tie(e1: Array, e2: Array, normal: Array, arm: Array) -> Array:
    """Motions (u, phi) at the end of an arm from a shell node: u, w_1, w_2 and the rotation about the normal.

    phi = w_1 e2 - w_2 e1 + omega n, the rotation that changes the normal by w, and u + phi x arm; vectors (3, q),
    result (q, 6, 6).
    """
    turn = np.stack([e2, -e1, normal], axis=-1).transpose(1, 0, 2)
    G = np.zeros((len(turn), MOTIONS, MOTIONS), dtype=np.result_type(turn, arm))
    G[:, :3, :3] = np.eye(3)
    G[:, 3:, 3:] = turn
    G[:, :3, 3:] = -np.matmul(skew(arm.T), turn)
    return G
