"""Sturm: random small structures, modes returned against modes counted, in counts and in bands.

`python -m reports.verification.modes.sturm [--quick] [--out DIR]` draws 1,000 structures (30 with --quick): charts,
sizes, thickness, supports, fields, meshes down to absurdly coarse ones, free bodies and exact doublets among them. For
each it computes some modes and all modes of a band, and holds them against the dense eigenvalues of the same matrices:
a mode missed or invented shows. Free bodies must show six rigid motions, or a warning that the mesh is too coarse for
them. It prints failures by kind of structure and writes sturm.csv.
"""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import eigvalsh

from casingfem.errors import ModelWarning, NumericsError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.pencil import make_pencil
from casingfem.modal.mode_set import frequency_scale
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Support
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.geometry.blade import TwistedPlate
from casingfem.structure.geometry.chart import Chart, Cylinder, Frustum, Panel, Plate
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from reports.tables import Row, command_line, show, write

SEED = 2207
ROUND_OFF = 1e-12  # of the largest eigenvalue: what a dense solution knows


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """Outcome for one structure; `fault` is empty if there is none."""

    kind: str
    dofs: int
    free: bool
    doublets: int
    fault: str


def random_chart(rng: np.random.Generator) -> tuple[str, Chart, float]:
    """A kind, a chart and its size [m]."""
    size = float(10.0 ** rng.uniform(-2, 1))
    a, b = rng.uniform(0.3, 2.0, 2) * size
    twist = float(rng.uniform(-1.5, 1.5))
    kinds: list[tuple[str, Chart]] = [
        ("frustum", Frustum(r_base=size, r_top=float(rng.uniform(0.4, 1.5) * size), height=float(a))),
        ("cylinder", Cylinder(radius=size, height=float(a))),
        ("panel", Panel(radius=size, length=float(a), angle=float(rng.uniform(0.2, 3.0)))),
        ("plate", Plate(length=float(a), width=float(b))),
        ("twisted plate", TwistedPlate(length=float(a), width=float(b), twist=twist)),
        ("square plate", Plate(length=size, width=size)),
    ]
    kind, chart = kinds[rng.integers(len(kinds))]
    return kind, chart, size


def random_shell(rng: np.random.Generator) -> tuple[str, Shell]:
    """A small structure: one in four free, one casing in two perfect."""
    kind, chart, size = random_chart(rng)
    casing = chart.periodic
    supports: dict[str, Support] = {}
    if rng.random() > 0.25:
        for edge in rng.permutation(list(chart.edges))[: rng.integers(1, 3)]:
            stiffness = {name: float(10.0 ** rng.uniform(2, 12)) for name in ("k_r", "k_theta", "k_z")}
            choice: list[Support] = [Clamped(), ShearDiaphragm(), ElasticEdge(**stiffness)]
            supports[str(edge)] = choice[rng.integers(3)]
    around = int(rng.integers(3, 9)) if casing else int(rng.integers(1, 4))
    mesh = ShellMesh(order=int(rng.integers(3, 7)), rows=int(rng.integers(1, 3)), around=around)
    p = int(rng.integers(1, 5))
    waved = casing and rng.random() < 0.5
    return kind, Shell(
        chart=chart,
        thickness=float(size * 10.0 ** rng.uniform(-3.5, -1)),
        material=Material(E=210e9, nu=float(rng.uniform(0.0, 0.45)), rho=7800.0),
        supports=supports,
        radius_defect=FourierField.of({p: float(10.0 ** rng.uniform(-8, -2))}) if waved else None,
        mesh=mesh,
    )


def dense_values(system: System) -> FloatArray:
    """Every eigenvalue of the scaled problem, by a dense solver."""
    return np.asarray(eigvalsh(make_pencil(system.K, system.mass).A.toarray()))


def fault_of(system: System, count: int, place: float) -> tuple[int, str]:
    """Doublets among the first modes, and what is wrong with a count and a band of one structure."""
    shell, exact = system.shell, dense_values(system)
    noise = ROUND_OFF * exact[-1]
    try:
        with warnings.catch_warnings(record=True) as doubts:
            warnings.simplefilter("always")
            found = modes(shell, count, method="shell", system=system)
            top = max(float(found.freq[-1]), frequency_scale(shell) / (2.0 * np.pi))
            band = modes(shell, band=(place * top, 1.1 * top), method="shell", system=system)
        doubted = any(isinstance(doubt.message, ModelWarning) for doubt in doubts)
    except NumericsError as error:
        return 0, str(error)
    off = np.abs(found.omega**2 - np.maximum(exact[: len(found)], 0.0)) > noise + 1e-6 * found.omega**2
    low, high = ((2.0 * np.pi * f) ** 2 for f in (place * top, 1.1 * top))
    slack = [noise + 1e-6 * end for end in (low, high)]
    least = np.count_nonzero((exact > low + slack[0]) & (exact < high - slack[1]))
    most = np.count_nonzero((exact > low - slack[0]) & (exact < high + slack[1]))
    checks = {
        f"{len(found)} modes, {count} asked for": len(found) == count,
        f"{found.sturm_count} counted, {len(found)} returned": found.sturm_count >= count,
        f"{np.count_nonzero(off)} values are not the dense ones": not np.any(off),
        f"{len(band)} in a band of {least} to {most}": least <= len(band) == band.sturm_count <= most,
        f"{found.rigid} rigid motions of a free body": bool(shell.supports) or doubted or found.rigid == min(6, count),
    }
    return len(found.doublets), "; ".join(name for name, well in checks.items() if not well)


def outcome(k: int) -> Outcome:
    """Draw structure k and compare its modes."""
    rng = np.random.default_rng([SEED, k])
    kind, shell = random_shell(rng)
    system = assemble(shell)
    count = int(min(rng.integers(1, 40), system.size // 3))
    doublets, fault = fault_of(system, count, float(rng.uniform(0.2, 0.95)))
    if fault:
        print(f"structure {k}: {fault}: {shell}")
    return Outcome(kind=kind, dofs=system.size, free=not shell.supports, doublets=doublets, fault=fault)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    every = [outcome(k) for k in range(30 if quick else 1000)]
    rows: list[Row] = []
    for kind in sorted({o.kind for o in every}):
        part = [o for o in every if o.kind == kind]
        rows.append(
            {
                "structure": kind,
                "drawn": len(part),
                "free": sum(o.free for o in part),
                "dofs": f"{min(o.dofs for o in part)} to {max(o.dofs for o in part)}",
                "doublets": sum(o.doublets for o in part),
                "faults": sum(bool(o.fault) for o in part),
            }
        )
    show("Modes returned against modes counted, and against dense eigenvalues", rows)
    print(f"{len(every)} structures, {sum(bool(o.fault) for o in every)} faults")
    write(out / "sturm.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
