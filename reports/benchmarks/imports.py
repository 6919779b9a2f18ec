"""From a mesh file to a basis with 20 tip nodes: processor time and memory of each step, and the limits reached.

`python -m reports.benchmarks.imports [--quick | --large] [--out DIR]` writes imports.csv. A twisted blade of 20-noded
bricks, a casing of nine-noded quadrilaterals and a thick block of ten-noded tetrahedra, each of some 300,000 unknowns
(--quick: 2,000; --large: 600,000 and 1,200,000 too), are written as Abaqus input files. Each goes through the study
that an engineer writes: read and checked, assembled, 8 modes kept, residual compliance at 20 nodes (`at`, 60 channels),
saved. Every part has a child process with limits of 15 minutes and 10 GB. "ended" gives the package's own message if a
limit is reached; the row has the numbers up to there.
"""

import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.reduction import reduce
from casingfem.structure.imported.grid import grid_mesh, revolved
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.study import load_study
from reports.benchmarks.child import Limits, Numbers, in_child
from reports.tables import Row, command_line, show, write
from reports.verification.modes.calculix import place
from reports.verification.modes.mesh_files import write_inp

KEPT, NODES = 8, 20
LIMITS = Limits(seconds=900.0, memory=10 * 2**30)
COLUMNS = ("unknowns", "file MB", "read s", "assemble s", "reduce s", "save s", "basis MB", "lowest Hz")
Counts = tuple[int, int, int]


def blade(counts: Counts) -> MeshData:
    """The twisted blade of `reports.verification.modes.calculix`."""
    return grid_mesh("hexahedron20", counts, place, groups={"held": (0, 0.0), "tip": (0, 1.0)})


def casing(counts: Counts) -> MeshData:
    """The reference frustum, a wall of 3 mm: cells around and along."""
    wall = revolved((0.50, 0.45), (0.0, 0.25), 3e-3)
    ends = {"held": (1, 0.0), "tip": (1, 1.0)}
    return grid_mesh("quad9", counts[1:], lambda u: wall(np.insert(u, 0, 0.5, axis=1)), groups=ends, wrap=0)


def block(counts: Counts) -> MeshData:
    """A block of 1 x 0.8 x 0.6 m."""
    size: FloatArray = np.array([1.0, 0.8, 0.6])
    return grid_mesh("tetra10", counts, lambda u: u * size, groups={"held": (0, 0.0), "tip": (0, 1.0)})


PARTS: dict[str, tuple[Callable[[Counts], MeshData], str, tuple[Counts, ...]]] = {
    "twisted blade, C3D20": (blade, "[solid]", ((12, 5, 1), (105, 45, 5), (134, 57, 6), (168, 72, 8))),
    "casing, S9": (casing, "[shell]\nthickness = 3e-3", ((1, 30, 4), (1, 300, 50), (1, 424, 70), (1, 600, 100))),
    "thick block, C3D10": (block, "[solid]", ((5, 4, 3), (29, 24, 18), (36, 30, 23), (46, 38, 28))),
}  # maker, table of the study, meshes of 2,000, 300,000, 600,000 and 1,200,000 unknowns


def chain(maker: Callable[[Counts], MeshData], table: str, counts: Counts, folder: Path) -> Iterator[Numbers]:
    """The steps of one part."""
    mesh = maker(counts)
    write_inp(mesh, folder / "part.inp")
    tip = mesh.groups["tip"].nodes
    at = (tip[np.linspace(0, len(tip) - 1, NODES).astype(int)] + 1).tolist()
    study = folder / "part.toml"
    study.write_text(
        f'[material]\nE = 210e9\nnu = 0.3\nrho = 7800.0\n{table}\nmesh = "part.inp"\n'
        f'[support.held]\nkind = "clamped"\n[reduce]\nat = {at}\nmodes = {KEPT}\nout = "part.npz"\n'
    )
    del mesh
    yield {"file MB": 1e-6 * (folder / "part.inp").stat().st_size}
    started = process_time()
    loaded = load_study(study)
    yield {"read s": process_time() - started}
    started = process_time()
    system = loaded.structure.assembled()
    yield {"assemble s": process_time() - started, "unknowns": system.size}
    started = process_time()
    basis = reduce(loaded.structure, loaded.interface, modes=KEPT, system=system)
    yield {"reduce s": process_time() - started, "lowest Hz": float(basis.freq[0])}
    started = process_time()
    basis.save(folder / "part.npz")
    yield {"save s": process_time() - started, "basis MB": 1e-6 * (folder / "part.npz").stat().st_size}


def main(out: Path, quick: bool = False, large: bool = False) -> list[Row]:
    """Print the table and write it."""
    rows: list[Row] = []
    for name, (maker, table, sizes) in PARTS.items():
        for counts in sizes[:1] if quick else sizes[1 : 4 if large else 2]:
            with tempfile.TemporaryDirectory() as folder:
                outcome = in_child(partial(chain, maker, table, counts, Path(folder)), LIMITS)
            numbers = {column: outcome.numbers.get(column) for column in COLUMNS}
            rows.append({"part": name, **numbers, "peak MB": outcome.peak, "ended": outcome.ended})
    show(f"From a mesh file to a basis of {KEPT} modes and {NODES} nodes", rows)
    write(out / "imports.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, large="add parts of 600,000 and 1,200,000 unknowns")
