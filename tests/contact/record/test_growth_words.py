"""What a growth states: its check at half the step, its verdict and its cause, on both sides of each limit."""

import math
from dataclasses import replace

import pytest

import contact as ct

CAUSE = ct.record.Cause(body="casing", n=4, share=0.9, travel=1.0, source="friction", work=1.5, closed=0.5)
GROWS = ct.record.RunGrowth(
    rate=10.0, low=9.0, high=11.0, state="grows", amplitude=1e-4, steady=0.5, since=0.1, time_to_half_wall=0.5,
    cause=CAUSE,
)  # fmt: skip
NO_WALL = replace(GROWS, time_to_half_wall=math.inf)


@pytest.mark.parametrize(
    ("half", "width", "check"),
    [
        (math.nan, math.nan, ""),
        (10.99, 0.0, "converged"), (9.01, 0.0, "converged"),  # a tenth, as is the interval
        (11.01, 0.0, "depends on the step"), (8.99, 0.0, "depends on the step"),
        (11.4, 1.0, "converged"), (11.42, 1.0, "depends on the step"),  # both intervals, the root of two
        (5.01, 0.0, "depends on the step"), (4.99, 0.0, "numerical"), (4.5, 0.49, "numerical"),
        (4.5, 0.51, "depends on the step"), (-3.0, 0.0, "numerical"),
    ],
)  # fmt: skip
def test_growth_at_half_the_step_agrees_within_a_tenth_or_both_intervals(half, width, check):
    found = GROWS.checked(half, width, 0.3)
    assert found.check == check
    assert found.converged is {"": None, "converged": True}.get(check, False)
    assert found.numerical is (check == "numerical")
    assert found.outcome == ("numerical" if check == "numerical" else "grows")
    assert [flag.code for flag in found.flags] == (
        ["growth-numerical"] if check in ("numerical", "depends on the step") else []
    )
    assert (found.half_step_width, found.check_share) == pytest.approx((width, 0.3), nan_ok=True)


def test_a_wide_interval_agrees_beyond_a_tenth():
    assert replace(GROWS, low=5.0, high=15.0).checked(14.9, 0.0, 0.3).converged is True
    assert replace(GROWS, low=5.0, high=15.0).checked(15.1, 0.0, 0.3).converged is False


@pytest.mark.parametrize(
    ("same", "irregular"),
    [(10.0, False), (9.01, False), (math.nan, False), (8.9, True), (11.1, True), (2.0, True)],
)
def test_a_motion_is_irregular_if_another_start_changes_its_growth(same, irregular):
    found = replace(GROWS.checked(2.0, 0.1, 0.3), same_step=same)
    assert found.irregular is irregular
    assert found.check == ("irregular" if irregular else "numerical")
    assert not replace(GROWS.checked(10.0, 0.1, 0.3), same_step=same).irregular  # half the step agrees


