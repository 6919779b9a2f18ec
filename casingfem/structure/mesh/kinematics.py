"""Naghdi (first-order shear) shell kinematics on a chart.

With a_alpha = X,alpha, unit normal a3, tangent frame e1 = a1/|a1|, e2 = a3 x e1, physical derivatives
D_i = (A^-1)_(i alpha) d_alpha with A_(alpha i) = a_alpha . e_i, Cartesian displacement u and rotation
w = w1 e1 + w2 e2 of the normal, the strains are (Chapelle & Bathe, The Finite Element Analysis of Shells,
2011, ch. 4)

    eps_ij = sym(e_i . D_j u),   chi_ij = sym(e_i . D_j w + D_i a3 . D_j u),   gamma_i = w_i + a3 . D_i u.

They are linear in (U, d_1 U, d_2 U), U = (u, w1, w2): `strain_slots` returns the coefficients, which depend
on the chart alone. All functions are analytic in their input, so complex-step derivatives can be used.
"""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.geometry.chart import Surface

STRAINS = 8  # eps_11, eps_22, 2 eps_12, chi_11, chi_22, 2 chi_12, gamma_1, gamma_2
DOFS = 5  # u_x, u_y, u_z, w_1, w_2


class Frame(NamedTuple):
    """Tangent frame of a surface at points: e1, e2, normal (3, ...), area Jacobian (...)."""

    e1: Array
    e2: Array
    normal: Array
    jacobian: Array


class Rates(NamedTuple):
    """Derivatives along the tangent frame: D_i = D[i, alpha] d_alpha, D_i a3, and e1 . D_i e2.

    `D` is (2, 2, ...), `normal` (2, 3, ...), `turn` (2, ...).
    """

    basis: Frame
    D: Array
    normal: Array
    turn: Array


def dot(a: Array, b: Array) -> Array:
    """Scalar product over the first axis, without conjugation."""
    return np.asarray(np.einsum("i...,i...->...", a, b))


def frame(surface: Surface) -> Frame:
    """Orthonormal tangent frame and area Jacobian J = |a1 x a2|."""
    normal = np.cross(surface.x1, surface.x2, axis=0)
    jacobian = np.sqrt(dot(normal, normal))
    normal = normal / jacobian
    e1 = surface.x1 / np.sqrt(dot(surface.x1, surface.x1))
    return Frame(e1=e1, e2=np.cross(normal, e1, axis=0), normal=normal, jacobian=jacobian)


def tangent_rates(surface: Surface) -> Rates:
    """Frame of a surface, its physical derivatives, and the derivatives of frame and normal."""
    basis = frame(surface)
    e = (basis.e1, basis.e2)
    # A = [[a1.e1, 0], [a2.e1, a2.e2]] because e1 is along a1; D[i, alpha] is its inverse
    a11, a21, a22 = dot(surface.x1, e[0]), dot(surface.x2, e[0]), dot(surface.x2, e[1])
    D = np.array([[1.0 / a11, np.zeros_like(a11)], [-a21 / (a11 * a22), 1.0 / a22]])

    second = ((surface.x11, surface.x12), (surface.x12, surface.x22))
    b = np.array([[dot(basis.normal, second[i][j]) for j in range(2)] for i in range(2)])
    contravariant = [sum(D[i, alpha] * e[i] for i in range(2)) for alpha in range(2)]
    normal_rate = [-sum(b[alpha, beta] * contravariant[beta] for beta in range(2)) for alpha in range(2)]
    normal_slope = [sum(D[i, alpha] * normal_rate[alpha] for alpha in range(2)) for i in range(2)]
    # e1 . d_alpha e2 = -(e2 . X,1alpha)/|a1|
    turn_rate = [-dot(e[1], second[0][alpha]) / a11 for alpha in range(2)]
    turn = [sum(D[i, alpha] * turn_rate[alpha] for alpha in range(2)) for i in range(2)]
    return Rates(basis=basis, D=D, normal=np.array(normal_slope), turn=np.array(turn))


def strain_slots(surface: Surface) -> tuple[Array, Rates]:
    """Coefficients L of strain = L[0] U + L[1] d_1 U + L[2] d_2 U, shape (3, 8, 5, ...), and the frame's rates."""
    rates = tangent_rates(surface)
    basis, D, normal_slope, turn = rates
    e, n, a11 = (basis.e1, basis.e2), basis.normal, D[0, 0]
    L = np.zeros((3, STRAINS, DOFS, *a11.shape), dtype=a11.dtype)
    for alpha in range(2):
        slot = L[1 + alpha]
        d1, d2 = D[0, alpha], D[1, alpha]
        slot[0, :3] = d1 * e[0]
        slot[1, :3] = d2 * e[1]
        slot[2, :3] = d2 * e[0] + d1 * e[1]
        slot[3, :3] = d1 * normal_slope[0]
        slot[4, :3] = d2 * normal_slope[1]
        slot[5, :3] = d2 * normal_slope[0] + d1 * normal_slope[1]
        slot[3, 3] = slot[5, 4] = d1
        slot[4, 4] = slot[5, 3] = d2
        slot[6, :3] = d1 * n
        slot[7, :3] = d2 * n
    # e_i . D_j w = D_j w_i + (e_i . D_j e_k) w_k
    L[0, 3, 4], L[0, 4, 3] = turn[0], -turn[1]
    L[0, 5, 3], L[0, 5, 4] = -turn[0], turn[1]
    L[0, 6, 3] = L[0, 7, 4] = 1.0
    return L, rates
