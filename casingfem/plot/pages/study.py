"""The page on one study: inputs, modes, update and reduction of a chart shell or of an imported part."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.io.side_by_side import aside, usable_cores
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.modal.modes import modes
from casingfem.plot.page import Page, Section, Verdict, origin, render_page
from casingfem.plot.pages.fit import shapes_section, update_section, update_verdict
from casingfem.plot.pages.sections import (
    campbell_section,
    inputs_section,
    modes_section,
    provenance_section,
    reduction_section,
)
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.imported.turning_structure import rotation_of
from casingfem.structure.shell.shell import Shell
from casingfem.study import MeshStudy, Study, perfect
from casingfem.study.tasks import run_reduce, run_update
from casingfem.updating.addresses import get_value
from casingfem.updating.result import UpdateResult
from casingfem.updating.shape_fit import ShapeFit, shape_fit

MANY = 10_000  # unknowns of an imperfect shell, whose update takes three seconds or more
SYNTHETIC = "SYNTHETIC: the frequency table was made by a program; nobody measured it."


def study_page(study: Study | MeshStudy, say: Callable[[str], None] = lambda words: None) -> Page:
    """The page on a study; `say` is called with progress texts.

    Beside an update that takes seconds, another process computes and draws the modes; beside the reduction, the
    comparison.

    Raises
    ------
    StudyError, NumericsError
        The errors of update, reduction and modes.
    """
    clock = Clock(say)
    structure: Shell | MeshStructure = study.structure
    fit: UpdateResult | None = None
    compared: ShapeFit | None = None
    with aside(study.table is not None and takes_seconds(structure) and usable_cores() > 1) as start:
        first = start(partial(on_modes, study, say if study.table is None else silent))
        if study.table is not None:
            fit = clock("update", lambda: run_update(study))
            structure, compared = fit.structure, shape_fit(fit)
        on_start = first()
        comparison = None if fit is None else start(partial(on_fit, study, fit, compared, on_start.reference))
        basis = None
        if study.file.reduce is not None:
            basis = clock("reduction", lambda: run_reduce(study, structure))
        sections = [inputs_section(study), *on_start.sections]
        if comparison is not None:
            on_update, clock.seconds["update's comparison"] = comparison()
            sections += on_update
    if basis is not None:
        sections.append(reduction_section(basis, updated=study.table is not None))
    say("drawing")
    sections.append(provenance_section(study, on_start.seconds | clock.seconds))
    return Page(
        title=f"Study {study.path.stem}", sections=sections,
        verdict=study_verdict(study, on_start.found, fit, compared), source=origin(study.source),
        notice=SYNTHETIC if study.table is not None and study.table.synthetic else "",
    )  # fmt: skip


def silent(words: str) -> None:
    """Say nothing: progress of a part that runs beside another one."""


def takes_seconds(structure: Shell | MeshStructure) -> bool:
    """Whether an update takes much longer than the second in which another process starts."""
    return isinstance(structure, Shell) and structure.mesh.unknowns >= MANY and bool(structure.defects)


@dataclass(frozen=True, slots=True)
class OnModes:
    """Modes of a study before its update, those of the perfect shell, sections of the page and times of the parts."""

    found: ModeSet
    reference: Modes | None
    sections: list[Section]
    seconds: dict[str, float]


def on_modes(study: Study | MeshStudy, say: Callable[[str], None]) -> OnModes:
    """Compute and draw the modes of a study as its file gives it."""
    clock, wanted = Clock(say), study.file.modes.wanted
    found = clock("modes", lambda: modes(study.structure, **wanted))
    ideal = imperfect(study.structure)
    reference = None if ideal is None else clock("modes of the perfect shell", lambda: modes(ideal, **wanted))
    sections = [modes_section(found, reference, updated=study.table is not None)]
    if turns(study.structure):
        sections.append(clock("Campbell diagram", lambda: campbell_section(study.structure, len(found))))
    return OnModes(found, reference, sections, clock.seconds)


def on_fit(
    study: Study | MeshStudy, fit: UpdateResult, compared: ShapeFit | None, reference: Modes | None
) -> tuple[list[Section], float]:
    """Sections on the update of a study and their time [s]; `reference` has the modes of the perfect shell if known."""
    started = time.perf_counter()
    same = reference is not None and len(reference) >= len(fit.before) and starts_there(study, fit)
    return fit_sections(fit, compared, known=reference if same else None), time.perf_counter() - started


def update_page(study: Study | MeshStudy, fit: UpdateResult, samples: FloatArray | None = None) -> str:
    """HTML of the page on an update; `samples` of its posterior (draws, parameters) if there are any."""
    compared = shape_fit(fit)
    sections = [*fit_sections(fit, compared, samples), inputs_section(study), provenance_section(study, fit.seconds)]
    return render_page(
        f"Update of {study.path.stem}", sections, verdict=update_verdict(fit, compared), source=origin(study.source),
        notice=SYNTHETIC if fit.table.synthetic else "",
    )  # fmt: skip


def fit_sections(
    fit: UpdateResult, compared: ShapeFit | None, samples: FloatArray | None = None, *, known: Modes | None = None
) -> list[Section]:
    """Sections on an update, with mode shapes if they were measured.

    `known` are the modes of the perfect shell at the start values, if the caller has them.
    """
    ideal = imperfect(fit.before.structure) if known is None else None
    perfect_modes = known if ideal is None else modes(ideal, len(fit.before))
    sections = [update_section(fit, perfect_modes, samples)]
    return sections + ([] if compared is None else [shapes_section(compared)])


def starts_there(study: Study | MeshStudy, fit: UpdateResult) -> bool:
    """Whether an update started at the values of the study."""
    return all(
        np.allclose(get_value(study.structure, p.name), start, rtol=1e-12, atol=0.0)
        for p, start in zip(fit.parameters, fit.start, strict=True)
    )


T = TypeVar("T")


class Clock:
    """Runs named parts and records their times."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self.say = say
        self.seconds: dict[str, float] = {}

    def __call__(self, name: str, part: Callable[[], T]) -> T:
        """Run one part."""
        self.say(name)
        started = time.perf_counter()
        result = part()
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - started
        return result


