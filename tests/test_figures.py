"""Figures that pages quote are those of the last run; campaigns are run, recorded and go on after a failure."""

import csv
import re
from pathlib import Path

import pytest

from reports import tables
from reports.tools.campaign import quoted
from reports.tools.campaign import run as campaign
from reports.tools.campaign.campaigns import CAMPAIGNS, Campaign
from reports.tools.campaign.figures import (
    MARK,
    PAGES,
    ROOT,
    Number,
    adopt,
    marks,
    numbers,
    placed,
    read_store,
    write_store,
)

STORE = read_store()
PAGE = {name: (ROOT / name).read_text(encoding="utf-8") for name in PAGES}
UNMARKED = {  # tables of docs/accuracy.md by their first heading: times of a machine, runs of others, a quick run's
    "solid": "times and memory",
    "split over half-power bandwidth": "identification_splits.csv of the campaign",
    "set, repository, licence": "responses of other projects, not in this repository",
    "channels x lines": "times of a machine",
    "code and method": "measured once, no command here repeats them",
}
COMMANDS = {
    ".".join(path.relative_to(ROOT / "reports").with_suffix("").parts).removesuffix(".__main__")
    for path in (ROOT / "reports").rglob("*.py")
    if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
}


def bodies(text: str) -> list[tuple[str, list[str]]]:
    """The tables of a page: first heading, rows."""
    found = re.findall(r"^\| (.+?) \|.*\n\|[-|]+\|\n((?:\|.*\n?)+)", text, re.MULTILINE)
    return [(heading, rows.splitlines()) for heading, rows in found]


@pytest.mark.parametrize("page", PAGES)
def test_every_marked_figure_is_the_last_run_s(page):
    for mark in marks(PAGE[page]):
        placed(mark, mark.figures(STORE))


@pytest.mark.parametrize("page", PAGES)
def test_every_comment_that_resembles_a_mark_is_one(page):
    assert len(re.findall("<!--", PAGE[page])) == len(list(marks(PAGE[page]))) == len(MARK.findall(PAGE[page]))


def test_every_row_of_readme_s_table_has_its_mark_and_is_on_the_accuracy_page():
    section = PAGE["README.md"].partition("## How far to trust it")[2].partition("## ")[0]
    ((_, rows),) = bodies(section)
    assert len(rows) >= 3
    assert [row for row in rows if not MARK.search(row)] == []
    assert [row for row in rows if row not in PAGE["docs/accuracy.md"]] == []


def test_every_table_of_the_accuracy_page_has_its_marks():
    tables_of_page = bodies(PAGE["docs/accuracy.md"])
    assert len(tables_of_page) >= 18
    assert [heading for heading, _ in tables_of_page if heading in UNMARKED] == list(UNMARKED)
    bare = [row for heading, rows in tables_of_page if heading not in UNMARKED for row in rows if not MARK.search(row)]
    assert bare == []


def test_times_state_when_they_were_measured():
    solids = PAGE["docs/accuracy.md"].partition("**Large solids.**")[2].partition("\n\n")[0]
    for text in (PAGE["docs/speed.md"], solids):
        assert re.search(r"python -m reports\.\w+", text)
        assert re.search(r"\d{1,2} [A-Z]\w+ 20\d\d", text)


def test_what_is_kept_is_quoted_from_a_campaign_s_tables():
    assert set(STORE) <= set(quoted.QUOTED) <= {one.name for one in CAMPAIGNS}
    assert {mark.report for text in PAGE.values() for mark in marks(text)} == set(quoted.QUOTED)


@pytest.mark.parametrize(
    ("text", "figure", "other"),
    [("0.88", 0.8849, 0.886), ("1.1e-4", 1.14e-4, 1.2e-4), ("10,290", 10290, 10291), ("-0.49", -0.4921, 0.4921),
     ("130", 130, 131), ("39", 39.1, 39.6), ("1", 1.0, 0.6), ("0", 0.0, 1e-4), ("+14.1", 14.06, 14.2)],
)  # fmt: skip
def test_a_number_states_a_figure_at_its_own_precision(text, figure, other):
    number = Number(start=0, text=text, below=False)
    assert number.says(figure)
    assert not number.says(other)
    assert Number(start=0, text=number.saying(other), below=False).says(other) or text in "10"
    assert number.saying(figure) == text


def test_a_bound_keeps_what_is_smaller_and_moves_only_when_it_must():
    number = Number(start=0, text="1e-14", below=True)
    assert number.says(-3e-15)
    assert number.saying(3e-15) == "1e-14"
    assert number.saying(2e-13) == "2e-12"
    assert not number.says(2e-14)


def test_numbers_of_code_addresses_marks_and_words_are_not_seen():
    line = "| `run 3` [page](a5.md) n6 < 1e-14, 10,290 or -.5 <!-- cylinder: 0.005 --> |"
    assert [(number.text, number.below) for number in numbers(line)] == [
        ("1e-14", True),
        ("10,290", False),
        ("-.5", False),
    ]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "docs").mkdir()
    write_store({"one": {"a b": {"x": 1.25, "y": 0.31}}, "two": {"all": {"z": 7.0}}}, tmp_path)
    (tmp_path / "page.md").write_text(
        "# Page 1.2\n\n| a | 1.2 | 0.31 <!-- one: a b --> |\n| b | 1.2 | 0.31 |\n\nSeven is 7, x is\n1.25.\n"
        "<!-- two: all --> <!-- one: a b @ x -->\n",
        encoding="utf-8",
    )
    return tmp_path


