"""Strain and kinetic energies of motions: Phi^T K Phi and Phi^T M Phi without assembling a matrix.

They are sums of squares over quadrature points and nodes. A frequency from them, omega^2 = phi^T K phi/phi^T M phi, is
exact to round-off relative to itself, while one from assembled matrices is exact relative to the largest: the doublets
of a perfect casing agree to 2e-15 instead of 1e-11 (instead of 1e-8 at R/t 10,000). They are analytic in every
parameter of the shell, so complex steps work.
"""

from dataclasses import dataclass

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.mesh.jet_form import JET, point_jets
from casingfem.structure.mesh.kinematics import STRAINS, strain_slots
from casingfem.structure.mesh.shell_mesh import Grid, make_grid
from casingfem.structure.shell.assembly import admitted
from casingfem.structure.shell.edges import edge_forms
from casingfem.structure.shell.nodal_mass import nodal_mass
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.wall import constitutive, curvature

WALL = ("chart", "thickness", "material", "shear_correction", "wall", "plies", "strips", "taper", "radius_defect",
        "thickness_defect", "modulus_defect", "density_defect")  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class ModalProducts:
    """Phi^T K Phi and Phi^T M Phi of some modes, (modes, modes) each; complex for a complex shell."""

    K: Array
    M: Array


@dataclass(frozen=True, slots=True, eq=False)
class PointFields:
    """Modes at the quadrature points and nodes, common to all parameters.

    `own` are the motions of the rings' own dofs, (own, modes). `jets` contains U, d_1 U, d_2 U: (elements, points, 3 *
    5, modes); `strain`, `curvature`, `jacobian` belong to the shell of the modes and are valid for every parameter that
    does not change the surface.
    """

    shell: ShellParts
    grid: Grid
    fields: Array
    own: Array
    jets: Array
    strain: Array
    curvature: Array
    jacobian: Array


def point_fields(shell: ShellParts, grid: Grid, fields: Array, own: Array) -> PointFields:
    """Evaluate modes (nodes, 5, modes) and their parameter derivatives at all quadrature points."""
    jets = point_jets(grid, fields)
    return PointFields(shell, grid, fields, own, jets, *point_strains(shell, grid, jets))


def point_strains(shell: ShellParts, grid: Grid, jets: Array) -> tuple[Array, Array, Array]:
    """Strains (elements, points, 8, k), curvature (3, elements, points), area Jacobian (elements, points).

    Times the section stiffness they are membrane forces [N/m], moments [N m/m] and transverse shear forces [N/m].
    """
    L, rates = strain_slots(shell.geometry(*grid.parameters).surface)
    coefficients = np.moveaxis(L, (3, 4), (0, 1)).transpose(0, 1, 3, 2, 4)
    coefficients = coefficients.reshape(*jets.shape[:2], STRAINS, JET)
    return np.matmul(coefficients, jets), curvature(rates), rates.basis.jacobian


def modal_products(shell: ShellParts, at: PointFields) -> ModalProducts:
    """Phi^T K Phi and Phi^T M Phi of a shell whose parameters may be complex, for given modes."""
    at = on_surface(shell, at)
    stress = np.matmul(point_stiffness(shell, at), at.strain)
    modes = at.fields.shape[2]
    K = at.strain.reshape(-1, modes).T @ stress.reshape(-1, modes)
    flat = at.fields.reshape(-1, modes)
    M = nodal_mass(shell, at.grid).product(at.fields)
    forms, motions = edge_forms(shell, at.grid), np.vstack([flat, at.own])
    K = sum((form.product(motions) for form in forms.stiffness), start=K)
    return ModalProducts(K=K, M=sum((form.product(motions) for form in forms.mass), start=M))


def point_stiffness(shell: ShellParts, at: PointFields) -> Array:
    """Section stiffness times the area of each quadrature point, (elements, points, 8, 8)."""
    geometry = shell.geometry(*at.grid.parameters, at.grid.middle)
    return np.moveaxis(constitutive(shell, geometry, at.curvature) * (at.jacobian * at.grid.measure), (0, 1), (2, 3))


def product_rates(shell: ShellParts, at: PointFields) -> ModalProducts:
    """The imaginary parts of `modal_products` for a shell that differs by one tiny complex step from that of `at`.

    In real arithmetic, Im(S^T D S) = S'^T D_i S' + (S"^T D' S') + its transpose with S = S' + i S"; the wall is omitted
    if only parts on its edges have changed.
    """
    moved = on_surface(shell, at)
    modes = at.fields.shape[2]
    flat = moved.fields.reshape(-1, modes)
    forms, motions = edge_forms(shell, moved.grid), np.vstack([flat, moved.own])
    K = sum((form.product(motions).imag for form in forms.stiffness), start=np.zeros((modes, modes)))
    M = sum((form.product(motions).imag for form in forms.mass), start=np.zeros((modes, modes)))
    if all(getattr(shell, name) is getattr(at.shell, name) for name in WALL):
        return ModalProducts(K=K, M=M)
    D, strain = point_stiffness(shell, moved), np.real(moved.strain)
    K = K + strain.reshape(-1, modes).T @ np.matmul(D.imag, strain).reshape(-1, modes)
    if np.iscomplexobj(moved.strain):
        cross = moved.strain.imag.reshape(-1, modes).T @ np.matmul(D.real, strain).reshape(-1, modes)
        K = K + cross + cross.T
    still = np.real(moved.fields)
    momenta = nodal_mass(shell, moved.grid).times(still).imag
    # fixed directions that turn move the modes along themselves, where these have no motion: M does not see it
    M = M + still.reshape(-1, modes).T @ momenta.reshape(-1, modes)
    return ModalProducts(K=K, M=M)


def on_surface(shell: ShellParts, at: PointFields) -> PointFields:
    """The modes on another surface close to that of their shell.

    Fixed directions of an edge's own frame change with it.
    """
    if shell.chart is at.shell.chart and shell.radius_defect is at.shell.radius_defect:
        return at
    stretched = shell.chart.bounds != at.shell.chart.bounds  # the parameter stretches the mesh itself
    turned = any(support.frame == "edge" for support in shell.supports.values())
    if stretched or turned:
        grid = make_grid(shell.chart, shell.mesh, shell.stations) if stretched else at.grid
        return point_fields(shell, grid, admitted(shell, grid, at.fields) if turned else at.fields, at.own)
    return PointFields(shell, at.grid, at.fields, at.own, at.jets, *point_strains(shell, at.grid, at.jets))
