"""A casing with a round hole and a rectangular window: imported shell and solid, CalculiX's S8R on the same cells.

`python -m reports.verification.modes.cutouts [--quick] [--out DIR]` prints one table and writes cutouts.csv: how far
the 20 lowest frequencies of each model are from those of the finest imported shell. The casing is a cylinder R 0.3 m,
0.25 m high, 3 mm of steel, clamped at its base, its top free; the hole has a radius of 36 mm, the window lies opposite,
98 mm around and 71 mm high. Beside them stands the casing without cut-outs. CalculiX runs where it is installed.
--quick takes a thicker wall, 6 modes, coarse shells and a solid.
"""

import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.imported.grid import end_group, grid_mesh
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from reports.tables import Row, command_line, show, write
from reports.verification.modes.corner import by_calculix
from reports.verification.modes.meridians import STEEL

COUNT, RADIUS, HEIGHT, WALL = 20, 0.3, 0.25, 3e-3
AROUND, ROWS = 96, 14  # cells of the coarsest mesh
HOLE, HOLLOW, ROUND = 4, 2, 0.036  # a block of 4 x 4 cells to each side, half of it hollow; the hole's radius [m]
WINDOW = (2.5, 2.0)  # half the window's width and height in cells


def drilled(u: FloatArray) -> FloatArray:
    """Unit coordinates (around, along) -> places on the unrolled wall [m], the lattice drawn to the hole's edge.

    Round the middle of the block a point keeps its share of the way from the hole to the block's rim; directions are
    spread evenly.
    """
    flat = np.stack([2.0 * np.pi * RADIUS * u[:, 0], HEIGHT * u[:, 1]], axis=1)
    middle = np.array([np.pi * RADIUS * 0.5, 0.5 * HEIGHT])
    half = HOLE * np.array([2.0 * np.pi * RADIUS / AROUND, HEIGHT / ROWS])
    p = (flat - middle) / half
    m = np.abs(p).max(axis=1)
    near = (m < 1.0) & (m > 0.0)
    rim = p[near] / m[near, None]
    side = np.abs(rim).argmax(axis=1)
    along = np.take_along_axis(rim, side[:, None], axis=1)[:, 0]
    other = np.take_along_axis(rim, 1 - side[:, None], axis=1)[:, 0]
    lean = 0.25 * np.pi * other
    circle = np.empty_like(rim)
    np.put_along_axis(circle, side[:, None], (along * np.cos(lean))[:, None], axis=1)
    np.put_along_axis(circle, 1 - side[:, None], np.sin(lean)[:, None], axis=1)
    share = (m[near, None] - HOLLOW / HOLE) / (1.0 - HOLLOW / HOLE)
    flat[near] = middle + (1.0 - share) * ROUND * circle + share * rim * half
    return flat


def pierced(kind: str, finer: int, thickness: float, whole: bool = False) -> MeshData:
    """The casing's mesh: cells of the lattice without those of hole and window; solids have one through the wall."""
    solid = kind.startswith("hexahedron")
    counts = (finer * AROUND, finer * ROWS)
    grid = grid_mesh(
        kind, (1, *counts) if solid else counts, lambda u: u if solid else np.insert(u, 0, 0.5, axis=1), wrap=int(solid)
    )
    flat = grid.points[:, -2:]
    at = flat[grid.cells]
    at[..., 0] += (at[..., 0] < 0.5) & (at[..., :1].max(axis=1) > 0.75)  # of the cells that close the circle
    middle = at.mean(axis=1) * [AROUND, ROWS]
    from_hole = np.abs(middle - [0.25 * AROUND, 0.5 * ROWS]).max(axis=1)
    from_window = np.abs(middle - [0.75 * AROUND + 0.5, 0.5 * ROWS]) / WINDOW
    kept = (from_hole > HOLLOW) & (from_window.max(axis=1) > 1.0) | whole
    used, cells = np.unique(grid.cells[kept], return_inverse=True)
    u = grid.points[used]
    place = np.stack([2.0 * np.pi * RADIUS * u[:, -2], HEIGHT * u[:, -1]], axis=1) if whole else drilled(u[:, -2:])
    theta, r = place[:, 0] / RADIUS, RADIUS + thickness * (u[:, 0] - 0.5)
    points = np.stack([r * np.cos(theta), r * np.sin(theta), place[:, 1]], axis=1)
    mesh = MeshData(kind=kind, points=points, cells=cells.reshape(-1, grid.cells.shape[1]), source="pierced")
    ends = {"base": u[:, -1] == 0.0, "top": u[:, -1] == 1.0}
    return replace(mesh, groups={name: end_group(mesh, inside) for name, inside in ends.items()})


def shell(mesh: MeshData, thickness: float = WALL) -> MeshShell:
    """The casing as an imported shell."""
    return MeshShell(mesh=mesh, thickness=thickness, material=STEEL, supports={"base": Clamped()})


def models(quick: bool) -> dict[str, tuple[int, FloatArray]]:
    """Number of cells and lowest frequencies [Hz] of each model, the finest shell first."""
    thickness, count = (0.012, 6) if quick else (WALL, COUNT)
    found: dict[str, tuple[int, FloatArray]] = {}

    def add(name: str, structure: MeshShell | Solid) -> None:
        started = time.process_time()
        found[name] = len(structure.mesh.cells), modes(structure, count).freq[:count]
        print(f"{name}: {time.process_time() - started:.1f} s")

    if quick:
        add("imported shell", shell(pierced("quad9", 1, thickness), thickness))
        bricks = pierced("hexahedron27", 1, thickness)
        add("imported solid", Solid(mesh=bricks, material=STEEL, supports={"base": Clamped()}))
        return found
    add("imported shell, finer", shell(pierced("quad9", 2, thickness)))
    add("imported shell", shell(pierced("quad9", 1, thickness)))
    add("no cut-outs", shell(pierced("quad9", 1, thickness, whole=True)))
    for name, finer in {"CalculiX S8R": 1, "CalculiX S8R, finer": 2}.items() if shutil.which("ccx") else ():
        mesh = pierced("quad8", finer, thickness)
        found[name] = len(mesh.cells), by_calculix(mesh, count)
    return found


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table; returns its rows."""
    found = models(quick)
    exact = next(iter(found.values()))[1]
    rows: list[Row] = []
    for name, (cells, freq) in found.items():
        error = freq / exact - 1.0
        row: Row = {"model": name, "cells": cells, "first [Hz]": float(freq[0])}
        row |= {"worst %": float(100.0 * np.abs(error).max()), "rms %": float(100.0 * np.sqrt(np.mean(error**2)))}
        rows.append(row)
    show("A casing with a hole and a window", rows)
    write(out / "cutouts.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
