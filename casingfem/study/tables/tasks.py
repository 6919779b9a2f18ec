"""Tables of tasks (modes, an update, a reduction) and the whole of study.toml.

Every table may be missing here, so that one bad table does not hide the problems of the others. `REQUIRED` names the
tables that the study of a shell on a chart needs. The study of an imported mesh needs only the first of them.
"""

from typing import Annotated, Any, Literal, Self, TypedDict

from pydantic import ConfigDict, Field, model_validator

from casingfem.modal.cyclic.engine_orders import OrderLoad
from casingfem.modal.interface.output import Displacement, NodeDisplacement, NodeStrain, NodeStress, Output, Strain
from casingfem.structure.imported.cells.solid import COMPONENTS
from casingfem.study.tables import shapes
from casingfem.study.tables.fields import CyclicTable, ImperfectionTable
from casingfem.study.tables.rig import RigTable
from casingfem.study.tables.supports import StiffenerTable, SupportTable
from casingfem.study.tables.table import Axis, Edge, Pair, Table, Vector
from casingfem.updating.parameters import Parameter
from contact.io.plausible import CHECKS, REACH, CheckName
from contact.io.tables import NotNegative, Positive, table_of

REQUIRED = ("material", "chart", "shell")


class Wanted(TypedDict, total=False):
    """Count or band [Hz] and method, the arguments of `modes`."""

    count: int
    band: tuple[float, float]
    method: str


class ModesTable(Table):
    """[modes]: a count, or a band."""

    count: int = Field(default=40, ge=1, le=100_000, description="number of modes")
    band_hz: list[NotNegative] | None = Field(
        default=None,
        min_length=2,
        max_length=2,
        description="band [from, to] of which all modes are computed [Hz], instead of count",
    )
    elastic_only: bool = Field(default=False, description="whether rigid-body modes are an error")
    method: Literal["auto", "shell", "fourier", "bolts"] = Field(
        default="auto",
        description="the model: shell (two-dimensional), fourier (one harmonic around at a time, perfect casings), "
        "bolts (harmonics coupled by the bolts, if nothing else varies around); auto takes fourier, bolts or shell",
    )

    @model_validator(mode="after")
    def _count_or_band(self) -> "ModesTable":
        if self.band_hz is not None and "count" in self.model_fields_set:
            raise ValueError("found count and band_hz, expected one of them")
        if self.band_hz is not None and not self.band_hz[0] < self.band_hz[1]:
            raise ValueError(f"found band_hz = {self.band_hz}, expected two frequencies in order")
        return self

    @property
    def wanted(self) -> Wanted:
        """Arguments for `modes`: count or band, and the method."""
        if self.band_hz is None:
            return {"count": self.count, "method": self.method}
        return {"band": (self.band_hz[0], self.band_hz[1]), "method": self.method}


@table_of(Parameter)
class ParameterTable(Table):
    """[[update.parameter]]."""

    name: str
    lower: float
    upper: float
    start: float | None = Field(
        default=None, description="start value [unit of the parameter]; the value of the study if left out"
    )


class UpdateTable(Table):
    """[update]."""

    table: str = Field(min_length=1, description="frequency table: CSV file or workbook, relative to this file")
    sigma: Positive | None = Field(
        default=None, lt=1, description="relative standard uncertainty of frequencies without sigma_hz in the table [-]"
    )
    outliers: Literal["set-aside", "keep"] = Field(
        default="set-aside", description="treatment of outliers, rows that do not agree with the others"
    )
    reach: Positive = Field(
        default=0.5,
        description="largest relative frequency difference of a measured and a computed mode that are paired [-]",
    )
    count: int | None = Field(
        default=None, ge=1, le=100_000, description="number of modes computed; from the table if left out"
    )
    model_error: float = Field(
        default=0.0,
        ge=0,
        lt=1,
        description="relative standard error of the model's frequencies [-], added to the measurement's",
    )
    shapes: str | None = Field(
        default=None, min_length=1, description="file of the measured mode shapes, a universal file or identified.npz"
    )
    shape_sigma: Positive | None = Field(
        default=None,
        description="relative noise of the shapes, rms over the rms of a shape [-]; that of the file if left out",
    )
    shape_error: float = Field(
        default=0.0, ge=0, lt=1, description="relative error of the model's shapes [-], added to the noise"
    )
    shape_reach: Positive = Field(
        default=1e-3, description="largest relative frequency difference of a shape and its row [-]"
    )
    regularise: Literal["discrepancy", "l-curve"] | None = Field(
        default=None,
        description="rule for the weight with which parameters are regularised towards their start values",
    )
    regularised: list[str] = Field(
        default=[], description="names of the regularised parameters; all harmonics if left out"
    )
    parameter: list[ParameterTable] = Field(
        min_length=1, description="tables [[update.parameter]]: varied parameters, at least one"
    )

    @model_validator(mode="after")
    def _of_shapes(self) -> "UpdateTable":
        alone = sorted({"shape_sigma", "shape_error", "shape_reach"} & self.model_fields_set)
        if alone and self.shapes is None:
            raise ValueError(f"found {', '.join(alone)} without shapes, expected shapes = a file with mode shapes")
        return self


