"""The table of published, exact and independent references, small: what passes, and what has its reason."""

import pandas as pd
import pytest

from reports.verification import table as verification


@pytest.mark.slow
def test_verification_passes_or_says_why_not(tmp_path, capsys):
    rows = verification.main(tmp_path, quick=True)
    verdicts = [row["verdict"] for row in rows]
    assert "FAIL" not in verdicts
    assert len(verdicts) == 227  # those of every module of the room among them
    assert verdicts.count("pass") >= 180
    for row in rows:
        error = 100.0 * (row["computed"] / row["reference"] - 1.0 if row["reference"] else row["computed"])
        assert row["error %"] == pytest.approx(error), row
        assert (row["verdict"] == "pass") == (abs(error) <= row["allowed %"]), row
        assert row["verdict"] == "pass" or len(row["verdict"].split()) > 2, f"a reason in words: {row}"
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
