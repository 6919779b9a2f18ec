"""README and pages are true: examples run and print what they claim, commands and links exist."""

import importlib
import operator
import re
import shlex
import tomllib
from pathlib import Path

import pytest

from casingfem.cli import main

ROOT = Path(__file__).parents[1]
DOCS = tuple(path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "docs").rglob("*.md")))
PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", *DOCS)
TEXT = {name: (ROOT / name).read_text(encoding="utf-8") for name in PAGES}
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PRINTS = re.compile(r"# prints: (.+)$", re.MULTILINE)
EXAMPLES = [
    pytest.param(code, id=f"{Path(page).stem}-{k + 1}")
    for page in ("README.md", *DOCS)
    for k, code in enumerate(code for kind, code in FENCE.findall(TEXT[page]) if kind == "python")
]
CONSOLE = [
    line.removeprefix("$ ").partition("  #")[0].split()
    for page in PAGES
    for kind, block in FENCE.findall(TEXT[page])
    if kind == "console"
    for line in block.splitlines()
    if line.startswith("$ ")
]


def spoken(pattern: str) -> set[str]:
    """What a pattern finds in all pages."""
    return {found for text in TEXT.values() for found in re.findall(pattern, text)}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder that resembles the repository's to an example, and takes what it writes."""
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_example_prints_or_asserts_a_number():
    codes = [example.values[0] for example in EXAMPLES]
    assert len(codes) > 15
    assert [code for code in codes if not PRINTS.findall(code) and "assert " not in code] == []


@pytest.mark.slow
@pytest.mark.parametrize("code", EXAMPLES)
def test_examples_run_and_print_what_they_state(code, folder, capsys):
    names: dict[str, object] = {"__name__": "example"}
    exec(compile(code, "page.md", "exec"), names)
    for name, value in names.items():
        if name.startswith("test_") and callable(value):
            value()
    printed = capsys.readouterr().out.splitlines()
    claims = PRINTS.findall(code)
    assert [line for line in printed if line in claims] == claims
    for name in re.findall(r'savefig\("(\S+)"\)', code):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")


def test_every_make_target_named_exists():
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    named = spoken(r"`make ([a-z]+)") | {words[1] for words in CONSOLE if words[0] == "make"}
    assert {"study", "test"} <= named <= targets


def command_lines() -> list[list[str]]:
    """Every `casingfem ...` of the consoles, without the program."""
    return [words[1:] for words in CONSOLE if words[0].endswith("casingfem")]


def test_the_pages_list_every_command():
    shown = {words[1] for words in CONSOLE if words[0].endswith("casingfem")}
    assert shown == set(main.commands)


@pytest.mark.parametrize("words", command_lines(), ids=" ".join)
def test_every_command_line_is_understood(words):
    command = main.commands[words[0]]
    context = command.make_context(words[0], words[1:])
    file = context.params.get("file")
    assert file is None or str(file).startswith("reports/out/") or (ROOT / file).is_file()


@pytest.mark.parametrize("words", sorted(spoken(r"`casingfem ([^`]+)`")))
def test_every_command_and_option_in_the_text_exists(words):
    name, *rest = shlex.split(words)
    command, rest = (main, [name]) if name.startswith("-") else (main.commands[name], rest)
    options = {option for parameter in command.params for option in parameter.opts} | {"--help"}
    assert {word for word in rest if word.startswith("-")} <= options


@pytest.mark.parametrize("page", PAGES)
def test_every_link_and_path_leads_somewhere(page):
    links = [((ROOT / page).parent, link) for link in re.findall(r"\]\(([^)#]+)(?:#[\w-]+)?\)", TEXT[page])]
    links += [
        (ROOT, path) for path in re.findall(r"`((?:casingfem|contact|data|reports|tests|docs)/[\w./]+)`", TEXT[page])
    ]
    for folder, link in links:
        if not link.startswith(("https://", "reports/out")):
            assert (folder / link).exists(), link


MAP = TEXT["docs/architecture.md"].partition("## Where things are")[2].partition("## ")[0]


def test_the_map_names_every_package():
    inits = [path for top in ("casingfem", "contact", "reports") for path in (ROOT / top).glob("*/**/__init__.py")]
    packages = [init.parent.relative_to(ROOT).as_posix() for init in inits]
    assert len(packages) > 15
    assert [package for package in packages if f"`{package}/" not in MAP] == []


def test_files_in_the_map_are_in_a_folder_of_their_row():
    for row in MAP.splitlines():
        folders = [ROOT / path for path in re.findall(r"`((?:casingfem|contact|reports)/(?:\w+/)*)[\w.]*`", row)]
        for name in re.findall(r"`(\w+\.py)`", row):
            assert any((folder / name).is_file() for folder in folders), f"{name}: {row}"


@pytest.mark.parametrize("page", PAGES)
def test_every_heading_linked_to_is_there(page):
    for file, anchor in re.findall(r"\]\(([^)#]*)#([\w-]+)\)", TEXT[page]):
        target = (ROOT / page).parent / file if file else ROOT / page
        headings = re.findall(r"^#+ (.+)$", target.read_text(encoding="utf-8"), re.MULTILINE)
        assert anchor in {re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in headings}, anchor


def test_every_dependency_is_explained():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = project["dependencies"] + project["optional-dependencies"]["dev"]
    names = {re.match(r"[\w-]+", line)[0] for line in needed} - {"casingfem"}  # its own extras
    section = TEXT["docs/dependencies.md"]
    explained = {name for row in re.findall(r"^\| ([\w, -]+) \|", section, re.MULTILINE) for name in row.split(", ")}
    assert explained - {"package", "---"} == names


def test_the_version_is_the_newest_in_the_changelog():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert re.search(r"^## \[([\d.]+)\]", TEXT["CHANGELOG.md"], re.MULTILINE)[1] == version


def test_synthetic_data_states_so():
    section = TEXT["docs/data.md"].partition("# What is measured")[2].partition("## ")[0]
    found = re.findall(r"\]\(\.\./(data/[\w/]+\.csv)\) \| (MEASURED|SYNTHETIC)", section)
    assert len(found) >= 4
    for path, kind in found:
        assert (ROOT / path).read_text(encoding="utf-8").startswith(f"# {kind}"), path
    assert section.count("SYNTHETIC") == 3


def test_every_call_of_the_walks_is_there():
    walks = TEXT["docs/architecture.md"].partition("## Walks")[2].partition("## How")[0]
    names = re.findall(r"`((?:casingfem|contact)\.[\w.]+)`", walks)
    assert len(names) == 18
    for name in names:
        module, _, last = name.rpartition(".")
        if module.rpartition(".")[2][0].isupper():  # a method
            module, _, owner = module.rpartition(".")
            last = f"{owner}.{last}"
        assert callable(operator.attrgetter(last)(importlib.import_module(module))), name
