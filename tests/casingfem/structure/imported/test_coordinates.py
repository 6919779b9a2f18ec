"""Nastran's coordinate systems: one in another, by published conventions; what refers to nothing is named."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.coordinates import System, axes_at, cartesian, coordinates, in_basic

X = np.array([1.0, 2.0, 3.0])


@pytest.mark.parametrize("kind", ["rectangular", "cylindrical", "spherical"])
def test_coordinates_go_there_and_back(kind):
    np.testing.assert_allclose(cartesian(kind, coordinates(kind, X)), X, atol=1e-14)


def test_a_turned_and_shifted_system():
    """z along the basic x, x along the basic y, then y along the basic z; origin at (1, 0, 0)."""
    points = np.array([[1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [1.0, 3.0, 0.0]])
    for kind, at in (("rectangular", X), ("cylindrical", coordinates("cylindrical", X)),
                     ("spherical", coordinates("spherical", X))):  # fmt: skip
        np.testing.assert_allclose(in_basic({7: System(kind, 0, points)}, 7, at), [4.0, 1.0, 2.0], atol=1e-12)


def test_a_system_in_a_cylindrical_one():
    """Its points are given as r, theta, z of the other."""
    whole = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    at_90 = np.array([[2.0, 90.0, 0.0], [2.0, 90.0, 1.0], [3.0, 90.0, 0.0]])
    systems = {1: System("cylindrical", 0, whole), 2: System("rectangular", 1, at_90)}
    np.testing.assert_allclose(in_basic(systems, 2, np.array([0.5, 0.0, 4.0])), [0.0, 2.5, 4.0], atol=1e-12)


@pytest.mark.parametrize("kind", ["rectangular", "cylindrical", "spherical"])
def test_directions_are_those_in_which_a_point_moves_with_its_coordinates(kind):
    """d x/d coordinate by differences, of length one, in a system that is turned and stands elsewhere."""
    points = np.array([[1.0, 0.5, 0.2], [3.0, 1.5, 2.2], [2.0, 3.0, -1.0]])
    systems, at = {7: System(kind, 0, points)}, coordinates(kind, X)
    moves = np.array([in_basic(systems, 7, at + move) - in_basic(systems, 7, at - move) for move in 1e-4 * np.eye(3)])
    units = moves / np.linalg.norm(moves, axis=1, keepdims=True)
    np.testing.assert_allclose(axes_at(systems, 7, in_basic(systems, 7, at)), units, atol=1e-8)


BDF = """BEGIN BULK
CORD2C,5,0,0.,0.,0.,0.,0.,1.
,1.,0.,0.
GRID,1,5,1.,0.,0.
GRID,2,5,1.,90.,0.
GRID,3,,0.,0.,0.
GRID,4,0,0.,0.,1.
CTETRA,1,1,1,2,3,4
ENDDATA
"""


def test_grids_stand_where_their_system_puts_them(tmp_path):
    (tmp_path / "part.bdf").write_text(BDF)
    points = cf.read_mesh(tmp_path / "part.bdf").points
    np.testing.assert_allclose(points, [[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 1]], atol=1e-12)
    later = BDF.replace("CORD2C,5,0,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n", "").replace(
        "ENDDATA", "CORD2C,5,0,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nENDDATA"
    )
    (tmp_path / "part.bdf").write_text(later)
    np.testing.assert_allclose(cf.read_mesh(tmp_path / "part.bdf").points, points, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace("GRID,1,5", "GRID,1,6"), "line 4: GRID: grid 1 in coordinate system 6: no system 6"),
        (lambda t: t.replace("CORD2C,5,0", "CORD2C,5,5"), "system 5 refers to itself"),
        (lambda t: t.replace(",1.,0.,0.\n", ",0.,0.,2.\n", 1), "the points of system 5 stand in a line"),
        (lambda t: t.replace("CORD2C,5,0,0.", "CORD2C,5,0,x"), "line 2: CORD2C: found 'x', expected a real number"),
        (lambda t: t.replace("CORD2C", "CORD1C"), "line 2: CORD1C: found '0.', expected a whole"),
        (lambda t: t.replace("GRID,1,5", "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,5"), "5 is given twice"),
    ],
)
def test_systems_that_cannot_be_are_named_with_their_line(change, message, tmp_path):
    (tmp_path / "part.bdf").write_text(change(BDF))
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.read_mesh(tmp_path / "part.bdf")
