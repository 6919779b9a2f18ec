"""Reports run small, write what they say, and find the numbers the README quotes."""

import sys
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from reports import (
    cone,
    cylinder,
    frustum_convergence,
    loose_bolts,
    mistuning,
    run,
    speed,
    splitting,
    steel_ring,
    sweep_kills,
    sweep_speed,
    tables,
    twisted_plate,
    verification,
    verify_fields,
    verify_rings,
)


def test_frustum_convergence_marks_the_default_mesh_and_finds_it_good(tmp_path, capsys):
    rows = frustum_convergence.main(tmp_path, quick=True)
    table = pd.read_csv(tmp_path / "frustum_convergence.csv")
    assert len(table) == len(rows) >= 4
    default = [row for row in rows if row[""]]
    assert {row["method"] for row in default} == {"shell", "fourier"}
    assert all(row["worst error"] < 2e-4 and row["sturm"] == 40 and row["doublet gap"] < 1e-10 for row in default)
    assert "<- default" in capsys.readouterr().out
    assert frustum_convergence.exact_frequencies()[[0, -1]].tolist() == [367.9087, 980.6034]


def test_cylinder_counts_rows_within_a_thousandth(tmp_path, capsys):
    rows = cylinder.main(tmp_path, quick=True)
    assert [row["within .1 %"] for row in rows[:3]] == [40, 40, 38]
    assert rows[2]["worst %"] < 0.19
    assert len(pd.read_csv(tmp_path / "cylinder.csv")) == 200
    assert "118 of 120 rows within .1 %" in capsys.readouterr().out


@pytest.mark.slow
def test_speed_gives_ratios_and_steps(tmp_path):
    rows = speed.main(tmp_path, quick=True)
    steps = pd.read_csv(tmp_path / "speed.csv").set_index("step")
    assert steps.loc["assemble, 10290 dofs", "over assembly"] == 1.0
    assert steps.loc["40 modes, perfect casing by harmonics", "seconds"] < steps.loc["40 modes", "seconds"]
    runs = pd.read_csv(tmp_path / "speed_contact.csv")
    assert np.all(runs["us/step"] < 50.0)
    assert len(rows) == len(steps) + len(runs)


