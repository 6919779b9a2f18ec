"""Steps of several contacts of one body against whole matrices; uncompiled."""

import math

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 0.01, 120


def patch(ct, *, soft, friction):
    """Two contacts with two tangents each on five modes, one of them rigid."""
    rng = np.random.default_rng(12)
    half = 0.03 * rng.standard_normal((6, 6))
    body = ct.ModalBody(
        omega=[5.0, 9.0, 14.0, 20.0, 0.0], zeta=[0.02, 0.01, 0.03, 0.01, 0.0],
        channels=("n1", "s1", "t1", "n2", "s2", "t2"), rows=rng.standard_normal((6, 5)),
        S=half @ half.T if soft else np.zeros((6, 6)),
    )  # fmt: skip
    more = {"tangent": (("s1", "t1"), ("s2", "t2")), "slide": [[0.3, -0.1], [0.0, 0.2]]} if friction else {}
    return ct.Patch(
        body=body, normal=("n1", "n2"), load=-8.0 * body.rows[0] - 5.0 * body.rows[3], clearance=[0.1, 0.12],
        velocity=[0.4, -0.5, 0.6, 0.3, 0.2], **more,
    )  # fmt: skip


def obeys(force, motion, mu):
    """How far forces and motions of contacts are from Coulomb's law, as motions for unit compliance."""
    worst = 0.0
    for f, u in zip(force.reshape(2, -1), motion.reshape(2, -1), strict=True):
        worst = max(worst, abs(min(f[0], u[0])))
        if f.size > 1:
            aim = f[1:] - u[1:]
            length = np.linalg.norm(aim)
            held = aim * min(1.0, mu * f[0] / length) if length > 0.0 else aim
            worst = max(worst, np.abs(f[1:] - held).max())
    return worst


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("soft", [False, True])
def test_contacts_of_a_body_obey_the_law_and_take_from_it_what_the_ledger_states(soft, mu):
    with plain() as module:
        ct, record = module("contact"), module("contact.record.record")
        problem = patch(ct, soft=soft, friction=mu > 0.0)
        law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
        run = ct.ExactModal().prepare(problem, law, dt=H, courant=None)
        out = record.samples(record.Record(every=1, state_every=1), STEPS, 2, 5)
        s, sums, seen, forces = run.state, run.sums, [], []
        begin = (s.q.copy(), s.d.copy(), s.now.copy(), s.lam.copy())
        for n in range(STEPS):
            assert run.advance(out, n, 1) == -1
            seen.append((s.q.copy(), s.d.copy(), s.now.copy(), s.lam.copy()))
            forces.append(s.force.copy())
    rows, dim, S, slide = run.steady.rows[:, :5], s.lam.size // 2, run.rows.still, -run.rows.glide / H
    normal, tangents = slice(None, None, dim), [k for k in range(2 * dim) if k % dim]
    work, friction, damping, touched, gaps = np.zeros(2), np.zeros(2), 0.0, np.zeros(2), []
    solved, before = 0, begin
    for n in range(STEPS):
        (q, D, place, lam), (q0, d_old, place0, lam0) = seen[n], before
        free = s.al * d_old - s.be * q0 + s.kick
        solved += bool((place0 + (rows @ free)[normal] < 0.0).any() or (lam0[normal] > 0.0).any())
        np.testing.assert_allclose(D, free + s.c * (rows.T @ lam), rtol=0.0, atol=1e-13)
        np.testing.assert_allclose(q, q0 + D, rtol=0.0, atol=1e-13)
        np.testing.assert_allclose(place, [0.1, 0.12] + rows[normal] @ q, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(out.state[n], q0, rtol=0.0, atol=1e-14)
        moved = rows @ D + S @ lam
        moved[normal] += place0
        moved[tangents] -= H * slide[tangents] + (S @ lam0)[tangents]
        scale = np.diag(rows @ np.diag(s.c) @ rows.T + S)
        assert obeys(lam * scale.max(), moved, mu) <= 1e-10
        both = 0.5 * rows @ (d_old + D)
        strained = lam * (S @ (lam - lam0))  # along the tangents S takes up what friction does on the body
        own = [[k for k in tangents if k // dim == i] for i in range(2)]
        work += (lam * both)[normal] - [strained[k].sum() for k in own]
        friction += [(lam * both + strained)[k].sum() for k in own]
        damping -= np.sum((1.0 - s.al) / (2.0 * s.c) * d_old * (d_old + D))
        gap = np.where(lam[normal] > 0.0, 0.0, place + (S @ lam)[normal])
        np.testing.assert_allclose(out.gap[n], gap, rtol=0.0, atol=1e-12)
        np.testing.assert_array_equal(out.force[n], lam[normal])
        touched += lam[normal] > 0.0
        gaps.append(gap)
        before = seen[n]
    assert touched.min() > 5
    assert (STEPS - touched).min() > 5
    np.testing.assert_allclose(sums.work, work, rtol=1e-9, atol=1e-13)
    np.testing.assert_allclose(sums.friction, friction, rtol=1e-9, atol=1e-13)
    assert sums.damping[0] == pytest.approx(damping, rel=1e-9)
    assert sums.contact_steps.tolist() == touched.tolist()
    np.testing.assert_allclose(sums.impulse, H * np.sum(forces, axis=0), rtol=1e-12)
    most, total, steps, fault = s.counts
    assert steps == solved
    assert 1 <= most <= total
    assert fault == 0.0
    assert (friction.any()) == (mu > 0.0)


def test_a_body_wedged_between_contacts_has_no_motion_and_one_beyond_numbers_fails():
    with plain() as module:
        ct, record = module("contact"), module("contact.record.record")
        body = ct.ModalBody(
            omega=[3.0], zeta=[0.0], channels=("up", "down"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2))
        )  # fmt: skip
        wedged = ct.Patch(body=body, normal=("up", "down"), clearance=[0.1, 0.1], velocity=[0.1])
        run = ct.ExactModal().prepare(wedged, ct.Unilateral(), dt=H, courant=None)
        run.state.q[0], run.rows.clearance[:] = 0.0, -0.1
        out = record.samples(record.Record(), 3, 2, 1)
        assert run.advance(out, 5, 3) == 5
        assert run.state.counts[3] == 1.0
        assert "no motion opens all gaps" in run.why()
        run.state.counts[3], run.state.q[0] = 0.0, math.nan
        assert run.advance(out, 7, 3) == 7
