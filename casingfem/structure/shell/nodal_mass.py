"""Mass of a shell at its nodes: a block for each node, and the dofs in which these blocks are diagonal.

With the moments (m0, m1, m2) of the wall (`wall.inertia`) and e_a the tangents of a node's rotations,

    m(U, V) = sum over nodes [m0 u.v + m1 (u.e_a y_a + v.e_a w_a) + m2 w_a y_a],   U = (u, w), V = (v, y).

m1 is not 0 where the wall's centre of mass is outside the mid-surface, as on a curved wall. With its displacement u +
(m1/m0) w instead of u, the block is diagonal, since the kinetic energy of a body splits into that of its centre of mass
and that about it.
"""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.mesh.element import ElementQuadLobatto, lobatto
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.wall import inertia

SKEW = 1e-12  # of a node's rotary inertia: above, its two rotations are coupled


class NodalMass(NamedTuple):
    """Moments of the nodes' masses, (nodes, 3) [kg, kg m, kg m^2], and tangents of their rotations, (nodes, 3, 2)."""

    moments: Array
    tangents: Array

    @property
    def blocks(self) -> Array:
        """Mass of each node on its five dofs, (nodes, 5, 5)."""
        m0, m1, m2 = (moment[:, None, None] for moment in self.moments.T)
        blocks = np.zeros((len(self.moments), DOFS, DOFS), dtype=np.result_type(*self))
        blocks[:, :3, :3], blocks[:, 3:, 3:] = m0 * np.eye(3), m2 * np.eye(2)
        blocks[:, :3, 3:] = m1 * self.tangents
        blocks[:, 3:, :3] = blocks[:, :3, 3:].swapaxes(1, 2)
        return blocks

    def times(self, fields: Array) -> Array:
        """M times nodal fields (nodes, 5, k): momenta and moments of momentum, (nodes, 5, k)."""
        m0, m1, m2 = (moment[:, None, None] for moment in self.moments.T)
        u, w = fields[:, :3], fields[:, 3:]
        momentum = m0 * u + m1 * np.matmul(self.tangents, w)
        return np.concatenate([momentum, m1 * np.matmul(self.tangents.swapaxes(1, 2), u) + m2 * w], axis=1)

    def product(self, fields: Array) -> Array:
        """Phi^T M Phi of nodal fields (nodes, 5, k), (k, k)."""
        columns = fields.shape[2]
        return np.asarray(fields.reshape(-1, columns).T @ self.times(fields).reshape(-1, columns))


def nodal_mass(shell: ShellParts, grid: Grid) -> NodalMass:
    """Lobatto mass at the nodes.

    Each element adds its own side of a node, so that M also stays nodal where thickness or density jump.
    """
    a, b = grid.nodes[:, grid.elements]
    geometry = shell.geometry(a, b, grid.middle)
    moments = nodal_sums(grid, np.moveaxis(inertia(shell, geometry) * frame(geometry.surface).jacobian, 0, -1))
    basis = frame(shell.geometry(*grid.nodes).surface)
    return NodalMass(moments, np.stack([basis.e1, basis.e2], axis=-1).transpose(1, 0, 2))


def nodal_sums(grid: Grid, density: Array) -> Array:
    """Integrate a density per parameter area, given at each element's nodes (elements, functions, k), to the nodes.

    The Lobatto rule: (nodes, k), and their sum is the integral.
    """
    _, w = lobatto(grid.mesh.order)
    i, j = ElementQuadLobatto(grid.mesh.order).pairs.T
    area = (grid.size[0] * grid.size[1])[:, None] * (w[i] * w[j])
    sums = np.zeros((grid.nodes.shape[1], density.shape[-1]), dtype=np.result_type(density, area))
    np.add.at(sums, grid.elements, density * area[:, :, None])
    return sums


def diagonal_frames(mass: NodalMass, frames: FloatArray, free: IntArray) -> tuple[FloatArray, FloatArray]:
    """Dofs in which the nodes' masses are diagonal, as columns (nodes, 5, 5), and the diagonal (nodes, 5).

    `frames` are orthogonal dofs of which `free` are free; fixed ones do not change. A free rotation includes free
    displacements that keep the centre of mass at rest.
    """
    moving = np.isin(np.arange(len(frames) * DOFS), free).reshape(-1, DOFS)
    A = frames.swapaxes(1, 2) @ mass.blocks @ frames
    shift = np.tile(np.eye(DOFS), (len(frames), 1, 1))
    both = moving[:, :3, None] & moving[:, None, 3:]
    shift[:, :3, 3:] = np.where(both, -A[:, :3, 3:] / mass.moments[:, 0, None, None], 0.0)
    A = shift.swapaxes(1, 2) @ A @ shift
    skew = np.flatnonzero(moving[:, 3:].all(axis=1) & (np.abs(A[:, 3, 4]) > SKEW * A[:, 3, 3]))
    if len(skew):  # corners that fix an oblique direction
        shift[skew, :, 3:] = shift[skew, :, 3:] @ np.linalg.eigh(A[skew, 3:, 3:])[1]
        A[skew, 3:, 3:] = np.einsum("ni,ij->nij", np.linalg.eigvalsh(A[skew, 3:, 3:]), np.eye(2))
    return frames @ shift, np.diagonal(A, axis1=1, axis2=2).copy()
