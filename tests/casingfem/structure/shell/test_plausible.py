"""Which shells are doubted and which are refused: both sides of each threshold."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.shell.plausible import (
    chart_warnings,
    extent,
    mass_warnings,
    material_warnings,
    sampled,
    spring_warnings,
    stretches,
    wall_warnings,
    warn_of,
    warnings_of,
)

MESH = cf.ShellMesh(order=4, rows=1, around=9)
BAR = cf.edge.Section.rectangle(width=0.02, depth=0.01)


def shell(chart=None, thickness=2e-3, E=210e9, nu=0.3, rho=7800.0, **parts):
    chart = cf.Plate(length=0.3, width=0.1) if chart is None else chart
    parts = {"mesh": MESH if "mesh" not in parts else parts["mesh"]} | parts
    return cf.Shell(chart=chart, thickness=thickness, material=cf.Material(E=E, nu=nu, rho=rho), **parts)


def codes(concerns):
    return [code for code, _ in concerns]


class Fan(cf.Plate):
    """A chart of one's own whose angle is none about an axis."""

    angle = 90.0


@pytest.mark.parametrize(
    ("E", "nu", "rho", "expected"),
    [
        (210e9, 0.3, 7800.0, []),
        (201.0**2 * 1e3, 0.3, 1e3, []),  # sound at 201 m/s
        (199.0**2 * 1e3, 0.3, 1e3, ["material-units"]),
        (19_990.0**2 * 1e3, 0.3, 1e3, []),
        (20_010.0**2 * 1e3, 0.3, 1e3, ["material-units"]),
        (1.0, 0.3, 1.0, []),  # no units
        (1.0, 0.3, 2.0, ["material-units"]),
        (1e10, 0.3, 25_000.0, []),
        (1e10, 0.3, 25_100.0, ["material-density-units"]),
        (1e6, 0.3, 1.0, []),
        (1e6, 0.3, 0.99, ["material-density-units"]),
        (1e4, 0.3, 0.01, ["material-density-units"]),
        (1e4, 0.3, 0.0099, []),  # meant to weigh nothing
        (210e9, 0.0, 7800.0, []),
        (210e9, -0.01, 7800.0, ["material-poisson-negative"]),
        (1.0, -0.1, 1.0, []),
    ],
)
def test_doubtful_materials(E, nu, rho, expected):
    assert codes(warnings_of(cf.Material(E=E, nu=nu, rho=rho))) == expected


def test_the_speed_of_sound_is_told():
    (concern,) = warnings_of(cf.Material(E=9e3, nu=0.3, rho=1e3))
    assert concern == ("material-units", "E = 9e+03 Pa and rho = 1e+03 kg/m^3, sound at 3 m/s")


