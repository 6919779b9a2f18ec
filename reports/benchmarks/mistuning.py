"""Restarts from the mean casing's modes against solutions from nothing: what accuracy costs.

`python -m reports.benchmarks.mistuning [--quick] [--out DIR]`. The reference frustum with radius defects by the example
spectrum (31 harmonics), 40 modes. Each row is one way to the modes of a draw: block steps k, and
what is kept of them: the whole Krylov space, or its last block (subspace iteration). Errors are the worst over modes
and draws, against shift-invert from nothing; seconds are of the processor, assembly and the Sturm count included.
"""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.linalg import eigh, qr

from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import factorise
from casingfem.linalg.pencil import make_pencil
from casingfem.modal.fourier import SHIFT
from casingfem.modal.mistuning import mean_modes, redrawn_shell
from casingfem.modal.mode_set import Modes, frequency_scale
from casingfem.modal.modes import modes
from casingfem.modal.neighbour import restarted_modes
from casingfem.structure.field.random import RandomField
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import reference_frustum

COUNT = 40
COARSE = ShellMesh(order=6, rows=1, around=17)


def casing(quick: bool) -> Shell:
    """The reference frustum with a random radius, on its default mesh or a coarse one."""
    field = RandomField.example(thickness=3e-3, radius=0.475, seed=7, p_max=16 if quick else 32)
    mesh = COARSE if quick else None
    return replace(reference_frustum(), radius_defect=field, mesh=mesh)


def subspace(shell: Shell, known: Modes, count: int, steps: int) -> FloatArray:
    """Frequencies [Hz] by plain subspace iteration: the last block alone."""
    system = assemble(shell)
    pencil = make_pencil(system.stiffness, system.mass)
    factor = factorise(pencil.shifted(-((SHIFT * frequency_scale(shell)) ** 2)))
    V = qr(system.restrict(known.fields) / pencil.scale[:, None], mode="economic")[0]
    for _ in range(steps):
        V = qr(factor.solve(V), mode="economic")[0]
    H = V.T @ (pencil.A @ V)
    pencil.count_below(1.0)  # the price of the certificate
    return np.asarray(np.sqrt(eigh(0.5 * (H + H.T), eigvals_only=True)[:count]) / (2.0 * np.pi))


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the rows and write them."""
    shell, count, draws = casing(quick), 12 if quick else COUNT, range(1, 3 if quick else 11)
    started = time.process_time()
    exact = [modes(redrawn_shell(shell, draw), count).freq for draw in draws]
    whole = time.process_time() - started
    known = mean_modes(shell, count)
    rows: list[Row] = []
    for space in ("Krylov", "subspace"):
        for steps in (1, 2, 3):
            started = time.process_time()
            shells = [redrawn_shell(shell, draw) for draw in draws]
            if space == "Krylov":
                found = [certified(drawn, known, count, steps) for drawn in shells]
            else:
                found = [subspace(drawn, known, count, steps) for drawn in shells]
            seconds = time.process_time() - started
            error = np.abs(np.array(found) / np.array(exact) - 1.0)
            rows.append(
                {
                    "space": space,
                    "block steps": steps,
                    "seconds": seconds,
                    "over from nothing": seconds / whole,
                    "worst error": float(error.max()),
                    "median error": float(np.median(error)),
                }
            )
    show(
        f"{count} modes of {len(draws)} draws, {known.dofs} unknowns; from nothing {whole:.3g} s",
        rows,
    )
    write(out / "mistuning.csv", rows)
    return rows


def certified(shell: Shell, known: Modes, count: int, steps: int) -> FloatArray:
    """Frequencies [Hz] by the restart as it is used."""
    return restarted_modes(shell, known, count, steps=steps).freq


if __name__ == "__main__":
    command_line(__doc__, main)
