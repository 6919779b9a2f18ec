"""Bars of a coating under one tip, and its friction, against the law of each bar written out."""

import math

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.abradable.tips", "solver.friction.all_sliding", "solver.friction.coulomb", "solver.yielding.several")
RUB = names("loop.rub.predict")
WORN = np.array([1e-5, 3e-5, 0.0, 2e-5, 9e-5, 5e-6, 4e-5])
THICK, STIFF, YIELD, HARD = 1e-4, 2e6, 30.0, 4e5


def bars(**changes):
    given = {
        "worn": WORN.copy(), "round": 2e-5, "mean": 1e-4, "thickness": THICK, "stiffness": STIFF, "yield_force": YIELD,
        "hardening": HARD, "under": 3, "memory": np.array([0.5, 9.0, 9.0]),
    }  # fmt: skip
    return N.Coating(**{**given, **changes})


def pressed(worn, cut, depth):
    """Worn depth and force of one bar under a tip at `depth`."""
    flown = (STIFF * (depth - cut) - YIELD) / (STIFF + HARD)
    now = max(worn, min(flown, THICK - cut))
    return now, STIFF * max(depth - cut - now, 0.0)


def test_a_tip_covers_bars_about_its_middle_all_around():
    c = bars()
    for k in range(7):
        assert N.first_bar(c, (k + 0.5) / 7.0) == (k - 1) % 7
        assert N.first_bar(c, 3.0 + (k + 0.01) / 7.0) == (k - 1) % 7
        assert N.first_bar(bars(under=2), -2.0 + (k + 0.51) / 7.0) == k
        assert N.first_bar(bars(under=2), (k + 0.49) / 7.0) == (k - 1) % 7
    assert N.machined(c, 1.05e-4) == pytest.approx(1.5e-5, rel=1e-10)
    assert N.machined(c, 0.95e-4) == pytest.approx(2.5e-5, rel=1e-10)
    assert N.machined(c, 1.3e-4) == 0.0
    assert N.surface(c, 3, 2e-5) == 2e-5 + 5e-6
    assert N.surface(c, 6, 2e-5) == 2e-5 + 1e-5
    assert N.surface(c, 3, 0.0) == 5e-6


@pytest.mark.parametrize("depth", [0.9e-5, 2.6e-5, 4.7e-5, 6.7e-5, 9.7e-5, 1.31e-4, 2.1e-4])
@pytest.mark.parametrize("first", [0, 3, 6])
def test_bars_bear_and_flow_each_by_its_own_law(depth, first):
    c, cut = bars(), 1e-5
    under = [(first + j) % 7 for j in range(3)]
    each = [pressed(WORN[i], cut, depth) for i in under]
    force, slope = N.borne(c, first, cut, depth)
    assert force == pytest.approx(sum(f for _, f in each), rel=1e-12, abs=1e-12)
    step = 1e-11
    ahead, back = (sum(pressed(WORN[i], cut, depth + side * step)[1] for i in under) for side in (1, -1))
    assert slope == pytest.approx((ahead - back) / (2.0 * step), rel=1e-4, abs=1.0)
    np.testing.assert_array_equal(c.worn, WORN)
    N.wear(c, first, cut, depth)
    worn = WORN.copy()
    worn[under] = [w for w, _ in each]
    np.testing.assert_allclose(c.worn, worn, rtol=1e-12)
    spent = sum((w - WORN[i]) * (YIELD + 0.5 * HARD * (w + WORN[i])) for i, (w, _) in zip(under, each, strict=True))
    elastic = sum(0.5 * f * f / STIFF for _, f in each)
    np.testing.assert_allclose(c.memory, [0.5 + spent, elastic, depth], rtol=1e-12)


@pytest.mark.parametrize("gap", [-1.2e-5, -4e-5, -9e-5, -1.5e-4, -6e-4])
@pytest.mark.parametrize("compliance", [1e-8, 3e-7, 1e-5])
def test_a_tip_rests_where_its_spring_and_the_bars_agree(gap, compliance):
    c, cut = bars(), 1e-5
    depth = N.settled(c, 1, cut, compliance, gap)
    force = N.borne(c, 1, cut, depth)[0]
    assert depth + compliance * force == pytest.approx(-gap, rel=1e-12)
    np.testing.assert_array_equal(c.worn, WORN)


def coats(tips):
    """Two tracks of bars; tips on them in turn."""
    return N.Coats(
        worn=np.concatenate([WORN, WORN[::-1]]), start=np.array([0, 7, 14]), track=np.arange(tips) % 2,
        round=np.array([2e-5, -math.inf]), mean=np.array([1e-4, 2e-4]), thickness=THICK,
        stiffness=np.array([STIFF, 2.0 * STIFF]), yield_force=np.array([YIELD, 2.0 * YIELD]),
        hardening=np.array([HARD, 3.0 * HARD]), under=3, memory=np.arange(3.0 * tips).reshape(tips, 3),
        first=np.arange(tips) % 7, cut=1e-5 * np.arange(tips),
    )  # fmt: skip


def test_a_tip_has_the_bars_of_its_track_and_a_memory_of_its_own():
    c = coats(3)
    for j, (k, bar) in enumerate(((0, WORN), (1, WORN[::-1]), (0, WORN))):
        one = N.coating_of(c, j)
        np.testing.assert_array_equal(one.worn, bar)
        found = (one.round, one.mean, one.stiffness, one.yield_force, one.hardening)
        assert found == (c.round[k], c.mean[k], c.stiffness[k], c.yield_force[k], c.hardening[k])
        assert (one.thickness, one.under, one.memory.tolist()) == (THICK, 3, c.memory[j].tolist())
        one.worn[0] += 1.0
        assert c.worn[c.start[k]] == bar[0] + 1.0
        one.worn[0] = bar[0]


