"""Runs of several contacts of one body against the exact motion of its modes and Coulomb's law; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 0.01, 120
OMEGA, ZETA = np.array([5.0, 9.0, 14.0, 20.0, 0.0]), np.array([0.02, 0.01, 0.03, 0.01, 0.0])
CLEARANCE, SLIDE = np.array([0.1, 0.12]), np.array([[0.3, -0.1], [0.0, 0.2]])


def patch(ct, *, soft, friction):
    """Two contacts with two tangents each on five modes, one of them rigid."""
    rng = np.random.default_rng(12)
    half = 0.03 * rng.standard_normal((6, 6))
    body = ct.ModalBody(
        omega=OMEGA, zeta=ZETA, channels=("n1", "s1", "t1", "n2", "s2", "t2"), rows=rng.standard_normal((6, 5)),
        S=half @ half.T if soft else np.zeros((6, 6)),
    )  # fmt: skip
    more = {"tangent": (("s1", "t1"), ("s2", "t2")), "slide": SLIDE} if friction else {}
    return ct.Patch(
        body=body, normal=("n1", "n2"), load=-8.0 * body.rows[0] - 5.0 * body.rows[3], clearance=CLEARANCE,
        velocity=[0.4, -0.5, 0.6, 0.3, 0.2], **more,
    )  # fmt: skip


def one_step():
    """Coefficients of q_{n+1} = q_n + al (q_n - q_{n-1}) - be q_n + c f, exact for each mode and a constant force f."""
    fade, turn = np.exp(-ZETA * OMEGA * H), OMEGA * H * np.sqrt(1.0 - ZETA**2)
    be = 1.0 - 2.0 * fade * np.cos(turn) + fade**2
    return fade**2, be, np.where(OMEGA > 0.0, be / np.where(OMEGA > 0.0, OMEGA, 1.0) ** 2, H**2)


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
        ct = module("contact")
        problem = patch(ct, soft=soft, friction=mu > 0.0)
        law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
        early, late, found = (
            ct.run(problem, law=law, scheme=ct.ExactModal(), dt=H, t_end=(n - 0.5) * H, record=ct.Record(state_every=1))
            for n in (2, STEPS - 1, STEPS)
        )
    al, be, c = one_step()
    dim = 3 if mu else 1
    used = [0, 1, 2, 3, 4, 5] if mu else [0, 3]
    rows, S = problem.body.rows[used], problem.body.S[np.ix_(used, used)]
    normal, tangents = list(range(0, 2 * dim, dim)), [k for k in range(2 * dim) if k % dim]
    kick = c * problem.load
    work, friction, damping, lam0 = 0.0, 0.0, 0.0, np.zeros(2 * dim)
    for n in range(1, STEPS - 1):
        before, q, after = found.state[n - 1 : n + 2]
        d_old, D, lam = q - before, after - q, np.zeros(2 * dim)
        push = D - (al * d_old - be * q + kick)  # of the contacts
        lam[normal] = found.force[n]
        if mu:
            lam[tangents] = np.linalg.lstsq(rows[tangents].T, push / c - lam[normal] @ rows[normal], rcond=None)[0]
        np.testing.assert_allclose(push, c * (rows.T @ lam), rtol=0.0, atol=1e-13)
        place = CLEARANCE + rows[normal] @ after
        moved = rows @ D + S @ lam
        moved[normal] += CLEARANCE + rows[normal] @ q
        if mu:
            moved[tangents] -= H * SLIDE.ravel() + (S @ lam0)[tangents]
        scale = np.diag(rows @ np.diag(c) @ rows.T + S)
        assert n == 1 or obeys(lam * scale.max(), moved, mu) <= 1e-10
        gap = np.where(lam[normal] > 0.0, 0.0, place + (S @ lam)[normal])
        np.testing.assert_allclose(found.gap[n], gap, rtol=0.0, atol=1e-12)
        if n > 1:
            both = 0.5 * rows @ (d_old + D)
            strained = (lam * (S @ (lam - lam0)))[tangents].sum()  # S takes up what friction does on the body
            work += (lam * both)[normal].sum() - strained
            friction += (lam * both)[tangents].sum() + strained
            damping -= np.sum((1.0 - al) / (2.0 * c) * d_old * (d_old + D))
        lam0 = lam
    touched = (found.force > 0.0).sum(axis=0)
    assert touched.min() > 5
    assert (STEPS - touched).min() > 5
    budget = late.energy.since(early.energy)
    assert budget.contact == pytest.approx(work, rel=1e-9)
    assert budget.friction == pytest.approx(friction, rel=1e-9)
    assert budget.damping == pytest.approx(damping, rel=1e-9)
    assert abs(late.energy.unaccounted) < 1e-12 * late.energy.scale
    assert (friction != 0.0) == (mu > 0.0)
    assert found.contact_steps.tolist() == touched.tolist()
    np.testing.assert_allclose(found.impulse, H * found.force.sum(axis=0), rtol=1e-12)


def test_a_casing_wedged_between_rigid_blades_has_no_motion():
    with plain() as module:
        ct = module("contact")
        casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=1, freq_hz=50.0, modal_mass=1.5), radius=0.5)
        blade = ct.ModalBody(
            omega=[100.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.0], [1.0]], S=np.zeros((2, 2))
        )
        opposite = (ct.ContactPoint(), ct.ContactPoint(blade=1, angle_deg=180.0))
        wedged = ct.Rub(casing, (blade, blade), opposite, clearance=-1e-4, speed=ct.Speed.constant(1.0))
        with pytest.raises(ct.NumericsError, match="a tip jams") as stop:
            ct.run(wedged, t_end=0.1, dt=1e-4)
    assert stop.value.result.steps == 0
