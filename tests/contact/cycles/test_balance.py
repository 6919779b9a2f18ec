"""Harmonic balance against exact solutions, against shooting, and where it must not be believed."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from reports.verification.outside.two_masses import FOLDS, masses
from reports.verification.schemes.cycles import mass_on_stop, rod
from tests.contact.cycles.bodies import random_body
from tests.contact.cycles.test_rubbing import rim

pytestmark = pytest.mark.slow
TURN = 2.0 * math.pi


def turns(motions):
    """Values at which a branch turns back."""
    value = np.array([motion.value for motion in motions])
    step = np.diff(value)
    return value[1:-1][step[1:] * step[:-1] < 0.0]


def test_a_mass_that_does_not_touch_has_the_amplitude_of_the_linear_oscillator():
    driven = mass_on_stop(100.0)
    for w in (0.3, 0.8, 1.7):
        found = ct.cycles.balance(driven.over("freq_hz", freq_hz=w / TURN), w / TURN, harmonics=3)
        assert found.amplitude["x"] == pytest.approx(0.02 / abs(1.0 - w**2 + 0.05j * w), rel=1e-12)
        assert found.contacts == 0
        assert abs(found.displacement["x"][1] - 0.02 / (1.0 - w**2 + 0.05j * w)) < 1e-15


def test_a_bilinear_oscillator_resonates_at_the_harmonic_mean_of_its_two_frequencies():
    """Without clearance omega = 2 w1 w2/(w1 + w2), here 4/3; the error is of second order in the damping, 1e-3."""
    body = ct.ModalBody(omega=[1.0], zeta=[0.001], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=0.0)
    driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=1.0, stiffness=3.0, shown=("x",))
    motions = ct.cycles.balance_branch(driven.over("freq_hz", freq_hz=0.2), (1.32 / TURN, 1.35 / TURN), longest=0.1)
    amplitude = np.array([motion.amplitude["x"] for motion in motions])
    value = TURN * np.array([motion.value for motion in motions])
    k = int(amplitude.argmax())
    bend, slope, _ = np.polyfit(value[k - 1 : k + 2] - value[k], amplitude[k - 1 : k + 2], 2)
    assert value[k] - 0.5 * slope / bend == pytest.approx(4.0 / 3.0, rel=3e-6)


@pytest.mark.parametrize(("driven", "value"), [(mass_on_stop(100.0), 0.16), (rod(4.0), 1.01e4)])
def test_amplitudes_converge_to_those_of_shooting_with_the_third_power_of_the_harmonics_or_faster(driven, value):
    family = driven.over("freq_hz", freq_hz=value)
    exact = ct.cycles.orbit(family, value).amplitude["x"]
    few, many = (abs(ct.cycles.balance(family, value, harmonics=H).amplitude["x"] / exact - 1.0) for H in (10, 80))
    assert 1e-3 < few < 5e-3
    assert many < few / 8**3
    assert many < 1e-6


@pytest.mark.parametrize("start", [0.0, 0.1, 0.37, 0.6])
def test_an_orbit_is_nearly_its_balance_wherever_it_starts(start):
    family = mass_on_stop(100.0).over("freq_hz", freq_hz=0.16)
    first = ct.cycles.orbit(family, 0.16)
    orbit = ct.cycles.orbit(family, 0.16, start=start, guess=first.x)
    assert orbit.start == start
    found = ct.cycles.balance(family, 0.16, harmonics=40, guess=orbit)
    assert found.iterations <= 2
    assert ct.cycles.balance(family, 0.16, harmonics=40).y == pytest.approx(found.y, abs=1e-6 * np.abs(found.y).max())


def test_contacts_that_press_on_a_common_compliance_move_as_in_shooting():
    driven = random_body(3, 2, compliance=0.02)
    S = np.array(driven.patch.body.S)
    S[0, 0], S[1, 2], S[2, 1] = 0.03, 0.012, 0.012
    body = replace(driven.patch.body, S=S)
    family = replace(driven, patch=replace(driven.patch, body=body)).over("freq_hz", freq_hz=0.4)
    found = ct.cycles.balance(family, 0.4, harmonics=80)
    orbit = ct.cycles.orbit(family, 0.4, guess=found.x)
    assert orbit.contacts == 2
    assert found.amplitude["d"] == pytest.approx(orbit.amplitude["d"], rel=1e-4)
    assert np.array(found.x) == pytest.approx(np.array(orbit.x), abs=1e-3 * np.linalg.norm(orbit.x))


def test_a_rub_with_friction_moves_as_in_shooting():
    """Its blade vibrates at 180 times the speed and touches sixteen times a turn."""
    family = ct.cycles.RimFamily(rim=rim(), mu=0.05)
    orbit = ct.cycles.orbit(family, 5.0)
    assert orbit.closings == (16,)
    found = ct.cycles.balance(family, 5.0, harmonics=500, guess=orbit)
    assert found.amplitude == pytest.approx(orbit.amplitude, rel=1e-4)
    with pytest.raises(ct.InputError, match=r"harmonics: found 1, expected \d+ or more, the highest of the forcing"):
        ct.cycles.balance(family, 5.0, harmonics=1)


def test_two_masses_turn_back_at_the_folds_of_nlvib_and_agree_with_shooting(held):
    family = masses().over("freq_hz", freq_hz=0.1)
    between = 0.6 / TURN, 0.8 / TURN
    assert TURN * np.sort(turns(ct.cycles.balance_branch(family, between, longest=0.04)))[[0, -1]] == pytest.approx(
        FOLDS, rel=2e-4
    )
    agreement = ct.cycles.balance_check(family, ct.cycles.follow(family, between, longest=0.1))
    assert agreement.found == agreement.value.size
    assert 1e-9 < agreement.worst[0] < 1e-3
    assert agreement.worst[1] < 1e-4
    held(1e-4, value=agreement.value, counts=[agreement.found, agreement.value.size])


def test_a_branch_is_the_same_from_either_end(held):
    family = mass_on_stop(9.0).over("freq_hz", freq_hz=0.2)
    up, down = (ct.cycles.balance_branch(family, ends, longest=0.3) for ends in ((0.13, 0.15), (0.15, 0.13)))
    assert (up[0].value, up[-1].value) == (down[-1].value, down[0].value) == (0.13, 0.15)
    assert up[-1].amplitude["x"] == pytest.approx(down[0].amplitude["x"], rel=1e-6)
    assert down[-1].amplitude["x"] == pytest.approx(up[0].amplitude["x"], rel=1e-6)
    held(1e-4, up=[x for one in up for x in (one.value, one.period, *one.amplitude.values())])


def test_a_range_from_clearance_zero_is_compared_with_harmonic_balance():
    family = mass_on_stop(9.0).over("clearance", freq_hz=0.2)
    found = ct.cycles.follow(family, (0.0, 0.1), longest=0.5)
    agreement = ct.cycles.balance_check(family, found)
    assert agreement.value[0] == 0.0
    assert agreement.found == agreement.value.size
    assert agreement.worst[0] < 1e-3
    assert agreement.worst[1] < 1e-3


def test_a_false_turning_point_of_a_short_series_is_no_fold(held):
    """A mass before a stop of 1e5 times its stiffness has no fold in this range; three harmonics turn back in it."""
    family = mass_on_stop(1e5).over("freq_hz", freq_hz=0.2)
    false = turns(ct.cycles.balance_branch(family, (0.16, 0.26), harmonics=3, longest=0.04))
    assert false.size
    assert false.max() == pytest.approx(0.25432, rel=1e-4)
    found = ct.cycles.follow(family, (0.16, 0.26), longest=0.1)
    assert not [mark for mark in found.marks() if mark["kind"] == "fold"]
    assert found.branches[0].points[-1].value == 0.26
    agreement = ct.cycles.balance_check(family, found, harmonics=3)
    assert agreement.found < agreement.value.size
    assert "take more harmonics" in agreement.words
    held(1e-4, false=np.sort(false), value=agreement.value, found=[agreement.found])


def test_follow_starts_from_harmonic_balance_where_no_run_settles():
    """With damping of 1e-4 a run of 200 periods is far from settled, and Newton's method leads nowhere from there."""
    driven = rod(4.0)
    body = replace(driven.patch.body, zeta=np.full(20, 1e-4))
    family = replace(driven, patch=replace(driven.patch, body=body)).over("freq_hz", freq_hz=1.01e4)
    with pytest.raises(ct.NumericsError, match="found no orbit of 1 periods"):
        ct.cycles.orbit(family, 1.01e4)
    (branch,) = ct.cycles.follow(family, (1.01e4, 1.02e4), most=2).branches
    near = ct.cycles.balance(family, 1.01e4)
    assert branch.points[0].amplitude["x"] == pytest.approx(near.amplitude["x"], rel=1e-3)


