"""The rub's own report: bases, speed, and the energy identity, small."""

import pandas as pd
import pytest

from reports.verification.rubs import checks


@pytest.mark.campaign
def test_a_small_basis_with_its_residual_is_enough_and_the_energy_closes(tmp_path, capsys):
    rows = checks.main(tmp_path, quick=True)
    bases = pd.read_csv(tmp_path / "rub_bases.csv").set_index("basis")
    small, bare = bases.loc["n <= 20, 1 order, S"], bases.loc["n <= 20, 1 order, no S"]
    assert small["modes"] < 48
    assert small["impulse error"] < 1e-3
    assert small["blade error"] < 0.03
    assert small["rim n = 10 error"] < 0.03 < small["the same without R lam"]
    assert bare["impulse error"] > 1.0
    energy = pd.read_csv(tmp_path / "rub_energy.csv")
    assert energy["unaccounted"].abs().max() < 1e-12
    for _, part in energy.groupby("law"):
        left = part.sort_values("dt [s]")["left of the work into the bodies"].to_numpy()
        assert left[0] < 0.6 * left[1] < 0.36 * left[2]
    assert energy[energy["dt/default"] == 1.0].set_index("law").loc["auto", "left of all fed in"] < 1e-4
    speed = pd.read_csv(tmp_path / "rub_speed.csv")
    assert speed["time in contact"].min() > 0.05
    assert (speed["us per step"] < 1e3).all()
    assert len(rows) == len(bases) + len(energy) + len(speed)
    assert "16 tip nodes" in capsys.readouterr().out
