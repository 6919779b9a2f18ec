"""Schema of study.toml (pydantic): the keys, their types and ranges, all SI.

Every table may be missing here, so that one bad table does not hide the problems of the others; `REQUIRED`
names those that the study of a shell on a chart cannot do without; one of an imported mesh needs the first.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self, TypedDict

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from casingfem.modal.output import Displacement, Output, Strain
from casingfem.study.rig_tables import RigTable
from casingfem.study.table import Edge, Length, NotNegative, Positive, Relative, Table

REQUIRED = ("material", "chart", "shell")


class MaterialTable(Table):
    """[material]: the fields of `Material`."""

    E: Positive = Field(description="Young's modulus [Pa]")
    nu: float = Field(gt=-1, lt=0.5, description="Poisson's ratio")
    rho: Positive = Field(description="density [kg/m^3]")


class FrustumTable(Table):
    """[chart] of kind "frustum"."""

    kind: Literal["frustum"]
    r_base: Length = Field(description="mean radius at z = 0 [m]")
    r_top: Length = Field(description="mean radius at z = height [m]")
    height: Length = Field(description="length along the axis [m]")


class CylinderTable(Table):
    """[chart] of kind "cylinder"."""

    kind: Literal["cylinder"]
    radius: Length = Field(description="mean radius [m]")
    height: Length = Field(description="length along the axis [m]")


class PanelTable(Table):
    """[chart] of kind "panel"."""

    kind: Literal["panel"]
    radius: Length = Field(description="mean radius [m]")
    length: Length = Field(description="length along the axis [m]")
    angle: Positive = Field(lt=6.283185307179586, description="opening angle [rad]")


class PlateTable(Table):
    """[chart] of kind "plate"."""

    kind: Literal["plate"]
    length: Length = Field(description="length from root to tip [m]")
    width: Length = Field(description="width [m]")


class DomeTable(Table):
    """[chart] of kind "dome": a circular meridian, r = r0 + radius cos phi, z = radius sin phi, turned about z."""

    kind: Literal["dome"]
    radius: Length = Field(description="radius of the meridian [m]")
    start_deg: float = Field(ge=-360, le=360, description="phi at the base [degrees], 0 at the equator")
    end_deg: float = Field(ge=-360, le=360, description="phi at the top [degrees]")
    r0: float = Field(default=0.0, ge=-1e3, le=1e3, description="distance of the meridian's centre from the axis [m]")


class TwistedPlateTable(Table):
    """[chart] of kind "twisted-plate"."""

    kind: Literal["twisted-plate"]
    length: Length = Field(description="length from root to tip [m]")
    width: Length = Field(description="width [m]")
    twist_deg: float = Field(ge=-360, le=360, description="twist of the tip against the root [degrees]")


Stations = float | Annotated[list[float], Field(min_length=1, max_length=8)]


class BladeTable(Table):
    """[chart] of kind "blade"; a list holds values at equally spaced stations, the root's first."""

    kind: Literal["blade"]
    length: Length = Field(description="span from root to tip [m]")
    chord: Stations = Field(description="chord [m], one number or [root, tip] or more stations")
    camber_deg: Stations = Field(default=0.0, description="opening angle of the section's arc [degrees]")
    twist_deg: Stations = Field(default=0.0, description="angle of the section about the span [degrees]")
    sweep: Stations = Field(default=0.0, description="shift of the section along y [m]")
    lean: Stations = Field(default=0.0, description="shift of the section along z [m]")


class TaperTable(Table):
    """[taper]: factors of the thickness at equally spaced stations."""

    along: Stations = Field(default=1.0, description="from root to tip, or base to top")
    across: Stations = Field(default=1.0, description="from left to right")


class ImportTable(Table):
    """A mesh file and how it is read: keys that [solid] and [shell] share."""

    mesh: str | None = Field(default=None, min_length=1, description="mesh file, relative to this file")
    scale: Positive = Field(default=1.0, description="factor that makes the file's lengths metres: 1e-3 for mm")
    join: NotNegative = Field(default=0.0, description="nodes closer than this become one [m]")


class SolidTable(ImportTable):
    """[solid]: an imported mesh of tetrahedra or bricks, instead of [chart] and [shell]."""

    mesh: str = Field(min_length=1, description="mesh file, relative to this file")
    material: dict[str, MaterialTable] = Field(default={}, description="group of cells -> its own material")


