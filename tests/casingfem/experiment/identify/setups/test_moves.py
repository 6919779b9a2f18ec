"""Starts that are tried for a cluster, and when they count."""

import numpy as np

from casingfem.experiment.identify.setups.cluster_modes import (
    _better,
    _one_fewer,
    _one_more,
    _together,
    fit_again,
    improved,
)
from casingfem.experiment.identify.setups.own_shifts import Modes, squares_at
from tests.casingfem.experiment.identify.setups.test_cluster_numbers import SETUPS, cluster, peaks


def test_a_move_counts_where_the_criterion_falls_by_more_than_one():
    c = cluster(sigma=1.0)
    old = peaks([[100.0, 100.2]], [[0.004] * 2], squares=50.0, on_peaks=2.0)
    for fall, better in ((1.01, True), (0.99, False)):
        new = old._replace(squares=50.0 - 2.0 * fall, on_peaks=3.0)
        assert _better(c, SETUPS, new, old) is better  # by the smaller noise, of two
    fewer = peaks([[100.0, 100.2], [102.0, 102.0]], [[0.004] * 2] * 2, squares=50.0, on_peaks=2.0)
    assert _better(c, SETUPS, old, fewer)


def test_one_set_up_is_put_to_the_mean_of_the_others_where_that_is_a_tenth_of_a_bandwidth_away():
    setups = [np.array([k]) for k in range(3)]
    own = peaks([[100.0, 100.0, 100.0], [110.0, 110.0, 110.3]], [[0.01] * 3] * 2)
    starts = list(_together(cluster(), setups, own))
    assert [freq.tolist() for freq, _ in starts] == [[[100.0] * 3, [110.0] * 3]]  # 0.3 of 2.2; others move 0.15
    np.testing.assert_array_equal(starts[0][1], [0.01, 0.01])
    assert list(_together(cluster(), [np.arange(5)], peaks([[100.0]], [[0.01]]))) == []


def test_a_mode_that_takes_little_is_tried_to_be_left_out():
    c = cluster(sigma=1.0)
    own = fit_again(c, SETUPS, c.modes.freq, c.modes.zeta)
    assert list(_one_fewer(c, SETUPS, own)) == []  # both take much
    ((freq, zeta),) = _one_fewer(c, SETUPS, own._replace(on_peaks=1e9))
    left = [squares_at(c.window, SETUPS, own.freq[[1 - k]], own.zeta[[1 - k], 0]) for k in range(2)]
    k = int(np.argmin(left))
    np.testing.assert_array_equal(freq, own.freq[[1 - k]])
    np.testing.assert_array_equal(zeta, own.zeta[[1 - k], 0])
    price = 13 * np.log(c.window.Y.size)
    for share, tried in ((1.01, 1), (0.99, 0)):
        squares = left[k] - 3.0 * price / share * 2.0
        assert len(list(_one_fewer(c, SETUPS, own._replace(squares=squares, on_peaks=2.0)))) == tried
    assert list(_one_fewer(c, SETUPS, peaks([[100.0] * 2], [[0.01] * 2]))) == []
    many = peaks([[100.0] * 2] * 14, [[0.01] * 2] * 14)
    assert list(_one_more(c, SETUPS, many)) == []
    assert list(_one_more(c, SETUPS, own)) == []


def test_where_every_channel_is_a_set_up_nothing_is_looked_for():
    c, single = cluster(), [np.array([k]) for k in range(5)]
    freq = np.repeat(c.modes.freq[:1].mean(axis=1, keepdims=True), 5, axis=1)
    few = c._replace(modes=Modes(freq, c.modes.zeta[:1], c.modes.residues[:1]))
    np.testing.assert_array_equal(
        improved(single, 0.05, few).own.freq, fit_again(few, single, freq, c.modes.zeta[:1]).freq
    )
