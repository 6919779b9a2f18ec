"""The tables of a structure's shape: material, chart, taper, wall, strips, masses, mesh, rotation, imported meshes."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from casingfem.structure.edge.ring import EdgeMass
from casingfem.structure.geometry.blade import Blade, TwistedPlate
from casingfem.structure.geometry.chart import Cylinder, Frustum, Panel, Plate
from casingfem.structure.geometry.revolved import Arc
from casingfem.structure.geometry.stations import Taper
from casingfem.structure.geometry.strip import Strip
from casingfem.structure.imported.attachments.glue import Gluing
from casingfem.structure.imported.sector_mesh import DiskRing
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.plies import Lamina, Ply
from casingfem.study.tables.table import (
    Angle,
    Axis,
    Edge,
    Pair,
    Size,
    Table,
    Thickness,
    Vector,
)
from contact.io.plausible import REACH
from contact.io.tables import Length, NotNegative, Positive, table_of

Cells = Annotated[list[Annotated[int, Field(ge=1, le=400)]], Field(min_length=3, max_length=3)]


@table_of(Material)
class MaterialTable(Table):
    """[material]: the fields of `Material`."""


@table_of(Frustum)
class FrustumTable(Table):
    """[chart] of kind "frustum"."""

    kind: Literal["frustum"] = Field(description="kind of surface")


@table_of(Cylinder)
class CylinderTable(Table):
    """[chart] of kind "cylinder"."""

    kind: Literal["cylinder"] = Field(description="kind of surface")


@table_of(Panel)
class PanelTable(Table):
    """[chart] of kind "panel"."""

    kind: Literal["panel"] = Field(description="kind of surface")


@table_of(Plate)
class PlateTable(Table):
    """[chart] of kind "plate"."""

    kind: Literal["plate"] = Field(description="kind of surface")


@table_of(Arc)
class DomeTable(Table):
    """[chart] of kind "dome": a circular meridian, r = r0 + radius cos phi, z = radius sin phi, rotated about z."""

    kind: Literal["dome"] = Field(description="kind of surface")

    @model_validator(mode="after")
    def _arc(self) -> Self:
        start, end = (float(getattr(self, name)) for name in ("start_deg", "end_deg"))
        if not abs(end - start) > 1e-4:
            found = f"start_deg = {start:g} and end_deg = {end:g}"
            raise ValueError(f"found {found}, expected two different angles")
        return self


class PieceTable(Table):
    """[[chart.piece]]: a straight piece or an arc of a meridian, optionally with its own thickness or material."""

    to: Annotated[Pair, REACH] = Field(description="end of the piece, [r, z] [m]")
    radius: Annotated[float, Field(ge=-1e3, le=1e3)] | None = Field(
        default=None,
        description="radius of an arc [m], positive if the arc turns left from start to end; straight if left out",
    )
    fillet: Size | None = Field(default=None, description="fillet radius at the start of the piece [m]")
    thickness: Thickness | None = Field(default=None, description="wall thickness of this part [m]")
    material: MaterialTable | None = Field(
        default=None, description="E, nu, rho of this part; those of the wall if left out"
    )


class MeridianTable(Table):
    """[chart] of kind "meridian": pieces from base to top, rotated about z."""

    kind: Literal["meridian"] = Field(description="kind of surface")
    start: Annotated[Pair, REACH] = Field(description="start of the meridian at the base, [r, z] [m]")
    fillet: Size | None = Field(
        default=None, description="fillet radius of the corners [m]; for a sharp corner the wall thickness"
    )
    piece: list[PieceTable] = Field(
        min_length=1, description="tables [[chart.piece]]: lines and arcs of the meridian, at least one"
    )


class PointsTable(Table):
    """[chart] of kind "points": a smooth meridian through points, rotated about z."""

    kind: Literal["points"] = Field(description="kind of surface")
    points: Annotated[str, Field(min_length=1)] | Annotated[list[Annotated[Pair, REACH]], Field(min_length=2)] = Field(
        description="points [r, z] from base to top [m], or a CSV file with columns radius_m and z_m, a row a point"
    )


@table_of(TwistedPlate)
class TwistedPlateTable(Table):
    """[chart] of kind "twisted-plate"."""

    kind: Literal["twisted-plate"] = Field(description="kind of surface")


Stations = float | Annotated[list[float], Field(min_length=1, max_length=8)]
Angles = Angle | Annotated[list[Angle], Field(min_length=1, max_length=8)]
Lengths = Length | Annotated[list[Length], Field(min_length=1, max_length=8)]
Factor = Annotated[float, Field(ge=1e-3, le=1e3)]
Factors = Factor | Annotated[list[Factor], Field(min_length=1, max_length=8)]


@table_of(Blade)
class BladeTable(Table):
    """[chart] of kind "blade"; a list has values at equally spaced stations from the root."""

    kind: Literal["blade"] = Field(description="kind of surface")


ChartTable = Annotated[
    FrustumTable
    | CylinderTable
    | PanelTable
    | PlateTable
    | TwistedPlateTable
    | DomeTable
    | MeridianTable
    | PointsTable
    | BladeTable,
    Field(discriminator="kind"),
]


@table_of(Taper)
class TaperTable(Table):
    """[taper]: factors of the thickness at equally spaced stations."""


@table_of(Gluing)
class TieTable(Table):
    """[[solid.tie]], [[shell.tie]]: faces of parts that do not share nodes."""


class ImportTable(Table):
    """A mesh file and options for reading it: keys that [solid] and [shell] share."""

    mesh: str | None = Field(default=None, min_length=1, description="path of the mesh file, relative to this file")
    scale: Positive = Field(default=1.0, description="factor from lengths of the mesh file to metres [-], 1e-3 for mm")
    join: NotNegative = Field(default=0.0, description="distance below which nodes are merged [m]")
    units: str | None = Field(
        default=None, description="units of length, mass and time in the mesh file, such as mm-t-s; instead of scale"
    )
    tie: list[TieTable] = Field(default=[], description="faces to tie: tables with follower, master, tolerance")


@table_of(DiskRing)
class DiskTable(Table):
    """[solid.disk]: a disk ring under a blade of sections, one sector of the wheel of [cyclic]."""


class SolidTable(ImportTable):
    """[solid]: an imported mesh of tetrahedra or bricks, or a blade of sections, instead of [chart] and [shell]."""

    material: dict[str, MaterialTable] = Field(default={}, description="materials of groups of cells, by name")
    sections: str | None = Field(
        default=None, min_length=1, description="CSV file of blade sections, relative to this file; instead of mesh"
    )
    cells: Cells = Field(
        default=[24, 20, 1], description="numbers of cells along chord, span and thickness of a blade of sections"
    )
    disk: DiskTable | None = Field(default=None, description="disk under the blade of sections; with [cyclic]")

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.mesh is None) == (self.sections is None):
            found = "neither mesh nor sections" if self.mesh is None else "both mesh and sections"
            raise ValueError(f"found {found}, expected one of them")
        other = {"scale", "join", "units", "tie"} if self.sections is not None else {"cells", "disk"}
        if wrong := sorted(other & self.model_fields_set):
            beside = "sections, whose columns name their units" if self.sections is not None else "mesh"
            raise ValueError(f"found {', '.join(wrong)} with {beside}, expected no such key")
        return self


@table_of(Lamina)
class LaminaTable(Table):
    """[shell.lamina.<name>]: the fields of `Lamina`."""


@table_of(Ply)
class PlyTable(Table):
    """[[shell.plies]]: a layer, from the inside out; on a mesh along its cells' normals."""

    thickness: float
    lamina: str | None = Field(
        default=None, description="name of its material, a table [shell.lamina.NAME]; [material] if left out"
    )


