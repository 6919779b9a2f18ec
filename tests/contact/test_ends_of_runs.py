"""Chunks joined to a result, what is said of a divergence, which runs share lanes: made-up numbers, no long runs."""

import importlib
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import contact as ct
from contact.collect import _intervals
from contact.diverged import AT_ONCE, IN_REALITY, SHORT, divergence, theory_of
from contact.model.gaps.rub import rub_of
from contact.prepared import prepared
from contact.problem import default_scheme, problem_of
from contact.record.growth import Cause, RunGrowth
from contact.record.record import NO_STEPS, samples
from contact.stability.closed_contact import growth
from tests.contact.synthetic_rim import blade, ring

RUN = importlib.import_module("contact.run")
ENERGY = ct.record.EnergyBudget(
    start=ct.record.Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0),
    end=ct.record.Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0),
    contact=0.0, rotation=3.0, friction=0.0, damping=0.0,
)  # fmt: skip
TIME = 0.01 * np.arange(320)
RISING = np.exp(2.0 * TIME) * np.where(np.arange(320) % 2, 1.0, -1.0)


def result(force=RISING, steps=600, **changes):
    """Two contacts that bear a force, the first more of it."""
    force = np.stack([0.75 * force, 0.25 * force], axis=1)
    none = np.zeros(2)
    return ct.Result(
        time=TIME[: len(force)], force=force, gap=force, impulse_history=force, impulse=none, peak_force=none,
        max_penetration=none, residual=none, contact_steps=none, reversals=none, state_time=np.zeros(0),
        state=np.zeros((0, 12)), intervals=((), ()), energy=ENERGY, motions=(), blocks=(), steps=steps, dt=0.005,
        window=0.02, seconds=0.3, scheme="some", source={}, channels=np.zeros((0, 12)), **changes,
    )  # fmt: skip


def test_closings_are_paired_with_openings_and_the_last_ends_with_the_run():
    kind, time = np.array([1.0, 0.0, 3.0, 1.0, 2.0, 0.0, 1.0]), np.array([0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0])
    assert _intervals(kind, time, 2.5) == ((0.5, 0.75), (1.25, 1.75), (2.0, 2.5))
    assert _intervals(kind[:-1], time[:-1], 2.5) == ((0.5, 0.75), (1.25, 1.75))
    assert _intervals(kind, time, 1.9)[-1] == (2.0, 2.0)  # located behind the last step
    assert _intervals(kind[:0], time[:0], 2.5) == ()
    assert _intervals(kind - 2.0, time, 2.5) == ((1.0, 1.5),)


GROWTH = RunGrowth(
    rate=2.0, low=1.5, high=2.5, state="grows", amplitude=1e-3, steady=1.0, since=1.0, time_to_half_wall=3.0,
    cause=Cause(body="casing", n=3, share=0.9, travel=1.0, source="the turning rim", work=3.0, closed=0.2),
)  # fmt: skip


def test_growth_stands_beside_the_limit_and_the_source_of_its_energy():
    bodies = [ct.Wall()]
    found = divergence(bodies, 0.0, result(growth=GROWTH.checked(2.1, 0.1, 0.5)), ("wall", 3e-3, 2e-3))
    assert (found.limit, found.step, found.reached, found.allowed, found.growth) == ("wall", 600, 3e-3, 2e-3, 2.0)
    assert found.time == pytest.approx(3.0, rel=1e-14)
    assert math.isnan(found.theory)
    assert found.words == (
        "diverged: the rim moved 0.003 m, 0.5 of its wall is 0.002 m. The motion grows by 2 1/s (95 %: 1.5 to 2.5). It "
        "is mostly the n = 3 motion of the casing, which travels with the rotation of the blades. Energy came from the "
        f"turning rim (3 J). At half the step it grows by 2.1 1/s: converged. {IN_REALITY}"
    )
    numerical = divergence(bodies, 0.0, result(growth=GROWTH.checked(0.3, 0.1, 0.5)), ("wall", 3e-3, 2e-3))
    assert numerical.words.endswith("At half the step it grows by 0.3 1/s: the growth is numerical, reduce dt.")
    faster = divergence(bodies, 0.0, result(growth=GROWTH.checked(4.0, 0.1, 0.5)), ("wall", 3e-3, 2e-3))
    assert "At half the step it grows by 4 1/s: the growth depends on the step, reduce dt." in faster.words
    irregular = divergence(
        bodies, 0.0, result(growth=replace(GROWTH.checked(0.3, 0.1, 0.5), same_step=7.0)), ("wall", 3e-3, 2e-3)
    )
    assert "at the same step from a slightly different start by 7 1/s: the motion is irregular" in irregular.words
    assert irregular.words.endswith(IN_REALITY)