def test_a_start_that_gives_the_growth_of_half_the_step_is_irregular_although_it_agrees():
    wide = replace(GROWS, low=0.5, high=19.5)  # to 9.5
    for same, irregular in ((5.05, True), (5.15, False)):
        assert replace(wide.checked(0.2, 0.1, 0.3), same_step=same).irregular is irregular


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "The motion grows by 10 1/s (95 %: 9 to 11). It is mostly the n = 4 motion of the casing, which travels "
             "with the rotation of the blades. Its energy comes from friction (1.5 J). The contact is closed 50 % of "
             "the time. The rim's deflection reaches half the wall at 0.5 s."),
        ({"low": 0.0, "cause": None, "time_to_half_wall": math.inf},
         "The motion grows beyond its limit. Its rate is uncertain: 10 1/s (95 %: 0 to 11)."),
        ({"low": 0.1, "cause": None, "time_to_half_wall": math.inf}, "The motion grows by 10 1/s (95 %: 0.1 to 11)."),
        ({"state": "decays", "rate": -10.0, "low": -12.0, "high": -8.0},
         "The motion decays by 10 1/s (95 %: 8 to 12)."),
        ({"state": "at rest"}, "Nothing vibrates."),
        ({"state": "bounded", "cause": None}, "The motion is bounded: at the end of the run the rim deflects by 0.05 to"
                                              " 0.1 mm."),
        ({"state": "bounded", "cause": None, "steady": 0.02},
         "The motion is bounded: at the end of the run the rim deflects by 0.1 mm, steady within 2 %."),
        ({"state": "bounded", "cause": None, "steady": 0.019},
         "The motion is bounded: at the end of the run the rim deflects by 0.1 mm, steady within 1.9 %. It may be "
         "periodic: `casingfem cycles` computes periodic motions and their growth (Floquet)."),
        ({"state": "undecided"}, "The run is too short to tell whether the motion grows: 10 1/s (95 %: 9 to 11). "
                                 "Lengthen t_end."),
        ({"state": "undecided", "cause": None, "passes": True},
         "The motion passes its limit too soon to fit a growth rate. At half the step the motion passes this limit too:"
         " converged."),
        ({"state": "undecided", "cause": None, "passes": False},
         "The motion passes its limit too soon to fit a growth rate. At half the step the motion stays within this "
         "limit: its growth is numerical, reduce dt."),
    ],
)  # fmt: skip
def test_words_of_each_state(changes, words):
    assert repr(replace(GROWS, **changes)) == replace(GROWS, **changes).words == words


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"half_step": 10.5, "half_step_width": 0.1}, "At half the step it grows by 10.5 1/s: converged."),
        ({"half_step": 10.5, "half_step_width": 0.1, "low": -1.0, "high": 21.0},
         "At half the step it grows by 10.5 1/s: within the intervals of both steps."),
        ({"half_step": 2.0, "half_step_width": 0.1},
         "At half the step it grows by 2 1/s: the growth is numerical, reduce dt."),
        ({"half_step": 7.0, "half_step_width": 0.1},
         "At half the step it grows by 7 1/s: the growth depends on the step, reduce dt."),
        ({"half_step": 2.0, "half_step_width": 0.1, "same_step": 3.0},
         "At half the step it grows by 2 1/s, at the same step from a slightly different start by 3 1/s: the motion is "
         "irregular, its growth differs from run to run."),
    ],
)  # fmt: skip
def test_words_of_the_check_at_half_the_step(changes, words):
    found = replace(GROWS, **changes)
    assert found.at_half_step == words
    assert found.words.endswith(words)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"travel": 0.31}, "the n = 4 motion of the casing, which travels with the rotation of the blades"),
        ({"travel": -0.31}, "the n = 4 motion of the casing, which travels against the rotation of the blades"),
        ({"travel": 0.29}, "the n = 4 motion of the casing, a standing wave"),
        ({"travel": -0.29}, "the n = 4 motion of the casing, a standing wave"),
        ({"travel": math.nan, "n": 0}, "the n = 0 motion of the casing"),
        ({"n": None, "body": "blades", "travel": math.nan}, "the motion of the blades"),
        ({"n": None, "body": "blades", "mode": 3}, "mode 3 of the blades"),
    ],
)
def test_words_of_a_cause(changes, words):
    assert replace(CAUSE, **changes).words == words


@pytest.mark.parametrize(
    ("closed", "source", "words"),
    [
        (0.99, "friction", "Its energy comes from friction (1.5 J). The contact is closed 99 % of the time."),
        (0.991, "friction", "Its energy comes from friction (1.5 J). The contact is closed all the time."),
        (0.5, "", ""),
    ],
)
def test_words_of_a_source(closed, source, words):
    assert replace(CAUSE, closed=closed, source=source).source_words == words


def test_what_a_growth_without_a_cause_names():
    alone = replace(GROWS, cause=None)
    assert (alone.body, alone.nodal_diameters, alone.blade_mode, alone.energy_rate) == ("", None, None, 20.0)
    named = replace(GROWS, cause=replace(CAUSE, n=None, mode=2, body="blades"))
    assert (named.body, named.nodal_diameters, named.blade_mode) == ("blades", None, 2)
    document = named.to_dict()
    assert (document["growth_1_s"], document["growth_low_1_s"], document["growth_high_1_s"]) == (10.0, 9.0, 11.0)
    assert (document["blade_mode"], document["n"], document["closed_fraction"]) == (2, None, 0.5)
    assert set(document) - set(alone.to_dict()) == {
        "body", "n", "blade_mode", "energy_share", "travel", "source", "source_work_J", "closed_fraction"
    }  # fmt: skip