def test_harmonic_balance_refuses_rigid_contacts_and_bad_numbers():
    family = mass_on_stop(100.0).over("freq_hz", freq_hz=0.2)
    rigid = mass_on_stop().over("freq_hz", freq_hz=0.2)
    for call in (lambda: ct.cycles.balance(rigid, 0.2), lambda: ct.cycles.balance_branch(rigid, (0.2, 0.21))):
        with pytest.raises(ct.InputError, match="contact 1: found a rigid contact, expected one with a compliance"):
            call()
    with pytest.raises(ct.InputError, match="harmonics"):
        ct.cycles.balance(family, 0.2, harmonics=0)
    with pytest.raises(ct.InputError, match=r"value: found nan"):
        ct.cycles.balance(family, math.nan)
    with pytest.raises(ct.InputError, match="harmonics: found 1, expected 2 or more"):
        ct.cycles.balance(family, 0.2, harmonics=1, periods=2)
    with pytest.raises(ct.InputError, match="expected two different ends"):
        ct.cycles.balance_branch(family, (0.2, 0.2))
    two = ct.cycles.balance(random_body(3, 2, stiffness=9.0).over("freq_hz", freq_hz=0.4), 0.4)
    with pytest.raises(ct.InputError, match="guess: found 2 contacts, expected 1"):
        ct.cycles.balance(family, 0.2, guess=two)


def test_harmonic_balance_refuses_friction_that_would_turn():
    """A ground that moves slower than the body slips back in each period."""
    body = ct.ModalBody(omega=[1.0, 1.3], zeta=[0.1] * 2, channels=("n", "t"), rows=np.array([[1.0, 0.4], [0.4, 1.0]]),
                        S=np.zeros((2, 2)))  # fmt: skip
    patch = ct.Patch(body=body, normal=("n",), tangent=(("t",),), slide=[[0.05]], clearance=0.1)
    driven = ct.cycles.DrivenBody(patch=patch, channel="n", amplitude=1.0, stiffness=5.0, mu=0.2)
    with pytest.raises(ct.NumericsError, match="change from slip to stick"):
        ct.cycles.balance(driven.over("freq_hz", freq_hz=0.16), 0.16)
