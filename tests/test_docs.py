"""The pages of docs/: all are reached from the first one, the gallery's examples run, what one asserts holds."""

import re
import runpy
from itertools import pairwise
from pathlib import Path

import matplotlib.figure
import matplotlib.pyplot as plt
import pytest

from reports.tools.structure import circles

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
GALLERY = sorted(DOCS.glob("gallery/*/*.py"))
TUTORIAL = sorted(DOCS.glob("tutorial/*.py"))
# those that take longer than a second are run by `make docs`, which stops at the first that fails, and by campaigns
LONG = {
    "a_wrong_row", "harmonic_balance", "how_firm_is_the_base", "interaction_table", "loose_bolt", "mesh",
    "random_imperfections", "rub",
}  # fmt: skip
TOCTREE = re.compile(r"^```\{toctree\}\n((?:.*\n)*?)```", re.MULTILINE)
COLUMNS = re.compile(r"^([A-Z_]+)(?:: \w+)? = (?:columns_of)?\(\n    Column\(", re.MULTILINE)
MADE = {"built/tutorial/index", "built/gallery/index", "built/api/index"}


def named(page: Path) -> list[str]:
    """The pages in the toctrees of a page, from docs/ on, without their ending."""
    blocks = TOCTREE.findall(page.read_text(encoding="utf-8"))
    lines = [line for block in blocks for line in block.splitlines() if line and not line.startswith(":")]
    return [(page.parent / line).relative_to(DOCS).as_posix() for line in lines]


def test_examples_that_take_long_are_there():
    assert {path.stem for path in GALLERY} >= LONG


def test_every_page_is_in_one_toctree_and_every_toctree_s_page_is_there():
    pages = {path.relative_to(DOCS).with_suffix("").as_posix(): path for path in DOCS.rglob("*.md")}
    held = [name for path in pages.values() for name in named(path)]
    assert len(pages) > 9
    assert sorted([*held, "index"]) == sorted([*pages, *MADE])


def test_headings_go_down_one_level_at_a_time_and_math_is_on_its_own():
    """What `make docs` would stop at: a heading two levels down, and an exponent without what it belongs to."""
    for page in DOCS.rglob("*.md"):
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        levels = [len(marks) for marks in re.findall(r"^(#+) ", text, re.MULTILINE)]
        assert all(after <= before + 1 for before, after in pairwise(levels)), page
        assert not re.search(r"\$[\^_]", text), page


def test_no_line_is_hidden_as_a_comment_and_no_row_of_a_table_is_broken():
    """Markdown takes a line that begins with a per cent sign for a comment, and ends a table at a broken row."""
    for page in [*DOCS.rglob("*.md"), *ROOT.glob("*.md")]:
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for line in text.splitlines():
            assert not line.lstrip().startswith("%"), (page, line)
            assert not line.startswith("|") or line.rstrip().endswith("|"), (page, line)


def test_the_page_of_keys_is_current():
    """It states the values of every key and its default, so that a changed range or default is seen."""
    page = runpy.run_path(str(DOCS / "keys.py"))["page"]()
    assert (DOCS / "keys.md").read_text(encoding="utf-8") == page, "run .venv/bin/python docs/keys.py"
    assert page.count("\n| ") > 700


def test_the_page_of_columns_is_current_and_has_those_of_every_module():
    made = runpy.run_path(str(DOCS / "columns.py"))
    assert (DOCS / "columns.md").read_text(encoding="utf-8") == made["page"](), "run .venv/bin/python docs/columns.py"
    for columns in map(made["columns_at"], made["RESULTS"].values()):
        assert len({column.name for column in columns}) == len(columns)
        assert all(column.text.endswith(".") and len(column.text.split()) < 25 for column in columns)
    defined = {
        ".".join([*path.relative_to(ROOT).with_suffix("").parts, name])
        for package in ("casingfem", "contact")
        for path in (ROOT / package).rglob("*.py")
        for name in COLUMNS.findall(path.read_text(encoding="utf-8"))
    }
    assert set(made["RESULTS"].values()) == defined


@pytest.mark.slow
def test_the_picture_of_the_architecture_shows_every_package_and_nothing_imports_itself_by_a_circle():
    made = runpy.run_path(str(DOCS / "architecture.py"))
    structure = made["Structure"](ROOT)
    assert circles(structure.imports) == []
    arrows = made["arrows_of"](structure)
    level = made["floors"](arrows)
    assert [(a, b) for a, b in arrows if level[a] <= level[b]] == []
    picture = (DOCS / "architecture.svg").read_text(encoding="utf-8")
    shown = set(re.findall(r">(\w+)</text>", picture))
    assert {box.rpartition(".")[2] for box in level} <= shown, "run .venv/bin/python -m docs.architecture"


def test_the_page_of_names_has_every_public_name_and_each_has_a_docstring_with_an_example():
    made = runpy.run_path(str(DOCS / "names.py"))
    names = {f"{room}.{name}": item for room, items in made["public"]().items() for name, item in items.items()}
    assert len(names) > 250
    assert [name for name, item in names.items() if not made["line"](item)] == []
    assert [name for name, item in names.items() if ">>>" not in (item.__doc__ or "")] == []
    written = re.findall(r"^\| `(\S+)` \| \S", (DOCS / "names.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert written == list(names), "run .venv/bin/python docs/names.py"


def test_every_example_is_in_a_section_of_the_gallery():
    sections = re.findall(r'"gallery/(\w+)"', (DOCS / "conf.py").read_text(encoding="utf-8"))
    assert len(GALLERY) >= 24
    assert sorted(sections) == sorted({path.parent.name for path in DOCS.glob("gallery/*/*")})
    assert all((DOCS / "gallery" / name / "GALLERY_HEADER.rst").is_file() for name in sections)
    assert not list(DOCS.glob("gallery/*.py"))


@pytest.mark.parametrize("path", [*TUTORIAL, *GALLERY], ids=lambda path: path.stem)
def test_an_example_has_a_title_one_picture_and_a_number_that_it_asserts(path):
    text = path.read_text(encoding="utf-8")
    title = re.match(r'r?"""\n(.+)\n(=+)\n\n', text)
    assert title
    assert len(title[1]) == len(title[2])
    assert len(re.findall(r"^assert .*\d", text, re.MULTILINE)) >= 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=[pytest.mark.campaign] * (path.stem in LONG)) for path in (*TUTORIAL, *GALLERY)],
    ids=lambda path: path.stem,
)
def test_an_example_runs_and_draws(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = runpy.run_path(str(path))
    assert isinstance(names["figure"], matplotlib.figure.Figure)
    assert any(axes.has_data() for axes in names["figure"].axes)
    plt.close("all")


def test_no_formula_is_broken_over_two_lines():
    for path in DOCS.rglob("*.md"):
        text = re.sub(r"```.*?```|\$\$.*?\$\$|`[^`]*`", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        assert [line for line in text.splitlines() if line.count("$") % 2] == [], path.name


def test_sections_of_docstrings_begin_on_lines_of_their_own():
    """An editor that joins lines makes one sentence of a heading and its list."""
    heading = re.compile(r"^\s*(Parameters|Attributes|Raises|Returns|Notes|Warns|Examples) -{3,}", re.MULTILINE)
    sources = [path for package in ("casingfem", "contact") for path in (ROOT / package).rglob("*.py")]
    assert [path.name for path in sources if heading.search(path.read_text(encoding="utf-8"))] == []
