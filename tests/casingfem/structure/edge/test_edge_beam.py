"""Sections, ties, beam strains, springs and bolts piece by piece: written-out numbers, bounds, names."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.edge.curved_beam import (
    beam_strain,
    make_beam,
    section_axes,
    section_inertia,
    section_stiffness,
    tie,
)
from casingfem.structure.edge.ring import check_stiffeners, held_at_root
from casingfem.structure.edge.support import outer_support
from casingfem.structure.geometry.rotation import skew
from casingfem.structure.mesh.edge_form import EdgeLine, LineFrame

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BAR = cf.edge.Section.rectangle(width=0.012, depth=0.004)
OWN = cf.edge.Section(width=0.1, depth=0.2, area=3.0, I_r=5.0, I_z=7.0, J=11.0, shear=0.5)
V, W = np.array([1.0, -2.0, 3.0]), np.array([0.5, 4.0, -1.0])


def test_sections_of_a_rectangle_and_a_circle():
    for width, depth in ((0.03, 0.02), (0.02, 0.03)):
        bar = cf.edge.Section.rectangle(width=width, depth=depth)
        assert (bar.width, bar.depth, bar.shear) == (width, depth, 5.0 / 6.0)
        found = bar.area, bar.I_r, bar.I_z
        assert found == pytest.approx((6e-4, width * depth**3 / 12.0, depth * width**3 / 12.0), rel=1e-14)
        assert bar.J == pytest.approx(0.03 * 0.02**3 * 0.19576, rel=1e-4)  # Timoshenko & Goodier, a/b = 1.5: 0.196
    wire = cf.edge.Section.circle(diameter=0.2)
    found = wire.width, wire.depth, wire.area, wire.I_r, wire.I_z, wire.J, wire.shear
    inertia = np.pi * 0.1**4 / 4.0
    assert found == pytest.approx((0.2, 0.2, np.pi * 0.01, inertia, inertia, 2.0 * inertia, 0.9), rel=1e-14)


def test_torsion_of_a_thin_strip():
    """(1/3 - 0.21 b/a (1 - b^4/(12 a^4))) a b^3, the usual approximation; a third in the limit."""
    thin = cf.edge.Section.rectangle(width=1.0, depth=0.1)
    assert thin.J == pytest.approx(1e-3 * (1 / 3 - 0.21 * 0.1 * (1 - 1e-4 / 12)), rel=1e-4)


def test_numbers_of_a_section_are_named():
    wire = cf.edge.Section.circle(diameter=0.2)
    assert (wire.number("diameter"), wire.number("width"), OWN.number("J")) == (0.2, 0.2, 11.0)
    assert wire.with_number("diameter", 0.3) == cf.edge.Section.circle(diameter=0.3)
    assert BAR.with_number("depth", 0.01) == cf.edge.Section.rectangle(width=0.012, depth=0.01)
    assert BAR.with_number("width", 0.01) == cf.edge.Section.rectangle(width=0.01, depth=0.004)
    assert OWN.with_number("width", 0.3) == cf.edge.Section(
        width=0.3, depth=0.2, area=3.0, I_r=5.0, I_z=7.0, J=11.0, shear=0.5
    )
    assert BAR.with_number("J", 2.0).area == BAR.area
    for section, name in ((BAR, "diameter"), (wire, "radius")):
        with pytest.raises(KeyError, match="has width, depth, area, I_r, I_z, J, shear, and a circle diameter"):
            section.number(name)
        with pytest.raises(KeyError):
            section.with_number(name, 1.0)


@pytest.mark.parametrize("name", ["width", "depth", "area", "I_r", "I_z", "J", "shear"])
def test_a_section_has_positive_numbers(name):
    for value in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(ValueError, match=rf"section\.{name} must be positive and finite"):
            OWN.with_number(name, value)
    for make in (
        lambda: cf.edge.Section.rectangle(width=0.1, depth=0.0),
        lambda: cf.edge.Section.circle(diameter=np.inf),
    ):
        with pytest.raises(ValueError, match=r"section\.(depth|diameter) must be positive and finite, found"):
            make()


def test_masses_at_their_bounds():
    assert cf.edge.EdgeMass(angle=-9.0, mass=0.0).angle == -9.0
    for given in ({"mass": -1e-9}, {"mass": np.inf}, {"angle": np.nan}):
        with pytest.raises(ValueError, match=r"a mass of .* kg at .* rad"):
            cf.edge.EdgeMass(**{"angle": 0.0, "mass": 1.0} | given)


def test_the_matrix_of_a_cross_product():
    np.testing.assert_array_equal(skew(np.stack([V, W])) @ W, [np.cross(V, W), np.zeros(3)])


def test_axes_of_a_section():
    length, axes = section_axes(np.array([0.0, 3.0, 4.0]), np.array([2.0, 1.0, 1.0]))
    t = np.array([0.0, 0.6, 0.8])
    a2 = np.array([2.0, 1.0, 1.0]) - 1.4 * t
    a2 = a2 / np.linalg.norm(a2)
    assert length == pytest.approx(5.0, rel=1e-15)
    np.testing.assert_allclose(axes, [t, a2, np.cross(t, a2)], atol=1e-15)


def test_a_beam_strains_by_its_own_definition():
    """u' - phi x t and phi' in the section's axes, of two nodes with values and slopes of their own."""
    _, axes = section_axes(V, W)
    value, slope = np.array([0.3, 0.9]), np.array([-2.0, 5.0])
    strain = beam_strain(axes, value, slope)
    motions = np.random.default_rng(1).normal(size=(2, 6))
    u1, phi, phi1 = slope @ motions[:, :3], value @ motions[:, 3:], slope @ motions[:, 3:]
    expected = np.concatenate([axes @ (u1 - np.cross(phi, axes[0])), axes @ phi1])
    np.testing.assert_allclose(np.einsum("imk,mk->i", strain, motions), expected, rtol=1e-13)


