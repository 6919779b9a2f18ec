"""Nastran's coordinate systems: one in another, by published conventions; what refers to nothing is named."""

import numpy as np
import pytest

import casingfem as cf

X = np.array([1.0, 2.0, 3.0])
KINDS = {"R": "rectangular", "C": "cylindrical", "S": "spherical"}
BODY = "GRID,91,,0.,0.,0.\nGRID,92,,1.,0.,0.\nGRID,93,,0.,1.,0.\nGRID,94,,0.,0.,1.\nCTETRA,1,1,91,92,93,94\nENDDATA\n"


def coordinates(kind, x):
    """Of a point, as Nastran gives them: angles in degrees, theta of a sphere from its z axis."""
    r = np.hypot(x[0], x[1])
    angle = np.degrees(np.arctan2(x[1], x[0]))
    if kind == "C":
        return np.array([r, angle, x[2]])
    return np.array([np.hypot(r, x[2]), np.degrees(np.arctan2(r, x[2])), angle]) if kind == "S" else np.asarray(x)


def fields(values):
    return ",".join(f"{float(value)!r}" for value in values)


def system(kind, number, points, within=0):
    """A card of a system by three points."""
    rows = [fields(row) for row in np.asarray(points, dtype=float)]
    return f"CORD2{kind},{number},{within},{rows[0]},{rows[1]}\n,{rows[2]}\n"


def read(folder, text):
    (folder / "part.bdf").write_text("BEGIN BULK\n" + text + BODY)
    return cf.read_mesh(folder / "part.bdf")


