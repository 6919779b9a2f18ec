"""Nodal fields -> their derivatives, strains and stress resultants at the quadrature points.

With U = (u, w1, w2) and its parameter derivatives ("jets"), strain = L0 U + L1 d_1 U + L2 d_2 U
(`kinematics.strain_slots`) and resultants = D strain (`wall.constitutive`): membrane forces N_11, N_22, N_12
[N/m], moments M_11, M_22, M_12 [N m/m], transverse shear forces Q_1, Q_2 [N/m].
"""

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.mesh.kinematics import DOFS, STRAINS, strain_slots
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.wall import curvature


def point_jets(grid: Grid, fields: Array) -> Array:
    """U, d_1 U, d_2 U of nodal fields (nodes, 5, k) at the quadrature points: (elements, points, 15, k)."""
    local = fields[grid.elements]
    elements, points = len(grid.elements), grid.table.shape[2]
    flat = local.reshape(elements, grid.table.shape[1], -1)
    jets = np.empty((elements, points, 3, flat.shape[2]), dtype=np.result_type(fields, grid.size))
    for slot, table in enumerate(grid.table):
        np.matmul(table.T, flat, out=jets[:, :, slot])
    jets[:, :, 1:] /= grid.size.T[:, None, :, None]
    return np.asarray(jets.reshape(elements, points, 3 * DOFS, fields.shape[2]))


def point_strains(shell: ShellParts, grid: Grid, jets: Array) -> tuple[Array, Array, Array]:
    """Strains (elements, points, 8, k), curvature (3, elements, points), area Jacobian (elements, points)."""
    L, rates = strain_slots(shell.geometry(*grid.parameters).surface)
    coefficients = np.moveaxis(L, (3, 4), (0, 1)).transpose(0, 1, 3, 2, 4)
    coefficients = coefficients.reshape(*jets.shape[:2], STRAINS, 3 * DOFS)
    return np.matmul(coefficients, jets), curvature(rates), rates.basis.jacobian
