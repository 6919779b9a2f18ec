"""Speed: time of each step of the chain in one run, as ratios to the assembly of the reference frustum.

`python -m reports.benchmarks [--quick] [--out DIR]` prints the table and writes speed.csv. Every figure is the best of
three on the same machine in the same run, in seconds of the processor; ratios change least with its load. The last
rows are microseconds per step of contact runs: finite element rods and modal bodies. --quick takes one of each.
"""

import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from time import process_time

import numpy as np

import contact as ct
from casingfem.linalg.eigen import solve_modes, sturm_count
from casingfem.linalg.factor import factorise
from casingfem.modal.harmonics import ring_content
from casingfem.modal.interface.kinds import Rim, Tip
from casingfem.modal.modes import modes
from casingfem.modal.reduction import reduce
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.chart import Plate
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell
from casingfem.updating.parameters import Parameter
from casingfem.updating.sensitivity import eigen_derivatives
from reports.benchmarks.core_limits import best
from reports.tables import Row, show, write
from reports.verification.modes.frustum import COUNT, reference_frustum

BAR = {"length": 10.0, "area": 1.0, "E": 900.0, "rho": 1.0, "x": 5.0}
SPARSE = ct.Record(every=1000)


def structure_tasks() -> Iterator[tuple[str, Callable[[], object]]]:
    """Steps of the structural chain on the reference frustum and its default mesh."""
    shell = reference_frustum()
    system = assemble(shell)
    found = modes(shell, COUNT, method="shell", system=system)
    yield "grid", lambda: make_grid(shell.chart, shell.mesh)
    yield f"assemble, {system.size} dofs", lambda: assemble(shell)
    yield "factor K", lambda: factorise(system.stiffness)
    yield "Sturm count", lambda: sturm_count(system.stiffness, system.mass, (2 * np.pi * 500.0) ** 2)
    yield f"{COUNT} modes", lambda: solve_modes(system.stiffness, system.mass, COUNT, shift=-1e5)
    yield "label", lambda: ring_content(shell.chart, system.grid, found.fields, n_max=40)
    yield f"{COUNT} modes, perfect casing by harmonics", lambda: modes(shell, COUNT, method="fourier")
    for method in ("free", "craig-bampton"):
        yield (
            f"reduce, {method}, rim to n = 20",
            lambda method=method: reduce(shell, Rim("top", n_max=20), modes=COUNT, method=method, system=system),
        )
    for name in ("material.E", "shell.thickness", "radius.p8.cos"):
        vary = [Parameter(name=name, lower=-1e15, upper=1e15)]
        yield f"sensitivity of {COUNT} modes to {name}", lambda vary=vary: eigen_derivatives(found, vary)


def contact_runs(folder: Path, quick: bool) -> Iterator[tuple[str, Callable[[], ct.Result]]]:
    """Contact runs whose cost is the step loop: a bar dropped on a wall again and again, a casing rubbed."""
    wall, count = ct.Wall(x=0.0), 20_000 if quick else 200_000
    for elements in (20, 100):
        bar = ct.Rod(**BAR, elements=elements, velocity=-10.0)
        t_end = count * 0.9 * 10.0 / 30.0 / elements
        yield (
            f"bar of {elements} elements on a wall",
            lambda bar=bar, t_end=t_end: ct.run([bar, wall], t_end=t_end, courant=0.9, gravity=10.0, record=SPARSE),
        )
    for law in ("forward", "averaged", "energy"):
        scheme = ct.ExactModal(law=law, modes=50)
        yield (
            f"bar of 50 modes on a wall, {law} law",
            lambda scheme=scheme: ct.run(
                [ct.Rod(**BAR), wall], t_end=count * 2e-3, dt=2e-3, gravity=10.0, scheme=scheme, record=SPARSE
            ),
        )
    rub = rubbed_casing(folder)
    for law in (ct.Unilateral(), ct.Coulomb(mu=0.3)):
        yield (
            f"blade on a turning casing of {COUNT} modes, {type(law).__name__}",
            lambda law=law: ct.run(rub, law=law, t_end=count * 1e-5, dt=1e-5, record=SPARSE),
        )


def rubbed_casing(folder: Path) -> ct.RotatingRim:
    """The reference frustum's rim around a small blade, touching from the start."""
    steel = Material(E=210e9, nu=0.3, rho=7800.0)
    blade = Shell(chart=Plate(length=0.1, width=0.04), thickness=4e-3, material=steel, supports={"root": Clamped()})
    casing = reduce(reference_frustum(), Rim("top", n_max=20), modes=COUNT, zeta=0.002)
    bodies = [
        ct.ModalBody.load(basis.save(folder / f"speed_{name}.npz"))
        for name, basis in (("casing", casing), ("blade", reduce(blade, Tip(), modes=6, zeta=0.002)))
    ]
    return ct.RotatingRim(*bodies, clearance=-1e-5, speed_hz=5.0)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    repeats = 1 if quick else 3
    seconds = {name: best(task, repeats, process_time) for name, task in structure_tasks()}
    unit = next(value for name, value in seconds.items() if name.startswith("assemble"))
    rows: list[Row] = [{"step": name, "seconds": s, "over assembly": s / unit} for name, s in seconds.items()]
    show(f"Structures, {os.cpu_count()} processors, best of {repeats}", rows)
    runs: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, run in contact_runs(Path(folder), quick):
            run()  # the first compiles
            result = run()
            runs.append({"run": name, "steps": result.steps, "us/step": 1e6 * result.seconds / result.steps})
    show("Contact, compiled step loops", runs)
    write(out / "speed.csv", rows)
    write(out / "speed_contact.csv", runs)
    return rows + runs
