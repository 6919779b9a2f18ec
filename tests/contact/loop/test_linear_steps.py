"""Step loops of linear problems against whole matrices, step by step, and their sums against what energy they leave."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.contact.loop.dense import GAP0, LOAD, SHAPES, U0, V0, Dense, K, Leapfrog, M, Q, amplitudes
from tests.contact.plain import plain

STEP, STEPS = 0.013, 90
NONE = np.zeros((3, 3))


def chung_hulbert(rho):
    am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + af - am
    return am, af, 0.25 * (gamma + 0.5) ** 2, gamma


RUNS = {
    "HHT": (lambda ct: ct.scheme.HHT(alpha=-0.25), None, Dense(h=STEP, w=(0.0, 0.25, 0.390625, 0.75)), "alpha"),
    "Newmark": (
        lambda ct: ct.scheme.Newmark(beta=0.4, gamma=0.55), None, Dense(h=STEP, w=(0.0, 0.0, 0.4, 0.55)), "alpha",
    ),
    "penalty": (
        lambda ct: ct.scheme.Newmark(beta=0.4, gamma=0.55), 3e3,
        Dense(h=STEP, w=(0.0, 0.0, 0.4, 0.55), soft=1.0 / 3e3), "alpha",
    ),
    "Moreau-Jean": (
        lambda ct: ct.MoreauJean(theta=0.7, restitution=0.4), None, Dense(h=STEP, theta=0.7, e=0.4), "moreau",
    ),
    "Moreau-Jean 1/2": (lambda ct: ct.MoreauJean(restitution=0.4), None, Dense(h=STEP, e=0.4), "moreau"),
    "nonsmooth": (
        lambda ct: ct.scheme.NonsmoothAlpha(rho_inf=0.6, restitution=0.3), None,
        Dense(h=STEP, w=chung_hulbert(0.6), e=0.3), "nonsmooth",
    ),
    "projected": (
        lambda ct: ct.scheme.ProjectedAlpha(rho_inf=0.6, restitution=0.3), None,
        Dense(h=STEP, w=chung_hulbert(0.6), e=0.3), "projected",
    ),
    "projected undamped": (
        lambda ct: ct.scheme.ProjectedAlpha(rho_inf=0.6, restitution=0.3), None,
        Dense(h=STEP, w=chung_hulbert(0.6), e=0.3, C=NONE), "projected",
    ),
    "stabilised": (lambda ct: ct.scheme.StabilisedNewmark(), None, Dense(h=STEP), "stabilised"),
    "central": (lambda ct: ct.CentralDifference(), None, Leapfrog(h=STEP), "leapfrog"),
    "averaged": (
        lambda ct: ct.scheme.PaoliSchatzman(restitution=0.4), None,
        Leapfrog(h=STEP, e=0.4, rule="averaged"), "leapfrog",
    ),
    "impulse": (
        lambda ct: ct.scheme.CDLagrange(restitution=0.4), None, Leapfrog(h=STEP, e=0.4, rule="impulse"), "leapfrog",
    ),
    "spring": (
        lambda ct: ct.scheme.PenaltyDifference(), 2e3, Leapfrog(h=STEP, rule="spring", stiffness=2e3), "leapfrog",
    ),
}  # fmt: skip


def prepared(ct, scheme, stiffness, damping):
    """Stepper of the two contacts."""
    forcing = tuple(
        ct.bodies.Forcing(shape=shape, amplitude=lambda t, j=j: np.broadcast_to(amplitudes(t)[j], np.shape(t)))
        for j, shape in enumerate(SHAPES)
    )
    body = ct.LinearBody(
        M=M, K=K, C=damping, Q=Q, gap0=GAP0, load=LOAD, displacement=U0, velocity=V0, forcing=forcing
    )  # fmt: skip
    law = ct.Unilateral() if stiffness is None else ct.Penalty(stiffness=stiffness)
    return scheme(ct).prepare(body, law, dt=STEP, courant=None)


def in_two_parts(run, record):
    """What a run stores that is advanced by 37 steps and by the rest, and how much of each."""
    kept, counts = [], np.zeros(3, dtype=int)
    for first, steps in ((0, 37), (37, STEPS - 37)):
        out = record.samples(record.Record(every=1, state_every=1), steps, 2, 3)
        run.sums.filled[:] = 0
        assert run.advance(out, first, steps) == -1
        sizes = {"state": run.sums.filled[1], "event": run.sums.filled[2]}
        parts = {name: value[: sizes.get(name[:5], run.sums.filled[0])] for name, value in out._asdict().items()
                 if name not in ("every", "state_every", "at", "rows")}  # fmt: skip
        kept.append(parts)
        counts += run.sums.filled
    return SimpleNamespace(**{name: np.concatenate([part[name] for part in kept]) for name in kept[0]}), counts.tolist()


@pytest.mark.parametrize("name", RUNS)
def test_steps_are_those_of_whole_matrices(name):
    scheme, stiffness, exact, step = RUNS[name]
    impacts = step != "alpha"
    with plain() as module:
        record = module("contact.record.record")
        run = prepared(module("contact"), scheme, stiffness, exact.C)
        before = run.sums.damping[0], run.sums.external[0]  # less the half step before t = 0
        out, count = in_two_parts(run, record)
    start, notes, states, deepest = exact.energy(), [], [], np.zeros(2)
    for k in range(STEPS):
        states.append(exact.u)
        notes.append(getattr(exact, step)(k * STEP))
        deepest = np.maximum(deepest, -getattr(exact, "deepest", notes[-1].gap))
    force, gap = (np.array([getattr(note, part) for note in notes]) for part in ("force", "gap"))
    scale = force.max()
    assert (force > 0.0).sum(axis=0).min() >= 2
    np.testing.assert_allclose(out.force, force, rtol=0.0, atol=1e-9 * scale)
    np.testing.assert_allclose(out.gap, gap, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(out.state, states, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(out.time, [note.time for note in notes], rtol=1e-13)
    np.testing.assert_allclose(out.state_time, STEP * np.arange(STEPS), rtol=1e-13)
    order, sums = run.system.order, run.sums
    np.testing.assert_allclose(run.state.u, exact.u[order], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(run.state.v, exact.v[order], rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(sums.impulse, STEP * force.sum(axis=0), rtol=1e-10)
    np.testing.assert_allclose(out.impulse, STEP * np.cumsum(force, axis=0), rtol=1e-9)
    np.testing.assert_allclose(sums.peak, force.max(axis=0), rtol=1e-10)
    work = np.sum([note.work for note in notes], axis=0)
    np.testing.assert_allclose(sums.work, work, rtol=1e-9)
    np.testing.assert_allclose(sums.penetration, deepest, rtol=1e-9, atol=1e-13)
    np.testing.assert_allclose(sums.residual, deepest if stiffness else 0.0, rtol=1e-9, atol=1e-13)
    works = sums.damping[0] - before[0], sums.external[0] - before[1]
    np.testing.assert_allclose(works, [exact.damping, exact.external], rtol=1e-9)
    assert sums.contact_steps.tolist() == (force > 0.0).sum(axis=0).tolist()
    own = exact.energy() - start - work.sum() - exact.damping - exact.external
    assert sums.algorithmic[0] == pytest.approx(own, abs=1e-11)
    assert impacts or abs(own) > 1e-3
    events = expected_events(notes)
    assert count == [STEPS, STEPS, len(events)]
    for (contact, kind, time), row in zip(events, range(count[2]), strict=True):
        assert (out.event_contact[row], out.event_kind[row]) == (contact, kind)
        assert out.event_time[row] == pytest.approx(time, abs=1e-9)


def expected_events(notes):
    """Closings where the line from the gap before to that without a force crosses zero, and openings."""
    found, closed = [], [False, False]
    for note in notes:
        began, before, ahead = note.line
        for k in range(2):
            if note.force[k] > 0.0 and not closed[k]:
                part = before[k] / (before[k] - ahead[k]) if before[k] > 0.0 and before[k] > ahead[k] else 0.0
                found.append((k, 1, max(began + min(part, 1.0) * STEP, 0.0)))
            elif not note.force[k] > 0.0 and closed[k]:
                found.append((k, 0, note.opened))
            closed[k] = note.force[k] > 0.0
    return found


@pytest.mark.parametrize("name", RUNS)
def test_a_motion_that_is_no_number_fails_in_the_step_it_is_met(name):
    scheme, stiffness, exact, _ = RUNS[name]
    with plain() as module:
        record = module("contact.record.record")
        run = prepared(module("contact"), scheme, stiffness, exact.C)
        out = record.samples(record.Record(), 4, 2, 3)
        assert run.advance(out, 3, 1) == -1
        run.state.u[:] = np.nan
        assert run.advance(out, 5, 3) == 5
        assert "motion is not finite" in run.why()
