"""Nodal fields -> their derivatives, strains and stress resultants at the quadrature points.

With U = (u, w1, w2) and its parameter derivatives ("jets"), strain = L0 U + L1 d_1 U + L2 d_2 U
(`kinematics.strain_slots`) and resultants = D strain: membrane forces N_11, N_22, N_12 [N/m], moments
M_11, M_22, M_12 [N m/m], transverse shear forces Q_1, Q_2 [N/m].
"""

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.material import plane_stress
from casingfem.structure.mesh.kinematics import DOFS, STRAINS, strain_slots
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.parts import ShellGeometry
from casingfem.structure.shell.shell import Shell


def constitutive(shell: Shell, geometry: ShellGeometry) -> Array:
    """Section stiffness D on the eight strains at points, (8, 8, ...)."""
    C, t = plane_stress(geometry.E, geometry.nu), geometry.thickness
    D = np.zeros((STRAINS, STRAINS, *t.shape), dtype=np.result_type(C, t))
    D[:3, :3] = C * t
    D[3:6, 3:6] = C * t**3 / 12.0
    D[6, 6] = D[7, 7] = shell.shear_correction * geometry.E / (2.0 * (1.0 + geometry.nu)) * t
    return D


def point_jets(grid: Grid, fields: Array) -> Array:
    """U, d_1 U, d_2 U of nodal fields (nodes, 5, k) at the quadrature points: (elements, points, 15, k)."""
    local = fields[grid.elements]
    elements, points = len(grid.elements), grid.table.shape[2]
    flat = local.reshape(elements, grid.table.shape[1], -1)
    jets = np.stack([np.matmul(table.T, flat) for table in grid.table], axis=2)
    jets = jets / np.concatenate([np.ones((1, elements)), grid.size]).T[:, None, :, None]
    return np.asarray(jets.reshape(elements, points, 3 * DOFS, fields.shape[2]))


def point_strains(shell: Shell, grid: Grid, jets: Array) -> tuple[Array, Array]:
    """Strains (elements, points, 8, k) and area Jacobian (elements, points) on a shell's surface."""
    L, basis = strain_slots(shell.geometry(*grid.parameters).surface)
    coefficients = np.moveaxis(L, (3, 4), (0, 1)).transpose(0, 1, 3, 2, 4)
    coefficients = coefficients.reshape(*jets.shape[:2], STRAINS, 3 * DOFS)
    return np.matmul(coefficients, jets), basis.jacobian