def test_each_material_is_looked_at_once():
    foam = cf.Material(E=1e3, nu=0.3, rho=1e3)
    strips = [cf.Strip(start=0.0, end=0.1, thickness=2e-3, material=foam), cf.Strip(start=0.1, end=0.2, thickness=2e-3)]
    strips.append(cf.Strip(start=0.2, end=0.3, thickness=2e-3, material=foam))
    doubted = shell(strips=strips, mesh=None)
    assert codes(material_warnings(doubted)) == ["material-units"]
    with pytest.warns(UserWarning, match=r"sound at 1 m/s"):
        warn_of(doubted)


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ({}, []),
        ({"chart": cf.Plate(length=24.0, width=6.9)}, []),  # 24.97 m from corner to corner
        ({"chart": cf.Plate(length=24.0, width=7.1)}, ["chart-units"]),  # 25.03 m
        ({"chart": cf.Plate(length=24.0, width=7.1), "E": 1.0, "rho": 1.0}, []),
        ({"chart": cf.Plate(length=8e-4, width=6.1e-4), "thickness": 1e-5}, []),  # 1.006 mm
        ({"chart": cf.Plate(length=8e-4, width=5.9e-4), "thickness": 1e-5}, ["chart-units"]),  # 0.994 mm
        ({"chart": cf.Plate(length=0.999, width=1e-3), "thickness": 1e-4}, []),
        ({"chart": cf.Plate(length=1.001, width=1e-3), "thickness": 1e-4}, ["chart-aspect"]),
        ({"chart": cf.Plate(length=1e-3, width=1.001), "thickness": 1e-4}, ["chart-aspect"]),
        ({"chart": cf.Panel(radius=0.4, length=0.3, angle=6.21)}, []),  # of 2 pi * 0.99 = 6.2204
        ({"chart": cf.Panel(radius=0.4, length=0.3, angle=6.23)}, ["chart-near-closed"]),
        ({"chart": Fan(length=0.3, width=0.1)}, []),
        ({"chart": cf.TwistedPlate(length=0.3, width=0.1, twist=3.14)}, []),
        ({"chart": cf.TwistedPlate(length=0.3, width=0.1, twist=-3.15)}, ["chart-twist-units"]),
        ({"chart": cf.Cylinder(radius=0.4, height=0.3), "radius_defect": cf.FourierField.of({0: 0.1})}, []),
        (
            {"chart": cf.Cylinder(radius=0.4, height=0.3), "radius_defect": cf.FourierField.of({0: -0.101})},
            ["field-large"],
        ),
        ({"chart": cf.Cylinder(radius=0.4, height=0.3), "thickness_defect": cf.FourierField.of({0: 1.0})}, []),
        (
            {"chart": cf.Cylinder(radius=0.4, height=0.3), "thickness_defect": cf.FourierField.of({0: 1.01})},
            ["field-large"],
        ),
    ],
)
def test_doubtful_charts_and_fields(parts, expected):
    assert codes(chart_warnings(shell(**parts))) == expected


def test_the_largest_value_of_a_field_is_looked_for_everywhere():
    """A field with its crest at the top and theta = 1.75 alone."""
    top = cf.FourierField(p=[1], cos=[[0.0, 0.5 * np.cos(1.75)]], sin=[[0.0, 0.5 * np.sin(1.75)]], z_half=0.3)
    casing = shell(chart=cf.Cylinder(radius=0.4, height=0.3), radius_defect=top, thickness_defect=top)
    assert [words for _, words in chart_warnings(casing)] == ["radius_defect reaches 0.5 of the radius"]


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ({"chart": cf.Cylinder(radius=0.5, height=1.0), "thickness": 0.099}, []),
        ({"chart": cf.Cylinder(radius=0.5, height=1.0), "thickness": 0.101}, ["shell-thick"]),
        ({"thickness": 0.059}, []),  # of 0.1 m
        ({"thickness": 0.061}, ["shell-thick"]),
        ({"chart": cf.Cylinder(radius=0.5, height=0.1), "thickness": 0.101}, ["shell-thick"]),  # once for both reasons
        ({"chart": cf.Plate(length=0.4, width=0.3), "thickness": 5.1e-6}, []),  # of 0.5 m
        ({"chart": cf.Plate(length=0.4, width=0.3), "thickness": 4.9e-6}, ["shell-thin"]),
        ({"shear_correction": 0.5}, []),
        ({"shear_correction": 0.49}, ["shear-correction"]),
        ({"shear_correction": 1.0}, []),
        ({"shear_correction": 1.01}, ["shear-correction"]),
        ({"shear_correction": 9.9}, ["shear-correction"]),
        ({"shear_correction": 10.0}, []),
    ],
)
def test_doubtful_walls(parts, expected):
    assert codes(wall_warnings(shell(**parts))) == expected


def test_what_is_said_of_thick_and_thin_walls():
    def said(**parts):
        return [words for _, words in wall_warnings(shell(**parts))]

    tube = cf.Cylinder(radius=0.5, height=1.0)
    assert said(chart=tube, thickness=0.2) == ["the wall is 0.4 of its smallest radius of curvature"]
    assert said(thickness=0.08) == ["the wall is 0.8 of the shortest side"]
    strip = cf.Strip(start=0.0, end=0.5, thickness=2e-6)
    given = {"chart": tube, "strips": (strip,), "mesh": cf.ShellMesh(order=4, rows=2, around=9)}
    assert said(**given) == ["the wall is 1.2e-06 of the structure's diagonal"]  # sqrt(1 + 1 + 1) m


