"""The reports on identification: two casings with forty modes each, two tests with everything that goes wrong."""

import numpy as np
import pytest

from reports.verification.updating import identification, unkind


@pytest.mark.campaign
def test_every_pair_half_a_bandwidth_apart_is_found_and_nothing_else(tmp_path, capsys):
    rows = identification.main(tmp_path, quick=True)
    for row in rows:
        assert row["modes"] == 40
        assert row["clear found"] == row["clear"] > 10
        assert row["missed"] <= 1  # one of a pair 0.08 bandwidths apart, with one reference
        assert row["spurious"] == 0
        assert row["freq error %"] < 0.02
        assert row["angle error deg"] < 0.5
    assert (tmp_path / "identification.csv").exists()
    assert "By split" in capsys.readouterr().out


@pytest.mark.campaign
def test_tests_unlike_a_bench_have_few_spurious_modes_among_the_sure(tmp_path, capsys):
    rows = unkind.main(tmp_path, quick=True)
    assert len(rows) == 2
    for row in rows:
        assert row["modes"] >= 28
        assert row["modes sure"] >= 0.95 * row["modes"]
        assert row["spurious"] == row["twice"] == 0
    assert (tmp_path / "unkind_modes.csv").exists()
    assert "In one line" in capsys.readouterr().out


@pytest.mark.campaign
def test_shifts_that_one_crowded_cluster_hides_are_found_and_no_mode_is_counted_twice(tmp_path, monkeypatch):
    monkeypatch.setattr(unkind, "SEEDS", [710])
    monkeypatch.setattr(unkind, "duration", lambda channels: {"channels": channels})
    (row,) = unkind.main(tmp_path)
    assert row["twice"] == row["spurious"] == 0
    assert row["modes sure"] >= 27


def test_sure_modes_are_judged_by_the_true_ones_next_to_them():
    """A doubtful mode at the first, a sure one a little farther from it, both nearer to it than the second."""
    gap = np.array([[0.02, 0.03], [0.43, 0.38]])
    assert unkind.matched(gap, np.array([False, True])) == {0: 1, 1: 0}
    assert unkind.matched(gap, np.array([False, False])) == {0: 0, 1: 1}
    assert unkind.matched(gap + 0.65, np.array([True, False])) == {0: 0}  # beyond 1 no mode is another