def turns(structure: Shell | MeshStructure) -> bool:
    """Whether a structure rotates at a nonzero speed."""
    rotation = rotation_of(structure)
    return rotation is not None and rotation.omega != 0.0


def imperfect(structure: object) -> Shell | None:
    """The perfect shell if the shell differs from it, else None."""
    if not isinstance(structure, Shell):
        return None
    around = any(isinstance(s, ElasticEdge) and s.patterns for s in structure.supports.values())
    return perfect(structure) if around or structure.defects else None


def study_verdict(
    study: Study | MeshStudy, found: ModeSet, fit: UpdateResult | None, compared: ShapeFit | None = None
) -> Verdict:
    """The first statement of the page: on the update if there is one, else on the modes."""
    if fit is not None:
        judged = update_verdict(fit, compared)
        return replace(judged, facts=(("Modes", f"Before the update {lead(found)}"), *judged.facts))
    counted = (
        "The modes could not be counted by inertia: whether one is missing is not known."
        if found.sturm_count is None
        else f"No mode is missing: the count by inertia gives {found.sturm_count}."
        if found.sturm_count == len(found)
        else f"The count by inertia gives {found.sturm_count}: the last one is a member of a pair that was cut."
    )
    name = study.path.name
    further = (
        "Simulate a rub: casingfem rub, with the basis that casingfem reduce writes."
        if study.file.reduce is not None
        else f"Fit the model to a test: add a table [update] to {name}. Or reduce it for contact: add a table [reduce]."
    )
    return Verdict(found=lead(found), sure=f"{counted} A test has not confirmed this model.", further=further)


def lead(found: ModeSet) -> str:
    """Number of modes, and the first elastic one."""
    elastic = found.rigid
    if elastic >= len(found):
        return f"{len(found)} rigid-body modes; raise modes.count to compute elastic ones."
    n = int(found.nodal_diameters[elastic])
    first = f"{found.freq[elastic]:.2f} Hz" + (f" with {n} nodal diameters" if n >= 0 else "")
    rigid = f" {elastic} rigid-body modes come first." if elastic else ""
    return f"{len(found)} modes up to {found.freq[-1]:.1f} Hz; the lowest elastic one at {first}.{rigid}"
