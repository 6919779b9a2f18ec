"""The default mesh, number by number: elements around, rows, and which of their rules decides."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

HELD = {"base": cf.Clamped(), "top": cf.Clamped()}


def mesh_of(steel, thickness=2e-3, height=0.3, supports=HELD, **parts):
    """Of a cylinder with R = 0.5 m: lowest = 0.46 R/sqrt(t h) = 9.39 diameters, if nothing else is said."""
    chart = cf.Cylinder(radius=0.5, height=height)
    return cf.Shell(chart=chart, thickness=thickness, material=steel, supports=supports, **parts).mesh


def waves(p):
    return {"thickness_defect": cf.FourierField.of({p: 0.01})}


def around_on(p):
    return {"supports": {"base": cf.ElasticEdge(k_r=1e8, around=cf.FourierField.of({p: 0.1})), "top": cf.Clamped()}}


@pytest.mark.parametrize(
    ("parts", "around"),
    [
        ({}, 19),  # 16 * 9.39/8 = 18.8
        (waves(3), 31),  # 25 * 9.39/8 = 29.3
        (waves(24), 35),  # 11.5 * 24/8 = 34.5
        (waves(30), 45),  # 11.5 * 30/8 = 43.1
        (waves(50), 67),  # 71.9, of which 525/8 = 65.6 are taken
        ({"thickness": 0.02}, 17),  # 5.9, at least 136/8
        ({"thickness": 1e-4}, 67),  # 84
        ({"masses": {"top": [cf.edge.EdgeMass(angle=0.1, mass=0.01)]}}, 31),
        (around_on(8), 40),  # the next multiple of the period above 4 * 9.39 = 37.6
        (around_on(46), 46),  # at most half more than 31
        (around_on(47), 31),
        (around_on(1), 31),  # no period
        ({"supports": {"base": cf.Bolts(count=24, k=1e8), "top": cf.Clamped()}}, 72),  # 30 sqrt(250)/8 = 59.3
        (
            {"supports": {"base": cf.Bolts(count=16, k=1e8), "top": cf.Bolts(count=24, k=1e8)}},
            96,
        ),  # 48 = 2 * 24 = 3 * 16
        ({"supports": {"base": cf.Bolts(count=24, k=1e8), "top": cf.Clamped()}, **waves(3)}, 72),
        ({"supports": {"base": cf.Bolts(count=4, k=1e8), "top": around_on(3)["supports"]["base"]}}, 60),
        (
            {
                "supports": {"base": cf.Bolts(count=10, k=1e8)},
                "masses": {"top": [cf.edge.EdgeMass(angle=0.0, mass=0.1)]},
            },
            60,
        ),
    ],
)
def test_elements_around(steel, parts, around):
    mesh = mesh_of(steel, **parts)
    assert (mesh.order, mesh.around) == (8, around)


def test_a_period_that_leaves_the_lowest_waves_too_few_elements_is_not_followed(steel):
    """0.46 R/sqrt(t h) = 18.8 on a thin casing: 4 times that are 75.1 elements, more than the 70 of the period."""
    assert mesh_of(steel, thickness=5e-4, **around_on(70)).around == 59
    assert mesh_of(steel, thickness=6e-4, **around_on(70)).around == 70  # 4 * 17.1 = 68.6


def test_the_radius_in_the_middle_and_the_length_along_the_wall_count(steel):
    """The wall is 0.583 m long: 0.46 * 0.35/sqrt(1.3e-3 * 0.583) = 5.85 diameters, 25 * 5.85/8 = 18.3 elements.

    Rows are at most 7 sqrt(0.35 * 1.3e-3)/0.583 = 0.256 of that length.
    """
    chart = cf.Frustum(r_base=0.6, r_top=0.1, height=0.3)
    mesh = cf.Shell(chart=chart, thickness=1.3e-3, material=steel, supports=HELD, **waves(2)).mesh
    assert mesh.around == 19
    assert mesh.rows == (0.0, 0.25, 0.5, 0.75, 1.0)


@pytest.mark.parametrize(
    ("parts", "rows"),
    [
        ({}, (0.0, 0.5, 1.0)),  # 7 sqrt(0.5 * 2e-3)/0.3 = 0.738
        ({"height": 0.2}, (0.0, 1.0)),  # 1.1
        ({"height": 0.5}, (0.0, 1 / 3, 2 / 3, 1.0)),  # 0.443
        ({"thickness": 1e-5, "height": 0.8}, (0.0, 0.25, 0.5, 0.75, 1.0)),  # 0.02, of which 0.25 is taken
        ({"supports": {"base": cf.Clamped()}}, (0.0, 59 / 120, 59 / 60, 1.0)),  # 2.5 * 2e-3/0.3 = 1/60
        ({"supports": {"top": cf.Clamped()}}, (0.0, 1 / 60, 61 / 120, 1.0)),
        ({"supports": {"base": cf.Clamped()}, "thickness": 1e-4}, (*np.linspace(0.0, 0.999, 5), 1.0)),  # a thousandth
        ({"supports": {"base": cf.Clamped()}, "thickness": 0.02}, (0.0, 0.9, 1.0)),  # 0.167, of which 0.1 is taken
    ],
)
def test_rows_along(steel, parts, rows):
    np.testing.assert_allclose(mesh_of(steel, **parts).rows, rows, rtol=1e-12)


def test_layers_are_as_wide_as_the_wall_at_their_own_edge(steel):
    thick = cf.Strip(start=0.0, end=0.1, thickness=4e-3)
    rows = mesh_of(steel, supports={}, strips=(thick,)).rows
    np.testing.assert_allclose(rows, [0.0, 1 / 30, 1 / 3, 79 / 120, 1 - 1 / 60, 1.0], rtol=1e-12)  # of 0.53 at most


def test_a_layer_wider_than_half_its_stretch_is_left_out(steel):
    """2.5 * 2e-3/0.3 = 1/60 of the height is half of a strip of 0.01 m."""
    for end, layered in ((0.0101, True), (0.0099, False)):
        strips = (cf.Strip(start=0.0, end=end, thickness=2e-3), cf.Strip(start=0.3 - end, end=0.3, thickness=2e-3))
        rows = np.array(mesh_of(steel, supports={}, strips=strips).rows)
        assert any(abs(rows - 1 / 60) < 1e-9) is layered
        assert any(abs(rows - 59 / 60) < 1e-9) is layered


def test_a_stiffener_is_on_a_line_and_the_thinnest_wall_counts(steel):
    """A strip of 1 mm: 0.46 R/sqrt(1e-3 * 0.3) = 13.3 diameters, 16 * 13.3/7 = 30.4 elements, rows of 0.373.

    Both sides of the stiffener have a layer of 2.5 * 2e-3/0.3 = 1/60.
    """
    ring = cf.edge.Stiffener(at=0.12, section=cf.edge.Section.rectangle(width=0.01, depth=0.004), offset=(0.006, 0.0))
    mesh = mesh_of(steel, strips=(cf.Strip(start=0.2, end=0.3, thickness=1e-3),), stiffeners=(ring,))
    assert mesh.around == 31
    np.testing.assert_allclose(mesh.rows, [0.0, 23 / 120, 23 / 60, 0.4, 25 / 60, 2 / 3, 1.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("length", "width", "rows", "around"),
    [(0.4, 0.2, 4, 2), (0.2, 0.2, 2, 2), (0.3, 0.2, 3, 2), (0.2, 0.3, 2, 3), (0.1, 0.9, 2, 8), (0.9, 0.1, 8, 2)],
)
def test_a_plate_is_divided_by_its_sides(steel, length, width, rows, around):
    plate = cf.Plate(length=length, width=width)
    clamped = cf.Shell(chart=plate, thickness=1e-3, material=steel, supports=dict.fromkeys(plate.edges, cf.Clamped()))
    assert (clamped.mesh.order, len(clamped.mesh.breaks) - 1, clamped.mesh.around) == (8, rows, around)
    free = cf.Shell(chart=plate, thickness=4e-3, material=steel).mesh
    assert (free.order, len(free.breaks) - 1, free.columns) == (7, rows + 2, around + 2)
    for breaks, size in ((free.rows, length), (free.around, width)):
        assert breaks[1] == pytest.approx(0.01 / size)  # 2.5 thicknesses
        assert 1.0 - breaks[-2] == pytest.approx(0.01 / size)


def test_strips_of_a_plate_are_divided_on_their_own(steel):
    """Rows of a quarter: a strip of 0.3 takes two, the rest of 0.7 three; layers of .0125 at the root and .01."""
    strips = (cf.Strip(start=0.0, end=0.12, thickness=2e-3),)
    mesh = cf.Shell(chart=cf.Plate(length=0.4, width=0.2), thickness=1e-3, material=steel, strips=strips).mesh
    expected = [0.0, 0.0125, 0.0125 + 0.2875 / 2, 0.3, 0.3 + 0.69 / 3, 0.3 + 1.38 / 3, 0.99, 1.0]
    np.testing.assert_allclose(mesh.rows, expected, rtol=1e-12)


GRADED = (0.0, 0.002, 0.01, 0.04, 0.1, 0.3, 0.5, 0.7, 0.9, 0.96, 0.99, 0.998, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("chart", "thickness", "held"),
    [
        (cf.Plate(length=0.4, width=0.2), 3e-3, ()),
        (cf.Plate(length=0.4, width=0.2), 5e-4, ("root",)),
        (cf.Plate(length=0.2, width=0.5), 2e-3, ("root",)),
        (cf.Panel(radius=0.61, length=0.3, angle=0.5), 3e-3, ("root",)),
        (cf.Blade(length=0.3, chord=(0.1, 0.08), twist=(0.0, 0.8), camber=0.3), 3e-3, ("root",)),
        (cf.Plate(length=0.3, width=0.3), 0.02, ("root", "tip", "left", "right")),
    ],
    ids=["free", "thin", "wide", "panel", "twisted", "clamped"],
)
def test_plates_and_blades_meet_the_error(steel, chart, thickness, held):
    """Before there were layers at free edges, these were 3e-4 to 2e-3 too high."""
    shell = cf.Shell(chart=chart, thickness=thickness, material=steel, supports=dict.fromkeys(held, cf.Clamped()))
    fine = replace(shell, mesh=cf.ShellMesh(order=8, rows=GRADED, around=GRADED))
    count = 10 if held else 16
    found, exact = (cf.modes(part, count).freq[0 if held else 6 :] for part in (shell, fine))
    np.testing.assert_allclose(found, exact, rtol=2e-4)


@pytest.mark.parametrize("rotor", ["rotor37", "rotor67"])
def test_a_meridian_through_measured_points_meets_the_error_too(rotor):
    """Its curvature changes from point to point."""
    casing = cf.load_study(f"data/scenes/{rotor}/casing.toml").shell
    fine = replace(casing, mesh=cf.ShellMesh(order=8, rows=24, around=17))
    assert cf.modes(casing, 12).freq == pytest.approx(cf.modes(fine, 12).freq, rel=2e-4)