@pytest.mark.parametrize(
    ("springs", "ratio"),
    [
        ({"k_r": 21.0}, "1e-10"),
        ({"k_theta": 42.0}, "2e-10"),
        ({"k_z": 63.0, "k_r": 21.0}, "3e-10"),
        ({"k_face": 21.0 / 2e-3}, "1e-10"),
        ({"k_rot": 42.0 * 4e-6}, "2e-10"),
        ({"k_r": 209.0}, "1e-09"),
        ({"k_r": 211.0}, None),
        ({"k_rot": 211.0 * 4e-6}, None),
        ({"k_face": 211.0 / 2e-3}, None),
    ],
)
def test_soft_springs_are_told_as_a_part_of_the_modulus(springs, ratio):
    held = shell(supports={"root": cf.ElasticEdge(**springs), "tip": cf.Clamped()})
    expected = [] if ratio is None else [("support-soft", f"support.root: springs of {ratio} E")]
    assert list(spring_warnings(held)) == expected


def test_the_extent_of_a_plate_and_of_a_frustum():
    size = extent(shell(chart=cf.Plate(length=0.4, width=0.3)))
    assert (size.diagonal, *size.sides) == pytest.approx((0.5, 0.4, 0.3), rel=1e-12)
    assert (size.curvature.max(), size.thickness.min(), size.thickness.size) == (0.0, 2e-3, 9 * 361)
    cone = extent(shell(chart=cf.Frustum(r_base=0.5, r_top=0.2, height=0.4)))
    assert cone.diagonal == pytest.approx(np.sqrt(1.0 + 1.0 + 0.16), rel=1e-12)
    assert cone.sides == pytest.approx([0.5, 720 * 0.5 * np.sin(np.pi / 360)], rel=1e-12)
    assert cone.curvature.max() == pytest.approx(0.8 / 0.2, rel=1e-12)  # cosine of the slope over the radius
    assert cone.curvature.min() == pytest.approx(0.8 / 0.5, rel=1e-12)


def test_the_larger_principal_curvature_of_a_slanted_surface():
    """A helicoid of rate k has -+ k/(1 + (k y)^2); a skew net of lines on it would give no other."""
    found = sampled(shell(chart=cf.TwistedPlate(length=0.3, width=0.2, twist=1.5)), np.array([0.0, 0.1]), 3)
    assert found.x.shape == (3, 2, 3)
    assert found.curvature == pytest.approx([5.0 / 1.25, 5.0, 5.0 / 1.25] * 2, rel=1e-12)


def test_stretches_lie_between_strips_and_pieces():
    strips = (cf.Strip(start=0.1, end=0.15, thickness=4e-3),)
    assert stretches(shell(strips=strips, mesh=None)) == pytest.approx([0.05, 0.125, 0.225], rel=1e-12)
    line = cf.geometry.PiecewiseMeridian(
        start=(0.3, 0.0), pieces=(cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.2, 0.2))), fillet=0.01
    )
    casing = shell(chart=cf.Revolved(profile=line), mesh=None)
    assert stretches(casing) == pytest.approx(0.5 * (line.lines[1:] + line.lines[:-1]), rel=1e-12)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"supports": {"left": cf.Ring(section=BAR)}}, "support.left: a ring on an edge that runs along the axis"),
        ({"supports": {"root": cf.Ring(section=BAR), "left": cf.Clamped()}}, "a ring ends on the held edge 'left'"),
        ({"supports": {"top": cf.Clamped()}}, "this chart has no edge 'top'; it has root, tip, left, right"),
        ({"supports": {"root": 3.0}}, "expected Clamped, .*, Ring, found float"),
        (
            {"masses": {"bas": [cf.edge.EdgeMass(angle=0.0, mass=1.0)]}},
            "masses.bas: expected masses on one of root, tip",
        ),
        ({"masses": {"root": [0.1]}}, "masses.root: expected masses on one of root"),
        (
            {"strips": (cf.Strip(start=0.2, end=0.31, thickness=1e-3),)},
            r"strip\[1\] from 0.2 to 0.31 m leaves the shell",
        ),
        (
            {"stiffeners": (cf.edge.Stiffener(at=0.1, section=BAR, offset=(0.01, 0.0)),)},
            "found an open shell, expected a clo",
        ),
        ({"thickness": 0.0}, "shell.thickness must be positive"),
        ({"shear_correction": 0.0}, "shell.shear_correction must be positive"),
        (
            {"supports": {"root": cf.Bolts(count=2, k=1.0, spacing=0.06, first_angle=-0.03, width=0.05)}},
            "from -0.055 to",
        ),
    ],
)
def test_parts_that_cannot_belong_together(parts, words):
    with pytest.raises(ValueError, match=words):
        shell(**parts)


