"""Shells that branch: a box of seven walls against published frequencies, a T against solids of 27-noded bricks.

`python -m reports.verification.modes.branching [--quick] [--out DIR]` prints one table and writes branching.csv: the
lowest frequencies of each mesh, and the largest difference from the reference. The double-cell box (1.27 x 2.54 x 2.54
m, walls of 12.7 mm, clamped at one end) is that of Fan and Luah, J. Sound Vib. 179, 1995, 763; its walls meet by twos
and threes. The T is a plate of 0.4 x 0.3 m with a web 0.15 m high in its middle, clamped at one side; its bricks have a
web that is on the plate, which the shell's does not: the difference falls with the wall. --quick leaves out the
fine meshes.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from reports.tables import Row, command_line, show, write

BOX, STEEL = Material(E=207e9, nu=0.3, rho=7850.0), Material(E=210e9, nu=0.3, rho=7800.0)
FAN_LUAH = np.array([20.28, 25.43, 28.79, 30.62])  # Hz
SIDE, WALL = 1.27, 12.7e-3
PLATE, LONG, WEB = 0.4, 0.3, 0.15
COUNT = 4  # frequencies compared
BOXES = (("quad8", 8), ("quad", 8), ("quad", 16), ("quad", 32), ("quad8", 16))  # kind, cells on a short side
TEES = (("quad", 1), ("quad8", 1), ("quad", 2), ("quad8", 2), ("quad8", 4))


def grid(kind: str, *steps: Sequence[float] | FloatArray) -> FloatArray:
    """Nodes of the cells between steps along two or three axes, (cells, nodes, axes)."""
    places = KINDS[kind].places
    first = np.array(list(np.ndindex(*(len(along) - 1 for along in steps))))
    low, high = (
        np.stack([np.asarray(a)[k] for a, k in zip(steps, (first + n).T, strict=True)], axis=1) for n in (0, 1)
    )
    return np.asarray(low[:, None] + places * (high - low)[:, None])


def sheet(kind: str, across: int, at: float, *steps: FloatArray) -> FloatArray:
    """Nodes of the cells of a wall square to an axis, (cells, nodes, 3)."""
    return np.insert(grid(kind, *steps), across, at, axis=2)


def joined(kind: str, parts: Sequence[FloatArray], end: int) -> MeshData:
    """Cells as one mesh; the group "base" are the nodes at 0 of an axis."""
    cells = np.concatenate(parts)
    x, place = np.unique(np.round(cells.reshape(-1, 3), 9), axis=0, return_inverse=True)
    base = Group(nodes=np.flatnonzero(np.abs(x[:, end]) < 1e-9))
    return MeshData(
        kind=kind, points=x, cells=place.reshape(cells.shape[:2]), groups={"base": base}, source="branching"
    )


def box(kind: str, n: int) -> MeshShell:
    """The double-cell box with n cells on the short side of a wall."""
    x, yz = np.linspace(0.0, SIDE, n + 1), np.linspace(0.0, 2.0 * SIDE, 2 * n + 1)
    walls = [sheet(kind, 0, at, yz, yz) for at in (0.0, SIDE)]
    walls += [sheet(kind, 1, at, x, yz) for at in (0.0, SIDE, 2.0 * SIDE)]
    return MeshShell(mesh=joined(kind, walls, 2), thickness=WALL, material=BOX, supports={"base": Clamped()})


def tee(kind: str, n: int, thickness: float) -> MeshShell:
    """The T with 4 n cells on each half of its plate."""
    x, y, z = (np.linspace(0.0, length, k * n + 1) for length, k in ((PLATE, 8), (LONG, 6), (WEB, 3)))
    mesh = joined(kind, [sheet(kind, 2, 0.0, x, y), sheet(kind, 0, 0.5 * PLATE, y, z)], 0)
    return MeshShell(mesh=mesh, thickness=thickness, material=STEEL, supports={"base": Clamped()})


def solid_tee(n: int, thickness: float) -> Solid:
    """The T of bricks with 4 n cells on each half of its plate, one through each wall."""
    middle, half = 0.5 * PLATE, 0.5 * thickness
    sides = [np.linspace(0.0, middle - half, 4 * n + 1), np.linspace(middle + half, PLATE, 4 * n + 1)]
    y = np.linspace(0.0, LONG, 6 * n + 1)
    plate = grid("hexahedron27", np.concatenate(sides), y, [-half, half])
    web = grid("hexahedron27", [middle - half, middle + half], y, np.linspace(half, WEB, 3 * n + 1))
    mesh = joined("hexahedron27", [plate, web], 0)
    return Solid(mesh=mesh, material=STEEL, supports={"base": Clamped()})


def row(case: str, mesh: str, freq: FloatArray, against: FloatArray) -> Row:
    """Frequencies of one mesh, and the largest difference from the reference."""
    worst = 100.0 * float(np.abs(freq / against - 1.0).max())
    return {"case": case, "mesh": mesh, **{f"f{k} [Hz]": float(f) for k, f in enumerate(freq, 1)}, "worst %": worst}


def main(out: Path, quick: bool = False) -> list[Row]:
    """Every mesh beside its reference."""
    case = "box, to Fan & Luah"
    meshes = BOXES[:2] if quick else BOXES
    rows = [row(case, f"{kind}, {n} on 1.27 m", modes(box(kind, n), COUNT).freq, FAN_LUAH) for kind, n in meshes]
    for thickness in (1e-3,) if quick else (1e-3, 2e-3, 4e-3):
        case, bricks = f"T of {1e3 * thickness:g} mm, to the finest bricks", (1,) if quick else (1, 2, 4)
        solids = {n: modes(solid_tee(n, thickness), COUNT).freq for n in bricks}
        exact = solids[bricks[-1]]
        rows += [row(case, f"bricks, {8 * n} x {6 * n}", freq, exact) for n, freq in solids.items()]
        for kind, n in TEES[1:2] if quick else TEES:
            rows.append(row(case, f"{kind}, {8 * n} x {6 * n}", modes(tee(kind, n, thickness), COUNT).freq, exact))
    show("Shells that branch: lowest frequencies, largest difference from the reference", rows)
    write(out / "branching.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