class ShellTable(ImportTable):
    """[shell]: a wall on [chart], or on an imported mesh of quadrilaterals."""

    thickness: Length = Field(description="nominal wall thickness [m]")

    @model_validator(mode="after")
    def _mesh_keys(self) -> "ShellTable":
        if self.mesh is None and (self.scale != 1.0 or self.join != 0.0):
            raise ValueError("found scale or join without mesh, expected them with a mesh file only")
        return self


class StripTable(Table):
    """[[strip]]: a band along the axis or span with a wall of its own."""

    start: float = Field(alias="from", ge=-1e3, le=1e3, description="where it begins along the axis or span [m]")
    end: float = Field(alias="to", ge=-1e3, le=1e3, description="where it ends [m]")
    thickness: Length = Field(description="its wall thickness [m]")
    material: MaterialTable | None = Field(default=None, description="E, nu, rho; the wall's own if left out")


class Harmonic(Table):
    """cos p theta and sin p theta, relative."""

    p: int = Field(ge=0, le=1000, description="number of waves around")
    cos: Relative = Field(default=0.0, description="relative amplitude of cos p theta")
    sin: Relative = Field(default=0.0, description="relative amplitude of sin p theta")


class Wave(Table):
    """One harmonic of a random field's spectrum, relative amplitudes."""

    p: int = Field(ge=1, le=1000, description="number of waves around")
    median: Annotated[float, Field(gt=0, le=1)] = Field(description="median amplitude, relative")
    high: Annotated[float, Field(gt=0, le=1)] | None = Field(
        default=None, description="90th percentile; 1.82 medians if left out, as of a Rayleigh amplitude"
    )


Random = Annotated[
    Annotated[Literal["example"], Tag("name")] | Annotated[list[Wave], Tag("spectrum"), Field(min_length=1)],
    Discriminator(lambda value: "spectrum" if isinstance(value, list) else "name"),
]


class ImperfectionTable(Table):
    """[[imperfection]]: harmonics, the fit of a survey, or a random field; several of them add up."""

    of: Literal["radius", "thickness", "modulus", "density"]
    harmonics: list[Harmonic] | None = Field(default=None, description="[{p, cos, sin}], relative")
    survey: str | None = Field(default=None, min_length=1, description="survey CSV, relative to this file")
    n_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic fitted to the survey")
    degree: int | None = Field(default=None, ge=0, le=20, description="degree of the fit along z")
    robust: bool | None = Field(default=None, description="set stray points of the survey aside, and say which")
    random: Random | None = Field(default=None, description='"example" (radius), or [{p, median, high}], relative')
    seed: int | None = Field(default=None, ge=0, description="of the random field: same seed, same field")
    scale: Positive | None = Field(default=None, description="factor on the random field's spectrum")
    p_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic of the random field")

    @model_validator(mode="after")
    def _one_source(self) -> "ImperfectionTable":
        sources = {"harmonics": (), "survey": ("n_max", "degree", "robust"), "random": ("seed", "scale", "p_max")}
        given = [name for name in sources if getattr(self, name) is not None]
        if len(given) != 1:
            found = "neither harmonics nor survey nor random" if not given else " beside ".join(given)
            raise ValueError(f"found {found}, expected one of {', '.join(sources)}")
        for name, own in sources.items():
            astray = [key for key in own if getattr(self, key) is not None and name != given[0]]
            if astray:
                raise ValueError(f"found {', '.join(astray)} beside {given[0]}, expected with {name} only")
        if self.random is not None and self.seed is None:
            raise ValueError("found random without seed, expected a whole number: the same seed gives the same field")
        if self.random == "example" and self.of != "radius":
            raise ValueError(f'found random = "example" of {self.of}, expected a spectrum of your own: [{{p, median}}]')
        return self


class SpringsAround(Table):
    """[support.EDGE.around]: how each spring varies along the edge."""

    k_r: list[Harmonic] = Field(default=[], description="[{p, cos, sin}] of the radial springs, relative")
    k_theta: list[Harmonic] = Field(default=[], description="[{p, cos, sin}] of the tangential springs, relative")
    k_z: list[Harmonic] = Field(default=[], description="[{p, cos, sin}] of the axial springs, relative")
    k_rot: list[Harmonic] = Field(default=[], description="[{p, cos, sin}] of the rotational springs, relative")
    k_face: list[Harmonic] = Field(default=[], description="[{p, cos, sin}] of the end face, relative")


Around = Annotated[
    Annotated[list[Harmonic], Tag("all")] | Annotated[SpringsAround, Tag("each")],
    Discriminator(lambda value: "each" if isinstance(value, Mapping | SpringsAround) else "all"),
]