def test_stiffness_and_inertia_of_a_section():
    G = 210e9 / 2.6
    expected = [3 * 210e9, 1.5 * G, 1.5 * G, 11 * G, 5 * 210e9, 7 * 210e9]
    np.testing.assert_allclose(section_stiffness(OWN, STEEL), np.diag(expected), rtol=1e-15)
    _, axes = section_axes(V, W)
    M = section_inertia(OWN, STEEL, axes)
    np.testing.assert_allclose(M[:3, :3], 7800.0 * 3.0 * np.eye(3), rtol=1e-15)
    assert np.abs(M[:3, 3:]).max() == np.abs(M[3:, :3]).max() == 0.0
    for axis, polar in zip(axes, (12.0, 5.0, 7.0), strict=True):
        np.testing.assert_allclose(M[3:, 3:] @ axis, 7800.0 * polar * axis, rtol=1e-12, atol=1e-8)


def test_a_straight_beam_has_its_length_and_mass():
    """Three nodes at equal distances along (0.6, 0.8, 0), 0.5 m."""
    points = np.linspace(0.0, 0.5, 3)[:, None] * np.array([0.6, 0.8, 0.0])
    beam = make_beam(points, np.tile([0.0, 0.0, 1.0], (3, 1)), np.arange(3)[None], 2, OWN, STEEL)
    assert beam.strain.shape == (1, 3, 6, 3, 6)
    np.testing.assert_allclose(beam.D.sum(axis=(0, 1)), 0.5 * section_stiffness(OWN, STEEL), rtol=1e-13)
    np.testing.assert_allclose(beam.inertia[0, :, 0, 0] / (7800.0 * 3.0 * 0.5), [1 / 6, 2 / 3, 1 / 6], rtol=1e-13)
    stretch = np.einsum("gimk,mk->gi", beam.strain[0], np.hstack([1e-3 * points, np.zeros((3, 3))]))
    np.testing.assert_allclose(stretch, np.tile([1e-3, 0, 0, 0, 0, 0], (3, 1)), atol=1e-17)


