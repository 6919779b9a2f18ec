"""Steps of a rub of several tips against the same steps by whole rows and matrices; uncompiled."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 2e-5, 70


def rub(module, *, axial):
    ct, made = module("contact"), module("tests.contact.synthetic_rub")
    return ct.Rub(
        made.rim3(), (made.nodes(2), made.nodes(1, seed=6)),
        [*made.tips(2, axial=axial), *made.tips(1, blade=1, angle=190.0, axial=axial)], clearance=-2e-5,
        speed=ct.Speed(time=[0.0, 0.1], hz=[3.0, 5.0]), closing=ct.gaps.Closing(time=[0.0, 1e-3], by=[0.0, 4e-6]),
        profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]),
        whirl=(ct.gaps.Whirl(amplitude=3e-6, per_rev=-3.0, phase_deg=40.0),),
    )  # fmt: skip


class Whole:
    """Rows, gaps and compliance of all tips at an instant, by whole matrices."""

    def __init__(self, run, dim):
        self.run, self.system, self.dim = run, run.system, dim

    def turned(self, t):
        return 2.0 * math.pi * (3.0 * t + 0.5 * 20.0 * max(t, 0.0) ** 2)

    def rows(self, t):
        """(K d, m), normals first of each tip."""
        system, m, d = self.system, self.system.omega.size, self.dim
        R, casing = np.zeros((system.contacts * d, m)), int(system.first[1])
        for j in range(system.contacts):
            for i in range(d):
                phi = system.angle[j] - self.turned(t)
                R[j * d + i, :casing] = system.rim.rows(int(system.line[j]) * system.directions + i, phi)
                begin, end = system.own[j]
                R[j * d + i, begin:end] = system.blade_rows[j * d + i, : end - begin]
        return R

    def gaps(self, t, q):
        angle = self.turned(t)
        phi = self.system.angle - angle
        profile = 2e-5 * np.cos(2.0 * phi) + 1e-5 * np.sin(3.0 * phi)
        whirl = 3e-6 * np.cos(phi - (math.radians(40.0) - 3.0 * angle))
        closing = 4e-6 * min(max(t / 1e-3, 0.0), 1.0)
        return self.system.clearance + profile + whirl - closing + self.rows(t)[:: self.dim] @ q

    def compliance(self, t):
        return self.system.compliance(self.turned(t))


def far_from_the_law(lam, motion, mu, d, unit):
    """Largest distance of forces and motions from the law; `unit` turns motions into forces."""
    worst = 0.0
    for f, u in zip(lam.reshape(-1, d), motion.reshape(-1, d) * unit, strict=True):
        worst = max(worst, abs(min(f[0], u[0])))
        if d > 1:
            aim = f[1:] - u[1:]
            length = np.linalg.norm(aim)
            worst = max(worst, np.abs(f[1:] - aim * min(1.0, mu * f[0] / max(length, 1e-300))).max())
    return worst


CASES = {
    "three directions": (True, 3, 0.2, "forward", 40),
    "two directions": (False, 2, 0.2, "forward", 40),
    "two directions, averaged": (False, 2, 0.3, "averaged", 40),
    "without friction": (True, 1, 0.0, "averaged", 40),
    "without friction by waves": (True, 1, 0.0, "forward", 0),
    "three directions by waves": (True, 3, 0.2, "averaged", 0),
    "two directions by waves": (False, 2, 0.3, "forward", 0),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_tips_obey_the_law_where_they_are_and_their_ledger_is_that_of_the_modes(name):
    axial, d, mu, law, few = CASES[name]
    with plain() as module:
        ct, record = module("contact"), module("contact.record.record")
        stepper = module("contact.scheme.modal.rub_arrays")
        kept, stepper.FEW = stepper.FEW, min(few, stepper.FEW) if few else 0
        friction = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
        run = ct.ExactModal(law=law).prepare(rub(module, axial=axial), friction, dt=H, courant=None)
        few_tips, stepper.FEW = run.arrays.rows.few, kept
        m, s, seen = run.system.omega.size, run.state, []
        out = record.samples(record.Record(every=1, state_every=1), STEPS, 3, s.seen.size)
        first = (s.q[:m].copy(), s.d[:m].copy())
        for n in range(STEPS):
            assert run.advance(out, n, 1) == -1
            seen.append((s.q[:m].copy(), s.d[:m].copy(), s.lam.copy()))
    assert few_tips == (few > 0)
    assert run.dimensions == d
    at, share = Whole(run, d), 0.25 if law == "averaged" else 1.0
    al, be, c = (np.array(x[:m]) for x in (s.al, s.be, s.c))
    sums, normal = run.sums, slice(None, None, d)
    (q, D), lam, strain = first, np.zeros(3 * d), np.zeros(3 * d)
    work, rotation, rubbed, heat, drive = np.zeros((5, 3))
    last, now, touched, damping = at.gaps(-H, q - D), at.gaps(0.0, q), np.zeros(3), 0.0
    for n in range(STEPS):
        t = n * H
        R, ahead, S, S_last = at.rows(t), at.rows(t + H), at.compliance(t), at.compliance(t - H)
        free = al * D - be * q + c * run.parts.load
        q_next, d_next, lam = seen[n]
        np.testing.assert_allclose(d_next, free + c * (R.T @ lam), rtol=0.0, atol=1e-14)
        np.testing.assert_allclose(q_next, q + d_next, rtol=0.0, atol=1e-14)
        gap = at.gaps(t + H, q + free)
        test = 0.25 * (gap + 2.0 * now + last) if share < 1.0 else gap
        yields = R * c @ R.T
        motion = np.zeros(3 * d)
        motion[normal] = test + share * ((ahead * c @ R.T) @ lam)[normal] + (S @ lam)[normal]
        slid = H * 2.0 * math.pi * (3.0 + 20.0 * t) * run.system.radius
        for i in range(1, d):
            motion[i::d] = (R @ free + yields @ lam + S @ lam - strain)[i::d] + (slid if i == 1 else 0.0)
        unit = 1.0 / (yields + S).diagonal().max()
        assert far_from_the_law(lam, motion, mu, d, unit) <= 1e-7 * max(1.0, lam.max())
        after = at.gaps(t + H, q_next)
        both, change = 0.5 * (R @ (D + d_next)), S @ lam - S_last @ lam
        soft = lam * (S @ lam - strain)
        for j in np.flatnonzero(lam[normal] > 0.0):
            own = slice(j * d, (j + 1) * d)
            tangents = slice(j * d + 1, (j + 1) * d)
            base = 0.5 * lam[j * d] * (after[j] - last[j])
            moved = 0.5 * (lam * change)[own].sum()
            work[j] += base + moved - soft[tangents].sum()
            rotation[j] += lam[j * d] * both[j * d] - base - moved
            rubbed[j] += (lam * both + soft)[tangents].sum()
            heat[j] -= (lam * motion)[tangents].sum()
            drive[j] -= lam[j * d + 1] * slid[j] if d > 1 else 0.0
        touched += lam[normal] > 0.0
        damping -= np.sum((1.0 - al) / (2.0 * c) * D * (D + d_next))
        np.testing.assert_array_equal(out.force[n], lam[normal])
        np.testing.assert_allclose(out.state[n], np.concatenate([q, lam]), rtol=0.0, atol=1e-15 + 1e-12 * lam.max())
        near = motion[normal] < 1e-6
        np.testing.assert_allclose(out.gap[n][near], motion[normal][near], rtol=0.0, atol=1e-13)
        assert (out.gap[n][~near] <= motion[normal][~near] + 1e-13).all()
        q, D, last, now, strain = q_next, d_next, now, after, S @ lam
    assert touched.max() > 10
    assert (touched > 0).sum() >= 2
    unit = np.abs(work).max()
    np.testing.assert_allclose(sums.work, work, rtol=1e-7, atol=1e-9 * unit)
    np.testing.assert_allclose(sums.rotation, rotation, rtol=1e-7, atol=1e-9 * unit)
    np.testing.assert_allclose(sums.friction, rubbed, rtol=1e-7, atol=1e-9 * unit)
    np.testing.assert_allclose([s.heat, s.drive], [heat, drive], rtol=1e-7, atol=1e-9 * unit)
    assert sums.damping[0] == pytest.approx(damping, rel=1e-9)
    assert sums.contact_steps.tolist() == touched.tolist()
    pressed = [False, *(one[2].any() for one in seen)]
    assert s.counts[2] == sum(now or before for before, now in pairwise(pressed))
    np.testing.assert_allclose(sums.impulse, H * sum(one[2] for one in seen)[normal], rtol=1e-10)
    assert sums.residual.max() <= 1e-13


def test_a_step_without_a_solution_is_reported(monkeypatch):
    with plain() as module:
        ct, record = module("contact"), module("contact.record.record")
        loop, scheme = module("contact.loop.rub.rub"), ct.ExactModal(law="forward")

        def started():
            return scheme.prepare(rub(module, axial=False), ct.Coulomb(mu=0.2), dt=H, courant=None)

        def samples():
            return record.samples(record.Record(every=1), STEPS, 3, 0)

        out, run = samples(), started()
        assert run.advance(out, 0, STEPS) == -1
        run, begun = started(), STEPS // 2
        assert run.advance(samples(), 0, begun) == -1
        failed = begun + int(np.flatnonzero(out.force[begun:].any(axis=1))[0])
        monkeypatch.setattr(loop, "solve", lambda *given: False)
        monkeypatch.setattr(loop, "alone", lambda *given: False)
        assert run.advance(samples(), begun, STEPS - begun) == failed
        assert run.steps[0] == failed
