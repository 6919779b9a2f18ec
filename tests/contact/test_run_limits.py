"""When a run is called diverged, and what it says then: both sides of each limit, on made-up budgets."""

import importlib
import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

import contact as ct
from contact.diverged import _fed_words, _limit_words
from contact.ended import ADDED
from contact.prepared import prepared
from contact.resolved import MOST_STEPS, count_of

RUN = importlib.import_module("contact.run")
ENDED = importlib.import_module("contact.ended")
STILL = ct.record.Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0)
CALM = ct.record.EnergyBudget(start=STILL, end=STILL, contact=0.5, rotation=0.25, friction=0.0, damping=0.0)


def later(added, **changes):
    """Contact has added so much since `CALM`, beside 2 J that were there and 1 J of rotation."""
    return replace(CALM, **{"contact": 0.5 + added, "rotation": 1.25} | changes)


def test_contact_that_adds_more_than_thrice_all_else_runs_away():
    bare, coated = (SimpleNamespace(law=SimpleNamespace(coating=coating)) for coating in (None, object()))
    assert ADDED * later(0.0).since(CALM).others == 9.0
    assert not RUN.runs_away(bare, later(8.99), CALM)
    assert RUN.runs_away(bare, later(9.01), CALM)
    assert not RUN.runs_away(coated, later(9.01), CALM)
    assert not RUN.runs_away(bare, later(-9.01), CALM)
    for ready in (bare, coated):
        assert RUN.runs_away(ready, later(math.inf), CALM)
        assert RUN.runs_away(ready, later(0.0, end=replace(STILL, discrete=math.nan)), CALM)


def block(**changes):
    return ct.Scene(
        **{"what": [ct.PointMass(mass=1.0, x=-0.1, velocity=1.0), ct.Wall()], "t_end": 0.3, "dt": 0.01} | changes
    )


def ended(ready, budget, *, steps=30, failed=-1, calm=None, monkeypatch):
    monkeypatch.setattr(ENDED, "budget_of", lambda _: budget)
    parts = [chunk.samples for chunk in RUN.steps(ready.stepper, 30, record=ready.record)]
    return ENDED.finished(ready, parts, steps, 0.1, failed, calm)


def test_how_a_run_ends(monkeypatch):
    """Done, run away by its energy, failed at a step, out of numbers: the step named, and what "flag" spares."""
    give = {"monkeypatch": monkeypatch}
    for on_limit in ("stop", "flag"):
        scene = block(on_limit=on_limit)
        whole = ended(prepared(scene), later(-1.0), calm=CALM, **give)
        assert (whole.divergence, [flag.code for flag in whole.flags]) == (None, ["energy-open"])
        with pytest.raises(ct.NumericsError, match=r"^step 7 \(t = 0\.07 s\): ") as caught:
            ended(prepared(scene), later(-1.0), failed=7, calm=CALM, **give)
        assert caught.value.result.divergence is None
        assert [flag.code for flag in caught.value.result.flags if flag.failed] == ["unconverged"]
        with pytest.raises(
            ct.NumericsError, match=r"^step 29 \(t = 0\.29 s\): diverged: the energy is not a fin"
        ) as caught:
            ended(prepared(scene), later(math.nan), calm=CALM, **give)
        assert caught.value.result.divergence.limit == "overflow"
        assert [flag.code for flag in caught.value.result.flags][-1] == "motion-overflow"
    told = ended(prepared(block(on_limit="flag")), later(9.5), calm=CALM, **give)
    ended_by = told.divergence
    assert (ended_by.limit, ended_by.reached, ended_by.allowed, ended_by.step) == ("energy", 9.5, 9.0, 30)
    assert [(flag.code, flag.failed) for flag in told.flags if flag.failed] == [("energy-grows", True)]
    with pytest.raises(
        ct.NumericsError, match=r"^step 29 \(t = 0\.29 s\): diverged: contact and scheme have made 9\.5 J"
    ):
        ended(prepared(block()), later(9.5), calm=CALM, **give)


