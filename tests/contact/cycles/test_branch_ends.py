"""Where and why a branch of a map in closed form ends."""

import math
from importlib import import_module

import numpy as np
import pytest

import contact as ct
from contact.cycles.branch import Tangent, _at_edge, _why, begun, followed
from contact.cycles.passage import Event
from tests.contact.cycles.henon import FOLD, B, course, fixed, followed_map

along_branch = import_module("contact.cycles.branch")


def at_fixed(family, v):
    return ct.cycles.orbit(family, v, guess=np.array([fixed(v)] * 2))


@pytest.fixture
def hitting(family, monkeypatch):
    """One contact closes twice as soon as a period begins beyond x = 1/2."""

    def hits(motion, x, *args, **more):
        found = followed_map(motion, x, *args, **more)
        found.events = (Event(0.1, 0, True, False, 1.0), Event(0.2, 0, True, False, 1.0)) if x[0] > 0.5 else ()
        return found

    monkeypatch.setattr(import_module("contact.cycles.shooting"), "passage", hits)
    return family


def test_other_closings_within_a_hundredth_are_grazing(hitting):
    edge = 0.25 + 0.5 * (1.0 - B)  # the value at which the fixed point is 1/2
    for off, sense, words in (
        (-0.001, 1.0, "a contact grazes (no step)"), (-0.001, -1.0, "a contact grazes (no step)"),
        (0.001, 1.0, "a contact grazes (no step)"), (-0.1, 1.0, "no step"), (0.1, 1.0, "no step"),
    ):  # fmt: skip
        at = at_fixed(hitting, edge + off)
        assert sum(at.closings) == (2 if off > 0.0 else 0)
        assert _why(course(hitting), at, Tangent(np.ones(2), sense), "no step") == words


def test_what_stops_a_branch_a_hundredth_further_is_told(family, monkeypatch):
    at, seen = at_fixed(family, 0.2), []

    def stops(motion, x, *args, **more):
        seen.append((motion.v, *x))
        raise ct.NumericsError("chatter")

    monkeypatch.setattr(import_module("contact.cycles.shooting"), "passage", stops)
    assert _why(course(family), at, Tangent(np.array([3.0, -2.0]), 5.0), "no step") == "chatter"
    assert seen == [pytest.approx((0.25, at.x[0] + 0.03, at.x[1] - 0.02))]


def test_the_orbit_at_the_edge_that_a_step_leaves_over(family):
    along, at = course(family, -0.1, 0.3), at_fixed(family, 0.2)
    found = _at_edge(along, at, 0.4, np.array([0.5, 0.5]))
    assert (found.value, found.x) == (0.3, pytest.approx([fixed(0.3)] * 2, rel=1e-9))
    low = _at_edge(along, at, -0.4, np.array([-0.5, -0.5]))
    assert (low.value, low.x) == (-0.1, pytest.approx([fixed(-0.1)] * 2, rel=1e-9))
    assert _at_edge(course(family, 2.0 * FOLD, 0.3), at, -0.4, np.array([-0.5, -0.5])) is None  # there is none
    span = 0.4
    for off, taken in ((0.9e-12, False), (1.2e-12, True)):
        near = at_fixed(family, 0.3 - off * span)
        assert (_at_edge(along, near, 0.4, np.array([0.5, 0.5])) is not None) == taken


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_branch_goes_up_to_the_edge_beyond_which_there_is_nothing(family, monkeypatch, sense):
    """The step that would leave the range is along the tangent: its edge is guessed on it."""
    high, low, guesses, at = 0.45, 0.05, [], family.at

    def inside(value):
        if not low <= value <= high:
            raise ct.InputError("v: found one beyond all values")
        return at(value)

    def guessed(asked, value, *, guess, **more):
        guesses.append(guess)
        return ct.cycles.orbit(asked, value, guess=guess, **more)

    family.at = inside
    monkeypatch.setattr(along_branch, "orbit", guessed)
    along = course(family, low, high)
    way = begun(along, at_fixed(family, 0.2), Tangent(np.zeros(2), sense), 0.3)
    found = followed(along, way, longest=0.3, most=50)
    edge = high if sense > 0.0 else low
    assert (found.points[-1].value, found.end) == (edge, "")
    assert guesses[-1] == pytest.approx([fixed(edge)] * 2, abs=0.02)
    assert np.all(np.diff(sense * found.value) > 0.0)


def test_a_step_is_halved_until_it_is_a_ten_thousandth_of_the_longest(family, monkeypatch):
    """Where no step leads to an orbit inside the range, after as many tries as there are halves."""
    along, lengths = course(family), []
    at = at_fixed(family, 0.2)

    def none(self, begin, tangent, length):
        lengths.append(length)
        raise ct.NumericsError("no orbit there")

    monkeypatch.setattr(type(along), "next", none)
    found = followed(along, begun(along, at, Tangent(np.zeros(2), 1.0), 0.5), longest=0.5, most=9)
    assert lengths == [0.15 * 0.5**k for k in range(len(lengths))]
    assert lengths[-1] >= 0.5e-4 > 0.5 * lengths[-1]
    assert (found.points, found.specials, found.end) == ((at,), (), "no orbit there")


def test_a_corner_is_where_directions_turn_by_more_than_a_cosine_of_nine_tenths(family, monkeypatch):
    along, at, other = course(family), at_fixed(family, 0.2), at_fixed(family, 0.21)
    for cosine, end in ((0.91, "2 orbits"), (0.89, "the branch has a corner")):
        ahead = along.tangent(at, Tangent(np.zeros(2), 1.0))
        monkeypatch.setattr(type(along), "next", lambda *_: other)
        monkeypatch.setattr(type(along), "product", lambda *_, cosine=cosine: cosine)
        monkeypatch.setattr(along_branch, "passed", lambda *_: [])
        way = along_branch.Way((at,), (), ahead, 0.01)
        assert followed(along, way, longest=0.01, most=2).end == end
        monkeypatch.undo()
        monkeypatch.setattr(import_module("contact.cycles.shooting"), "passage", followed_map)
    assert math.isfinite(other.value)
