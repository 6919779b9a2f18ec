"""What reports share: the command line, tables, verdicts."""

import runpy
import sys

import numpy as np
import pytest

from reports import tables


def test_command_line_hands_on_folder_and_haste(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "argv", ["report", "--quick", "--out", str(tmp_path)])
    tables.command_line("A report.", lambda out, quick: seen.append((out, quick)))
    assert seen == [(tmp_path, True)]


def test_command_line_ends_with_an_error_where_rows_state_fail(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["report", "--out", str(tmp_path)])
    with pytest.raises(SystemExit, match="1 rows say that something is wrong"):
        tables.command_line("A report.", lambda out, quick: [{"verdict": "pass"}, {"verdict": "FAIL"}])


@pytest.mark.parametrize(
    ("report", "flag", "message"),
    [
        ("reports.benchmarks.tips_beside", "--beside", "no folder '{}/nowhere', expected one that exists"),
        ("reports.benchmarks.tips_beside", "--beside=.", "no casingfem/ in '.', expected a checkout"),
        ("reports.verification.updating.public_sets", "--folder", "no folder '{}/nowhere', expected one that exists"),
    ],
)
def test_a_report_without_the_folder_it_reads_ends_with_a_sentence(
    report, flag, message, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(sys.modules, report, raising=False)
    words = [flag] if "=" in flag else [flag, str(tmp_path / "nowhere")]
    monkeypatch.setattr(sys, "argv", ["report", *words, "--out", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module(report, run_name="__main__")
    assert ended.value.code == 2
    assert f"error: {flag.partition('=')[0]}: found {message.format(tmp_path)}" in capsys.readouterr().err


def test_table_lines_up_and_shows_gaps(capsys):
    tables.show("Title", [{"name": "a", "value": 1.23456}, {"name": "long", "value": None}])
    assert capsys.readouterr().out.splitlines()[1:] == ["Title", "name  value", "a     1.235", "long      -"]


def test_a_check_passes_has_its_reason_or_fails():
    rows = [tables.check("case", "source", 2.0, 2.0 + d, 1.0, gap=2.0, reason="why") for d in (0.01, -0.03, 0.05)]
    assert [row["verdict"] for row in rows] == ["pass", "why", "FAIL"]
    assert tables.check("case", "source", 0.0, 1e-9, 1e-6)["error %"] == pytest.approx(1e-7)
    assert tables.check("case", "source", 1.0, np.nan, 1.0, gap=9.0, reason="why")["verdict"] == "FAIL"
