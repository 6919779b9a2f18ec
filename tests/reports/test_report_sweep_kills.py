"""A sweep on a local Dask cluster whose workers and driver are killed; scenes that diverge, or are mistyped."""

import pytest

from reports.robustness import diverging, sweep_kills


@pytest.mark.campaign
def test_a_sweep_under_kill_9_loses_nothing(tmp_path):
    pytest.importorskip("distributed")
    (row,) = sweep_kills.main(tmp_path, quick=True)
    assert (row["workers killed"], row["drivers killed"], row["failed"]) == (2, 1, 0)
    assert row["finished before the table was asked for"] == 200
    assert row["unreadable files"] == 0
    assert row["table identical"]
    assert row["identical after damage"]


@pytest.mark.slow
def test_scenes_that_diverge_are_stopped_and_mistyped_ones_refused(tmp_path):
    rows = diverging.main(tmp_path, quick=True)
    verdicts = {row["verdict"] for row in rows}
    assert {"stopped", "refused"} <= verdicts <= {"stopped", "refused", "flagged", "swept"}
    assert len(diverging.cases()) == 40
