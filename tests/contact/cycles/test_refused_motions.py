"""Motions that cannot be followed, and orbits that are not there, are refused; what is next to them is taken."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import contact as ct
from contact.cycles import passage, shooting
from contact.cycles.basins import _start
from contact.cycles.branch import Course, Tangent
from contact.cycles.follow import digest
from contact.cycles.passage import Event, pressing
from contact.cycles.switched import Plant, phase_of
from reports.verification.schemes.cycles import mass_on_stop
from tests.contact.cycles.test_closed_forms import ball, ball_orbit, oscillator
from tests.contact.synthetic_rim import blade, ring

TURN = 2.0 * math.pi
BLOCK = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.1] * 2, channels=("n", "t"), rows=np.eye(2), S=np.zeros((2, 2)))


def before(rows, **given):
    """Two modes before as many stops as rows."""
    names = tuple(f"stop{k}" for k in range(len(rows)))
    body = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.01] * 2, channels=names, rows=rows, S=np.zeros((len(rows),) * 2))
    patch = ct.Patch(body=body, normal=names, clearance=1.0)
    return ct.cycles.DrivenBody(patch=patch, channel=names[0], amplitude=1.0, **given)


def test_a_start_outside_the_rigid_contacts_is_drawn_a_thousand_times():
    """One that is found at the last draw is taken."""
    motion, _ = ball(1.0).over("freq_hz", freq_hz=1.0).at(1.0)

    def drawn(inside):
        draws = iter([[-1.0, 0.0]] * inside + [[2.0, 3.0]])
        return _start(motion, np.ones(2), SimpleNamespace(standard_normal=lambda _: np.array(next(draws))))

    assert drawn(999).tolist() == [2.0, 3.0]
    with pytest.raises(
        ct.NumericsError, match="no start outside the rigid contacts in 1,000 draws: give smaller sizes"
    ):
        drawn(1000)


def test_what_is_asked_for_is_told_by_its_motion_range_and_way():
    family = mass_on_stop(100.0).over("freq_hz", freq_hz=0.2)
    orbit = SimpleNamespace(x=np.array([0.1, 0.2]))
    asked = [
        digest(family, between, first, longest)
        for between, first, longest in (
            ((0.1, 0.2), None, 0.02), ((0.1, 0.3), None, 0.02), ((0.1, 0.2), None, 0.03), ((0.1, 0.2), orbit, 0.02)
        )
    ]  # fmt: skip
    for other in (mass_on_stop(101.0), mass_on_stop(100.0, 0.03), replace(mass_on_stop(100.0), restitution=0.5)):
        asked.append(digest(other.over("freq_hz", freq_hz=0.2), (0.1, 0.2), None, 0.02))
    assert len(set(asked)) == len(asked)
    again = mass_on_stop(100.0).over("freq_hz", freq_hz=0.2)
    assert digest(again, (0.1, 0.2), None, 0.02) == asked[0]


@pytest.mark.parametrize(("slide", "friction"), [(0.0, 0.1), ([[2.0], [0.0]], 0.1)])
def test_friction_without_a_slide_is_for_long_runs(slide, friction):
    k = np.size(slide)
    patch = ct.Patch(body=BLOCK, normal=("n",) * k, tangent=(("t",),) * k, slide=slide)
    given = {"patch": patch, "channel": "n", "amplitude": 1.0, "stiffness": 3.0}
    assert ct.cycles.DrivenBody(**given).mu == 0.0
    with pytest.raises(ct.InputError, match=r"mu: found friction, expected one tangent and a slide other than 0"):
        ct.cycles.DrivenBody(**given, mu=friction)
    moving = replace(patch, slide=-2.0)
    assert ct.cycles.DrivenBody(**(given | {"patch": moving}), mu=friction).mu == friction


@pytest.mark.parametrize("large", [1.4e154, 1e200])
def test_a_body_whose_products_are_beyond_all_numbers_is_refused(large):
    """Squares of rows up to 1.34e154 are numbers."""
    assert before([[1.3e154, 0.0]], stiffness=1.0).over("freq_hz", freq_hz=1.0).plant.rate == pytest.approx(1.3e154)
    with pytest.raises(ct.InputError, match="body: found frequencies, shapes or compliances whose products are beyond"):
        before([[large, 0.0]], stiffness=1.0).over("freq_hz", freq_hz=1.0)


def test_contacts_that_press_each_other_apart_no_less_have_no_forces():
    """What one presses the other feels doubled: no forces open both gaps."""
    g = np.array([-1.0, -1.0])
    assert pressing(np.array([[1.0, -0.5], [-0.5, 1.0]]), g) == pytest.approx([2.0, 2.0], rel=1e-14)
    with pytest.raises(ct.NumericsError, match="the set of closed contacts was not found: contacts press against each"):
        pressing(np.array([[1.0, -2.0], [-2.0, 1.0]]), g)


def test_a_start_inside_a_rigid_contact_is_refused():
    """By more than 1e-9 of what adds up to the gap, .1 + .1."""
    motion, _ = mass_on_stop().over("freq_hz", freq_hz=0.2).at(0.2)
    assert motion.closed_at(np.array([0.1 + 1.9e-10, 0.0]), 0.0) == ()
    with pytest.raises(ct.NumericsError, match="closed where the period begins: choose another start, or give it S"):
        motion.closed_at(np.array([0.1 + 2.1e-10, 0.0]), 0.0)
    soft, _ = mass_on_stop(100.0).over("freq_hz", freq_hz=0.2).at(0.2)
    assert soft.closed_at(np.array([0.2, 0.0]), 0.0) == (0,)


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [math.inf, 100.0])
@pytest.mark.parametrize("guess", [[math.nan, 0.0], [0.0, math.nan]])
def test_a_motion_that_is_no_number_is_refused(stiffness, guess):
    family = mass_on_stop(stiffness).over("freq_hz", freq_hz=0.2)
    with pytest.raises(ct.NumericsError, match=r"the motion is not a number after \d"):
        shooting.map_of(family, 0.2)(np.array(guess))


@pytest.mark.slow
def test_more_hits_than_are_counted_in_a_period_are_chatter(monkeypatch):
    """Three bounces of a ball, each one event."""
    w, e, force = 20.0, 0.5, 12.0
    height, velocity, start, _ = ball_orbit(force, w, e)
    family = ball(force, e).over("freq_hz", freq_hz=w / TURN)
    three = shooting.map_of(family, w / TURN, start, 3)
    state = family.state([height], [velocity])
    monkeypatch.setattr(passage, "EVENTS", 3)
    assert len(three(state).events) == 3
    monkeypatch.setattr(passage, "EVENTS", 2)
    with pytest.raises(ct.NumericsError, match=r"found over 2 openings and closings in 0\.\d+ s: the contact chatters"):
        three(state)


@pytest.mark.parametrize("stiffness", [0.0, -1.0, math.nan])
def test_a_coating_that_holds_nothing_is_refused(stiffness):
    rim = ct.RotatingRim(ring(), blade(), clearance=1e-5, speed_hz=5.0)
    assert ct.cycles.RimFamily(rim=rim, stiffness=1e-300).stiffness == 1e-300
    with pytest.raises(ct.InputError, match=rf"stiffness: found {stiffness} N/m, expected > 0 \(inf: no coating\)"):
        ct.cycles.RimFamily(rim=rim, stiffness=stiffness)


def test_a_step_is_halved_four_times_until_it_leads_to_a_motion():
    x, change, last = np.array([1.0, 2.0]), np.array([16.0, -32.0]), None

    def follow(trial, *, refused):
        nonlocal last
        if abs(trial[0] - x[0]) > refused:
            raise ct.NumericsError("chatter")
        last = SimpleNamespace(x=trial)
        return last

    nearer = shooting._nearer(lambda trial: follow(trial, refused=1.0), x, SimpleNamespace(x=x + 1.0), change)
    assert nearer[0].tolist() == [2.0, 0.0]
    assert nearer[1] is last
    with pytest.raises(ct.NumericsError, match="no step of Newton's method leads to a motion that can be followed"):
        shooting._nearer(lambda trial: follow(trial, refused=0.99), x, SimpleNamespace(x=x + 1.0), change)


def flight(closes_until):
    """A period of 2 s from 10 s on, in which a rigid contact is closed but for its last part."""
    events = (Event(10.0, 0, True, True, 0.0), Event(closes_until, 0, False, False, 0.0))
    return SimpleNamespace(start=10.0, events=events), SimpleNamespace(plant=SimpleNamespace(rigid=np.array([True])))


def test_a_rigid_contact_is_open_for_a_thousandth_of_the_period_or_closed_at_all_times():
    assert shooting._free_time(*flight(11.9979), 2.0) == pytest.approx(1.99895, rel=1e-12)
    with pytest.raises(ct.NumericsError, match="some rigid contact is closed at all times: give the contacts a compl"):
        shooting._free_time(*flight(11.9981), 2.0)


@pytest.mark.slow
def test_a_ball_that_its_table_never_throws_up_has_no_free_start():
    """Without rebound it rests where the table's acceleration stays below g."""
    with pytest.raises(ct.NumericsError, match="some rigid contact is closed at all times"):
        ct.cycles.orbit(ball(9.0, 0.0).over("freq_hz", freq_hz=1.0), 1.0, settle=5)
    thrown = ct.cycles.orbit(ball(11.0, 0.0).over("freq_hz", freq_hz=1.0), 1.0, settle=5)
    assert thrown.gap[0] == pytest.approx(0.0, abs=1e-12)
    assert thrown.amplitude["y"] > 1e-3


