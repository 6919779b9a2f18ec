"""Sections, ties, beam strains, springs and bolts piece by piece: written-out numbers, bounds, names."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BAR = cf.edge.Section.rectangle(width=0.012, depth=0.004)
OWN = cf.edge.Section(width=0.1, depth=0.2, area=3.0, I_r=5.0, I_z=7.0, J=11.0, shear=0.5)


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
        with pytest.raises(KeyError, match="are width, depth, area, I_r, I_z, J, shear; of a circle, diameter"):
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
        with pytest.raises(KeyError, match=r"this ring are section\.width, \.\.\., material\.E, k_r"):
            held.number(path)
    with pytest.raises(KeyError, match=r"section.width, ..., material.E'"):
        cf.Ring(section=BAR, material=STEEL).number(("k_r",))
    with pytest.raises(ValueError, match=r"ring\.support must be elastic or bolts, found float"):
        cf.Ring(section=BAR, support=1.0)
