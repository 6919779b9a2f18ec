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


def test_a_track_in_words_and_numbers():
    """Depth in micrometres, volume in mm^3, contacts from 1; the radius before and after, missing energy."""
    wear = Wear(
        angle=np.zeros(3), made=np.array([1e-5, 2e-5, 3e-5]), cut=np.array([1e-4, 0.0, 2e-4]),
        worn=np.array([5e-6, 4.5e-5, 0.0]), map_time=np.zeros(1), map=np.zeros((1, 3)), volume=2.5e-9, stated=0.5,
        dissipated=0.5005, bare=1, tips=(1, 4),
    )  # fmt: skip
    assert wear.before == pytest.approx([1.1e-4, 2e-5, 2.3e-4], rel=1e-12)
    assert wear.after == pytest.approx([1.15e-4, 6.5e-5, 2.3e-4], rel=1e-12)
    assert repr(wear) == (
        "worn 2.5 mm^3, at most 45 um, 1 of 3 bars to the casing; 0.5005 J dissipated, residual 1.0e-03"
    )
    assert wear.to_dict() == {
        "contacts": [2, 5], "volume_m3": 2.5e-9, "deepest_m": 4.5e-5, "dissipated_J": 0.5005, "stated_J": 0.5,
        "bare_bars": 1, "bars": 3,
    }  # fmt: skip
    assert {name: column.tolist() for name, column in wear.columns().items()} == {
        "angle_rad": [0.0] * 3, "made_m": wear.made.tolist(), "cut_m": wear.cut.tolist(), "worn_m": wear.worn.tolist(),
    }  # fmt: skip
