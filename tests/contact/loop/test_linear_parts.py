"""What linear step loops share: products and solves of every form of storage, sums, events, what is stored when."""

import math

import numpy as np
import pytest

from tests.contact.plain import names, plain

N = names("loop.linear.linear", "loop.tally", "record.record", "loop.linear.leapfrog")
BAND = names("model.bodies.band")


def matrix(width, n=7, seed=2):
    """Symmetric positive definite, with entries up to `width` beside the diagonal, not all of them."""
    A = np.random.default_rng(seed).uniform(-1.0, 1.0, (n, n))
    A = np.where(np.abs(np.subtract.outer(np.arange(n), np.arange(n))) <= width, A + A.T, 0.0)
    return A + np.diag(2.0 * np.abs(A).sum(axis=1))


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize("width", [0, 1, 2, 4])
def test_products_and_solves_are_those_of_whole_matrices(width, wide):
    A, x = matrix(width), np.random.default_rng(1).standard_normal(7)
    packed = BAND.band(A, np.arange(7), wide=wide)
    out, work = np.arange(7.0), np.full(7 + 4, 9.0)
    N.add_product(packed, -1.5, x, out, work)
    np.testing.assert_allclose(out, np.arange(7.0) - 1.5 * A @ x, rtol=1e-12)
    solved = x.copy()
    N.solve_in_place(BAND.factor(packed, "A"), solved)
    np.testing.assert_allclose(solved, np.linalg.solve(A, x), rtol=1e-12)


@pytest.mark.parametrize("wide", [False, True])
def test_springs_without_ground_are_not_strained_by_a_translation(wide):
    A = matrix(2)
    A = A - np.diag(A.sum(axis=1))
    packed, out = BAND.band(A, np.arange(7), wide=wide), np.zeros(7)
    assert not packed.grounded
    N.add_product(packed, 2.0, np.full(7, 1e9), out, np.zeros(9))
    assert not out.any()
    N.add_product(packed, 2.0, np.arange(7.0), out, np.zeros(9))
    np.testing.assert_allclose(out, 2.0 * A @ np.arange(7.0), rtol=1e-12, atol=1e-12)


def test_what_is_tiny_is_set_to_zero_with_either_sign():
    x = np.array([1e-151, -1e-151, 1e-149, -1e-149, 0.5])
    N.flush(x)
    assert x.tolist() == [0.0, 0.0, 1e-149, -1e-149, 0.5]


@pytest.mark.parametrize(
    ("before", "predicted", "at"),
    [
        (0.3, -0.1, 2.0 + 0.75 * 0.5), (0.3, 0.1, 2.5), (0.3, 0.3, 2.0), (0.3, 0.4, 2.0), (0.0, -0.1, 2.0),
        (-0.1, -0.2, 2.0), (0.3, 0.0, 2.5),
    ],
)  # fmt: skip
def test_a_contact_closes_where_the_line_between_gaps_is_zero_within_the_step(before, predicted, at):
    assert N.closing(0.5, 2.0, before, predicted) == pytest.approx(at, rel=1e-15)
    assert N.closing(0.5, -0.4, -0.1, -0.2) == 0.0  # a run may begin closed


def books(contacts, steps, size=2, **record):
    return N.tally(contacts), N.samples(N.Record(**record), steps, contacts, size)


def test_sums_and_events_of_one_contact_among_others():
    sums, out = books(3, 8)
    for force, gap, slack, began in (
        (0.0, 0.2, 0.0, 1.0), (5.0, -0.01, 0.03, 1.5), (3.0, -0.04, 0.02, 2.0), (0.0, 0.1, 0.01, 2.5),
    ):  # fmt: skip
        N.note_step(sums, out, 1, 0.5, force, gap, slack, began, 0.3, -0.1, began + 0.1)
    assert sums.impulse.tolist() == [0.0, 4.0, 0.0]
    assert sums.peak.tolist() == [0.0, 5.0, 0.0]
    assert sums.contact_steps.tolist() == [0, 2, 0]
    assert sums.penetration.tolist() == [0.0, 0.04, 0.0]
    assert sums.residual.tolist() == [0.0, 0.03, 0.0]
    assert sums.closed.tolist() == [0, 0, 0]
    assert sums.filled.tolist() == [0, 0, 2]
    assert out.event_contact[:2].tolist() == [1, 1]
    assert out.event_kind[:2].tolist() == [1, 0]
    assert out.event_time[:2].tolist() == [1.875, 2.6]
    N.note_contact(sums, out, 2, 0.5, 4.0, 6.0, 0.5, 0.02, 0.4, -0.4)
    N.note_contact(sums, out, 2, 0.5, 4.5, 0.0, 0.5, 0.02, 0.4, 0.6)
    assert sums.residual[2] == 0.12
    assert out.event_time[2:4].tolist() == [4.25, 4.25]
    N.note_stick(sums, out, 0, 0, 5.0)
    assert sums.filled[2] == 4
    N.note_stick(sums, out, 0, 1, 5.0)
    N.note_stick(sums, out, 0, 1, 6.0)
    N.note_stick(sums, out, 0, 0, 7.0)
    assert out.event_kind[4:6].tolist() == [3, 2]
    assert (out.event_time[4:6].tolist(), sums.filled[2], sums.stuck[0]) == ([5.0, 7.0], 6, 0)


def stored(record, steps=13):
    """Times of what a run of so many steps stores, and of its states."""
    kept = N.Record(**record)
    sums, out = N.tally(2), N.samples(kept, steps, 2, 3, kept.steps(dt=1.0, count=steps))
    for step in range(steps):
        sums.impulse[:] = [step, 2.0 * step]
        N.store_state(sums, out, step, float(step), np.array([step, 10.0 * step, -1.0]))
        N.store(sums, out, step, float(step), np.array([step, 0.5]), np.array([0.1, step]))
    rows, states = sums.filled[:2]
    return out, out.time[:rows].tolist(), out.state_time[:states].tolist()


