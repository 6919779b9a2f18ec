"""Modes of a neighbour: a block Krylov space grown from modes already known, instead of from nothing.

With S = (K - s M)^-1 M of the new structure and X the old modes, a few more than wanted, the space is
span[X, S X, ..., S^k X]; Rayleigh-Ritz on it gives the modes, one inertia certifies that none is missing. Plain
subspace iteration keeps S^k X alone: at the same number of solves its worst frequency is hundreds of times less
accurate (`python -m reports.modes.mistuning`).
"""

import time

import numpy as np
from scipy.linalg import eigh, qr

from casingfem.errors import NumericsError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import gap_after
from casingfem.linalg.factor import factorise
from casingfem.linalg.pencil import Pencil, make_pencil
from casingfem.modal.mode_set import Modes, labelled
from casingfem.modal.modes import ritz_modes
from casingfem.modal.neighbour import shift_of
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell

STEPS = 3  # block steps: worst frequency right to 1e-7, with two to 1e-5 for a tenth less (reports.modes.mistuning)
EXTRA = 4  # Ritz values beyond `count`, so that the count ends in a gap


def guarded(count: int) -> int:
    """How many known modes to start from for `count` new ones: half as many again."""
    return count + max(8, count // 2)


def restarted_modes(shell: Shell, known: Modes, count: int, *, steps: int = STEPS) -> Modes:
    """Lowest `count` modes of a shell from the modes of a similar one on the same mesh, complete by a Sturm count.

    Parameters
    ----------
    shell
        The new structure.
    known
        Modes of the similar one, `guarded(count)` of them or more.
    count, steps
        Modes wanted; block steps k.

    Raises
    ------
    ValueError
        If the meshes differ, or too few modes are known.
    NumericsError
        If the inertia finds a mode that the space does not hold.
    """
    if known.shell.mesh != shell.mesh or len(known) < count + EXTRA:
        raise ValueError(f"a restart of {count} modes needs {count + EXTRA} or more, of a shell on the same mesh")
    started = time.perf_counter()
    system = assemble(shell)
    assembled = time.perf_counter()
    pencil = make_pencil(system.stiffness, system.mass)
    start = system.collect(known.fields, known.own) / pencil.scale[:, None]
    values, vectors = krylov_modes(pencil, start, shift_of(shell), steps)
    below, sigma = gap_after(values[: count + EXTRA], count)
    certified = pencil.count_below(sigma)
    if certified != below:
        raise NumericsError(f"{certified} modes lie below {np.sqrt(sigma) / 2 / np.pi:.6g} Hz, {below} were found")
    ritz = ritz_modes(system, pencil.scale[:, None] * vectors[:, :below])
    seconds = {"assemble": assembled - started, "solve": time.perf_counter() - assembled}
    return labelled(shell, system.grid, *ritz, count=count, sturm=certified, dofs=system.size, seconds=seconds)


def krylov_modes(pencil: Pencil, start: FloatArray, shift: float, steps: int) -> tuple[FloatArray, FloatArray]:
    """Ritz values [rad^2/s^2] and B-orthonormal vectors of the block Krylov space of `start` (free, columns)."""
    factor = factorise(pencil.shifted(shift))
    blocks = [qr(start, mode="economic")[0]]
    for _ in range(steps):
        blocks.append(qr(factor.solve(pencil.weigh(blocks[-1])), mode="economic")[0])
    V = qr(np.concatenate(blocks, axis=1), mode="economic")[0]
    H, G = V.T @ (pencil.A @ V), V.T @ pencil.weigh(V)
    wanted = [0, start.shape[1] - 1]
    values, y = eigh(0.5 * (H + H.T), 0.5 * (G + G.T), subset_by_index=wanted)
    return values, V @ y
