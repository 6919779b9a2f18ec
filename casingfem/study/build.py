"""From the tables of a study file to a shell: each part is tried, and what fails is collected with its key."""

from dataclasses import replace

import numpy as np

from casingfem.errors import warn
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.point_mass import EdgeMass
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Support, Symmetry
from casingfem.structure.field.fourier import Field, FourierField
from casingfem.structure.field.random import RAYLEIGH, RandomField, Spectrum
from casingfem.structure.field.survey.survey import SurveyField
from casingfem.structure.geometry.blade import Blade
from casingfem.structure.geometry.chart import Chart, Cylinder, Frustum, Panel, Plate
from casingfem.structure.geometry.pieces import Piece, PiecewiseMeridian
from casingfem.structure.geometry.revolved import Arc, Revolved
from casingfem.structure.geometry.strip import Strip, check_strips
from casingfem.structure.geometry.survey_check import check_survey, mean_radius
from casingfem.structure.geometry.taper import Taper
from casingfem.structure.geometry.twisted import TwistedPlate
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.plies import Lamina, Ply
from casingfem.structure.shell.shell import Shell
from casingfem.study.problems import Problems
from casingfem.study.rotation import build_rotation
from casingfem.study.schema import StudyFile
from casingfem.study.tables.fields import Harmonic, ImperfectionTable
from casingfem.study.tables.shapes import (
    BladeTable,
    ChartTable,
    DomeTable,
    MassTable,
    MeridianTable,
    MeshTable,
    ShellTable,
    TwistedPlateTable,
)
from casingfem.study.tables.supports import BoltsTable, ElasticTable, FixedTable, RingTable, SupportTable, SymmetryTable
from contact.io.names import hint

CHARTS = {"frustum": Frustum, "cylinder": Cylinder, "panel": Panel, "plate": Plate}
FLAT = ("plate", "twisted-plate", "blade")  # kinds without a radius


def build_shell(tables: StudyFile, problems: Problems) -> Shell | None:
    """The shell a study describes, or None with the reasons collected: of each part, then of the whole."""
    if tables.cyclic is not None:
        problems.add("cyclic", "it beside [chart]", "an imported mesh: the sector of a wheel", "study-key")
    chart = try_chart(tables, problems)
    material = None
    if tables.material is not None:
        with problems.at("material"):
            material = Material(**tables.material.model_dump())
    supports = build_supports(tables.support, chart, problems)
    strips = build_strips(tables, chart, problems)
    taper = None
    if tables.taper is not None:
        with problems.at("taper"):
            taper = Taper(**tables.taper.model_dump())
    rotation = build_rotation(tables.rotation, chart, problems)
    masses = build_masses(tables.mass, chart, problems)
    fields: dict[str, Field] = {}
    surveys = [table.of for table in tables.imperfection if table.survey is not None]
    for of in {of for of in surveys if surveys.count(of) > 1}:
        found = f"{surveys.count(of)} surveys of the {of}"
        problems.add("imperfection", found, "one: what both measured would count twice", "survey-twice")
    for k, table in enumerate(tables.imperfection):
        field = build_field(table, f"imperfection[{k + 1}]", tables, problems)
        if field is not None:
            fields[table.of] = fields[table.of] + field if table.of in fields else field  # type: ignore[operator]
    if chart is None or material is None or tables.shell is None or problems:
        return None
    shell = None
    with problems.at("support" if supports else "shell"):
        thickness = tables.shell.thickness
        shell = Shell(
            chart=chart,
            thickness=thickness,
            material=material,
            wall=tables.shell.wall,
            plies=build_plies(tables.shell),
            supports=supports,
            strips=strips,
            taper=taper,
            rotation=rotation,
            masses=masses,
        )
    if shell is None:
        return None
    with problems.at("imperfection" if fields else "shell"):
        defects = {f"{quantity}_defect": field for quantity, field in fields.items()}
        shell = replace(shell, mesh=None, **defects)  # type: ignore[arg-type]  # the default mesh follows the fields
        shell.geometry(*(np.array([ends[0]]) for ends in chart.bounds))
    if not problems:
        if not supports:
            warn("shell-free", f"{problems.file}: no [support.EDGE]")
        with problems.at("mesh"):
            return replace(shell, mesh=build_mesh(tables.mesh, shell.mesh))
    return None


