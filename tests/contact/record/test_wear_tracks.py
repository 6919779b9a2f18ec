"""Tracks of a coating joined to one."""

import numpy as np
import pytest

from contact.record.wear import WEAR_ARRAYS, WEAR_NUMBERS, Wear, joined


def track(bars, start, tips):
    """A track whose numbers all differ from those of another start."""
    cells = start + np.arange(bars, dtype=float)
    return Wear(
        angle=cells, made=10.0 * cells, cut=20.0 * cells, worn=30.0 * cells, map_time=np.array([0.0, 1.0]),
        map=np.stack([40.0 * cells, 50.0 * cells]), volume=start + 0.1, stated=start + 0.2, dissipated=start + 0.3,
        bare=int(start), tips=tips,
    )  # fmt: skip


def test_joined_tracks_keep_every_bar_and_sum_what_they_lost():
    one, two = track(3, 2.0, (2, 0)), track(2, 7.0, (1,))
    both = joined([one, two])
    assert both.tips == (0, 1, 2)
    for name in set(WEAR_ARRAYS) - {"map_time"}:
        first, second, whole = (getattr(wear, name) for wear in (one, two, both))
        assert whole.shape == (*first.shape[:-1], 5)
        np.testing.assert_array_equal(whole[..., :3], first)
        np.testing.assert_array_equal(whole[..., 3:], second)
    np.testing.assert_array_equal(both.map_time, one.map_time)
    for name in WEAR_NUMBERS:
        assert getattr(both, name) == pytest.approx(getattr(one, name) + getattr(two, name))


def test_one_track_is_itself_and_no_track_is_none():
    only = track(3, 2.0, (0,))
    assert joined([only]) is only
    assert joined([]) is None
