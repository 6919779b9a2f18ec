"""A twisted lofted blade in CalculiX: frequencies at rest and at speed, static compliance at its tip.

`python -m reports.verification.modes.calculix [--out DIR]` runs `ccx` where it is installed and writes
imported_blade_calculix.csv, which is stored in data/reference. reports/verification/modes/imported.py compares with the
stored table, without CalculiX.
"""

import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.io.arrays import FloatArray
from casingfem.modal.interface.kinds import AtNodes
from casingfem.modal.modes import modes
from casingfem.modal.reduction import reduce
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.modes.mesh_files import write_inp

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
MESHES = {"hexahedron20": (12, 5, 1), "tetra10": (24, 8, 2)}
RPM = (0, 5000, 10000)
AXIS = Rotation(omega=0.0, axis=(0.0, 0.0, 1.0), centre=(-0.15, 0.0, 0.0))
COUNT = 8


def place(u: FloatArray) -> FloatArray:
    """Span 0.2 m along x, chord 60 to 48 mm, thickness 6 to 4.2 mm, twisted by 30 degrees, its sections leaned."""
    s = u[:, 0]
    angle = np.radians(30.0) * s
    y, z = (u[:, 1] - 0.5) * 0.060 * (1.0 - 0.2 * s), (u[:, 2] - 0.5) * 0.006 * (1.0 - 0.3 * s)
    lean = 0.005 * s**2
    return np.stack([0.2 * s, np.cos(angle) * y - np.sin(angle) * z, np.sin(angle) * y + np.cos(angle) * z + lean], 1)


def blade(kind: str, rpm: float = 0.0) -> Solid:
    """The blade on the report's mesh, at a speed about an axis 0.15 m below its root."""
    mesh = grid_mesh(kind, MESHES[kind], place, groups={"root": (0, 0.0), "tip": (0, 1.0)})
    rotation = AXIS.at(rpm * np.pi / 30.0) if rpm else None
    return Solid(mesh=mesh, material=STEEL, supports={"root": Clamped()}, rotation=rotation)


def tip_nodes(solid: Solid) -> tuple[int, int]:
    """Two corners of the tip by their numbers, the first and last of its nodes."""
    tip = solid.mesh.groups["tip"].nodes
    first, last = solid.mesh.node_numbers[tip[[0, -1]]].tolist()
    return first, last


def mesh_deck(mesh: MeshData, material: Material, folder: Path) -> str:
    """Nodes, elements and material as CalculiX reads them: numbers of twenty characters at most."""
    write_inp(mesh, folder / "part.inp")
    text = (folder / "part.inp").read_text().partition("*ELEMENT")[2]
    nodes = "".join(f"{k},{x:.12e},{y:.12e},{z:.12e}\n" for k, (x, y, z) in enumerate(mesh.points.tolist(), 1))
    own = f"*MATERIAL,NAME=M\n*ELASTIC\n{material.E!r},{material.nu!r}\n*DENSITY\n{material.rho!r}\n"
    return f"*NODE\n{nodes}*ELEMENT{text}{own}"


def deck(solid: Solid, folder: Path) -> str:
    """The CalculiX input of the blade, clamped at its root."""
    text = mesh_deck(solid.mesh, solid.material, folder)
    return text + "*SOLID SECTION,ELSET=body,MATERIAL=M\n*BOUNDARY\nroot,1,3\n"


def run(text: str, folder: Path) -> str:
    """CalculiX's table of results."""
    (folder / "job.inp").write_text(text)
    ran = subprocess.run(["ccx", "-i", "job"], cwd=folder, capture_output=True, text=True, timeout=3600, check=False)
    if "Job finished" not in ran.stdout:
        raise SystemExit(f"ccx: {ran.stdout[-500:]}")
    return (folder / "job.dat").read_text()