def test_what_may_stand_beside_a_ring():
    shell(supports={"root": cf.Ring(section=BAR), "tip": cf.Clamped()})
    shell(supports={"root": cf.Ring(section=BAR), "left": cf.ElasticEdge(k_r=1e6)})
    shell(supports={"left": cf.edge.Symmetry()}, masses={"left": [cf.edge.EdgeMass(angle=0.1, mass=1.0)]})


def test_masses_on_a_clamped_edge_are_doubted():
    masses = [cf.edge.EdgeMass(angle=0.0, mass=1.0), cf.edge.EdgeMass(angle=0.1, mass=2.0)]
    held = shell(supports={"root": cf.Clamped()}, masses={"root": masses, "tip": masses}, mesh=None)
    assert list(mass_warnings(held)) == [("mass-held", "masses.root: found 2 on a clamped edge")]
    with pytest.warns(UserWarning, match=r"masses.root"):
        warn_of(held)
    assert not list(mass_warnings(shell(supports={"root": cf.Clamped()}, masses={"root": ()}, mesh=None)))
    assert not list(
        mass_warnings(shell(supports={"root": cf.ElasticEdge(k_r=1e6)}, masses={"root": masses}, mesh=None))
    )


@pytest.mark.parametrize(("deepest", "refused"), [(-0.999, False), (-1.0, False), (-1.001, True)])
def test_springs_may_vanish_and_not_push(deepest, refused):
    def made():
        edge = cf.ElasticEdge(k_r=1e6, k_z=1e6, around={"k_z": cf.FourierField.of({0: deepest})})
        return shell(supports={"root": edge})

    if refused:
        with pytest.raises(ValueError, match=r"support.root.around.*makes k_z negative \(factor -0.001\)"):
            made()
    else:
        assert made().supports["root"].k_z == 1e6


@pytest.mark.parametrize(("value", "refused"), [(-0.89, ""), (-0.9, "-0.9"), (9.0, ""), (9.01, "9.01")])
def test_a_field_may_run_from_a_tenth_to_ten(value, refused):
    def made():
        return shell(thickness=1e-4, thickness_defect=cf.FourierField.of({0: value}))

    if refused:
        with pytest.raises(ValueError, match=f"the field reaches {refused}, it may run from -0.9 to 9"):
            made()
    else:
        made()


def test_a_field_needs_two_nodes_a_wave():
    """Four times nine nodes around carry 18 waves."""
    tube = cf.Cylinder(radius=0.4, height=0.3)
    shell(chart=tube, radius_defect=cf.FourierField.of({18: 1e-3}))
    with pytest.raises(ValueError, match="radius_defect: 19 waves on 36 nodes around; the mesh resolves 18 at most"):
        shell(chart=tube, radius_defect=cf.FourierField.of({19: 1e-3}))
    shell(chart=cf.Panel(radius=0.4, length=0.3, angle=1.0), radius_defect=cf.FourierField.of({19: 1e-3}))
