"""The table of dangerous speeds beside runs of its own, run small."""

import pytest

from reports.verification.rubs import beside


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore:.*mesh-thin-curved", "ignore:.*reduce-steady")  # coarse, and run at one speed
def test_runs_beside_the_tables_of_the_tutorial_and_of_rotor_37_confirm_them(tmp_path):
    rows = beside.main(tmp_path, quick=True)
    assert {row["machine"] for row in rows} == {"tutorial", "rotor 37"}
    assert all(row["agree"] == "yes" for row in rows)
    assert any(row["pole 1/s"] > 1.5 * row["high"] for row in rows)  # closed contact alone misleads