class ClampedTable(Table):
    """[support.EDGE] of kind "clamped"."""

    kind: Literal["clamped"]


class DiaphragmTable(Table):
    """[support.EDGE] of kind "shear-diaphragm"."""

    kind: Literal["shear-diaphragm"]


class FixedTable(Table):
    """[support.GROUP] of kind "fixed": displacements held, on imported meshes."""

    kind: Literal["fixed"]
    directions: list[Literal["x", "y", "z"]] = Field(min_length=1, description="which of x, y, z are held")


class SymmetryTable(Table):
    """[support.EDGE] of kind "symmetry": the edge lies in a plane of symmetry."""

    kind: Literal["symmetry"]


class ElasticTable(Table):
    """[support.EDGE] of kind "elastic"; `around` multiplies all springs, or each by its own, by 1 + harmonics."""

    kind: Literal["elastic"]
    k_r: NotNegative = Field(default=0.0, description="radial springs [N/m per m]")
    k_theta: NotNegative = Field(default=0.0, description="tangential springs [N/m per m]")
    k_z: NotNegative = Field(default=0.0, description="axial springs [N/m per m]")
    k_rot: NotNegative = Field(default=0.0, description="rotational springs [N m/rad per m]")
    k_face: NotNegative = Field(default=0.0, description="foundation modulus of the end face [N/m^3]")
    around: Around = Field(default=[], description="[{p, cos, sin}], relative; or such a list for each spring's name")


class LooseTable(Table):
    """One loose or missing bolt."""

    bolt: int = Field(ge=1, le=1000, description="number of the bolt, from 1")
    factor: float = Field(ge=0, le=1e6, description="factor of its stiffness, 0 for a missing bolt")


class BoltsTable(Table):
    """[support.EDGE] of kind "bolts"."""

    kind: Literal["bolts"]
    count: int = Field(ge=1, le=1000, description="number of bolts")
    k: NotNegative | None = Field(default=None, description="stiffness of one bolt in all three directions [N/m]")
    k_r: NotNegative | None = Field(default=None, description="radial stiffness of one bolt [N/m]")
    k_theta: NotNegative | None = Field(default=None, description="tangential stiffness of one bolt [N/m]")
    k_z: NotNegative | None = Field(default=None, description="axial stiffness of one bolt [N/m]")
    k_rot: NotNegative = Field(default=0.0, description="rotational stiffness of one bolt [N m/rad]")
    first_angle_deg: float = Field(default=0.0, ge=-360, le=360, description="angle of bolt 1 [degrees]")
    width_deg: float | None = Field(default=None, gt=0, le=360, description="width of the patch of a bolt [degrees]")
    width_m: Length | None = Field(default=None, description="the same as a length on a closed casing's edge [m]")
    spacing_deg: float | None = Field(default=None, gt=0, le=360, description="angle between bolts; else all around")
    loose: list[LooseTable] = Field(default=[], description="[{bolt, factor}]")

    @model_validator(mode="after")
    def _one_of_each(self) -> "BoltsTable":
        split = [name for name in ("k_r", "k_theta", "k_z") if getattr(self, name) is not None]
        if (self.k is None) == (not split):
            found = "neither k nor" if self.k is None else "k beside"
            raise ValueError(f"found {found} {', '.join(split or ['k_r, k_theta, k_z'])}, expected one of the two")
        if self.width_deg is not None and self.width_m is not None:
            raise ValueError("found both width_deg and width_m, expected one of them")
        bolts = [entry.bolt for entry in self.loose]
        if len(set(bolts)) < len(bolts):
            raise ValueError(f"loose: found bolts {bolts}, expected each once")
        return self


class Wanted(TypedDict, total=False):
    """Count or band [Hz], as `modes` takes them."""

    count: int
    band: tuple[float, float]


Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class RotationTable(Table):
    """[rotation]: a blade on its hub (hub_radius, stagger_deg), or any axis (axis, centre)."""

    speed_hz: float = Field(ge=0, le=1e5, description="turns a second")
    hub_radius: Annotated[float, Field(ge=0, le=1e3)] | None = Field(
        default=None, description="from the axis to the middle of the root [m], open charts"
    )
    stagger_deg: float = Field(default=0.0, ge=-360, le=360, description="from the axis to the root's chord [degrees]")
    axis: (
        Annotated[
            Annotated[Literal["x", "y", "z"], Tag("name")] | Annotated[Vector, Tag("vector")],
            Discriminator(lambda value: "name" if isinstance(value, str) else "vector"),
        ]
        | None
    ) = Field(default=None, description='"x", "y", "z" or a direction [x, y, z]; z if left out')
    centre: Vector | None = Field(default=None, description="a point on the axis [m]; the origin if left out")


Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
RingSupport = Annotated[ElasticTable | BoltsTable, Field(discriminator="kind")]


