"""What a rub consists of, by hand: directions of tips, their arrays and compliance, forces on bodies and their rest."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.rub_system import (
    RimTable,
    axial_load,
    force_at_start,
    place,
    plane_force,
    plane_participation,
    rub_system,
    waves_of_tips,
)
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import N_MAX, SIZE, nodes, rim3, tips


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
            {"profile": ct.RimProfile.fourier([{"p": 2, "cos": 0.045}])},
            {"profile": ct.RimProfile.fourier([{"p": 2, "cos": 0.0451}])},
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


def test_rows_of_a_rim_by_table():
    rng = np.random.default_rng(4)
    cos, sin = rng.standard_normal((2, 2, 3, 4))
    table = RimTable(cos=cos, sin=sin)
    assert table.n_max == 2
    phi = 0.7
    expected = sum(cos[1, n] * math.cos(n * phi) + sin[1, n] * math.sin(n * phi) for n in range(3))
    np.testing.assert_allclose(table.rows(1, phi), expected, rtol=1e-12)
    np.testing.assert_allclose(waves_of_tips(np.array([phi]), np.array([1]), 1, (2, 5))[0, 5:],
                               [1.0, math.cos(phi), math.cos(2 * phi), math.sin(phi), math.sin(2 * phi)])  # fmt: skip


@pytest.mark.parametrize("d", [1, 2, 3])
def test_arrays_of_a_rub_are_its_tips_one_by_one(d):
    every = [*tips(2), *tips(1, blade=1, angle=190.0, lean=-20.0)]
    scene = ct.Rub(rim3(), (nodes(2), nodes(1, seed=6)), every, clearance=-3e-5,
                   blade_starts=[ct.gaps.Start(displacement=[1.0, 2.0, 3.0], load=[4.0, 5.0, 6.0]), ct.gaps.Start()],
                   casing_start=ct.gaps.Start(velocity=np.arange(10.0)))  # fmt: skip
    system = rub_system(scene, d)
    assert (system.contacts, system.directions, system.first.tolist()) == (3, 3, [0, 10, 13, 16])
    assert system.line.tolist() == [0, 1, 0]
    np.testing.assert_allclose(system.angle, np.radians([10.0, 10.5, 190.0]), rtol=1e-14)
    np.testing.assert_allclose(system.clearance, [-3e-5, -2.9e-5, -3e-5], rtol=1e-12)
    assert system.radius.tolist() == [0.4] * 3
    assert system.own.tolist() == [[10, 13], [10, 13], [13, 16]]
    assert system.displacement.tolist() == [0.0] * 10 + [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]
    assert system.velocity.tolist() == [*np.arange(10.0), *[0.0] * 6]
    assert system.load.tolist() == [0.0] * 10 + [4.0, 5.0, 6.0, 0.0, 0.0, 0.0]
    along = [tip.directions(scene.blades[tip.blade])[:d] for tip in every]
    for j, tip in enumerate(every):
        np.testing.assert_allclose(system.blade_rows[d * j : d * (j + 1)], -along[j] @ scene.blades[tip.blade].rows)
    for turned in (0.0, 0.8):
        angle = system.angle - turned
        E = np.zeros((3 * d, 6 * SIZE))
        for j, tip in enumerate(every):
            n = np.arange(1, N_MAX + 1)
            h = np.r_[1.0, np.cos(n * angle[j]), np.sin(n * angle[j])]
            for i in range(d):
                E[d * j + i, (3 * tip.line + i) * SIZE : (3 * tip.line + i + 1) * SIZE] = h
        expected = E @ scene.casing.S @ E.T
        for j, one in enumerate(every):
            for k, other in enumerate(every):
                if one.blade == other.blade:
                    own = along[j] @ scene.blades[one.blade].S @ along[k].T
                    expected[d * j : d * (j + 1), d * k : d * (k + 1)] += own
        np.testing.assert_allclose(system.compliance(turned), expected, atol=1e-9 * np.abs(expected).max())
    assert system.turns


def test_a_perfect_casing_gives_way_alike_at_every_angle():
    system = rub_system(rub(), 2)
    assert not system.turns
    np.testing.assert_array_equal(system.compliance(0.3), system.still)
    expected = np.diag([1e-8 * 7.0, 0.5e-8 * 7.0]) + blade().S  # 1 + sum over n of cos^2 + sin^2
    np.testing.assert_allclose(system.still, expected, rtol=1e-12)


PART = np.array([[0.3, 0.8], [1.1, -0.4], [0.2, 0.5]])
CASING_PART = np.arange(30.0).reshape(3, 10)


def pulled(*forces, **more):
    given = {"casing": replace(ring(), participation=CASING_PART), "blades": (replace(blade(), participation=PART),),
             "tips": [ct.ContactPoint(angle_deg=35.0, lean_deg=20.0)]}  # fmt: skip
    return rub(**given | more, forces=forces)


def test_participation_in_the_casings_plane():
    """Span stands along the lean from the radius, flap a right angle on, at the place of the blade."""
    found = plane_participation(pulled(ct.gaps.BodyForce()))
    np.testing.assert_allclose(found[:, :10], CASING_PART[:2], rtol=1e-14)
    span = np.array([math.cos(math.radians(15.0)), math.sin(math.radians(15.0))])  # 35 - 20 degrees
    flap = np.array([-span[1], span[0]])
    np.testing.assert_allclose(found[:, 10:], np.outer(span, PART[0]) + np.outer(flap, PART[1]), rtol=1e-12)
    on_casing = plane_participation(pulled(ct.gaps.BodyForce(on="casing")))
    assert on_casing[:, :10].any()
    assert not on_casing[:, 10:].any()
    on_blades = plane_participation(pulled(ct.gaps.BodyForce(on="blades")))
    assert not on_blades[:, :10].any()
    assert on_blades[:, 10:].any()


def test_pulls_along_the_axis_are_those_on_the_body():
    forces = [ct.gaps.BodyForce(on=on, axial=a) for on, a in (("both", 1.0), ("casing", 10.0), ("blades", 100.0))]
    found = axial_load(pulled(*forces))
    np.testing.assert_allclose(found, [*(11.0 * CASING_PART[2]), *(101.0 * PART[2])], rtol=1e-14)
    assert not axial_load(rub()).any()


def test_the_place_of_a_blade_is_the_mean_of_its_tips():
    def stands(*angles, lean=12.0):
        return place(rub(tips=[ct.ContactPoint(angle_deg=a, lean_deg=lean) for a in angles]), 0)

    assert stands(40.0, 43.0, 50.0) == pytest.approx((math.radians(133.0 / 3.0), math.radians(12.0)), rel=1e-12)
    assert stands(350.0, 360.0)[0] == pytest.approx(math.radians(355.0), rel=1e-12)
    with pytest.raises(ct.InputError, match=r"tips of blade 1 over 10\.5 degrees and leans that differ by 0, expected"):
        stands(40.0, 50.5)
    leans = rub(tips=[ct.ContactPoint(lean_deg=10.0), ct.ContactPoint(lean_deg=12.5)])
    with pytest.raises(ct.InputError, match=r"over 0 degrees and leans that differ by 2\.5, expected one blade"):
        place(leans, 0)


def test_force_per_mass_in_the_plane_of_casing_and_blades():
    """a(t) = (a + r w^2) e(beta) - r w' e'(beta); blades' axes lag by the angle turned."""
    force = ct.gaps.BodyForce(
        acceleration=3.0, radius=0.02, per_rev=0.5, hz=2.0, phase_deg=20.0, casing_turns=True
    )  # fmt: skip
    angle, omega, slope, t = 0.7, 11.0, 40.0, 0.3
    w = 1.5 * omega + 4.0 * math.pi
    beta = math.radians(20.0) + 0.5 * angle + 4.0 * math.pi * t
    whole = (3.0 + 0.02 * w * w - 0.02j * 1.5 * slope) * np.exp(1j * beta)
    casing, blades = plane_force([force], angle, omega, slope, t)
    np.testing.assert_allclose(casing, [whole.real, whole.imag], rtol=1e-12)
    whole = whole * np.exp(1j * angle)
    np.testing.assert_allclose(blades, [whole.real, whole.imag], rtol=1e-12)
    alone = plane_force([replace(force, on="casing"), replace(force, on="blades")], angle, omega, slope, t)
    np.testing.assert_allclose(alone, [casing, blades], rtol=1e-12)
    np.testing.assert_allclose(plane_force([force] * 3, angle, omega, slope, t), np.multiply(3.0, [casing, blades]))


