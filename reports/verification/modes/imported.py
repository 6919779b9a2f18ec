"""Imported meshes: five formats of one part, solids and shells against references, where thin bricks lock, rubs.

`python -m reports.verification.modes.imported [--quick] [--out DIR]` prints six tables and writes them:
imported_formats.csv, imported_solids.csv, imported_shells.csv, imported_locking.csv, imported_calculix.csv (frequencies
at rest and at speed, static compliance, reports/verification/modes/calculix.py) and imported_rubs.csv (a rub of parts
from outside against the same parts on charts). The part of the first table is written in every format by
reports/verification/modes/mesh_files.py, read back with its study as `casingfem modes` does, and compared with the mesh
in memory.
--quick leaves out the finest meshes.
"""

import time
from pathlib import Path

import numpy as np
import pandas as pd

import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.modal.basis import ModalBasis
from casingfem.modal.interface.kinds import Rim, TipNodes
from casingfem.modal.mesh_modes import MeshModes, mesh_modes
from casingfem.modal.modes import modes
from casingfem.modal.reduction import reduce
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.chart import Frustum, Plate
from casingfem.structure.imported.cells.support import Fixed
from casingfem.structure.imported.grid import Placing, grid_mesh, revolved
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from casingfem.structure.shell.shell import Shell
from casingfem.study import load_study
from reports.tables import DATA, Row, command_line, show_all
from reports.verification.modes.calculix import compared
from reports.verification.modes.frustum import exact_frequencies
from reports.verification.modes.mesh_files import WRITERS, group_name

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
NAFEMS = Material(E=200e9, nu=0.3, rho=8000.0)
BASE = {"base": Clamped()}


def wall(t: float = 3e-3) -> Placing:
    """The reference frustum's wall."""
    return revolved((0.50, 0.45), (0.0, 0.25), t)


def ring(kind: str, counts: tuple[int, int, int], t: float) -> MeshData:
    """A frustum meshed with solids: elements through the wall, around, along."""
    return grid_mesh(kind, counts, wall(t), groups={"base": (2, 0.0), "top": (2, 1.0)}, wrap=1)


def skin(kind: str, counts: tuple[int, int], t: float = 3e-3) -> MeshShell:
    """The reference frustum meshed with quadrilaterals: elements around, along."""
    place = wall(t)
    mesh = grid_mesh(
        kind, counts, lambda u: place(np.insert(u, 0, 0.5, axis=1)), groups={"base": (1, 0.0), "top": (1, 1.0)}, wrap=0
    )
    return MeshShell(mesh=mesh, thickness=t, material=STEEL, supports=BASE)


def formats(out: Path) -> list[Row]:
    """One part in five formats, each read by its own study."""
    part = ring("hexahedron20", (1, 16, 3), 0.03)
    exact = mesh_modes(Solid(mesh=part, material=STEEL, supports=BASE), 20)
    folder = out / "meshes"
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for name, (file, writer) in WRITERS.items():
        writer(part, folder / file)
        group = group_name(name, "base", list(part.groups))
        study = folder / f"{file.replace('.', '_')}.toml"
        study.write_text(
            f'[material]\nE = 210e9\nnu = 0.3\nrho = 7800.0\n\n[solid]\nmesh = "{file}"\n\n'
            f'[support."{group}"]\nkind = "clamped"\n\n[modes]\ncount = 20\n'
        )
        loaded = load_study(study)
        found = modes(loaded.structure, 20)
        rows.append(
            {
                "format": name,
                "bytes": (folder / file).stat().st_size,
                "first [Hz]": f"{found.freq[0]:.6f}",
                "n": int(found.nodal_diameters[0]),
                "largest change of 20 frequencies": float(np.abs(found.freq / exact.freq - 1.0).max()),
            }
        )
    return rows


