"""Steps of a rotating rim against the same steps by whole rows; lanes against runs alone; as plain Python."""

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 2e-5, 180


def turning(module, *, imperfect=0.05, clearance=-1e-5, speed=20.0, lean=25.0):
    ct, made = module("contact"), module("tests.contact.synthetic_rim")
    return ct.RotatingRim(
        made.ring(S=4e-7, imperfect=imperfect), made.blade(S=1e-6), clearance=clearance, speed_hz=speed, lean_deg=lean,
        out_of_roundness=[{"p": 2, "cos": 2e-5}, {"p": 5, "sin": 1e-5}], angle_deg=13.0,
    )  # fmt: skip


def friction(n, across, along, t, gap, slip, mu):
    """Normal and tangential force of a contact that would close: sticking inside the cone, else slipping."""
    force = np.linalg.solve([[n, across], [along, t]], [-gap, -slip])
    if abs(force[1]) <= mu * force[0]:
        return force, True
    for side in (-1.0, 1.0):
        normal = -gap / (n + side * mu * across)
        if side * ((along + side * mu * t) * normal + slip) <= 0.0:
            return np.array([normal, side * mu * normal]), False
    raise AssertionError("neither sticks nor slips")


@pytest.mark.slow
@pytest.mark.parametrize(("averaged", "skip"), [(False, True), (True, False)])
@pytest.mark.parametrize(
    ("mu", "imperfect", "speed"), [(0.0, 0.05, 20.0), (0.3, 0.05, 20.0), (0.9, 0.05, -2e-3), (0.3, 0.0, 20.0)]
)
def test_a_rim_presses_where_its_point_is_and_its_ledger_is_that_of_its_modes(mu, imperfect, speed, averaged, skip):
    with plain() as module:
        ct, record = module("contact"), module("contact.record.record")
        rim = turning(module, imperfect=imperfect, speed=speed, clearance=-2e-5 if speed > 0.0 else -2.9e-5)
        system = module("contact.model.gaps.modal_system").rim_system(rim)
        law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
        scheme = ct.ExactModal(law="averaged" if averaged else "forward", skip=skip)
        run = scheme.prepare(rim, law, dt=H, courant=None)
        s = run.rim.state
        q, D, al, be, c = (np.array(x[: system.omega.size]) for x in (s.q, s.d, s.al, s.be, s.c))
        now, last = s.memory[0], s.memory[1]
        out = record.samples(record.Record(every=1, state_every=1), STEPS, 1, run.size)
        assert run.advance(out, 0, 71) == -1
        assert run.advance(out, 71, STEPS - 71) == -1
    sums, share, surface = run.sums, 0.25 if averaged else 1.0, system.radius * system.speed

    def at(n):
        phi = system.angle - system.speed * n * H
        S = np.array([[system.S_nn(phi), system.S_nt(phi)], [system.S_nt(phi), system.S_tt(phi)]])
        return *system.table.rows(phi), system.clearance(phi), S

    def energy(q, D):
        return np.sum(0.5 * (D**2 + be * (q - D) * q) / c)

    begun, S_last, strain, noted, stuck = energy(q, D), at(-1)[3], 0.0, [], 0
    work = rubbed = heat = drive = damping = moved = 0.0
    turnings, sticks, closings, reversals = 0, [], [], 0
    for n in range(STEPS):
        (Q, T, _, S), (ahead, _, clear, _) = at(n), at(n + 1)
        new = al * D - be * q
        free = clear + ahead @ (q + new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        force, H_ = np.zeros(2), np.array([ahead @ (c * Q), ahead @ (c * T)])
        slipped, sticking, slope = 0.0, False, np.array([share * H_[0] + S[0, 0], share * H_[1] + S[0, 1]])
        if test < 0.0:
            slip = T @ new + H * surface - strain
            across = np.array([T @ (c * Q) + S[0, 1], T @ (c * T) + S[1, 1]])
            if mu:
                force, sticking = friction(*slope, *across, test, slip, mu)
                slipped = across @ force + slip
            else:
                force = np.array([-test / slope[0], 0.0])
        new = new + c * (Q * force[0] + T * force[1])
        assert out.state[n, : q.size] == pytest.approx(q, abs=1e-15)
        assert out.state[n, q.size] == pytest.approx(force[0], rel=1e-8, abs=1e-8)
        noted.append((force[0], test + slope @ force))
        after, both = free + H_ @ force, D + new
        if force[0] > 0.0:
            change = S @ force
            soft = force[1] * (change[1] - strain)
            work += 0.5 * force[0] * (after - last) + 0.5 * force @ (S - S_last) @ force - soft
            rubbed += 0.5 * force[1] * (T @ both) + soft
            heat -= force[1] * slipped
            drive -= force[1] * H * surface
            reversals += int(not sticking and force[1] * surface > 0.0)
            moved += 0.5 * force @ np.array([Q @ both, T @ both])
        damping -= np.sum((1.0 - al) / (2.0 * c) * D * both)
        if mu and int(sticking) != stuck:
            stuck = int(sticking)
            sticks.append((2 + stuck, n * H))
        turnings += int(force[0] > 0.0)
        strain, S_last = (S @ force)[1], S
        q, D, last, now = q + new, new, now, after
        closings.append(abs(now - clear))
    forces, gaps = np.array(noted).T
    assert 10 < turnings <= STEPS
    scale = forces.max()
    np.testing.assert_allclose(out.force[:STEPS, 0], forces, rtol=0.0, atol=1e-9 * scale)
    np.testing.assert_allclose(out.gap[:STEPS, 0], gaps, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(out.time[:STEPS], H * np.arange(STEPS), rtol=1e-12)
    np.testing.assert_allclose(out.state_time[:STEPS], H * np.arange(STEPS), rtol=1e-12)
    unit = abs(energy(q, D) - begun) + abs(work)
    expected = [work, rubbed, moved - work - rubbed, damping]
    found = [sums.work[0], sums.friction[0], sums.rotation[0], sums.damping[0]]
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-10 * unit)
    assert energy(q, D) - begun == pytest.approx(sum(found), abs=1e-10 * unit)
    np.testing.assert_allclose(s.memory[8:10], [heat, drive], rtol=1e-8, atol=1e-10 * unit)
    assert sums.contact_steps[0] == turnings
    assert sums.reversals[0] == reversals
    assert sums.peak[0] == pytest.approx(scale, rel=1e-9)
    assert sums.impulse[0] == pytest.approx(H * forces.sum(), rel=1e-9)
    kinds, times = out.event_kind[: sums.filled[2]], out.event_time[: sums.filled[2]]
    found = [(k, t) for k, t in zip(kinds, times, strict=True) if k >= 2]
    assert [k for k, _ in found] == [k for k, _ in sticks]
    assert (len(sticks) > 0) == (mu == 0.9)
    np.testing.assert_allclose([t for _, t in found], [t for _, t in sticks], rtol=1e-12)
    limits = module_limits()
    assert run.limits[limits.REACHED + limits.TIP] == pytest.approx(max(closings), rel=1e-9)


def module_limits():
    with plain() as module:
        return module("contact.model.gaps.limits")


@pytest.mark.slow
def test_lanes_of_unlike_rims_are_as_if_each_ran_alone():
    with plain() as module:
        ct = module("contact")
        scenes = [
            ct.Scene(
                what=turning(module, clearance=clearance, speed=speed, lean=lean), scheme=ct.ExactModal(law=law),
                law=ct.Coulomb(mu=mu) if mu else ct.Unilateral(), dt=dt, t_end=140 * dt,
                record=ct.Record(every=every, state_every=2 * every),
            )
            for clearance, speed, lean, mu, dt, law, every in (
                (-2e-5, 20.0, 25.0, 0.3, 2e-5, "averaged", 3), (-3e-5, -7.0, 10.0, 0.0, 1.8e-5, "forward", 5),
                (-2.9e-5, -2e-3, 35.0, 0.9, 2e-5, "forward", 1),
            )
        ]  # fmt: skip
        many, alone = ct.run_many(scenes), [ct.run(scene) for scene in scenes]
    assert sum(len(sticks) for one in alone for sticks in one.sticking) > 0
    for one, other in zip(alone, many, strict=True):
        assert one.contact_steps[0] > 5
        for name in ("time", "state_time", "contact_steps", "reversals"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name))
        for name in ("force", "gap", "state", "impulse", "peak_force", "impulse_history"):
            exact = getattr(one, name)
            np.testing.assert_allclose(getattr(other, name), exact, rtol=0.0, atol=1e-9 * np.abs(exact).max() + 1e-18)
        np.testing.assert_allclose(other.intervals[0], one.intervals[0], rtol=0.0, atol=1e-10)
        for sticks, exact in zip(other.sticking, one.sticking, strict=True):
            np.testing.assert_allclose(sticks, exact, rtol=0.0, atol=1e-10)
        for name in ("contact", "rotation", "friction", "damping"):
            exact = getattr(one.energy, name)
            assert getattr(other.energy, name) == pytest.approx(exact, rel=1e-8, abs=1e-12 * one.energy.scale)
        assert abs(other.energy.unaccounted) <= 1e-11 * other.energy.scale
        for name in ("heat", "drive"):
            assert getattr(other.notes, name) == pytest.approx(getattr(one.notes, name), rel=1e-8, abs=1e-13)
        np.testing.assert_allclose(other.max_penetration, one.max_penetration, rtol=1e-7, atol=1e-15)
        assert np.max(other.residual) <= 1e-14
