"""Speed, closing and profile of a rub by hand: before the first point, between points, after the last."""

import math

import numpy as np
import pytest

import contact as ct

TURN = 2.0 * math.pi


def test_a_speed_that_changes_between_its_points():
    """3 turns/s to 2 s, then 4 turns/s^2 to 3 s, then -1 turn/s^2 to 5 s, then 5 turns/s."""
    speed = ct.Speed(time=[2.0, 3.0, 5.0], hz=[3.0, 7.0, 5.0])
    at = np.array([-1.0, 0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0, 6.5])
    turned = [-3.0, 0.0, 3.0, 6.0, 8.0, 11.0, 17.5, 23.0, 30.5]
    assert speed.angles(at) / TURN == pytest.approx(np.array(turned), rel=1e-12, abs=1e-12)
    assert [speed.angle(t) / TURN for t in at] == pytest.approx(turned, rel=1e-12, abs=1e-12)
    assert [speed.omega(t) / TURN for t in at] == pytest.approx([3, 3, 3, 3, 5, 7, 6, 5, 5], rel=1e-12)
    assert speed.fastest == pytest.approx(7.0 * TURN)
    table = speed.table
    assert table[:, 0].tolist() == [-1.0, 2.0, 3.0, 5.0]
    assert table[:, 1] / TURN == pytest.approx([-3.0, 6.0, 11.0, 23.0], rel=1e-12)
    assert table[:, 2] / TURN == pytest.approx([3.0, 3.0, 7.0, 5.0], rel=1e-12)
    assert table[:, 3] / TURN == pytest.approx([0.0, 4.0, -1.0, 0.0], rel=1e-12)


def test_a_speed_known_from_before_the_start():
    speed = ct.Speed(time=[-2.0, 1.0], hz=[-6.0, 3.0])
    assert speed.table[:, 0].tolist() == [-3.0, -2.0, 1.0]
    assert [speed.angle(t) / TURN for t in (-2.0, 0.0, 1.0, 2.0)] == pytest.approx([6.0, 0.0, 1.5, 4.5], abs=1e-12)
    assert speed.omega(-9.0) == pytest.approx(-6.0 * TURN)
    assert speed.fastest == pytest.approx(6.0 * TURN)
    assert ct.Speed.constant(4.0).angle(1.5) == pytest.approx(6.0 * TURN)
    assert ct.Speed.constant(4.0).table.shape == (2, 4)


def test_closings_are_straight_between_points_and_constant_outside():
    closing = ct.gaps.Closing(time=[1.0, 3.0], by=[1e-5, 5e-5])
    assert [closing.at(t) for t in (0.0, 1.0, 2.0, 3.0, 9.0)] == pytest.approx([1e-5, 1e-5, 3e-5, 5e-5, 5e-5])
    assert (ct.gaps.Closing.none().at(0.0), ct.gaps.Closing.none().at(5.0)) == (0.0, 0.0)


def test_an_exponential_closing_is_kept_within_a_ten_thousandth():
    closing = ct.gaps.Closing.exponential(2e-4, 0.5)
    assert (closing.time[0], closing.by[0]) == (0.0, 0.0)
    assert closing.time[-1] == pytest.approx(6.0, rel=1e-12)
    assert closing.by == pytest.approx(2e-4 * (1.0 - np.exp(-closing.time / 0.5)), rel=1e-12)
    at = np.linspace(0.0, 6.0, 999)
    off = np.abs([closing.at(t) for t in at] - 2e-4 * (1.0 - np.exp(-at / 0.5))).max()
    assert off < 1e-4 * 2e-4
    assert 780 <= closing.time.size <= 800  # 400 by share and 400 by time, the ends in common
    assert ct.gaps.Closing.exponential(2e-4, 0.5, points=20).time.size < 41
    for by in (math.nan, math.inf):
        with pytest.raises(ct.InputError, match="by: found"):
            ct.gaps.Closing.exponential(by, 0.5)


@pytest.mark.parametrize("name", ["per_rev", "hz", "phase_deg"])
def test_whirls_are_finite(name):
    whirl = ct.gaps.Whirl(amplitude=1e-4)
    assert (whirl.per_rev, whirl.hz, whirl.phase_deg) == (0.0, 0.0, 0.0)
    with pytest.raises(ct.InputError, match=f"{name}: found nan"):
        ct.gaps.Whirl(amplitude=1e-4, **{name: math.nan})


TERMS = [{"p": 0, "cos": 1e-5}, {"p": 2, "cos": 3e-5, "sin": -4e-5}, {"p": 3, "sin": 2e-5}]