def try_chart(tables: StudyFile, problems: Problems) -> Chart | None:
    """The chart of a study, or None with the reason collected."""
    if tables.chart is not None:
        with problems.at("chart"):
            return build_chart(tables.chart)
    return None


def build_chart(table: ChartTable) -> Chart:
    """The chart of a [chart] table."""
    if isinstance(table, TwistedPlateTable):
        return TwistedPlate(length=table.length, width=table.width, twist=float(np.radians(table.twist_deg)))
    if isinstance(table, MeridianTable):
        pieces = tuple(
            Piece(to=(part.to[0], part.to[1]), radius=part.radius, fillet=part.fillet) for part in table.piece
        )
        start = (table.start[0], table.start[1])
        return Revolved(profile=PiecewiseMeridian(start=start, pieces=pieces, fillet=table.fillet))
    if isinstance(table, DomeTable):
        ends = np.radians([table.start_deg, table.end_deg]).tolist()
        return Revolved(profile=Arc(radius=table.radius, start=ends[0], end=ends[1], r0=table.r0))
    if isinstance(table, BladeTable):
        laws = {
            name: np.radians(value).tolist() if name.endswith("_deg") else value
            for name, value in table.model_dump(exclude={"kind"}).items()
        }
        return Blade(**{name.removesuffix("_deg"): value for name, value in laws.items()})
    chart: Chart = CHARTS[table.kind](**table.model_dump(exclude={"kind"}))
    return chart


def build_strips(study: StudyFile, chart: Chart | None, problems: Problems) -> tuple[Strip, ...]:
    """Strips in the file's order, then those of a meridian's pieces; what is wrong with them is collected."""
    strips: list[Strip] = []
    tables = study.strip
    for k, table in enumerate(tables):
        with problems.at(f"strip[{k + 1}]"):
            material = None if table.material is None else Material(**table.material.model_dump())
            strips.append(Strip(start=table.start, end=table.end, thickness=table.thickness, material=material))
    if chart is not None and len(strips) == len(tables):
        strips += piece_strips(study, chart)
        with problems.at("strip"):
            check_strips(strips, chart.bounds[0], None)
    return tuple(strips)


def piece_strips(study: StudyFile, chart: Chart) -> list[Strip]:
    """Strips of the pieces of a meridian that have a wall or a material of their own."""
    table = study.chart
    if not isinstance(table, MeridianTable) or not isinstance(chart, Revolved) or study.shell is None:
        return []
    assert isinstance(chart.profile, PiecewiseMeridian)
    return [
        Strip(
            start=start,
            end=end,
            thickness=part.thickness or study.shell.thickness,
            material=None if part.material is None else Material(**part.material.model_dump()),
        )
        for part, (start, end) in zip(table.piece, chart.profile.owners, strict=True)
        if part.thickness is not None or part.material is not None
    ]


def build_mesh(table: MeshTable, default: ShellMesh) -> ShellMesh:
    """The default mesh with what [mesh] says put in its place."""
    rows = tuple(table.rows) if isinstance(table.rows, list) else table.rows
    return ShellMesh(
        order=table.order or default.order,
        rows=default.rows if rows is None else rows,
        around=table.around or default.around,
    )


def build_supports(tables: dict[str, SupportTable], chart: Chart | None, problems: Problems) -> dict[str, Support]:
    """Supports by edge; edges the chart does not have are collected."""
    supports: dict[str, Support] = {}
    for edge, table in tables.items():
        if chart is not None and edge not in chart.edges:
            expected = f"one of the chart's edges {', '.join(chart.edges)}{hint(edge, chart.edges)}"
            problems.add(f"support.{edge}", f"edge {edge!r}", expected, "support-edge")
            continue
        with problems.at(f"support.{edge}"):
            supports[edge] = build_support(table, edge, chart)
    return supports


