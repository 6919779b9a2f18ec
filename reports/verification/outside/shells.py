"""Shells: the double-cell box, the stiffened barrel, Raasch's hook, a clamped cylinder.

- The box: Fan and Luah, J. Sound Vib. 179, 1995, 763, and CalculiX 2.20 on eight-noded shells and on bricks.
- The barrel: Abaqus, three-noded STRI3, as FinEtoolsFlexStructures.jl (P. Krysl, MIT) quotes it; `modes.barrel`.
- The hook: N. F. Knight, AIAA J. 35, 1997, 305; the solid's 5.022 in as FinEtoolsFlexStructures.jl quotes it.
- The cylinder: an example on ADINA's news page, as the same package quotes it; torsion is a wave in closed form.
"""

import math
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.imported.loads import solve_mesh_static
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from casingfem.structure.shell.loads import EdgeLoad
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, write
from reports.verification.modes import barrel, branching, calculix
from reports.verification.outside.columns import row

TABLE = DATA / "reference" / "branching_calculix.csv"
CARD = """# Shells that branch in CalculiX 2.20 (ccx), by `python -m reports.verification.outside --calculix`.
# Kind: computed, not measured. box: double-cell box of Fan and Luah; barrel: reports.verification.modes.barrel.
# S8R: eight-noded shells, which CalculiX makes bricks of, rigid where walls meet; C3D20R: bricks with solid corners.
# mesh: cells on 1.27 m of the box; cells around the barrel. How sure: digits as printed (7); S8R falls with the mesh.
"""
BOX_SHELLS, BOX_BRICKS = 32, 16
BRICKS = "the corners of bricks are solid, 12.7 mm wide; walls of a shell meet in a line"
HOOK = 5.022  # in
STEEL = Material(E=200e9, nu=0.3, rho=7800.0)


def box_of_bricks(n: int) -> Solid:
    """The box of 20-noded bricks, one through each wall, n on the short side."""
    side, half = branching.SIDE, 0.5 * branching.WALL
    x = barrel.stations(-half, 1, half, n, side - half, 1, side + half)
    y = np.concatenate([x, side + x[2:]])
    z = np.linspace(0.0, 2.0 * side, 2 * n + 1)
    middle_x, middle_y = (0.5 * (along[1:] + along[:-1]) for along in (x, y))
    in_x = (np.abs(middle_x[:, None] - side * np.arange(2)) < half).any(axis=1)
    in_y = (np.abs(middle_y[:, None] - side * np.arange(3)) < half).any(axis=1)
    used = np.repeat((in_x[:, None] | in_y).ravel(), 2 * n)
    mesh = branching.joined("hexahedron20", [branching.grid("hexahedron20", x, y, z)[used]], 2)
    return Solid(mesh=mesh, material=branching.BOX, supports={"base": Clamped()})


def of_calculix(part: MeshShell | Solid, count: int) -> FloatArray:
    """Lowest elastic frequencies [Hz] of a part in CalculiX: S8R for shells, C3D20R for bricks."""
    mesh, held = part.mesh, "base" in part.supports
    section = "*SOLID SECTION,ELSET=body,MATERIAL=M\n"
    if isinstance(part, MeshShell):
        used, cells = np.unique(mesh.cells[:, :8], return_inverse=True)  # without the ninth nodes
        base = Group(nodes=np.flatnonzero(np.isin(used, mesh.groups["base"].nodes)))
        mesh = MeshData(
            kind="quad8", points=mesh.points[used], cells=cells.reshape(-1, 8), groups={"base": base}, source="shell"
        )
        section = f"*SHELL SECTION,ELSET=body,MATERIAL=M\n{part.thickness!r}\n"
    with tempfile.TemporaryDirectory() as name:
        text = calculix.mesh_deck(mesh, part.material, Path(name)).replace("C3D20", "C3D20R") + section
        text += "*BOUNDARY\nbase,1,6\n" * held
        rigid = 0 if held else barrel.RIGID
        text += f"*STEP\n*FREQUENCY\n{count + rigid}\n*END STEP\n"
        return np.array(calculix.eigenfrequencies(calculix.run(text, Path(name))))[rigid : rigid + count]


def run_calculix(out: Path) -> None:
    """CalculiX on every mesh, written as the reference table."""
    parts: list[tuple[str, str, int, MeshShell | Solid, int]] = [
        *(("box", "S8R", n, branching.box("quad8", n), 4) for n in (8, 16, 32)),
        *(("box", "C3D20R", n, box_of_bricks(n), 4) for n in (8, 16)),
        *(("barrel", "S8R", n, barrel.barrel(*sizes), 10) for n, sizes in ((48, (48, 3, 4)), (64, (64, 4, 5)))),
    ]
    rows: list[Row] = []
    for part, cells, mesh, structure, count in parts:
        found = of_calculix(structure, count).tolist()
        rows += [{"part": part, "cells": cells, "mesh": mesh, "mode": k, "freq_hz": f} for k, f in enumerate(found, 1)]
    write(out / TABLE.name, rows)
    (out / TABLE.name).write_text(CARD + (out / TABLE.name).read_text())


def in_calculix(part: str, cells: str, mesh: int) -> FloatArray:
    """Frequencies [Hz] of the reference table."""
    table = pd.read_csv(TABLE, comment="#")
    return table[(table["part"] == part) & (table["cells"] == cells) & (table["mesh"] == mesh)]["freq_hz"].to_numpy()