class ShellTable(ImportTable):
    """[shell]: a wall on [chart], or on an imported mesh of quadrilaterals."""

    thickness: Thickness = Field(description="nominal wall thickness [m]")
    wall: Literal["curved", "linear"] = Field(
        default="curved",
        description="wall theory, with the metric through the wall (curved) or as published shell theory (linear)",
    )
    plies: list[PlyTable] = Field(
        default=[], description='layers from the inner to the outer face; they need wall = "linear"'
    )
    lamina: dict[str, LaminaTable] = Field(default={}, description="orthotropic materials of plies, by name")
    angle_from: Axis | None = Field(
        default=None, description="direction from which ply angles on an imported mesh are measured [-]; z if left out"
    )
    thicknesses: dict[str, Thickness] = Field(
        default={}, description="wall thickness of groups of cells of an imported mesh [m], by name"
    )
    material: dict[str, MaterialTable] = Field(
        default={}, description="materials of groups of cells of an imported mesh, by name"
    )

    @model_validator(mode="after")
    def _plies(self) -> "ShellTable":
        total = sum(ply.thickness for ply in self.plies)
        if self.plies and abs(total - self.thickness) > 1e-6 * self.thickness:
            raise ValueError(
                f"found plies of {total:g} m in a wall of {self.thickness:g} m, expected plies that add up to the wall"
            )
        for ply in self.plies:
            if ply.lamina is not None and ply.lamina not in self.lamina:
                known = ", ".join(self.lamina) or "none"
                raise ValueError(f"found a ply of lamina {ply.lamina!r}, expected one of: {known}")
        return self

    @model_validator(mode="after")
    def _mesh_keys(self) -> "ShellTable":
        own = {"scale", "join", "units", "thicknesses", "material", "angle_from"}
        if self.mesh is None and own & self.model_fields_set:
            found = "scale, join, units, thicknesses, material or angle_from without mesh"
            raise ValueError(f"found {found}, expected them with a mesh only")
        return self


