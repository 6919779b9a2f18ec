"""Read study.toml: the objects that a study describes, or every problem of the file at once."""

import hashlib
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from casingfem.errors import with_code
from casingfem.experiment.correlation.measured_shapes import read_shapes
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.included import included_files
from casingfem.io.workbook import file_and_sheet
from casingfem.linalg.krylov import START_SEED
from casingfem.modal.interface.chart_rows import require_lines
from casingfem.modal.interface.kinds import Rim, Tip, TipNodes
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.shell.shell import Shell
from casingfem.study.build import build_shell, try_chart
from casingfem.study.cyclic import build_wheel
from casingfem.study.imported import MeshStudy, build_imported, is_imported, mesh_interface
from casingfem.study.plausible import add_implausible
from casingfem.study.problems import FromFile, Problems, StudyError
from casingfem.study.tables.tasks import REQUIRED, ParameterTable, ReduceTable, StudyFile, UpdateTable
from casingfem.updating.addresses import Structure, address_of, get_value, with_value
from casingfem.updating.numbers import HeldNumber
from casingfem.updating.parameters import Parameter
from casingfem.updating.shapes import SensorShapes
from contact.io.infiles import pipes_read_once, read_bytes
from contact.io.toml import read_toml

PACKAGES = ("casingfem", "numpy", "scipy", "scikit-fem")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Study(FromFile):
    """A study as its file describes it.

    Attributes
    ----------
    path, file
        Path of the file, and its tables as written.
    shell
        The structure.
    table, shapes, parameters
        From [update]: the measured frequencies and mode shapes, None without; the parameters.
    start
        The structure with the start values of the parameters, where an update begins.
    interface
        From [reduce]: the rim or tip for contact; None without.
    source
        Name and hash of the input (the file and all it refers to), versions, seed, for results.

    Examples
    --------
    >>> import casingfem as cf
    >>> study = cf.load_study("data/studies/frustum.toml")
    >>> study.path.name, study.shell.thickness
    ('frustum.toml', 0.003)
    """

    path: Path
    file: StudyFile
    shell: Shell
    start: Shell
    table: FrequencyTable | None
    shapes: SensorShapes | None
    parameters: tuple[Parameter, ...]
    interface: Rim | Tip | TipNodes | None
    source: dict[str, Any]

    @property
    def structure(self) -> Shell:
        """The structure, under the name that all studies use."""
        return self.shell


def load_shell_study(path: str | Path) -> Study:
    """Read the study of a shell on a chart; surveys and tables are found relative to it.

    Raises
    ------
    StudyError
        With all problems, one on each line: file: key: found X, expected Y. An imported mesh is one.

    Examples
    --------
    >>> load_shell_study("data/studies/frustum.toml").shell.thickness
    0.003
    """
    study = load_study(path)
    if isinstance(study, MeshStudy):
        key = "solid" if study.file.solid is not None else "shell.mesh"
        raise study.error(key, "an imported mesh", "a shell on a [chart] for this command")
    return study


