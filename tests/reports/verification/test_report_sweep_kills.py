"""Killed sweeps and commands, damaged files, stray points; scenes that diverge, or are mistyped."""

import csv
import os
import signal
import subprocess
import sys
import warnings

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
import contact as ct
from reports.tables import ROOT
from reports.verification.robustness import diverging, file_mutations, schema, schema_bases, stray_points, sweep_kills
from reports.verification.robustness.sample_files import READERS, write_tests


@pytest.mark.campaign
def test_a_sweep_under_kill_9_loses_nothing(tmp_path):
    pytest.importorskip("distributed")
    (row,) = sweep_kills.main(tmp_path, quick=True)
    assert (row["workers killed"], row["drivers killed"], row["failed"]) == (2, 1, 0)
    assert row["finished before the table was asked for"] == 200
    assert row["unreadable files"] == 0
    assert row["table identical"]
    assert row["identical after damage"]


@pytest.mark.campaign
def test_scenes_that_diverge_are_stopped_and_mistyped_ones_refused(tmp_path):
    rows = diverging.main(tmp_path, quick=True)
    verdicts = {row["verdict"] for row in rows}
    assert {"stopped", "refused"} <= verdicts <= {"stopped", "refused", "flagged", "swept"}
    assert len(diverging.cases()) == 40


@pytest.mark.campaign
def test_commands_under_kill_9_leave_the_old_set_or_the_new(tmp_path):
    """In a process of its own: it forks."""
    line = [sys.executable, "-m", "reports.verification.robustness.set_kills", "--quick", "--out", str(tmp_path)]
    subprocess.run(line, cwd=ROOT, check=True, capture_output=True)
    with (tmp_path / "set_kills.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 24
    for row in rows:
        assert (int(row["kills"]) >= 4, row["torn"], row["left over"], row["verdict"]) == (True, "0", "0", "pass")


@pytest.mark.campaign
def test_damaged_files_end_in_no_traceback(tmp_path):
    rows = file_mutations.main(tmp_path, quick=True)
    assert len(rows) == 57
    for row in rows:
        assert (row["mutants"], row["failed"]) == (20, 0)
        assert row["refused"] > 2


@pytest.mark.campaign
def test_bad_values_of_keys_end_in_no_traceback(tmp_path):
    rows = schema.main(tmp_path, quick=True)
    assert sum(row["cases"] for row in rows) > 150
    assert sum(row["refused"] for row in rows) > 100
    assert not any(row["failed"] for row in rows)


def test_every_key_of_a_table_gets_every_bad_value():
    base = next(base for base in schema.BASES if base.name == "cylinder")
    found = {(case.path, case.damage): case.text for case in schema.cases() if case.base == base}
    damages = {damage for path, damage in found if path == ("shell", "thickness")}
    assert damages == {"wrong type", *schema.NUMBERS, "empty text", "empty list"}
    assert '"thickness" = 1e+30' in found[("shell", "thickness"), "huge"]
    assert '"count" = -1' in found[("modes", "count"), "negative"]
    assert '"around" = "word"' in found[("mesh", "around"), "wrong type"]


def test_the_judge_of_bad_values_sees_tracebacks_and_numbers_that_are_not_finite():
    base = schema_bases.Base("modes", "modes", "study", schema_bases.CASING)
    case = schema.Case(base, ("shell", "thickness"), "huge", 1e30, (3e-3,))

    def outcome(code, out="", err="", raised=""):
        return schema.judged(case, schema.Ended(code, out, err, raised), {".a": "1"})[0]

    assert outcome(2, err="x.toml: shell.thickness: found 1e30") == "refused"
    assert outcome(2, err="x.toml: found 1e30") == "unnamed"
    assert outcome(3, err="the numerics failed") == "numerics"
    assert outcome(0, out='{"a": 1}') == "accepted"
    assert outcome(0, out='{"a": NaN}') == "failed"
    assert outcome(0, out='{"a": 1}', err="a.py:3: RuntimeWarning: x") == "failed"
    assert outcome(1, raised="KeyError: 'a'") == "failed"
    assert schema.judged(case, None, {})[0] == "failed"


def unnamed(_):
    """A reader whose error does not name the file."""
    raise OSError("no file")


def test_the_judge_of_damaged_files_sees_what_differs(tmp_path):
    write_tests(tmp_path)
    path, reader = tmp_path / "table.csv", READERS["table.csv"]
    data = path.read_bytes()
    whole = dict(file_mutations.leaves(reader(path)))
    assert file_mutations.judged(reader, path, whole) == ("same", "")
    path.write_bytes(data.replace(b"371.2", b"371.3"))
    assert file_mutations.judged(reader, path, whole) == ("differs", ".freq_hz")
    path.write_bytes(data.replace(b"371.2", b"371,2"))
    assert file_mutations.judged(reader, path, whole) == ("refused", "")
    assert file_mutations.judged(lambda _: {}["x"], path, whole) == ("TRACEBACK", "KeyError: 'x'")
    assert file_mutations.judged(unnamed, path, whole) == ("TRACEBACK", "OSError: no file")
    damaged = file_mutations.mutants(data, "table.csv", 60, 1)
    assert len({mutant for _, mutant in damaged}) > 40


@pytest.mark.parametrize(
    ("warning", "verdict"),
    [
        (ct.scene.SceneWarning("turning-unstated", "a.toml: speed.turning: missing"), "differs, warned"),
        (cf.errors.ModelWarning("mesh-coarse", "found 1 element"), "differs, warned"),
        (RuntimeWarning("overflow"), "TRACEBACK"),
    ],
)
def test_the_judge_of_damaged_files_accepts_warnings_of_the_project_only(tmp_path, warning, verdict):
    def reader(_):
        warnings.warn(warning, stacklevel=2)

    assert file_mutations.judged(reader, tmp_path / "a.toml", {"": "1"})[0] == verdict


@pytest.mark.slow
def test_a_reader_that_hangs_or_dies_is_counted_and_the_rest_goes_on(tmp_path, monkeypatch):
    """Each in turn of three files: one kills its process, one never ends, one is read."""

    def reader(path):
        content = path.read_bytes()
        if content == b"die":
            os.kill(os.getpid(), signal.SIGKILL)
        while content == b"hang":
            pass
        return content

    (tmp_path / "a.txt").write_bytes(b"whole")
    monkeypatch.setitem(READERS, "a.txt", reader)
    monkeypatch.setattr(file_mutations, "SECONDS", 0.3)
    todo = [("d", b"die"), ("h", b"hang"), ("w", b"whole"), ("o", b"other")]
    found = list(file_mutations.verdicts(tmp_path, "a.txt", todo))
    assert [verdict for _, verdict, _ in found] == ["HANG OR DEATH", "HANG OR DEATH", "same", "differs"]


def test_matrices_that_differ_are_seen():
    A = csc_array(np.eye(3))
    B = csc_array(np.diag([1.0, 2.0, 1.0]))
    assert dict(file_mutations.leaves([A, A])) != dict(file_mutations.leaves([A, B]))
    assert dict(file_mutations.leaves([A, B])) != dict(file_mutations.leaves([B, A]))


@pytest.mark.slow
def test_stray_points_are_found_unasked(tmp_path):
    rows = stray_points.main(tmp_path, quick=True)
    assert [row["verdict"] for row in rows] == ["pass"] * 9
