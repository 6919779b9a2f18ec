"""The cache of machine code is named after everything that ends up in it."""

import ast
from pathlib import Path

import contact
from contact.compiled import SOURCES

ROOT = Path(contact.__file__).parent
# annotations and what is raised outside loops
NOT_COMPILED = {"contact.compiled", "contact.errors", "contact.model.arrays"}


def imported(source: Path) -> set[str]:
    """Modules of contact that a source takes names from."""
    tree = ast.walk(ast.parse(source.read_text()))
    return {
        str(node.module) for node in tree if isinstance(node, ast.ImportFrom) and str(node.module).startswith("contact")
    }


def file_of(module: str) -> Path:
    path = ROOT.parent.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def test_the_cache_watches_every_module_that_compiles() -> None:
    compiling = {source for source in ROOT.rglob("*.py") if "contact.compiled" in imported(source)}
    assert len(compiling) > 25
    assert compiling <= set(SOURCES)


def test_the_cache_watches_what_compiled_modules_take_from_elsewhere() -> None:
    taken = {module for source in SOURCES for module in imported(source)} - NOT_COMPILED
    assert {file_of(module) for module in taken} <= set(SOURCES)