@pytest.mark.slow
def test_newtons_method_ends_after_its_steps(monkeypatch):
    family = mass_on_stop(5.0).over("freq_hz", freq_hz=0.16)
    found = ct.cycles.orbit(family, 0.16, guess=np.array([0.05, 0.0]))
    assert found.iterations > 2
    monkeypatch.setattr(shooting, "NEWTON", found.iterations - 1)
    again = ct.cycles.orbit(family, 0.16, guess=np.array([0.05, 0.0]))
    assert np.array_equal(again.x, found.x)
    monkeypatch.setattr(shooting, "NEWTON", found.iterations - 2)
    words = rf"freq_hz = 0\.16: no orbit of period 1 after {found.iterations - 2} Newton steps, the last .* begin else"
    with pytest.raises(ct.NumericsError, match=words):
        ct.cycles.orbit(family, 0.16, guess=np.array([0.05, 0.0]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "between"), [("amplitude", (0.02, 0.0)), ("clearance", (0.1, 0.0)), ("freq_hz", (0.16, 0.01))]
)
def test_a_branch_ends_on_the_edge_of_its_range_though_nothing_is_beyond(name, between):
    """No amplitude, no clearance below zero: steps beyond cannot be tried."""
    family = mass_on_stop(5.0).over(name, freq_hz=0.16)
    found = [ct.cycles.follow(family, way, longest=0.5).branches for way in (between, between[::-1])]
    for branches in found:  # where the mass comes to touch the stop, one ends and the next begins
        assert set(between) <= {at.value for way in branches for at in way.points}
    last, first = found[0][-1].points[-1], found[1][0].points[0]
    assert np.allclose(first.x, last.x, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("state", "words"),
    [
        (np.zeros(3), r"shape \(3,\), expected \(2,\), displacements and then velocities"),
        (np.zeros((1, 2)), r"shape \(1, 2\), expected \(2,\)"),
        ([np.inf, 0.0], r"entries that are NaN or infinite or huge, expected numbers below 1e\+30"),
        ([0.0, np.nan], "entries that are NaN"),
        ([0.0, 1e30], "entries that are NaN"),
    ],
)
def test_what_is_no_state_is_refused(state, words):
    family = mass_on_stop(5.0).over("freq_hz", freq_hz=0.16)
    with pytest.raises(ct.InputError, match=f"^guess: found {words}"):
        ct.cycles.orbit(family, 0.16, guess=state)
    with pytest.raises(ct.InputError, match=f"^size: found {words}"):
        ct.cycles.basins(family, 0.16, state, seed=1)


