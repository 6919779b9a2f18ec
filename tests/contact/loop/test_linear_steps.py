"""Runs of linear problems against whole matrices, step by step, and their budgets against the energy left."""

from dataclasses import replace

import numpy as np
import pytest

from tests.contact.loop.dense import FULL, GAP0, LOAD, SHAPES, U0, V0, Dense, Leapfrog, M, Q, amplitudes
from tests.contact.loop.dense import K as BANDS
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


def run(ct, scheme, stiffness, exact, steps, velocity=V0):
    """Result of a body with two contacts and two varying loads, with every step stored."""
    forcing = tuple(
        ct.bodies.Forcing(shape=shape, amplitude=lambda t, j=j: np.broadcast_to(amplitudes(t)[j], np.shape(t)))
        for j, shape in enumerate(SHAPES)
    )
    body = ct.LinearBody(
        M=M, K=exact.K, C=exact.C, Q=Q, gap0=GAP0, load=LOAD, displacement=U0, velocity=velocity, forcing=forcing
    )  # fmt: skip
    law = ct.Unilateral() if stiffness is None else ct.Penalty(stiffness=stiffness)
    return ct.run(
        body,
        law=law,
        scheme=scheme(ct),
        dt=STEP,
        t_end=(steps - 0.5) * STEP,
        record=ct.Record(state_every=1),
        on_limit="flag",
    )


@pytest.mark.parametrize("stiff", [BANDS, FULL], ids=["one band", "two bands"])
@pytest.mark.parametrize("name", RUNS)
def test_steps_are_those_of_whole_matrices(name, stiff):
    scheme, stiffness, exact, step = RUNS[name]
    exact = replace(exact, K=stiff, v=V0.copy())
    with plain() as module:
        ct = module("contact")
        early, found = (run(ct, scheme, stiffness, exact, steps) for steps in (37, STEPS))
    notes, states, deepest, works = [], [], np.zeros(2), []
    for k in range(STEPS):
        if k == 37:
            start, works = exact.energy(), [exact.damping, exact.external]
        states.append(exact.u)
        notes.append(getattr(exact, step)(k * STEP))
        deepest = np.maximum(deepest, -getattr(exact, "deepest", notes[-1].gap))
    force, gap = (np.array([getattr(note, part) for note in notes]) for part in ("force", "gap"))
    assert (force > 0.0).sum(axis=0).min() >= 2
    np.testing.assert_allclose(found.force, force, rtol=0.0, atol=1e-9 * force.max())
    np.testing.assert_allclose(found.gap, gap, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found.state, states, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found.time, [note.time for note in notes], rtol=1e-13)
    np.testing.assert_allclose(found.state_time, STEP * np.arange(STEPS), rtol=1e-13)
    np.testing.assert_allclose(found.impulse, STEP * force.sum(axis=0), rtol=1e-10)
    np.testing.assert_allclose(found.impulse_history, STEP * np.cumsum(force, axis=0), rtol=1e-9)
    np.testing.assert_allclose(found.peak_force, force.max(axis=0), rtol=1e-10)
    np.testing.assert_allclose(found.max_penetration, deepest, rtol=1e-9, atol=1e-13)
    np.testing.assert_allclose(found.residual, deepest if stiffness else 0.0, rtol=1e-9, atol=1e-13)
    assert found.contact_steps.tolist() == (force > 0.0).sum(axis=0).tolist()
    assert [list(map(pytest.approx, part)) for part in expected_intervals(notes)] == [list(p) for p in found.intervals]
    since, change = found.energy.since(early.energy), exact.energy() - start
    work = np.sum([note.work for note in notes[37:]])
    damping, external = exact.damping - works[0], exact.external - works[1]
    assert since.end.discrete - since.start.discrete == pytest.approx(change, abs=1e-11)
    assert [since.contact, since.damping, since.external] == pytest.approx([work, damping, external], rel=1e-9)
    own = change - work - damping - external
    assert since.algorithmic == pytest.approx(own, abs=1e-11)
    assert step != "alpha" or abs(own) > 1e-3


def expected_intervals(notes):
    """Closings where the line from the gap before to that without a force crosses zero, to openings."""
    found, closed = ([], []), [False, False]
    for note in notes:
        began, before, ahead = note.line
        for k in range(2):
            if note.force[k] > 0.0 and not closed[k]:
                part = before[k] / (before[k] - ahead[k]) if before[k] > 0.0 and before[k] > ahead[k] else 0.0
                found[k].append([max(began + min(part, 1.0) * STEP, 0.0), STEPS * STEP])
            elif not note.force[k] > 0.0 and closed[k]:
                found[k][-1][1] = note.opened
            closed[k] = note.force[k] > 0.0
    return found


@pytest.mark.parametrize("name", RUNS)
def test_a_motion_that_overflows_ends_the_run(name):
    scheme, stiffness, exact, _ = RUNS[name]
    with plain() as module, np.errstate(over="ignore", invalid="ignore"):
        ct = module("contact")
        with pytest.raises(ct.NumericsError, match="diverged: the motion overflowed"):
            run(ct, scheme, stiffness, exact, 9, 8e307 * V0)
