"""The coating's report, small: machining closes the contact, wear ends the interaction, the energies agree."""

import pandas as pd
import pytest

from reports.studies import jumps, wear


@pytest.mark.campaign
def test_machined_closed_and_worn_free(tmp_path, capsys):
    rows = {row["coating"]: row for row in wear.main(tmp_path, quick=True)}
    closed = {name: row["last turn [%]"] for name, row in rows.items()}
    assert closed["as made"] < 35.0 < 99.9 < closed["machined"]
    assert closed["wear in"] > 99.9 > closed["as made"]
    assert rows["wear in"]["past touch [um]"] < 80.0 < 99.0 < rows["as made"]["past touch [um]"]
    assert rows["wear in"]["out of round [um]"] < 0.2 * rows["as made"]["out of round [um]"]
    assert rows["wear in"]["largest [N]"] < 0.2 * rows["pressed"]["largest [N]"]
    assert closed["digging in"] < 50.0
    assert rows["digging hard"]["n = 10, highest [m]"] > 1e-3
    assert rows["digging soft"]["n = 10, highest [m]"] < 5e-5
    assert closed["digging soft"] < 15.0
    assert all(abs(row["against profile"]) < 1e-11 and row["unaccounted"] < 1e-10 for row in rows.values())
    assert [row["worn [cm^3]"] > 0.0 for row in rows.values()] == [False, False, True, False, True, True, False, True]
    assert (tmp_path / "abradable" / "digging_soft.png").stat().st_size > 10_000
    assert len(pd.read_csv(tmp_path / "wear.csv")) == 8


@pytest.mark.campaign
def test_runs_of_slowly_changing_speed_jump_where_the_branch_folds(tmp_path, capsys):
    rows = jumps.main(tmp_path, quick=True)
    assert [row["verdict"] for row in rows] == ["pass"] * 4
    assert rows[0]["computed"] < rows[1]["computed"] < rows[3]["computed"]  # what jumps up comes back elsewhere
    assert (tmp_path / "jumps.png").stat().st_size > 10_000
