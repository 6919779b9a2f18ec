"""Intervals of the growth of runs beside poles, run small."""

import pytest

from reports.verification.rubs import growth_intervals


@pytest.mark.campaign
def test_intervals_of_growth_have_the_pole_of_closed_contact(tmp_path):
    row, *_ = growth_intervals.main(tmp_path, quick=True)
    assert row["runs"] >= 3
    assert row["off over pole"] < 0.2
    assert len((tmp_path / "growth_intervals.csv").read_text().splitlines()) == row["runs"] + 1
