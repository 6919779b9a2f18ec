"""Broken models, part two: as files give them, study.toml and imported meshes."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import casingfem as cf
from casingfem.structure.imported.grid import grid_mesh
from casingfem.study import load_shell_study
from reports.verification.robustness.broken.shells import Broken, steel

STUDY = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "frustum"
r_base = 0.50
r_top = 0.45
height = 0.25
[shell]
thickness = 20e-3
[[imperfection]]
of = "radius"
survey = "survey.csv"
n_max = 4
degree = 1
[support.base]
kind = "clamped"
[modes]
count = 2
[mesh]
order = 6
rows = 1
around = 9
"""
FREE = '[support.base]\nkind = "clamped"\n[modes]\ncount = 2'
SURVEY = ["# SYNTHETIC: made for this test", "theta_deg,z_m,radius_m"]
SURVEY += [f"{a},{z},{0.5 - 0.2 * z:.3f}" for z in (0.0, 0.125, 0.25) for a in range(0, 360, 10)]
BRICKS = grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * [0.2, 0.1, 0.05], groups={"root": (0, 0.0)})


def study(old: str = "", new: str = "", survey: Callable[[str], str] = str) -> Callable[[], object]:
    """Modes of the study with one text replaced, on the survey with its text changed."""

    def make() -> object:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "study.toml"
            (path.parent / "survey.csv").write_text(survey("\n".join(SURVEY) + "\n"), encoding="utf-8")
            path.write_text(STUDY.replace(old, new, 1) if old else STUDY + new, encoding="utf-8")
            found = load_shell_study(path)
            return cf.modes(found.shell, found.file.modes.count)

    return make


def other(scale: float) -> Callable[[str], str]:
    """The survey of a casing of another size."""

    def change(text: str) -> str:
        head, *lines = text.splitlines()
        cells = [line.split(",") for line in lines[1:]]
        return "\n".join([head, lines[0], *(f"{a},{z},{scale * float(r):.4f}" for a, z, r in cells)]) + "\n"

    return change


def studies() -> list[Broken]:
    """Study files."""
    return [
        Broken("study: not TOML", study("nu = 0.3", "nu = = 0.3"), "study-toml"),
        Broken("study: an edge supported twice", study(new='[support.base]\nkind = "clamped"\n'), "study-toml"),
        Broken("study: misspelt key", study("thickness =", "thicknes ="), "study-key"),
        Broken("study: no chart height", study("height = 0.25\n", ""), "study-missing"),
        Broken("study: E as text", study("210e9", '"210 GPa"'), "material-modulus"),
        Broken("study: nu 0.7", study("nu = 0.3", "nu = 0.7"), "material-poisson"),
        Broken("study: thickness nan", study("20e-3", "nan"), "shell-thickness"),
        Broken("study: support on no edge", study("support.base", "support.bottom"), "support-edge"),
        Broken("study: no support", study(FREE, "[modes]\ncount = 12"), "shell-free"),
        Broken("study: lengths in mm", study("thickness = 20e-3", "thickness = 20"), "shell-thickness-size"),
        Broken("study: rows descending", study("rows = 1", "rows = [0.0, 0.7, 0.4, 1.0]"), "mesh-rows"),
        Broken("survey of another casing", study(survey=other(1.6)), "survey-other"),
        Broken("survey in mm", study(survey=other(1e3)), "survey-table"),
        Broken("survey of the radius taken for thickness", study('of = "radius"', 'of = "thickness"'),
               "survey-quantity"),
        Broken("survey with a cell missing", study(survey=lambda text: text.replace(",0.500\n", ",\n", 1)),
               "survey-table"),
        Broken("survey too sparse for its fit", study("n_max = 4", "n_max = 40"), "survey-table"),
        Broken("survey file missing", study("survey.csv", "no.csv"), "study-file"),
    ]  # fmt: skip


def bricks(
    cells: Callable[[Any], Any] | None = None, points: Callable[[Any], Any] | None = None, **parts: Any
) -> object:
    """Modes of a clamped beam of bricks with cells or points changed."""
    changed = {"cells": cells(BRICKS.cells.copy()) if cells else BRICKS.cells}
    changed["points"] = points(BRICKS.points.copy()) if points else BRICKS.points
    mesh = cf.imported.MeshData(kind=BRICKS.kind, groups=BRICKS.groups, source="part.msh", **changed)
    solid = {"material": steel(), "supports": {"root": cf.Clamped()}} | parts
    return cf.modes(cf.Solid(mesh=mesh, **solid), 2)


def torn(cells: Any) -> Any:
    """The second brick on nodes of its own."""
    apart = np.flatnonzero(np.isin(cells[1], cells[0]))
    cells[1, apart] = len(BRICKS.points) + np.arange(len(apart))
    return cells


def copied(points: Any) -> Any:
    """The nodes of `torn`, at the same places."""
    shared = BRICKS.cells[1][np.isin(BRICKS.cells[1], BRICKS.cells[0])]
    return np.vstack([points, points[shared]])


def meshes() -> list[Broken]:
    """Imported meshes; `tests/casingfem/structure/imported/test_mesh_checks.py` has more."""
    mirror = np.array([-1.0, 1.0, 1.0])
    return [
        Broken("mesh: inside out", lambda: bricks(points=lambda x: x * mirror), "mesh-inverted-cell"),
        Broken("mesh: scrambled", lambda: bricks(cells=lambda c: c[:, [1, 0, *range(2, 20)]]), "mesh-scrambled-cell"),
        Broken("mesh: open seam", lambda: bricks(cells=torn, points=copied), "mesh-open-seam"),
        Broken("mesh: nan", lambda: bricks(points=lambda x: np.where(x == x.max(), NAN_POINT, x)), "mesh-not-finite"),
        Broken("mesh: in mm", lambda: bricks(points=lambda x: 1e3 * x), "mesh-units"),
        Broken("mesh: E in MPa", lambda: bricks(material=steel(E=210e3)), "material-units"),
        Broken("mesh: support on no group", lambda: bricks(supports={"rott": cf.Clamped()}), "mesh-no-group"),
    ]


NAN_POINT = float("nan")


def rows() -> list[Broken]:
    """All of them."""
    return [*studies(), *meshes()]
