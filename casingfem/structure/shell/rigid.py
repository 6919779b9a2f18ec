"""Rigid motions of a shell, and those that its supports allow.

A body is unsupported if a rigid motion moves no fixed dof and strains no spring. This depends only on the supports: no
limit for small frequencies is needed, and a body on soft springs is supported.
"""

import numpy as np

from casingfem.errors import warn
from casingfem.io.arrays import FloatArray
from casingfem.structure.geometry.rotation import rigid_motions, skew, unfelt
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.assembly import held_dofs
from casingfem.structure.shell.edges import edge_forms, holding_forms, own_dofs
from casingfem.structure.shell.nodal_mass import nodal_mass
from casingfem.structure.shell.shell import Shell

SHARE = 0.5  # of a mode's kinetic energy in rigid motions, from which it is one


def rigid_fields(shell: Shell, grid: Grid) -> FloatArray:
    """The six rigid motions as nodal fields (nodes, 5, 6), each moving the body by about 1 m."""
    surface = shell.geometry(*grid.nodes).surface
    basis = frame(surface)
    tangents = np.stack([basis.e1, basis.e2]).transpose(2, 0, 1)
    return rigid_motions(surface.x.T, basis.normal.T, tangents).reshape(-1, DOFS, 6)


def free_motions(shell: Shell, grid: Grid) -> FloatArray:
    """The rigid motions that the supports allow, (nodes, 5, k), k from 0 to 6.

    >>> from casingfem.structure.geometry.chart import Plate
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.mesh.shell_mesh import make_grid
    >>> from casingfem.structure.edge.support import ElasticEdge
    >>> steel = Material(E=210e9, nu=0.3, rho=7800.0)
    >>> sliding = Shell(chart=Plate(length=1.0, width=0.5), thickness=0.01, material=steel,
    ...                 supports={"root": ElasticEdge(k_z=1e-3)})
    >>> free_motions(sliding, make_grid(sliding.chart, sliding.mesh)).shape[2]
    4
    """
    fields = rigid_fields(shell, grid)
    free, frames = held_dofs(shell, grid)
    moved = np.einsum("nji,njk->nik", frames, fields).reshape(-1, 6)
    moved[free] = 0.0
    motions = np.vstack([fields.reshape(-1, 6), ring_turns(shell, grid, fields)])
    reactions = [moved.T @ moved, *(np.real(form.product(motions)) for form in holding_forms(shell, grid))]
    return np.asarray(fields @ unfelt(reactions))


def ring_turns(shell: Shell, grid: Grid, fields: FloatArray) -> FloatArray:
    """The rings' own dofs in rigid motions (nodes, 5, columns): rotations about the normal, (own, columns)."""
    edges = [grid.edges[name].nodes for name in own_dofs(shell, grid)]
    if not edges:
        return np.zeros((0, fields.shape[2]))
    surface = shell.geometry(*grid.nodes).surface
    x, normal = surface.x.T, frame(surface).normal.T
    motion = np.concatenate([np.tile(np.eye(3), (len(x), 1, 1)), -skew(x)], axis=2).reshape(-1, 6)  # u = a + phi x x
    shift_and_turn = np.linalg.lstsq(motion, fields[:, :3].reshape(len(motion), -1), rcond=None)[0]
    return np.asarray(normal[np.concatenate(edges)] @ shift_and_turn[3:])


def rigid_modes(shell: Shell, grid: Grid, fields: FloatArray, own: FloatArray) -> int:
    """Number of the first modes (nodes, 5, modes) that are rigid motions which the supports allow.

    `own` are the motions of the rings' own dofs, (own, modes). Translations are exact on every mesh, rotations are
    interpolated: on a mesh too coarse for a thin wall a rotation is not rigid, and a warning states it.
    """
    motions = free_motions(shell, grid)
    expected: int = min(motions.shape[2], fields.shape[2])
    if not expected:
        return 0
    turns = np.hstack([ring_turns(shell, grid, motions), own])
    kinetic = kinetic_products(shell, grid, np.dstack([motions, fields]), turns)
    k = motions.shape[2]  # a mode's energy in rigid motions: its M-orthogonal projection on them
    projected = np.linalg.solve(np.linalg.cholesky(kinetic[:k, :k]), kinetic[:k, k:])
    rigid = np.sum(projected**2, axis=0) > SHARE * np.diag(kinetic)[k:]
    first = min(int(np.argmin(np.append(rigid, False))), expected)
    if 0 < first < expected:
        found = f"found {first} rigid-body modes, expected {expected}, as many as the supports leave free"
        warn("modes-rigid", found, stacklevel=5)
    return first


def kinetic_products(shell: Shell, grid: Grid, fields: FloatArray, own: FloatArray) -> FloatArray:
    """Phi^T M Phi of nodal fields (nodes, 5, columns) and rings' turns (own, columns): rings and masses included."""
    flat = fields.reshape(-1, fields.shape[2])
    motions = np.vstack([flat, own])
    forms = edge_forms(shell, grid).mass
    return np.asarray(sum((form.product(motions) for form in forms), start=nodal_mass(shell, grid).product(fields)))
