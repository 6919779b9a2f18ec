"""Coordinate systems of Nastran's cards: which field is what, systems in systems, and what stands in a line."""

import re

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.bdf_cards import Card, Numbers
from casingfem.structure.imported.readers.coordinates import (
    CardSystems,
    System,
    axes_at,
    cartesian,
    coordinates,
    in_basic,
)

WHOLE = np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0]])


def card(name, *fields, line="4"):
    return Card(line, name, [str(field) for field in fields])


def systems(*given):
    found = CardSystems(Numbers("a.bdf"))
    for one in given:
        (found.take if one.name.startswith("CORD2") else found.take_by_grids)(one)
    return found


@pytest.mark.parametrize(
    ("name", "kind"), [("CORD2R", "rectangular"), ("CORD2C", "cylindrical"), ("CORD2S", "spherical")]
)
def test_fields_of_a_system_by_points(name, kind):
    found = systems(card(name, 5, 3, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.5), card(name, 6, "", 1.0, "", 2.0))
    assert found.systems[5][:2] == (kind, 3)
    assert found.systems[5].points.tolist() == [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.5]]
    assert found.systems[6][:2] == (kind, 0)
    assert found.systems[6].points.tolist() == [[1.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


@pytest.mark.parametrize(
    ("name", "kind"), [("CORD1R", "rectangular"), ("CORD1C", "cylindrical"), ("CORD1S", "spherical")]
)
def test_a_card_of_systems_by_grids_has_one_or_two(name, kind):
    two = card(name, 5, 11, 12, 13, 6, 21, 22, 23)
    assert systems(two).by_grids == {5: (kind, [11, 12, 13], two), 6: (kind, [21, 22, 23], two)}


@pytest.mark.parametrize(
    ("fields", "told"),
    [((5, 11, 12), "11, 12"), ((5,), "none"), ((5, 11, "", 13), "11, , 13"), ((5, 1, 2, 3, 6, 7, 8), "7, 8")],
)
def test_systems_by_other_than_three_grids_are_refused(fields, told):
    with pytest.raises(cf.errors.ModelError, match=f"a.bdf: line 4: CORD1R: found the grids {told}, expected three"):
        systems(card("CORD1R", *fields))


@pytest.mark.parametrize("first", [("CORD2R", 5), ("CORD1R", 5, 1, 2, 3)])
@pytest.mark.parametrize("second", [("CORD2C", 5), ("CORD1C", 5, 1, 2, 3)])
def test_a_number_is_that_of_one_system(first, second):
    with pytest.raises(cf.errors.ModelError, match=f"{second[0]}: coordinate system 5 is given twice"):
        systems(card(*first), card(*second))


def test_grids_are_placed_in_systems_by_grids_in_systems_by_grids():
    """Grid 4 in system 1 by grids 1 to 3, grid 7 in system 2 by grids 4 to 6; the cards stand the other way round."""
    found = systems(card("CORD1C", 2, 4, 5, 6), card("CORD1R", 1, 1, 2, 3))
    grids = [(7, 2.0, 90.0, 0.5), (4, 1.0, 2.0, 3.0), (1, 10.0, 0.0, 0.0), (2, 10.0, 0.0, 1.0), (3, 10.0, 1.0, 0.0),
             (5, 8.0, 1.0, 5.0), (6, 8.0, 1.0 + 2.0, 3.0)]  # fmt: skip
    at = card("GRID", 7)
    found.place(grids, [(0, 2, at), (1, 1, at)])
    # system 1: origin (10, 0, 0), z along z, x along y, so y along -x
    assert grids[1][1:] == pytest.approx((8.0, 1.0, 3.0), abs=1e-12)
    # system 2: origin grid 4, z along z, x along y: r = 2 at 90 degrees is y, -x of the basic one
    assert grids[0][1:] == pytest.approx((6.0, 1.0, 3.5), abs=1e-12)
    assert grids[2:] == [(1, 10.0, 0.0, 0.0), (2, 10.0, 0.0, 1.0), (3, 10.0, 1.0, 0.0), (5, 8.0, 1.0, 5.0),
                         (6, 8.0, 3.0, 3.0)]  # fmt: skip
    assert [number for number, *_ in grids] == [7, 4, 1, 2, 3, 5, 6]


def test_a_grid_in_a_system_within_one_by_grids_waits_for_it():
    found = systems(card("CORD1R", 1, 1, 2, 3), card("CORD2R", 9, 1, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 1.0, 0.0, 1.0))
    grids = [(4, 0.5, 0.25, 0.125), (1, 1.0, 0.0, 0.0), (2, 1.0, 0.0, 1.0), (3, 1.0, 1.0, 0.0)]
    found.place(grids, [(0, 9, card("GRID", 4))])
    assert grids[0][1:] == pytest.approx((0.75, 0.5, 1.125), abs=1e-12)


@pytest.mark.parametrize(
    ("given", "system", "told"),
    [
        ((), 6, "grid 4 in coordinate system 6: no system 6"),
        ((card("CORD2R", 6, 8, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0),), 6, "grid 4 in coordinate system 6: no system 8"),
        ((card("CORD2R", 6, 6, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0),), 6, "system 6 refers to itself"),
        ((card("CORD2R", 6, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0),), 6, "the points of system 6 stand in a line"),
        ((card("CORD2R", 6, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0),), 6, "the points of system 6 stand in a line"),
    ],
)
def test_a_grid_whose_system_cannot_be_is_refused(given, system, told):
    with pytest.raises(cf.errors.ModelError, match=re.escape("a.bdf: line 7: GRID: ") + ".*" + told):
        systems(*given).place([(4, 1.0, 2.0, 3.0)], [(0, system, card("GRID", 4, line="7"))])


@pytest.mark.parametrize(("slant", "stands"), [(0.5e-10, False), (1.5e-10, True)])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_points_in_a_line_are_told_by_their_angle(slant, stands, size):
    points = size * np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [3.0 * slant, 0.0, 3.0]])
    given = {1: System("rectangular", 0, points)}
    if stands:
        np.testing.assert_allclose(axes_at(given, 1, np.zeros(3)), np.eye(3), atol=1e-9)
        return
    with pytest.raises(ValueError, match="the points of system 1 stand in a line"):
        in_basic(given, 1, np.zeros(3))


