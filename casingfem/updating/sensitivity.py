"""Exact derivatives of the eigenvalue problem restricted to some modes, without assembling a matrix.

For modes Phi the products Phi^T K(p) Phi and Phi^T M(p) Phi are sums over quadrature points of strain and
kinetic energies. They are analytic in every parameter, so one evaluation at p + i h gives

    Phi^T K_p Phi = Im(Phi^T K(p + i h) Phi)/h

to round-off (complex step: Squire & Trapp, SIAM Review 40, 1998, 110), for moduli, densities, thickness, harmonics
of any field and springs alike. Held directions of a diaphragm edge are taken as they stand.
"""

from dataclasses import dataclass

import numpy as np

from casingfem.arrays import Array, FloatArray
from casingfem.errors import ModelError
from casingfem.modal.mode_set import Modes
from casingfem.structure.assembly import nodal_mass
from casingfem.structure.edges import edge_forms
from casingfem.structure.mesh import Grid, make_grid
from casingfem.structure.shell import Shell
from casingfem.structure.strains import constitutive, point_jets, point_strains
from casingfem.updating.parameters import Parameter, get_value, with_value

STEP = 1e-30


@dataclass(frozen=True, slots=True, eq=False)
class ModalProducts:
    """Phi^T K Phi and Phi^T M Phi of some modes, (modes, modes) each; complex for a complex shell."""

    K: Array
    M: Array


@dataclass(frozen=True, slots=True, eq=False)
class PointFields:
    """Modes at the quadrature points and nodes: what all parameters share.

    `own` are the motions of the rings' own dofs, (own, modes). `jets` holds U, d_1 U, d_2 U: (elements, points, 3 * 5,
    modes); `strain`, `jacobian` belong to the shell the modes were computed on and serve every parameter that leaves
    the surface alone.
    """

    shell: Shell
    grid: Grid
    fields: FloatArray
    own: FloatArray
    jets: FloatArray
    strain: FloatArray
    jacobian: FloatArray


def point_fields(shell: Shell, grid: Grid, fields: FloatArray, own: FloatArray) -> PointFields:
    """Evaluate modes (nodes, 5, modes) and their parameter derivatives at all quadrature points."""
    jets = point_jets(grid, fields)
    strain, jacobian = point_strains(shell, grid, jets)
    return PointFields(shell=shell, grid=grid, fields=fields, own=own, jets=jets, strain=strain, jacobian=jacobian)


def modal_products(shell: Shell, at: PointFields) -> ModalProducts:
    """Phi^T K Phi and Phi^T M Phi of a shell whose parameters may be complex, for given modes."""
    if shell.chart.bounds != at.shell.chart.bounds:  # the parameter stretches the mesh itself
        at = point_fields(shell, make_grid(shell.chart, shell.mesh), at.fields, at.own)
    same = shell.chart is at.shell.chart and shell.radius_defect is at.shell.radius_defect
    strain, jacobian = (at.strain, at.jacobian) if same else point_strains(shell, at.grid, at.jets)
    geometry = shell.geometry(*at.grid.parameters, at.grid.middle)
    D = constitutive(shell, geometry) * (jacobian * at.grid.measure)
    stress = np.matmul(np.moveaxis(D, (0, 1), (2, 3)), strain)
    modes = at.fields.shape[2]
    K = strain.reshape(-1, modes).T @ stress.reshape(-1, modes)
    flat = at.fields.reshape(-1, modes)
    inertia = np.repeat(nodal_mass(shell, at.grid), (3, 2), axis=1).ravel()
    M = flat.T @ (inertia[:, None] * flat)
    forms, motions = edge_forms(shell, at.grid), np.vstack([flat, at.own])
    K = sum((form.product(motions) for form in forms.stiffness), start=K)
    return ModalProducts(K=K, M=sum((form.product(motions) for form in forms.mass), start=M))


def eigen_derivatives(modes: Modes, vary: list[Parameter]) -> FloatArray:
    """G[p, i, j] = phi_i^T (K_p - omega_i^2 M_p) phi_j, (parameters, modes, modes) [rad^2/s^2 per unit].

    The diagonal is d(omega_i^2)/dp; G[p, i, j]/(omega_i^2 - omega_j^2) is mode j's share in the change of mode i.
    Units are those of the solver: per decade for a log parameter. A rotating shell is refused (`rotation-update`).
    """
    if modes.shell.rotation is not None:
        raise ModelError("rotation-update", "update: found a rotating shell")
    at = point_fields(modes.shell, modes.grid, modes.fields, modes.own)
    derivatives = np.empty((len(vary), len(modes), len(modes)))
    for k, parameter in enumerate(vary):
        x = parameter.to_internal(get_value(modes.shell, parameter.name)) + 1j * STEP
        changed = with_value(modes.shell, parameter.name, parameter.from_internal(x))
        products = modal_products(changed, at)
        derivatives[k] = (products.K.imag - modes.omega[:, None] ** 2 * products.M.imag) / STEP
    return derivatives
