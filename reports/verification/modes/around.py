"""Default meshes: error and time on structures of each kind; other meshes for a frustum with waves in its radius.

`python -m reports.verification.modes.around [--quick] [--out DIR]` prints two tables.

defaults.csv: the default mesh of each structure, the two-dimensional shell. "error" is the largest relative one of 40
frequencies (a blade's 10) against order 10 with rows of a third to a half and 1.35 times the nodes around, across a
blade columns of a third to a half. "seconds" is processor time of these modes, the least of two runs.

around.csv: the frustum of data/studies/frustum.toml, whose radius has 8, 20 and 4 waves with the common period 4. A
pair of n nodal diameters with odd n must stay double. The table has meshes of several orders and numbers of elements
around. "error" is against order 9 with 61 elements around and four times the rows. "forbidden" is the largest relative
split of odd pairs. "turned" is the largest change of a frequency when the waves are turned by 0.4567 and 2 rad. "time"
is processor time over that of the default mesh, in turns.

--quick takes two structures and two meshes, and no errors of the latter.
"""

import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import Modes, modes
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.edge.support import Clamped
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.mesh.shell_mesh import ShellMesh, break_points
from casingfem.structure.shell.shell import Shell
from casingfem.study.load import load_study
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.modes.frustum import COUNT, reference_frustum
from reports.verification.modes.meridians import CASINGS, WALL, chart_shell
from reports.verification.modes.stiffeners import CASINGS as STIFFENED
from reports.verification.modes.stiffeners import stiffened

WAVES = FourierField.of({8: 0.004, 20: 0.003, 4: (0.0019, 0.0006)})
PERIOD = 4
ANGLES = (0.4567, 2.0)  # rad
MILD = FourierField.of({4: 0.002, 9: 0.001})
MESHES = ((8, 29), (8, 25), (8, 28), (8, 32), (7, 28), (7, 33), (7, 41), (9, 24))  # order, around; first the default
QUICK = ((7, 33), (7, 28))
FEW = 10  # modes of a plate or a blade


def structures() -> Iterator[tuple[str, Shell]]:
    """Structures of each kind with a default mesh, by name."""
    plain = replace(reference_frustum(), mesh=None)
    clamped = {"base": Clamped(), "top": Clamped()}
    ring = {"base": Clamped(), "top": Ring(section=Section.rectangle(width=0.02, depth=0.01))}
    cylinder = replace(plain, chart=Cylinder(radius=0.3, height=1.5), mesh=None)
    yield "perfect frustum", plain
    yield "frustum, both edges clamped", replace(plain, supports=clamped, mesh=None)
    yield "frustum, ring on its top", replace(plain, supports=ring, mesh=None)
    yield "long cylinder", cylinder
    yield "cos 8 theta in the radius", replace(plain, radius_defect=FourierField.of({8: 0.004}), mesh=None)
    yield "8, 20 and 4 waves in the radius", replace(plain, radius_defect=WAVES, mesh=None)
    for name in ("mistuning", "rig_casing", "tapered_blade", "rotating_blade", "olson_lindberg"):
        yield name, replace(study_shell(name), mesh=None)
    pieces, walls = CASINGS["the same, cone of 5 mm"]
    yield "cylinder and thicker cone, waves", replace(chart_shell(pieces, walls, WALL), radius_defect=MILD, mesh=None)
    parts, rings = next(iter(STIFFENED.values()))
    yield "two stiffeners, waves", replace(stiffened(parts, rings), radius_defect=MILD, mesh=None)


def study_shell(name: str) -> Shell:
    """The shell of a study in data/studies."""
    found = load_study(DATA / "studies" / f"{name}.toml").start
    assert isinstance(found, Shell)
    return found


