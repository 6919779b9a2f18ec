"""The reports on updating run small and say what they should."""

import numpy as np
import pytest

from reports.studies import fan_blade
from reports.verification.updating import checks, twin, wrong_rows
from reports.verification.updating.derivatives import ENOUGH, extrapolated


@pytest.mark.campaign
def test_the_script_to_copy_runs(tmp_path, capsys):
    row = fan_blade.main(tmp_path, quick=True)[0]
    assert row["RMS before"] > 0.03 > 0.02 > row["RMS after"]
    assert "own error" in row
    assert "shell.thickness" in (tmp_path / "model_updating.txt").read_text()
    assert "the data determine" in capsys.readouterr().out


def test_differences_are_extrapolated_and_show_what_they_are_sure_to():
    """exp at 0 from coarse steps; with noise of 1e-4 in its values the uncertainty shows it."""
    found, doubt = extrapolated(lambda h: np.array([np.sinh(h) / h]), 0.5)
    assert abs(found[0] - 1.0) < doubt <= ENOUGH
    random = np.random.default_rng(1)
    found, doubt = extrapolated(lambda h: np.array([(np.sinh(h) + 1e-4 * random.standard_normal()) / h]), 0.5)
    assert 1e-5 < abs(found[0] - 1.0) < 10.0 * doubt


@pytest.mark.campaign
def test_derivatives_cost_and_the_blade(tmp_path):
    rows = checks.main(tmp_path, quick=True)
    exact = [row for row in rows if "simple modes" in row]
    assert len(exact) == 3
    assert all(row["simple modes"] < 1e-7 and row["mean and split"] < 1e-6 for row in exact)
    assert all(row["differences"] <= ENOUGH for row in exact)
    blade = [row for row in rows if "left out %" in row]
    assert all(1.5 < row["own error %"] < 2.5 for row in blade)  # a uniform blade is 2 % off, whichever number varies


@pytest.mark.campaign
def test_a_twin_of_its_own_family(tmp_path):
    rows = twin.main(tmp_path, quick=True)
    assert all(row["noise-free error"] < 1e-5 for row in rows)
    # the scatter of eight draws, by chi^2, 99.9 %
    assert all(0.29 < row["over the bound"] < 1.87 for row in rows)


@pytest.mark.campaign
def test_wrong_rows_of_tables_are_named(tmp_path):
    every = wrong_rows.main(tmp_path, quick=True)[-2]
    assert (every["wrong rows"], every["tables"], every["verdict"]) == ("1 to 3", 4, "pass")