def build_support(table: SupportTable, edge: str, chart: Chart | None) -> Support:
    """The support of a [support.EDGE] table."""
    if isinstance(table, BoltsTable):
        return build_bolts(table, edge, chart)
    if isinstance(table, RingTable):
        return build_ring(table, edge, chart)
    if isinstance(table, ElasticTable):
        return ElasticEdge(**table.model_dump(exclude={"kind", "around"}), around=build_around(table))
    if isinstance(table, FixedTable):
        raise ValueError("kind: found 'fixed', which is for imported meshes, expected a kind for a chart's edge")
    if isinstance(table, SymmetryTable):
        return Symmetry()
    return Clamped() if table.kind == "clamped" else ShearDiaphragm()


def build_bolts(table: BoltsTable, edge: str, chart: Chart | None) -> Bolts:
    """Bolts of the file: degrees become radians, a width in metres an angle on the edge's mean radius."""
    require_angle(chart, edge, "bolts")
    width = None if table.width_deg is None else float(np.radians(table.width_deg))
    if table.width_m is not None:
        if chart is None or not chart.periodic:
            raise ValueError("width_m: found an open edge, expected a closed casing; give width_deg")
        width = table.width_m / edge_radius(chart, edge)
    parts = tuple(k or 0.0 for k in (table.k_r, table.k_theta, table.k_z))
    return Bolts(
        count=table.count,
        k=parts if table.k is None else table.k,  # type: ignore[arg-type]
        k_rot=table.k_rot,
        first_angle=float(np.radians(table.first_angle_deg)),
        width=width,
        spacing=None if table.spacing_deg is None else float(np.radians(table.spacing_deg)),
        loose={entry.bolt: entry.factor for entry in table.loose},
    )


def build_ring(table: RingTable, edge: str, chart: Chart | None) -> Ring:
    """A ring of the file, with its own support."""
    if table.diameter is not None:
        section = Section.circle(diameter=table.diameter)
    else:
        assert table.width is not None  # the table has seen to it
        assert table.depth is not None
        section = Section.rectangle(width=table.width, depth=table.depth)
    held = None if table.support is None else build_support(table.support, edge, chart)
    return Ring(
        section=section,
        material=None if table.material is None else Material(**table.material.model_dump()),
        offset=None if table.offset is None else (table.offset[0], table.offset[1]),
        foot=None if table.foot is None else (table.foot[0], table.foot[1]),
        support=held,  # type: ignore[arg-type]  # an elastic edge or bolts, as the table says
    )


def build_masses(tables: list[MassTable], chart: Chart | None, problems: Problems) -> dict[str, list[EdgeMass]]:
    """Point masses by edge; edges the chart does not have are collected."""
    masses: dict[str, list[EdgeMass]] = {}
    for k, table in enumerate(tables):
        if chart is not None and table.edge not in chart.edges:
            problems.add(f"mass[{k + 1}].edge", repr(table.edge), f"one of the chart's edges {', '.join(chart.edges)}")
            continue
        with problems.at(f"mass[{k + 1}]"):
            require_angle(chart, table.edge, "angle_deg")
            place = EdgeMass(angle=float(np.radians(table.angle_deg)), mass=table.mass)
            masses.setdefault(table.edge, []).append(place)
    return masses


def edge_radius(chart: Chart, edge: str) -> float:
    """Radius of the base or top of a closed chart [m]."""
    z = np.array([chart.bounds[0][chart.edges[edge][1]]])
    return float(np.linalg.norm(chart.surface(z, np.zeros(1), None).x[:2]))