@pipes_read_once()
def load_study(path: str | Path, *, wheel: bool = False) -> Study | MeshStudy:
    """Read a study file: the structure and tables it describes, all files it names read relative to it.

    Parameters
    ----------
    path
        A study.toml, of a shell on a chart or of an imported mesh.
    wheel
        Accept [cyclic], one sector of a wheel.

    Returns
    -------
    Study | MeshStudy
        `structure` is the shell or the imported part; `start` has the start values of [update].

    Raises
    ------
    StudyError
        An `InputError` with all problems, one on each line: file: key: found X, expected Y.

    Examples
    --------
    >>> import casingfem as cf
    >>> study = cf.load_study("data/studies/frustum.toml")
    >>> study.structure.chart
    Frustum(r_base=0.5, r_top=0.45, height=0.25)
    """
    file = Path(path)
    problems = Problems(file)
    text, data = tables_of(file)
    tables = validated(data, problems)
    if is_imported(data):
        structure = build_imported(tables, data, problems)
        table, parameters, begun = load_update(tables, structure, problems)
        if tables.update is not None and tables.update.shapes is not None:
            problems.add("update.shapes", repr(tables.update.shapes), "frequencies alone", "structure-chart")
        seen = mesh_interface(tables.reduce, structure, problems)
        whole = build_wheel(tables, structure, problems)
        if tables.cyclic is not None and not wheel:
            expected = "a study without it, as this command computes a single part"
            problems.add("cyclic", "a table [cyclic]", expected, "study-key")
        add_implausible(tables, structure, problems)
        if problems or structure is None or not isinstance(begun, Solid | MeshShell):
            raise StudyError(problems)
        return MeshStudy(
            path=file,
            file=tables,
            structure=structure,
            start=begun,
            table=table,
            parameters=parameters,
            interface=seen,
            wheel=whole,
            source=source(file, text, tables),
        )
    shell = build_shell(tables, problems)
    table, parameters, start = load_update(tables, shell, problems)
    shapes = load_shapes(tables.update, start, table, problems)
    chart = try_chart(tables, Problems(file))  # its problems are collected with the shell's
    interface = load_interface(tables.reduce, chart, problems)
    add_implausible(tables, shell, problems)
    if problems or shell is None or start is None:
        raise StudyError(problems)
    return Study(
        path=file,
        file=tables,
        shell=shell,
        start=start,
        table=table,
        shapes=shapes,
        parameters=parameters,
        interface=interface,
        source=source(file, text, tables),
    )


def tables_of(file: Path) -> tuple[bytes, dict[str, Any]]:
    """The bytes and the tables of a study file."""
    try:
        return read_toml(file)
    except OSError as error:
        raise StudyError([with_code("study-file", f"{file}: {error.strerror}")]) from None
    except ValueError as error:
        code = "study-toml" if str(error).startswith("not TOML") else "study-file"
        raise StudyError([with_code(code, f"{file}: {error}")]) from None


def validated(data: dict[str, Any], problems: Problems) -> StudyFile:
    """The valid tables; the problems of the others are collected."""
    for name in REQUIRED[:1] if is_imported(data) else REQUIRED:
        if name not in data:
            meaning = StudyFile.model_fields[name].description
            problems.add(name, "nothing", f"a table [{name}]: {meaning}", "study-missing")
    try:
        return StudyFile.model_validate(data)
    except ValidationError as error:
        bad = problems.add_invalid(error, data)
    return StudyFile.model_validate({key: value for key, value in data.items() if key not in bad})


def load_update(
    tables: StudyFile, shell: Structure | None, problems: Problems
) -> tuple[FrequencyTable | None, tuple[Parameter, ...], Structure | None]:
    """The frequency table, the parameters, and the shell with their start values."""
    if tables.update is None:
        return None, (), shell
    if tables.rotation is not None:
        problems.add("update", "[update] and [rotation]", "a test at rest; add [rotation] after the update")
    table = None
    with problems.at("update.table"):
        table = FrequencyTable.from_csv(problems.file.parent / tables.update.table, sigma=tables.update.sigma)
    parameters: list[Parameter] = []
    start = shell
    for k, entry in enumerate(tables.update.parameter):
        with problems.at(f"update.parameter[{k + 1}]"):
            if entry.name in (p.name for p in parameters):
                raise ValueError(f"name: found {entry.name} again, expected each parameter once")
            parameters.append(Parameter(**entry.model_dump(exclude={"start"})))
            if start is not None:
                require_stated(tables, start, entry.name)
                start = with_start_value(start, entry)
    return table, tuple(parameters), start


def require_stated(tables: StudyFile, structure: Structure, name: str) -> None:
    """Refuse a number of a ring's section that the study does not state: the updated study could not state it."""
    match address_of(structure, name):
        case HeldNumber(edge, ("section", key)) if getattr(tables.support[edge], key, None) is None:
            stated = [known for known in ("width", "depth", "diameter") if getattr(tables.support[edge], known, None)]
            raise ValueError(f"name: found {name}, expected a number that the study states: {' or '.join(stated)}")


