"""Every report that a page, a card, a docstring or a comment names is there, and a command that is named can be run."""

import importlib.util
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
FOLDERS = ("casingfem", "contact", "data", "docs", "reports", "tests", ".ci")
KINDS = {".csv", ".html", ".j2", ".md", ".py", ".pyi", ".toml", ""}
COMMAND = re.compile(r"python\s+(?:#\s+)?-m\s+(?:#\s+)?(reports(?:\.\w+)+)")  # lines may break between
MENTION = re.compile(r"(?<![\w./])reports(?:\.[a-z]\w*)+")
PATH = re.compile(r"(?<![\w./])reports/[\w/]+\.(?:py|csv)")
MADE_UP = {"reports.NAME", "reports.no_such_report", "reports.tables"}  # of docstrings and tests


def texts() -> dict[str, str]:
    """Every file of the project that a reader opens, by its path."""
    paths = [path for path in ROOT.iterdir() if path.is_file()]
    for folder in FOLDERS:
        paths += [path for path in (ROOT / folder).rglob("*") if path.is_file()]
    read = {path.relative_to(ROOT): path for path in paths if path.suffix in KINDS}
    return {
        name.as_posix(): path.read_text(encoding="utf-8", errors="replace")
        for name, path in read.items()
        if not {"out", "__pycache__"} & set(name.parts)
    }


TEXTS = texts()


def named(pattern: re.Pattern[str], but: str = "nothing") -> dict[str, str]:
    """What a pattern finds in all files but those of one folder, each with a file that has it."""
    files = {name: text for name, text in TEXTS.items() if not name.startswith(but)}
    return {found: name for name, text in files.items() for found in pattern.findall(text) if found not in MADE_UP}


@cache
def source(module: str) -> str:
    """The source of a module that can be imported; nothing of one that is not there."""
    try:
        spec = importlib.util.find_spec(module)
    except ModuleNotFoundError:
        return ""
    return "" if spec is None or spec.origin is None else Path(spec.origin).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def commands() -> dict[str, str]:
    return named(COMMAND)


def test_every_command_named_can_be_run(commands: dict[str, str]) -> None:
    assert {"reports.studies.rig", "reports.verification.cylinder", "reports.benchmarks.first_use"} <= commands.keys()
    missing = {
        module: name
        for module, name in commands.items()
        if 'if __name__ == "__main__":' not in source(module) + source(f"{module}.__main__")
    }
    assert missing == {}


@pytest.mark.slow
def test_every_report_mentioned_is_there() -> None:
    mentions = named(MENTION)
    assert len(mentions) > 60
    missing = {}
    for mention, name in mentions.items():
        parent, _, last = mention.rpartition(".")
        if not source(mention) and not re.search(rf"\b{last}\b", source(parent)):
            missing[mention] = name
    assert missing == {}


@pytest.mark.slow
def test_every_file_of_the_reports_mentioned_is_there() -> None:
    files = named(PATH, but="tests/")  # which make some up
    assert "reports/campaigns.csv" in files
    assert {file: name for file, name in files.items() if not (ROOT / file).is_file()} == {}