def test_what_a_call_gives_takes_the_place_of_what_the_scene_says(monkeypatch):
    """Zero too; a step of one kind replaces the other's; what is left out stays."""
    monkeypatch.setattr(RUN, "prepared", lambda scene: scene)
    monkeypatch.setattr(RUN, "completed", lambda scene, *_: scene)
    said = block(
        gravity=9.81, law=ct.Unilateral(), scheme=ct.CentralDifference(), record=ct.Record(every=3), on_limit="flag"
    )
    names = ("law", "scheme", "t_end", "dt", "courant", "gravity", "record", "on_limit")
    for given in (
        {}, {"gravity": 0.0}, {"t_end": 0.7}, {"dt": 0.02}, {"on_limit": "stop"}, {"law": ct.Coulomb(mu=0.1)},
        {"scheme": ct.ExactModal()}, {"record": ct.Record(every=2)}, {"courant": 0.5},
    ):  # fmt: skip
        found = ct.run(said, **given)
        expected = {name: getattr(said, name) for name in names} | ({"dt": None} if "courant" in given else {}) | given
        assert {name: getattr(found, name) for name in names} == expected
    assert ct.run(said.what, t_end=1.0).gravity == 0.0


def test_samples_end_at_the_first_that_is_no_number():
    ready = prepared(block(record=ct.Record(state_every=2)))
    (part,) = (chunk.samples for chunk in RUN.steps(ready.stepper, 30, record=ready.record))
    assert ENDED._finite(part) is part
    spoilt = part._replace(gap=part.gap.copy())
    spoilt.gap[11, 0] = math.inf
    kept = ENDED._finite(spoilt)
    assert len(kept.time) == len(kept.force) == len(kept.gap) == len(kept.impulse) == 11
    assert kept.time[-1] == part.time[10]
    assert kept.state_time.tolist() == [time for time in part.state_time if time < part.time[11]]
    assert len(kept.state) == len(kept.state_time) == 6


def test_steps_to_the_end():
    assert count_of(1.0, 0.1) == 10
    assert count_of(1.0 + 1e-9, 0.1) == 11
    assert count_of(1.0 + 1e-13, 0.1) == 10
    assert count_of(1e-9, 0.1) == 1
    assert count_of(float(MOST_STEPS), 1.0) == MOST_STEPS
    with pytest.raises(ct.InputError, match=r"which is 1\.001e\+08 steps, about .*, expected at most 1e\+08: shorten"):
        count_of(1.001 * 2.0 * MOST_STEPS, 2.0)


def test_who_fed_a_motion_the_largest_first():
    budget = replace(CALM, friction=5.0, rotation=-9.0, body_force=0.06, external=0.04, contact=3.0)
    assert _fed_words(budget).startswith(
        "Energy came from friction (5 J), the contact law (3 J), gravity and whirl (0.06"
    )
    assert "varying loads" not in _fed_words(budget)
    assert "overlapping" not in _fed_words(budget)
    assert "pushes overlapping bodies apart" in _fed_words(replace(budget, contact=6.0))
    assert _fed_words(replace(CALM, contact=-1.0, rotation=0.0)) == ""
    assert _fed_words(replace(CALM, contact=0.0, rotation=0.0, external=2.0)) == "Energy came from varying loads (2 J)."


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("wall", "the rim moved 0.003 m, 0.5 of its wall is 0.002 m"),
        ("radius", "rim and tip moved 0.003 m, a tenth of the radius is 0.002 m"),
        ("gap", "a gap moved 0.003 m"),
        ("overflow", "the energy is not a finite number"),
    ],
)
def test_limits_in_words(name, words):
    assert _limit_words(name, 0.003, 0.002).startswith(f"diverged: {words}")


def test_a_failed_step_says_why():
    body = ct.ModalBody(omega=[1.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]])
    stepper = prepared(block(what=ct.Patch(body=body, normal=("x",), clearance=0.1))).stepper
    assert stepper.why() == "the motion is not a number [motion-overflow]"
    stepper.state.counts[3] = 1.0
    assert stepper.why().startswith("no motion opens all gaps at once")
    stepper.state.counts[3] = 2.0
    assert stepper.why().startswith("no forces found that obey Coulomb's law in every contact")
    stepper = prepared(
        block(dt=0.01, what=[ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=4, x=0.1), ct.Wall()])
    )
    stepper = stepper.stepper
    assert stepper.why().startswith("the contacts have no common answer")
    for name in ("u", "v"):
        kept = getattr(stepper.state, name)[0]
        getattr(stepper.state, name)[0] = math.inf
        assert stepper.why() == "the motion is not a finite number [motion-overflow]"
        getattr(stepper.state, name)[0] = kept
    stepper.fault.extend(["the first", "the last"])
    assert stepper.why() == "the last"
