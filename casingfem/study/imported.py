"""A study of an imported mesh: [solid], or [shell] with a mesh, instead of a chart."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.imported.mesh_data import MeshData
from casingfem.structure.imported.read import read_mesh
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.imported.support import Fixed, MeshSupport
from casingfem.structure.material import Material
from casingfem.study.problems import Problems, StudyError
from casingfem.study.schema import StudyFile
from casingfem.study.tables.shapes import ImportTable
from casingfem.study.tables.supports import ElasticTable, FixedTable, SupportTable

OWN = ("material", "solid", "shell", "support", "modes")  # the tables of such a study; others need a chart


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshStudy:
    """What a study file on an imported mesh describes; it has modes, and cannot be updated or reduced.

    Attributes
    ----------
    path, file
        Where it was read from, and its tables as written.
    structure
        The solid or shell.
    source
        Name and hash of the input (the file and its mesh), versions, seed: what a result carries.
    """

    path: Path
    file: StudyFile
    structure: Solid | MeshShell
    source: dict[str, Any]

    def error(self, key: str, found: str, expected: str) -> StudyError:
        """An error that names this file and a key of it, to be raised."""
        problems = Problems(self.path)
        problems.add(key, found, expected)
        return StudyError(problems)


def is_imported(data: Mapping[str, Any]) -> bool:
    """Whether the tables of a file are those of an imported mesh."""
    shell = data.get("shell")
    return "solid" in data or (isinstance(shell, dict) and "mesh" in shell)


def build_imported(tables: StudyFile, data: Mapping[str, Any], problems: Problems) -> Solid | MeshShell | None:
    """The structure of a mesh study, or None with the reasons collected."""
    for name in data:
        if name in StudyFile.model_fields and name not in OWN:
            problems.add(
                name, "a table for shells on a chart", f"no [{name}] beside an imported mesh, which has modes only"
            )
    if "solid" in data and "shell" in data:
        problems.add("shell", "it beside [solid]", "one of the two")
    material = None
    if tables.material is not None:
        with problems.at("material"):
            material = Material(**tables.material.model_dump())
    supports = build_supports(tables.support, problems)
    table, key = (tables.solid, "solid") if tables.solid is not None else (tables.shell, "shell")
    mesh = None if table is None else build_mesh(table, key, problems)
    if mesh is None or material is None or problems:
        return None
    with problems.at(key):
        if tables.solid is not None:
            own = {name: Material(**part.model_dump()) for name, part in tables.solid.material.items()}
            return Solid(mesh=mesh, material=material, materials=own, supports=supports)
        if tables.shell is not None:
            return MeshShell(mesh=mesh, thickness=tables.shell.thickness, material=material, supports=supports)
    return None


def build_mesh(table: ImportTable, key: str, problems: Problems) -> MeshData | None:
    """The mesh a table names, read relative to the study."""
    if table.mesh is not None:
        with problems.at(f"{key}.mesh"):
            return read_mesh(problems.file.parent / table.mesh, scale=table.scale, join=table.join)
    return None


def build_supports(tables: Mapping[str, SupportTable], problems: Problems) -> dict[str, MeshSupport]:
    """Supports by group; kinds that need a chart are collected."""
    supports: dict[str, MeshSupport] = {}
    for group, table in tables.items():
        key = f"support.{group}"
        if isinstance(table, FixedTable):
            with problems.at(key):
                supports[group] = Fixed(directions=tuple(table.directions))
        elif isinstance(table, ElasticTable):
            if table.model_fields_set - {"kind", "k_face"}:
                problems.add(
                    key, ", ".join(sorted(table.model_fields_set - {"kind", "k_face"})), "k_face alone on a mesh"
                )
                continue
            with problems.at(key):
                supports[group] = ElasticEdge(k_face=table.k_face)
        elif table.kind == "clamped":
            supports[group] = Clamped()
        else:
            problems.add(f"{key}.kind", repr(table.kind), "clamped, fixed or elastic on an imported mesh")
    return supports
