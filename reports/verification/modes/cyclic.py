"""Wheels of equal sectors: one sector against the whole wheel, mistuned blades against the full model, time.

`python -m reports.verification.modes.cyclic [--quick] [--out DIR]` prints three tables and writes cyclic_wheels.csv,
cyclic_mistuned.csv and cyclic_times.csv. The sector is a piece of a disk with a twisted blade on it, clamped at the
hub, of 20-node bricks, or a bent plate of nine-node quadrilaterals. The full models are assembled from all sectors and
solved as any imported part. The largest sector of the times has 30,000 nodes: a quarter of an hour, 6 GB. --quick takes
fewer sectors, and a small sector for the times.
"""

import resource
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import factorise
from casingfem.modal.cyclic.mistuned import mistuned_modes
from casingfem.modal.cyclic.modes import CyclicModes, cyclic_modes, wheel_modes
from casingfem.modal.cyclic.reduction import cyclic_reduce
from casingfem.modal.cyclic.whirl import CyclicWhirl, cyclic_whirl
from casingfem.modal.interface.kinds import TipNodes
from casingfem.modal.interface.view import view
from casingfem.modal.modes import modes
from casingfem.modal.whirl import whirl_modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.cyclic.sector import CyclicSector, assemble_cyclic
from casingfem.structure.imported.cyclic.wheel import wheel_nodes, wheel_structure
from casingfem.structure.imported.grid import end_group, grid_mesh
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from reports.tables import Row, command_line, show_all

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
HUB, RIM, TIP, DEPTH = 0.10, 0.18, 0.30, 0.04  # radii of the disk and of the blade's tip, axial length [m]
THIN, TWIST = 0.14, np.radians(35.0)  # blade's part of the pitch; its twist
LARGE = 30_000  # unknowns beyond which SuperLU takes many gigabytes
SCATTER = 0.02  # standard deviation of the blades' frequencies


def placed(u: FloatArray, sectors: int, disk: float) -> FloatArray:
    """Unit coordinates (around, along the radius, along the axis) of a sector -> positions; the disk ends at `disk`."""
    pitch = 2.0 * np.pi / sectors
    around = np.interp(u[:, 0], [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0], [0.0, 0.5 - THIN / 2.0, 0.5 + THIN / 2.0, 1.0])
    r = np.interp(u[:, 1], [0.0, disk, 1.0], [HUB, RIM, TIP])
    turn = TWIST * np.clip((r - RIM) / (TIP - RIM), 0.0, 1.0)
    across, z = pitch * (around - 0.5) * RIM, DEPTH * (0.5 - u[:, 2])
    across, z = np.cos(turn) * across - np.sin(turn) * z, np.sin(turn) * across + np.cos(turn) * z
    theta = pitch * 0.5 + across / np.where(r > RIM, r, RIM)
    return np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=1)


def bladed_mesh(sectors: int, counts: tuple[int, int, int, int]) -> MeshData:
    """A piece of a disk and a blade: cells across the blade (three times that around), along disk, blade and axis."""
    k, along_disk, along_blade, along_axis = counts
    grid = grid_mesh("hexahedron20", (3 * k, along_disk + along_blade, along_axis), lambda u: u)
    middle = grid.points[grid.cells].mean(axis=1)
    disk = along_disk / (along_disk + along_blade)
    cells = grid.cells[(middle[:, 1] < disk) | (np.abs(middle[:, 0] - 0.5) < 1.0 / 6.0)]
    used, inverse = np.unique(cells, return_inverse=True)
    u, cells = grid.points[used], inverse.reshape(cells.shape)
    mesh = MeshData(kind=grid.kind, points=placed(u, sectors, disk), cells=cells, source="bladed disk")
    ends = {"low": u[:, 0] == 0.0, "high": u[:, 0] == 1.0, "hub": u[:, 1] == 0.0, "tip": u[:, 1] == 1.0}
    groups = {name: end_group(mesh, inside) for name, inside in ends.items()}
    blade = np.flatnonzero(u[cells, 1].mean(axis=1) > disk)
    groups["blade"] = Group(nodes=cells[blade].ravel(), cells=blade)
    return replace(mesh, groups=groups)


