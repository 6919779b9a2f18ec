"""Rigid motions, axes of rotation, bends of a meridian and places of a survey on it, by written-out numbers."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.field.survey.points import SurveyPoints
from casingfem.structure.geometry.pieces import Bend, fillet_between, joined, unjoined
from casingfem.structure.geometry.revolved import chart_lines
from casingfem.structure.geometry.rotation import blade_frame, rigid_left, rigid_motions, unfelt
from casingfem.structure.geometry.survey_check import on_meridian

X = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0], [2.0, 4.0, 8.0]])


def test_rigid_motions_of_points():
    """About the middle (1, 2, 2); the longest arm, 6, is one."""
    motions = rigid_motions(X).reshape(4, 3, 6)
    for k, x in enumerate(X):
        arm = (x - [1.0, 2.0, 2.0]) / 6.0
        for axis in range(3):
            e = np.eye(3)[axis]
            np.testing.assert_allclose(motions[k, :, axis], e)
            np.testing.assert_allclose(motions[k, :, 3 + axis], np.cross(e, arm), atol=1e-15)


def test_rigid_motions_turn_the_normals_with_the_body():
    normals = np.array([[0.0, 0.0, 1.0]] * 3 + [[0.6, 0.0, 0.8]])
    frames = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]] * 3 + [[[0.8, 0.0, -0.6], [0.0, 1.0, 0.0]]])
    motions = rigid_motions(X, normals, frames).reshape(4, 5, 6)
    np.testing.assert_allclose(motions[:, :3].reshape(-1, 6), rigid_motions(X), atol=1e-15)
    assert np.abs(motions[:, 3:, :3]).max() == 0.0
    for k in range(4):
        for axis in range(3):
            turned = np.cross(np.eye(3)[axis], normals[k]) / 6.0
            np.testing.assert_allclose(motions[k, 3:, 3 + axis], frames[k] @ turned, atol=1e-15)


def test_motions_that_no_support_feels():
    assert unfelt([]).shape == (6, 6)
    assert unfelt([np.zeros((6, 6)), np.diag([1.0, 0, 0, 0, 0, 0])]).shape == (6, 5)
    free = unfelt([np.diag([4e9, 1e9, 1e9, 0, 0, 0]), np.diag([0, 0, 0, 2e-9, 0, 0])])
    np.testing.assert_allclose(free @ free.T, np.diag([0.0, 0, 0, 0, 1, 1]), atol=1e-12)
    for share, left in ((0.9e-12, 1), (1.2e-12, 0)):
        assert unfelt([np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 5.0 * share])]).shape[1] == left


def test_rigid_motions_left_by_held_dofs_and_springs():
    motions = rigid_motions(X)
    assert rigid_left(motions, np.array([0]), []) == 5
    assert rigid_left(motions, np.arange(6), []) == 1  # two points held: a turn about their line
    spring = np.zeros((12, 12))
    spring[8, 8] = 1e-6  # at the third along z
    assert rigid_left(motions, np.arange(6), [spring]) == 0
    assert rigid_left(motions, np.arange(0), [spring]) == 5


def test_an_axis_and_its_plane():
    rotation = cf.Rotation(omega=3.0, axis=(1.0, -2.0, 2.0), centre=(4.0, 5.0, 6.0))
    np.testing.assert_allclose(rotation.direction, [1 / 3, -2 / 3, 2 / 3], rtol=1e-15)
    np.testing.assert_allclose(rotation.plane, np.array([[8, 2, -2], [2, 5, 4], [-2, 4, 5]]) / 9.0, rtol=1e-14)
    assert rotation.at(5.0) == cf.Rotation(omega=5.0, axis=(1.0, -2.0, 2.0), centre=(4.0, 5.0, 6.0))
    assert cf.Rotation(omega=1.0).centre == (0.0, 0.0, 0.0)
    for given, words in (
        ({"omega": np.inf}, "rotation.omega: found inf"),
        ({"axis": (0.0, 0.0, 0.0)}, "found axis"),
        ({"centre": (0.0, np.nan, 0.0)}, "through"),
        ({"axis": (np.inf, 0.0, 1.0)}, "found axis"),
    ):
        with pytest.raises(ValueError, match=words):
            cf.Rotation(**{"omega": 1.0} | given)


def test_the_axis_of_a_staggered_blade_lies_below_its_root():
    """A root whose chord is turned by 0.3 rad about x and lies 0.02 m off: span x, chord and normal turned."""
    blade = cf.Blade(length=0.5, chord=0.2, twist=(0.3, 0.8), sweep=(0.02, 0.02), lean=(0.01, 0.01))
    c, s = np.cos(0.3), np.sin(0.3)
    root, span, chord, normal = blade_frame(blade)
    np.testing.assert_allclose(root, [0.0, 0.02, 0.01], atol=1e-15)
    np.testing.assert_allclose([span, chord, normal], [[1, 0, 0], [0, c, s], [0, -s, c]], atol=1e-14)
    found = cf.Rotation.of_blade(blade, omega=7.0, hub_radius=0.3, stagger=0.4)
    np.testing.assert_allclose(found.axis, np.cos(0.4) * chord + np.sin(0.4) * normal, atol=1e-15)
    np.testing.assert_allclose(found.centre, [-0.3, 0.02, 0.01], atol=1e-15)
    assert found.omega == 7.0
    assert cf.Rotation.of_blade(cf.Plate(length=0.3, width=0.1), omega=1.0, hub_radius=0.0).centre == (0.0, 0.0, 0.0)


def test_the_span_of_a_swept_blade_is_across_its_chord():
    """Lines along a skewed blade run off by 0.1 m in 0.5 m."""
    root, span, chord, _ = blade_frame(cf.Blade(length=0.5, chord=0.2, sweep=(0.0, 0.1)))
    np.testing.assert_allclose([root, span, chord], [[0, 0, 0], [1, 0, 0], [0, 1, 0]], atol=1e-15)


@pytest.mark.parametrize("kappa", [2.0, -2.0, 0.0])
def test_a_bend_by_its_own_equation(kappa):
    """Positions by 64 points of Gauss of the direction; distances to its left and places of points beside it."""
    bend = Bend(np.array([0.4, 0.1]), 0.7, kappa, 0.6)
    at = bend.at(np.array(0.5))
    x, w = np.polynomial.legendre.leggauss(64)
    phi = 0.7 + kappa * 0.25 * (x + 1.0)
    np.testing.assert_allclose([at.r, at.z], [0.4 + 0.25 * w @ np.cos(phi), 0.1 + 0.25 * w @ np.sin(phi)], rtol=1e-13)
    turned = 0.7 + 0.5 * kappa
    c, d = np.cos(turned), np.sin(turned)
    np.testing.assert_allclose([at.r1, at.z1, at.r2, at.z2], [c, d, -kappa * d, kappa * c], atol=1e-15)
    beside = np.array([at.r, at.z]) + 0.05 * np.array([-d, c])
    distance, direction = bend.offset(beside)
    assert distance == pytest.approx(0.05, rel=1e-12)
    np.testing.assert_allclose(direction, [-d, c], atol=1e-13)
    assert bend.place(np.array([at.r, at.z])) == pytest.approx(0.5, rel=1e-12)
    part = bend.between(0.2, 0.5)
    assert (part.phi, part.kappa, part.length) == (pytest.approx(0.7 + 0.2 * kappa), kappa, pytest.approx(0.3))
    np.testing.assert_allclose(part.end, [at.r, at.z], rtol=1e-13)
    np.testing.assert_allclose(part.start, [bend.at(np.array(0.2)).r, bend.at(np.array(0.2)).z], rtol=1e-15)


def test_pieces_from_point_to_point():
    """A chord of 0.5 m in the direction (0.6, 0.8) as a line, and as arcs of 0.5 m: a sixth of a circle."""
    line, left, right = (
        unjoined((0.3, 0.1), [cf.geometry.Piece(to=(0.6, 0.5), radius=r)])[0] for r in (None, 0.5, -0.5)
    )
    phi = np.arctan2(0.8, 0.6)
    assert (line.phi, line.kappa, line.length) == pytest.approx((phi, 0.0, 0.5), rel=1e-14)
    assert (left.phi, left.kappa, left.length) == pytest.approx((phi - np.pi / 6, 2.0, 0.5 * np.pi / 3), rel=1e-13)
    assert (right.phi, right.kappa, right.length) == pytest.approx((phi + np.pi / 6, -2.0, 0.5 * np.pi / 3), rel=1e-13)
    for bend in (line, left, right):
        np.testing.assert_allclose(bend.end, [0.6, 0.5], rtol=1e-13)


@pytest.mark.parametrize("radii", [(None, None), (0.4, None), (-0.4, 0.3), (0.5, -0.35), (None, 0.3)])
@pytest.mark.parametrize("over", [0.2, -0.2])
def test_a_fillet_starts_and_ends_on_its_pieces_in_their_directions(radii, over):
    """Up and to one side, whatever arcs meet there; each piece reaches to the middle of the fillet."""
    pieces = [
        cf.geometry.Piece(to=(0.5, 0.2), radius=radii[0]),
        cf.geometry.Piece(to=(0.5 + over, 0.3), radius=radii[1]),
    ]
    one, other = unjoined((0.5, 0.0), pieces)
    turn = (other.phi - one.phi - one.kappa * one.length + np.pi) % (2.0 * np.pi) - np.pi
    fillet, leaves, reaches = fillet_between(one, other, 0.01, turn, "")
    assert fillet.kappa == pytest.approx(np.sign(turn) * 100.0, rel=1e-13)
    for bend, s, at in ((one, leaves, 0.0), (other, reaches, fillet.length)):
        a, b = bend.at(np.array(s)), fillet.at(np.array(at))
        np.testing.assert_allclose([a.r, a.z, a.r1, a.z1], [b.r, b.z, b.r1, b.z1], atol=1e-12)
    bends, owners = joined([one, other], [None, 0.01])
    assert [bend.length for bend in bends] == pytest.approx([leaves, fillet.length, other.length - reaches], rel=1e-12)
    middle = leaves + 0.5 * fillet.length
    assert owners == [
        (0.0, pytest.approx(middle)),
        (pytest.approx(middle), pytest.approx(sum(b.length for b in bends))),
    ]


@pytest.mark.parametrize(("turn", "smooth"), [(0.9e-6, True), (1.1e-6, False)])
def test_pieces_that_turn_by_a_millionth_need_no_fillet(turn, smooth):
    pieces = (
        cf.geometry.Piece(to=(0.3, 0.1)),
        cf.geometry.Piece(to=(0.3 + 0.1 * np.sin(turn), 0.1 + 0.1 * np.cos(turn))),
    )
    if smooth:
        line = cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=pieces)
        assert chart_lines(cf.Revolved(profile=line)) == pytest.approx([0.0, 0.1, 0.2], rel=1e-14)
        at = line.at(np.array([0.05, 0.1, 0.2]))
        np.testing.assert_allclose(at.r1, [0.0, np.sin(turn), np.sin(turn)], atol=1e-15)  # on a line, what begins
    else:
        with pytest.raises(ValueError, match=r"piece\[2\]\.fillet: found none at a corner of 6.3e-05 degrees"):
            cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=pieces)


@pytest.mark.parametrize(("fillet", "words"), [(0.0, "found 0 m at a corner"), (0.101, "found 0.101 m, which does")])
def test_fillets_that_do_not_fit(fillet, words):
    pieces = [cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.4, 0.1), fillet=0.099)]
    assert cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=pieces, fillet=fillet).bends[
        1
    ].kappa == pytest.approx(-1 / 0.099)
    with pytest.raises(ValueError, match=words):
        cf.geometry.PiecewiseMeridian(
            start=(0.3, 0.0), pieces=[pieces[0], cf.geometry.Piece(to=(0.4, 0.1))], fillet=fillet
        )
    with pytest.raises(ValueError, match="found none, expected one or more"):
        cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=())


def test_surveyed_radii_and_walls_find_their_arc_length():
    """On a sphere of 0.5 m from latitude 0.2 to 1.1 rad; radii become those of a cylinder through its middle."""
    sphere = cf.Revolved(profile=cf.geometry.Arc(radius=0.5, start=0.2, end=1.1))
    latitude, theta = np.array([0.25, 0.7, 1.05]), np.array([0.0, 1.0, 2.0])
    z, r = 0.5 * np.sin(latitude), 0.5 * np.cos(latitude)
    radii = on_meridian(SurveyPoints(theta=theta, z=z, value=1.01 * r), sphere)
    np.testing.assert_allclose(radii.z, 0.5 * (latitude - 0.2), rtol=1e-5)
    np.testing.assert_allclose(radii.value, 1.01 * 0.5 * np.cos(0.65), rtol=1e-5)
    walls = on_meridian(SurveyPoints(theta=theta, z=z, value=np.full(3, 3e-3), quantity="thickness"), sphere)
    np.testing.assert_allclose(walls.z, 0.5 * (latitude - 0.2), rtol=1e-7)
    assert walls.value.tolist() == [3e-3] * 3
    same = SurveyPoints(theta=theta, z=z, value=r)
    assert on_meridian(same, cf.Plate(length=1.0, width=1.0)) is on_meridian(same, None) is same


@pytest.mark.parametrize(("latitude", "flat"), [(1.469, False), (1.473, True)])
def test_a_radius_measured_where_the_meridian_is_flat_tells_no_shape(latitude, flat):
    """The slope's sine is 0.1 at a latitude of 1.4706 rad."""
    sphere = cf.Revolved(profile=cf.geometry.Arc(radius=0.5, start=0.2, end=1.5))
    at = np.array([0.5, latitude])
    points = SurveyPoints(theta=np.zeros(2), z=0.5 * np.sin(at), value=0.5 * np.cos(at))
    if flat:
        with pytest.raises(ValueError, match=r"found 1 points where .* is flat, the first at theta 0 deg, z 0\.4976"):
            on_meridian(points, sphere)
    else:
        np.testing.assert_allclose(on_meridian(points, sphere).z, 0.5 * (at - 0.2), rtol=1e-4)