def test_impacts_are_the_cause_only_of_what_closed_contact_does_not_feed():
    """At 5 Hz this closed contact decays, at 60 Hz it diverges by itself; half the step decides before both."""
    impacts = "Contact that opens and closes feeds this motion: it is closed 20 % of the time."
    rim = ct.RotatingRim(ring(), blade(zeta=0.05), clearance=0.0, speed_hz=5.0, lean_deg=10.0)
    for speed, half_step, feeds in ((5.0, 2.1, True), (5.0, 0.3, False), (60.0, 2.1, False)):
        found = divergence(
            replace(rim, speed_hz=speed), 0.0, result(growth=GROWTH.checked(half_step, 0.1, 0.5)), ("wall", 3e-3, 2e-3)
        )
        assert (found.theory > 0.0) == (speed == 60.0)
        assert (impacts in found.words) == feeds


@pytest.mark.parametrize(
    ("name", "steps", "expected"),
    [("wall", 499, AT_ONCE), ("radius", 499, AT_ONCE), ("wall", 500, SHORT), ("gap", 499, ""), ("energy", 500, "")],
)
def test_a_limit_passed_at_once_is_put_down_to_the_numbers_given(name, steps, expected):
    found = divergence([ct.Wall()], 0.0, result(RISING[:10], steps), (name, 3.0, 2.0))
    assert math.isnan(found.growth)
    for words in (AT_ONCE, SHORT):
        assert (words in found.words) == (words == expected)
    assert (IN_REALITY in found.words) == (name in ("wall", "radius"))


@pytest.mark.parametrize("hz", [60.0, 5.0])
def test_theory_says_what_the_closed_contact_does_at_the_speed_of_that_instant(hz):
    rim = ct.RotatingRim(ring(), blade(), clearance=0.0, speed_hz=hz, lean_deg=10.0)
    ramp = replace(rub_of(rim), speed=ct.Speed(time=[0.0, 2.0], hz=[0.0, 2.0 * hz]))
    expected = growth(ct.gaps.rim_contact(rim, mu=0.05), np.array([hz]))[0]
    for what, time in ((rim, 7.0), (ramp, 1.0)):
        rate, words = theory_of(what, 0.05, time)
        assert rate == pytest.approx(expected, rel=1e-9, abs=1e-9)
        does = f"diverges at {hz:.4g} Hz, by {rate:.3g} 1/s." if rate > 0.0 else f"does not diverge at {hz:.4g} Hz ("
        assert words.startswith(f"By theory a contact that stays closed {does}")
    assert theory_of([ct.Wall()], 0.0, 1.0)[1] == ""
    odd = replace(ring(), rows=ring().rows[:, :9], omega=ring().omega[:9], zeta=ring().zeta[:9])
    assert theory_of(replace(rim, casing=odd), 0.05, 1.0)[1].startswith("By theory (its pairs' mean) a contact")


class Counter:
    """A stepper that stores what `samples` gives room for, and fails where it is told to."""

    dt = 0.1
    size = 2

    def __init__(self, fails=10**9):
        self.sums, self.calls, self.fails = SimpleNamespace(closed=np.zeros(1), filled=np.ones(3, dtype=int)), [], fails

    def advance(self, out, first, size):
        assert not self.sums.filled.any()
        self.calls.append((first, size, out.at.tolist()))
        self.sums.filled[:] = 2, 1, 3
        return self.fails if self.fails < first + size else -1


def test_a_run_is_cut_at_chunks_and_where_the_energy_is_looked_at(monkeypatch):
    monkeypatch.setattr(RUN, "CHUNK", 4)
    monkeypatch.setattr(RUN, "LEDGER", 10)
    stepper = Counter()
    chunks = list(RUN.steps(stepper, 23, record=ct.Record(at=[0.0, 0.4, 0.9, 2.2])))
    cuts = [(0, 4), (4, 4), (8, 2), (10, 4), (14, 4), (18, 2), (20, 3)]
    assert [call[:2] for call in stepper.calls] == cuts
    assert [call[2] for call in stepper.calls] == [[0], [4], [9], [], [], [], [22]]
    assert [chunk.steps for chunk in chunks] == [4, 4, 2, 4, 4, 2, 3]
    assert [chunk.done for chunk in chunks] == [done / 23 for done in (4, 8, 10, 14, 18, 20, 23)]
    assert {chunk.failed for chunk in chunks} == {-1}


def test_a_run_ends_at_the_step_that_failed(monkeypatch):
    monkeypatch.setattr(RUN, "CHUNK", 5)
    chunks = list(RUN.steps(Counter(fails=7), 20, record=ct.Record(every=1, state_every=1)))
    assert [(chunk.steps, chunk.failed, chunk.done) for chunk in chunks] == [(5, -1, 0.25), (2, 7, 0.35)]
    part = chunks[0].samples
    assert [len(values) for values in (part.time, part.force, part.gap, part.impulse)] == [2] * 4
    assert [len(values) for values in (part.state_time, part.state)] == [1] * 2
    assert [len(values) for values in (part.event_time, part.event_kind, part.event_contact)] == [3] * 3


