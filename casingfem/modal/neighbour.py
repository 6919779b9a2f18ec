"""Modes of one structure after another that differs little: an update's way from step to step.

A solution keeps a factor of K - s M of a structure on the way. The modes X of the next one start from the last,
and grow by what the old factor makes of their residuals (block Davidson),

    R = K X - M X Lambda,   V = [X, F R, F R', ...],   F = (K_old - s M_old)^-1,

until r^T F r, the first order of what an eigenvalue has yet to fall, is below TOL of it; the block that shows it is
taken in too, which leaves a hundredth or less. Near the end of an update one block is enough and nothing is factored.
A long step needs a factor of its own; then the modes are counted too, for one could have come from far above. After
short steps they are counted when asked (`counted`), at the end of an update.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh, qr

from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import gap_after
from casingfem.linalg.factor import Factor, factorise
from casingfem.linalg.pencil import Pencil, make_pencil
from casingfem.modal.fourier import SHIFT
from casingfem.modal.mode_set import Modes, frequency_scale, labelled
from casingfem.modal.modes import modes
from casingfem.modal.ritz import RitzModes, ritz_modes
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System

TOL = 1e-7  # of an eigenvalue, still to fall before the last block is taken in
FAR = 1e-5  # more than this to fall, an old factor takes more blocks than a new one is worth
GUARD = 8  # modes carried along above those wanted
MOST = 12


@dataclass(frozen=True, slots=True, eq=False)
class OldFactor:
    """(K - s M)^-1 of a structure on the way, as scaled by its own pencil."""

    factor: Factor
    scale: FloatArray

    def apply(self, pencil: Pencil, residual: FloatArray) -> FloatArray:
        """F r in the scaling of another pencil, (free, columns)."""
        turn = (self.scale / pencil.scale)[:, None]
        return np.asarray(turn * self.factor.solve(turn * residual))


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Modes of a structure with what the next one starts from.

    Attributes
    ----------
    modes
        The modes wanted.
    guard
        These and GUARD more above them.
    system, pencil
        Matrices of the structure.
    old
        A factor of it or of a neighbour.
    blocks
        How many blocks the restart took; 0 from nothing.
    """

    modes: Modes
    guard: RitzModes
    system: System
    pencil: Pencil
    old: OldFactor
    blocks: int

    @property
    def vectors(self) -> FloatArray:
        """These as orthonormal columns of the pencil, (free, count + GUARD)."""
        start = self.system.collect(self.guard.fields, self.guard.own) / self.pencil.scale[:, None]
        return np.asarray(qr(start, mode="economic")[0])


def shift_of(shell: Shell) -> float:
    """A negative shift: K - s M is positive definite even where nothing holds the shell [rad^2/s^2]."""
    return -float((SHIFT * frequency_scale(shell)) ** 2)


def factored(pencil: Pencil, shift: float) -> tuple[OldFactor, dict[str, float]]:
    """A factor, and the seconds it took."""
    started = time.perf_counter()
    factor = factorise(pencil.shifted(shift))
    return OldFactor(factor, pencil.scale), {"factor": time.perf_counter() - started}


def solved(shell: Shell, count: int) -> Solution:
    """The lowest modes of a shell from nothing, counted, and what a neighbour needs to start from them."""
    started = time.perf_counter()
    system = assemble(shell)
    assembled = time.perf_counter() - started
    pencil = make_pencil(system.stiffness, system.mass)
    found = modes(shell, count + GUARD, method="shell", system=system)
    guard = RitzModes(found.freq, found.fields, found.own)
    old, seconds = factored(pencil, shift_of(shell))
    seconds |= {"assemble": assembled, "solve": found.seconds["solve"]}
    found = replace(named(shell, system, guard, count, seconds), sturm_count=found.sturm_count)
    return Solution(found, guard, system, pencil, old, 0)


def solved_near(shell: Shell, known: Solution, count: int) -> Solution:
    """The lowest modes of a shell on the same mesh as a solved one; after a short step they are not counted.

    Raises
    ------
    ValueError
        If the meshes differ.
    """
    if shell.mesh != known.modes.shell.mesh:
        raise ValueError("a restart needs a shell on the same mesh")
    started = time.perf_counter()
    system = assemble(shell)
    assembled = time.perf_counter() - started
    pencil = make_pencil(system.stiffness, system.mass)
    start = system.collect(known.guard.fields, known.guard.own) / pencil.scale[:, None]
    vectors, old, blocks, seconds = davidson(pencil, start, known.old, shift_of(shell), count)
    ritz = ritz_modes(system, pencil.scale[:, None] * vectors)
    spent = time.perf_counter() - started - assembled - seconds.get("factor", 0.0)
    far = "factor" in seconds
    seconds |= {"assemble": assembled, "solve": spent}
    solution = Solution(named(shell, system, ritz, count, seconds), ritz, system, pencil, old, blocks)
    return (counted(solution) or solved(shell, count)) if far else solution


def davidson(
    pencil: Pencil, start: FloatArray, old: OldFactor, shift: float, count: int
) -> tuple[FloatArray, OldFactor, int, dict[str, float]]:
    """Vectors (free, as many as started with) whose first `count` have converged.

    With the factor last used, the blocks it took, and the seconds of a new factor.
    """
    width = start.shape[1]
    seconds: dict[str, float] = {}
    V = qr(start, mode="economic")[0]
    images = np.asarray(pencil.A @ V)
    for block in range(MOST + 1):
        values, y = eigh(projected(V, images), subset_by_index=[0, width - 1])
        X = V @ y
        residual = images @ y - X * values
        W = old.apply(pencil, residual)
        left = float((np.abs(np.einsum("ij,ij->j", residual, W)[:count]) / values[:count]).max())
        if left > TOL and not seconds and (left > FAR or block > 1):
            old, seconds = factored(pencil, shift)
            W = old.apply(pencil, residual)
        W = W - V @ (V.T @ W)
        W = qr(W - V @ (V.T @ W), mode="economic")[0]
        V, images = np.hstack([V, W]), np.hstack([images, pencil.A @ W])
        if left <= TOL:
            break
    return V @ eigh(projected(V, images), subset_by_index=[0, width - 1])[1], old, block + 1, seconds


def counted(solution: Solution) -> Solution | None:
    """The solution with its Sturm count; None if the inertia finds modes that it does not have."""
    found = solution.modes
    if found.sturm_count is not None:
        return solution
    below, sigma = gap_after((2.0 * np.pi * solution.guard.freq) ** 2, len(found))
    if solution.pencil.count_below(sigma) != below:
        return None
    return replace(solution, modes=replace(found, sturm_count=below))


def projected(V: FloatArray, images: FloatArray) -> FloatArray:
    """V^T A V from A V, symmetric to the last bit."""
    H = V.T @ images
    return np.asarray(0.5 * (H + H.T))


def named(shell: Shell, system: System, found: RitzModes, count: int, seconds: dict[str, float]) -> Modes:
    """The first `count` modes with their labels."""
    return labelled(
        shell,
        system.grid,
        found.freq,
        found.fields,
        count=count,
        sturm=None,
        dofs=system.size,
        own=found.own,
        seconds=seconds,
    )