class RingTable(Table):
    """[support.EDGE] of kind "ring": a rectangle, or a circle by its diameter; [support.EDGE.support] holds it."""

    kind: Literal["ring"]
    width: Length | None = Field(default=None, description="radial size of the section [m]")
    depth: Length | None = Field(default=None, description="axial size of the section [m]")
    diameter: Length | None = Field(default=None, description="diameter of a round section [m]")
    material: MaterialTable | None = Field(default=None, description="E, nu, rho; the casing's if left out")
    offset: Pair | None = Field(default=None, description="[radial, axial] from the edge to the centre [m]")
    foot: Pair | None = Field(default=None, description="[radial, axial] from the centre to the springs [m]")
    support: RingSupport | None = Field(default=None, description="what holds the ring: elastic or bolts")

    @model_validator(mode="after")
    def _one_section(self) -> "RingTable":
        sides = [name for name in ("width", "depth", "diameter") if getattr(self, name) is not None]
        if sides not in (["width", "depth"], ["diameter"]):
            raise ValueError(f"found {', '.join(sides) or 'no section'}, expected width and depth, or diameter")
        return self


class MassTable(Table):
    """[[mass]]: a point mass on an edge, on the centre line of its ring if it has one."""

    edge: Edge = Field(min_length=1, description="an edge of the chart")
    angle_deg: float = Field(ge=-360, le=360, description="where it stands [degrees]")
    mass: NotNegative = Field(description="mass [kg]")


class ModesTable(Table):
    """[modes]: a count, or a band."""

    count: int = Field(default=40, ge=1, le=100_000, description="number of modes")
    band_hz: list[NotNegative] | None = Field(
        default=None, min_length=2, max_length=2, description="[from, to]: every mode of a band, instead of a count"
    )
    elastic_only: bool = Field(default=False, description="rigid modes are an error")

    @model_validator(mode="after")
    def _count_or_band(self) -> "ModesTable":
        if self.band_hz is not None and "count" in self.model_fields_set:
            raise ValueError("found count and band_hz, expected one of them")
        if self.band_hz is not None and not self.band_hz[0] < self.band_hz[1]:
            raise ValueError(f"found band_hz = {self.band_hz}, expected two frequencies in order")
        return self

    @property
    def wanted(self) -> Wanted:
        """What `modes` is asked for: count or band."""
        return {"count": self.count} if self.band_hz is None else {"band": (self.band_hz[0], self.band_hz[1])}


class MeshTable(Table):
    """[mesh]: what is left out is chosen for the shell."""

    order: int | None = Field(default=None, ge=2, le=20, description="polynomial order")
    rows: Annotated[int, Field(ge=1, le=1000)] | list[float] | None = Field(
        default=None, description="number of equal rows, or breaks from 0 to 1"
    )
    around: int | None = Field(default=None, ge=1, le=10_000, description="elements around")


class ParameterTable(Table):
    """[[update.parameter]]."""

    name: str = Field(min_length=1, description="path of a number, such as material.E")
    lower: float = Field(description="lower bound, in the parameter's unit")
    upper: float = Field(description="upper bound, in the parameter's unit")
    sigma: Positive | None = Field(default=None, description="prior standard deviation; decades if log")
    log: bool = Field(default=False, description="vary the decimal logarithm")
    start: float | None = Field(default=None, description="start value; the study's own if left out")


class UpdateTable(Table):
    """[update]."""

    table: str = Field(min_length=1, description="frequency table CSV, relative to this file")
    reach: Positive = Field(default=0.5, description="largest relative frequency error of a pair")
    count: int | None = Field(default=None, ge=1, le=100_000, description="modes computed; from the table if left out")
    model_error: float = Field(default=0.0, ge=0, lt=1, description="relative error allowed to the model")
    shapes: str | None = Field(
        default=None, min_length=1, description="mode shapes of the table: universal file or identified.npz"
    )
    shape_sigma: Positive | None = Field(
        default=None, description="noise of the shapes, rms over a shape's own rms; the file's if left out"
    )
    shape_error: float = Field(default=0.0, ge=0, lt=1, description="the same, allowed to the model's shapes")
    shape_reach: Positive = Field(default=1e-3, description="largest relative distance of a shape from its row")
    regularise: Literal["discrepancy", "l-curve"] | None = Field(
        default=None, description="rule that chooses how strongly ill-posed parameters are held to their start"
    )
    regularised: list[str] = Field(default=[], description="their names; all harmonics if left out")
    parameter: list[ParameterTable] = Field(min_length=1, description="at least one [[update.parameter]]")

    @model_validator(mode="after")
    def _of_shapes(self) -> "UpdateTable":
        alone = sorted({"shape_sigma", "shape_error", "shape_reach"} & self.model_fields_set)
        if alone and self.shapes is None:
            raise ValueError(f"found {', '.join(alone)} without shapes, expected shapes = a file with mode shapes")
        return self