def thick_plate(kind: str, counts: tuple[int, int, int]) -> Solid:
    """FV52: 10 x 10 x 1 m, fixed across its plane along the lower edges."""
    mesh = grid_mesh(kind, counts, lambda u: (u - [0.5, 0.5, 0.0]) * [10.0, 10.0, 1.0])
    x, y, z = mesh.points.T
    edge = (np.abs(z) < 1e-9) & (np.maximum(np.abs(x), np.abs(y)) > 5.0 - 1e-9)
    held = MeshData(
        kind=kind, points=mesh.points, cells=mesh.cells, groups={"edges": Group(nodes=np.flatnonzero(edge))}
    )
    return Solid(mesh=held, material=NAFEMS, supports={"edges": Fixed(directions=("z",))})


def thick_cylinder(kind: str, counts: tuple[int, int, int]) -> Solid:
    """FV41: a free cylinder of mean radius 2 m, wall .4 m, length 10 m."""
    return Solid(mesh=grid_mesh(kind, counts, revolved((2.0, 2.0), (0.0, 10.0), 0.4), wrap=1), material=NAFEMS)


def axisymmetric(found: MeshModes) -> FloatArray:
    """Frequencies of the n = 0 modes that move in the meridional plane: the torsional ones are left out."""
    assert found.rings is not None
    hoop = np.linalg.norm(found.rings.amplitudes[0, :, 1], axis=0)
    others = np.linalg.norm(found.rings.amplitudes[0, :, [0, 2]], axis=(0, 1))
    return np.asarray(found.freq[(found.nodal_diameters == 0) & (hoop < others)])


def twisted(kind: str, counts: tuple[int, int, int], b_over_h: float, twist_deg: float) -> Solid:
    """A cantilever of length 1, chord 1, sections turned along the length."""

    def place(u: FloatArray) -> FloatArray:
        angle = np.radians(twist_deg) * u[:, 0]
        y, z = u[:, 1] - 0.5, (u[:, 2] - 0.5) / b_over_h
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([u[:, 0], c * y - s * z, s * y + c * z], axis=1)

    mesh = grid_mesh(kind, counts, place, groups={"root": (0, 0.0)})
    return Solid(mesh=mesh, material=STEEL, supports={"root": Clamped()})


def plate_factors(found: MeshModes, b_over_h: float) -> FloatArray:
    """Lambda = omega a^2 sqrt(rho h/D) for length a = 1."""
    h = 1.0 / b_over_h
    D = STEEL.E * h**3 / (12.0 * (1.0 - STEEL.nu**2))
    return np.asarray(found.omega * np.sqrt(STEEL.rho * h / D))


def reference(name: str) -> pd.DataFrame:
    """A table of data/reference."""
    return pd.read_csv(DATA / "reference" / name, comment="#")


def solids(quick: bool) -> list[Row]:
    """Solids against published and independent values: worst relative error, and the source of the reference."""
    nafems = reference("nafems_free_vibration.csv").set_index(["case", "mode"])
    rows: list[Row] = []

    def add(case: str, source: str, found: MeshModes, values: FloatArray, exact: FloatArray, seconds: float) -> None:
        error = np.abs(values / exact - 1.0)
        rows.append(
            {
                "case": case,
                "reference": source,
                "cells": f"{len(found.structure.mesh.cells)} {found.structure.mesh.kind}",
                "dofs": found.dofs,
                "modes": len(exact),
                "worst error": float(error.max()),
                "seconds": seconds,
            }
        )

    plate = [float(nafems.loc[("FV52", k), "frequency_hz"]) for k in ("4", "5-6", "5-6", "7", "8", "9-10", "9-10")]
    started = time.perf_counter()
    found = modes(thick_plate("hexahedron20", (4, 4, 1)), 10)
    add("FV52 thick plate, the printed mesh", "NAFEMS", found, found.freq[3:], np.array(plate), since(started))
    tube = [float(nafems.loc[("FV41", str(k)), "check_hz"]) for k in range(2, 7)]
    cylinders = [("hexahedron20", (1, 12, 8)), ("hexahedron27", (1, 12, 12)), ("tetra10", (1, 12, 12))]
    for kind, counts in cylinders[:1] if quick else cylinders:
        started = time.perf_counter()
        found = modes(thick_cylinder(kind, counts), band=(200.0, 410.0))
        values = axisymmetric(found)[:5]
        add("FV41 free thick cylinder, n = 0", "3-D, Fourier", found, values, np.array(tube), since(started))
    table = reference("twisted_plate_3d.csv")
    for twist in (0, 60):
        part = table[(table.a_over_b == 1) & (table.b_over_h == 5) & (table.twist_deg == twist)]
        exact = part["lambda"].to_numpy()
        choices = [("hexahedron20", (5, 5, 2)), ("tetra10", (5, 5, 2))]
        for kind, counts in choices if quick else [*choices, ("hexahedron27", (8, 8, 2))]:
            started = time.perf_counter()
            found = modes(twisted(kind, counts, 5.0, twist), len(exact))
            values = plate_factors(found, 5.0)
            add(f"thick cantilever, {twist} deg of twist", "3-D, spectral", found, values, exact, since(started))
    return rows


