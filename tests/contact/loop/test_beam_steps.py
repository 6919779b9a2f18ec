"""Step loops of a beam in a circle: forces against energies, steps against their equations."""

import math

import numpy as np
import pytest

from tests.contact.plain import names

N = names("contact.loop.beam.beam", "contact.record.record")
IMPLICIT = names("contact.loop.beam.implicit")
H, REST, EA, EI = 0.01, 0.5, 40.0, 0.7


def bent(n=4, seed=3):
    """Nodes of a bent and stretched beam."""
    rng = np.random.default_rng(seed)
    x = np.stack([REST * np.arange(n), np.zeros(n), np.zeros(n)], axis=1)
    return x + 0.08 * rng.standard_normal((n, 3)) + [0.0, 0.0, 0.2]


def energy(x):
    """Strain energy by lengths and by angles between chords and ends."""
    total = 0.0
    for e in range(len(x) - 1):
        d = x[e + 1, :2] - x[e, :2]
        chord, length = math.atan2(d[1], d[0]), math.hypot(*d)
        a = math.remainder(x[e, 2] - chord, 2.0 * math.pi)
        b = a + x[e + 1, 2] - x[e, 2]
        stretch = (d @ d - REST**2) / (length + REST)
        total += 0.5 * EA / REST * stretch**2 + EI / REST * 2.0 * (a * a + a * b + b * b)
    return total


def slope(f, x, step=1e-6):
    """Central differences of f by every entry of x."""
    found = []
    for i in np.ndindex(x.shape):
        ahead, back = x.copy(), x.copy()
        ahead[i] += step
        back[i] -= step
        found.append((f(ahead) - f(back)) / (2.0 * step))
    return np.array(found)


def inner_force(x):
    out = np.full(x.shape, 7.0)
    N.strain_energy_and_forces(x, REST, EA, EI, out)
    return out


@pytest.mark.parametrize("turned", [0.0, 2.5, -3.0])
def test_forces_and_stiffness_of_elements_are_the_slopes_of_their_energy(turned):
    x, c, s = bent(), math.cos(turned), math.sin(turned)
    x = np.stack([c * x[:, 0] - s * x[:, 1], s * x[:, 0] + c * x[:, 1], x[:, 2] + turned], axis=1)
    out = np.full(x.shape, 7.0)
    assert N.strain_energy_and_forces(x, REST, EA, EI, out) == pytest.approx(energy(x), rel=1e-12)
    np.testing.assert_allclose(out.ravel(), slope(energy, x), rtol=0.0, atol=1e-7)
    tangent, work = np.zeros((12, 12)), IMPLICIT.implicit_work(4)
    IMPLICIT.add_tangent(x, REST, EA, EI, work.B, work.z, tangent)
    by_differences = np.array([row.ravel() for row in slope(inner_force, x)])
    np.testing.assert_allclose(tangent, by_differences, rtol=0.0, atol=1e-6)


def test_interface_functions_are_the_cosines_and_sines_of_the_angle():
    waves = np.zeros(7)
    N.fill_waves(waves, math.cos(0.7), math.sin(0.7))
    exact = [1.0, *np.cos(0.7 * np.arange(1, 4)), *np.sin(0.7 * np.arange(1, 4))]
    np.testing.assert_allclose(waves, exact, atol=1e-15)


def beam(m, depth=(0.02, -0.1, -0.1), *, radius=1.0, offset=0.05, seed=3):
    """State and work of a beam in a rim with m modes."""
    rng, n = np.random.default_rng(seed), 4
    x = bent(n, seed)
    x[0, :2] = 0.0
    beyond, angle = radius + np.array(depth), np.array([0.4, 1.1, 2.0])
    x[1:, :2] = np.stack([offset + beyond * np.cos(angle), beyond * np.sin(angle)], axis=1)
    top = 2
    rows = 0.3 * rng.standard_normal((2 * top + 1, m))
    half = 0.01 * rng.standard_normal((2 * top + 1, 2 * top + 1))
    rate = np.full((n, 3), 2e-4) * rng.uniform(0.8, 1.2, (n, 1))
    rate[:, 2] *= 3.0
    rate[0, :2] = 0.0
    state = N.BeamState(
        x=x, d=0.004 * rng.standard_normal((n, 3)), rate=rate, load=rng.standard_normal((n, 3)), rest=REST, EA=EA,
        EI=EI, inner=np.zeros((n, 3)), q=0.01 * rng.standard_normal(m), dq=0.002 * rng.standard_normal(m),
        al=rng.uniform(0.9, 1.0, m), be=rng.uniform(0.01, 0.1, m), c=rng.uniform(1e-4, 3e-4, m), rows=rows,
        S=half @ half.T, radius=radius, offset=offset, push=np.zeros((n, 2)), waves=np.zeros((n, 2 * top + 1)),
        phi=np.zeros((n, m)), rim=np.zeros(2 * top + 1), free=np.zeros(n), before=np.full(n - 1, 0.01),
        force=np.zeros(n - 1), gap=np.zeros(n - 1), scale=np.zeros(n - 1), ledger=np.zeros(2),
    )  # fmt: skip
    state.d[0, :2] = 0.0
    return state, N.beam_work(state)