@pytest.mark.slow
def test_a_run_that_changes_by_1e30_in_a_period_grows_without_bound():
    """An undamped mode of half the frequency is at -x after a period: it changes by 2 x."""
    body = ct.ModalBody(omega=[1.0], zeta=[0.0], channels=("x", "stop"), rows=[[1.0], [1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=1e31)
    driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=1.0, stiffness=1.0)
    family, hz = driven.over("freq_hz", freq_hz=2.0 / TURN), 2.0 / TURN
    x, at = shooting.settled(family, hz, 1, x=np.array([0.49e30, 0.0]))
    assert x == pytest.approx([-0.49e30, 0.0], rel=1e-12, abs=1e18)
    assert at == 0.0
    with pytest.raises(ct.NumericsError, match=r"freq_hz = 0\.31830989: a run grows without bound"):
        shooting.settled(family, hz, 1, x=np.array([0.51e30, 0.0]))


def test_rigid_contacts_that_are_all_but_one_are_told_by_number():
    """Rows of any size at an angle d: the condition of their impulses is 4 d^-2, at most 1e12."""

    def closed(d, size):
        return phase_of(before([[-1.0, 0.0], [-size, -d * size]]).over("freq_hz", freq_hz=1.0).plant, (0, 1))

    for size in (1.0, 1e-9, 1e9):
        impulses = np.array([[1.0, size], [size, size**2]]) + np.diag([0.0, (2.01e-6 * size) ** 2])
        assert closed(2.01e-6, size).solve @ impulses == pytest.approx(np.eye(2), abs=1e-3 * max(size, 1.0 / size))
        with pytest.raises(ct.InputError, match=r"contact: rigid contacts 1, 2 are not independent, expected a compl"):
            closed(1.99e-6, size)


@pytest.mark.parametrize("d", [1e-3, 0.99e-6, 1e-12, 1e12])
def test_rigid_contacts_across_each_other_are_independent_whatever_their_sizes(d):
    plant = before([[-1.0, 0.0], [0.0, -d]]).over("freq_hz", freq_hz=1.0).plant
    assert phase_of(plant, (0, 1)).solve == pytest.approx(np.diag([1.0, d**-2]), rel=1e-12)


def test_modes_that_have_become_one_are_refused():
    """x' = y, y' = -d^2 x: the eigenvectors (1, +-i d) have the condition 1/d, below 1e11."""

    def free(d):
        none = np.zeros
        plant = Plant(A=np.array([[0.0, 1.0], [-d * d, 0.0]]), B=none((2, 0)), C=none((0, 2)), S=none((0, 0)),
                      D=none((0, 2)), E=none((0, 0)), restitution=none(0), rate=1.0)  # fmt: skip
        return phase_of(plant, ())

    assert free(1.01e-11).lam == pytest.approx([1.01e-11j], rel=1e-12)
    with pytest.raises(ct.NumericsError, match=r"contacts closed \(\): found two modes that have become one, expected"):
        free(0.99e-11)


@pytest.mark.slow
@pytest.mark.parametrize(("taken", "refused"), [(1.99, 2.01), (-0.99, -1.01)])
def test_an_orbit_further_from_the_range_than_its_length_is_not_looked_for(taken, refused):
    """The range is 2 to 3 N; before contact the motion is as large as its force."""
    family = oscillator(0.8, 0.05, 100.0).over("amplitude", freq_hz=0.3)
    at = ct.cycles.orbit(family, 2.0, guess=np.zeros(2))
    course, along = Course(family=family, low=2.0, high=3.0, size=1e-3), Tangent(np.zeros(2), 1.0)
    found = course.next(at, along, taken)
    assert found.value == pytest.approx(2.0 + taken, rel=1e-12)
    assert found.x == pytest.approx((1.0 + 0.5 * taken) * at.x, rel=1e-9)
    with pytest.raises(ct.NumericsError, match=rf"no orbit after 8 Newton steps near amplitude = {2.0 + refused:.8g}"):
        course.next(at, along, refused)


def gravity_on(rub):
    bodies = [replace(body, participation=np.ones((3, body.omega.size))) for body in rub.bodies]
    return replace(rub, casing=bodies[0], blades=bodies[1:], forces=[ct.gaps.BodyForce.gravity()])


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (gravity_on, "gravity"),
        (lambda rub: replace(rub, closing=ct.gaps.Closing(time=[0.0, 1.0], by=[0.0, -1e-5])), "closing"),
        (lambda rub: replace(rub, blade_starts=[ct.gaps.Start(load=[0.0, 1.0])]), "load"),
        (lambda rub: replace(rub, whirl=[ct.gaps.Whirl(amplitude=1e-6, per_rev=-0.5)]), "whirl"),
    ],
)
def test_what_has_no_period_of_a_turn_is_named(change, word):
    """A load of zeros, a closing by nothing and a whirl in whole turns have one."""
    still = {
        "closing": ct.gaps.Closing(time=[0.0, 1.0], by=[0.0, 0.0]),
        "casing_start": ct.gaps.Start(load=np.zeros(10)),
    }
    rub = ct.Rub(ring(), (blade(),), whirl=[ct.gaps.Whirl(amplitude=1e-6, per_rev=-3.0)], **still)
    assert ct.cycles.RimFamily(rim=rub).at(-4.0)[1] == pytest.approx(0.125, rel=1e-12)
    with pytest.raises(ct.InputError, match=rf"^{word}: found one, which periodic motions of a rub do not take; long"):
        ct.cycles.RimFamily(rim=change(rub))


