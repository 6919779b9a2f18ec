"""Orbits, branches and basins of a map known in closed form: x' = v - x^2 + b y, y' = x (Henon, 1976).

Fixed points x^2 + (1 - b) x = v with multipliers m^2 + 2 x m = b: a fold at v = -(1 - b)^2/4, a flip at 3 (1 - b)^2/4,
beyond which the two points of period 2 have the sum 1 - b and the product (1 - b)^2 - v.
"""

import math
from importlib import import_module

import numpy as np
import pytest

import contact as ct
from contact.cycles.branch import Tangent, begun, followed, merged
from contact.cycles.passage import Event
from contact.cycles.shooting import map_of, settled
from tests.contact.cycles.henon import FLIP, FOLD, B, course, fixed, followed_map


def test_an_orbit_from_a_guess_has_its_state_and_multipliers(family):
    found, x = ct.cycles.orbit(family, 0.2, guess=np.array([0.5, 0.0])), fixed(0.2)
    assert found.x == pytest.approx([x, x], rel=1e-12)
    assert np.sort(found.multipliers.real) == pytest.approx(np.sort(np.roots([1.0, 2.0 * x, -B])), rel=1e-7)
    assert found.M == pytest.approx(np.array([[-2.0 * x, B], [1.0, 0.0]]), rel=1e-7)
    assert (found.name, found.value, found.period, found.periods, found.start) == ("v", 0.2, 2.0, 1, 0.0)
    assert (found.gap.tolist(), found.force.tolist()) == ([1.0, 1.0], [0.0, 0.0])
    assert (found.closings, found.rests, found.touching, found.contacts) == ((0, 0), (0, 0), (), 0)
    assert found.amplitude == pytest.approx({"x": x, "y": x}, rel=1e-7)
    assert found.multiplier == pytest.approx(x + math.sqrt(x * x + B), rel=1e-7)
    assert found.stable
    assert set(family.asked) == {(0.0, 2.0)}
    at_once = ct.cycles.orbit(family, 0.2, guess=found.x)
    assert at_once.iterations == 1
    assert 4 <= found.iterations <= 6


def test_an_orbit_of_two_periods_and_its_state_elsewhere_in_the_period(family):
    found = ct.cycles.orbit(family, 0.5, guess=np.array([0.85, 0.0]), start=0.25, periods=2)
    root = math.sqrt((1.0 - B) ** 2 - 4.0 * ((1.0 - B) ** 2 - 0.5))
    assert np.sort(found.x) == pytest.approx([(1.0 - B - root) / 2.0, (1.0 - B + root) / 2.0], rel=1e-10)
    assert (found.period, found.periods, found.start) == (4.0, 2, 0.25)
    assert set(family.asked) == {(0.5, 4.0)}
    assert "v 0.5, closes after 2 periods: x 0.714" in repr(found)
    twice = found.twice()
    assert (twice.periods, twice.period) == (4, 8.0)
    assert twice.M == pytest.approx(found.M @ found.M)
    assert twice.multipliers == pytest.approx(found.multipliers**2)


def test_an_unstable_orbit_says_so(family):
    found = ct.cycles.orbit(family, 0.2, guess=np.array([-1.0, -1.0]))
    assert found.x == pytest.approx([fixed(0.2, -1.0)] * 2, rel=1e-12)
    assert not found.stable
    assert repr(found).endswith(f"; unstable, |multiplier| {found.multiplier:.6g}")
    assert "closes" not in repr(found)


def test_an_orbit_without_a_guess_is_where_a_run_settles(family):
    found = ct.cycles.orbit(family, 0.2)
    assert found.x == pytest.approx([fixed(0.2)] * 2, rel=1e-12)
    assert 20 < len(family.asked) < 150  # as long as it settles
    family.asked.clear()
    x, at = settled(family, 0.2, 3)
    assert (len(family.asked), at) == (3, 0.0)
    start = settled(family, 0.2, 0, x=np.array([3.0, 4.0]), at=0.25)
    assert (start[0].tolist(), start[1]) == ([3.0, 4.0], 0.25)
    for v in (0.2, 0.25):
        x, _ = settled(family, v, 400)
        assert x == pytest.approx([fixed(v)] * 2, rel=1e-7)
    with pytest.raises(ct.InputError, match="periods: found 0"):
        ct.cycles.orbit(family, 0.2, periods=0)
    with pytest.raises(ct.InputError, match="value: found nan"):
        ct.cycles.orbit(family, math.nan)