@pytest.mark.parametrize("kind", ["cylindrical", "spherical"])
@pytest.mark.parametrize(("away", "stands"), [(0.5e-10, False), (1.5e-10, True)])
@pytest.mark.parametrize("origin", [0.0, 7.0])
def test_on_the_axis_of_a_round_system_there_are_no_directions(kind, away, stands, origin):
    points, at = WHOLE + np.array([0.0, origin, 0.0]), np.array([2.0 * away, origin, 2.0])
    given = {1: System(kind, 0, points)}
    if stands:
        np.testing.assert_allclose(axes_at(given, 1, at)[0 if kind == "cylindrical" else 1], [1.0, 0.0, 0.0], atol=1e-6)
        return
    with pytest.raises(ValueError, match="a point on the axis of system 1, where its directions are not defined"):
        axes_at(given, 1, at)


@pytest.mark.parametrize("kind", ["cylindrical", "spherical"])
def test_at_the_origin_of_a_round_system_there_are_no_directions(kind):
    with pytest.raises(ValueError, match="a point on the axis of system 1"):
        axes_at({1: System(kind, 0, WHOLE)}, 1, np.zeros(3))


def test_directions_of_the_basic_system_are_its_axes():
    assert axes_at({}, 0, np.zeros(3)).tolist() == np.eye(3).tolist()


def test_angles_are_in_degrees_and_from_the_z_axis():
    """r, theta, z at 30 degrees; r, theta from z, phi at 60 and 30 degrees."""
    half, root = 0.5, np.sqrt(3.0) / 2.0
    np.testing.assert_allclose(cartesian("cylindrical", np.array([4.0, 30.0, -3.0])), [4 * root, 2.0, -3.0], rtol=1e-14)
    wanted = [4 * root * root, 4 * root * half, 4 * half]
    np.testing.assert_allclose(cartesian("spherical", np.array([4.0, 60.0, 30.0])), wanted, rtol=1e-14)
    np.testing.assert_allclose(coordinates("cylindrical", np.array([-3.0, 4.0, 2.0])), [5.0, 126.86989764584402, 2.0])
    np.testing.assert_allclose(coordinates("spherical", np.array([0.0, -3.0, 4.0])), [5.0, 36.86989764584402, -90.0])
    assert coordinates("rectangular", np.array([1.0, 2.0, 3.0])).tolist() == [1.0, 2.0, 3.0]


def test_axes_that_a_card_asks_for_are_refused_with_its_line():
    found = systems(card("CORD2C", 5, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0))
    np.testing.assert_allclose(
        found.axes(card("CONM2"), 5, np.array([0.0, 2.0, 1.0])), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-15
    )
    with pytest.raises(cf.errors.ModelError, match=r"a\.bdf: line 9: CONM2: coordinate system 6: no system 6"):
        found.axes(card("CONM2", line="9"), 6, np.zeros(3))
