"""Motions that cannot be followed, and orbits that are not there, are refused; what is next to them is taken."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from reports.verification.schemes.cycles import mass_on_stop
from tests.contact.cycles.test_closed_forms import ball
from tests.contact.synthetic_rim import blade, ring

TURN = 2.0 * math.pi
BLOCK = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.1] * 2, channels=("n", "t"), rows=np.eye(2), S=np.zeros((2, 2)))


def before(rows, **given):
    """Two modes before as many stops as rows."""
    names = tuple(f"stop{k}" for k in range(len(rows)))
    body = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.01] * 2, channels=names, rows=rows, S=np.zeros((len(rows),) * 2))
    patch = ct.Patch(body=body, normal=names, clearance=1.0)
    return ct.cycles.DrivenBody(patch=patch, channel=names[0], amplitude=1.0, **given)


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
    with pytest.raises(ct.InputError, match="body: found frequencies, shapes or compliances whose products overflow"):
        before([[large, 0.0]], stiffness=1.0).over("freq_hz", freq_hz=1.0)


def test_a_start_inside_a_rigid_contact_is_refused():
    """By more than 1e-9 of what adds up to the gap, .1 + .1."""
    motion, _ = mass_on_stop().over("freq_hz", freq_hz=0.2).at(0.2)
    assert motion.closed_at(np.array([0.1 + 1.9e-10, 0.0]), 0.0) == ()
    with pytest.raises(ct.NumericsError, match="closed at the start of the period"):
        motion.closed_at(np.array([0.1 + 2.1e-10, 0.0]), 0.0)
    soft, _ = mass_on_stop(100.0).over("freq_hz", freq_hz=0.2).at(0.2)
    assert soft.closed_at(np.array([0.2, 0.0]), 0.0) == (0,)


@pytest.mark.parametrize("stiffness", [0.0, -1.0, math.nan])
def test_a_coating_without_effect_is_refused(stiffness):
    rim = ct.RotatingRim(ring(), blade(), clearance=1e-5, speed_hz=5.0)
    assert ct.cycles.RimFamily(rim=rim, stiffness=1e-300).stiffness == 1e-300
    with pytest.raises(ct.InputError, match=rf"stiffness: found {stiffness} N/m, expected > 0 \(inf: no coating\)"):
        ct.cycles.RimFamily(rim=rim, stiffness=stiffness)


@pytest.mark.slow
def test_a_ball_that_its_table_never_throws_up_has_no_free_start():
    """Without rebound it rests where the table's acceleration stays below g."""
    with pytest.raises(ct.NumericsError, match="found a rigid contact that never opens"):
        ct.cycles.orbit(ball(9.0, 0.0).over("freq_hz", freq_hz=1.0), 1.0, settle=5)
    thrown = ct.cycles.orbit(ball(11.0, 0.0).over("freq_hz", freq_hz=1.0), 1.0, settle=5)
    assert thrown.gap[0] == pytest.approx(0.0, abs=1e-12)
    assert thrown.amplitude["y"] > 1e-3


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
        (np.zeros(3), r"shape \(3,\), expected \(2,\): displacements, then velocities"),
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
    with pytest.raises(ct.InputError, match=rf"^{word}: found one, expected none for periodic motions of a rub"):
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
    with pytest.raises(ct.InputError, match=r"^tips\.axial: found one, expected none for periodic motions of a rub"):
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
        ct.NumericsError, match="found a drive at the resonance of an undamped mode, expected damping or"
    ):
        motion.phase(())