def predicted(s):
    """Increments without contact, free gaps, directions, waves at the nodes beyond the hinge."""
    d = s.d + s.rate * (s.load - inner_force(s.x))
    dq = s.al * s.dq - s.be * s.q
    to = (s.x + d)[1:, :2] - [s.offset, 0.0]
    r = np.hypot(*to.T)
    angle = np.arctan2(to[:, 1], to[:, 0])
    waves = np.stack([np.ones(3), np.cos(angle), np.cos(2 * angle), np.sin(angle), np.sin(2 * angle)], axis=1)
    rim = waves @ (s.rows @ (s.q + dq)) if s.q.size else 0.0
    return d, dq, s.radius - r + rim, -to / r[:, None], waves


def pressed(W, gap):
    for k in range(2 ** len(gap)):
        c = np.flatnonzero([(k >> i) & 1 for i in range(len(gap))])
        force = np.zeros(len(gap))
        force[c] = np.linalg.solve(W[np.ix_(c, c)], -gap[c])
        if (force >= 0.0).all() and (np.delete(W @ force + gap, c) >= 0.0).all():
            return force
    raise AssertionError("no set")


@pytest.mark.parametrize("m", [0, 3])
@pytest.mark.parametrize(
    ("depth", "touching"), [((-0.1, -0.2, -0.1), 0), ((0.03, -0.1, -0.1), 1), ((0.03, 0.04, 0.035), 3)]
)
def test_a_step_of_a_beam_presses_on_its_rim_as_the_law_asks(m, depth, touching):
    s, w = beam(m, depth)
    d, dq, gap, push, waves = predicted(s)
    phi = waves @ s.rows
    W = np.diag(s.rate[1:, 0])
    if m:
        W = W + phi @ np.diag(s.c) @ phi.T + waves @ s.S @ waves.T
    force = pressed(W, gap)
    assert (force > 0.0).sum() == touching
    x, q, old, old_q = s.x.copy(), s.q.copy(), s.d.copy(), s.dq.copy()
    sums, out = N.tally(3), N.samples(N.Record(every=1, state_every=1), 1, 3, 12)
    assert N.advance_beam(s, w, sums, out, H, 5, 1) == -1
    np.testing.assert_allclose(s.force, force, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(s.gap, np.where(force > 0.0, 0.0, W @ force + gap), rtol=0.0, atol=1e-13)
    assert not s.gap[s.force > 0.0].any()
    d[1:, :2] += s.rate[1:, :2] * force[:, None] * push
    dq = dq + s.c * (phi.T @ force)
    np.testing.assert_allclose(s.d, d, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(s.x, x + d, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose([s.dq, s.q], [dq, q + dq], rtol=0.0, atol=1e-13)
    work = 0.5 * force * (np.sum(push * (d + old)[1:, :2], axis=1) + (phi @ (dq + old_q) if m else 0.0))
    np.testing.assert_allclose(sums.work, work, rtol=1e-9, atol=1e-15)
    moment = np.sum(force * (x[1:, 0] * push[:, 1] - x[1:, 1] * push[:, 0]))
    np.testing.assert_allclose(s.ledger, [0.5 * np.sum(inner_force(x) * (d + old)), moment], rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(out.state[0], x.ravel())
    np.testing.assert_array_equal(s.before, s.gap)
    assert out.time[0] == out.state_time[0] == 5 * H
    assert sums.filled[2] == touching
    for row in range(touching):
        k = out.event_contact[row]
        part = min(0.01 / (0.01 - gap[k]), 1.0)
        assert out.event_time[row] == pytest.approx(H * (5 + part), rel=1e-9)


def test_a_beam_whose_forces_are_not_found_ends_its_run_at_that_step(monkeypatch):
    s, w = beam(0, (0.03, -0.1, -0.1))
    monkeypatch.setitem(N.advance_beam.__globals__, "solve_contacts", lambda *_: False)
    assert N.advance_beam(s, w, N.tally(3), N.samples(N.Record(), 3, 3, 12), H, 4, 3) == 4


def test_a_beam_that_is_nowhere_ends_its_run():
    s, w = beam(0)
    s.x[2, 1] = math.nan
    sums, out = N.tally(3), N.samples(N.Record(), 3, 3, 12)
    assert N.advance_beam(s, w, sums, out, H, 4, 3) == 4


def implicit(beta, gamma, reach):
    rng, n = np.random.default_rng(6), 4
    x = bent(n)
    x[0, :2] = 0.0
    x[1:, :2] *= reach
    mass = rng.uniform(0.5, 1.5, (n, 3))
    mass[:, 1] = mass[:, 0]
    v = 2.0 * rng.standard_normal((n, 3))
    load = rng.standard_normal((n, 3))
    a = (load - inner_force(x)) / mass
    v[0, :2], a[0, :2] = 0.0, 0.0
    gap = 1.3 - np.hypot(x[1:, 0] - 0.05, x[1:, 1])
    s = IMPLICIT.ImplicitBeam(
        x=x, v=v, a=a, mass=mass, load=load, rest=REST, EA=EA, EI=EI, beta=beta, gamma=gamma, radius=1.3, offset=0.05,
        force=np.zeros(n - 1), gap=gap, last=np.zeros(n - 1), before=gap.copy(), ledger=np.zeros(3),
    )  # fmt: skip
    return s, IMPLICIT.implicit_work(n)


@pytest.mark.slow
@pytest.mark.parametrize(("beta", "gamma"), [(0.25, 0.5), (0.4, 0.62)])
def test_implicit_steps_of_a_beam_obey_their_equations_and_keep_their_ledger(beta, gamma):
    s, w = implicit(beta, gamma, 0.86)
    sums, out = N.tally(3), N.samples(N.Record(every=1, state_every=1), 26, 3, 12)
    h, works, moment, touched, own, closings = 0.02, np.zeros(3), 0.0, 0, 0.0, []
    impulse, peak, iterations = np.zeros(3), np.zeros(3), 0.0
    closed = np.zeros(3, dtype=bool)
    for step in range(26):
        x, v, a, last, gap = s.x.copy(), s.v.copy(), s.a.copy(), s.force.copy(), s.gap.copy()
        assert IMPLICIT.advance_implicit(s, w, sums, out, h, step, 1) == -1
        np.testing.assert_allclose(s.x, x + h * v + h * h * ((0.5 - beta) * a + beta * s.a), atol=1e-12)
        np.testing.assert_allclose(s.v, v + h * ((1.0 - gamma) * a + gamma * s.a), atol=1e-12)
        assert not s.x[0, :2].any()
        to = s.x[1:, :2] - [0.05, 0.0]
        r = np.hypot(*to.T)
        push = np.zeros((4, 3))
        push[1:, :2] = -s.force[:, None] * to / r[:, None]
        left = s.mass * s.a + inner_force(s.x) - s.load - push
        left[0, :2] = 0.0
        assert np.abs(left).max() <= 2e-7
        assert (s.force >= 0.0).all()
        np.testing.assert_allclose(s.gap, np.where(s.force > 0.0, 0.0, 1.3 - r), atol=1e-10)
        assert (1.3 - r >= -1e-10).all()
        dx, old = (s.x - x)[1:, :2], x[1:, :2] - [0.05, 0.0]
        unit, unit_old = to / r[:, None], old / np.hypot(*old.T)[:, None]
        works -= 0.5 * (s.force * np.sum(unit * dx, axis=1) + last * np.sum(unit_old * dx, axis=1))
        for force, at, n in ((s.force, s.x[1:], unit), (last, x[1:], unit_old)):
            moment -= 0.5 * h * np.sum(force * (at[:, 0] * n[:, 1] - at[:, 1] * n[:, 0]))
        kinetic = 0.5 * np.sum(s.mass * (s.v**2 - v**2))
        strain = energy(s.x) - energy(x) - np.sum(s.load * (s.x - x))
        own += kinetic + strain
        for k in range(3):
            if s.force[k] > 0.0 and not closed[k]:
                ahead = 1.3 - math.hypot(x[k + 1, 0] + h * v[k + 1, 0] - 0.05, x[k + 1, 1] + h * v[k + 1, 1])
                part = min(gap[k] / (gap[k] - ahead), 1.0) if gap[k] > max(ahead, 0.0) else 0.0
                closings.append((k, 1, h * (step + part)))
            elif not s.force[k] > 0.0 and closed[k]:
                closings.append((k, 0, h * (step + 0.5)))
            closed[k] = s.force[k] > 0.0
        touched += closed.sum()
        impulse, peak = impulse + h * s.force, np.maximum(peak, s.force)
        np.testing.assert_array_equal(out.state[step], s.x.ravel())
        iterations = max(iterations, s.ledger[2] / (step + 1))
    assert touched >= 2
    np.testing.assert_allclose(sums.work, works, rtol=1e-9, atol=1e-12)
    assert s.ledger[1] == pytest.approx(moment, rel=1e-9)
    assert s.ledger[0] == pytest.approx(own - works.sum(), abs=1e-8)
    np.testing.assert_allclose(sums.impulse, impulse, rtol=1e-12)
    np.testing.assert_allclose(sums.peak, peak, rtol=1e-12)
    assert 1.0 <= iterations <= 15.0
    events = list(zip(out.event_contact, out.event_kind, out.event_time, strict=True))[: len(closings)]
    assert sums.filled.tolist() == [26, 26, len(closings)]
    for found, exact in zip(events, closings, strict=True):
        assert found[:2] == exact[:2]
        assert found[2] == pytest.approx(exact[2], abs=1e-9)
    np.testing.assert_allclose(out.time[:26], h * np.arange(1, 27), rtol=1e-13)
    np.testing.assert_allclose(out.state_time[:26], h * np.arange(1, 27), rtol=1e-13)


def test_an_implicit_step_from_nowhere_fails():
    s, w = implicit(0.25, 0.5, 0.86)
    s.v[2, 0] = math.nan
    sums, out = N.tally(3), N.samples(N.Record(), 3, 3, 12)
    assert IMPLICIT.advance_implicit(s, w, sums, out, 0.02, 4, 3) == 4
