"""Verdicts of runs at single speeds from what the runs state: limits on both sides, and the notes."""

import math
from dataclasses import replace

import pytest

import contact as ct
from contact.speed_verdict import SpeedRun, at_end_of_band, decided, disagree, may_change
from tests.contact.stability.test_growth_of_runs import grown

RUN = SpeedRun(
    speed_hz=20.0, verdict="safe", closed=3.0, growth=0.1, low=-0.2, high=0.4, amplitude_m=2e-5, half_wall_s=math.inf,
    n=4, wave="with", body="casing", state="bounded", steady=0.04, contact=0.3, allowed_m=1e-3,
)  # fmt: skip


@pytest.mark.parametrize(
    ("size", "allowed", "verdict"),
    [(5.9e-5, 1.0, "safe"), (6.1e-5, 1.0, "resonance"), (5.9e-5, 5.8e-5, "resonance"), (5.0e-5, 5.1e-5, "safe")],
)
def test_a_resonance_exceeds_three_times_the_median_or_the_allowed_deflection(size, allowed, verdict):
    """The median is that of the runs at even speeds, without those that grow or do not decide."""
    calm = [replace(RUN, verdict="resonance", amplitude_m=value) for value in (1e-5, 2e-5, 2e-5, 5e-5)]
    large = replace(RUN, verdict="resonance", amplitude_m=size, allowed_m=allowed)
    grows = replace(RUN, verdict="unstable", amplitude_m=1.0)
    found = decided([*calm, large, grows], [*calm, grows, replace(large, verdict="not decided")])
    assert [run.verdict for run in found] == ["safe"] * 4 + [verdict, "unstable"]
    assert [run.amplitude_m for run in found] == [run.amplitude_m for run in (*calm, large, grows)]


def test_runs_that_all_grow_stay_as_they_are():
    grows, short = replace(RUN, verdict="unstable"), replace(RUN, verdict="not decided", half_wall_s=1.0)
    assert decided([grows, short], [grows, short]) == (grows, short)
    alone = replace(RUN, verdict="resonance", amplitude_m=2e-3)
    assert decided([alone], [grows]) == (alone,)  # above the allowed deflection
    assert decided([replace(alone, amplitude_m=9e-4)], [grows])[0].verdict == "safe"


@pytest.mark.parametrize(("factor", "found"), [(1.99, False), (2.01, True)])
def test_runs_disagree_where_one_is_more_than_twice_the_other(factor, found):
    other = replace(RUN, amplitude_m=factor * RUN.amplitude_m)
    assert disagree(RUN, other) is disagree(other, RUN) is found
    stopped = replace(RUN, amplitude_m=1.0, limit_m=factor * RUN.amplitude_m)  # a run counts up to where it stopped
    assert disagree(RUN, stopped) is found


def test_runs_of_other_verdicts_disagree_whatever_their_size():
    assert disagree(RUN, replace(RUN, verdict="unstable"))
    assert disagree(replace(RUN, verdict="unstable"), replace(RUN, verdict="unstable", slow=True))
    assert not disagree(RUN, replace(RUN, n=5, growth=9.0))


@pytest.mark.parametrize(
    ("speeds", "verdicts", "found"),
    [
        ((9.0, 10.0), ("safe", "unstable"), True),  # the ends belong to the band
        ((9.0, 10.0), ("unstable", "safe"), False),
        ((20.0, 21.0), ("unstable", "safe"), True),
        ((12.0, 15.0), ("unstable", "safe"), False),  # both inside
        ((5.0, 25.0), ("safe", "unstable"), False),  # both outside
        ((25.0, 30.0), ("safe", "unstable"), True),  # of the second band
    ],
)
def test_the_end_of_a_band_lies_between_two_runs_if_the_inner_one_is_unstable(speeds, verdicts, found):
    runs = [replace(RUN, speed_hz=hz, verdict=word) for hz, word in zip(speeds, verdicts, strict=True)]
    bands = [(10.0, 20.0), (28.0, 40.0)]
    assert at_end_of_band(*runs, bands) is at_end_of_band(*runs[::-1], bands) is found


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({}, "The contact opens (closed 30 % of the time). The motion is bounded at 0.02 mm, steady within 4 %."),
        ({"state": "decays"}, "The contact opens (closed 30 % of the time). The motion decays."),
        ({"state": "grows"}, "The contact opens (closed 30 % of the time)."),
        ({"contact": 0.989, "state": None}, "The contact opens (closed 99 % of the time)."),
        ({"contact": 0.99, "state": None}, "The contact opens (open for a small part of the time)."),
        ({"contact": 0.99, "opens": False, "state": None}, "The contact stays closed."),
        ({"closed": -1.0}, "The motion is bounded at 0.02 mm, steady within 4 %."),
        ({"closed": -1.0, "growth": 0.0}, ""),
        ({"closed": 0.0, "growth": -0.1}, ""),
        ({"closed": -1.0, "growth": 0.0, "why": "it is short"}, "It is short."),
        ({"contact": 0.0}, "The contact never closes."),
        ({"contact": math.nan}, "The contact never closes."),
        ({"contact": 0.0, "body": "rotor"}, ""),
        ({"verdict": "unstable"}, ""),
        ({"verdict": "not decided"}, ""),
        (
            {"verdict": "resonance", "state": "decays"},
            "The contact opens (closed 30 % of the time). The motion decays.",
        ),
    ],
)
def test_the_note_of_a_run_states_why_it_differs_from_closed_contact(changes, note):
    assert replace(RUN, **changes).note == note


@pytest.mark.parametrize(
    ("amplitude", "limit", "shown", "text"),
    [(2e-5, math.nan, 2e-5, "0.02"), (5e-3, 1.5e-3, 1.5e-3, "> 1.5"), (1e-3, 1.5e-3, 1e-3, "> 1.5"),
     (math.nan, math.nan, math.nan, ""), (math.inf, 1e-3, 1e-3, "")],
)  # fmt: skip
def test_the_deflection_of_a_stopped_run_is_at_most_its_limit(amplitude, limit, shown, text):
    run = replace(RUN, amplitude_m=amplitude, limit_m=limit)
    assert run.stopped is math.isfinite(limit)
    assert run.shown_m == pytest.approx(shown, nan_ok=True)
    assert run.deflection == text


def test_a_longer_run_may_change_growth_with_contact_that_opens_and_runs_that_do_not_decide():
    rod = ct.Rod(length=1.0, area=1e-4, E=2e11, rho=7800.0, elements=5)
    result = ct.run([rod, ct.Wall(x=-1e-3)], t_end=1e-4, courant=0.9)
    for growth, changes in (
        (grown(closed=0.3), True), (grown(closed=1.0), False), (grown(closed=0.0), False),
        (grown(closed=0.3, outcome="bounded"), False), (grown(closed=1.0, outcome="undecided"), True),
        (grown(closed=0.3).checked(1.0, 0.1, 0.3), False),
    ):  # fmt: skip
        assert may_change(replace(result, growth=growth)) is changes
