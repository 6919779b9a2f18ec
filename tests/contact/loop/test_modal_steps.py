"""Exact-modal step loops against the same steps in whole arrays, and against what energy they leave."""

import math

import numpy as np
import pytest

from tests.contact.plain import names

N = names("contact.loop.modal.modal", "contact.record.record")
ENERGY = names("contact.loop.modal.modal")
STICK = names("contact.loop.tally")
H = 0.02


def books(contacts, size, steps, **every):
    """Empty sums, and samples of every step."""
    record = N.Record(**({"every": 1, "state_every": 1} | every))
    return N.tally(contacts), N.samples(record, steps, contacts, size)


def modes(m, seed=1):
    """Frequencies, damping, and the exact map of one step: al, be, c."""
    rng = np.random.default_rng(seed)
    omega, zeta = rng.uniform(2.0, 30.0, m), rng.uniform(0.0, 0.05, m)
    fade, turn = np.exp(-zeta * omega * H), omega * H * np.sqrt(1.0 - zeta**2)
    al = fade**2
    return rng, al, 1.0 - 2.0 * fade * np.cos(turn) + al, np.sin(turn) * H / omega * fade


@pytest.mark.parametrize("averaged", [False, True])
@pytest.mark.parametrize(("m", "steps"), [(3, 41), (11, 40), (16, 41)])
def test_a_fixed_contact_point_takes_its_forces_from_the_gap_ahead(averaged, m, steps):
    rng, al, be, c = modes(m)
    Q, weight = rng.standard_normal(m), (1.0 - al) / (2.0 * c)
    kick = c * (rng.standard_normal(m) - 6.0 * Q / (Q @ Q))
    q, D, S, clearance = 0.02 * rng.standard_normal(m), 0.01 * rng.standard_normal(m), 2e-4, 0.01
    now, last = clearance + Q @ q, clearance + Q @ (q - D)
    s = N.ModalState(
        q=q.copy(), d=D.copy(), old=np.zeros(m), al=al, be=be, c=c, kick=kick, weight=weight,
        memory=np.array([now, last, 0.0]), force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip
    sums, out = books(1, m, steps)
    share = 0.25 if averaged else 1.0
    yields = c @ Q**2
    forces, gaps, states, lines, work, damping, nearest = [], [], [], [], 0.0, 0.0, 1.0
    for n in range(steps):
        states.append(q.copy())
        new = al * D - be * q + kick
        free = clearance + Q @ (q + new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        nearest = min(nearest, abs(test))
        force = max(-test, 0.0) / (share * yields + S)
        new = new + c * Q * force
        after = free + yields * force
        work += 0.5 * force * (after - last)
        damping -= np.sum(weight * D * (D + new))
        lines.append((n * H, now, free))
        q, D, last, now = q + new, new, now, after
        forces.append(force)
        gaps.append(test + (share * yields + S) * force)
    assert 2 <= np.count_nonzero(forces) < steps - 2
    assert nearest > 1e-9  # no sign of a gap is round-off
    assert N.advance_modal(s, Q, clearance, S, averaged, True, None, sums, out, H, 0, steps) == -1
    np.testing.assert_allclose(out.force[:steps, 0], forces, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(out.gap[:steps, 0], gaps, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(out.state[:steps], states, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose([s.q, s.d], [q, D], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(s.memory, [now, last, forces[-1]], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose([sums.work[0], sums.damping[0]], [work, damping], rtol=1e-9)
    np.testing.assert_allclose(out.time[:steps], H * np.arange(steps))
    assert sums.residual[0] <= 1e-13
    assert sums.penetration[0] == pytest.approx(max(0.0, -min(gaps)), abs=1e-11)
    closings = [k for k in range(steps) if forces[k] > 0.0 and not (k and forces[k - 1] > 0.0)]
    found = out.event_time[: sums.filled[2]][out.event_kind[: sums.filled[2]] == 1]
    at = []
    for k in closings:
        began, before, ahead = lines[k]
        part = before / (before - ahead) if before > 0.0 and before > ahead else 0.0
        at.append(began + min(part, 1.0) * H)
    np.testing.assert_allclose(found, at, atol=1e-9)
    opened = [k for k in range(1, steps) if forces[k - 1] > 0.0 and not forces[k] > 0.0]
    found = out.event_time[: sums.filled[2]][out.event_kind[: sums.filled[2]] == 0]
    np.testing.assert_allclose(found, [(k - 0.5) * H for k in opened], atol=1e-14)


def test_a_contact_that_no_force_opens_ends_the_run_and_damping_counts_where_asked_for():
    _, al, be, c = modes(3)
    Q, zero = np.array([1.0, -0.5, 0.7]), np.zeros(3)

    def state(q):
        return N.ModalState(
            q=np.array(q), d=np.full(3, 0.1), old=zero.copy(), al=al, be=be, c=c, kick=zero,
            weight=(1.0 - al) / (2.0 * c), memory=np.zeros(3), force=np.zeros(1), gap=np.zeros(1),
        )  # fmt: skip

    def advanced(q, S, *, damped=False, clearance=0.0):
        sums, out = books(1, 3, 4)
        return N.advance_modal(state(q), Q, clearance, S, False, damped, None, sums, out, H, 0, 4), sums.damping[0]

    assert advanced([-1.0, 0.0, 0.0], -1.0)[0] == 0
    assert advanced([np.nan, 0.0, 0.0], 0.0)[0] == 0
    assert advanced([0.1, 0.0, 0.0], -1.0, clearance=9.0) == (-1, 0.0)
    assert advanced([0.1, 0.0, 0.0], -1.0, damped=True, clearance=9.0)[1] < 0.0


@pytest.mark.parametrize(
    ("now", "free"), [(0.3, -0.2), (-0.1, -0.4), (-0.1, 0.02), (-0.3, 0.2), (0.0, -0.1), (-0.2, -0.2)]
)
def test_the_gap_after_a_step_is_that_of_the_discrete_gradient(now, free):
    b, S = 0.03, 0.2
    x = ENERGY.next_gap(b, S, now, free)

    def phi(g):
        return min(g, 0.0) ** 2 / (2.0 * S)

    force = max(-x, 0.0) / S if abs(x - now) < 1e-14 else -(phi(x) - phi(now)) / (x - now)
    assert (x - free) / b == pytest.approx(force, abs=1e-12)
    assert x >= free


@pytest.mark.parametrize("steps", [60])
def test_a_force_of_the_discrete_gradient_takes_no_energy(steps):
    rng, m = np.random.default_rng(5), 4
    omega, S, clearance = np.array([2.0, 7.0, 11.0, 17.0]), 3e-3, 0.02
    turn = omega * H
    Q, load = np.array([1.0, -0.6, 0.4, 0.3]), np.array([-0.3, 0.2, 0.1, 0.0])
    lift, drift = (1.0 - np.cos(turn)) / omega**2, np.sin(turn) / omega
    q, v = 0.02 * rng.standard_normal(m), np.array([-0.5, 0.4, 0.1, -0.2])
    now = clearance + Q @ q
    s = ENERGY.EnergyState(
        q=q.copy(), v=v.copy(), cos=np.cos(turn), drift=drift, pull=-omega * np.sin(turn), lift=lift, load=load,
        memory=np.array([now, 0.0]), force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip
    sums, out = books(1, m, steps)
    b = lift @ Q**2
    assert now > 0.0
    assert ENERGY.advance_energy(s, Q, clearance, S, b, sums, out, H, 0, steps) == -1
    force, elastic, lines = out.force[:steps, 0], [now], []
    for n in range(steps):  # a constant force over each step is exact for the modes
        np.testing.assert_allclose(out.state[n], q, rtol=0.0, atol=1e-13)
        f = load + Q * force[n]
        free = clearance + Q @ (np.cos(turn) * q + drift * v + lift * load)
        q, v = np.cos(turn) * q + drift * v + lift * f, -omega * np.sin(turn) * q + np.cos(turn) * v + drift * f
        lines.append(free)
        elastic.append(clearance + Q @ q)
    np.testing.assert_allclose([s.q, s.v], [q, v], rtol=0.0, atol=1e-12)
    elastic = np.array(elastic)
    phi = np.minimum(elastic, 0.0) ** 2 / (2.0 * S)
    np.testing.assert_allclose(force * np.diff(elastic), -np.diff(phi), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(out.gap[:steps, 0], 0.5 * (elastic[1:] + elastic[:-1]) + S * force, rtol=0.0, atol=1e-13)
    assert 4 < (force > 0.0).sum() < steps - 4
    assert sums.work[0] == pytest.approx(phi[0] - phi[-1], abs=1e-13)
    assert s.memory[0] == pytest.approx(elastic[-1], abs=1e-13)
    assert sums.impulse[0] == pytest.approx(H * force.sum(), rel=1e-12)
    np.testing.assert_allclose(out.time[:steps], H * (np.arange(steps) + 0.5), rtol=1e-13)
    slack = np.abs(np.minimum(force * (b + S), out.gap[:steps, 0])).max()
    assert sums.residual[0] == pytest.approx(slack, rel=1e-9)
    first = int(np.argmax(force > 0.0))
    assert out.event_time[0] == pytest.approx(
        first * H + H * min(1.0, elastic[first] / (elastic[first] - elastic[first + 1])), abs=1e-12
    )
    s.q[0] = np.nan
    assert ENERGY.advance_energy(s, Q, clearance, S, b, sums, out, H, 7, 2) == 7


def sticking(k, dim):
    return STICK.Sticking(slip=np.zeros((2, k * dim)), hold=np.zeros(k), pressed=np.zeros(k), since=np.zeros(k))


def noted(past, sums, out, time, lam, slip, W):
    """One step of contact 2 of 2 with this slip; returns the last event, or None where there is no new one."""
    before = sums.filled[2]
    STICK.note_sticking(past, sums, out, 1, time, H, 0.5, W, np.array(lam), np.array(slip))
    return (
        (out.event_kind[before], out.event_time[before], out.event_contact[before]) if sums.filled[2] > before else None
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_sticking_begins_where_the_slip_continued_is_zero_and_ends_where_the_holding_force_leaves_the_cone(dim):
    W = np.diag(np.linspace(1.0, 2.0, 2 * dim)) + 0.1
    past, (sums, out) = sticking(2, dim), books(2, 1, 9)
    to = np.array([0.6, 0.8][: dim - 1]) if dim == 3 else np.ones(1)

    def step(time, normal, drag, slip):
        lam = np.concatenate([np.zeros(dim), [normal], -drag * to])
        return noted(past, sums, out, time, lam, np.concatenate([np.zeros(dim + 1), slip * to]), W)

    assert step(0.1, 4.0, 2.0, 0.05) is None  # slips
    assert step(0.2, 4.0, 2.0, 0.02) is None
    kind, time, contact = step(0.3, 4.0, 1.2, 0.0)
    assert (kind, contact) == (3, 1)
    assert time == pytest.approx(0.3 + H * (0.02 / 0.03 - 0.5), rel=1e-12)
    assert past.since[1] == time
    assert step(0.4, 4.0, 1.7, 0.0) is None
    held = 1.7 / 2.0
    assert past.hold[1] == pytest.approx(held, rel=1e-12)
    assert past.pressed[1] == 4.0
    kind, time, contact = step(0.5, 4.0, 2.0, 0.3)
    block = W[dim + 1 :, dim + 1 :]
    hold = np.linalg.norm(-2.0 * to - np.linalg.solve(block, 0.3 * to)) / 2.0
    assert (kind, contact) == (2, 1)
    assert time == pytest.approx(0.5 + H * ((1.0 - held) / (hold - held) - 1.0), rel=1e-12)
    np.testing.assert_allclose(past.slip[0, dim + 1 :], 0.3 * to, atol=1e-14)


def test_a_contact_that_opens_ends_its_sticking_half_a_step_before():
    past, (sums, out), W = sticking(2, 2), books(2, 1, 9), np.eye(4)
    assert noted(past, sums, out, 0.1, [0.0, 0.0, 3.0, 0.2], [0.0] * 4, W)[:2] == (3, 0.1)  # it pressed not before
    kind, time, _ = noted(past, sums, out, 0.2, [0.0] * 4, [0.0, 0.0, 0.0, 0.4], W)
    assert (kind, time) == (2, 0.2 - 0.5 * H)
    assert past.hold[1] == math.inf
    assert noted(past, sums, out, 0.3, [0.0] * 4, [0.0, 0.0, 0.0, 0.4], W) is None


def test_a_contact_at_the_edge_of_its_cone_slips():
    past, (sums, out), W = sticking(2, 2), books(2, 1, 9), np.eye(4)
    assert noted(past, sums, out, 0.1, [0.0, 0.0, 3.0, -1.5 * (1.0 - 0.5e-9)], [0.0] * 4, W) is None
    assert noted(past, sums, out, 0.1, [0.0, 0.0, 3.0, 1.5 * (1.0 - 2e-9)], [0.0] * 4, W)[0] == 3
