"""The assembled shell: its matrices on the free dofs, and conversion between free dofs and nodal fields."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Symmetric
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import QUAD, Grid, quads
from casingfem.structure.shell.shell import Shell
from contact.io.brief import brief


@dataclass(frozen=True, eq=False)
class System:
    """Matrices of a supported shell on its free dofs.

    Attributes
    ----------
    shell, grid
        The shell and its mesh.
    stiffness
        Symmetric, (free, free) [SI]: element by element, or a sparse matrix; `K` is always sparse.
    mass
        The diagonal of M, (free,).
    free
        Numbers of the free dofs among 5 * nodes and the additional dofs of rings after them.
    frames
        Motions of each node by its dofs, as columns, (nodes, 5, 5): rotated at nodes fixed in an edge's frame; where
        the wall's centre of mass is off the mid-surface, rotations include displacements
        (`nodal_mass.diagonal_frames`).
    change
        Transformation that makes M diagonal if rings or masses couple it: the free dofs are change @ those of the
        stiffness and `mass`, (free, free); None where nothing is coupled.
    own
        Number of additional dofs of rings: rotations about the normal at the nodes of their edges.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> system = cf.shell.assemble(plate)
    >>> system.size == system.free.size, system.K.shape == (system.size, system.size)
    (True, True)
    """

    shell: Shell
    grid: Grid
    stiffness: Symmetric
    mass: FloatArray
    free: IntArray
    frames: FloatArray
    change: csc_array | None = None
    own: int = 0

    __repr__ = brief

    @property
    def dofs(self) -> int:
        """Dofs of a node."""
        return DOFS

    @property
    def cells(self) -> IntArray:
        """Cells for pictures: VTK's quadrilateral type and the nodes, (cells, 5)."""
        return np.insert(quads(self.grid), 0, QUAD, axis=1)

    @property
    def size(self) -> int:
        """Number of free dofs."""
        return len(self.free)

    @cached_property
    def K(self) -> csc_array:
        """The stiffness as a sparse matrix, (free, free)."""
        return self.stiffness.tocsc() if isinstance(self.stiffness, ElementSum) else self.stiffness

    @cached_property
    def M(self) -> csc_array:
        """The mass as a matrix, (free, free), diagonal."""
        return csc_array(diags_array(self.mass))

    @cached_property
    def points(self) -> FloatArray:
        """Positions of the nodes, (nodes, 3)."""
        return np.asarray(self.shell.geometry(*self.grid.nodes).surface.x.T)

    def expand(self, vectors: Array) -> Array:
        """Free dofs (free, columns) -> nodal fields in Cartesian axes, (nodes, 5, columns)."""
        fields = self._spread(vectors)[: len(self.frames) * DOFS].reshape(len(self.frames), DOFS, -1)
        return np.asarray(np.einsum("nij,njk->nik", self.frames, fields))

    def expand_own(self, vectors: Array) -> Array:
        """Free dofs (free, columns) -> the rings' own dofs, (own, columns)."""
        return self._spread(vectors)[len(self.frames) * DOFS :]

    def restrict(self, forces: Array, own: Array | None = None) -> Array:
        """Nodal forces in Cartesian axes (nodes, 5, columns) -> work-conjugate free dofs (free, columns).

        `own` (own, columns) are those on the rings' own dofs, by default zero.
        """
        turned = np.einsum("nji,njk->nik", self.frames, forces).reshape(len(self.frames) * DOFS, -1)
        felt = np.vstack([turned, np.zeros((self.own, turned.shape[1])) if own is None else own])[self.free]
        return np.asarray(felt if self.change is None else self.change.T @ felt)

    def translations(self, axes: FloatArray) -> FloatArray:
        """Unit translations of the body along the rows of `axes` (k, 3) on the free dofs, (free, k)."""
        shift = np.zeros((len(self.frames), DOFS, len(axes)))
        shift[:, :3] = axes.T
        return np.asarray(self.collect(shift, np.zeros((self.own, len(axes)))))

    def collect(self, fields: Array, own: Array) -> Array:
        """Free dofs (free, columns) from motions (nodes, 5, columns) and (own, columns).

        The inverse of `expand`, `expand_own`.
        """
        turned = np.linalg.solve(self.frames, fields).reshape(len(self.frames) * DOFS, -1)
        motions = np.vstack([turned, own])[self.free]
        return np.asarray(motions if self.change is None else splu(self.change).solve(motions))

    def _spread(self, vectors: Array) -> Array:
        full = np.zeros((len(self.frames) * DOFS + self.own, vectors.shape[1]), dtype=vectors.dtype)
        full[self.free] = vectors if self.change is None else self.change @ vectors
        return full