@pytest.mark.parametrize("kind", KINDS)
def test_a_turned_and_shifted_system(kind, tmp_path):
    """z along the basic x, x along the basic y, then y along the basic z; origin at (1, 0, 0)."""
    points = [[1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [1.0, 3.0, 0.0]]
    mesh = read(tmp_path, system(kind, 7, points) + f"GRID,1,7,{fields(coordinates(kind, X))}\n")
    np.testing.assert_allclose(mesh.points[0], [4.0, 1.0, 2.0], atol=1e-12)


def test_a_system_in_a_cylindrical_one(tmp_path):
    """Its points are given as r, theta, z of the other, whose card may come later."""
    whole = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    at_90 = [[2.0, 90.0, 0.0], [2.0, 90.0, 1.0], [3.0, 90.0, 0.0]]
    mesh = read(tmp_path, system("R", 2, at_90, within=1) + "GRID,1,2,.5,0.,4.\n" + system("C", 1, whole))
    np.testing.assert_allclose(mesh.points[0], [0.0, 2.5, 4.0], atol=1e-12)


def test_a_system_in_one_by_grids_of_a_third(tmp_path):
    """System 3 is 2 m along y of system 2, by grids of system 4, whose origin is 1 m along x."""
    upright = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    text = "GRID,1,3,.5,.5,.5\n" + system("R", 3, upright + np.array([0.0, 2.0, 0.0]), within=2) + "CORD1R,2,11,12,13\n"
    text += "".join(f"GRID,{k},4,{fields(row)}\n" for k, row in enumerate(upright, 11))
    mesh = read(tmp_path, text + system("R", 4, upright + np.array([1.0, 0.0, 0.0])))
    np.testing.assert_allclose(mesh.points[0], [1.5, 2.5, 0.5], atol=1e-12)


def test_systems_by_grids_in_systems_by_grids(tmp_path):
    """Grid 4 in system 1 by grids 1 to 3, grid 7 in system 2 by grids 4 to 6; the cards come the other way round."""
    grids = {7: (2, 2.0, 90.0, 0.5), 4: (1, 1.0, 2.0, 3.0), 1: (0, 10.0, 0.0, 0.0), 2: (0, 10.0, 0.0, 1.0),
             3: (0, 10.0, 1.0, 0.0), 5: (0, 8.0, 1.0, 5.0), 6: (0, 8.0, 3.0, 3.0),
             8: (9, 0.5, 0.25, 0.125)}  # fmt: skip
    cards = "".join(f"GRID,{number},{at[0]},{fields(at[1:])}\n" for number, at in grids.items())
    cards += "CORD1C,2,4,5,6\nCORD1R,1,1,2,3\n"
    cards += system("R", 9, [[0, 0, 1.0], [0, 0, 2.0], [1.0, 0, 1.0]], within=1)
    found = dict(zip(grids, read(tmp_path, cards).points, strict=False))
    # system 1: origin (10, 0, 0), z along z, x along y, so y along -x
    np.testing.assert_allclose(found[4], [8.0, 1.0, 3.0], atol=1e-12)
    # system 2: origin grid 4, z along z, x along y: r = 2 at 90 degrees is y, -x of the basic one
    np.testing.assert_allclose(found[7], [6.0, 1.0, 3.5], atol=1e-12)
    # system 9: that of 1, a metre higher
    np.testing.assert_allclose(found[8], [9.75, 0.5, 1.125], atol=1e-12)
    one_card = cards.replace("CORD1C,2,4,5,6\nCORD1R,1,1,2,3\n", "CORD1R,1,1,2,3,12,4,5,6\n")
    two = read(tmp_path, one_card.replace("GRID,7,2,2.0,90.0", "GRID,7,12,0.,2."))
    np.testing.assert_allclose(two.points[0], [6.0, 1.0, 3.5], atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_directions_are_those_in_which_a_point_moves_with_its_coordinates(kind, tmp_path):
    """Offsets of masses in a system are along its directions at the mass: differences of positions, of length one."""
    points = [[1.0, 0.5, 0.2], [3.0, 1.5, 2.2], [2.0, 3.0, -1.0]]
    at, steps = coordinates(kind, X), 1e-4 * np.eye(3)
    places = [at, *(at + step for step in steps), *(at - step for step in steps)]
    cards = "".join(f"GRID,{k + 1},7,{fields(place)}\n" for k, place in enumerate(places))
    cards += "".join(f"CONM2,{80 + k},1,7,1.,{fields(np.eye(3)[k])}\n" for k in range(3))
    mesh = read(tmp_path, system(kind, 7, points) + cards)
    moves = mesh.points[1:4] - mesh.points[4:7]
    units = moves / np.linalg.norm(moves, axis=1, keepdims=True)
    np.testing.assert_allclose([mass.offset for mass in mesh.attachments.masses], units, atol=1e-8)


@pytest.mark.parametrize("kind", ["C", "S"])
@pytest.mark.parametrize("place", [(0.0, 0.0, 2.0), (1e-10, 0.0, 2.0), (0.0, 0.0, 0.0)])
def test_on_the_axis_of_a_round_system_there_are_no_directions(kind, place, tmp_path):
    whole = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    text = system(kind, 1, whole) + f"GRID,1,,{fields(place)}\nCONM2,80,1,1,1.,1.,0.,0.\n"
    with pytest.raises(
        cf.errors.ModelError, match=r"line 5: CONM2: .*a point on the axis of system 1, where its radial"
    ):
        read(tmp_path, text)
    off = read(tmp_path, text.replace(f"GRID,1,,{fields(place)}", "GRID,1,,3e-10,0.,2."))
    np.testing.assert_allclose(np.abs(off.attachments.masses[0].offset).max(), 1.0, rtol=1e-9)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_points_in_a_line_are_seen_by_their_angle(size, tmp_path):
    def text(slant):
        return system("R", 1, size * np.array([[0, 0, 0], [0, 0, 2.0], [3.0 * slant, 0, 3.0]])) + "GRID,1,1,1.,2.,3.\n"

    np.testing.assert_allclose(read(tmp_path, text(1.5e-10)).points[0], X, atol=1e-9)
    with pytest.raises(cf.errors.ModelError, match="three points of system 1 in one line"):
        read(tmp_path, text(0.5e-10))


@pytest.mark.parametrize(
    ("card", "found"), [("CORD1R,5,91,92", "91, 92"), ("CORD1R,5", "none"), ("CORD1R,5,91,,93", "91, , 93")]
)
def test_systems_by_other_than_three_grids_are_refused(card, found, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=f"line 2: CORD1R: found the grids {found}, expected three"):
        read(tmp_path, f"{card}\n")


@pytest.mark.parametrize("first", ["CORD2R,5,,0.,0.,0.,0.,0.,1.\n,1.", "CORD1R,5,91,92,93"])
@pytest.mark.parametrize("second", ["CORD2C,5,,0.,0.,0.,0.,0.,1.\n,1.", "CORD1C,5,91,92,93"])
def test_a_number_is_that_of_one_system(first, second, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=f"{second[:6]}: found coordinate system 5 again"):
        read(tmp_path, f"{first}\n{second}\n")


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


def test_grids_are_where_their_system_puts_them(tmp_path):
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
        (lambda t: t.replace("GRID,1,5", "GRID,1,6"), "line 4: GRID: grid 1 in coordinate system 6: found no system 6"),
        (lambda t: t.replace("CORD2C,5,0", "CORD2C,5,5"), "system 5: found a system 5 that refers to itself"),
        (lambda t: t.replace(",1.,0.,0.\n", ",0.,0.,2.\n", 1), "three points of system 5 in one line"),
        (lambda t: t.replace("CORD2C,5,0,0.", "CORD2C,5,0,x"), "line 2: CORD2C: found 'x', expected a real number"),
        (lambda t: t.replace("CORD2C", "CORD1C"), "line 2: CORD1C: found '0.', expected a whole"),
        (
            lambda t: t.replace("GRID,1,5", "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,5"),
            "found coordinate system 5 again",
        ),
    ],
)
def test_systems_that_cannot_be_are_named_with_their_line(change, message, tmp_path):
    (tmp_path / "part.bdf").write_text(change(BDF))
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.read_mesh(tmp_path / "part.bdf")