def test_a_run_that_does_not_settle_gives_the_state_nearest_to_itself(family):
    """Of period 2 in the end: it came nearest to the fixed point on its way."""
    x, apart, states = np.array([0.2, 0.2]), [], []
    for _ in range(30):
        after = np.array([0.5 - x[0] ** 2 + B * x[1], x[0]])
        apart.append(np.linalg.norm(after - x) / np.linalg.norm(after))
        states.append(after)
        x = after
    found, _ = settled(family, 0.5, 30, x=np.array([0.2, 0.2]))
    assert found == pytest.approx(states[int(np.argmin(apart))], rel=1e-14)


def test_events_count_by_contact(family, monkeypatch):
    def hits(*args, **more):
        found = followed_map(*args, **more)
        events = (Event(0.1, 1, True, True, 0.0), Event(0.2, 1, False, False, 0.0), Event(0.3, 0, True, False, 1.0),
                  Event(0.4, 0, True, False, 0.5), Event(0.5, 0, True, True, 0.0, True))  # fmt: skip
        found.events, found.first = events, (1,)
        return found

    monkeypatch.setattr(import_module("contact.cycles.shooting"), "passage", hits)
    found = ct.cycles.orbit(family, 0.2, guess=np.array([0.5, 0.0]))
    assert (found.closings, found.rests, found.touching, found.contacts) == ((3, 1), (1, 0), (1,), 2)
    assert (found.twice().closings, found.twice().rests) == ((6, 2), (2, 0))


def test_lengths_along_a_branch_count_the_state_by_its_size_and_the_value_by_its_range(family):
    along = course(family, -1.0, 3.0, 0.5)
    a, b = Tangent(np.array([1.0, 2.0]), 3.0), Tangent(np.array([4.0, -1.0]), 2.0)
    assert along.span == 4.0
    assert along.product(a, b, np.array([3.0, 4.0])) == pytest.approx(2.0 / 25.0 + 6.0 / 16.0, rel=1e-14)
    assert along.product(a, b, np.array([0.3, 0.0])) == pytest.approx(2.0 / 0.25 + 6.0 / 16.0, rel=1e-14)
    unit = along.unit(a, np.array([3.0, 4.0]))
    assert along.product(unit, unit, np.array([3.0, 4.0])) == pytest.approx(1.0, rel=1e-14)
    assert unit.x / unit.value == pytest.approx([1.0 / 3.0, 2.0 / 3.0])
    assert [along.difference(v) for v in (0.9, 1.1, -0.5, 0.001, 2.0)] == pytest.approx(
        [0.9e-7, -1.1e-7, 0.5e-7, 4e-10, -2e-7], rel=1e-12
    )


def test_the_direction_of_a_branch_is_its_derivative_by_the_value(family):
    at, along = ct.cycles.orbit(family, 0.2, guess=np.array([0.5, 0.0])), course(family, 0.15, 0.25)
    rate = 1.0 / math.sqrt((1.0 - B) ** 2 + 0.8)  # dx/dv
    assert along.slope(at) == pytest.approx([1.0, 0.0], abs=1e-7)
    for sense in (1.0, -1.0):
        found = along.tangent(at, Tangent(np.zeros(2), sense))
        assert found.x / found.value == pytest.approx([rate, rate], rel=1e-6)
        assert math.copysign(1.0, found.value) == sense
        assert along.product(found, found, at.x) == pytest.approx(1.0, rel=1e-12)
        new = along.next(at, found, 0.05)
        assert new.iterations <= 4
        assert new.x == pytest.approx([fixed(new.value)] * 2, rel=1e-10)
        apart = Tangent(new.x - at.x, new.value - at.value)
        assert along.product(apart, found, at.x) == pytest.approx(0.05, rel=1e-9)


def test_steps_grow_by_half_until_they_are_the_longest(family):
    """From three tenths of it."""
    along = course(family, 0.0, 0.6)
    way = begun(along, ct.cycles.orbit(family, 0.05, guess=np.array([0.1, 0.1])), Tangent(np.zeros(2), 1.0), 0.02)
    assert (way.length, len(way.points), way.specials) == (pytest.approx(0.006), 1, ())
    told = []
    found = followed(along, way, longest=0.02, most=9, progress=told.append)
    assert (len(found.points), found.end) == (9, "9 orbits")
    tangent, sizes = way.along, []
    for at, new in zip(found.points[:-1], found.points[1:], strict=True):
        sizes.append(along.product(Tangent(new.x - at.x, new.value - at.value), tangent, at.x))
        tangent = along.tangent(new, tangent)
    assert sizes == pytest.approx([0.006, 0.009, 0.0135] + [0.02] * 5, rel=1e-6)
    assert [len(now.points) for now in told] == list(range(2, 10))
    assert told[0].length == pytest.approx(0.009)
    again = followed(along, told[3], longest=0.02, most=9)
    assert [p.value for p in again.points] == [p.value for p in found.points]


