"""The digest of machine code covers all compiled sources; parts, announcements and garbage while loops compile."""

import ast
import gc
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import contact
from contact.jit.compiled import OPTIONS, compiled, jit, jit_entry
from contact.jit.machine_code import SOURCES
from contact.jit.progress import WORDS, Announcement, Uncollected
from contact.solver.friction.one_contact import scalar_force
from tests.conftest import PLACE, Groups

ROOT = Path(contact.__file__).parent
# annotations and what is raised outside loops
PLAIN = (
    "jit.compiled",
    "jit.machine_code",
    "jit.progress",
    "base.errors",
    "base.arrays",
    "io.brief",
    "io.keys",
    "io.notebook",
)
NOT_COMPILED = {f"contact.{name}" for name in PLAIN}


def imported(source: Path) -> set[str]:
    """Modules of contact that a source takes names from."""
    tree = ast.walk(ast.parse(source.read_text()))
    return {
        str(node.module) for node in tree if isinstance(node, ast.ImportFrom) and str(node.module).startswith("contact")
    }


def file_of(module: str) -> Path:
    path = ROOT.parent.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@pytest.mark.slow
def test_the_cache_watches_every_module_that_compiles() -> None:
    compiling = {source for source in ROOT.rglob("*.py") if "contact.jit.compiled" in imported(source)}
    assert len(compiling) > 25
    assert compiling <= set(SOURCES)


@pytest.mark.slow
def test_the_cache_watches_what_compiled_modules_take_from_elsewhere() -> None:
    taken = {module for source in SOURCES for module in imported(source)} - NOT_COMPILED
    assert {file_of(module) for module in taken} <= set(SOURCES)


def test_a_part_of_a_loop_is_compiled_as_an_entry_when_python_calls_it() -> None:
    """It has no way in of its own: without that the call would end the process."""
    assert scalar_force(2.0, -1.0) == 0.5


def test_long_compiling_is_said_once_and_short_not_at_all() -> None:
    said: list[str] = []
    patient, hasty = (Announcement(after=after, say=said.append) for after in (60.0, 0.0))
    for listening in (patient, hasty, hasty):
        for nested in (listening.on_start, listening.on_start):
            nested(None)
        if listening is hasty and listening.timer is not None:
            listening.timer.join()
        for nested in (listening.on_end, listening.on_end):
            nested(None)
    assert said == [WORDS]


def test_garbage_is_let_be_from_the_first_function_that_is_compiled() -> None:
    listening = Uncollected()
    assert gc.isenabled()
    try:
        listening.on_start(None)
        assert not gc.isenabled()
        listening.on_end(None)
        assert gc.isenabled()
    finally:
        gc.enable()


def test_garbage_is_collected_again_after_compiling() -> None:
    running = []

    class Seen(Uncollected):
        def on_end(self, _: Any) -> None:
            running.append(gc.isenabled())
            super().on_end(_)
            running.append(gc.isenabled())

    listening = Seen()
    listening.on_start(None)
    listening.on_start(None)
    listening.on_end(None)
    listening.on_end(None)
    assert running == [False, False, False, True]
    gc.disable()
    try:  # who has switched it off keeps it off
        listening.on_start(None)
        listening.on_end(None)
        assert running[-2:] == [False, False]
    finally:
        gc.enable()


@jit
def following(k: int) -> int:
    return k + 1


def counted(n: int) -> int:
    k = 0
    for _ in range(n):
        k = following(k)
    return following(2) + k


def test_a_part_is_compiled_once_for_the_number_zero_and_for_others() -> None:
    assert compiled(counted, {**OPTIONS, "cache": False})(3) == 6  # from disk the caller would come without its parts
    part: Any = following
    assert len(part.overloads) == 1


class Numbers(NamedTuple):
    values: np.ndarray


@jit_entry
def first_or_none(numbers: Numbers | None) -> float:
    return 0.0 if numbers is None else numbers.values[0]


@jit_entry
def sum_without(numbers: Numbers | None) -> float:
    if numbers is None:
        return numbers.nothing
    return numbers.values[0] + numbers.values[1]


def test_what_a_bundle_has_no_need_of_is_not_compiled() -> None:
    """Under `is None` stands what a bundle could not even do."""
    given = Numbers(np.array([2.0, 3.0]))
    assert sum_without(given) == 5.0
    assert (first_or_none(None), first_or_none(given)) == (0.0, 2.0)


def test_the_files_that_go_first_are_there() -> None:
    there = {path.name for path in Path(__file__).parents[2].rglob("test_*.py")}
    assert set(PLACE) <= there


def test_files_that_share_loops_go_to_one_process_and_others_by_themselves() -> None:
    scope = object.__new__(Groups)._split_scope
    assert scope("tests/contact/model/test_rub.py::test_a[b]") == scope("tests/contact/model/test_patch.py::test_c")
    assert scope("tests/contact/model/test_rub.py::test_a") != scope("tests/contact/model/test_rim.py::test_a")
    alone = "tests/casingfem/structure/field/test_field.py"
    assert scope(f"{alone}::test_a") == alone


def test_what_is_compiled_within_the_time_is_not_announced_and_the_next_is_timed_anew():
    said = []
    telling = Announcement(after=60.0, say=said.append)
    for _ in range(2):
        telling.on_start(None)
        first = telling.timer
        telling.on_start(None)  # what it calls
        assert telling.timer is first
        telling.on_end(None)
        assert telling.timer is first
        telling.on_end(None)
        assert telling.timer is None
        assert first.finished.is_set()  # cancelled
    assert said == []