def load_shapes(
    tables: UpdateTable | None, shell: Shell | None, table: FrequencyTable | None, problems: Problems
) -> SensorShapes | None:
    """The mode shapes of [update], located on the wall and matched to the rows of its table."""
    if tables is None or tables.shapes is None:
        return None
    with problems.at("update.shapes"):
        measured = read_shapes(problems.file.parent / tables.shapes)
        if tables.shape_sigma is None and np.isnan(measured.sigma).any():
            expected = f"the relative noise of the shapes, which {tables.shapes} does not state"
            problems.add("update.shape_sigma", "nothing", expected, "study-missing")
        elif shell is not None and table is not None:
            error, reach = tables.shape_error, tables.shape_reach
            return SensorShapes.of(measured, shell, table, reach=reach, sigma=tables.shape_sigma, error=error)
    return None


def with_start_value(shell: Structure, entry: ParameterTable) -> Structure:
    """The shell with a parameter at its start value, which must be within the bounds."""
    own = float(np.real(get_value(shell, entry.name)))
    value = own if entry.start is None else entry.start
    if not entry.lower <= value <= entry.upper:
        within = f"[{entry.lower:.6g}, {entry.upper:.6g}]"
        raise ValueError(f"{entry.name}: found the start {value:.6g}, expected it within {within}")
    return shell if entry.start is None else with_value(shell, entry.name, entry.start)


def load_interface(table: ReduceTable | None, chart: Chart | None, problems: Problems) -> Rim | Tip | TipNodes | None:
    """The rim or tip that [reduce] names."""
    if table is None or chart is None:
        return None
    for key in ("at", "axis", "point"):
        if getattr(table, key) is not None:
            found = str(getattr(table, key))
            problems.add(f"reduce.{key}", found, "no such key: it is for imported meshes", "study-key")
    if table.interface is None and not table.lines:
        return None
    curved = [edge for edge, (held, _) in chart.edges.items() if held == 0]
    if table.interface is not None and table.interface not in curved:
        expected = f"one of the chart's edges {', '.join(curved)}"
        problems.add("reduce.interface", repr(table.interface), expected, "interface-edge")
    if chart.periodic:
        if table.nodes is not None:
            problems.add("reduce.nodes", str(table.nodes), "no such key: a casing's rim has no pieces", "study-key")
        n_max = 40 if table.n_max is None else table.n_max
        with problems.at("reduce"):
            require_lines(chart, table.lines)
        return Rim(table.interface or "", n_max, axial=table.axial, lines=tuple(table.lines))
    for key in ("n_max", "axial", "lines"):
        if getattr(table, key):
            found = str(getattr(table, key))
            problems.add(f"reduce.{key}", found, "no such key: an open chart has no harmonics around", "study-key")
    edge = table.interface or ""
    return Tip(edge) if table.nodes is None else TipNodes(edge, table.nodes)


def source(file: Path, text: bytes, tables: StudyFile) -> dict[str, Any]:
    """Name and hash of the input, package versions, seed."""
    update, mistuning = tables.update, None if tables.cyclic is None else tables.cyclic.mistuning
    names = [entry.survey for entry in tables.imperfection]
    names += [name for entry in tables.imperfection for name in entry.surveys]
    names += [] if update is None else [update.table, update.shapes]
    names += [mistuning if isinstance(mistuning, str) else None]
    names += [table.mesh for table in (tables.solid, tables.shell) if table is not None]
    names += [] if tables.solid is None else [tables.solid.sections]
    files = [Path(file_and_sheet(file.parent / name)[0]) for name in names if name is not None]
    contents = [text, *(read_bytes(each) for name in files for each in (name, *included_files(name)))]
    return {
        "study": file.name,
        "sha256": hashlib.sha256(b"\0".join(contents)).hexdigest(),
        "versions": {name: version(name) for name in PACKAGES},
        "seed": START_SEED,
    }