def test_a_rub_at_rest_under_what_pulls_at_the_start():
    whirl = ct.gaps.BodyForce.of_whirl(
        ct.gaps.Whirl(amplitude=2e-3, per_rev=0.3, phase_deg=20.0), "blades", turning="casing"
    )
    scene = pulled(ct.gaps.BodyForce.gravity(turning="casing", axial=0.5), whirl, turning="casing",
                   speed=ct.Speed(time=[-1.0, 1.0], hz=[4.0, 8.0]))  # fmt: skip
    omega, slope = 12.0 * math.pi, 4.0 * math.pi
    w = 1.3 * omega
    felt = -2e-3 * (w * w - 1.3j * slope) * np.exp(1j * math.radians(20.0)) - 9.80665j
    plane = plane_participation(scene)
    load = np.concatenate([[0.0, -9.80665] @ plane[:, :10], [felt.real, felt.imag] @ plane[:, 10:]])
    np.testing.assert_allclose(force_at_start(scene), load, rtol=1e-12)
    load = load + 0.5 * np.concatenate([CASING_PART[2], PART[2]])
    rest = ct.gaps.settled(scene)
    np.testing.assert_allclose(rest.casing_start.displacement, load[:10] / ring().omega ** 2, rtol=1e-12)
    np.testing.assert_allclose(rest.blade_starts[0].displacement, load[10:] / blade().omega ** 2, rtol=1e-12)
    still = ct.gaps.settled(rub(casing_start=ct.gaps.Start(velocity=np.ones(10))))
    assert not still.casing_start.displacement.any()
    assert still.casing_start.velocity.all()


def test_each_blade_settles_by_its_own_stiffening():
    two = [replace(blade(), participation=PART)] * 2
    stiff = ct.gaps.Stiffening(blade=1, stiffness_by_speed=1e4 * np.eye(2))
    scene = rub(casing=replace(ring(), participation=CASING_PART), blades=two, stiffening=[stiff],
                tips=[ct.ContactPoint(blade=0), ct.ContactPoint(blade=1)], forces=[ct.gaps.BodyForce(acceleration=1.0)],
                speed=ct.Speed.constant(5.0))  # fmt: skip
    one, other = (start.displacement for start in ct.gaps.settled(scene).blade_starts)
    np.testing.assert_allclose(one, PART[0] / blade().omega ** 2, rtol=1e-12)
    np.testing.assert_allclose(other, PART[0] / (blade().omega ** 2 + 1e4 * (10.0 * math.pi) ** 2), rtol=1e-12)
