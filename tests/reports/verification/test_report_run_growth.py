"""Verdicts on growth of random rubs, run small."""

import pytest

from reports.verification.rubs import run_growth


@pytest.mark.campaign
def test_verdicts_agree_with_long_runs_and_rows_are_written(tmp_path):
    table = run_growth.main(tmp_path, quick=True)
    assert [row["kind"] for row in table] == 2 * ["rim", "rub", "disk", "all"]
    assert all(row["verdict"] == "pass" for row in table)
    assert sum(row["same sign"] for row in table if row["kind"] == "all") >= 11
    assert len((tmp_path / "run_growth.csv").read_text().splitlines()) == 13
