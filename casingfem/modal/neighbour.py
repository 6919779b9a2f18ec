"""Modes of a sequence of slightly different structures, as in the steps of an update.

An update keeps a factor of K - s M of an earlier structure. The modes X of the next one start from the last ones, and
the space grows by the old factor applied to their residuals (block Davidson),

    R = K X - M X Lambda,   V = [X, F R, F R', ...],   F = (K_old - s M_old)^-1,

until r^T F r, the first-order remaining decrease of an eigenvalue, is below TOL of it. The last block is also added,
which reduces the error to a hundredth or less. Near the end of an update one block is enough and no factor is needed; a
long step needs a new factor. A further mode could enter from far above, so modes are counted on request (`counted`) at
the end of an update.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import gap_after, solve_modes
from casingfem.linalg.factor import Factor, factorise
from casingfem.linalg.krylov import NOISE, independent, project_out
from casingfem.linalg.pencil import Pencil, make_pencil
from casingfem.modal.fourier import SHIFT
from casingfem.modal.mode_set import Modes, frequency_scale, labelled
from casingfem.modal.modes import RitzModes, checked_resolution, ritz_modes
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.plausible import warn_of
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System

TOL = 1e-7  # of an eigenvalue, expected decrease below which only the last block is added
FAR = 1e-5  # more than this to fall, an old factor takes more blocks than a new one is worth
LEAST = 1e-2  # of TOL: modes that have less to fall stay as they are
GUARD = 8  # modes kept above those wanted
MOST = 12


@dataclass(frozen=True, slots=True, eq=False)
class OldFactor:
    """(K - s M)^-1 of an earlier structure, in the scaling of its own pencil."""

    factor: Factor
    scale: FloatArray

    def apply(self, pencil: Pencil, residual: FloatArray) -> FloatArray:
        """F r in the scaling of another pencil, (free, columns)."""
        turn = (self.scale / pencil.scale)[:, None]
        return np.asarray(turn * self.factor.solve(turn * residual))


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Modes of a structure, with data from which the solution of a similar structure starts.

    Attributes
    ----------
    modes
        The wanted modes.
    guard
        These and GUARD more above them.
    system, pencil
        Matrices of the structure.
    old
        A factor of it or of a similar structure.
    blocks
        Number of blocks of the restart; 0 without a restart.
    """

    modes: Modes
    guard: RitzModes
    system: System
    pencil: Pencil
    old: OldFactor
    blocks: int

    @property
    def vectors(self) -> FloatArray:
        """The modes as orthonormal columns of the pencil, (free, count + GUARD)."""
        return np.asarray(self.system.collect(self.guard.fields, self.guard.own) / self.pencil.scale[:, None])


def shift_of(shell: Shell) -> float:
    """A negative shift for which K - s M is positive definite even without support [rad^2/s^2]."""
    return -float((SHIFT * frequency_scale(shell)) ** 2)


def factored(pencil: Pencil, shift: float) -> tuple[OldFactor, dict[str, float]]:
    """A factor, and its time in seconds."""
    started = time.perf_counter()
    factor = factorise(pencil.shifted(shift))
    return OldFactor(factor, pencil.scale), {"factor": time.perf_counter() - started}


def solved(shell: Shell, count: int, system: System | None = None) -> Solution:
    """The lowest modes of a shell without earlier data, counted, and data from which a similar shell starts.

    `system` is the assembled shell, if it exists already.
    """
    warn_of(shell)
    started = time.perf_counter()
    system = system or assemble(shell)
    assembled = time.perf_counter() - started
    pencil = make_pencil(system.stiffness, system.mass)
    shift = shift_of(shell)
    found = solve_modes(system.stiffness, system.mass, count + GUARD, shift)
    assert found.factor is not None
    shown = None if found.sturm_count is None else gap_after(found.eigenvalues, count, abs(shift))[0]
    guard = ritz_modes(system, found.vectors)
    seconds = {"assemble": assembled, "solve": time.perf_counter() - started - assembled}
    lowest = labelled(shell, system.grid, *guard, count=count, sturm=shown, dofs=system.size, seconds=seconds)
    return Solution(checked_resolution(lowest), guard, system, pencil, OldFactor(found.factor, pencil.scale), 0)


