"""The table of published, exact and independent references: what passes, and what has its reason."""

import math

import pandas as pd
import pytest

from reports.tables import ROOT
from reports.verification import table as verification


def judged(rows, digits):
    """Every row's error is that of its values, its verdict that of its error; what does not pass has its reason."""
    for row in rows:
        error = 100.0 * (row["computed"] / row["reference"] - 1.0 if row["reference"] else row["computed"])
        assert math.isclose(row["error %"], error, rel_tol=1e-6, abs_tol=1e3 * 10.0**-digits), row
        assert (row["verdict"] == "pass") == (abs(row["error %"]) <= row["allowed %"]), row
        assert row["verdict"] == "pass" or len(row["verdict"].split()) > 2, f"a reason in words: {row}"
    return [row["verdict"] for row in rows]


def test_the_kept_table_passes_or_states_why_not():
    """That of the last full run; tests/references compute again what is published."""
    verdicts = judged(pd.read_csv(ROOT / "docs" / "verification.csv").to_dict("records"), 6)
    assert len(verdicts) >= 347
    assert "FAIL" not in verdicts
    assert verdicts.count("pass") >= 296


@pytest.mark.campaign
def test_verification_passes_or_states_why_not(tmp_path, capsys):
    rows = verification.main(tmp_path, quick=True)
    verdicts = judged(rows, 12)
    assert "FAIL" not in verdicts
    assert len(verdicts) == 231  # those of every module of the room among them
    assert verdicts.count("pass") >= 180
    names = [str(row["case"]) for row in rows]
    heads = ("A0", "A1", "A2", "A3", "A4")
    assert [sum(name.startswith(head) for name in names) for head in heads] == [20, 29, 21, 7, 5]
    assert len(pd.read_csv(tmp_path / "verification.csv")) == len(rows)
    assert " 0 fail" in capsys.readouterr().out
