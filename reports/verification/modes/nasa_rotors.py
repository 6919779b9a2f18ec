"""Blades of NASA rotors 37 and 67 beside CalculiX on the same mesh, at rest and at the design speed.

`python -m reports.verification.modes.nasa_rotors [--quick] [--out DIR]` meshes both blades from their published
sections (data/scenes/rotor37 and rotor67), clamped at the hub, in 24 x 20 x 1 bricks of 20 nodes with wedges at the
edges, and compares six frequencies with data/reference/nasa_rotors_calculix.csv. `--calculix` runs `ccx` where it is
installed and writes that table anew into DIR. The two programs integrate the wedges with different numbers of points;
frequencies differ by up to 0.02 % on 12 x 8 x 1 cells (quick), and by 2.2e-4 % on the mesh above.
"""

import math
import shutil
import tempfile
from pathlib import Path

import pandas as pd

import casingfem as cf
from reports.tables import DATA, Row, check, command_line, show, write
from reports.verification.modes import calculix

RPM = {"rotor37": 17188.7, "rotor67": 16043.0}
MATERIAL = {
    "rotor37": cf.Material(E=180e9, nu=0.3, rho=8000.0),  # 18-Ni-200 maraging steel
    "rotor67": cf.Material(E=114e9, nu=0.34, rho=4430.0),  # titanium Ti-6Al-4V
}
CELLS, COARSE, COUNT = (24, 20, 1), (12, 8, 1), 6
AXIS = cf.Rotation(omega=0.0, axis=(0.0, 0.0, 1.0))
TABLE = DATA / "reference" / "nasa_rotors_calculix.csv"
ALLOWED, OF_COARSE = 1e-3, 0.02  # %
CARD = """# Blades of NASA rotors 37 and 67, clamped at the hub section: frequencies at rest and at the design speed.
# Kind: computed, not measured; CalculiX 2.20 (ccx), by `python -m reports.verification.modes.nasa_rotors --calculix`.
# Meshes: C3D20 and C3D15, cells along chord, span and thickness; rotor 37: E 180 GPa, nu 0.3, rho 8000 kg/m^3;
# rotor 67: E 114 GPa, nu 0.34, rho 4430 kg/m^3. At speed: nonlinear static step, then a perturbation step.
# How sure: digits as printed (7). It integrates wedges at fewer points than this project: 2e-4 on the coarse mesh.
"""


def blade(name: str, cells: tuple[int, int, int] = CELLS, rpm: float = 0.0) -> cf.Solid:
    """The blade of a rotor, clamped at its root, turning about z."""
    sections = cf.imported.BladeSections.from_csv(DATA / "scenes" / name / "sections.csv")
    rotation = AXIS.at(2.0 * math.pi * rpm / 60.0) if rpm else None
    mesh = sections.mesh(cells)
    return cf.Solid(mesh=mesh, material=MATERIAL[name], supports={"root": cf.Clamped()}, rotation=rotation)


def run_calculix(out: Path) -> None:
    """Frequencies of both blades by CalculiX, written as the reference table."""
    if shutil.which("ccx") is None:
        raise SystemExit(f"ccx: found no such program, expected CalculiX on the path; {TABLE.name} has what it gave")
    rows: list[Row] = []
    for name, design in RPM.items():
        for cells in (COARSE, CELLS):
            for rpm in (0.0, design):
                with tempfile.TemporaryDirectory() as folder:
                    found = calculix.frequencies(blade(name, cells, rpm), rpm, Path(folder), axis=AXIS, count=COUNT)
                grid = " x ".join(map(str, cells))
                rows += [
                    {"rotor": name, "cells": grid, "rpm": rpm, "mode": k, "freq_hz": value}
                    for k, value in enumerate(found[:COUNT], 1)
                ]
    write(out / TABLE.name, rows)
    (out / TABLE.name).write_text(CARD + (out / TABLE.name).read_text())


def main(out: Path, quick: bool = False, calculix: bool = False) -> list[Row]:
    """Print the frequencies beside those of CalculiX; write nasa_rotors.csv."""
    if calculix:
        run_calculix(out)
    cells, allowed = (COARSE, OF_COARSE) if quick else (CELLS, ALLOWED)
    table = pd.read_csv(TABLE, comment="#")
    rows = []
    for (name, rpm), part in table[table["cells"] == " x ".join(map(str, cells))].groupby(["rotor", "rpm"]):
        found = cf.modes(blade(str(name), cells, float(rpm)), COUNT).freq
        rows += [
            check(f"{name} at {rpm:.0f} rpm, mode {k}", "CalculiX 2.20", reference, float(value), allowed)
            for k, (reference, value) in enumerate(zip(part["freq_hz"], found, strict=True), 1)
        ]
    show("NASA rotors 37 and 67, clamped at the hub section", rows)
    write(out / "nasa_rotors.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, calculix="run CalculiX and write its table")