class OutputTable(Table):
    """[[reduce.output]]: a displacement (direction), a strain, or a stress, at a place of the chart or a node."""

    name: str = Field(min_length=1, description="name of the output in results")
    at: Pair | None = Field(default=None, description="place on the chart, by its two parameters [m or rad]")
    node: int | None = Field(default=None, description="number of a node of an imported mesh")
    direction: Literal["x", "y", "z", "normal", "radial", "tangential"] | None = Field(
        default=None, description="direction of a displacement"
    )
    strain: Literal["11", "22", "12", "xx", "yy", "zz", "yz", "xz", "xy"] | None = Field(
        default=None, description="component of the strain"
    )
    stress: Literal["xx", "yy", "zz", "yz", "xz", "xy"] | None = Field(
        default=None, description="component of the stress"
    )
    side: float | None = Field(
        default=None,
        ge=-1,
        le=1,
        description="position through the wall [-], from 1 on the face to which the normal points to -1 on the other",
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        given = [value for value in (self.direction, self.strain, self.stress) if value is not None]
        if len(given) != 1 or (self.side is not None and self.strain is None):
            raise ValueError("found direction, strain, side that do not go together, expected direction, or strain")
        if (self.at is None) == (self.node is None):
            raise ValueError("found at and node, or neither, expected one: at on a chart, node on an imported mesh")
        if self.at is not None and (self.stress is not None or self.strain in COMPONENTS):
            raise ValueError(f"found {given[0]!r} at a place of a chart, expected a strain 11, 22 or 12")
        if self.node is not None and (self.strain in ("11", "22", "12") or self.side is not None):
            raise ValueError("found a strain of the wall at a node, expected xx, yy, zz, yz, xz or xy")
        return self

    def output(self) -> Output:
        """The output in the form for `reduce`."""
        if self.node is not None:
            if self.direction is not None:
                return NodeDisplacement(name=self.name, node=self.node, direction=self.direction)
            kind = NodeStrain if self.stress is None else NodeStress
            return kind(name=self.name, node=self.node, component=self.stress or self.strain or "")
        assert self.at is not None
        at = (self.at[0], self.at[1])
        if self.direction is not None:
            return Displacement(name=self.name, at=at, direction=self.direction)
        side = 1.0 if self.side is None else self.side
        return Strain(name=self.name, at=at, component=self.strain or "11", side=side)


class ReduceTable(Table):
    """[reduce]."""

    interface: Edge | None = Field(
        default=None, min_length=1, description="edge (of a mesh: group) at which contact acts"
    )
    at: Annotated[list[int], Field(min_length=1, max_length=1000)] | None = Field(
        default=None, description="node numbers of an imported mesh, each with channels x, y, z; instead of interface"
    )
    n_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic of a casing's rim")
    axial: bool = Field(default=False, description="whether a casing's rim has axial channels too")
    lines: list[Annotated[float, REACH]] = Field(
        default_factory=list, description="places along the meridian of lines around a casing [m], instead of an edge"
    )
    nodes: int | None = Field(
        default=None,
        ge=1,
        le=100,
        description="number of pieces into which a blade's tip is divided; one mean place if left out",
    )
    axis: Axis | None = Field(
        default=None,
        description='axis of an imported rim, or for the directions at an imported tip, as "x", "y", "z" or [x, y, z]',
    )
    point: Vector | None = Field(default=None, description="a point on this axis [m]; the origin if left out")
    recovery: bool = Field(
        default=False, description="whether the basis also stores the shapes at all nodes, for ParaView"
    )
    output: list[OutputTable] = Field(
        default_factory=list,
        description="tables [[reduce.output]]: displacements, strains or stresses that runs can give",
    )
    modes: int = Field(default=40, ge=1, le=100_000, description="number of modes kept")
    method: Literal["free", "craig-bampton"] = Field(
        default="free", description="method of reduction, with modes of the free or the fixed interface"
    )
    zeta: Annotated[float, Field(ge=0, lt=1), CHECKS["zeta"]] = Field(
        default=0.0, description="damping ratio of every mode [-]"
    )
    out: str | None = Field(
        default=None, pattern=r"^[^/\\]+\.npz$", description="name of the file to write, which ends in .npz"
    )

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        given = [name for name in ("interface", "lines", "at") if getattr(self, name)]
        if not given or ("at" in given and len(given) > 1):
            found = " and ".join(given) or "none of interface, lines and at"
            expected = "an edge or group (interface), lines around a casing, nodes of a mesh (at)"
            raise ValueError(f"found {found}, expected one: {expected}")
        return self


@table_of(OrderLoad)
class ResponseTable(Table):
    """[[response]]: response of a wheel to an engine order over speed; needs [cyclic] and [reduce]."""

    influence: str | None = Field(
        default=None,
        min_length=1,
        description="CSV file offset,stiffness,damping of aerodynamic influence coefficients [N/m, N s/m]",
    )


class ChecksTable(Table):
    """[checks]: implausible values that are intended."""

    allow: list[CheckName] = Field(
        default=[], description="names of checks of plausibility that are not applied to this file"
    )


class StudyFile(Table):
    """A whole study.toml."""

    model_config = ConfigDict(
        json_schema_extra={"required": ["material"], "anyOf": [{"required": ["shell"]}, {"required": ["solid"]}]},
        title="study.toml",
    )

    material: shapes.MaterialTable | None = Field(default=None, description="material: E, nu, rho")
    chart: shapes.ChartTable | None = Field(default=None, description="surface of the shell: its kind and dimensions")
    shell: shapes.ShellTable | None = Field(default=None, description="wall thickness; mesh file of an imported shell")
    solid: shapes.SolidTable | None = Field(default=None, description="imported solid, instead of [chart] and [shell]")
    taper: shapes.TaperTable | None = Field(default=None, description="variation of the wall thickness by design")
    strip: list[shapes.StripTable] = Field(
        default=[], description="tables [[strip]]: parts of the wall with another thickness or material"
    )
    stiffener: list[StiffenerTable] = Field(
        default=[], description="tables [[stiffener]]: stiffening rings on the wall"
    )
    rotation: shapes.RotationTable | None = Field(default=None, description="speed and axis of rotation")
    cyclic: CyclicTable | None = Field(
        default=None, description="cyclic symmetry of an imported mesh, one sector of a wheel"
    )
    imperfection: list[ImperfectionTable] = Field(
        default=[], description="tables [[imperfection]]: deviations of radius, thickness, modulus or density"
    )
    mass: list[shapes.MassTable] = Field(default=[], description="tables [[mass]]: point masses on edges")
    support: dict[Edge, SupportTable] = Field(
        default={}, description="support of each edge (of a mesh: group), by its name"
    )
    modes: ModesTable = Field(default=ModesTable(), description="number or band of the modes to compute")
    mesh: shapes.MeshTable = Field(default=shapes.MeshTable(), description="elements of the shell")
    update: UpdateTable | None = Field(default=None, description="model update: measured table and varied parameters")
    reduce: ReduceTable | None = Field(default=None, description="reduction to a modal basis")
    response: list[ResponseTable] = Field(
        default=[], description="tables [[response]]: excitation of a wheel by engine orders"
    )
    rig: RigTable | None = Field(default=None, description="virtual test rig, which makes synthetic measurements")
    checks: ChecksTable = Field(default=ChecksTable(), description="implausible values that are intended")


def schema() -> dict[str, Any]:
    """JSON schema of study.toml.

    >>> sorted(schema()["properties"])[:4]
    ['chart', 'checks', 'cyclic', 'imperfection']
    """
    return StudyFile.model_json_schema()
