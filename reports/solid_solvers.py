"""Solid solvers: shift-invert against LOBPCG with multigrid on thick and thin solids: time, memory, iterations.

`python -m reports.solid_solvers [--quick] [--out DIR]` takes the first 10 modes of clamped blocks and plates of
quadratic hexahedra, 10,000 to 70,000 unknowns (--quick: 1,000), and writes solid_solvers.csv. The environment variable
SOLID_SOLVERS=large adds 300,000 unknowns: minutes and gigabytes. A failure is shown, not hidden.
"""

import os
import time
from pathlib import Path

import numpy as np

from casingfem.modal.eigen import solve_modes
from casingfem.modal.krylov import ConvergenceError
from casingfem.modal.multigrid import iterate
from casingfem.modal.pencil import make_pencil
from casingfem.structure.factor import SuperLUFactor, factorise
from casingfem.structure.material import Material
from casingfem.structure.mesh_assembly import MeshSystem
from casingfem.structure.mesh_grid import grid_mesh
from casingfem.structure.rigid_body import rigid_motions
from casingfem.structure.solid import Solid, assemble_solid
from casingfem.structure.support import Clamped
from reports.tables import Row, command_line, show, write

COUNT, EXTRA = 10, 4
SHIFT = 0.5
STEEL = Material(E=210e9, nu=0.3, rho=7800.0)


def block(counts: tuple[int, int, int], size: tuple[float, float, float]) -> MeshSystem:
    """A block of quadratic hexahedra, clamped at x = 0."""
    mesh = grid_mesh("hexahedron20", counts, lambda u: u * np.array(size), groups={"root": (0, 0.0)})
    return assemble_solid(Solid(mesh=mesh, material=STEEL, supports={"root": Clamped()}))


def cases(quick: bool) -> dict[str, tuple[tuple[int, int, int], tuple[float, float, float]]]:
    """Name -> cells and size [m]."""
    if quick:
        return {"thick block": ((4, 4, 4), (1.0, 0.8, 0.6)), "thin plate": ((8, 6, 1), (1.0, 0.8, 0.004))}
    chosen = {
        "thick block, small": ((9, 9, 9), (1.0, 0.8, 0.6)),
        "thick block": ((17, 17, 16), (1.0, 0.8, 0.6)),
        "plate, t/L 1/20": ((24, 20, 3), (1.0, 0.8, 0.05)),
        "thin plate, t/L 1/250": ((60, 45, 1), (1.0, 0.8, 0.004)),
    }
    if os.environ.get("SOLID_SOLVERS") == "large":
        chosen["thick block, large"] = ((29, 29, 28), (1.0, 0.8, 0.6))
        chosen["thin plate, large"] = ((130, 105, 1), (1.0, 0.8, 0.004))
    return chosen


def factor_size(system: MeshSystem, shift: float) -> float:
    """Memory of the factor [MB]: values and row numbers of L and U."""
    factor = factorise(make_pencil(system.K, system.M).shifted(shift))
    return 12e-6 * factor.lu.nnz if isinstance(factor, SuperLUFactor) else float("nan")


def compare(name: str, system: MeshSystem) -> Row:
    """One row: both solvers on one solid."""
    shift = -((SHIFT * system.frequency_scale) ** 2)
    started = time.perf_counter()
    exact = solve_modes(system.K, system.M, COUNT, shift)
    direct = time.perf_counter() - started
    near_null = rigid_motions(system.points)[system.free]
    started = time.perf_counter()
    worst, steps, words = float("nan"), 0, "converged"
    try:
        values, _, products = iterate(make_pencil(system.K, system.M), near_null, COUNT + EXTRA, shift)
        worst = float(np.abs(np.sqrt(values[:COUNT] / exact.eigenvalues[:COUNT]) - 1.0).max())
        steps = products // (COUNT + EXTRA)
    except ConvergenceError as error:
        words = str(error)
    multigrid = time.perf_counter() - started
    return {
        "solid": name,
        "unknowns": system.size,
        "shift-invert s": direct,
        "factor MB": factor_size(system, shift),
        "LOBPCG s": multigrid,
        "LOBPCG over shift-invert": multigrid / direct,
        "iterations": steps,
        "worst difference": worst,
        "LOBPCG": words,
    }


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    rows = [compare(name, block(*case)) for name, case in cases(quick).items()]
    show(f"First {COUNT} modes of solids", rows)
    write(out / "solid_solvers.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