def frequencies(solid: Solid, rpm: float, folder: Path, *, axis: Rotation = AXIS, count: int = COUNT) -> list[float]:
    """Frequencies [Hz], about the nonlinear steady state if the blade rotates."""
    text = deck(solid, folder)
    if rpm:
        c, a = axis.centre, axis.direction.tolist()
        line = ",".join(f"{v!r}" for v in (*c, *a))
        load = f"*DLOAD\nbody,CENTRIF,{(rpm * np.pi / 30.0) ** 2:.12g},{line}\n"
        tight = "*CONTROLS,PARAMETERS=FIELD\n1e-8,1e-8\n"  # its own 0.5 % of the force shows in the fifth digit
        text += f"*STEP,NLGEOM\n*STATIC\n{tight}{load}*END STEP\n"
        text += f"*STEP,PERTURBATION\n*FREQUENCY\n{count}\n{load}*END STEP\n"
    else:
        text += f"*STEP\n*FREQUENCY\n{count}\n*END STEP\n"
    return eigenfrequencies(run(text, folder))


def eigenfrequencies(results: str) -> list[float]:
    """Frequencies [Hz] in CalculiX's table of results."""
    table = results.split("E I G E N V A L U E   O U T P U T")[1].split("P A R T I C")[0]
    rows = [line.split() for line in table.splitlines()]
    return [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()]


def compliance(solid: Solid, folder: Path) -> FloatArray:
    """Displacements of the two tip nodes under unit forces there, (6, 6) [m/N]."""
    nodes = tip_nodes(solid)
    text = deck(solid, folder) + f"*NSET,NSET=seen\n{nodes[0]},{nodes[1]}\n"
    for node in nodes:
        for direction in (1, 2, 3):
            text += f"*STEP\n*STATIC\n*CLOAD,OP=NEW\n{node},{direction},1.\n*NODE PRINT,NSET=seen\nU\n*END STEP\n"
    columns = []
    for block in re.split(r"displacements.*\n", run(text, folder))[1:]:
        found = {int(row[0]): row[1:] for row in map(str.split, block.splitlines()) if len(row) == 4}
        columns.append([float(value) for node in nodes for value in found[node]])
    return np.array(columns).T


def compared(quick: bool) -> list[Row]:
    """The project's own frequencies and compliance against the table of data/reference."""
    table = pd.read_csv(DATA / "reference" / "imported_blade_calculix.csv", comment="#")
    rows: list[Row] = []

    def add(kind: str, solid: Solid, quantity: str, found: FloatArray, seconds: float) -> None:
        part = table[(table["cells"] == kind) & (table["quantity"] == quantity)]["value"].to_numpy()
        scale = np.abs(part) if quantity.startswith("freq") else np.abs(part).max()
        error = float((np.abs(found.ravel() - part) / scale).max())
        cells = f"{len(solid.mesh.cells)} {kind}"
        rows.append({"cells": cells, "quantity": quantity, "worst error": error, "seconds": round(seconds, 2)})

    for kind in list(MESHES)[: 1 if quick else None]:
        for rpm in RPM:
            started = time.perf_counter()
            found = modes(blade(kind, rpm), COUNT).freq
            add(kind, blade(kind), f"freq_hz at {rpm} rpm", found, time.perf_counter() - started)
        started = time.perf_counter()
        basis = reduce(blade(kind), AtNodes(tip_nodes(blade(kind))), modes=COUNT)
        add(kind, blade(kind), "compliance", basis.compliance, time.perf_counter() - started)
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Run CalculiX on every mesh; print and write the table."""
    if shutil.which("ccx") is None:
        raise SystemExit("ccx: not installed; data/reference/imported_blade_calculix.csv has what it gave")
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kind in list(MESHES)[: 1 if quick else None]:
            for rpm in RPM:
                values = frequencies(blade(kind), rpm, folder)
                rows += [{"cells": kind, "quantity": f"freq_hz at {rpm} rpm", "index": k, "value": v}
                         for k, v in enumerate(values, 1)]  # fmt: skip
            flat = compliance(blade(kind), folder).ravel().tolist()
            rows += [{"cells": kind, "quantity": "compliance", "index": k, "value": v} for k, v in enumerate(flat, 1)]
    show("A twisted blade in CalculiX", rows[:COUNT])
    write(out / "imported_blade_calculix.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
