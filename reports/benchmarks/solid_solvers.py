"""Solid solvers: shift-invert against LOBPCG with multigrid on thick and thin solids: time, memory, iterations.

`python -m reports.benchmarks.solid_solvers [--quick | --large] [--out DIR]` takes the first 10 modes of clamped blocks
and plates of quadratic hexahedra, 10,000 and 22,000 unknowns (--quick: 1,000; --large: 60,000 and 300,000 too, up to an
hour and 14 GB), and writes solid_solvers.csv. Each solver runs in a child process of its own, with 9 minutes and 14 GB;
the row of one that does not end states it, with the numbers it reached. Seconds are the processor's. Shift-invert is
split into the factor (setup), Lanczos steps by the vector, and the Sturm count, which is a factor more; its memory is
that of one factor. LOBPCG is split into the levels (setup) and iterations; its memory is that of the levels and of nine
blocks of vectors. "Peak" is all a child had, the matrices included. Here no count certifies LOBPCG.
"""

import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import gap_after
from casingfem.linalg.factor import factorise
from casingfem.linalg.fronts import planned
from casingfem.linalg.krylov import BLOCKS, ConvergenceError, nearest
from casingfem.linalg.multigrid import iterate, make_levels
from casingfem.linalg.pencil import Pencil, make_pencil
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.rotation import rigid_motions
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.solid import Solid, assemble_solid
from casingfem.structure.material import Material
from reports.benchmarks.child import Limits, Numbers, in_child
from reports.tables import Row, command_line, show, write

COUNT, EXTRA = 10, 4
BLOCKS_OF_VECTORS = 9  # X, its residuals and directions, each under A and B
SHIFT = 0.5
STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
NUMBERS = ("setup s", "solve s", "count s", "steps", "MB", "missed")
Case = tuple[tuple[int, int, int], tuple[float, float, float]]  # cells, size [m]

QUICK: dict[str, Case] = {"thick block": ((4, 4, 4), (1.0, 0.8, 0.6)), "thin plate": ((8, 6, 1), (1.0, 0.8, 0.004))}
FULL: dict[str, Case] = {
    "thick block": ((9, 9, 9), (1.0, 0.8, 0.6)),
    "plate, t/L 1/20": ((24, 20, 3), (1.0, 0.8, 0.05)),
}
LARGE: dict[str, Case] = {
    "thin plate, t/L 1/250": ((60, 45, 1), (1.0, 0.8, 0.004)),
    "thick block, 60,000": ((17, 17, 16), (1.0, 0.8, 0.6)),
    "thin plate, 300,000": ((130, 105, 1), (1.0, 0.8, 0.004)),
    "thick block, 300,000": ((29, 29, 28), (1.0, 0.8, 0.6)),
}


def block(counts: tuple[int, int, int], size: tuple[float, float, float]) -> MeshSystem:
    """A block of quadratic hexahedra, clamped at x = 0."""
    mesh = grid_mesh("hexahedron20", counts, lambda u: u * np.array(size), groups={"root": (0, 0.0)})
    return assemble_solid(Solid(mesh=mesh, material=STEEL, supports={"root": Clamped()}))


def direct(pencil: Pencil, shift: float) -> Iterator[Numbers]:
    """Shift-invert: the factor, the Lanczos vectors, the Sturm count."""
    started = time.process_time()
    factor = factorise(pencil.shifted(shift))
    yield {"setup s": time.process_time() - started, "MB": 1e-6 * planned(pencil.A).bytes(keep=True)}
    started = time.process_time()
    found = nearest(pencil, factor.solve, shift, COUNT + EXTRA, BLOCKS[0])
    values = np.sort(found.values)
    yield {"solve s": time.process_time() - started, "steps": found.products, "values": values[:COUNT]}
    del factor
    started = time.process_time()
    below, sigma = gap_after(values, COUNT, abs(shift))
    counted = pencil.count_below(sigma)
    yield {"count s": time.process_time() - started, "missed": counted - below}


def multigrid(pencil: Pencil, near_null: FloatArray, shift: float) -> Iterator[Numbers]:
    """LOBPCG: the levels, the iteration."""
    started = time.process_time()
    levels = make_levels(pencil, near_null, shift)
    vectors = 8 * BLOCKS_OF_VECTORS * (COUNT + EXTRA) * pencil.size
    yield {"setup s": time.process_time() - started, "MB": 1e-6 * (levels.bytes + vectors)}
    started = time.process_time()
    try:
        values, _, products = iterate(pencil, levels, COUNT + EXTRA, shift)
    except ConvergenceError:
        yield {"solve s": time.process_time() - started}
        raise
    yield {"solve s": time.process_time() - started, "steps": products // (COUNT + EXTRA), "values": values[:COUNT]}


def compare(name: str, case: Case, limits: Limits) -> list[Row]:
    """The rows of one solid: both solvers."""
    system = block(*case)
    shift = -((SHIFT * system.frequency_scale) ** 2)
    pencil = make_pencil(system.K, system.M)
    near_null = rigid_motions(system.points)[system.free]
    works = {"shift-invert": partial(direct, pencil, shift), "LOBPCG": partial(multigrid, pencil, near_null, shift)}
    rows: list[Row] = []
    exact = None
    for solver, work in works.items():
        outcome = in_child(work, limits)
        values = outcome.numbers.pop("values", None)
        exact = values if solver == "shift-invert" else exact
        rows.append(
            {"solid": name, "unknowns": system.size, "solver": solver}
            | {key: outcome.numbers.get(key) for key in NUMBERS}
            | {"peak MB": outcome.peak, "difference": difference(values, exact), "ended": outcome.ended}
        )
    return rows


def difference(values: object, exact: object) -> float | None:
    """Largest relative difference of frequencies, where both solvers have them."""
    if not isinstance(values, np.ndarray) or not isinstance(exact, np.ndarray):
        return None
    return float(np.abs(np.sqrt(values / exact) - 1.0).max())


def main(out: Path, quick: bool = False, large: bool = False) -> list[Row]:
    """Print the table and write it."""
    cases = QUICK if quick else FULL | (LARGE if large else {})
    rows = [row for name, case in cases.items() for row in compare(name, case, Limits())]
    show(f"First {COUNT} modes of solids", rows)
    write(out / "solid_solvers.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, large="add solids of 60,000 and 300,000 unknowns")