def bladed_disk(
    sectors: int, counts: tuple[int, int, int, int] = (1, 2, 3, 1), rotation: Rotation | None = None
) -> CyclicSector:
    """The sector of solids, clamped at the hub."""
    mesh = bladed_mesh(sectors, counts)
    solid = Solid(mesh=mesh, material=STEEL, supports={"hub": Clamped()}, rotation=rotation)
    return CyclicSector(structure=solid, sectors=sectors, faces=("low", "high"))


def bent_plate(sectors: int, rotation: Rotation | None = None, counts: tuple[int, int] = (4, 4)) -> CyclicSector:
    """A sector of a wavy annular shell whose cells meet in kinks, clamped at the hub."""

    def place(u: FloatArray) -> FloatArray:
        theta, r = 2.0 * np.pi / sectors * (u[:, 0] + 0.2 * u[:, 1]), HUB + (TIP - HUB) * u[:, 1]
        height = 0.1 * HUB * u[:, 1] * np.cos(2.0 * np.pi * u[:, 0])
        return np.stack([r * np.cos(theta), r * np.sin(theta), height], axis=1)

    mesh = grid_mesh("quad9", counts, place, groups={"hub": (1, 0.0), "tip": (1, 1.0)})
    shell = MeshShell(mesh=mesh, thickness=6e-3, material=STEEL, supports={"hub": Clamped()}, rotation=rotation)
    return CyclicSector(structure=shell, sectors=sectors)


def complete(found: CyclicModes | CyclicWhirl, labels: Sequence[tuple[int, ...]]) -> float:
    """Frequency [Hz] up to which a list of so many modes of each label is complete."""
    own = np.array(labels)
    return min(float(found.freq[(own == label).all(axis=1)].max()) for label in np.unique(own, axis=0))


def wheels(quick: bool) -> list[Row]:
    """Every mode of the full wheel against the modes of the sector, for all nodal diameters."""
    turning = Rotation(omega=2.0 * np.pi * 150.0)
    cases = [
        ("solid", bladed_disk(6 if quick else 24)),
        ("solid at 9,000 rpm", bladed_disk(6 if quick else 24, rotation=turning)),
        ("shell", bent_plate(5 if quick else 11)),
        ("shell at 9,000 rpm", bent_plate(5 if quick else 11, rotation=turning)),
    ]
    rows: list[Row] = []
    for name, sector in cases:
        whole = wheel_structure(sector)
        found = cyclic_modes(sector, 6)
        waves = wheel_modes(found).freq
        count = int(np.count_nonzero(waves < complete(found, [(n,) for n in found.nodal_diameters.tolist()])))
        rows.append(compared(name, sector, count, waves[:count], modes(whole, count).freq))
        if sector.structure.rotation is None:
            continue
        whirl = cyclic_whirl(sector, 4)
        labels = list(zip(whirl.nodal_diameters.tolist(), whirl.sense.tolist(), strict=True))
        waves = np.sort(whirl.freq)
        count = int(np.count_nonzero(waves < complete(whirl, labels)))
        rows.append(compared(f"{name}, Coriolis", sector, count, waves[:count], whirl_modes(whole, count).freq[:count]))
    return rows


def compared(name: str, sector: CyclicSector, count: int, found: FloatArray, exact: FloatArray) -> Row:
    """One row of the table of wheels."""
    return {
        "wheel": name,
        "sectors": sector.sectors,
        "diameters": f"0 to {sector.diameters[-1]}",
        "modes": count,
        "largest change of a frequency": float(np.abs(found / exact - 1.0).max()),
    }


def mistuned_wheel(sector: CyclicSector, deviations: FloatArray) -> Solid:
    """The full wheel whose blades have the moduli given by their deviations."""
    whole, N = wheel_structure(sector), sector.sectors
    assert isinstance(whole, Solid)
    blades = whole.mesh.groups["blade"].cells.reshape(N, -1)
    own = {f"blade {j}": Group(nodes=whole.mesh.cells[cells].ravel(), cells=cells) for j, cells in enumerate(blades)}
    moduli = [replace(STEEL, E=STEEL.E * (1.0 + deviation) ** 2) for deviation in deviations]
    mesh = replace(whole.mesh, groups=dict(whole.mesh.groups) | own)
    return replace(whole, mesh=mesh, materials=dict(zip(own, moduli, strict=True)))


