"""Verdicts over speed against many more runs, run small."""

import pytest

from reports.verification.rubs import speeds_between


@pytest.mark.campaign
def test_two_tables_are_compared_with_many_runs_and_rows_are_written(tmp_path):
    table = speeds_between.main(tmp_path, quick=True)
    assert [row["speeds"] for row in table] == ["ct.interactions", "even"]
    assert all(0.0 <= row[name] < 5.0 for row in table for name in ("other verdict [%]", "unsafe called safe [%]"))
    assert len((tmp_path / "speeds_between.csv").read_text().splitlines()) == 5
