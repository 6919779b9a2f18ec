"""Growth: 40 modes of the reference frustum on finer and finer meshes: seconds, memory, share of the machine's dgemm.

`python -m reports.benchmarks.growth [--quick | --large] [--out DIR]` takes meshes of order 7 with 10,000 to 200,000
unknowns (--quick: 4,000; --large: 500,000 and a million too) and writes growth.csv. Each mesh has a child process with
limits of 25 minutes and 14 GB; its row states whether it ended. Times are processor seconds (of one thread if
OPENBLAS_NUM_THREADS=1) of assembly, of plan and factor of K - sigma M, and of the whole of `modes`. "GF/s" counts the
factor's multiplications and additions, "of dgemm" sets them against a product of two dense matrices of 1,500 rows.
"Leaf unknowns" and "leaf work" are the shares of the factor's first fronts: the interiors of elements, most of them.
"Factor MB" is the plan's estimate, "peak MB" the largest memory of the child.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from casingfem.linalg.fronts import planned
from casingfem.linalg.multifrontal import factored
from casingfem.linalg.pencil import make_pencil
from casingfem.modal.fourier import SHIFT
from casingfem.modal.mode_set import frequency_scale
from casingfem.modal.modes import modes
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.assembly import assemble
from reports.benchmarks.child import Limits, Numbers, in_child
from reports.benchmarks.core_limits import best
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import COUNT, reference_frustum

ORDER, DENSE = 7, 1500
QUICK = ((1, 16),)
FULL = ((2, 21), (4, 50), (7, 59), (10, 83))  # rows, elements around
LARGE = ((16, 127), (23, 178))
COLUMNS = ("assemble s", "plan s", "factor s", "modes s", "GF/s", "of dgemm", "leaf unknowns", "leaf work",
           "factor MB", "counted")  # fmt: skip


def dense_rate() -> float:
    """Multiplications and additions of a dense product in a second."""
    A = np.random.default_rng(23).random((DENSE, DENSE))
    return 2.0 * DENSE**3 / best(lambda: A @ A, 5, process_time)


def solution(rows: int, around: int) -> Iterator[Numbers]:
    """The steps of one mesh, then the whole."""
    shell = reference_frustum(ShellMesh(order=ORDER, rows=rows, around=around))
    times = [process_time()]
    system = assemble(shell)
    times.append(process_time())
    yield {"unknowns": system.size, "assemble s": times[1] - times[0]}
    pencil = make_pencil(system.stiffness, system.mass)
    A = pencil.shifted(-((SHIFT * frequency_scale(shell)) ** 2))
    times.append(process_time())
    fronts = planned(A)
    times.append(process_time())
    factored(A, fronts)
    times.append(process_time())
    plan, factor = np.diff(times)[2:]
    rate = fronts.operations / factor
    yield {"plan s": plan, "factor s": factor, "GF/s": 1e-9 * rate, "of dgemm": rate / dense_rate()}
    first = replace(fronts, fronts=tuple(front for front in fronts.fronts if not front.children))
    yield {
        "leaf unknowns": sum(front.pivots for front in first.fronts) / system.size,
        "leaf work": first.operations / fronts.operations,
        "factor MB": 1e-6 * fronts.bytes(keep=True),
    }
    del first, fronts, A, pencil, system
    started = process_time()
    found = modes(shell, COUNT, method="shell")
    yield {"modes s": process_time() - started, "counted": found.sturm_count}


def row(case: tuple[int, int]) -> Row:
    """Times and memory of one mesh."""
    outcome = in_child(partial(solution, *case), Limits(seconds=1500.0))
    numbers = {name: outcome.numbers.get(name) for name in ("unknowns", *COLUMNS)}
    return {"rows x around": f"{case[0]} x {case[1]}", **numbers, "peak MB": outcome.peak, "ended": outcome.ended}


def main(out: Path, quick: bool = False, large: bool = False) -> list[Row]:
    """Print the table and write it."""
    rows = [row(case) for case in (QUICK if quick else FULL + (LARGE if large else ()))]
    show(f"{COUNT} modes of the reference frustum, order {ORDER}", rows)
    write(out / "growth.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, large="add a mesh of 500,000 unknowns")
