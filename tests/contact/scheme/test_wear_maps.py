"""Tracks of a coating: their bars from the law, the maps kept on the way, which tips share them."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.trig import fourier
from contact.scheme.modal.wear_track import Track, Tracks, rub_tracks, track_tips
from tests.contact.synthetic_rub import nodes, rim3, tips

COAT = {"E": 8e8, "yield_stress": 2e4, "hardening": 1e6, "thickness": 2e-3, "width": 0.03, "tip": 0.05}
RADIUS = 0.4
SHAPE = fourier([(0, 4e-4, 0.0), (2, 1e-4, -3e-4)])


def track(memory=None, tips=(0,), **more):
    memory = np.zeros((1, 3)) if memory is None else memory
    return Track.of(ct.Abradable(**COAT | more), RADIUS, SHAPE, tips, memory)


def test_bars_have_their_share_of_the_rim_and_the_numbers_of_the_law():
    one = track(bars=3, machined=5e-4)
    cells = round(2.0 * math.pi * 0.4 * 3 / 0.05)
    area = 0.03 * 2.0 * math.pi * 0.4 / cells
    phi = (np.arange(cells) + 0.5) * 2.0 * math.pi / cells
    radial = 1e-4 * np.cos(2.0 * phi) - 3e-4 * np.sin(2.0 * phi)
    np.testing.assert_allclose(one.made, radial, atol=1e-17)
    c = one.coating
    assert c.worn.tolist() == [0.0] * cells
    found = (one.area, c.mean, c.thickness, c.stiffness, c.yield_force, c.hardening, c.under)
    assert found == pytest.approx((area, 4e-4, 2e-3, 8e8 * area / 2e-3, 2e4 * area, 1e6 * area / 2e-3, 3), rel=1e-12)
    assert c.round == pytest.approx(radial.min() + 5e-4, rel=1e-12)
    assert track().coating.round == -math.inf


def test_a_tip_takes_at_most_a_quarter_of_the_rim_and_a_track_a_million_bars():
    quarter = 0.5 * math.pi * 0.4
    assert track(tip=quarter, bars=2).coating.worn.size == 8
    with pytest.raises(ct.InputError, match=r"found 0.628947 m, expected at most a quarter of the rim of 0.4 m"):
        track(tip=1.001 * quarter)
    around = 2.0 * math.pi * 0.4
    with pytest.raises(ct.InputError, match=r"with 10000 bars under it, 1.01e\+06 bars around .*at most 1000000"):
        track(tip=around / 101.0, bars=10_000)


def test_what_a_track_lost_is_volume_energy_and_bars_worn_to_the_casing():
    memory = np.array([[1.0, 10.0, 0.0], [2.0, 20.0, 0.0], [4.0, 40.0, 0.0]])
    one = track(memory, tips=(0, 2), bars=1, machined=5e-4)
    worn = one.coating.worn
    cut = np.maximum(one.coating.round - one.made, 0.0)
    worn[:3] = 1e-4, 2e-3 - cut[1], 2e-3
    found = one.wear(np.array([0.5, 0.7]), np.array([2.0 * worn, worn]))
    assert (found.dissipated, one.memorised(1), found.bare, found.tips) == (5.0, 50.0, 2, (0, 2))
    assert found.volume == pytest.approx(one.area * worn.sum(), rel=1e-13)
    assert found.stated == pytest.approx(one.area * np.sum(worn * (2e4 + 1e6 * 0.5 * worn / 2e-3)), rel=1e-12)
    np.testing.assert_allclose(found.cut, cut, rtol=1e-13)
    assert 0.0 < cut.max() <= 5e-4 * (1.0 + 1e-12)
    assert (found.map_time.tolist(), found.map.tolist()) == ([0.5, 0.7], [(2.0 * worn).tolist(), worn.tolist()])
    none = np.zeros(0), np.zeros((0, worn.size))
    assert one.wear(*none).map.shape == (0, worn.size)
    assert not track().wear(*none).cut.any()


def test_maps_are_kept_every_hundred_steps_and_every_second_is_dropped_beyond_four_hundred():
    tracks, calls = Tracks(tracks=(track(),)), []

    def times():
        return tracks.wear()[0].map_time.tolist()

    def loop(first, steps):
        calls.append((first, steps))
        tracks.tracks[0].coating.worn[:] += steps
        return -1

    assert tracks.watch(0.5, 0, 250, loop) == -1
    assert calls == [(0, 100), (100, 100), (200, 50)]
    assert tracks.watch(0.5, 250, 120, loop) == -1
    assert calls[3:] == [(250, 50), (300, 70)]
    assert times() == [50.0, 100.0, 150.0]
    assert tracks.wear()[0].map[:, 0].tolist() == [100.0, 200.0, 300.0]
    assert tracks.watch(0.5, 370, 40_000 - 370, loop) == -1
    assert (len(times()), times()[-1]) == (400, 20_000.0)
    assert tracks.watch(0.5, 40_000, 100, loop) == -1
    assert (len(times()), times()[:2]) == (200, [100.0, 200.0])
    assert tracks.watch(0.5, 40_100, 300, loop) == -1
    assert times()[-1] == 20_200.0


def test_a_step_that_fails_ends_the_watch_and_no_steps_are_passed_on():
    tracks = Tracks(tracks=(track(),))
    assert tracks.watch(0.5, 0, 250, lambda first, steps: 117 if first == 100 else -1) == 117
    assert tracks.wear()[0].map_time.tolist() == [50.0]
    assert tracks.watch(0.5, 7, 0, lambda first, steps: 10 * first + steps) == 70


def rub(places):
    return ct.Rub(rim3(), (nodes(2), nodes(2, seed=6)), places, clearance=1e-4, speed=ct.Speed.constant(1.0))


def test_tips_wear_the_track_they_name_or_that_of_their_place_on_the_line():
    first, second = (replace(tip, line=0) for tip in tips(2, angle=10.0))
    third, fourth = (replace(tip, line=0) for tip in tips(2, blade=1, angle=190.0))
    other = replace(third, line=1, angle_deg=100.0)
    assert track_tips(rub([first, second, third, fourth, other]), 0.05) == [[0, 2], [1, 3], [4]]
    named = [replace(first, track=3), second, replace(third, track=3), fourth]
    assert track_tips(rub(named), 0.05) == [[0, 2], [1, 3]]


def test_tips_of_one_track_stand_a_tip_apart_also_across_zero_degrees():
    first, second = (replace(tip, line=0, track=0) for tip in tips(2))
    first, second = replace(first, angle_deg=355.0), replace(second, angle_deg=365.0)
    apart = 0.4 * math.radians(10.0)
    assert track_tips(rub([first, second]), apart) == [[0, 1]]
    words = r"tips\[1\].track: found 0.0698 m to tips\[0\] on one track 0, expected at least the tip's length of 0.0699"
    with pytest.raises(ct.InputError, match=words):
        track_tips(rub([first, second]), 0.0699)
    assert track_tips(rub([first]), 0.4 * 2.0 * math.pi) == [[0]]


def test_coats_of_all_tracks_are_one_array_with_their_own_numbers():
    places = [*tips(2, angle=10.0), *tips(2, blade=1, angle=190.0)]
    law = ct.Abradable(**COAT, bars=2, machined=5e-4)
    tracks, coats = rub_tracks(replace(rub(places), profile=ct.RimProfile.fourier([{"p": 2, "cos": 1e-4}])), law)
    cells = round(2.0 * math.pi * 0.4 * 2 / 0.05)
    assert coats.start.tolist() == [0, cells, 2 * cells]
    assert coats.track.tolist() == [0, 1, 0, 1]
    assert [one.tips for one in tracks.tracks] == [(0, 2), (1, 3)]
    phi = (np.arange(cells) + 0.5) * 2.0 * math.pi / cells
    np.testing.assert_allclose(tracks.tracks[1].made, 1e-4 * np.cos(2.0 * phi), atol=1e-16)
    coats.worn[cells] = 7.0
    assert tracks.tracks[1].coating.worn[0] == 7.0
    area = 0.03 * 2.0 * math.pi * 0.4 / cells
    np.testing.assert_allclose(coats.stiffness, [8e8 * area / 2e-3] * 2, rtol=1e-12)
    np.testing.assert_allclose(coats.yield_force, [2e4 * area] * 2, rtol=1e-12)
    np.testing.assert_allclose(coats.hardening, [1e6 * area / 2e-3] * 2, rtol=1e-12)
    np.testing.assert_allclose(coats.round, [min(tracks.tracks[0].made) + 5e-4] * 2, rtol=1e-12)
    assert (coats.thickness, coats.under, coats.memory.shape) == (2e-3, 2, (4, 3))
    coats.memory[:, 1] = 1.0, 2.0, 4.0, 8.0
    assert tracks.elastic == 15.0