def test_motions_at_the_end_of_an_arm():
    """The rotation that turns the normal by w, and u + phi x arm."""
    e1, e2, n = np.eye(3)[[1, 2, 0]]
    arm, u, w1, w2, omega = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, 3.0]), 0.7, -0.4, 0.9
    found = tie(*(x[:, None] for x in (e1, e2, n, arm)))[0] @ np.array([*u, w1, w2, omega])
    phi = w1 * e2 - w2 * e1 + omega * n
    np.testing.assert_allclose(np.cross(phi, n), w1 * e1 + w2 * e2, rtol=1e-14)
    np.testing.assert_allclose(found, np.concatenate([u + np.cross(phi, arm), phi]), rtol=1e-14)


def test_a_bar_held_at_its_root_shears_by_less():
    """(int (arm + z)^2 dz)^2/(w int tau^2 dz) with tau = int_z^w (arm + x) dx by 64 points of Gauss: 3 mm of wall."""
    w, arm = 0.012, 0.0015
    x, weights = np.polynomial.legendre.leggauss(64)
    z = 0.5 * w * (x + 1.0)
    tau = arm * (w - z) + 0.5 * (w**2 - z**2)
    inertia, square = 0.5 * w * weights @ (arm + z) ** 2, 0.5 * w * weights @ tau**2
    assert held_at_root(BAR, arm).shear == pytest.approx(inertia**2 / (w * square), rel=1e-12)
    assert held_at_root(BAR, 0.0).shear == pytest.approx(5.0 / 6.0, rel=1e-13)
    assert held_at_root(BAR, -1e-9) is BAR
    assert held_at_root(OWN, arm) is OWN
    tuned = BAR.with_number("shear", 0.7)
    assert held_at_root(tuned, arm) is tuned
    for offset in (0.0075, -0.0075):
        assert (
            cf.edge.Stiffener(at=0.1, section=BAR, offset=(offset, 0.0)).ring.section.shear
            == held_at_root(BAR, arm).shear
        )
    for given, words in (({"at": np.nan}, "stiffener.at: found nan"), ({"offset": 0.1}, "stiffener.offset: found 0.1")):
        with pytest.raises(ValueError, match=words):
            cf.edge.Stiffener(**{"at": 0.1, "section": BAR, "offset": (0.0, 0.0)} | given)


@pytest.mark.parametrize(
    ("places", "words"),
    [
        ([1.5, 4.5], ""),
        ([1.0 + 3e-9], r"stiffener\[1\].at: found 1 m, 1 to 5 m"),
        ([1.0 + 5e-9, 5.0 - 5e-9], ""),
        ([2.0, 5.0 - 3e-9], r"stiffener\[2\].at: found 5 m, 1 to 5 m"),
        ([2.0, 3.0, 2.0 + 3e-9], r"stiffener\[3\].at: found a second one at 2 m"),
        ([2.0, 3.0, 2.0 - 5e-9], ""),
    ],
)
def test_stiffeners_stand_apart_between_the_ends(places, words):
    given = [cf.edge.Stiffener(at=at, section=BAR, offset=(0.01, 0.0)) for at in places]
    if words:
        with pytest.raises(ValueError, match=words):
            check_stiffeners(given, (1.0, 5.0), True)
    else:
        check_stiffeners(given, (1.0, 5.0), True)
    with pytest.raises(ValueError, match="found an open shell"):
        check_stiffeners(given, (1.0, 5.0), False)
    check_stiffeners([], (1.0, 5.0), False)


def test_places_of_a_ring_and_its_foot():
    ring = cf.Ring(section=OWN)
    assert ring.centre(1).tolist() == [0.0, 0.1]
    assert ring.support_point(-1).tolist() == [0.0, -0.2]
    assert cf.Ring(section=OWN, offset=(0.3, 0.4)).support_point(1).tolist() == pytest.approx([0.3, 0.5])
    assert cf.Ring(section=OWN, foot=(0.05, 0.01)).support_point(-1).tolist() == pytest.approx([0.05, -0.09])
    for name in ("offset", "foot"):
        for place in ((1.0, 2.0, 3.0), (np.inf, 0.0)):
            with pytest.raises(ValueError, match=rf"ring\.{name} must be two finite lengths"):
                cf.Ring(section=OWN, **{name: place})
    assert outer_support(ring) is None


