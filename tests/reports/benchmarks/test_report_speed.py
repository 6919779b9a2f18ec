"""Reports on speed run small: their tables are whole, no time is asserted: it is the machine's."""

import numpy as np
import pandas as pd
import pytest

from reports.benchmarks import beside_calculix, growth, imports, tips_beside
from reports.benchmarks import steps as speed
from reports.benchmarks import sweeps as sweep_speed
from reports.benchmarks import tips as tip_speed


@pytest.mark.campaign
def test_speed_gives_ratios_and_steps(tmp_path):
    rows = speed.main(tmp_path, quick=True)
    steps = pd.read_csv(tmp_path / "speed.csv").set_index("step")
    assert steps.loc["assemble, 10880 dofs", "over assembly"] == 1.0
    assert {"40 modes", "40 modes, perfect casing by harmonics"} <= set(steps.index)
    assert np.all(steps["seconds"] > 0.0)
    runs = pd.read_csv(tmp_path / "speed_contact.csv")
    assert np.all(runs["us/step"] > 0.0)
    assert len(rows) == len(steps) + len(runs)


@pytest.mark.campaign
def test_speed_tables_are_whole_and_skipping_changes_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep_speed, "RUNS", 8)
    rows = sweep_speed.main(tmp_path, quick=True)
    names = ("us/step alone", "tips", "speed-up alone", "cores")
    speeds, several, flights, swept = ([row for row in rows if name in row] for name in names)
    assert all(row["% of peak flops"] > 0.0 for row in (*speeds, *several))
    assert len(several) == 9
    assert speeds[-1]["terms of the rows"] > 1.5 * speeds[0]["terms of the rows"]
    assert max(row["state differs by"] for row in flights) <= 1e-12
    assert flights[-1]["contact fraction"] < 0.1 < flights[0]["contact fraction"]
    assert [row["failed"] for row in swept] == [0, 0]


@pytest.mark.campaign
def test_steps_of_one_tip_and_of_several_are_timed(tmp_path):
    rows = tip_speed.main(tmp_path, quick=True)
    assert [(row["tips"], row["case"]) for row in rows] == [(n, case) for n in (1, 4) for case, _, _ in tip_speed.CASES]
    for row in rows:
        assert (row["closed"] > 0.0) == (row["case"] != "free")
        assert row["us/step"] > 0.0


@pytest.mark.campaign
def test_tips_touch_alike_in_two_checkouts(tmp_path):
    for row in tips_beside.main(tmp_path, quick=True):
        assert (row["closed"] > 0.0) == (row["case"] != "free")
        assert row["impulse differs by"] <= 1e-9
        assert min(row["other us/step"], row["us/step"], row["ratio"]) > 0.0


@pytest.mark.slow
def test_a_mesh_file_becomes_a_basis(tmp_path):
    for row in imports.main(tmp_path, quick=True):
        assert row["ended"] == "done"
        assert row["basis MB"] > 0.02
        assert row["peak MB"] > 50.0


@pytest.mark.campaign
def test_calculix_is_beside_us_where_it_is_installed(tmp_path):
    other, coarse, default = beside_calculix.main(tmp_path, quick=True)
    assert coarse["worst error"] < 1e-3 > 3.0 * default["worst error"]
    if other["seconds"] is not None:  # a mesh far too coarse, but the same frustum
        assert default["worst error"] < other["worst error"] < 0.2


@pytest.mark.slow
def test_growth_shows_a_counted_solution_with_its_memory(tmp_path):
    (row,) = growth.main(tmp_path, quick=True)
    assert row["ended"] == "done"
    assert row["unknowns"] == 5 * 7 * 7 * 16
    assert row["counted"] == 40
    assert row["factor MB"] < row["peak MB"]
    assert 0.7 < row["leaf unknowns"] < row["leaf work"] < 1.0  # the interiors of elements
    assert min(row[name] for name in ("assemble s", "plan s", "factor s", "modes s", "GF/s", "of dgemm")) > 0.0