def since(started: float) -> float:
    """Seconds since an instant."""
    return round(time.perf_counter() - started, 2)


def shells(quick: bool) -> list[Row]:
    """The reference frustum on quadrilaterals against 3-D elasticity: 40 modes."""
    exact = exact_frequencies()
    rows: list[Row] = []
    choices = [("quad9", (61, 8)), ("quad8", (61, 8))]
    for kind, counts in choices if quick else [*choices, ("quad9", (121, 16)), ("quad", (121, 16))]:
        started = time.perf_counter()
        found = modes(skin(kind, counts), 40)
        error = found.freq / exact - 1.0
        rows.append(
            {
                "cells": kind,
                "around x along": f"{counts[0]} x {counts[1]}",
                "dofs": found.dofs,
                "worst error": float(np.abs(error).max()),
                "RMS error": float(np.sqrt(np.mean(error**2))),
                "gap in perfect pairs": float(found.splits.max()),
                "least purity": float(found.purity.min()),
                "seconds": since(started),
            }
        )
    return rows


def locking(quick: bool) -> list[Row]:
    """One quadratic brick through the wall of ever thinner frusta: the lowest mode against the shell on a chart."""
    rows: list[Row] = []
    for ratio in (30, 100) if quick else (10, 30, 100, 300, 1000):
        t = 0.5 / ratio
        chart = Frustum(r_base=0.50, r_top=0.45, height=0.25)
        low = modes(Shell(chart=chart, thickness=t, material=STEEL, supports=BASE), 1)
        n = int(low.nodal_diameters[0])
        row: Row = {"R/t": ratio, "n": n, "shell [Hz]": float(low.freq[0])}
        for kind in ("hexahedron20", "hexahedron27"):
            found = modes(Solid(mesh=ring(kind, (1, 48, 8), t), material=STEEL, supports=BASE), 1)
            row[f"{kind}: error"] = float(found.freq[0] / low.freq[0] - 1.0)
            row[f"{kind}: n"] = int(found.nodal_diameters[0])
        found = modes(skin("quad9", (48, 8), t), 1)
        row["quad9 shell: error"] = float(found.freq[0] / low.freq[0] - 1.0)
        rows.append(row)
    return rows


