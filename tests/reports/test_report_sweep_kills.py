"""Killed sweeps on a local Dask cluster, killed commands; scenes that diverge, or are mistyped."""

import csv
import subprocess
import sys

import pytest

from reports.robustness import diverging, sweep_kills
from reports.tables import ROOT


@pytest.mark.campaign
def test_a_sweep_under_kill_9_loses_nothing(tmp_path):
    pytest.importorskip("distributed")
    (row,) = sweep_kills.main(tmp_path, quick=True)
    assert (row["workers killed"], row["drivers killed"], row["failed"]) == (2, 1, 0)
    assert row["finished before the table was asked for"] == 200
    assert row["unreadable files"] == 0
    assert row["table identical"]
    assert row["identical after damage"]


@pytest.mark.slow
def test_scenes_that_diverge_are_stopped_and_mistyped_ones_refused(tmp_path):
    rows = diverging.main(tmp_path, quick=True)
    verdicts = {row["verdict"] for row in rows}
    assert {"stopped", "refused"} <= verdicts <= {"stopped", "refused", "flagged", "swept"}
    assert len(diverging.cases()) == 40


@pytest.mark.campaign
def test_commands_under_kill_9_leave_the_old_set_or_the_new(tmp_path):
    """In a process of its own: it forks."""
    line = [sys.executable, "-m", "reports.robustness.set_kills", "--quick", "--out", str(tmp_path)]
    subprocess.run(line, cwd=ROOT, check=True, capture_output=True)
    with (tmp_path / "set_kills.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 8
    for row in rows:
        assert (int(row["kills"]) >= 4, row["torn"], row["left over"], row["verdict"]) == (True, "0", "0", "pass")
