"""Modes of a solid block, bent into any shape, by one spectral hexahedron: 3-D elasticity to hold shells against.

The element's nodes are the points of its Lobatto rule, so the mass is diagonal; everything is dense.
"""

import numpy as np
from scipy.linalg import eigh

from casingfem.io.arrays import FloatArray
from casingfem.structure.material import Material
from casingfem.structure.mesh.element import lagrange, lobatto

Orders = tuple[int, int, int]


def unit_cube(orders: Orders) -> FloatArray:
    """The nodes on the unit cube, (3, nodes), the last coordinate fastest."""
    grids = np.meshgrid(*(lobatto(order)[0] for order in orders), indexing="ij")
    return np.stack([grid.ravel() for grid in grids])


def solid_modes(
    place: FloatArray, held: FloatArray, orders: Orders, material: Material, count: int, free: tuple[int, ...] = ()
) -> FloatArray:
    """The lowest angular frequencies [rad/s] of the solid whose nodes are at `place` (3, nodes).

    All displacements are nothing where `held`, (nodes,), but for those along the axes `free`.
    """
    rules = [lobatto(order) for order in orders]
    units = [np.eye(order + 1) for order in orders]
    slopes = [lagrange(order, rule[0])[1].T for order, rule in zip(orders, rules, strict=True)]
    gradient = [
        np.kron(np.kron(*(slopes[j] if j == k else units[j] for j in (0, 1))), slopes[2] if k == 2 else units[2])
        for k in range(3)
    ]
    weight = np.einsum("i,j,k->ijk", *(rule[1] for rule in rules)).ravel()
    jacobian = np.array([[gradient[j] @ place[i] for j in range(3)] for i in range(3)]).transpose(2, 0, 1)
    volume, inverse = weight * np.abs(np.linalg.det(jacobian)), np.linalg.inv(jacobian)
    by = [sum(inverse[:, j, i, None] * gradient[j] for j in range(3)) for i in range(3)]
    pair = [[by[i].T @ (volume[:, None] * by[j]) for j in range(3)] for i in range(3)]
    lame = material.E * material.nu / ((1.0 + material.nu) * (1.0 - 2.0 * material.nu))
    G = material.shear_modulus
    laplace = G * sum(pair[i][i] for i in range(3))
    K = np.block(
        [[lame * pair[i][j] + G * pair[j][i] + (laplace if i == j else 0.0) for j in range(3)] for i in range(3)]
    )
    moves = np.flatnonzero(np.concatenate([~held.astype(bool) | (axis in free) for axis in range(3)]))
    root = 1.0 / np.sqrt(material.rho * np.tile(volume, 3)[moves])
    values = eigh(root[:, None] * K[np.ix_(moves, moves)] * root, eigvals_only=True, subset_by_index=[0, count - 1])
    return np.sqrt(np.maximum(values, 0.0))
