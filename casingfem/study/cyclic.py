"""[cyclic] of a study: a wheel of equal sectors, perhaps mistuned."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from casingfem.errors import InputError
from casingfem.io import strict_csv
from casingfem.io.arrays import FloatArray
from casingfem.modal.cyclic.mistuned import checked_deviations
from casingfem.modal.cyclic.modes import checked_diameters
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.study.problems import Problems
from casingfem.study.rotation import axis_vector, vector
from casingfem.study.schema import StudyFile


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wheel:
    """What [cyclic] describes.

    Attributes
    ----------
    sector
        The wheel by its one sector.
    diameters
        Nodal diameters whose modes are wanted.
    coriolis
        Whether the waves with Coriolis forces are wanted too.
    deviations, blade
        Relative deviations of the blades' frequencies, None of a tuned wheel; the group of cells that deviates.
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
        problems.add("update", "an update beside [cyclic]", "a study of the sector alone", "study-key")
    if table.coriolis and tables.rotation is None:
        problems.add("cyclic.coriolis", "true at rest", "a table [rotation]: speed_hz, axis, point", "study-missing")
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
    """Deviations of a CSV file under blade,deviation, blades counted from 1, in any order.

    Raises
    ------
    InputError
        Naming the line.
    """
    table = strict_csv.read(path)
    if set(table.header) != {"blade", "deviation"}:
        expected = "blade,deviation"
        raise InputError(str(path), line=table.header_line, found=",".join(table.header), expected=expected)
    blades, deviations = table.integers("blade"), table.numbers("deviation")
    order = np.argsort(blades)
    if not np.array_equal(blades[order], np.arange(1, len(blades) + 1)):
        found = f"blades {', '.join(map(str, blades[order][:5]))}, ..."
        raise InputError(str(path), found=found, expected=f"each of 1 to {len(blades)} once")
    return np.asarray(deviations[order])
