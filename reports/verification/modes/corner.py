"""A casing of cylinder and cone in four ways: chart of two pieces, imported shell, imported solid, CalculiX's S8R.

`python -m reports.verification.modes.corner [--quick] [--out DIR]` prints one table and writes corner.csv: how far the
40 lowest frequencies of each model are from those of the finer solid, for corners of 30 and 60 degrees. The chart has a
fillet of the wall's thickness, or half of it, at the corner. The others have a sharp one: imported shells are narrow
sectors of nine-noded quadrilaterals, with the curved and with the linear wall; solids sectors of 27-noded bricks mitred
at the corner; CalculiX, where it is installed, has 96 x 65 shells of eight nodes on the whole casing. All are clamped
at the base. --quick takes the first casing, 12 modes, coarser meshes and no CalculiX.
"""

import shutil
import tempfile
import time
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.cyclic.modes import CyclicModes, cyclic_modes
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.pieces import Piece
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.grid import Placing, grid_mesh
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from reports.tables import Row, command_line, show, write
from reports.verification.modes.calculix import eigenfrequencies, mesh_deck, run
from reports.verification.modes.meridians import STEEL, WALL, chart_shell

COUNT, HIGHEST, OF_EACH = 40, 14, 3  # modes compared; nodal diameters solved for, modes of each
BASE, CORNER = (0.3, 0.0), (0.3, 0.15)
TOPS = {30: (0.3 - 0.15 * 3**-0.5, 0.30), 60: (0.2, 0.15 + 0.1 * 3**-0.5)}  # degrees -> (r, z)


def mitred(top: tuple[float, float], rows: int, sectors: float, *, solid: bool) -> tuple[Placing, int]:
    """Unit coordinates (through the wall, around, along) -> positions; and how many of the rows are the cone's."""
    points = np.array([BASE, CORNER, top])
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    normals = np.stack([steps[:, 1], -steps[:, 0]], axis=1) / lengths[:, None]
    both = normals.sum(axis=0) / (1.0 + normals[0] @ normals[1])
    away = WALL * np.stack([normals[0], both, normals[1]])
    cone = max(1, round(rows * lengths[1] / lengths[0]))

    def place(u: FloatArray) -> FloatArray:
        through = u[:, 0] - 0.5 if solid else np.zeros(len(u))
        row = u[:, -1] * (rows + cone)
        s = np.where(row <= rows, row / rows, 1.0 + (row - rows) / cone)
        theta = 2.0 * np.pi / sectors * u[:, -2]
        r, z = (np.interp(s, range(3), points[:, k]) + through * np.interp(s, range(3), away[:, k]) for k in range(2))
        return np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=1)

    return place, cone


def shell_sector(top: tuple[float, float], rows: int, wall: str) -> CyclicSector:
    """A sixtieth of the casing as an imported shell; the cylinder has so many rows."""
    place, cone = mitred(top, rows, 60, solid=False)
    mesh = grid_mesh("quad9", (2, rows + cone), place, groups={"base": (1, 0.0)})
    part = MeshShell(mesh=mesh, thickness=WALL, material=STEEL, wall=wall, supports={"base": Clamped()})
    return CyclicSector(structure=part, sectors=60)


def solid_sector(top: tuple[float, float], rows: int) -> CyclicSector:
    """One four-hundredth of the casing as an imported solid."""
    place, cone = mitred(top, rows, 400, solid=True)
    mesh = grid_mesh("hexahedron27", (2, 1, rows + cone), place, groups={"base": (2, 0.0)})
    return CyclicSector(structure=Solid(mesh=mesh, material=STEEL, supports={"base": Clamped()}), sectors=400)


def whole_shell(top: tuple[float, float], rows: int = 30, around: int = 96) -> MeshData:
    """The whole casing of eight-noded quadrilaterals."""
    place, cone = mitred(top, rows, 1, solid=False)
    return grid_mesh("quad8", (around, rows + cone), place, groups={"base": (1, 0.0)}, wrap=0)


def by_calculix(mesh: MeshData, count: int) -> FloatArray:
    """Frequencies [Hz] of a mesh of S8R."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = mesh_deck(mesh, STEEL, folder) + (
            f"*SHELL SECTION,ELSET=body,MATERIAL=M\n{WALL!r}\n*BOUNDARY\nbase,1,6\n"
            f"*STEP\n*FREQUENCY\n{count}\n*END STEP\n"
        )
        return np.array(eigenfrequencies(run(text, folder)))


def lowest(found: CyclicModes, count: int) -> FloatArray:
    """The lowest frequencies of a wheel [Hz], pairs twice."""
    freq = np.repeat(found.freq, np.where(found.nodal_diameters == 0, 1, 2))
    return np.sort(freq)[:count]


def models(top: tuple[float, float], quick: bool) -> dict[str, FloatArray]:
    """Lowest frequencies [Hz] of each model, that of the finest solid first; seconds are printed by `main`."""
    count, rows = (12, 20) if quick else (COUNT, 50)
    diameters = range(8 if quick else HIGHEST)

    def wheel(sector: CyclicSector) -> FloatArray:
        return lowest(cyclic_modes(sector, OF_EACH, diameters=diameters), count)

    pieces = (Piece(to=CORNER), Piece(to=top))
    found = {"solid": wheel(solid_sector(top, 2 * rows))}
    found["solid, half the rows"] = wheel(solid_sector(top, rows))
    for name, fillet in {"chart, fillet of the wall": WALL, "chart, half of it": 0.5 * WALL}.items():
        found[name] = modes(chart_shell(pieces, {}, fillet), count).freq[:count]
    for wall in ("curved", "linear"):
        found[f"imported shell, {wall} wall"] = wheel(shell_sector(top, rows, wall))
    if not quick and shutil.which("ccx") is not None:
        found["CalculiX S8R"] = by_calculix(whole_shell(top), count)
    return found


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table; returns its rows."""
    rows: list[Row] = []
    for angle, top in list(TOPS.items())[: 1 if quick else None]:
        started = time.perf_counter()
        exact, *others = models(top, quick).items()
        for name, freq in others:
            error = freq / exact[1] - 1.0
            rows.append(
                {
                    "corner [deg]": angle,
                    "model": name,
                    "modes": len(error),
                    "worst %": float(100.0 * np.abs(error).max()),
                    "rms %": float(100.0 * np.sqrt(np.mean(error**2))),
                }
            )
        print(f"{angle} degrees: {time.perf_counter() - started:.0f} s")
    show("A casing of cylinder and cone: frequencies against a solid's", rows)
    write(out / "corner.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