def axial_ring():
    """One pair of two diameters that moves along the radius alone, and gives way along all three."""
    rows = np.zeros((15, 2))
    rows[2, 0] = rows[4, 1] = 1.0
    return ct.ModalBody(
        omega=[300.0] * 2,
        zeta=[0.01] * 2,
        channels=ct.bodies.rim_channels(2, 3),
        rows=rows,
        S=1e-8 * np.eye(15),
        kind="rim",
        n_max=2,
        radius=0.4,
    )


def test_friction_along_the_axis_is_for_long_runs():
    three = ct.ModalBody(
        omega=[1000.0], zeta=[0.01], channels=("span", "flap", "chord"), rows=np.ones((3, 1)), S=1e-8 * np.eye(3)
    )
    rub = ct.Rub(axial_ring(), (three,), (ct.ContactPoint(axial="chord"),))
    assert ct.cycles.RimFamily(rim=rub).mu == 0.0
    with pytest.raises(ct.InputError, match=r"^tips\.axial: found one, which periodic motions of a rub do not take"):
        ct.cycles.RimFamily(rim=rub, mu=0.1)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_drive_is_at_a_resonance_within_1e_12_of_its_frequency(sense):
    body = ct.ModalBody(omega=[TURN], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]])
    patch = ct.Patch(body=body, normal=("x",), clearance=1.0)
    driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=1.0, stiffness=1.0)
    family = driven.over("freq_hz", freq_hz=1.0)
    motion, _ = family.at(1.0 + sense * 1.1e-12)
    assert np.abs(motion.phase(()).X[0, 0]) == pytest.approx(1.0 / (2.0 * TURN**2 * 1.1e-12), rel=1e-3)
    motion, _ = family.at(1.0 + sense * 0.9e-12)
    with pytest.raises(
        ct.NumericsError, match="the drive is at the resonance of an undamped mode, expected damping or"
    ):
        motion.phase(())
