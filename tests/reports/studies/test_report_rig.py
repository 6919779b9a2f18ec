"""The virtual test rig runs from bench to prediction; the rows of the verification pass."""

import pandas as pd
import pytest

import casingfem as cf
from reports.studies.rig import measure


@pytest.mark.campaign
def test_the_chain_from_records_to_predictions(tmp_path, capsys):
    found = measure.main(tmp_path, quick=True)
    casing = found["casing"]
    assert casing["found"] == casing["modes in band"] >= 20
    assert casing["spurious"] == casing["wrong n"] == 0
    assert casing["largest error %"] < 1e-3
    assert casing["largest angle error deg"] < 0.1
    assert found["records"]["worst %"] < 1.0
    assert found["scan 40 dB"]["angle rms deg"] < 0.02
    assert found["scan 0 dB"]["angle rms deg"] < 1.0
    prediction = found["elastic edge"]
    assert prediction["predicted"] == prediction["unseen"] >= 10
    assert prediction["after sigma rms"] < 0.25 * prediction["before sigma rms"]
    assert capsys.readouterr().out.startswith("SYNTHETIC")
    table = cf.FrequencyTable.from_csv(tmp_path / "rig_measure_casing.csv")
    assert table.card[0].startswith("SYNTHETIC")
    assert cf.frf.FrfSet.from_uff(tmp_path / "rig_measure_casing.uff").card[0].startswith("SYNTHETIC")
    assert len(pd.read_csv(tmp_path / "rig_measure.csv")) == prediction["predicted"]
    for name in ("responses", "scan", "deflections"):
        assert (tmp_path / f"rig_measure_{name}.png").stat().st_size > 10_000
