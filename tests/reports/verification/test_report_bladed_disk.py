"""Bladed disks and what a rub converges with, small."""

import pandas as pd
import pytest

from reports.verification.rubs import bladed_disk
from reports.verification.rubs import convergence as rub_convergence


@pytest.mark.campaign
def test_the_unstable_speed_is_where_the_condition_states(tmp_path, capsys):
    rows = bladed_disk.main(tmp_path, quick=True)
    assert abs(rows[0]["off [%]"]) < 1.0
    assert abs(rows[0]["off poles [%]"]) < 0.01
    assert rows[0]["run [1/s]"] == pytest.approx(rows[0]["poles [1/s]"], rel=0.01)
    blades = pd.read_csv(tmp_path / "bladed_disk_24.csv")
    assert blades["off [%]"].abs().max() < 1.0
    assert blades["run [1/s]"].to_numpy() == pytest.approx(blades["poles [1/s]"].to_numpy(), rel=0.05)
    assert (tmp_path / "bladed_disk.png").stat().st_size > 5_000


@pytest.mark.campaign
def test_errors_of_a_rub_fall_with_each_refinement(tmp_path, capsys):
    tables = rub_convergence.main(tmp_path, quick=True)
    modes, steps, surface = (tables[name] for name in ("modes", "steps", "surface"))
    assert modes[0]["impulse error"] < 2e-3
    assert modes[1]["tip error"] < modes[0]["tip error"] < 0.02
    assert steps[1]["order, tip"] > 1.8
    assert surface[1]["straight: tip error"] < 0.1 * surface[0]["straight: tip error"]
    assert surface[1]["cubic: impulse error"] < 1e-4
    assert tables["pieces"][0]["tip error"] < 1e-3
    assert len(pd.read_csv(tmp_path / "rub_convergence" / "surface.csv")) == len(surface)