def solved_near(shell: Shell, known: Solution, count: int) -> Solution:
    """The lowest modes of a shell on the same mesh as a solved one; they are not counted.

    Raises
    ------
    ValueError
        If the meshes differ.
    """
    if shell.mesh != known.modes.shell.mesh:
        raise ValueError("restart: found a shell on another mesh, expected the mesh of the known modes")
    started = time.perf_counter()
    system = assemble(shell)
    assembled = time.perf_counter() - started
    pencil = make_pencil(system.stiffness, system.mass)
    start = system.collect(known.guard.fields, known.guard.own) / pencil.scale[:, None]
    vectors, old, blocks, seconds = davidson(pencil, start, known.old, shift_of(shell), count)
    ritz = ritz_modes(system, pencil.scale[:, None] * vectors)
    spent = time.perf_counter() - started - assembled - seconds.get("factor", 0.0)
    seconds |= {"assemble": assembled, "solve": spent}
    lowest = labelled(shell, system.grid, *ritz, count=count, sturm=None, dofs=system.size, seconds=seconds)
    return Solution(lowest, ritz, system, pencil, old, blocks)


def davidson(
    pencil: Pencil, start: FloatArray, old: OldFactor, shift: float, count: int
) -> tuple[FloatArray, OldFactor, int, dict[str, float]]:
    """Vectors (free, as many as at the start) whose first `count` have converged.

    Returns also the factor used last, the number of blocks, and the seconds of a new factor.
    """
    space = Space(pencil, MOST + 2, start)
    seconds: dict[str, float] = {}
    width = space.count
    for block in range(MOST + 1):
        values, y = eigh(space.H, subset_by_index=[0, width - 1])
        residual = space.images @ y - (space.V @ y) * values
        W = old.apply(pencil, residual)
        left = np.abs(np.einsum("ij,ij->j", residual, W) / values)
        most = float(left[:count].max())
        if most > TOL and not seconds and (most > FAR or block > 1):
            old, seconds = factored(pencil, shift)
            W = old.apply(pencil, residual)
        space.grow(W[:, left > LEAST * TOL])
        if most <= TOL:
            break
    return space.V @ eigh(space.H, subset_by_index=[0, width - 1])[1], old, block + 1, seconds


class Space:
    """Orthonormal columns V (free, count), their images A V, and H = V^T A V, which grow by blocks."""

    def __init__(self, pencil: Pencil, blocks: int, start: FloatArray) -> None:
        self.pencil, self.count = pencil, 0
        room = blocks * start.shape[1]
        self._both = np.empty((2, room, pencil.size))  # rows here are the columns of V and A V
        self._H = np.zeros((room, room))
        self.grow(start)

    @property
    def V(self) -> FloatArray:
        """The columns."""
        return self._both[0, : self.count].T

    @property
    def images(self) -> FloatArray:
        """A V."""
        return self._both[1, : self.count].T

    @property
    def H(self) -> FloatArray:
        """V^T A V, its lower triangle, which is all that `eigh` needs."""
        return self._H[: self.count, : self.count]

    def grow(self, block: FloatArray) -> None:
        """Add the part of a block that is outside V."""
        block = np.array(block, order="F")
        for _ in range(2):  # twice is enough
            project_out(self.pencil, self.V, block)
            longest = np.linalg.norm(block, axis=0).max(initial=0.0)
            block = np.asfortranarray(independent(self.pencil, block, NOISE * longest))
        first, self.count = self.count, self.count + block.shape[1]
        self._both[0, first : self.count] = block.T
        self._both[1, first : self.count] = (self.pencil.A @ block).T
        across = self.V.T @ self.images[:, first:]
        self._H[first : self.count, : self.count] = across.T


def counted(solution: Solution) -> Solution | None:
    """The solution with its Sturm count; None if the inertia shows modes that are missing."""
    found = solution.modes
    if found.sturm_count is not None:
        return solution
    below, sigma = gap_after((2.0 * np.pi * solution.guard.freq) ** 2, len(found))
    if solution.pencil.count_below(sigma) != below:
        return None
    return replace(solution, modes=replace(found, sturm_count=below))
