"""A study of an imported mesh or of blade sections: [solid], or [shell] with a mesh, instead of a chart."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.modal.interface.kinds import AtNodes, Interface, Rim, Tip, TipNodes
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.imported.attachments.glue import Gluing, tied
from casingfem.structure.imported.cells.support import Fixed, MeshSupport
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.read import read_mesh
from casingfem.structure.imported.sections import BladeSections
from casingfem.structure.imported.sector_mesh import DiskRing
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from casingfem.study.build import build_plies
from casingfem.study.cyclic import Wheel, axis_vector, build_mesh_rotation, vector
from casingfem.study.problems import FromFile, Problems
from casingfem.study.tables.shapes import ImportTable, SolidTable
from casingfem.study.tables.supports import ElasticTable, FixedTable, SupportTable
from casingfem.study.tables.tasks import ReduceTable, StudyFile
from casingfem.updating.parameters import Parameter
from contact.io.tables import value_of

# tables of an imported part; others need a chart
OWN = ("material", "solid", "shell", "support", "modes", "rotation", "update", "reduce", "cyclic", "response", "checks")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshStudy(FromFile):
    r"""A study on an imported mesh, as its file describes it.

    Attributes
    ----------
    path, file
        Path of the file, and its tables as written.
    structure
        The solid or shell.
    start
        The structure with the start values of the parameters, where an update begins.
    table, parameters
        From [update]: the measured frequencies, None without; the parameters.
    interface
        From [reduce]: the interface for contact; None without.
    wheel
        From [cyclic]: the wheel of which the structure is one sector; None without.
    source
        Name and hash of the input (the file and its mesh), versions, seed, for results.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> mesh = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n"
    >>> text = '[material]\nE = 210e9\nnu = 0.3\nrho = 7800.0\n[shell]\nmesh = "wall.inp"\nthickness = 0.01\n'
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "wall.inp").write_text(mesh), Path(folder, "study.toml").write_text(text)
    ...     study = cf.load_study(Path(folder, "study.toml"))
    >>> isinstance(study, cf.study.MeshStudy), study.structure.thickness
    (True, 0.01)
    """

    path: Path
    file: StudyFile
    structure: Solid | MeshShell
    start: Solid | MeshShell
    table: FrequencyTable | None
    parameters: tuple[Parameter, ...]
    interface: Interface | None
    wheel: Wheel | None
    source: dict[str, Any]

    @property
    def shapes(self) -> None:
        """None: shapes are fitted only on charts."""
        return None


def is_imported(data: Mapping[str, Any]) -> bool:
    """Whether the tables of a file are those of an imported mesh."""
    shell = data.get("shell")
    return "solid" in data or (isinstance(shell, dict) and "mesh" in shell)


def build_imported(tables: StudyFile, data: Mapping[str, Any], problems: Problems) -> Solid | MeshShell | None:
    """The structure of a mesh study, or None with the collected reasons."""
    for name in data:
        if name in StudyFile.model_fields and name not in OWN:
            expected = f"no [{name}] beside an imported mesh"
            problems.add(name, "a table for shells on a chart", expected, "structure-chart")
    if "solid" in data and "shell" in data:
        problems.add("shell", "[shell] and [solid]", "one of the two")
    material = problems.made("material", Material, tables.material)
    supports = build_supports(tables.support, problems)
    rotation = build_mesh_rotation(tables.rotation, problems)
    table, key = (tables.solid, "solid") if tables.solid is not None else (tables.shell, "shell")
    sectors = None if tables.cyclic is None else tables.cyclic.sectors
    mesh = None if table is None else build_mesh(table, key, sectors, problems)
    if mesh is None or material is None or problems:
        return None
    with problems.at(key):
        if tables.solid is not None:
            own = {name: value_of(part, Material) for name, part in tables.solid.material.items()}
            return Solid(mesh=mesh, material=material, materials=own, supports=supports, rotation=rotation)
        if tables.shell is not None:
            return MeshShell(
                mesh=mesh,
                thickness=tables.shell.thickness,
                thicknesses=tables.shell.thicknesses,
                material=material,
                materials={name: value_of(part, Material) for name, part in tables.shell.material.items()},
                supports=supports,
                rotation=rotation,
                wall=tables.shell.wall,
                plies=build_plies(tables.shell),
                angle_from=axis_vector(tables.shell.angle_from),
            )
    return None


def mesh_interface(
    table: ReduceTable | None, structure: Solid | MeshShell | None, problems: Problems
) -> Interface | None:
    """Interface in [reduce] of an imported mesh: nodes, a rim by harmonics, a tip in pieces or as a whole."""
    if table is None:
        return None
    rim = sorted({"n_max", "axial", "axis", "point"} & table.model_fields_set)
    of_rim_alone = [key for key in rim if key in ("n_max", "axial")]
    for key in ("lines", *(of_rim_alone if table.nodes is not None else ())):
        if key in table.model_fields_set:
            problems.add(f"reduce.{key}", str(getattr(table, key)), "no such key here", "study-key")
    if table.at is not None:
        for key in ("nodes", *rim):
            if key in table.model_fields_set:
                problems.add(f"reduce.{key}", f"{key} and at", "at alone", "study-key")
        return AtNodes(tuple(table.at))
    edge = table.interface or ""
    if structure is not None:
        with problems.at("reduce.interface"):
            check_groups(structure.mesh, [edge])
    if table.nodes is not None:
        axis = None if table.axis is None else axis_vector(table.axis)
        if axis is None and table.point is not None:
            problems.add("reduce.point", "a point without axis", "an axis through this point", "study-key")
        return TipNodes(edge, table.nodes, axis=axis, point=vector(table.point))
    if rim:
        n_max = 40 if table.n_max is None else table.n_max
        return Rim(edge, n_max, axial=table.axial, axis=axis_vector(table.axis), point=vector(table.point))
    return Tip(edge)


def build_mesh(table: ImportTable, key: str, sectors: int | None, problems: Problems) -> MeshData | None:
    """The mesh, or the mesh of the blade sections, that a table names, with paths relative to the study.

    A blade on a disk is one of the `sectors` of [cyclic].
    """
    if isinstance(table, SolidTable) and table.sections is not None:
        with problems.at(f"{key}.sections"):
            sections = BladeSections.from_csv(problems.file.parent / table.sections)
            if table.disk is None:
                with problems.at(f"{key}.cells"):
                    return sections.mesh(table.cells)
                return None
            if sectors is None:
                expected = "[cyclic] with sectors, the number of blades of the wheel"
                if not problems:  # else [cyclic] may be there with a mistake
                    problems.add(f"{key}.disk", "a disk without [cyclic]", expected, "study-missing")
                return None
            with problems.at(f"{key}.disk"):
                return sections.sector(sectors, value_of(table.disk, DiskRing), table.cells)
            return None
    if table.mesh is not None:
        with problems.at(f"{key}.mesh"):
            place = problems.file.parent / table.mesh
            mesh = read_mesh(place, scale=table.scale, join=table.join, units=table.units)
            faces = [value_of(tie, Gluing, where=f"{key}.tie {k}") for k, tie in enumerate(table.tie, 1)]
            return tied(mesh, faces)
    return None


def build_supports(tables: Mapping[str, SupportTable], problems: Problems) -> dict[str, MeshSupport]:
    """Supports by group; kinds that need a chart are reported."""
    supports: dict[str, MeshSupport] = {}
    for group, table in tables.items():
        key = f"support.{group}"
        if isinstance(table, FixedTable):
            with problems.at(key):
                supports[group] = Fixed(directions=tuple(table.directions))
        elif isinstance(table, ElasticTable):
            if others := table.model_fields_set - {"kind", "k_face"}:
                problems.add(key, ", ".join(sorted(others)), "k_face alone on a mesh")
                continue
            with problems.at(key):
                supports[group] = ElasticEdge(k_face=table.k_face)
        elif table.kind == "clamped":
            supports[group] = Clamped()
        else:
            problems.add(f"{key}.kind", repr(table.kind), "clamped, fixed or elastic on an imported mesh")
    return supports
