"""Exact derivatives of the eigenvalue problem restricted to some modes, without assembled matrices.

For modes Phi the products Phi^T K(p) Phi and Phi^T M(p) Phi are sums over quadrature points of strain and
kinetic energies. They are analytic in every parameter, so one evaluation at p + i h gives

    Phi^T K_p Phi = Im(Phi^T K(p + i h) Phi)/h

to round-off (complex step: Squire & Trapp, SIAM Review 40, 1998, 110), for moduli, densities, thickness, harmonics
of any field and springs alike. Where a parameter moves the surface, the directions that a diaphragm or a plane of
symmetry fixes turn with it, and the modes with them.

For an imported part the derivatives are central differences of the assembled matrices: K and M are linear in moduli,
densities and foundations and at most cubic in a thickness, so the relative error with the step `MESH_STEP` is 1e-8.
"""

from collections.abc import Sequence

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes, require_energies
from casingfem.structure.imported.turning_structure import rotation_of
from casingfem.structure.shell.energies import point_fields, product_rates
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.shell import remade
from casingfem.updating.addresses import get_value, with_value
from casingfem.updating.parameters import Parameter

STEP = 1e-30
MESH_STEP = 1e-4  # of the parameter's value


def product_derivatives(
    modes: Modes | MeshModes, vary: Sequence[Parameter], fields: FloatArray, own: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """X^T K_p X and X^T M_p X for motions X of a solved shell, each (parameters, motions, motions) [per unit].

    Units are those of the solver: per decade for a log parameter. A rotating shell is refused (`rotation-update`).
    """
    if isinstance(modes, MeshModes):
        return of_mesh(modes, vary, fields)
    assert own is not None
    require_energies(modes)
    if modes.shell.rotation is not None:
        raise ModelError("rotation-update", "update: found a rotating shell, expected one at rest")
    at = point_fields(modes.shell, modes.grid, fields, own)
    bare = remade(ShellParts, modes.shell)
    K, M = np.empty((2, len(vary), fields.shape[2], fields.shape[2]))
    for k, parameter in enumerate(vary):
        x = parameter.to_internal(get_value(bare, parameter.name)) + 1j * STEP
        rates = product_rates(with_value(bare, parameter.name, parameter.from_internal(x)), at)
        K[k], M[k] = rates.K / STEP, rates.M / STEP
    return K, M


def of_mesh(modes: MeshModes, vary: Sequence[Parameter], fields: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The same derivatives for an imported part, by its assembled matrices; a rotating part is refused."""
    if rotation_of(modes.structure) is not None:
        raise ModelError("rotation-update", "update: found a rotating part, expected one at rest")
    K, M = np.empty((2, len(vary), fields.shape[2], fields.shape[2]))
    for k, parameter in enumerate(vary):
        value = float(get_value(modes.structure, parameter.name))
        h = MESH_STEP * abs(value)
        ends = (with_value(modes.structure, parameter.name, value + step) for step in (h, -h))
        ahead, behind = (end.assembled() for end in ends)
        X, unit = ahead.collect(fields), np.log(10.0) * value if parameter.log else 1.0
        K[k] = (X.T @ (ahead.K @ X) - X.T @ (behind.K @ X)) / (2.0 * h) * unit
        M[k] = (X.T @ (ahead.M @ X) - X.T @ (behind.M @ X)) / (2.0 * h) * unit
    return K, M


def eigen_derivatives(modes: Modes | MeshModes, vary: Sequence[Parameter]) -> FloatArray:
    """G[p, i, j] = phi_i^T (K_p - omega_i^2 M_p) phi_j, (parameters, modes, modes) [rad^2/s^2 per unit].

    The diagonal is d(omega_i^2)/dp; G[p, i, j]/(omega_i^2 - omega_j^2) is mode j's share in the change of mode i.

    Raises
    ------
    ModelError
        `rotation-update` for a structure that rotates, `modes-harmonics` for modes of a bolted casing by harmonics.

    Examples
    --------
    A clamped shell has omega^2 proportional to E:

    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01,
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"root": cf.Clamped()})
    >>> found = cf.modes(plate, 4)
    >>> G = cf.updating.eigen_derivatives(found, [cf.Parameter(name="material.E", lower=100e9, upper=300e9)])
    >>> G.shape, bool(np.allclose(210e9 * np.diag(G[0]), found.omega**2))
    ((1, 4, 4), True)
    """
    K, M = product_derivatives(modes, vary, modes.fields, getattr(modes, "own", None))
    return np.asarray(K - modes.omega[:, None] ** 2 * M)