@table_of(Strip)
class StripTable(Table):
    """[[strip]]: a band along the axis or span with its own thickness or material."""

    start: float
    end: float
    material: MaterialTable | None = Field(
        default=None, description="E, nu, rho of this part; those of the wall if left out"
    )

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if not self.start < self.end:
            raise ValueError(f"found from = {self.start:g} and to = {self.end:g}, expected from < to")
        return self


@table_of(EdgeMass)
class MassTable(Table):
    """[[mass]]: a point mass on an edge, on the centre line of its ring if it has one."""

    edge: Edge = Field(min_length=1, description="name of an edge of the chart")


@table_of(ShellMesh, optional=("order", "around"))
class MeshTable(Table):
    """[mesh]: by default keys are chosen for the shell."""

    order: int | None = None
    around: Annotated[int, Field(ge=1, le=10_000)] | list[float] | None = Field(
        default=None, description="elements around; across an open chart also their ends from 0 to 1 [-]"
    )
    rows: Annotated[int, Field(ge=1, le=1000)] | list[float] | None = Field(
        default=None, description="number of equal rows of elements, or their ends from 0 to 1 [-]"
    )


class RotationTable(Table):
    """[rotation]: a blade on its hub (hub_radius, stagger_deg), or any axis (axis, and point or centre on it)."""

    speed_hz: float = Field(ge=0, le=1e5, description="speed of rotation [turns/s]")
    hub_radius: Annotated[float, Field(ge=0, le=1e3), REACH] | None = Field(
        default=None, description="radius from the axis to the middle of the root [m], for open charts"
    )
    stagger_deg: float = Field(
        default=0.0, ge=-360, le=360, description="stagger angle from the axis to the chord of the root [degrees]"
    )
    axis: Axis | None = Field(
        default=None, description='axis, as "x", "y", "z" or a direction [x, y, z]; z if left out'
    )
    centre: Vector | None = Field(default=None, description="a point on the axis [m]; the origin if left out")
    point: Vector | None = Field(default=None, description="another name of centre [m]")

    @model_validator(mode="after")
    def _one_point(self) -> "RotationTable":
        if self.centre is not None and self.point is not None:
            raise ValueError("found centre and point, expected one of them, since both give the same point")
        return self
