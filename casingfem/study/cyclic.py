"""Rotation in a study: [rotation], speed and axis; [cyclic], a wheel of equal or mistuned sectors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from casingfem.errors import InputError
from casingfem.io import strict_csv
from casingfem.io.arrays import FloatArray
from casingfem.modal.cyclic.mistuned import checked_deviations
from casingfem.modal.cyclic.modes import checked_diameters
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.geometry.rotation import Rotation, Vector
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.study.problems import Problems
from casingfem.study.tables.shapes import RotationTable
from casingfem.study.tables.tasks import StudyFile

NAMED = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wheel:
    """A wheel as [cyclic] describes it.

    Attributes
    ----------
    sector
        The wheel by its one sector.
    diameters
        Nodal diameters for the modes.
    coriolis
        Whether waves with Coriolis forces are also computed.
    deviations, blade
        Relative deviations of the blades' frequencies, None for a tuned wheel; the group of cells that deviates.
    """

    sector: CyclicSector
    diameters: tuple[int, ...]
    coriolis: bool
    deviations: FloatArray | None
    blade: str | None


def build_wheel(tables: StudyFile, structure: Solid | MeshShell | None, problems: Problems) -> Wheel | None:
    """The wheel of a study, or None with the reasons collected."""
    table = tables.cyclic
    if table is None:
        return None
    if tables.update is not None:
        problems.add("update", "[update] and [cyclic]", "a study of the sector alone, without [cyclic]", "study-key")
    if table.coriolis and tables.rotation is None:
        expected = "a table [rotation]: speed_hz, axis, point"
        problems.add("cyclic.coriolis", "true for a wheel at rest", expected, "study-missing")
    if structure is None:
        return None
    with problems.at("cyclic"):
        faces = None if table.faces is None else (table.faces[0], table.faces[1])
        sector = CyclicSector(
            structure=structure,
            sectors=table.sectors,
            axis=axis_vector(table.axis),
            point=vector(table.point),
            faces=faces,
            tolerance=table.tolerance,
        )
        deviations = None
        if isinstance(table.mistuning, str):
            deviations = read_deviations(problems.file.parent / table.mistuning)
        elif table.mistuning is not None:
            deviations = np.array(table.mistuning)
        if deviations is not None:
            deviations = checked_deviations(deviations, table.sectors)
        if table.blade is not None:
            check_groups(structure.mesh, [table.blade])
        return Wheel(
            sector=sector,
            diameters=checked_diameters(sector, table.nodal_diameters),
            coriolis=table.coriolis,
            deviations=deviations,
            blade=table.blade,
        )
    return None


def read_deviations(path: Path) -> FloatArray:
    """Deviations from a CSV file with columns blade,deviation; blades are counted from 1, in any order.

    Raises
    ------
    InputError
        The table is invalid; the message has the line.
    """
    table = strict_csv.read(path)
    if set(table.header) != {"blade", "deviation"}:
        expected = "blade,deviation"
        raise table.refuse_header(found=",".join(table.header), expected=expected)
    blades, deviations = table.integers("blade"), table.numbers("deviation")
    order = np.argsort(blades)
    if not np.array_equal(blades[order], np.arange(1, len(blades) + 1)):
        found = f"blades {', '.join(map(str, blades[order][:5]))}, ..."
        raise InputError(str(path), found=found, expected=f"each blade from 1 to {len(blades)} once")
    return np.asarray(deviations[order])


def build_rotation(table: RotationTable | None, chart: Chart | None, problems: Problems) -> Rotation | None:
    """The rotation of a study: for a blade on its hub, or about an axis in the chart's coordinates.

    A closed casing rotates about z unless an axis is named; an open chart needs a hub radius or an axis.
    """
    if table is None or chart is None:
        return None
    point = table.centre or table.point
    on_hub = table.hub_radius is not None or table.stagger_deg != 0.0
    if on_hub and (table.axis is not None or point is not None):
        found = "hub_radius or stagger_deg, and axis, centre or point"
        problems.add("rotation", found, "one of these two ways to place the axis")
        return None
    if not on_hub and table.axis is None and not chart.periodic:
        problems.add("rotation", "neither hub_radius nor axis on an open chart", "hub_radius, or axis and centre")
        return None
    omega = 2.0 * np.pi * table.speed_hz
    with problems.at("rotation"):
        if on_hub:
            stagger = float(np.radians(table.stagger_deg))
            return Rotation.of_blade(chart, omega=omega, hub_radius=table.hub_radius or 0.0, stagger=stagger)
        return Rotation(omega=omega, axis=axis_vector(table.axis), centre=vector(point))
    return None


def build_mesh_rotation(table: RotationTable | None, problems: Problems) -> Rotation | None:
    """The rotation of an imported part about an axis in the mesh's coordinates, which must be given."""
    if table is None:
        return None
    for key in ("hub_radius", "stagger_deg"):
        if key in table.model_fields_set:
            problems.add(f"rotation.{key}", "it on an imported mesh", "axis and point", "structure-chart")
    if table.axis is None:
        expected = "the axis of an imported part, such as [1.0, 0.0, 0.0]"
        problems.add("rotation.axis", "nothing", expected, "study-missing")
        return None
    with problems.at("rotation"):
        omega, point = 2.0 * np.pi * table.speed_hz, table.centre or table.point
        return Rotation(omega=omega, axis=axis_vector(table.axis), centre=vector(point))
    return None


def axis_vector(axis: str | list[float] | None) -> Vector:
    """An axis of a study, by name or by components; by default z."""
    return NAMED[axis] if isinstance(axis, str) else NAMED["z"] if axis is None else vector(axis)


def vector(numbers: list[float] | None) -> Vector:
    """Three numbers; by default the origin."""
    x, y, z = numbers or (0.0, 0.0, 0.0)
    return x, y, z