def test_a_run_renews_its_own_figures_where_they_are_marked_and_nothing_else(folder):
    before = (folder / "page.md").read_text(encoding="utf-8")
    assert adopt("one", {"a b": {"x": 12.0, "y": 0.4}}, folder, ["page.md"]) == ["page.md"]
    after = (folder / "page.md").read_text(encoding="utf-8")
    assert after == before.replace("| a | 1.2 | 0.31 ", "| a | 12.0 | 0.40 ").replace("1.25.", "12.00.")
    assert adopt("one", {"a b": {"x": 12.0, "y": 0.4}}, folder, ["page.md"]) == []
    assert adopt("one", {"a b": {"x": 1.25, "y": 0.31}}, folder, ["page.md"]) == ["page.md"]
    assert (folder / "page.md").read_text(encoding="utf-8") == before
    assert read_store(folder)["two"] == {"all": {"z": 7.0}}


def test_a_figure_that_is_not_in_its_row_is_named(folder):
    page = (folder / "page.md").read_text(encoding="utf-8").replace("| a | 1.2 |", "| a | 1.4 |")
    with pytest.raises(ValueError, match=r"one, a b, x: 1\.25 is not in '\| a \| 1\.4"):
        [placed(mark, mark.figures(read_store(folder))) for mark in marks(page)]


@pytest.mark.parametrize("row", ["another", "a b"])
def test_a_run_without_a_quoted_figure_leaves_store_and_every_page_alone(folder, row):
    (folder / "first.md").write_text("x is 1.25 <!-- one: a b @ x -->\n", encoding="utf-8")
    with pytest.raises(KeyError):
        adopt("one", {row: {"x": 2.0}}, folder, ["first.md", "page.md"])
    assert read_store(folder)["one"] == {"a b": {"x": 1.25, "y": 0.31}}
    assert "1.25" in (folder / "first.md").read_text(encoding="utf-8")


def test_cells_become_figures_in_the_page_s_unit(tmp_path):
    rows: list[tables.Row] = [{"kind": "a", "n": 2, "error": 0.011, "gap": None}, {"kind": "b", "n": 3, "error": 1.0}]
    tables.write(tmp_path / "t.csv", rows)
    table = quoted.Table("t.csv", ("kind", "n"), quoted.percent("error") | quoted.plain("gap"), only={"kind": "a"})
    assert table.figures(tmp_path) == {"a 2": {"error %": pytest.approx(1.1)}}


def test_every_campaign_is_a_report_with_a_subject_that_exists():
    for one in CAMPAIGNS:
        assert one.name in COMMANDS
        assert all((ROOT / path).exists() for path in one.subject), one.name


def test_every_report_is_a_campaign_or_states_why_not():
    parts = {f"verification.{name}" for name in ("cone", "twisted_plate", "splitting", "locking")}  # rows of the table
    tools = {
        "tools.campaign",
        "tools.drawn",
        "tools.frozen",
        "verification.modes.calculix",
        "verification.updating.public_sets",  # a folder of other projects' files
        "studies.rig.synthetic",
        "tools.structure",
        "benchmarks.runs_of_tips",
        "benchmarks.device",  # a CUDA device
    }
    assert COMMANDS - {one.name for one in CAMPAIGNS} == parts | tools


@pytest.mark.slow
def test_campaigns_go_on_after_a_failure_and_are_recorded(tmp_path, capfd):
    chosen = [Campaign("no_such_report", "", ("contact",)), Campaign("tables", "", ("contact",))]
    rows = campaign.main(chosen, tmp_path / "out", tmp_path)
    assert [row["verdict"] for row in rows] == ["FAIL: exit code 1", "pass"]
    assert [str(row["command"]).split()[-1] for row in rows] == ["reports.no_such_report", "reports.tables"]
    campaign.keep(rows[1] | {"verdict": "again"}, tmp_path)
    record = campaign.read_record(tmp_path)
    assert {name: row["verdict"] for name, row in record.items()} == {
        "no_such_report": "FAIL: exit code 1",
        "tables": "again",
    }
    assert "=== python -m reports.tables" in capfd.readouterr().out


def test_a_report_whose_rows_state_fail_ends_with_one():
    assert tables.failures([{"verdict": "pass"}, {"verdict": "a reason"}, {"faults": 0}]) == 0
    assert tables.failures([{"verdict": "FAIL"}, {"verdict": "MISSED"}, {"faults": 2}, {"SILENT": 1}]) == 4
    assert tables.failures({"rig": 1.0}) == 0


@pytest.mark.slow
def test_the_last_runs_are_listed_whatever_git_knows():
    assert [row["campaign"] for row in campaign.last()] == [one.name for one in CAMPAIGNS]
    assert campaign.since("", ("contact",)) == "never run"
    assert campaign.since("0" * 40, ("contact",)) == "commit unknown here"


def kept_rows() -> list[tables.Row]:
    with Path(ROOT, "docs", "verification.csv").open(newline="", encoding="utf-8") as stream:
        return [dict(line) for line in csv.DictReader(stream)]


def test_no_bound_of_the_verification_is_wider_than_what_is_seen_asks_for():
    rows = kept_rows()
    assert tables.loose(rows) == []
    assert not [row["case"] for row in rows if row["verdict"] == "FAIL"]
    counts = STORE["verification"]["all"]
    assert len(rows) == counts["rows"] == counts["pass"] + counts["reason"]


def test_a_bound_that_is_too_wide_is_named():
    rows = kept_rows()
    reasoned = next(row for row in rows if row["verdict"] != "pass")
    reasoned["bound %"] = 2.0 * abs(float(str(reasoned["error %"])))
    passed = [row for row in rows if row["source"] == "ring theory, closed form"]
    for row in passed:
        row["bound %"] = 1.0
    assert len(tables.loose(rows)) == 2
    assert str(reasoned["case"]) in tables.loose(rows)[0]
