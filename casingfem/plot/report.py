"""The report on one study: inputs, modes, update and reduction on a page that stands alone."""

import time
from collections.abc import Callable
from typing import TypeVar

from casingfem.modal.modes import Modes, modes
from casingfem.plot.fit import update_section
from casingfem.plot.fit_shapes import shapes_section
from casingfem.plot.page import render_page
from casingfem.plot.sections import inputs_section, modes_section, provenance_section, reduction_section
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.shell.shell import Shell
from casingfem.study import Study, perfect
from casingfem.study.tasks import run_reduce, run_update
from casingfem.updating.shape_fit import shape_fit

SYNTHETIC = "SYNTHETIC: the frequency table was made by a program; nobody measured it."


def study_report(study: Study, say: Callable[[str], None] = lambda words: None) -> str:
    """HTML of the report on a study; `say` is told what is being computed.

    Raises
    ------
    StudyError, NumericsError
        As the update, reduction and modes themselves do.
    """
    clock = Clock(say)
    found = clock("modes", lambda: modes(study.shell, **study.file.modes.wanted))
    ideal, reference = perfect(study.shell), None
    if has_imperfections(study.shell):
        reference = clock("modes of the perfect shell", lambda: modes(ideal, **study.file.modes.wanted))
    sections = [inputs_section(study), modes_section(found, reference)]
    structure = study.shell
    if study.table is not None:
        fit = clock("update", lambda: run_update(study, lambda k, rms: say(f"evaluation {k}: rms {rms:.3g}")))
        assert isinstance(fit.structure, Shell)  # that of the study
        structure, start, nominal = fit.structure, study.start, None
        if has_imperfections(start):
            nominal = clock("perfect shell", lambda: modes(perfect(start), len(fit.before)))
        sections.append(update_section(fit, nominal))
        compared = shape_fit(fit)
        sections += [] if compared is None else [shapes_section(compared)]
    if study.file.reduce is not None:
        basis = clock("reduction", lambda: run_reduce(study, structure))
        sections.append(reduction_section(basis, updated=study.table is not None))
    say("drawing")
    sections.append(provenance_section(study, clock.seconds))
    notice = SYNTHETIC if study.table is not None and study.table.synthetic else ""
    return render_page(f"Study {study.path.stem}", sections, lead=lead(study, found), notice=notice)


T = TypeVar("T")


class Clock:
    """Runs parts by name and keeps their times."""

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


def has_imperfections(shell: Shell) -> bool:
    """Whether anything sets this shell apart from a perfect one."""
    around = any(isinstance(s, ElasticEdge) and s.patterns for s in shell.supports.values())
    return around or bool(shell.defects)


def lead(study: Study, found: Modes) -> str:
    """The first paragraph: what the structure is and its first mode."""
    elastic = found.rigid
    if elastic >= len(found):
        return f"{len(found)} rigid motions; ask for more modes to see elastic ones."
    n = int(found.nodal_diameters[elastic])
    first = f"{found.freq[elastic]:.2f} Hz" + (f" with {n} nodal diameters" if n >= 0 else "")
    rigid = f" {elastic} rigid motions come first." if elastic else ""
    last = f"{found.freq[-1]:.1f} Hz"
    return f"{len(found)} modes up to {last}; the lowest elastic one at {first}.{rigid}"
