"""Ranges over which a map in closed form is followed: steps, edges, what is refused."""

import math

import numpy as np
import pytest

import contact as ct
from tests.contact.cycles.henon import FLIP, fixed


@pytest.mark.parametrize(
    ("between", "more", "words"),
    [
        ((math.nan, 1.0), {}, "start: found nan"), ((0.0, math.inf), {}, "end: found inf"),
        ((0.0, 1.0), {"longest": 0.0}, "longest: found"), ((0.0, 1.0), {"most": 1}, "most: found 1"),
        ((0.0, 1.0), {"doublings": -1}, "doublings: found -1"), ((0.5, 0.5), {}, r"v: found 0\.5 to 0\.5, expected"),
    ],
)  # fmt: skip
def test_ranges_and_steps_that_lead_nowhere_are_refused(family, between, more, words):
    with pytest.raises(ct.InputError, match=words):
        ct.cycles.follow(family, between, **more)


def test_a_flip_within_the_last_step_before_the_edge_is_located(family):
    for high in (FLIP + 1e-3, FLIP + 6e-3, FLIP + 0.012):
        (branch,) = ct.cycles.follow(family, (0.2, high), longest=0.05).branches
        (flip,) = branch.of("flip")
        assert flip.orbit.value == pytest.approx(FLIP, abs=2e-5)
        assert branch.points[-1].value == high


def test_a_search_begins_at_the_orbit_that_is_given(family):
    other = ct.cycles.orbit(family, 0.2, guess=np.array([fixed(0.2, -1.0)] * 2))
    found = ct.cycles.follow(family, (0.2, 0.3), first=other, longest=0.2)
    assert found.branches[0].points[0] is other
    assert found.branches[0].points[-1].x == pytest.approx([fixed(0.3, -1.0)] * 2, rel=1e-9)
