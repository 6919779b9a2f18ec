"""The rotating beam's report, small: closed forms, balances and the picture."""

import pytest

from reports.verification.schemes import rotating_beam


@pytest.mark.campaign
def test_rotating_beam_meets_the_rigid_closed_form_and_balances(tmp_path):
    rows = rotating_beam.main(tmp_path, quick=True)
    explicit = [row for row in rows if "courant" in row["run"] or "N m" in row["run"] or "ring" in row["run"]]
    assert len(explicit) >= 5
    assert all(row["unaccounted"] < 1e-12 and row["ang. momentum"] < 1e-8 for row in explicit)
    assert all(row["penetration [m]"] == 0.0 for row in explicit if "ring" not in row["run"])
    assert all(abs(row["first contact %"]) < 0.3 for row in explicit if not row["run"].startswith("5 "))
    assert not any(row[""] for row in rows)
    assert (tmp_path / "rotating_beam.png").stat().st_size > 20_000
