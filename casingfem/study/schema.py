"""Schema of study.toml (pydantic): the keys, their types and ranges, all SI.

Every table may be missing here, so that one bad table does not hide the problems of the others; `REQUIRED`
names those that the study of a shell on a chart cannot do without; one of an imported mesh needs the first.
"""

from typing import Any

from pydantic import ConfigDict, Field

from casingfem.study.tables import shapes
from casingfem.study.tables.fields import CyclicTable, ImperfectionTable
from casingfem.study.tables.rig import RigTable
from casingfem.study.tables.supports import StiffenerTable, SupportTable
from casingfem.study.tables.table import Edge, Table
from casingfem.study.tables.tasks import ModesTable, ReduceTable, UpdateTable

REQUIRED = ("material", "chart", "shell")


class StudyFile(Table):
    """A whole study.toml."""

    model_config = ConfigDict(
        json_schema_extra={"required": ["material"], "anyOf": [{"required": ["shell"]}, {"required": ["solid"]}]},
        title="study.toml",
    )

    material: shapes.MaterialTable | None = Field(default=None, description="E, nu, rho")
    chart: shapes.ChartTable | None = Field(default=None, description="kind and dimensions")
    shell: shapes.ShellTable | None = Field(default=None, description="thickness; mesh if imported")
    solid: shapes.SolidTable | None = Field(default=None, description="mesh, instead of [chart] and [shell]")
    taper: shapes.TaperTable | None = Field(default=None, description="how the thickness varies by design")
    strip: list[shapes.StripTable] = Field(default=[], description="tables [[strip]]")
    stiffener: list[StiffenerTable] = Field(default=[], description="tables [[stiffener]]: rings on the wall")
    rotation: shapes.RotationTable | None = Field(default=None, description="speed and axis")
    cyclic: CyclicTable | None = Field(default=None, description="the imported mesh is one sector of a wheel")
    imperfection: list[ImperfectionTable] = Field(default=[], description="tables [[imperfection]]")
    mass: list[shapes.MassTable] = Field(default=[], description="tables [[mass]]: point masses on edges")
    support: dict[Edge, SupportTable] = Field(default={}, description="edge or group -> kind and stiffnesses")
    modes: ModesTable = Field(default=ModesTable(), description="how many modes")
    mesh: shapes.MeshTable = Field(default=shapes.MeshTable(), description="how the shell is divided")
    update: UpdateTable | None = Field(default=None, description="the measured table and what may vary")
    reduce: ReduceTable | None = Field(default=None, description="the modal basis")
    rig: RigTable | None = Field(default=None, description="the virtual test rig")


def schema() -> dict[str, Any]:
    """JSON schema of study.toml.

    >>> sorted(schema()["properties"])[:4]
    ['chart', 'cyclic', 'imperfection', 'mass']
    """
    return StudyFile.model_json_schema()
