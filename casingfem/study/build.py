"""From the tables of a study file to a shell: each part is tried, and errors are collected with their keys."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.errors import InputError, warn
from casingfem.io import strict_csv
from casingfem.io.columns import MERIDIAN, named
from casingfem.io.together import together
from casingfem.structure.field.field import Field
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.field.random import RAYLEIGH, RandomField, Spectrum
from casingfem.structure.field.survey.points import read_points
from casingfem.structure.field.survey.survey import SurveyField
from casingfem.structure.geometry.blade import Blade, TwistedPlate
from casingfem.structure.geometry.chart import Chart, Cylinder, Frustum, Panel, Plate
from casingfem.structure.geometry.pieces import Piece, PiecewiseMeridian
from casingfem.structure.geometry.revolved import Arc, Revolved
from casingfem.structure.geometry.smooth import SmoothMeridian
from casingfem.structure.geometry.stations import Taper
from casingfem.structure.geometry.strip import Strip, check_strips
from casingfem.structure.geometry.survey_check import check_survey, mean_radius, on_meridian, with_rule
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.plies import Lamina, Ply
from casingfem.structure.shell.shell import Shell
from casingfem.study.cyclic import build_rotation
from casingfem.study.problems import Problems
from casingfem.study.supports import build_masses, build_stiffeners, build_supports, series
from casingfem.study.tables import shapes
from casingfem.study.tables.fields import ImperfectionTable
from casingfem.study.tables.tasks import StudyFile
from contact.io.tables import value_of

CHARTS: dict[str, Callable[..., Chart]] = {
    "frustum": Frustum, "cylinder": Cylinder, "panel": Panel, "plate": Plate, "twisted-plate": TwistedPlate,
    "blade": Blade,
}  # fmt: skip
FLAT = ("plate", "twisted-plate", "blade")  # kinds without a radius
LEAST = 1e-4  # of the largest amplitude of a survey
NOISE = 4.0  # standard deviations: amplitudes of a survey below are left out of a spectrum


def build_shell(tables: StudyFile, problems: Problems) -> Shell | None:
    """The shell of a study, or None with the collected reasons: first of each part, then of the whole."""
    if tables.cyclic is not None:
        problems.add("cyclic", "[cyclic] and [chart]", "[cyclic] with an imported mesh, one sector", "study-key")
    chart = try_chart(tables, problems)
    material = problems.made("material", Material, tables.material)
    supports = build_supports(tables.support, chart, problems)
    strips = build_strips(tables, chart, problems)
    stiffeners = build_stiffeners(tables.stiffener, chart, problems)
    taper = problems.made("taper", Taper, tables.taper)
    rotation = build_rotation(tables.rotation, chart, problems)
    masses = build_masses(tables.mass, chart, problems)
    fields: dict[str, Field] = {}
    surveys = [table.of for table in tables.imperfection if table.survey is not None]
    for of in {of for of in surveys if surveys.count(of) > 1}:
        found = f"{surveys.count(of)} surveys of the {of}"
        problems.add("imperfection", found, "one, because the deviation would be counted twice", "survey-twice")
    for k, table in enumerate(tables.imperfection):
        field = build_field(table, f"imperfection[{k + 1}]", tables, problems)
        if field is not None:
            fields[table.of] = fields[table.of] + field if table.of in fields else field  # type: ignore[operator]
    if chart is None or material is None or tables.shell is None or problems:
        return None
    shell = None
    with problems.at("support" if supports else "shell"):
        shell = Shell(
            chart=chart,
            thickness=tables.shell.thickness,
            material=material,
            wall=tables.shell.wall,
            plies=build_plies(tables.shell),
            supports=supports,
            strips=strips,
            stiffeners=stiffeners,
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
            warn("shell-free", f"{problems.file}: found no table [support.EDGE]")
        with problems.at("mesh"):
            return replace(shell, mesh=build_mesh(tables.mesh, shell.mesh))
    return None


def try_chart(tables: StudyFile, problems: Problems) -> Chart | None:
    """The chart of a study, or None with the collected reason."""
    if tables.chart is not None:
        with problems.at("chart"):
            return build_chart(tables.chart, problems.file.parent)
    return None


def build_chart(table: shapes.ChartTable, folder: Path) -> Chart:
    """The chart of a [chart] table; its files are relative to the study."""
    if isinstance(table, shapes.PointsTable):
        points = read_meridian(folder / table.points) if isinstance(table.points, str) else table.points
        return Revolved(profile=SmoothMeridian(points=tuple((r, z) for r, z in points)))
    if isinstance(table, shapes.MeridianTable):
        pieces = tuple(Piece(to=(p.to[0], p.to[1]), radius=p.radius, fillet=p.fillet) for p in table.piece)
        start = (table.start[0], table.start[1])
        return Revolved(profile=PiecewiseMeridian(start=start, pieces=pieces, fillet=table.fillet))
    if isinstance(table, shapes.DomeTable):
        return Revolved(profile=value_of(table, Arc))
    chart: Chart = value_of(table, CHARTS[table.kind])
    return chart


def read_meridian(path: Path) -> list[tuple[float, float]]:
    """The points of a CSV file or workbook with columns radius_m and z_m, in the order of its rows.

    Raises
    ------
    InputError
        The table is invalid; the message has the line.
    """
    table = named(strict_csv.read(path), MERIDIAN)
    if set(table.header) != {"radius_m", "z_m"}:
        raise table.refuse_header(found=",".join(table.written.values()), expected="radius_m,z_m")
    columns, wrong = list[list[float]](), list[InputError]()
    for name in ("radius_m", "z_m"):
        try:
            columns.append(table.numbers(name).tolist())
        except InputError as error:
            wrong.append(error)
    if wrong:
        raise together(wrong)
    return list(zip(*columns, strict=True))


def build_strips(study: StudyFile, chart: Chart | None, problems: Problems) -> tuple[Strip, ...]:
    """Strips in the file's order, then those of a meridian's pieces; their errors are collected."""
    strips: list[Strip] = []
    for k, table in enumerate(study.strip):
        with problems.at(f"strip[{k + 1}]"):
            material = None if table.material is None else value_of(table.material, Material)
            strips.append(value_of(table, Strip, material=material))
    if chart is not None and len(strips) == len(study.strip):
        strips += piece_strips(study, chart)
        with problems.at("strip"):
            check_strips(strips, chart.bounds[0], None)
    return tuple(strips)


def piece_strips(study: StudyFile, chart: Chart) -> list[Strip]:
    """Strips of the pieces of a meridian that have their own thickness or material."""
    table = study.chart
    if not isinstance(table, shapes.MeridianTable) or study.shell is None:
        return []
    assert isinstance(chart, Revolved)
    assert isinstance(chart.profile, PiecewiseMeridian)
    return [
        Strip(
            start=start,
            end=end,
            thickness=part.thickness or study.shell.thickness,
            material=None if part.material is None else value_of(part.material, Material),
        )
        for part, (start, end) in zip(table.piece, chart.profile.owners, strict=True)
        if part.thickness is not None or part.material is not None
    ]


def build_mesh(table: shapes.MeshTable, default: ShellMesh) -> ShellMesh:
    """The default mesh, with the values of [mesh] replaced."""
    rows, around = (tuple(part) if isinstance(part, list) else part for part in (table.rows, table.around))
    return ShellMesh(
        order=table.order or default.order,
        rows=default.rows if rows is None else rows,
        around=default.around if around is None else around,
    )


def build_plies(table: shapes.ShellTable) -> tuple[Ply, ...]:
    """The layers of a wall."""
    laminae = {name: value_of(lamina, Lamina) for name, lamina in table.lamina.items()}
    return tuple(value_of(ply, Ply, lamina=None if ply.lamina is None else laminae[ply.lamina]) for ply in table.plies)


def build_field(table: ImperfectionTable, key: str, tables: StudyFile, problems: Problems) -> Field | None:
    """One imperfection field, or None with the collected reason."""
    if tables.chart is not None and tables.chart.kind in FLAT and table.of == "radius":
        found, expected = "'radius' on a plate, which has none", "thickness, or a chart with a radius"
        problems.add(f"{key}.of", found, expected, "field-no-radius")
        return None
    if table.harmonics is not None:
        with problems.at(f"{key}.harmonics"):
            return series(table.harmonics, f"{key}.harmonics")
    elif table.random is not None:
        with problems.at(f"{key}.random"):
            return build_random(table, int(key.partition("[")[2][:-1]), tables, problems.file.parent)
    elif table.survey is not None:
        with problems.at(f"{key}.survey"):
            chart = None if tables.chart is None else build_chart(tables.chart, problems.file.parent)
            survey = SurveyField.fitted(
                read_points(problems.file.parent / table.survey),
                n_max=table.n_max,
                degree=table.degree,
                robust=bool(table.robust),
                centred=bool(table.centred),
                placed=lambda points: on_meridian(points, chart),
            )
            survey = with_rule(survey, table.outside, chart)
            check_survey(survey, table.of, chart, None if tables.shell is None else tables.shell.thickness)
            return survey
    return None


def spectrum_of_surveys(table: ImperfectionTable, folder: Path) -> Spectrum:
    """The spectrum that is fitted to the shapes of surveys, each even along the axis."""
    fits = []
    for name in table.surveys:
        survey = SurveyField.fitted(read_points(folder / name), degree=0)
        if survey.quantity != table.of:
            raise ValueError(f"{name}: found a survey of the {survey.quantity}, expected one of the {table.of}")
        fits.append(above_noise(survey))
    return Spectrum.of_surveys(fits, p_max=table.p_max)


def above_noise(survey: SurveyField) -> FourierField:
    """The harmonics of a survey whose amplitude is above that of the noise of its points, `NOISE` standard deviations.

    Noise of standard deviation r at N points gives each coefficient r sqrt(2/N). Digits of a file that are the same at
    all heights are no noise of this kind: amplitudes below `LEAST` of the largest are left out too.
    """
    fit = survey.fit
    size = np.hypot(fit.cos[:, 0], fit.sin[:, 0])
    noise = NOISE * survey.residual_rms * np.sqrt(2.0 / survey.points)
    seen = size > max(noise, LEAST * size.max(initial=0.0))
    return FourierField(p=fit.p[seen], cos=fit.cos[seen], sin=fit.sin[seen])


def build_random(table: ImperfectionTable, stream: int, tables: StudyFile, folder: Path) -> RandomField | None:
    """A random field; None if the tables it needs are invalid, which is collected there."""
    seed, scale = table.seed or 0, 1.0 if table.scale is None else table.scale
    if table.surveys:
        spectrum = spectrum_of_surveys(table, folder).scaled(scale)
        return RandomField(spectrum=spectrum, seed=seed, stream=stream)
    if waves := table.waves:
        median = {wave.p: wave.median for wave in waves}
        high = {wave.p: wave.high or RAYLEIGH * wave.median for wave in waves}
        if len(median) < len(waves):
            raise ValueError(f"found harmonics {[wave.p for wave in waves]}, expected each p once")
        spectrum = Spectrum.between(median, high, p_max=table.p_max).scaled(scale)
        return RandomField(spectrum=spectrum, seed=seed, stream=stream)
    if tables.chart is None or tables.shell is None:
        return None
    radius = mean_radius(build_chart(tables.chart, folder))
    thickness, p_max = tables.shell.thickness, table.p_max or 32
    return RandomField.example(thickness=thickness, radius=radius, seed=seed, scale=scale, p_max=p_max, stream=stream)
