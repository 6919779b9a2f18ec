"""The report on identification: two casings with forty modes each."""

import pytest

from reports.updating import identification


@pytest.mark.campaign
def test_every_pair_half_a_bandwidth_apart_is_found_and_nothing_else(tmp_path, capsys):
    rows = identification.main(tmp_path, quick=True)
    for row in rows:
        assert row["modes"] == 40
        assert row["clear found"] == row["clear"] > 10
        assert row["missed"] == row["spurious"] == 0
        assert row["freq error %"] < 5e-3
        assert row["angle error deg"] < 0.5
    assert (tmp_path / "identification.csv").exists()
    assert "By split" in capsys.readouterr().out
