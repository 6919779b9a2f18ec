"""The digest of machine code covers all compiled sources; what loops may hold, and what they are compiled for."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import contact
from contact.jit.bundle import Bundle
from contact.jit.machine_code import SOURCES
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
    "io.interrupts",
    "io.keys",
    "io.notebook",
)
NOT_COMPILED = {f"contact.{name}" for name in PLAIN}


def imported(source: Path) -> set[str]:
    """Modules of contact that a source takes names from."""
    return set(re.findall(r"^ *from (contact\.[\w.]+) import", source.read_text(), re.MULTILINE))


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


class Values(NamedTuple):
    values: np.ndarray


def test_a_loop_is_the_same_for_arrays_that_can_be_written_and_that_cannot() -> None:
    kept = np.zeros(3)
    kept.setflags(write=False)
    assert Bundle(Values(kept)).kind is Bundle(Values(np.zeros(5))).kind


def test_the_files_that_go_first_are_there() -> None:
    there = {path.name for path in Path(__file__).parents[2].rglob("test_*.py")}
    assert set(PLACE) <= there


def test_files_that_share_loops_go_to_one_process_and_others_by_themselves() -> None:
    scope = object.__new__(Groups)._split_scope
    assert scope("tests/contact/model/test_rub.py::test_a[b]") == scope("tests/contact/model/test_patch.py::test_c")
    assert scope("tests/contact/model/test_rub.py::test_a") != scope("tests/contact/model/test_rim.py::test_a")
    alone = "tests/casingfem/structure/field/test_field.py"
    assert scope(f"{alone}::test_a") == alone
