"""The reports on pairing and on the search for loose bolts, run small."""

import pandas as pd
import pytest

from reports.verification.updating import loose_bolt_search, pairing


@pytest.mark.slow
def test_rotated_doublets_are_paired_by_planes_not_by_shapes(tmp_path):
    rows = pairing.main(tmp_path, quick=True)
    assert rows[0]["draws right %"] == 100.0
    assert rows[0]["worst subspace MAC"] > 0.98
    assert rows[0]["worst plain MAC"] < 0.1
    assert len(pd.read_csv(tmp_path / "pairing.csv")) == len(rows)


@pytest.mark.campaign
def test_loose_bolts_are_searched_on_another_mesh(tmp_path):
    rows = loose_bolt_search.main(tmp_path, quick=True)
    assert rows[0]["pair found %"] == 100.0
    assert rows[0]["alarms when tight %"] == 0.0
    checked = pd.read_csv(tmp_path / "loose_bolts_reduced.csv")
    assert checked["worst error"].max() < 1e-4
    alike = pd.read_csv(tmp_path / "loose_bolts_alike.csv")
    assert alike["groups"].tolist() == [2, 3, 6, 12, 12, 12]
