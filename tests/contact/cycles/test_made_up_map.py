"""Orbits, branches and basins of a map known in closed form: x' = v - x^2 + b y, y' = x (Henon, 1976).

Fixed points x^2 + (1 - b) x = v with multipliers m^2 + 2 x m = b: a fold at v = -(1 - b)^2/4, a flip at 3 (1 - b)^2/4,
beyond which the two points of period 2 have the sum 1 - b and the product (1 - b)^2 - v.
"""

import math

import numpy as np
import pytest

import contact as ct
from tests.contact.cycles.henon import FLIP, FOLD, B, Fork, fixed


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
    assert "v 0.5, repeats after 2 periods: x 0.714" in repr(found)
    twice = found.twice()
    assert (twice.periods, twice.period) == (4, 8.0)
    assert twice.M == pytest.approx(found.M @ found.M)
    assert twice.multipliers == pytest.approx(found.multipliers**2)


def test_an_unstable_orbit_states_so(family):
    found = ct.cycles.orbit(family, 0.2, guess=np.array([-1.0, -1.0]))
    assert found.x == pytest.approx([fixed(0.2, -1.0)] * 2, rel=1e-12)
    assert not found.stable
    assert repr(found).endswith(f"; unstable, |multiplier| {found.multiplier:.6g}")
    assert "closes" not in repr(found)


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


@pytest.mark.usefixtures("family")
def test_a_multiplier_through_one_without_a_turn_of_the_branch_is_a_branch_point():
    found = ct.cycles.follow(Fork(), (-0.3, 0.25), longest=0.1)
    (branch,) = found.branches
    assert [special.kind for special in branch.specials] == ["branch point"]
    assert branch.specials[0].orbit.value == pytest.approx(0.0, abs=1e-5)
    assert branch.stable.tolist() == [point.value < 0.0 for point in branch.points]


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
        f"{kept.count(-1) / 12:.1%} of the starts reach no periodic motion",
    ]  # fmt: skip
    assert found.records()[0]["periods"] == 2
    short = ct.cycles.basins(family, 0.5, np.array([0.1, 0.1]), starts=2, seed=3, settle=200, longest=1)
    assert short.reached == (-1, -1)
    one = ct.cycles.basins(family, 0.2, np.array([0.1, 0.1]), starts=2, seed=3)
    assert (one.reached, one.attractors[0].periods, one.attractors[0].share) == ((0, 0), 1, 1.0)
    assert "no periodic motion" not in repr(one)