def test_a_profile_of_terms():
    profile = ct.gaps.RimProfile.fourier(TERMS)
    assert profile.terms == ((0, 1e-5, 0.0), (2, 3e-5, -4e-5), (3, 0.0, 2e-5))
    at = 0.7
    expected = 1e-5 + 3e-5 * math.cos(1.4) - 4e-5 * math.sin(1.4) + 2e-5 * math.sin(2.1)
    assert profile(at) == pytest.approx(expected, rel=1e-12)
    assert profile.smooth(at) == pytest.approx(expected, rel=1e-12)
    assert profile.farthest == pytest.approx(1e-5 + 5e-5 + 2e-5)
    assert profile.lowest == pytest.approx(1e-5 - 5e-5 - 2e-5)
    assert ct.gaps.RimProfile()(1.0) == ct.gaps.RimProfile().farthest == ct.gaps.RimProfile().lowest == 0.0
    assert ct.gaps.RimProfile().table.shape == (0, 3)


def test_a_profile_by_a_table():
    """Slopes are weighted harmonic means of the chords (Fritsch & Butland), and zero at extremes."""
    theta, depth = [0.5, 1.0, 2.0, 4.0], [0.0, 2e-5, 3e-5, -1e-5]
    profile = ct.gaps.RimProfile(ct.gaps.RimProfile.fourier(TERMS[:1]).terms, theta, depth)
    chords = [2e-5 / 0.5, 1e-5 / 1.0]
    middle = (2 * 1.0 + 0.5 + 1.0 + 2 * 0.5) / ((2 * 1.0 + 0.5) / chords[0] + (1.0 + 2 * 0.5) / chords[1])
    last = TURN + 0.5 - 4.0
    rise = 1e-5 / last
    first = (2 * 0.5 + last + 0.5 + 2 * last) / ((2 * 0.5 + last) / rise + (0.5 + 2 * last) / chords[0])
    assert profile.table[:, 0] == pytest.approx([*theta, TURN + 0.5])
    assert profile.table[:, 1].tolist() == [*depth, 0.0]
    assert profile.table[:, 2] == pytest.approx([first, middle, 0.0, 0.0, first], rel=1e-12)
    s = 0.25  # of the way from 1.0 to 2.0
    h00, h10 = 2 * s**3 - 3 * s**2 + 1, s**3 - 2 * s**2 + s
    between = 1e-5 + h00 * 2e-5 + h10 * middle + (1.0 - h00) * 3e-5
    for turns in (-2, 0, 1):
        assert profile(1.25 + turns * TURN) == pytest.approx(between, rel=1e-9)
        assert profile(2.0 + turns * TURN) == pytest.approx(4e-5, rel=1e-9)
    s = (0.2 + TURN - 4.0) / last  # from the last point to the first a turn later
    h00, h11 = 2 * s**3 - 3 * s**2 + 1, s**3 - s**2
    assert profile(0.2) == pytest.approx(1e-5 - h00 * 1e-5 + last * h11 * first, rel=1e-9)
    assert profile.farthest == pytest.approx(1e-5 + 3e-5)
    assert profile.lowest == pytest.approx(1e-5 - 1e-5)


def test_forces_on_bodies_as_numbers_of_the_loop():
    plain = ct.gaps.BodyForce(
        acceleration=3.0, radius=2e-3, axial=0.5, per_rev=0.25, hz=4.0, phase_deg=90.0, casing_turns=True
    )  # fmt: skip
    assert plain.row == pytest.approx((3.0, 2e-3, 0.25, 1.25, 8.0 * math.pi, math.pi / 2.0, 1.0, 1.0))
    assert ct.gaps.BodyForce(on="casing").row == (0.0,) * 6 + (1.0, 0.0)
    assert ct.gaps.BodyForce(on="blades", casing_turns=True).row == (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    weight = ct.gaps.BodyForce.gravity(turning="casing")
    assert (weight.acceleration, weight.phase_deg, weight.axial, weight.per_rev) == (9.80665, -90.0, 0.0, -1.0)
    assert weight.on == "both"
    assert weight.casing_turns
    still = ct.gaps.BodyForce.gravity(acceleration=2.0, down_deg=5.0, axial=-1.0)
    assert (still.acceleration, still.phase_deg, still.axial, still.per_rev) == (2.0, 5.0, -1.0, 0.0)
    assert not still.casing_turns
    whirl = ct.gaps.Whirl(amplitude=2e-3, per_rev=0.5, hz=3.0, phase_deg=20.0)
    felt = ct.gaps.BodyForce.of_whirl(whirl, "casing")
    assert (felt.on, felt.radius, felt.per_rev, felt.hz, felt.phase_deg) == ("casing", 2e-3, 0.5, 3.0, 20.0)
    assert (felt.acceleration, felt.axial, felt.casing_turns) == (0.0, 0.0, False)
    assert ct.gaps.BodyForce.of_whirl(whirl, "blades", turning="casing").casing_turns


@pytest.mark.parametrize("name", ["acceleration", "radius", "axial", "per_rev", "hz", "phase_deg"])
def test_forces_on_bodies_are_finite(name):
    with pytest.raises(ct.InputError, match=f"{name}: found inf"):
        ct.gaps.BodyForce(**{name: math.inf})
