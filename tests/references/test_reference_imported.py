"""Imported meshes: the report runs small, formats agree, references are met, thin bricks lock where it says."""

import pandas as pd
import pytest

from reports.verification import imported as verify_imported
from reports.verification.modes import calculix, imported

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # locking is what it shows


@pytest.mark.campaign
def test_report_on_imported_meshes(tmp_path, capsys):
    imported.main(tmp_path, quick=True)
    formats = pd.read_csv(tmp_path / "imported_formats.csv")
    assert len(formats) == 5
    assert formats["largest change of 20 frequencies"].max() < 1e-11
    solids = pd.read_csv(tmp_path / "imported_solids.csv")
    assert solids["worst error"].max() < 0.035
    assert solids["worst error"][0] < 1e-3
    shells = pd.read_csv(tmp_path / "imported_shells.csv").set_index("cells")
    assert shells.loc["quad9", "worst error"] < 0.013
    assert abs(shells.loc["quad8", "worst error"] / shells.loc["quad9", "worst error"] - 1) < 1e-3
    assert shells["gap in perfect pairs"].max() < 1e-10
    locking = pd.read_csv(tmp_path / "imported_locking.csv").set_index("R/t")
    assert locking.loc[100, "hexahedron27: error"] > 0.04 > 20 * 0.75 * locking.loc[30, "quad9 shell: error"]
    blades = pd.read_csv(tmp_path / "imported_calculix.csv")
    assert blades["worst error"].max() < 1e-6
    rubs = pd.read_csv(tmp_path / "imported_rubs.csv")
    assert rubs[["first release: change", "second contact: change"]].abs().to_numpy().max() < 0.01
    assert rubs["impulse: change"].abs().max() < 0.02
    assert "One part in five formats" in capsys.readouterr().out


@pytest.mark.slow
def test_a_twisted_blade_is_that_of_calculix_at_rest_and_at_speed():
    """The same cells: seven digits are printed; about the nonlinear steady state at 10,000 rpm."""
    rows = calculix.compared(quick=True)
    assert [row["quantity"] for row in rows] == [*(f"freq_hz at {rpm} rpm" for rpm in calculix.RPM), "compliance"]
    assert max(float(row["worst error"]) for row in rows) < 1e-6


@pytest.mark.campaign
def test_all_rows_pass_or_state_why_not():
    verdicts = [row["verdict"] for row in verify_imported.slow_rows()]
    assert len(verdicts) == 6
    assert "FAIL" not in verdicts