def box() -> list[Row]:
    """Four frequencies of the box: eight-noded cells, 8 on the short side."""
    found = modes(branching.box("quad8", 8), 4).freq
    rows = [
        row("published", f"double-cell box, mode {k}", "Fan and Luah 1995", exact, value, 0.5)
        for k, (exact, value) in enumerate(zip(branching.FAN_LUAH, found, strict=True), 1)
    ]
    for cells, mesh, name, gap in (
        ("S8R", BOX_SHELLS, f"shells, {BOX_SHELLS} on the short side", 0.0),
        ("C3D20R", BOX_BRICKS, f"bricks, {BOX_BRICKS} on the short side", 0.65),
    ):
        rows += [
            row("program", f"double-cell box, {name}, mode {k}", "CalculiX 2.20", exact, value, 0.5,
                gap=gap, reason=BRICKS)
            for k, (exact, value) in enumerate(zip(in_calculix("box", cells, mesh), found, strict=True), 1)
        ]  # fmt: skip
    return rows


def stiffened(quick: bool) -> list[Row]:
    """Five pairs of the barrel."""
    around = 48 if quick else 64
    freq = modes(barrel.barrel(48, 3, 4) if quick else barrel.barrel(), 16).freq[barrel.RIGID :: 2]
    rows = [
        row("program", f"barrel with T stiffeners, pair {k}", "Abaqus STRI3", exact, value, 0.52 if quick else 0.2)
        for k, (exact, value) in enumerate(zip(barrel.ABAQUS, freq, strict=True), 1)
    ]
    reason = "rigid joints as wide as the wall make CalculiX's shells stiff; it falls with the mesh"
    return rows + [
        row("program", f"barrel with T stiffeners, {around} cells around, pair {k}", "CalculiX 2.20", exact, value, 0.5,
            gap=1.1, reason=reason)
        for k, (exact, value) in enumerate(zip(in_calculix("barrel", "S8R", around)[::2], freq, strict=True), 1)
    ]  # fmt: skip


def hook(along: int, across: int) -> MeshShell:
    """Raasch's hook [in, psi]: arcs of 14 in over 60 degrees and 46 in over 150, 20 in wide, 2 in thick."""
    first = 2 * along // 7
    turn = np.radians(
        np.concatenate([np.linspace(0.0, 60.0, first + 1), np.linspace(60.0, 210.0, along - first + 1)[1:]])
    )
    a, z = np.moveaxis(branching.grid("quad8", turn, np.linspace(0.0, 20.0, across + 1)), 2, 0)
    bend, tilt = math.radians(60.0), math.radians(30.0)
    centre = 14.0 * math.sin(bend) + 46.0 * math.cos(tilt), 14.0 * (1.0 - math.cos(bend)) - 46.0 * math.sin(tilt)
    inner = a <= bend + 1e-9
    x = np.where(inner, 14.0 * np.sin(a), centre[0] - 46.0 * np.cos(a - bend + tilt))
    y = np.where(inner, 14.0 * (1.0 - np.cos(a)), centre[1] + 46.0 * np.sin(a - bend + tilt))
    mesh = branching.joined("quad8", [np.stack([x, y, z], axis=-1)], 0)
    tip = np.array([x[a > turn[-1] - 1e-9][0], y[a > turn[-1] - 1e-9][0]])
    base, end = (np.flatnonzero(np.hypot(*(mesh.points[:, :2] - at).T) < 1e-6) for at in (np.zeros(2), tip))
    groups = {"base": Group(nodes=base), "end": Group(nodes=end)}
    held = MeshData(kind="quad8", points=mesh.points, cells=mesh.cells, groups=groups, source="hook")
    return MeshShell(
        mesh=held, thickness=2.0, material=Material(E=3300.0, nu=0.35, rho=1.0), supports={"base": Clamped()}
    )


def hook_tip(along: int, across: int) -> float:
    """Mean displacement of the hook's end along its width under 1 lbf of in-plane shear [in]."""
    shell = hook(along, across)
    found = solve_mesh_static(shell, [EdgeLoad(edge="end", force=(0.0, 0.0, 0.05))])
    return float(found.fields[shell.mesh.groups["end"].nodes, 2].mean())


def cylinder() -> list[Row]:
    """The cylinder of ADINA's page, both ends clamped: lowest pair, torsion."""
    length = 0.4
    shell = Shell(
        chart=Cylinder(radius=0.1, height=length), thickness=0.01, material=STEEL,
        supports={"base": Clamped(), "top": Clamped()},
    )  # fmt: skip
    found = modes(shell, 16)
    wave = math.sqrt(STEEL.shear_modulus / STEEL.rho) / (2.0 * length)
    torsion = float(found.freq[np.abs(found.freq / wave - 1.0).argmin()])
    open_ = "the page states neither its cells nor its accuracy"
    return [
        row("program", "clamped cylinder, n = 2", "ADINA's news page", 1701.0, float(found.freq[0]), 0.3, open_=open_),
        row("program", "clamped cylinder, torsion", "ADINA's news page", 3926.0, torsion, 0.02, open_=open_),
    ]


def rows(quick: bool) -> list[Row]:
    """All rows of shells."""
    sizes, allowed = ((56, 8), 0.6) if quick else ((112, 16), 0.3)
    solid = "solid of 20-noded bricks, quoted by FinEtoolsFlexStructures"
    tip = row("program", "Raasch's hook, displacement of its end [in]", solid, HOOK, hook_tip(*sizes), allowed)
    return [*box(), *stiffened(quick), tip, *cylinder()]