def test_a_tip_s_own_compliance_has_its_share_of_friction():
    W = np.array([[2.0, 0.5, -0.3], [0.5, 1.0, 0.0], [-0.3, 0.0, 1.0]])
    assert N.own_compliance(W, 0, 3, np.array([4.0, 1.0, -2.0])) == pytest.approx(2.0 + 0.125 + 0.15)
    assert N.own_compliance(W, 0, 3, np.array([0.0, 1.0, -2.0])) == 2.0
    assert N.own_compliance(W, 0, 3, np.array([1.0, -9.0, 0.0])) == 2.0  # it would jam
    assert N.own_compliance(W, 0, 1, np.array([4.0, 1.0, -2.0])) == 2.0


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("tips", [1, 3])
def test_depths_and_forces_of_tips_obey_the_bars_and_friction(dim, tips):
    rng, n = np.random.default_rng(3), tips * dim
    for _ in range(4):
        half = rng.standard_normal((n, n))
        W = 1e-7 * (half @ half.T / n + 2.0 * np.eye(n))
        b = 5e-5 * rng.standard_normal((tips, dim))
        b[:, 0] -= 6e-5
        mu, c, force, depth = np.full(tips, 0.2), coats(tips), np.zeros(n), np.zeros(tips)
        chosen, room = np.arange(tips), N.solver_room(tips, dim)
        assert N.yielding_forces(
            c, None, chosen, W, b.ravel(), mu, dim, tips, force, depth, N.AllSliding(used=True), room
        )
        motion = (W @ force + b.ravel()).reshape(tips, dim)
        for j in range(tips):
            own, first = force[j * dim : (j + 1) * dim], c.first[j]
            bears = N.borne(N.coating_of(c, j), first, c.cut[j], depth[j])[0]
            assert own[0] == pytest.approx(bears, rel=1e-7, abs=1e-7)
            if own[0] > 0.0:
                assert motion[j, 0] == pytest.approx(-depth[j], rel=1e-9, abs=1e-14)
            else:
                assert motion[j, 0] + N.surface(N.coating_of(c, j), first, c.cut[j]) >= -1e-14
            drag, slip = np.linalg.norm(own[1:]), np.linalg.norm(motion[j, 1:])
            assert drag <= 0.2 * own[0] * (1.0 + 1e-9) + 1e-9
            if dim > 1 and slip > 1e-12:
                assert own[1:] @ motion[j, 1:] == pytest.approx(-0.2 * own[0] * slip, rel=1e-6, abs=1e-15)
        np.testing.assert_array_equal(c.worn, coats(tips).worn)


def test_bars_stand_under_tips_that_are_near_and_flow_under_those_that_press():
    from types import SimpleNamespace

    c, dim, angle = coats(4), 2, 0.7
    at = np.array([0.5, 2.0, 4.0, 5.5])
    s = SimpleNamespace(
        mu=np.zeros(4), inside=np.array([2, 2, 0, 1]), skin=np.zeros(4), test=np.array([-1e-3, -1e-6, -1.0, -1e-3]),
        motion=np.zeros(8), lam=np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
    )  # fmt: skip
    terms = SimpleNamespace(harmonic=np.array([1, 2]), cos=np.array([1e-5, 2e-5]), sin=np.array([-1e-5, 3e-5]))
    laws, w = SimpleNamespace(terms=terms, table=np.zeros((0, 3))), SimpleNamespace(turn=np.zeros((2, 8)))
    apart = RUB.stand(s, laws, SimpleNamespace(angle=at), w, c, dim, angle)
    skin = np.zeros(4)
    for j in (0, 1, 3):
        phi, tip = at[j] - angle, N.coating_of(c, j)
        profile = 1e-5 * math.cos(phi) - 1e-5 * math.sin(phi) + 2e-5 * math.cos(2 * phi) + 3e-5 * math.sin(2 * phi)
        cut = max(2e-5 - (profile - 1e-4), 0.0) if j != 1 and j != 3 else 0.0
        assert c.cut[j] == pytest.approx(cut, rel=1e-12)
        assert c.first[j] == N.first_bar(tip, phi / (2.0 * math.pi))
        skin[j] = N.surface(tip, c.first[j], cut)
    np.testing.assert_allclose(s.skin, skin, rtol=1e-12)
    np.testing.assert_allclose(s.test, np.array([-1e-3, -1e-6, -1.0, -1e-3]) + skin, rtol=1e-12)
    np.testing.assert_allclose(s.motion[::2][[0, 1, 3]], s.test[[0, 1, 3]], rtol=1e-12)
    assert c.memory[:, 1].tolist() == [0.0] * 4
    opened = bool(s.test[1] >= 0.0)
    assert (apart, s.inside.tolist()) == (int(opened), [2, 1 if opened else 2, 0, 1])
    assert opened
    before, w = c.worn.copy(), SimpleNamespace(chosen=np.array([0, 2]))
    s.lam[0] = 5.0
    c.memory[0, 2] = c.memory[2, 2] = 3e-4
    RUB.flow(s, w, c, 2, dim)
    again = coats(4)
    again.first[:], again.cut[:] = c.first, c.cut
    for j in (0, 2):
        N.wear(N.coating_of(again, j), c.first[j], c.cut[j], 3e-4)
    np.testing.assert_array_equal(c.worn, again.worn)
    assert not np.array_equal(c.worn, before)
    kept, s.lam[:] = c.worn.copy(), 0.0
    RUB.flow(s, w, c, 2, dim)
    np.testing.assert_array_equal(c.worn, kept)
