"""A gap and a law of a user's own: what schemes need of them, and no more."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact as ct

STEP = {"t_end": 0.02, "dt": 1e-6}


@dataclass(frozen=True)
class Lever:
    """An oscillator before a stop, seen through a lever, as matrices and as one mode."""

    mass: float = 2.0
    stiffness: float = 3e5
    ratio: float = 1.5
    clearance: float = 1e-4
    velocity: float = -0.4
    crossing_time = math.inf
    in_order = True

    def linear_form(self):
        return ct.LinearBody(
            M=np.array([self.mass]), K=np.array([[self.stiffness]]), Q=np.array([[self.ratio]]),
            gap0=np.array([self.clearance]), velocity=np.array([self.velocity]),
        )  # fmt: skip


@dataclass(frozen=True)
class LeverMode(Lever):
    def modal_form(self, modes):
        root = math.sqrt(self.mass)
        body = ct.ModalBody(
            omega=[math.sqrt(self.stiffness) / root], zeta=[0.0], channels=("lever",), rows=[[self.ratio / root]],
            S=[[0.0]],
        )  # fmt: skip
        side = ct.gaps.Side(body=body, channel="lever", sign=1, velocity=np.array([root * self.velocity]))
        return ct.gaps.point_system(ct.PointGap(sides=(side,), clearance=self.clearance))


@dataclass(frozen=True)
class Spring:
    stiffness: float
    updates: int = 0
    tolerance: float = 0.0
    mu: float = 0.0
    coating: None = None
    response: None = None
    words: str = "my spring"


@pytest.mark.slow
def test_a_gap_of_ones_own_is_what_the_same_body_is():
    lever = Lever()
    own, same = (
        ct.run(what, scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55), **STEP) for what in (lever, lever.linear_form())
    )
    assert own.impulse[0] > 0.0
    assert np.array_equal(own.force, same.force)
    assert np.array_equal(own.gap, same.gap)


@pytest.mark.slow
def test_its_modal_form_runs_under_exact_modal():
    exact = ct.run(LeverMode(), scheme=ct.ExactModal(), **STEP)
    free = math.sqrt(3e5 / 2.0)
    touches = math.asin(1e-4 * free / (1.5 * 0.4)) / free  # ratio v/omega sin(omega t) = clearance
    assert exact.intervals[0][0][0] == pytest.approx(touches, abs=2e-6)
    assert exact.impulse[0] == pytest.approx(ct.run(Lever(), **STEP).impulse[0], rel=1e-3)


@pytest.mark.slow  # compiles the loops of both
@pytest.mark.parametrize("scheme", [ct.scheme.PenaltyDifference(), ct.scheme.Newmark(), ct.scheme.HHT()])
def test_a_law_of_ones_own_is_what_the_same_spring_is(scheme):
    own, same = (ct.run(Lever(), law=law, scheme=scheme, **STEP) for law in (Spring(4e6), ct.Penalty(stiffness=4e6)))
    assert own.impulse[0] > 0.0
    assert np.array_equal(own.force, same.force)
    assert "my spring" in own.scheme


@pytest.mark.slow
def test_a_scheme_is_chosen_by_the_kind_of_the_law_and_refuses_what_it_does_not_know():
    assert "my spring" in ct.run(Lever(), law=Spring(4e6), **STEP).scheme
    with pytest.raises(ct.InputError, match=r"law: found Spring\(.*updates=5.*expected Unilateral"):
        ct.run(Lever(), law=Spring(4e6, updates=5, tolerance=1e-9), scheme=ct.CentralDifference(), **STEP)
    with pytest.raises(ct.InputError, match=r"law: found Spring.*for ExactModal"):
        ct.run(LeverMode(), law=Spring(4e6, updates=5, tolerance=1e-9), scheme=ct.ExactModal(), **STEP)


def test_what_has_no_form_is_refused_by_name():
    @dataclass(frozen=True)
    class Nothing:
        x: float = 0.0

    with pytest.raises(ct.InputError, match="found ExactModal for Nothing, expected"):
        ct.run(Nothing(), **STEP)
    with pytest.raises(ct.InputError, match="found Newmark for Nothing, expected ExactModal"):
        ct.run(Nothing(), scheme=ct.scheme.Newmark(), **STEP)
    with pytest.raises(ct.InputError, match="bodies: found Nothing, expected Rod, PointMass or Wall"):
        ct.run([Nothing(), ct.Wall()], **STEP)
    with pytest.raises(ct.InputError, match=r"gravity: found 9.81 m/s.2 with Lever, expected gravity as a load"):
        ct.run(replace(Lever(), ratio=1.0), gravity=9.81, **STEP)