def test_a_branch_is_followed_around_its_fold(family):
    found = ct.cycles.follow(family, (0.2, -0.3), longest=0.1)
    (branch,) = found.branches
    assert (branch.points[0].value, branch.points[-1].value, branch.end) == (0.2, pytest.approx(0.2, abs=1e-12), "")
    sign = np.where(np.arange(len(branch.points)) <= np.argmin(branch.value), 1.0, -1.0)
    for point, side in zip(branch.points, sign, strict=True):
        roots = [fixed(point.value, side), fixed(point.value, -side)]
        assert min(abs(point.x[0] - root) for root in roots) < 1e-8
    assert branch.points[-1].x == pytest.approx([fixed(0.2, -1.0)] * 2, rel=1e-9)
    assert [special.kind for special in branch.specials] == ["fold"]
    (fold,) = branch.of("fold")
    assert fold.orbit.value == pytest.approx(FOLD, abs=1e-8)
    assert fold.orbit.x == pytest.approx([-(1.0 - B) / 2.0] * 2, abs=1e-4)
    assert np.linalg.norm(fold.orbit.x - fold.before.x) < 2e-5
    assert [kept for kept, _, _ in branch.stretches] == [True, False]
    assert "fold at -0.1225" in repr(found)


def test_the_branch_of_doubled_period_leaves_at_the_flip(family):
    found = ct.cycles.follow(family, (0.2, 0.6), longest=0.05, doublings=1)
    one, two = found.branches
    (flip,) = one.of("flip")
    assert flip.orbit.value == pytest.approx(FLIP, abs=1e-5)
    assert (one.points[-1].value, two.points[-1].value) == (pytest.approx(0.6), pytest.approx(0.6))
    assert {point.periods for point in two.points} == {2}
    for point in two.points:
        assert point.x.sum() == pytest.approx(1.0 - B, abs=1e-7)
        assert point.x.prod() == pytest.approx((1.0 - B) ** 2 - point.value, abs=1e-7)
    assert two.stable.all()
    assert one.stable.tolist() == [point.value < FLIP for point in one.points]
    assert len(ct.cycles.follow(family, (0.2, 0.6), longest=0.05).branches) == 1


def test_a_branch_that_passes_the_one_of_half_its_period_has_joined_it(family):
    root = 0.2
    high, low = (
        ct.cycles.orbit(family, 0.45, guess=np.array([0.35 + s * root, 0.35 - s * root]), periods=2) for s in (1, -1)
    )
    assert merged(course(family), high, low)
    assert not merged(course(family), high, high)
    single = ct.cycles.orbit(family, 0.2, guess=np.array([0.5, 0.5]))
    assert not merged(course(family), single, single)
    half = map_of(family, 0.45, periods=1)(high.x)
    assert half.x == pytest.approx(low.x, rel=1e-6)


def test_basins_of_a_point_of_two_points_and_of_nothing(family):
    found = ct.cycles.basins(family, 0.5, np.array([1.2, -0.8]), starts=12, seed=3, settle=200)
    draws = np.random.default_rng(3).standard_normal((12, 2)) * [1.2, 0.8]
    np.testing.assert_allclose(found.starts, draws, rtol=1e-14)
    (two,) = found.attractors
    assert two.periods == 2
    assert np.sort(two.states[0]) == pytest.approx(np.sort(two.states[1]), rel=1e-6)
    assert two.amplitude == pytest.approx({"x": two.states.max(), "y": two.states.max()}, rel=1e-6)
    kept = []
    for x in draws:
        for _ in range(200):
            x = np.array([0.5 - x[0] ** 2 + B * x[1], x[0]]) if abs(x[0]) < 1e3 else x
        kept.append(0 if abs(x[0]) < 1e3 else -1)
    assert found.reached == tuple(kept)
    assert 0 < kept.count(-1) < 12
    assert two.share == pytest.approx(kept.count(0) / 12)
    assert repr(found).splitlines() == [
        "12 starts at v 0.5",
        "share [%]  periods  amplitude x [m]  amplitude y [m]",
        f"{100.0 * two.share:9.1f}  {2:7d}  {two.amplitude['x']:15.6g}  {two.amplitude['y']:15.6g}",
        f"{kept.count(-1) / 12:.1%} of the starts: not periodic",
    ]  # fmt: skip
    assert found.records()[0]["periods"] == 2
    short = ct.cycles.basins(family, 0.5, np.array([0.1, 0.1]), starts=2, seed=3, settle=200, longest=1)
    assert short.reached == (-1, -1)
    one = ct.cycles.basins(family, 0.2, np.array([0.1, 0.1]), starts=2, seed=3)
    assert (one.reached, one.attractors[0].periods, one.attractors[0].share) == ((0, 0), 1, 1.0)
    assert "not periodic" not in repr(one)