class OutputTable(Table):
    """[[reduce.output]]: a displacement (direction), or a strain (strain and side), at parameters of the chart."""

    name: str = Field(min_length=1)
    at: list[float] = Field(min_length=2, max_length=2, description="parameters of the chart")
    direction: Literal["x", "y", "z", "normal", "radial", "tangential"] | None = None
    strain: Literal["11", "22", "12"] | None = None
    side: float | None = Field(default=None, ge=-1, le=1, description="face: 1 where the normal points, -1, or between")

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.direction is None) == (self.strain is None) or (self.side is not None and self.strain is None):
            raise ValueError("found direction, strain, side that do not go together, expected direction, or strain")
        return self

    def output(self) -> Output:
        """The output as `reduce` takes it."""
        at = (self.at[0], self.at[1])
        if self.direction is not None:
            return Displacement(name=self.name, at=at, direction=self.direction)
        side = 1.0 if self.side is None else self.side
        return Strain(name=self.name, at=at, component=self.strain or "11", side=side)


class ReduceTable(Table):
    """[reduce]."""

    interface: Edge = Field(min_length=1, description="the edge that contact sees")
    n_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic of a casing's rim")
    axial: bool = Field(default=False, description="a casing's rim along the axis too")
    lines: list[float] = Field(default_factory=list, description="places along a casing's meridian, for the edge")
    nodes: int | None = Field(default=None, ge=1, le=100, description="pieces of a blade's tip, for one mean place")
    output: list[OutputTable] = Field(default_factory=list, description="displacements and strains to be had from runs")
    modes: int = Field(default=40, ge=1, le=100_000, description="number of modes kept")
    method: Literal["free", "craig-bampton"] = "free"
    zeta: float = Field(default=0.0, ge=0, lt=1, description="damping ratio of every mode")
    out: str | None = Field(default=None, pattern=r"^[^/\\]+\.npz$", description="a file name ending in .npz")


ChartTable = Annotated[
    FrustumTable | CylinderTable | PanelTable | PlateTable | TwistedPlateTable | DomeTable | BladeTable,
    Field(discriminator="kind"),
]
SupportTable = Annotated[
    ClampedTable | DiaphragmTable | SymmetryTable | ElasticTable | BoltsTable | RingTable | FixedTable,
    Field(discriminator="kind"),
]


class StudyFile(Table):
    """A whole study.toml."""

    model_config = ConfigDict(
        json_schema_extra={"required": ["material"], "anyOf": [{"required": ["shell"]}, {"required": ["solid"]}]},
        title="study.toml",
    )

    material: MaterialTable | None = Field(default=None, description="E, nu, rho")
    chart: ChartTable | None = Field(default=None, description="kind and dimensions")
    shell: ShellTable | None = Field(default=None, description="thickness; mesh if imported")
    solid: SolidTable | None = Field(default=None, description="mesh, instead of [chart] and [shell]")
    taper: TaperTable | None = Field(default=None, description="how the thickness varies by design")
    strip: list[StripTable] = Field(default=[], description="tables [[strip]]")
    rotation: RotationTable | None = Field(default=None, description="speed and axis")
    imperfection: list[ImperfectionTable] = Field(default=[], description="tables [[imperfection]]")
    mass: list[MassTable] = Field(default=[], description="tables [[mass]]: point masses on edges")
    support: dict[Edge, SupportTable] = Field(default={}, description="edge or group -> kind and stiffnesses")
    modes: ModesTable = ModesTable()
    mesh: MeshTable = MeshTable()
    update: UpdateTable | None = None
    reduce: ReduceTable | None = None
    rig: RigTable | None = Field(default=None, description="the virtual test rig")


def schema() -> dict[str, Any]:
    """JSON schema of study.toml.

    >>> sorted(schema()["properties"])[:4]
    ['chart', 'imperfection', 'mass', 'material']
    """
    return StudyFile.model_json_schema()