def test_numbers_of_a_ring_are_those_of_its_parts():
    held = cf.Ring(section=BAR, material=STEEL, support=cf.ElasticEdge(k_r=5.0, k_z=7.0))
    assert [held.number(p) for p in (("section", "depth"), ("material", "nu"), ("k_z",))] == [0.004, 0.3, 7.0]
    assert held.with_number(("k_r",), 6.0).support == cf.ElasticEdge(k_r=6.0, k_z=7.0)
    assert held.with_number(("material", "E"), 1.0).material == cf.Material(E=1.0, nu=0.3, rho=7800.0)
    assert held.with_number(("section", "depth"), 0.01).section == cf.edge.Section.rectangle(width=0.012, depth=0.01)
    bolted = cf.Ring(section=BAR, support=cf.Bolts(count=8, k=3.0))
    assert bolted.number(("bolts", "2", "k")) == 3.0
    assert bolted.with_number(("k",), 4.0).support.k == 4.0
    assert (bolted.uniform, held.uniform, cf.Ring(section=BAR).uniform) == (False, True, True)
    with pytest.raises(KeyError, match="this ring has no material of its own"):
        bolted.number(("material", "E"))
    for path in (("k_phi",), ("k_r", "k_z"), ("material", "G")):
        with pytest.raises(KeyError, match=r"this ring has section.width and the like, material.E, k_r"):
            held.number(path)
    with pytest.raises(KeyError, match=r"the like, material.E'"):
        cf.Ring(section=BAR, material=STEEL).number(("k_r",))
    with pytest.raises(ValueError, match=r"ring\.support must be elastic or bolts, found float"):
        cf.Ring(section=BAR, support=1.0)


def line(bend=0.0):
    """Two nodes of an edge of other length and weight, directions turned by 30 degrees about z."""
    c, s = np.cos(np.pi / 6), 0.5
    directions = np.repeat(np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])[:, :, None], 2, axis=2)
    tangents = np.stack([directions[1], directions[2]], axis=1)
    at = LineFrame(
        a=np.zeros(2), b=np.array([0.0, np.pi / 2]), directions=directions, thickness=np.array([0.1, 0.2]),
        stretch=np.array([2.0, 3.0]), tangents=tangents, bend=np.full(2, bend),
    )  # fmt: skip
    return EdgeLine(np.array([4, 6]), np.array([0.5, 0.25]), at, np.zeros(2), 1, False, lambda x: at, lambda x: None)


def test_springs_of_an_elastic_edge_at_its_nodes():
    """k per length times length; a pattern doubles the radial spring at angle 0 and the face at a quarter turn."""
    around = {"k_r": cf.FourierField.of({1: 1.0}), "k_face": cf.FourierField.of({1: (0.0, 1.0)})}
    edge = cf.ElasticEdge(k_r=10.0, k_theta=20.0, k_z=30.0, k_rot=7.0, k_face=600.0, around=around)
    found = edge.springs(line(bend=0.5))
    assert found.nodes.tolist() == [[4], [6]]
    assert found.values.tolist() == [[1.0], [1.0]]
    for k, (length, k_r, face, t) in enumerate(((1.0, 20.0, 600.0, 0.1), (0.75, 10.0, 1200.0, 0.2))):
        Q = line().nodal.directions[:, :, k]
        exact = length * (Q.T @ np.diag([k_r, 20.0, 30.0]) @ Q + face * t * np.eye(3))
        np.testing.assert_allclose(found.blocks[k], exact, rtol=1e-12, atol=1e-12)
        assert found.rotation[k] == pytest.approx(length * (7.0 + face * t**3 / 12.0), rel=1e-13)
        np.testing.assert_allclose(found.coupling[k], -0.5 * length * face * t**3 / 12.0 * Q[1:].T, rtol=1e-12)
    assert (edge.uniform, cf.ElasticEdge(k_r=1.0).uniform) == (False, True)
    assert list(edge.patterns) == ["k_r", "k_face"]