def test_every_so_many_steps_are_stored_or_those_asked_for():
    assert stored({"every": 4})[1:] == ([0.0, 4.0, 8.0, 12.0], [])
    assert stored({"every": 3, "state_every": 6})[1:] == ([0.0, 3.0, 6.0, 9.0, 12.0], [0.0, 6.0, 12.0])
    assert stored({"at": [2.2, 7.0]})[1:] == ([2.0, 7.0], [2.0, 7.0])
    out = stored({"every": 3, "state_every": 6})[0]
    assert out.force[2].tolist() == [6.0, 0.5]
    assert out.gap[2].tolist() == [0.1, 6.0]
    assert out.impulse[2].tolist() == [6.0, 12.0]
    assert out.state[1].tolist() == [6.0, 60.0, -1.0]
    out = stored({"at": [2.2, 7.0], "channels": [[1.0, -0.5, 2.0], [0.0, 1.0, 0.0]]})[0]
    assert out.state[1].tolist() == [7.0 - 35.0 - 2.0, 70.0]


@pytest.mark.parametrize(
    ("rule", "held"), [(0, 0.2 - 0.5), (1, math.inf), (2, 0.2 + (-0.5 - 0.25 * 0.1) / 1.25), (3, 0.2)]
)
def test_each_rule_holds_its_own_gap(rule, held):
    assert N.law_gap(rule, 0.25, 0.2, 0.1, -0.5) == pytest.approx(held, rel=1e-15)
    closed = {1: -0.5 + 0.25 * 0.1}.get(rule)
    if closed is not None:
        assert N.law_gap(rule, 0.25, 0.0, 0.1, -0.5) == N.law_gap(rule, 0.25, -0.2, 0.1, -0.5) == closed


def test_massless_ends_of_two_rods_rest_on_their_springs_and_the_others_leap():
    """A chain held at the left whose end meets a wall: the end's coordinate follows from the rest, exactly."""
    h, steps = 0.02, 120
    K = np.array([[70.0, -30.0, 0.0], [-30.0, 50.0, -20.0], [0.0, -20.0, 20.0]])
    C, mass = np.array([0.3, 0.2, 0.1]), np.array([1.0, 1.5, 0.4])
    load, shape = np.array([0.5, 0.0, 1.0]), np.array([1.0, 0.0, 2.0])
    Q, gap0 = np.array([[0.0, 0.0, -1.0]]), np.array([0.05])
    with plain() as module:
        ct, record = module("contact"), module("contact.record.record")
        forcing = (ct.bodies.Forcing(shape=shape, amplitude=lambda t: 1.5 * np.cos(3.0 * t)),)
        body = ct.LinearBody(
            M=mass, K=K, C=C, Q=Q, gap0=gap0, load=load, forcing=forcing, velocity=np.array([0.2, 0.5, 1.0])
        )  # fmt: skip
        run = ct.scheme.MasslessBoundary().prepare(body, ct.Unilateral(), dt=h, courant=None)
        order = run.system.order
        u, D, force = np.empty(3), np.empty(3), run.state.force[0]
        u[order], D[order] = run.state.u, run.state.v
        out = record.samples(record.Record(every=1, state_every=1), steps, 1, 3)
        assert run.advance(out, 0, steps) == -1
    mass, C = np.array([1.0, 1.9, 0.0]), np.array([0.3, 0.3, 0.0])  # the end's goes to what it is sprung to
    v = np.array([0.2, 0.5, 1.0])  # the sums leave out the work of the half step before t = 0
    work, damping, external = 0.0, 0.5 * h * v @ (C * v), -0.5 * h * 1.5 * shape @ v
    for n in range(steps):
        np.testing.assert_allclose(out.state[n], u, atol=1e-12)
        assert out.force[n, 0] == pytest.approx(force, abs=1e-10)
        assert out.gap[n, 0] == pytest.approx(gap0[0] - u[2], abs=1e-12)
        f = load + 1.5 * np.cos(3.0 * n * h) * shape
        pull = f - K @ u - C * D / h
        d = np.zeros(3)
        d[:2] = D[:2] + (pull / (mass / h**2 + 0.5 * C / h + [0.0, 0.0, 1.0]))[:2]
        new = u + d
        ahead = load[2] + 1.5 * np.cos(3.0 * (n + 1) * h) * shape[2]
        new[2] = min((ahead + 20.0 * new[1]) / 20.0, gap0[0])
        after = max(ahead + 20.0 * new[1] - 20.0 * new[2], 0.0) if new[2] == gap0[0] else 0.0
        mean = 0.5 * (D + new - u)
        work -= force * mean[2]
        damping -= mean @ (C * mean) / h
        external += 1.5 * np.cos(3.0 * n * h) * shape @ mean
        u, D, force = new, new - u, after
    assert 10 < (out.force[:steps] > 0.0).sum() < steps - 10
    np.testing.assert_allclose(
        [run.sums.work[0], run.sums.damping[0], run.sums.external[0]], [work, damping, external], rtol=1e-9, atol=1e-12
    )
    np.testing.assert_allclose(run.sums.impulse[0], h * out.force[:steps].sum(), rtol=1e-12)
    np.testing.assert_allclose(out.time[:steps], h * np.arange(steps), rtol=1e-13)
    assert run.sums.residual[0] <= 1e-13
    assert run.sums.contact_steps[0] == (out.force[:steps] > 0.0).sum()