def require_angle(chart: Chart | None, edge: str, key: str) -> None:
    """Refuse an angle on an edge that is measured in metres: of a plate or blade, or one that runs along the axis."""
    if chart is not None and (isinstance(chart, Plate | TwistedPlate | Blade) or chart.edges[edge][0] != 0):
        raise ValueError(f"{key}: found an edge without angles, {edge!r}, expected one that runs around an axis")


def build_around(table: ElasticTable) -> Field | dict[str, Field] | None:
    """How the springs of an elastic edge vary: all alike, or each by its own harmonics; None where they are even."""
    if isinstance(table.around, list):
        return series(table.around, "around", least=1) if table.around else None
    lists = {name: getattr(table.around, name) for name in ElasticEdge.stiffness_names}
    patterns: dict[str, Field] = {k: series(waves, f"around.{k}", least=1) for k, waves in lists.items() if waves}
    return patterns or None


def series(waves: list[Harmonic], key: str, least: int = 0) -> FourierField:
    """Harmonics of the file as a field."""
    numbers = [h.p for h in waves]
    if len(set(numbers)) < len(numbers) or min(numbers, default=least) < least:
        once = f"each p >= {least} once" if least else "each p once"
        raise ValueError(f"{key}: found harmonics {numbers}, expected {once}")
    return FourierField.of({h.p: (h.cos, h.sin) for h in waves})


def build_plies(table: ShellTable) -> tuple[Ply, ...]:
    """The layers of a wall."""
    laminae = {name: Lamina(**lamina.model_dump()) for name, lamina in table.lamina.items()}
    return tuple(
        Ply(
            thickness=ply.thickness,
            angle_deg=ply.angle_deg,
            lamina=None if ply.lamina is None else laminae[ply.lamina],
        )
        for ply in table.plies
    )


def build_field(table: ImperfectionTable, key: str, tables: StudyFile, problems: Problems) -> Field | None:
    """One imperfection field, or None with the reason collected."""
    if tables.chart is not None and tables.chart.kind in FLAT and table.of == "radius":
        found, expected = "'radius' on a plate, which has none", "thickness, or a chart with a radius"
        problems.add(f"{key}.of", found, expected, "field-no-radius")
        return None
    if table.harmonics is not None:
        with problems.at(f"{key}.harmonics"):
            return series(table.harmonics, f"{key}.harmonics")
    elif table.random is not None:
        with problems.at(f"{key}.random"):
            return build_random(table, int(key.partition("[")[2][:-1]), tables)
    elif table.survey is not None:
        with problems.at(f"{key}.survey"):
            survey = SurveyField.from_csv(
                problems.file.parent / table.survey, table.n_max, table.degree,
                robust=bool(table.robust), centred=bool(table.centred),
            )  # fmt: skip
            chart = None if tables.chart is None else build_chart(tables.chart)
            check_survey(survey, table.of, chart, None if tables.shell is None else tables.shell.thickness)
            return survey
    return None


def build_random(table: ImperfectionTable, stream: int, tables: StudyFile) -> RandomField | None:
    """A random field; None where the tables it needs are not in order, which is collected there."""
    seed, scale = table.seed or 0, 1.0 if table.scale is None else table.scale
    if isinstance(table.random, list):
        median = {wave.p: wave.median for wave in table.random}
        high = {wave.p: wave.high or RAYLEIGH * wave.median for wave in table.random}
        if len(median) < len(table.random):
            raise ValueError(f"found harmonics {[wave.p for wave in table.random]}, expected each p once")
        spectrum = Spectrum.between(median, high, p_max=table.p_max).scaled(scale)
        return RandomField(spectrum=spectrum, seed=seed, stream=stream)
    if tables.chart is None or tables.shell is None:
        return None
    radius, thickness, p_max = mean_radius(build_chart(tables.chart)), tables.shell.thickness, table.p_max or 32
    return RandomField.example(thickness=thickness, radius=radius, seed=seed, scale=scale, p_max=p_max, stream=stream)
