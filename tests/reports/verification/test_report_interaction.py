"""The sign of the pole is what a run does; the rows of B6 pass."""

import pytest

from reports.verification.rubs import interaction, interaction_map


@pytest.mark.campaign
def test_signs_agree_and_pictures_are_written(tmp_path, capsys):
    rows = interaction.main(tmp_path, quick=True)
    assert len(rows) == 14
    assert {row["signs"] for row in rows} == {"agree"}
    assert sum(row["pole 1/s"] > 0.0 for row in rows) == 6
    assert (tmp_path / "interaction_campbell.png").stat().st_size > 10_000
    assert (tmp_path / "interaction_safe.png").exists()
    assert "14 pairs: 14 agree" in capsys.readouterr().out


@pytest.mark.slow
def test_peaks_in_time_come_within_two_per_cent():
    for row in interaction.peaks():
        assert abs(row["run 1/s"] / row["pole 1/s"] - 1.0) < 0.02


@pytest.mark.slow
def test_digging_friction_moves_growth_to_the_difference():
    rows = {(row["mu"], row["lean deg"]): row for row in interaction.friction()}
    assert rows[0.0, 10.0]["backward 1/s"] < 0.0 < rows[0.0, 10.0]["sum 1/s"]
    digging = rows[0.3, 10.0]
    assert digging["sum 1/s"] < 0.0 < digging["backward 1/s"]
    assert digging["backward run 1/s"] == pytest.approx(digging["backward 1/s"], rel=0.02)
    assert rows[0.3, -10.0]["backward 1/s"] < 0.0


@pytest.mark.campaign
def test_map_by_poles_is_the_map_by_runs(tmp_path):
    *cost, verdict = interaction_map.main(tmp_path, quick=True)
    assert [row["points"] for row in cost] == [21, 21]
    assert 5 < verdict["grow by poles"] < 16
    assert verdict["told"] >= 18
    assert verdict["signs agree %"] == 100.0
    assert (tmp_path / "interaction_map" / "interaction_map.png").stat().st_size > 10_000
    assert (tmp_path / "interaction_map" / "map.csv").read_text(encoding="utf-8").count("\n") > 21