def test_run_takes_the_reports_in_turn(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(run, "REPORTS", ("cylinder",))
    assert list(run.main(tmp_path, quick=True)) == ["cylinder"]
    assert (tmp_path / "cylinder_summary.csv").exists()
    assert "=== reports.cylinder" in capsys.readouterr().out


def test_command_line_hands_on_folder_and_haste(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "argv", ["report", "--quick", "--out", str(tmp_path)])
    tables.command_line("A report.", lambda out, quick: seen.append((out, quick)))
    assert seen == [(tmp_path, True)]


def test_table_lines_up_and_shows_gaps(capsys):
    tables.show("Title", [{"name": "a", "value": 1.23456}, {"name": "long", "value": None}])
    assert capsys.readouterr().out.splitlines()[1:] == ["Title", "name  value", "a     1.235", "long      -"]


def test_verification_passes_or_says_why_not(tmp_path, capsys):
    rows = verification.main(tmp_path, quick=True)
    verdicts = [row["verdict"] for row in rows]
    assert "FAIL" not in verdicts
    assert verdicts.count("pass") >= 65
    assert all(verdicts)
    names = [str(row["case"]) for row in rows]
    assert [sum(name.startswith(head) for name in names) for head in ("A0", "A1", "A2", "A3", "A4")] == [
        20,
        29,
        21,
        7,
        5,
    ]
    assert len(pd.read_csv(tmp_path / "verification.csv")) == len(rows)
    assert " 0 fail" in capsys.readouterr().out


def test_a_check_passes_has_its_reason_or_fails():
    rows = [tables.check("case", "source", 2.0, 2.0 + d, 1.0, gap=2.0, reason="why") for d in (0.01, -0.03, 0.05)]
    assert [row["verdict"] for row in rows] == ["pass", "why", "FAIL"]
    assert tables.check("case", "source", 0.0, 1e-9, 1e-6)["error %"] == pytest.approx(1e-7)
    assert tables.check("case", "source", 1.0, np.nan, 1.0, gap=9.0, reason="why")["verdict"] == "FAIL"


def test_quick_tables_of_cones_and_twisted_plates(tmp_path, capsys):
    assert len(cone.main(tmp_path, quick=True)) == 20
    assert len(pd.read_csv(tmp_path / "cone.csv")) == 240
    assert len(twisted_plate.main(tmp_path, quick=True)) == 10
    printed = capsys.readouterr().out
    assert "without shear and rotary inertia 240" in printed
    assert "75 of 80 rows within .5 %" in printed


def test_a_split_that_the_rule_forbids_is_seen():
    """The same frustum, judged by a wrong p: what must part does."""
    name, parts = next(iter(splitting.fields().items()))
    shell = frustum_convergence.reference_frustum(splitting.ODD)
    row = splitting.stays_double(name, replace(shell, **parts), 5, "a wrong rule")
    assert row["verdict"] == "FAIL"


def test_a_ring_as_strip_and_as_beam_agree(tmp_path):
    rows = steel_ring.main(tmp_path, quick=True)
    gaps = [abs(row["beam/strip - 1 %"]) for row in rows]
    assert max(gaps) < 1.0
    assert max(abs(row["strip Hz"] / row["no ring Hz"] - 1.0) for row in rows) > 0.08  # the ring matters more
    assert len(pd.read_csv(tmp_path / "steel_ring_bolts.csv")) == 6


@pytest.mark.slow
def test_two_loose_bolts_settle_and_lead_the_lowest_mode(tmp_path):
    rows = loose_bolts.main(tmp_path, quick=True)
    assert [row["worst"] for row in rows] == sorted((row["worst"] for row in rows), reverse=True)
    assert rows[1]["worst"] < 3e-3
    first = pd.read_csv(tmp_path / "loose_bolts.csv")
    assert first["shift %"][0] < -10.0
    assert np.all(first["shift %"] < 0.0)  # springs were only taken away
    ratio = pd.read_csv(tmp_path / "bolt_meshes.csv")["estimate/computed"]
    assert np.all((ratio > 0.1) & (ratio < 10.0))


def test_rows_of_rings_pass_or_say_why():
    verdicts = [row["verdict"] for row in verify_rings.rows(quick=True)]
    assert len(verdicts) == 18
    assert "FAIL" not in verdicts
    assert verdicts.count("pass") == 16


@pytest.mark.slow
def test_mistuning_restarts_gain_digits_with_each_step(tmp_path):
    rows = mistuning.main(tmp_path, quick=True)
    krylov, subspace = (
        [row["worst error"] for row in rows if row["space"] == space] for space in ("Krylov", "subspace")
    )
    assert krylov[2] < 1e-7
    assert krylov[1] < subspace[1] / 50
    assert len(pd.read_csv(tmp_path / "mistuning.csv")) == 6


def test_fields_quick_rows_pass():
    assert {row["verdict"] for row in verify_fields.rows(quick=True)} == {"pass"}


@pytest.mark.slow
def test_speed_tables_are_whole_and_leaps_change_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep_speed, "RUNS", 16)
    rows = sweep_speed.main(tmp_path, quick=True)
    names = ("us/step alone", "tips", "speed-up alone", "cores")
    speeds, several, leaps, swept = ([row for row in rows if name in row] for name in names)
    assert all(row["% of peak flops"] > 0.0 for row in (*speeds, *several))
    assert len(several) == 9
    assert speeds[-1]["terms of the rows"] > 1.5 * speeds[0]["terms of the rows"]
    assert max(row["state differs by"] for row in leaps) <= 1e-12
    assert leaps[-1]["contact fraction"] < 0.1 < leaps[0]["contact fraction"]
    assert [row["failed"] for row in swept] == [0, 0]


@pytest.mark.slow
def test_a_sweep_under_kill_9_loses_nothing(tmp_path):
    pytest.importorskip("distributed")
    (row,) = sweep_kills.main(tmp_path, quick=True)
    assert (row["workers killed"], row["drivers killed"], row["failed"]) == (2, 1, 0)
    assert row["finished before the table was asked for"] == 200
    assert row["unreadable files"] == 0
    assert row["table identical"]
    assert row["identical from a new index"]
