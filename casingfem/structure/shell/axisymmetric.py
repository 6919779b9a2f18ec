"""Stiffness and mass of a perfect casing, one small problem for each number of nodal diameters.

With u = u^(z) e^(i n theta) in cylindrical components, the same strain slots as the two-dimensional shell give, at
theta = 0, strain = (L0 + L1 d_z + L2 (i n + e_z x)) u^. Multiplying the hoop displacement and the hoop rotation by i
makes stiffness and mass real: a reference for the two-dimensional shell, and the fast method if nothing varies around.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.pencil import diagonalised
from casingfem.structure.mesh.element import gauss, lagrange, lobatto
from casingfem.structure.mesh.kinematics import DOFS, STRAINS, frame, strain_slots
from casingfem.structure.shell.assembly import edge_rotation
from casingfem.structure.shell.edges import harmonic_forms
from casingfem.structure.shell.nodal_mass import NodalMass, diagonal_frames
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.wall import constitutive, curvature, inertia

HOOP = np.array([1.0, 1j, 1.0, 1.0, 1j])  # hoop motions are in quadrature
SPIN = np.zeros((DOFS, DOFS))  # d/d theta of the cylindrical unit vectors at theta = 0
SPIN[1, 0], SPIN[0, 1] = 1.0, -1.0


class Wall(NamedTuple):
    """Strains of the dofs of each element at its points, (elements, points, 8, dofs), complex, with section and dofs.

    `section` is the section stiffness times the weight of a point, (8, 8, elements, points); `dofs` (elements, dofs).
    """

    strain: Array
    section: FloatArray
    dofs: IntArray

    def elements(self) -> FloatArray:
        """Element matrices (elements, dofs, dofs)."""
        return self._products(self.strain)

    def energies(self, motions: FloatArray) -> FloatArray:
        """Phi^T K Phi of motions (dofs, modes), summed over the points."""
        return np.asarray(self._products(self.strain @ motions[self.dofs][:, None]).sum(axis=0))

    def _products(self, strain: Array) -> FloatArray:
        return np.asarray(np.einsum("eqsi,steq,eqtj->eij", strain.conj(), self.section, strain, optimize=True).real)


@dataclass(frozen=True, slots=True, eq=False)
class Meridian:
    """Matrices of one harmonic on the free dofs of a meridian.

    K is (free, free), `mass` its diagonal mass (free,), both per unit angle; `free` numbers the dofs among 5 * nodes
    and the rings' own after them; `z` contains the nodes; `frames` (nodes, 5, 5) the motions of each node by its dofs,
    as in `System`; the free dofs are change @ those of K and mass, (free, free), where rings or masses couple M (else
    None); `own` is the number of the rings' rotations about the normal, one for each ring in the order of
    `Shell.rings`. K is the sum of `wall` and `edges`, the stiffness of springs and rings on all dofs, in cylindrical
    axes.
    """

    n: int
    wall: Wall
    edges: FloatArray
    K: FloatArray
    mass: FloatArray
    free: IntArray
    z: FloatArray
    frames: FloatArray
    change: csc_array | None
    own: int = 0

    def expand(self, vectors: FloatArray) -> FloatArray:
        """Free dofs (free, modes) -> (nodes, 5, modes): u_r, u_theta, u_z, w_1, w_2 amplitudes.

        The motion is (u_r, -u_theta, u_z, w_1, -w_2) times (cos, sin, cos, cos, sin) of n theta.
        """
        fields = self._spread(vectors)[: len(self.z) * DOFS].reshape(len(self.z), DOFS, -1)
        return np.asarray(np.matmul(self.frames, fields))

    def expand_own(self, vectors: FloatArray) -> FloatArray:
        """Rotations about the normal at the rings, (own, modes), from free dofs (free, modes)."""
        return self._spread(vectors)[len(self.z) * DOFS :]

    def energies(self, vectors: FloatArray) -> FloatArray:
        """Phi^T K Phi for free dofs (free, modes) from strains.

        Exact to round-off relative to itself, not to the largest in K.
        """
        fields = self.expand(vectors)
        motions = np.vstack([fields.reshape(-1, fields.shape[2]), self.expand_own(vectors)])
        return np.asarray(self.wall.energies(motions) + motions.T @ self.edges @ motions)

    def restrict(self, forces: FloatArray) -> FloatArray:
        """Nodal forces (5 nodes, columns) in cylindrical axes -> work-conjugate free dofs (free, columns)."""
        nodal = forces.reshape(len(self.z), DOFS, -1)
        turned = np.matmul(self.frames.swapaxes(1, 2), nodal).reshape(len(forces), -1)
        felt = np.vstack([turned, np.zeros((self.own, turned.shape[1]))])[self.free]
        return np.asarray(felt if self.change is None else self.change.T @ felt)

    def collect(self, fields: FloatArray, own: FloatArray) -> FloatArray:
        """Free dofs (free, columns) from motions (nodes, 5, columns) and (own, columns).

        The inverse of `expand`, `expand_own`.
        """
        turned = np.linalg.solve(self.frames, fields).reshape(len(self.z) * DOFS, -1)
        motions = np.vstack([turned, own])[self.free]
        return np.asarray(motions if self.change is None else splu(self.change).solve(motions))

    def _spread(self, vectors: FloatArray) -> FloatArray:
        full = np.zeros((len(self.z) * DOFS + self.own, vectors.shape[1]))
        full[self.free] = vectors if self.change is None else self.change @ vectors
        return full


def harmonic_matrices(shell: Shell, n: int) -> Meridian:
    """Stiffness and mass of n nodal diameters of an axisymmetric shell, on its mesh's meridian.

    Raises
    ------
    ValueError
        If anything varies around the shell.
    """
    if not shell.axisymmetric:
        found = "found a shell that rotates or varies around, expected an axisymmetric casing at rest"
        raise ModelError("modes-method", f'method "fourier": {found}')
    order = shell.mesh.order
    (z0, z1), _ = shell.chart.bounds
    lines = z0 + (z1 - z0) * shell.mesh.breaks
    size = np.diff(lines)
    rows = len(size)
    x, w = gauss(order + 1)
    z = lines[:-1, None] + size[:, None] * x
    middle = (lines[:-1] + 0.5 * size)[:, None]
    geometry = shell.geometry(z, np.zeros_like(z), middle)
    L, rates = strain_slots(geometry.surface)
    D = constitutive(shell, geometry, curvature(rates)) * (rates.basis.jacobian * size[:, None] * w)
    values, slopes = lagrange(order, x)
    still = np.einsum("sceq,fq->eqsfc", L[0] + n * 1j * L[2], values)
    still += np.einsum("sceq,cd,fq->eqsfd", L[2], SPIN, values)
    strain = still + np.einsum("sceq,fq,e->eqsfc", L[1], slopes, 1.0 / size)
    strain = (strain * HOOP).reshape(rows, len(x), STRAINS, -1)

    nodes = rows * order + 1
    at = np.arange(rows)[:, None] * order + np.arange(order + 1)
    wall = Wall(strain, D, (at[:, :, None] * DOFS + np.arange(DOFS)).reshape(rows, -1))
    points, weights = lobatto(order)
    z = lines[:-1, None] + size[:, None] * points
    geometry = shell.geometry(z, np.zeros_like(z), middle)
    density = inertia(shell, geometry) * (frame(geometry.surface).jacobian * size[:, None] * weights)
    moments = np.zeros((nodes, 3))
    np.add.at(moments, at, np.moveaxis(density, 0, -1))
    z = np.append(z[:, :-1].ravel(), lines[-1])
    basis = frame(shell.geometry(z, np.zeros_like(z)).surface)  # hoop tangents are in quadrature as hoop motions are
    mass = NodalMass(moments, np.stack([basis.e1, basis.e2], axis=-1).transpose(1, 0, 2))
    return supported(shell, n, wall, z, mass)


def supported(shell: Shell, n: int, wall: Wall, z: FloatArray, mass: NodalMass) -> Meridian:
    """Add springs, rings and masses, express dofs in the frames of nodes, and remove fixed dofs."""
    nodes, own = len(z), len(shell.rings)
    frames = np.tile(np.eye(DOFS), (nodes, 1, 1))
    held = np.zeros((nodes, DOFS), dtype=bool)
    last = nodes * DOFS
    edges, added = np.zeros((2, last + own, last + own))
    for name in (*shell.supports, *shell.stations):
        node = int(np.abs(z - np.real(shell.line_at(name))).argmin())
        stiffness, inert = harmonic_forms(shell, name, n, z[node : node + 1])
        dofs = np.arange(node * DOFS, node * DOFS + DOFS)
        if name in shell.rings:
            dofs, last = np.append(dofs, last), last + 1
        edges[np.ix_(dofs, dofs)] += stiffness
        added[np.ix_(dofs, dofs)] += inert
        if name in shell.stations:
            continue
        support = shell.supports[name]
        if support.frame == "edge":
            # across and normal lie in the meridian plane, along is the hoop direction: K stays real
            frames[node] = edge_rotation(shell, np.array([[z[node]], [0.0]]), along=1)[0]
        held[node, list(support.held)] = True
    K = edges.copy()
    for part, element in zip(wall.dofs, wall.elements(), strict=True):
        K[np.ix_(part, part)] += element
    free = np.flatnonzero(~held.ravel())
    frames, diagonal = diagonal_frames(mass, frames, free)
    lumped = np.append(diagonal.ravel()[free], np.zeros(own))
    free = np.append(free, np.arange(last - own, last))
    K, change = in_frames(K, frames)[np.ix_(free, free)], None
    if added.any():
        lumped, change = diagonalised(csc_array(np.diag(lumped) + in_frames(added, frames)[np.ix_(free, free)]))
        # it differs from the identity at a few nodes alone: two dense products took as long as all else here
        K = np.ascontiguousarray(change.T @ K @ change)
    return Meridian(n, wall, edges, K=K, mass=lumped, free=free, z=z, frames=frames, change=change, own=own)


def in_frames(matrix: FloatArray, frames: FloatArray) -> FloatArray:
    """Symmetric matrix on the nodes' dofs and the rings' own, expressed in the nodes' frames (nodes, 5, 5)."""
    for _ in range(2):
        matrix = matrix.T.copy()
        nodal = matrix[: len(frames) * DOFS].reshape(len(frames), DOFS, -1)
        nodal[:] = np.matmul(frames.swapaxes(1, 2), nodal)
    return matrix
