"""Rims before one blade that cannot be, and laws of contact where nothing is said."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3


def rim(**more):
    given = {"casing": ring(), "blade": blade(), "clearance": 1e-5, "speed_hz": 5.0} | more
    return ct.RotatingRim(given.pop("casing"), given.pop("blade"), **given)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"casing": blade()}, "casing: found a basis of kind 'point', expected 'rim'"),
        ({"casing": rim3(lines=1)}, "casing: found 1 rim lines in 3 directions, expected one line"),
        ({"blade": ring()}, "blade: found a basis of kind 'rim', expected 'point'"),
        ({"blade": nodes(1)}, r"blade: found the channels node0\.span, .*, expected span and flap"),
        ({"casing": replace(ring(), radius=0.0)}, r"radius: found 0\.0"),
        ({"clearance": math.nan}, "clearance: found nan"),
        ({"speed_hz": math.inf}, "speed_hz: found inf"),
        ({"angle_deg": math.nan}, "angle_deg: found nan"),
        (
            {"clearance": 0.0451},
            r"clearance: found 0\.0451 m, expected between -0\.045 and 0\.045 m, a tenth",
        ),
        ({"clearance": -0.0451}, r"clearance: found -0\.0451 m"),
        ({"lean_deg": 90.0}, r"lean_deg: found 90\.0, expected an angle between"),
        ({"lean_deg": -90.0}, r"lean_deg: found -90\.0"),
        ({"casing_velocity": [1.0]}, r"casing_velocity: found shape \(1,\), expected \(10,\)"),
        ({"blade_velocity": [1.0]}, r"blade_velocity: found shape \(1,\), expected \(2,\)"),
        ({"out_of_roundness": [{"p": 2, "cos": 0.03, "sin": 0.04}]}, r"out_of_roundness: found 0\.05 m on a radius"),
        ({"out_of_roundness": [{"p": 2, "cos": math.nan}]}, r"out_of_roundness\.cos: found nan"),
        ({"out_of_roundness": [{"p": 2, "sin": math.inf}]}, r"out_of_roundness\.sin: found inf"),
        ({"out_of_roundness": [{"p": 2.5, "sin": 0.0}]}, r"out_of_roundness: found p = 2\.5, expected a whole number"),
        ({"out_of_roundness": [{"p": -1}]}, "out_of_roundness: found p = -1"),
    ],
)
def test_rims_that_cannot_be_are_refused(change, words):
    with pytest.raises(ct.InputError, match=words):
        rim(**change)


def test_what_a_rim_is_where_nothing_is_stated():
    one = rim(clearance=0.045)
    assert (one.lean_deg, one.angle_deg, one.out_of_roundness) == (0.0, 0.0, ())
    assert (one.casing_velocity, one.blade_velocity) == (None, None)
    assert rim(clearance=-0.045, lean_deg=-89.9).clearance == -0.045
    assert one.speed == pytest.approx(10.0 * math.pi)
    shaped = rim(out_of_roundness=[{"p": 2.0, "cos": 0.027, "sin": 0.036}, {"p": 0, "sin": 0.0}])
    assert shaped.terms == [(2, 0.027, 0.036), (0, 0.0, 0.0)]
    with pytest.raises(ct.InputError, match="clearance: found -1e-09"):
        ct.PointGap(sides=(ct.gaps.Side(body=blade(), channel="flap", sign=1),), clearance=-1e-9)


def test_the_blades_motion_along_the_contact_normal_leans():
    name, row = rim(lean_deg=30.0).blade_normal()
    span, flap = blade().rows
    assert name == "blade"
    np.testing.assert_allclose(row, math.cos(math.pi / 6) * span + 0.5 * flap, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "value"),
    [("E", 0.0), ("yield_stress", 0.0), ("thickness", 0.0), ("width", 0.0), ("tip", 0.0), ("hardening", -1.0),
     ("machined", -1.0), ("mu", -0.1), ("bars", 0), ("bars", 2.5), ("machined", 2.1)],
)  # fmt: skip
def test_coatings_that_cannot_be_are_refused(name, value):
    given = {"E": 4.0, "yield_stress": 5.0, "hardening": 6.0, "thickness": 2.0, "width": 0.5, "tip": 0.25}
    with pytest.raises(ct.InputError, match=f"{name}: found {value}"):
        ct.Abradable(**given | {name: value})
    assert ct.Abradable(**given, machined=2.0).machined == 2.0


@pytest.mark.parametrize("name", ["stiffness", "updates", "tolerance"])
def test_numbers_of_an_augmented_lagrangian_are_above_zero(name):
    with pytest.raises(ct.InputError, match=f"{name}: found 0"):
        ct.laws.AugmentedLagrangian(**{"stiffness": 1.0} | {name: 0})
    if name == "stiffness":
        with pytest.raises(ct.InputError, match="stiffness: found 0"):
            ct.Penalty(stiffness=0.0)
        with pytest.raises(ct.InputError, match=r"mu: found -0\.1"):
            ct.Coulomb(mu=-0.1)