def refined(mesh: ShellMesh, periodic: bool) -> ShellMesh:
    """Order 10 on narrower rows; across an open chart on narrower columns, around a casing with more nodes."""
    rows = narrower(mesh.breaks)
    if not periodic:
        return ShellMesh(order=10, rows=rows, around=narrower(break_points(mesh.around)))
    around = int(1.35 * mesh.columns * mesh.order / 10.0)
    return ShellMesh(order=10, rows=rows, around=2 * (around // 2) + 1)


def narrower(breaks: FloatArray) -> tuple[float, ...]:
    """Break points of parts of a third to a half."""
    parts = [np.linspace(a, b, 4 if b - a > 0.1 else 3)[:-1] for a, b in pairwise(breaks.tolist())]
    return (*np.concatenate(parts).tolist(), 1.0)


def default_row(name: str, shell: Shell) -> Row:
    """Error and time of a structure's default mesh."""
    count = COUNT if shell.chart.periodic else FEW
    exact, _ = solved(replace(shell, mesh=refined(shell.mesh, shell.chart.periodic)), count)
    (found, first), (_, second) = solved(shell, count), solved(shell, count)
    mesh = shell.mesh
    return {
        "structure": name, "order": mesh.order, "rows": len(mesh.breaks) - 1, "around": mesh.columns,
        "unknowns": found.dofs, "error": float(np.abs(found.freq[:count] / exact.freq[:count] - 1.0).max()),
        "seconds": min(first, second),
    }  # fmt: skip


def wavy(order: int, around: int, rows: Iterable[float], field: FourierField = WAVES) -> Shell:
    """The frustum with waves in its radius on a mesh."""
    mesh = ShellMesh(order=order, rows=tuple(rows), around=around)
    return replace(reference_frustum(), radius_defect=field, mesh=mesh)


def solved(shell: Shell, count: int = COUNT) -> tuple[Modes, float]:
    """Modes, and the processor time they take [s]."""
    begun = time.process_time()
    found = modes(shell, count, method="shell")
    return found, time.process_time() - begun


def finest(rows: FloatArray) -> FloatArray:
    """Frequencies of the finest mesh [Hz]."""
    inner = np.concatenate([np.linspace(low, high, 5)[:-1] for low, high in pairwise(rows.tolist())])
    return modes(wavy(9, 61, [*inner.tolist(), 1.0]), COUNT, method="shell").freq


def row_of(order: int, around: int, rows: FloatArray, default: ShellMesh, exact: FloatArray | None) -> Row:
    """A row of the table."""
    spent: list[tuple[float, float]] = []
    for _ in range(2):
        found, mine = solved(wavy(order, around, rows))
        spent.append((mine, solved(wavy(default.order, default.around, rows))[1]))
    turned = [modes(wavy(order, around, rows, WAVES.rotated(angle)), COUNT, method="shell").freq for angle in ANGLES]
    odd = np.array([2 * found.nodal_diameters[low] % PERIOD != 0 for low, _ in found.doublets])
    return {
        "order": order, "around": around, "unknowns": found.dofs,
        "error": None if exact is None else float(np.abs(found.freq / exact - 1.0).max()),
        "forbidden": float(found.splits[odd].max()), "allowed": float(found.splits[~odd].max()),
        "turned": max(float(np.abs(freq / found.freq - 1.0).max()) for freq in turned),
        "time": min(mine for mine, _ in spent) / min(theirs for _, theirs in spent),
    }  # fmt: skip


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print both tables and write them; returns the rows of both."""
    chosen = [shell for k, shell in enumerate(structures()) if k < 2 or not quick]
    defaults = [default_row(name, shell) for name, shell in chosen]
    show("Default meshes of the two-dimensional shell", defaults)
    write(out / "defaults.csv", defaults)
    plain = reference_frustum()
    default = replace(plain, radius_defect=WAVES, mesh=None).mesh
    exact = None if quick else finest(default.breaks)
    rows = [row_of(order, around, default.breaks, default, exact) for order, around in (QUICK if quick else MESHES)]
    show(f"Frustum with 8, 20 and 4 waves; default: order {default.order}, {default.around} around", rows)
    write(out / "around.csv", rows)
    return [*defaults, *rows]


if __name__ == "__main__":
    command_line(__doc__, main)
