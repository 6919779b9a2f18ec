"""Modal speed: error against time over meshes and orders, and the time of each part of a solution.

`python -m reports.benchmarks.modal [--quick] [--out DIR]` takes the first 40 modes of the reference frustum: by the
two-dimensional shell on several meshes, perfect and with cos 8 theta of 0.2 % in the radius, with strong waves 8, 20
and 4 in the radius on the coarsest meshes right to 1e-3 and the default one, and 13 harmonics by three modes. Errors
are against 3-D elasticity (perfect) or the finest mesh (imperfect). The parts of a solution are timed in the same run,
and so is ARPACK on the same factor, one vector at a time. Seconds are the processor's. Writes modal_speed.csv and
modal_parts.csv.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
from scipy.sparse.linalg import LinearOperator, eigsh

from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import factorise
from casingfem.linalg.krylov import BLOCKS, START_SEED, nearest
from casingfem.linalg.pencil import make_pencil
from casingfem.modal.fourier import SHIFT, lowest
from casingfem.modal.mode_set import frequency_scale
from casingfem.modal.modes import modes
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.mesh.shell_mesh import ShellMesh, make_grid
from casingfem.structure.shell.assembly import assemble, element_matrices
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.benchmarks.core_limits import best
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import COUNT, GRADED, REFERENCE, exact_frequencies, reference_frustum
from reports.verification.wall import STRONG

MESHES = {
    "6, one row, 21": ShellMesh(order=6, rows=1, around=21),
    "7, one row, 17": ShellMesh(order=7, rows=1, around=17),
    "8, one row, 17": ShellMesh(order=8, rows=1, around=17),
    "6, graded, 17": ShellMesh(order=6, rows=GRADED, around=17),
    "7, graded, 15": ShellMesh(order=7, rows=GRADED, around=15),
    "7, graded, 21": ShellMesh(order=7, rows=GRADED, around=21),
    "8, graded, 17": ShellMesh(order=8, rows=GRADED, around=17),  # the default
}
FINE = ShellMesh(order=10, rows=GRADED, around=23)
STRONG_MESHES = {
    "8, one row, 25": ShellMesh(order=8, rows=1, around=25),
    "9, one row, 19": ShellMesh(order=9, rows=1, around=19),
    "7, graded, 41": ShellMesh(order=7, rows=GRADED, around=41),
    "8, graded, 29": ShellMesh(order=8, rows=GRADED, around=29),  # the default
}
STRONG_FINE = ShellMesh(order=10, rows=GRADED, around=41)
HARMONICS, EACH = range(4, 17), 3


def mesh_rows(quick: bool) -> list[Row]:
    """Error and time of each mesh, perfect and imperfect."""
    frustum = reference_frustum()
    cases: list[tuple[str, Shell, FloatArray, dict[str, ShellMesh]]] = [
        ("perfect", frustum, exact_frequencies(), MESHES)
    ]
    if not quick:
        for name, field, fine, meshes in (
            ("cos 8 theta", FourierField.of({8: 0.002}), FINE, MESHES), ("strong", STRONG, STRONG_FINE, STRONG_MESHES)
        ):  # fmt: skip
            imperfect = replace(frustum, radius_defect=field, mesh=fine)
            cases.append((name, imperfect, modes(imperfect, COUNT).freq, meshes))
    rows: list[Row] = []
    for name, shell, exact, meshes in cases:
        for mesh_name, mesh in list(meshes.items())[: 2 if quick else None]:
            meshed = replace(shell, mesh=mesh)
            found = modes(meshed, COUNT, method="shell")
            seconds = best(lambda meshed=meshed: modes(meshed, COUNT, method="shell"), 1 if quick else 3, process_time)
            rows.append({"frustum": name, "order, rows, around": mesh_name, "dofs": found.dofs, "seconds": seconds,
                         "worst error": float(np.abs(found.freq / exact - 1.0).max()),
                         "sturm": found.sturm_count})  # fmt: skip
    return rows


def harmonic_row() -> Row:
    """13 harmonics, three modes each, against the table's 3-D columns."""
    table = pd.read_csv(REFERENCE, comment="#").set_index("n")
    shell = reference_frustum()
    shift = (SHIFT * frequency_scale(shell)) ** 2
    started = process_time()
    found = np.array([lowest(harmonic_matrices(shell, n), EACH, shift)[0] for n in HARMONICS])
    seconds = process_time() - started
    exact = table.loc[list(HARMONICS), [f"f{m}_3d" for m in range(1, EACH + 1)]].to_numpy()
    error = float(np.nanmax(np.abs(np.sqrt(found) / (2.0 * np.pi) / exact - 1.0)))
    return {"frustum": "perfect", "order, rows, around": "13 harmonics x 3", "dofs": None, "seconds": seconds,
            "worst error": error, "sturm": None}  # fmt: skip


def part_rows(quick: bool) -> list[Row]:
    """Shares of each part in the time of one solution on the default mesh."""
    shell, repeats = reference_frustum(MESHES["6, one row, 21"] if quick else None), 1 if quick else 3
    grid, system = make_grid(shell.chart, shell.mesh), assemble(shell)
    shift = -((SHIFT * frequency_scale(shell)) ** 2)
    pencil = make_pencil(system.stiffness, system.mass)
    factor, wanted = factorise(pencil.shifted(shift)), COUNT + 4
    start = np.random.default_rng(START_SEED).standard_normal(system.size)
    inverse = LinearOperator(pencil.A.shape, matvec=factor.solve, dtype=float)
    parts: dict[str, Callable[[], object]] = {
        "whole": lambda: modes(shell, COUNT, method="shell"),
        "element matrices": lambda: element_matrices(shell, grid),
        "assembly, elements included": lambda: assemble(shell),
        "factor": lambda: factorise(pencil.shifted(shift)),
        "block Lanczos": lambda: nearest(pencil, factor.solve, shift, wanted),
        "Sturm count": lambda: pencil.count_below(1e7),
        "instead: ARPACK": lambda: eigsh(pencil.A, wanted, sigma=shift, OPinv=inverse, v0=start),
        **{f"instead: blocks of {b}": lambda b=b: nearest(pencil, factor.solve, shift, wanted, b) for b in (2, 4, 16)},
    }
    seconds = {name: best(task, repeats, process_time) for name, task in parts.items()}
    return [{"part": name, "seconds": s, "of the whole": s / seconds["whole"]} for name, s in seconds.items()]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print both tables and write them."""
    rows, parts = [*mesh_rows(quick), harmonic_row()], part_rows(quick)
    show(f"Reference frustum, {COUNT} modes", rows)
    show(f"Where the time goes; blocks are of {BLOCKS[0]}", parts)
    write(out / "modal_speed.csv", rows)
    write(out / "modal_parts.csv", parts)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