def tip_loads(sector: CyclicSector, whole: Solid | MeshShell, tips: TipNodes) -> FloatArray:
    """Loads of the channels of all sectors on the full wheel's free dofs."""
    part, system = sector.structure.assembled(), whole.assembled()
    nodal, nodes = part.expand(view(part, tips).loads), wheel_nodes(sector)
    columns = []
    for j in range(sector.sectors):
        forces = np.zeros((len(system.points), system.dofs, nodal.shape[2]))
        turn = np.linalg.matrix_power(sector.turn.matrix, j)
        forces[nodes[j], :3] = np.einsum("cd,ndk->nck", turn, nodal[:, :3])
        columns.append(system.restrict(forces))
    return np.hstack(columns)


def mistuned(quick: bool) -> list[Row]:
    """Frequencies and static compliance at the tips of a mistuned wheel against its full model, over families kept."""
    sector = bladed_disk(6 if quick else 24)
    deviations = SCATTER * np.random.default_rng(7127).standard_normal(sector.sectors)
    whole, tips, count = mistuned_wheel(sector, deviations), TipNodes("tip", 2), 3 * sector.sectors
    exact = modes(whole, count).freq
    P = tip_loads(sector, whole, tips)
    compliance = P.T @ factorise(whole.assembled().K).solve(P)
    rows: list[Row] = []
    for families in (3, 5, 8, 12):
        found = mistuned_modes(sector, deviations, 3, blade="blade", families=families)
        rows.append(
            {
                "basis": f"{families} tuned modes a diameter",
                "modes": count,
                "worst frequency": float(np.abs(found.freq / exact - 1.0).max()),
                "largest localisation": float(found.localisation.max()),
                "static compliance": None,
            }
        )
    basis = cyclic_reduce(sector, tips, modes=3, deviations=deviations, blade="blade")
    rows.append(
        {
            "basis": "of cyclic_reduce, 3 kept",
            "modes": count,
            "worst frequency": float(np.abs(basis.freq / exact - 1.0).max()),
            "largest localisation": None,
            "static compliance": float(np.abs(basis.compliance - compliance).max() / np.abs(compliance).max()),
        }
    )
    return rows


def times(quick: bool) -> list[Row]:
    """Processor time and memory of 12 modes of every diameter, and of one factor."""
    rows: list[Row] = []
    for counts in [(2, 4, 6, 2)] if quick else [(2, 8, 12, 3), (3, 16, 24, 5), (5, 28, 42, 10)]:
        sector = bladed_disk(24, counts)
        started = time.process_time()
        found = cyclic_modes(sector, 12, diameters=(0, 1, 12) if quick else None)
        rows.append(
            {
                "nodes of a sector": len(sector.structure.mesh.points),
                "sectors": sector.sectors,
                "diameters": len(found.sturm_counts),
                "modes": len(found.records()),
                "processor s": round(time.process_time() - started, 1),
                "peak memory [GB]": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6, 1),
                **factors(sector),
            }
        )
    return rows


def factors(sector: CyclicSector) -> Row:
    """Processor time and memory of one factor of the complex pencil, by dense fronts, of small ones by SuperLU too."""
    K, M, _ = assemble_cyclic(sector).matrices(1)
    A = csc_array(K + M * (abs(K.diagonal()).min() / abs(M.diagonal()).max()))
    row: Row = {}
    for name, direct in (("fronts", "multifrontal"), ("SuperLU", "superlu")):
        if direct == "superlu" and A.shape[0] > LARGE:
            row |= {"SuperLU [s]": None, "SuperLU [MB]": None}
            continue
        started = time.process_time()
        factor: Any = factorise(A, direct)  # type: ignore[arg-type]
        row[f"{name} [s]"] = round(time.process_time() - started, 2)
        numbers = factor.fronts.entries * 16 if direct == "multifrontal" else factor.lu.nnz * 20  # SuperLU's have rows
        row[f"{name} [MB]"] = round(1e-6 * numbers)
    return row


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the three tables; returns their rows."""
    tables = {
        "wheels": ("One sector against the whole wheel", wheels(quick)),
        "mistuned": ("A mistuned wheel against its full model", mistuned(quick)),
        "times": ("12 modes of every nodal diameter", times(quick)),
    }
    return show_all(out, "cyclic_", tables)


if __name__ == "__main__":
    command_line(__doc__, main)
