"""The report on chances, run small."""

import pytest

from reports.verification import chance


@pytest.mark.campaign
def test_splits_and_quantiles_of_the_report_are_right(tmp_path):
    rows = chance.main(tmp_path, quick=True)
    full = next(row for row in rows if row.get("against") == "full solutions")
    assert full["within 2 %"] == 1.0
    assert all(row["verdict"] in ("pass", "too few") for row in rows if "verdict" in row)
    assert next(row for row in rows if "speeds" in row)["speeds"] == 100
    assert {path.name for path in tmp_path.glob("*.csv")} == {
        "chance_dangerous.csv", "chance_family.csv", "chance_quantiles.csv", "chance_repeated.csv", "chance_speeds.csv",
    }  # fmt: skip
