"""What a rub's loop looks up and adds: tables, rows, body forces, works, free flight; against formulas written out."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.contact.plain import names, plain

N = names("loop.rub.rows", "loop.rub.predict", "loop.rub.rub")
RUB = names("loop.rub.solve", "loop.rub.compliance", "loop.rub.predict", "loop.rub.rows")
LIMITS = names("loop.limits", "loop.rub.deflection", "model.gaps.limits")


def waves_of(phi, count=8):
    n = np.arange(count)
    return np.stack([np.cos(n * phi), np.sin(n * phi)])


def test_a_table_is_straight_between_its_points_and_constant_outside():
    table = np.array([[0.5, 2.0], [1.0, 4.0], [3.0, -1.0], [3.5, 0.0], [7.0, 7.0]])
    t = np.array([-1.0, 0.5, 0.75, 1.0, 2.9, 3.0, 3.1, 5.0, 7.0, 9.0])
    found = [N.straight(table, x) for x in t]
    np.testing.assert_allclose(found, np.interp(t, *table.T), rtol=1e-14)


def test_turning_is_integrated_over_segments():
    speed = np.array([[0.0, 0.0, 3.0, 2.0], [1.0, 4.0, 5.0, -1.0], [2.0, 8.5, 4.0, 0.0]])
    assert N.turned(speed, 0.5) == pytest.approx((0.5 * 3.0 + 0.5 * 2.0 * 0.25, 4.0))
    assert N.turned(speed, 1.0) == (4.0, 5.0)
    assert N.turned(speed, 1.5) == pytest.approx((4.0 + 2.5 - 0.125, 4.5))
    assert N.turned(speed, 3.0) == (12.5, 4.0)
    assert N.turned(speed, -0.5) == pytest.approx((-1.5 + 0.25, 2.0))  # before the first the first goes on


def cubic(at, values, slopes, x):
    """The cubic with these values and slopes at both ends, by its coefficients."""
    rows = [[u**k for k in range(4)] for u in at] + [[k * u ** max(k - 1, 0) for k in range(4)] for u in at]
    return np.linalg.solve(rows, [*values, *slopes]) @ [x**k for k in range(4)]


def test_a_periodic_cubic_has_its_values_and_slopes():
    at = np.array([0.2, 1.0, 2.5, 4.0, 6.0, 0.2 + 2.0 * math.pi])
    values, slopes = np.array([0.1, -0.3, 0.4, 0.2, -0.2, 0.1]), np.array([0.5, 0.1, -0.4, 0.3, 0.2, 0.5])
    table = np.stack([at, values, slopes], axis=1)
    for phi in (0.2, 0.7, 1.0, 3.9, 6.2, 6.4, -0.3, 20.0, -9.0):
        inside = at[0] + (phi - at[0]) % (2.0 * math.pi)
        k = int(np.searchsorted(at, inside, side="right")) - 1
        exact = cubic(at[k : k + 2], values[k : k + 2], slopes[k : k + 2], inside)
        assert N.hermite(table, phi) == pytest.approx(exact, abs=1e-11)
    assert N.hermite(np.zeros((0, 3)), 1.0) == 0.0


def laws(**parts):
    given = {
        "speed": np.array([[0.0, 0.0, 3.0, 0.0]]), "closing": np.array([[0.0, 0.0]]),
        "whirl": np.array([[2e-3, -3.0, 0.7, 0.4], [1e-3, 1.0, 0.0, -1.0]]),
        "terms": N.Terms(np.array([2, 3]), np.array([0.3, 0.1]), np.array([-0.2, 0.4])), "table": np.zeros((0, 3)),
        "lowest": -0.6, "pulls": None, "swing": N.Swing(np.zeros((0, 4)), np.zeros((2, 0)), 0, np.zeros(2)),
        "spin": N.Spin(-1, 0.0, np.zeros(3)),
    }  # fmt: skip
    return N.RubLaws(**{**given, **parts})


def rub_rows(angle=(0.5, 2.0), **parts):
    angle = np.array(angle)
    given = dict.fromkeys(N.RubRows._fields)
    given.update(
        angle=angle, heading=np.stack([np.cos(angle), np.sin(angle)], axis=1), clearance=np.array([0.01, 0.02]),
        own=np.array([[2, 4], [4, 7]]), blade=np.arange(1.0, 13.0).reshape(4, 3) / 10.0,
        glide=np.array([0.0, 1.1, 0.0, 1.2]),
    )  # fmt: skip
    return N.RubRows(**{**given, **parts})


def test_the_rigid_gap_is_profile_and_whirl_at_the_angle_of_the_tip():
    rows, given, angles, waves = rub_rows(), laws(), np.zeros((3, 3)), np.zeros((2, 8))
    N.look_at(angles, N.AHEAD, 0.9)
    assert angles[2].tolist() == [0.9, math.cos(0.9), math.sin(0.9)]
    for j in (0, 1):
        phi = rows.angle[j] - 0.9
        found = N.rigid_gap(given, rows, j, 0.25, angles, N.AHEAD, waves)
        profile = 0.3 * math.cos(2 * phi) - 0.2 * math.sin(2 * phi) + 0.1 * math.cos(3 * phi) + 0.4 * math.sin(3 * phi)
        whirl = 2e-3 * math.cos(phi - (0.4 - 3.0 * 0.9 + 0.7 * 0.25)) + 1e-3 * math.cos(phi - (-1.0 + 0.9))
        assert found == pytest.approx(profile + whirl, rel=1e-12)
        np.testing.assert_allclose(waves, waves_of(phi), atol=1e-14)
        assert N.least_gap(given, rows, j, 0.005) == pytest.approx(rows.clearance[j] - 0.005 - 0.6 - 3e-3, rel=1e-14)
    table = np.array([[0.0, 0.1, 0.2], [3.0, 0.3, 0.2], [2.0 * math.pi, 0.1, 0.2]])
    more = N.rigid_gap(laws(table=table), rows, 1, 0.25, angles, N.AHEAD, waves) - found
    assert more == pytest.approx(N.hermite(table, rows.angle[1] - 0.9), rel=1e-12)


def test_a_blade_counts_with_its_own_modes_alone():
    rows, some, others = rub_rows(), np.arange(1.0, 9.0), np.arange(8.0) ** 2
    assert N.blade_dot(rows, rows.own, 1, 0, some) == pytest.approx(0.4 * 3.0 + 0.5 * 4.0)
    assert N.blade_dot(rows, rows.own, 2, 1, some) == pytest.approx(0.7 * 5.0 + 0.8 * 6.0 + 0.9 * 7.0)
    exact = N.blade_dot(rows, rows.own, 2, 1, some + others)
    assert N.blade_dot_of_sum(rows, rows.own, 2, 1, some, others) == pytest.approx(exact, rel=1e-14)


def test_body_forces_are_rotated_into_the_frames_of_casing_and_blades():
    law = np.array([[0.3, 0.2, -1.0, 1.5, 0.5, 0.4, 2.0, 3.0], [0.1, 0.0, 0.5, 0.0, 2.0, -0.7, 1.0, 0.0]])
    rng = np.random.default_rng(1)
    plane, out = rng.standard_normal((2, 5)), np.zeros(5)
    speed = np.array([[0.0, 0.0, 3.0, 2.0], [1.0, 4.0, 5.0, -1.5]])
    for t, slope in ((0.5, 2.0), (1.0, -1.5), (1.2, -1.5)):
        angle, omega, casing, blades = 0.8, 4.0, 0j, 0j
        for a, m, per, by, own, phase, on_casing, on_blades in law:
            w = by * omega + own
            force = complex(a + m * w * w, -m * by * slope) * np.exp(1j * (phase + per * angle + own * t))
            casing += on_casing * force
            blades += on_blades * force * np.exp(1j * angle)
        N.body_force(N.Pulls(law, plane, 3, np.zeros((0, 4)), np.zeros((2, 0))), speed, t, angle, omega, out)
        exact = np.where(np.arange(5) < 3, np.conj(casing), np.conj(blades))
        np.testing.assert_allclose(out, np.real((plane[0] + 1j * plane[1]) * exact), rtol=1e-12)


def test_a_step_without_forces_stiffens_and_keeps_the_last_increment():
    rng, m = np.random.default_rng(2), 16
    q, d, al, be, c, kick = rng.standard_normal((6, m))
    stiff, stiff_at = rng.standard_normal((2, 3, 3))
    s = SimpleNamespace(
        q=q, d=d.copy(), old=np.zeros(m), al=al, be=be, c=c, kick=kick, stiff=stiff, stiff_at=stiff_at,
        push=np.zeros(14), body=np.zeros(0),
    )  # fmt: skip
    given = laws(pulls=N.Pulls(np.zeros((0, 8)), np.zeros((2, 0)), 11, np.zeros((0, 4)), np.zeros((2, 0))))
    N.propagate(s, given, 0.1, 0.2, 3.0)
    push = -(9.0 * stiff - stiff_at) @ q[11:14]
    exact = al * d - be * q + kick
    exact[11:14] += c[11:14] * push
    np.testing.assert_allclose(s.d, exact, rtol=1e-12)
    np.testing.assert_array_equal(s.old, d)
    np.testing.assert_allclose(s.push[11:], push, rtol=1e-13)
    s.d[:], s.stiff = d, np.zeros((0, 0))
    s.body = np.zeros(14)
    law = np.array([[0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]])
    plane = rng.standard_normal((2, 14))
    N.propagate(s, laws(pulls=N.Pulls(law, plane, 11)), 0.1, 0.0, 3.0)
    exact = al * d - be * q + kick
    exact[:14] += c[:14] * 0.3 * plane[0]
    np.testing.assert_allclose(s.d, exact, rtol=1e-12)


def test_modes_that_move_give_the_works_of_body_forces_stiffening_and_damping():
    old, d, q, weight, body, push = np.random.default_rng(6).standard_normal((6, 16))
    s = SimpleNamespace(
        q=q.copy(), d=d, old=old, weight=weight, body=body[:14], push=push[:14], stiff=np.zeros((3, 3))
    )  # fmt: skip
    sums = SimpleNamespace(body_force=np.ones(1), external=np.ones(1), damping=np.ones(1))
    N.advance_modes(s, sums)
    both = old + d
    assert sums.body_force[0] == pytest.approx(1.0 + 0.5 * body[:14] @ both[:14], rel=1e-13)
    assert sums.external[0] == pytest.approx(1.0 + 0.5 * push[11:14] @ both[11:14], rel=1e-13)
    assert sums.damping[0] == pytest.approx(1.0 - np.sum(weight * old * both), rel=1e-13)
    np.testing.assert_allclose(s.q, q + d)


@pytest.mark.parametrize(("drag", "stuck"), [((0.2, 0.1), True), ((0.3, 0.4), False), ((0.4, 0.4), False)])
def test_a_tip_sticks_inside_its_cone(drag, stuck):
    s = SimpleNamespace(lam=np.array([9.0, 9.0, 9.0, 1.0, *drag]), mu=np.array([1.0, 0.5]))
    assert N.sticks(s, 3, 3, 1) == stuck
    s.lam[3] = 0.0
    assert not N.sticks(s, 3, 3, 1)


def test_pushes_of_tips_reach_the_casing_and_their_own_blades():
    rng, own = np.random.default_rng(4), np.array([[8, 10], [10, 13]])
    rows = rub_rows(width=8, own=own, apart=own)
    pushed, d, c = rng.standard_normal(8), rng.standard_normal(16), rng.standard_normal(16)
    s = SimpleNamespace(contact=np.ones(16), d=d.copy(), c=c, lam=np.array([1.0, -0.5, 2.0, 0.3]))
    w = SimpleNamespace(pushed=pushed, chosen=np.array([1, 0]))
    RUB.push(s, rows, w, 2, 2)
    force = np.zeros(16)
    force[:8] = pushed
    force[8:10] = s.lam[:2] @ rows.blade[:2, :2]
    force[10:13] = s.lam[2:] @ rows.blade[2:, :3]
    np.testing.assert_allclose(s.contact, force, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(s.d, d + c * force, rtol=1e-13)
    s.d[:] = d
    RUB.push(s, rows, w, 1, 2)
    force[8:10] = 0.0
    np.testing.assert_allclose(s.d, d + c * force, rtol=1e-13)


@pytest.mark.parametrize("share", [1.0, 0.25])
def test_gaps_move_on_by_what_is_not_compliance(share):
    s = SimpleNamespace(
        mu=np.zeros(3), inside=np.array([1, 2, 0]), free=np.array([0.1, 0.2, 0.3]), skin=np.array([0.0, 0.02, 0.0]),
        motion=np.array([0.5, 9.0, 0.01, 9.0, 9.0, 9.0]), test=np.array([0.4, -0.3, 9.0]),
    )  # fmt: skip
    w = SimpleNamespace(strain=np.array([0.03, 9.0, 0.05, 9.0, 9.0, 9.0]), chosen=np.array([1]), depth=np.array([0.07]))
    RUB.update_gaps(s, w, 1, 2, share)
    near = 0.1 + (0.5 - 0.4 - 0.03) / share
    pressed = 0.2 + (0.01 - 0.07 + 0.3 + 0.02 - 0.05) / share
    np.testing.assert_allclose(s.free, [near, pressed, 0.3], rtol=1e-13)


def test_forces_of_slots_add_up_to_what_they_push_and_strain():
    rng = np.random.default_rng(5)
    s = SimpleNamespace(lam=np.zeros(6), motion=np.zeros(6))
    w = SimpleNamespace(
        slots=np.array([2]), pull=np.full(4, 9.0), row=np.array([0, 1, 4, 5, 2, 3]),
        column=np.array([0, 1, 2, 3, 0, 1]), lam=rng.standard_normal(6), motion=rng.standard_normal(6),
        pushed=np.zeros(16), strained=np.zeros(8), rows=rng.standard_normal((4, 16)), soft=rng.standard_normal((4, 8)),
    )  # fmt: skip
    RUB.hand_over(s, w, 6, 2)
    pull = [w.lam[0] + w.lam[4], w.lam[1] + w.lam[5], w.lam[2], w.lam[3]]
    np.testing.assert_allclose(w.pull, pull)
    np.testing.assert_allclose(w.pushed, pull @ w.rows, rtol=1e-12)
    np.testing.assert_allclose(w.strained, pull @ w.soft, rtol=1e-12)
    np.testing.assert_array_equal(s.lam[w.row], w.lam)
    np.testing.assert_array_equal(s.motion[w.row], w.motion)


def test_a_deflection_is_that_around_the_rim_and_ends_a_run_beyond_its_limit():
    limits, z, top = LIMITS.motion_limits(0.5, 3e-3), np.array([1e-4, 0.0, 3e-4, 0.0, -4e-4]), np.zeros(8)
    half = (np.arange(24) + 0.5) * (np.pi / 24)
    angle = np.concatenate([half, -half])
    found = LIMITS.largest_around(z, np.array([np.cos(half), np.sin(half)]), top)
    assert found == pytest.approx(np.abs(1e-4 + 3e-4 * np.cos(2 * angle) - 4e-4 * np.sin(2 * angle)).max(), rel=1e-12)
    assert not LIMITS.matters(limits, 1.4e-3, True)
    assert LIMITS.matters(limits, 1.6e-3, True)
    LIMITS.note_deflection(limits, 1.7e-3, False)  # of a state that is stored
    assert (limits[LIMITS.LARGEST], LIMITS.outgrown(limits)) == (1.7e-3, False)
    assert not LIMITS.matters(limits, 1.65e-3, False)
    LIMITS.note_deflection(limits, 1.6e-3, True)
    assert (limits[LIMITS.LARGEST], limits[LIMITS.REACHED + LIMITS.RIM]) == (1.7e-3, 1.6e-3)
    assert LIMITS.outgrown(limits)


def test_what_is_machined_off_a_coating_follows_waves_and_table_of_the_profile(monkeypatch):
    with plain() as module:
        loop = module("contact.loop.rub.predict")
    monkeypatch.setattr(loop, "coating_of", lambda coats, j: SimpleNamespace(round=0.0))
    monkeypatch.setattr(loop, "first_bar", lambda tip, turns: round(100.0 * turns))
    monkeypatch.setattr(loop, "machined", lambda tip, depth: depth)
    monkeypatch.setattr(loop, "surface", lambda tip, first, cut: 2.0 * cut)
    at = np.array([0.0, 2.0, 4.0, 2.0 * math.pi])
    table = np.stack([at, [0.1, 0.4, -0.2, 0.1], np.zeros(4)], axis=1)
    given, test = laws(table=table), np.array([0.5, -0.1])
    s = SimpleNamespace(
        mu=np.zeros(2), inside=np.array([2, 2]), skin=np.zeros(2), test=test.copy(), motion=np.zeros(4), lam=np.zeros(4)
    )
    coats = SimpleNamespace(memory=np.ones((2, 3)), first=np.zeros(2, int), cut=np.zeros(2))
    rows, w = SimpleNamespace(angle=np.array([0.5, 2.0])), SimpleNamespace(turn=np.zeros((2, 8)))
    apart = loop.stand(s, given, rows, w, coats, 2, 0.3)
    exact = [
        0.3 * math.cos(2 * phi) - 0.2 * math.sin(2 * phi) + 0.1 * math.cos(3 * phi) + 0.4 * math.sin(3 * phi)
        + N.hermite(table, phi)
        for phi in (0.2, 1.7)
    ]  # fmt: skip
    np.testing.assert_allclose(coats.cut, exact, rtol=1e-13)
    np.testing.assert_allclose(s.test, test + 2.0 * coats.cut, rtol=1e-13)
    assert coats.first.tolist() == [3, 27]
    assert (coats.memory[:, 1] == 0.0).all()
    assert apart == sum(s.test >= 0.0)
    assert s.inside.tolist() == [1 if gap >= 0.0 else 2 for gap in s.test]