def test_buffers_hold_what_the_steps_can_produce():
    found = samples(ct.Record(every=4, state_every=8), 20, 3, 5)
    assert (found.every, found.state_every, len(found.time), found.force.shape) == (4, 8, 6, (6, 3))
    assert (found.gap.shape, found.impulse.shape, found.state_time.shape) == ((6, 3), (6, 3), (3,))
    assert (found.state.shape, found.rows.shape, found.event_time.size) == ((3, 5), (0, 5), 120)
    assert samples(ct.Record(every=4), 20, 3, 5).state.shape == (0, 5)
    at = np.array([3, 7, 9])
    found = samples(ct.Record(at=[0.1], channels=np.ones((2, 5))), 20, 3, 5, at)
    assert (found.every, len(found.time), found.state.shape, found.at.tolist()) == (0, 3, (3, 2), [3, 7, 9])
    assert found.rows.shape == (2, 5)
    assert samples(ct.Record(), 3, 1, 1).at is NO_STEPS


def test_what_is_to_run_takes_gravity_where_it_has_bodies():
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=4)
    assert problem_of([rod, ct.Wall()], 9.81).linear_form is not None
    rim = ct.RotatingRim(ring(), blade(), clearance=0.0, speed_hz=5.0)
    assert problem_of(rim, 0.0) is rim
    with pytest.raises(ct.InputError, match=r"gravity: found 9\.81 m/s\^2 with RotatingRim, expected it as their load"):
        problem_of(rim, 9.81)
    with pytest.raises(ct.InputError, match="bodies: found str, expected Rod, PointMass or Wall"):
        problem_of([rod, "wall"], 0.0)
    assert isinstance(default_scheme(rim, ct.Unilateral()), ct.ExactModal)
    bodies = problem_of([rod, ct.Wall()], 0.0)
    assert isinstance(default_scheme(bodies, ct.Unilateral()), ct.CentralDifference)
    assert isinstance(default_scheme(bodies, ct.Penalty(stiffness=10.0)), ct.PenaltyDifference)


@pytest.mark.slow  # loads compiled loops
def test_a_flagged_run_goes_on_to_the_limit_of_its_tip():
    rim = ct.RotatingRim(replace(ring(), thickness=1e-3), blade(), clearance=0.0, speed_hz=5.0)
    for on_limit, wall in (("stop", 5e-4), ("flag", 0.045)):
        limits = prepared(ct.Scene(what=rim, t_end=1e-3, dt=1e-5, on_limit=on_limit)).stepper.limits
        assert limits[0] == pytest.approx(wall, rel=1e-12)


def test_a_run_needs_an_end():
    rim = ct.RotatingRim(ring(), blade(), clearance=0.0, speed_hz=5.0)
    with pytest.raises(ct.InputError, match="t_end: found none, expected the end of the run in seconds"):
        prepared(ct.Scene(what=rim, dt=1e-5))
    with pytest.raises(ct.InputError, match=r"t_end: found -1\.0, expected a finite number > 0"):
        prepared(ct.Scene(what=rim, t_end=-1.0, dt=1e-5))


def test_the_budget_of_a_run_has_each_sum_of_all_contacts_in_its_place():
    names = ("work", "rotation", "friction", "damping", "external", "body_force", "algorithmic", "peak")
    sums = {name: np.array([2.0**k, 0.5]) for k, name in enumerate(names)}
    stepper = SimpleNamespace(sums=SimpleNamespace(**sums), stored=lambda: ENERGY.end)
    start = replace(ENERGY.start, strain=7.0)
    found = RUN.budget_of(SimpleNamespace(stepper=stepper, start=start, load_step=3.0, overlap=0.25))
    assert (found.start, found.end, found.load_step, found.overlap) == (start, ENERGY.end, 3.0, 0.25 * 128.5)
    assert (found.contact, found.rotation, found.friction) == (1.5, 2.5, 4.5)
    assert (found.damping, found.external, found.body_force, found.algorithmic) == (8.0, 16.0, 32.0, 64.0)


def test_what_a_run_is_prepared_with_belongs_to_its_step_and_law():
    bodies = [ct.PointMass(mass=2.0, x=-0.1, velocity=1.0), ct.Wall()]
    ready = prepared(ct.Scene(what=bodies, t_end=0.3, dt=0.01, gravity=3.0, law=ct.Unilateral()))
    assert (ready.count, ready.law, ready.on_limit) == (30, ct.Unilateral(), "stop")
    assert ready.load_step == pytest.approx(1e-4 * 3.0**2 * 2.0, rel=1e-12)  # h^2 f^T M^-1 f
    assert (ready.record.every, ready.overlap) == (1, 0.0)
    with pytest.raises(ct.InputError, match=r"at: found 0\.4 s, expected at most 0\.3 s"):
        prepared(ct.Scene(what=bodies, t_end=0.3, dt=0.01, record=ct.Record(at=[0.4])))