def strip_blade(kind: str) -> Shell | MeshShell | Solid:
    """A steel strip of 110 x 40 x 5.4 mm: on a chart, as an imported shell, as an imported solid."""
    length, width, t = 0.110, 0.040, 5.4e-3
    ends = {"root": (0, 0.0), "tip": (0, 1.0)}
    held = {"root": Clamped()}
    if kind == "chart":
        return Shell(chart=Plate(length=length, width=width), thickness=t, material=STEEL, supports=held)
    if kind == "shell":
        flat = grid_mesh(
            "quad9", (24, 12), lambda u: np.insert((u - [0.0, 0.5]) * [length, width], 2, 0.0, axis=1), groups=ends
        )
        return MeshShell(mesh=flat, thickness=t, material=STEEL, supports=held)
    block = grid_mesh("hexahedron20", (16, 6, 2), lambda u: (u - [0.0, 0.5, 0.5]) * [length, width, t], groups=ends)
    return Solid(mesh=block, material=STEEL, supports=held)


def rub_casing(kind: str, t: float, quick: bool) -> Shell | MeshShell:
    """The reference frustum with a wall of t, on a chart or as an imported shell."""
    if kind == "chart":
        return Shell(chart=Frustum(r_base=0.50, r_top=0.45, height=0.25), thickness=t, material=STEEL, supports=BASE)
    return skin("quad9", (61, 8) if quick else (121, 16), t)


def body(basis: ModalBasis) -> ct.ModalBody:
    """A basis as the contact takes it, without a file."""
    return ct.ModalBody(
        omega=basis.omega, zeta=basis.zeta, channels=basis.channels, rows=basis.rows, S=basis.S, kind=basis.kind,
        n_max=basis.n_max, radius=basis.radius,
    )  # fmt: skip


def rubs(quick: bool) -> list[Row]:
    """The first contacts of a rub: three tips of an imported blade on an imported casing, and the same on charts."""
    t, n_max = (0.010, 8) if quick else (5e-3, 16)
    rim, tips = Rim("top", n_max=n_max), TipNodes("tip", 3)
    made = {
        kind: reduce(rub_casing(kind, t, quick), rim, modes=20 if quick else 40, zeta=0.002)
        for kind in ("chart", "shell")
    }
    blades = {kind: reduce(strip_blade(kind), tips, modes=6, zeta=0.002) for kind in ("chart", "shell", "solid")}
    rows: list[Row] = []
    for casing, blade in (("chart", "chart"), ("shell", "shell"), ("shell", "solid")):
        places = tuple(ct.ContactPoint(span=f"node{k}.span", flap=f"node{k}.flap", lean_deg=10.0) for k in range(3))
        rub = ct.Rub(
            body(made[casing]), (body(blades[blade]),), places, clearance=-2e-5,
            speed=ct.Speed.constant(5.0), thickness=t,
        )  # fmt: skip
        result = ct.run(rub, law=ct.Coulomb(mu=0.2), t_end=5e-3, dt=2e-6)
        rows.append(
            {
                "casing": casing,
                "blade": blade,
                "first release [ms]": float(1e3 * result.intervals[1][0][1]),
                "second contact [ms]": float(1e3 * result.intervals[1][1][0]),
                "impulse [N s]": float(result.impulse.sum()),
                "blade [Hz]": float(blades[blade].freq[0]),
                "casing [Hz]": float(made[casing].freq[0]),
            }
        )
    for row in rows:
        for name in ("first release [ms]", "second contact [ms]", "impulse [N s]"):
            row[f"{name.split(' [')[0]}: change"] = float(row[name]) / float(rows[0][name]) - 1.0  # type: ignore[arg-type]
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the six tables; returns their rows."""
    tables = {
        "formats": ("One part in five formats, 20 modes", formats(out)),
        "solids": ("Solids against references", solids(quick)),
        "shells": ("The reference frustum on quadrilaterals against 3-D elasticity, 40 modes", shells(quick)),
        "locking": ("One brick through the wall, 48 around, 8 along: lowest mode against the shell", locking(quick)),
        "calculix": ("A twisted blade on the same cells as in CalculiX 2.20: worst relative error", compared(quick)),
        "rubs": ("The first 5 ms of a rub, parts from outside against charts", rubs(quick)),
    }
    return show_all(out, "imported_", tables)


if __name__ == "__main__":
    command_line(__doc__, main)
