"""What a rub consists of, by hand: directions of tips, their arrays and compliance, forces on bodies and their rest."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips


def test_directions_of_a_leaning_tip():
    body = ct.ModalBody(omega=[1.0], zeta=[0.0], channels=("u", "chord", "flap", "span"), rows=np.ones((4, 1)),
                        S=np.eye(4))  # fmt: skip
    c, s = math.cos(math.radians(25.0)), math.sin(math.radians(25.0))
    found = ct.ContactPoint(lean_deg=25.0, axial="chord").directions(body)
    np.testing.assert_allclose(found, [[0, 0, s, c], [0, 0, c, -s], [0, 1, 0, 0]], rtol=1e-14)
    assert ct.ContactPoint().directions(body).tolist() == [[0, 0, 0, 1], [0, 0, 1, 0]]
    plain = ct.ContactPoint()
    assert (plain.blade, plain.line, plain.axial, plain.track) == (0, 0, None, None)
    assert (plain.angle_deg, plain.lean_deg, plain.clearance) == (0.0, 0.0, 0.0)
    assert ct.ContactPoint(track=0).track == 0


@pytest.mark.parametrize(
    ("name", "value"),
    [("track", -1), ("angle_deg", math.nan), ("clearance", math.inf), ("lean_deg", 90.0), ("lean_deg", -90.0),
     ("lean_deg", math.nan)],
)  # fmt: skip
def test_tips_that_cannot_be_are_refused(name, value):
    with pytest.raises(ct.InputError, match=f"{name}: found {value}"):
        ct.ContactPoint(**{name: value})
    assert ct.ContactPoint(lean_deg=89.9).lean_deg == -ct.ContactPoint(lean_deg=-89.9).lean_deg


def test_a_blade_stiffens_from_the_speed_of_its_own_basis():
    body = replace(blade(), stiffness_by_speed=np.array([[1.5, 0.4], [0.4, 2.5]]), spin=6.0 * math.pi)
    found = ct.gaps.Stiffening.of(body, 2)
    assert (found.blade, found.at_hz) == (2, pytest.approx(3.0, rel=1e-14))
    assert found.stiffness_by_speed.tolist() == [[1.5, 0.4], [0.4, 2.5]]
    assert ct.gaps.Stiffening.of(body).blade == 0
    assert (ct.gaps.Stiffening().blade, ct.gaps.Stiffening().at_hz, ct.gaps.Stiffening().stiffness_by_speed.shape) == (
        0,
        0.0,
        (0, 0),
    )
    with pytest.raises(
        ct.InputError, match=r"blades\[2\]: found a basis without stiffness_by_speed, expected one of a rotating"
    ):
        ct.gaps.Stiffening.of(blade(), 2)
    with pytest.raises(ct.InputError, match="at_hz: found nan"):
        ct.gaps.Stiffening(at_hz=math.nan)


def rub(**more):
    given = {"casing": ring(), "blades": (blade(),), "tips": (ct.ContactPoint(),)} | more
    return ct.Rub(given.pop("casing"), given.pop("blades"), given.pop("tips"), **given)


@pytest.mark.parametrize(
    ("taken", "refused", "words"),
    [
        ({"clearance": 0.045}, {"clearance": 0.0451}, r"clearance: found 0\.0451 m at tip 0 on a radius of 0\.45 m"),
        ({"clearance": -0.045}, {"clearance": -0.0451}, r"clearance: found -0\.0451 m at tip 0"),
        (
            {"clearance": 0.02, "tips": [ct.ContactPoint(clearance=0.025)]},
            {"clearance": 0.02, "tips": [ct.ContactPoint(), ct.ContactPoint(clearance=0.0251)]},
            r"found 0\.0451 m at tip 1",
        ),
        (
            {"closing": ct.gaps.Closing([0.0, 1.0], [0.0, -0.045])},
            {"closing": ct.gaps.Closing([0.0, 1.0, 2.0], [0.0, -0.0451, 0.04])},
            r"closing: found -0\.0451 m",
        ),
        (
            {"whirl": [ct.gaps.Whirl(amplitude=0.0225)] * 2},
            {"whirl": [ct.gaps.Whirl(amplitude=0.0226)] * 2},
            r"whirl: found 0\.0452 m",
        ),
        (
            {"profile": ct.gaps.RimProfile.fourier([{"p": 2, "cos": 0.045}])},
            {"profile": ct.gaps.RimProfile.fourier([{"p": 2, "cos": 0.0451}])},
            r"out_of_roundness: found 0\.0451 m",
        ),
        ({"thickness": 0.045}, {"thickness": 0.0451}, r"thickness: found 0\.0451 m"),
        ({"thickness": math.inf}, {"thickness": math.nan}, "thickness: found nan, expected metres > 0"),
    ],
)
def test_lengths_up_to_a_tenth_of_the_radius_are_taken(taken, refused, words):
    rub(**taken)
    with pytest.raises(ct.InputError, match=words):
        rub(**refused)


def test_names_walls_and_directions_of_a_rub():
    one, two = rub(), rub(blades=(blade(), blade(psi=0.5)), tips=[ct.ContactPoint(blade=1, lean_deg=30.0)])
    assert (one.names, two.names) == (("casing", "blade"), ("casing", "blade 1", "blade 2"))
    assert (one.wall, one.clearance, one.dimensions) == (math.inf, 0.0, 2)
    assert rub(thickness=2e-3, casing=replace(ring(), thickness=3e-3)).wall == 2e-3
    assert rub(casing=replace(ring(), thickness=3e-3)).wall == 3e-3
    name, row = two.blade_normal()
    span, flap = blade(psi=0.5).rows
    assert name == "blade 2"
    np.testing.assert_allclose(row, math.cos(math.pi / 6) * span + 0.5 * flap, rtol=1e-12)
    assert ct.Rub(rim3(), (nodes(1),), tips(1)).dimensions == 3
    assert [len(part) for part in (two.bodies, two.starts)] == [3, 3]
    assert rub(tips=[ct.ContactPoint()], whirl=[ct.gaps.Whirl(amplitude=0.0)]).tips == (ct.ContactPoint(),)


PART = np.array([[0.3, 0.8], [1.1, -0.4], [0.2, 0.5]])
CASING_PART = np.arange(30.0).reshape(3, 10)


def test_each_blade_settles_by_its_own_stiffening():
    two = [replace(blade(), participation=PART)] * 2
    stiff = ct.gaps.Stiffening(blade=1, stiffness_by_speed=1e4 * np.eye(2))
    scene = rub(casing=replace(ring(), participation=CASING_PART), blades=two, stiffening=[stiff],
                tips=[ct.ContactPoint(blade=0), ct.ContactPoint(blade=1)], forces=[ct.gaps.BodyForce(acceleration=1.0)],
                speed=ct.Speed.constant(5.0))  # fmt: skip
    one, other = (start.displacement for start in ct.gaps.settled(scene).blade_starts)
    np.testing.assert_allclose(one, PART[0] / blade().omega ** 2, rtol=1e-12)
    np.testing.assert_allclose(other, PART[0] / (blade().omega ** 2 + 1e4 * (10.0 * math.pi) ** 2), rtol=1e-12)
