"""The blade-off study, small: its tables, its page, the balance of the rotor's energy."""

import pandas as pd
import pytest

from reports.studies import blade_off


@pytest.mark.campaign
def test_the_study_runs_and_accounts_for_the_energy_of_the_spin(tmp_path, capsys):
    rows = blade_off.main(tmp_path, quick=True)
    runs = [row for row in rows if "run" in row]
    assert [row["run"] for row in runs] == ["12 blades", "1 blade", "draw 11", "draw 12"]
    assert all(row["unaccounted"] < 1e-12 and row["speed at the end [Hz]"] < 100.0 for row in runs)
    assert runs[2]["blade [mm]"] != runs[3]["blade [mm]"]
    choices = pd.read_csv(tmp_path / "blade_off_choices.csv")
    assert choices["fall of speed [%]"].abs().max() < 5.0
    page = (tmp_path / "blade_off" / "index.html").read_text(encoding="utf-8")
    assert "Fifteen seconds after a blade is lost" in page
    assert page.count("data:image/png") == 2
