"""Two blocks whose meshes do not match, tied, against one mesh: frequencies, and a constant tension across the joint.

`python -m reports.verification.modes.ties [--quick] [--out DIR]`. Blocks of 0.3 and 0.4 m in a row, 0.1 by 0.12 m,
clamped at one end; the first has m x m x m cells, the other n x n x n, its nodes follow. In tension Poisson's ratio is
0, so the exact stress is uniform. Its error, at the nodes of both faces, is that of a tie at nodes.
"""

from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.interface.output import NodeStress
from casingfem.modal.mesh_modes import mesh_modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.imported.attachments.glue import Gluing, tied
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.loads import solve_mesh_static
from casingfem.structure.imported.mesh.mesh_data import MeshData, beside
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from casingfem.structure.shell.loads import EdgeLoad
from reports.tables import Row, command_line, show, write

STEEL, PLAIN = (Material(E=210e9, nu=nu, rho=7800.0) for nu in (0.3, 0.0))
ENDS = {"low": (0, 0.0), "high": (0, 1.0)}
COUNT = 6
CASES = (("hexahedron20", 2, 3), ("hexahedron20", 4, 6), ("tetra10", 2, 3), ("tetra10", 4, 6))


def block(kind: str, counts: tuple[int, int, int], start: float, length: float) -> MeshData:
    """A block along x."""
    return grid_mesh(kind, counts, lambda u: u * [length, 0.1, 0.12] + [start, 0.0, 0.0], groups=ENDS)


def pair(kind: str, m: int, n: int) -> MeshData:
    """The two blocks, tied."""
    both = beside({"a": block(kind, (m, m, m), 0.0, 0.3), "b": block(kind, (n, n, n), 0.3, 0.4)})
    return tied(both, [Gluing(follower="b.low", master="a.high")])


def tension(mesh: MeshData) -> tuple[float, float]:
    """Largest error of the stress at the joint, and that of the end's mean displacement, both relative."""
    part = Solid(mesh=mesh, material=PLAIN, supports={"a.low": Clamped()})
    system = part.assembled()
    found = solve_mesh_static(part, [EdgeLoad(edge="b.high", force=(1e6, 0.0, 0.0))], system=system)
    joint = np.union1d(mesh.groups["a.high"].nodes, mesh.groups["b.low"].nodes)
    rows = [NodeStress(name="s", node=int(mesh.node_numbers[k]), component="xx").row(system) for k in joint]
    stress: FloatArray = np.array([np.sum(row * found.fields) for row in rows])
    end = found.fields[mesh.groups["b.high"].nodes, 0].mean()
    return float(np.abs(stress / 1e6 - 1.0).max()), abs(float(end) / (1e6 * 0.7 / PLAIN.E) - 1.0)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Every pair of meshes."""
    rows: list[Row] = []
    for kind, m, n in CASES[:1] if quick else CASES:
        mesh = pair(kind, m, n)
        freq = mesh_modes(Solid(mesh=mesh, material=STEEL, supports={"a.low": Clamped()}), COUNT).freq
        one = block(kind, (2 * n, n, n), 0.0, 0.7)
        exact = mesh_modes(Solid(mesh=one, material=STEEL, supports={"low": Clamped()}), COUNT).freq
        stress, end = tension(mesh)
        rows.append(
            {
                "cells": kind, "meshes": f"{m} x {m} x {m}, {n} x {n} x {n}",
                "freq_deviation": float(np.abs(freq / exact - 1.0).max()), "stress_error": stress, "end_error": end,
            }
        )  # fmt: skip
    show("Tied blocks against one mesh, and the stress of a tension of 1 at their joint", rows)
    write(out / "ties.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
