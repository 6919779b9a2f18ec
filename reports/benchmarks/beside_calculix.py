"""40 modes of the reference frustum by CalculiX and by this package, one after the other in one run.

`python -m reports.benchmarks.beside_calculix [--quick] [--out DIR]` gives CalculiX a mesh of S8R, 160 x 24 with rows
graded towards both edges (--quick: 48 x 6), if `ccx` is installed, and this package its default mesh and a coarser one.
Times are processor seconds of one thread each, for reading, assembly and modes together. Errors are against 3-D
elasticity. Writes beside_calculix.csv.
"""

import os
import resource
import shutil
import tempfile
from pathlib import Path
from time import process_time

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.mesh.shell_mesh import ShellMesh
from reports.benchmarks.core_limits import best
from reports.tables import Row, command_line, show, write
from reports.verification.modes.calculix import eigenfrequencies, run
from reports.verification.modes.frustum import COUNT, exact_frequencies, reference_frustum

AROUND, ROWS = 160, 24
STEEP = 2.0  # how much finer than in the middle rows are at the edges: cosh^2 of it
SOLID = 21  # unknowns an element: it makes solids of shells, three nodes of a corner's and two of a middle's
COARSE = ShellMesh(order=7, rows=1, around=17)


def heights(rows: int) -> FloatArray:
    """Lines between rows, and the lines through their middles, from 0 to 1, (2 rows + 1,)."""
    lines = 0.5 * (1.0 + np.tanh(STEEP * np.linspace(-1.0, 1.0, rows + 1)) / np.tanh(STEEP))
    return np.sort(np.concatenate([lines, 0.5 * (lines[1:] + lines[:-1])]))


def deck(around: int, rows: int) -> str:
    """The CalculiX input: the frustum as quadratic shells with reduced integration, clamped at its base."""
    shell = reference_frustum()
    theta = np.pi * np.arange(2 * around) / around
    numbers = np.arange(1, 2 * around * (2 * rows + 1) + 1).reshape(2 * rows + 1, 2 * around)
    lines = ["*NODE"]
    for j, u in enumerate(heights(rows)):
        radius, z = 0.50 - 0.05 * u, 0.25 * u
        step = 2 if j % 2 else 1  # no node in the middle of an element
        for i in range(0, 2 * around, step):
            lines.append(f"{numbers[j, i]},{radius * np.cos(theta[i]):.12e},{radius * np.sin(theta[i]):.12e},{z:.12e}")
    lines.append("*ELEMENT,TYPE=S8R,ELSET=body")
    n = np.concatenate([numbers, numbers[:, :1]], axis=1)
    for e, (j, i) in enumerate(((j, i) for j in range(0, 2 * rows, 2) for i in range(0, 2 * around, 2)), 1):
        corners = n[j, i], n[j, i + 2], n[j + 2, i + 2], n[j + 2, i]
        middles = n[j, i + 1], n[j + 1, i + 2], n[j + 2, i + 1], n[j + 1, i]
        lines.append(",".join(map(str, (e, *corners, *middles))))
    lines += ["*NSET,NSET=base", *map(str, numbers[0].tolist())]
    m = shell.material
    return "\n".join(lines) + (
        f"\n*MATERIAL,NAME=M\n*ELASTIC\n{m.E!r},{m.nu!r}\n*DENSITY\n{m.rho!r}\n"
        f"*SHELL SECTION,ELSET=body,MATERIAL=M\n{shell.thickness!r}\n*BOUNDARY\nbase,1,6\n"
        f"*STEP\n*FREQUENCY\n{COUNT}\n*END STEP\n"
    )


def calculix_row(around: int, rows: int) -> Row:
    """Time and error of CalculiX, a row of the table."""
    name = f"CalculiX S8R {around} x {rows}"
    if shutil.which("ccx") is None:
        return {"code": name, "unknowns": None, "seconds": None, "worst error": None}
    os.environ["OMP_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        results = run(deck(around, rows), Path(folder))
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    found = np.array(eigenfrequencies(results))[:COUNT]
    return {"code": name, "unknowns": SOLID * around * rows, "seconds": seconds, "worst error": worst(found)}


def worst(freq: FloatArray) -> float:
    """The largest relative error."""
    return float(np.abs(freq / exact_frequencies() - 1.0).max())


def own_row(mesh: ShellMesh | None) -> Row:
    """Time and error of this package's two-dimensional shell, a row of the table."""
    shell = reference_frustum(mesh)
    found = modes(shell, COUNT, method="shell")
    seconds = best(lambda: modes(shell, COUNT, method="shell"), 3, process_time)
    name = f"casingfem, {'default mesh' if mesh is None else f'order {mesh.order}, one row, {mesh.around} around'}"
    return {"code": name, "unknowns": found.dofs, "seconds": seconds, "worst error": worst(found.freq)}


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    rows = [calculix_row(*((48, 6) if quick else (AROUND, ROWS))), own_row(COARSE), own_row(None)]
    show(f"{COUNT} modes of the reference frustum, one thread", rows)
    write(out / "beside_calculix.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
