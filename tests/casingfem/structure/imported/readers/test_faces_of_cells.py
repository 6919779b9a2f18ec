"""Faces by the names of Abaqus and CalculiX: where they lie on cells of unit size, and names that no face has."""

import numpy as np
import pytest

from casingfem.structure.imported.readers.inp_names import face_corners

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
X, Y, Z, SLANTED = [1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [1.0, 1.0, 0]


def raised(flat):
    return np.vstack([np.insert(flat, 2, z, axis=1) for z in (0.0, 1.0)])


PLACES = {
    "tetra": np.vstack([np.zeros(3), np.eye(3)]),
    "wedge": raised(TRIANGLE),
    "hexahedron": raised(SQUARE),
}
# along which direction the places of a face's corners have which value (Abaqus Analysis User's Guide, 28.1.4)
LIES = {
    "tetra": [(Z, 0), (Y, 0), ([1.0, 1.0, 1.0], 1), (X, 0)],
    "wedge": [(Z, 0), (Z, 1), (Y, 0), (SLANTED, 1), (X, 0)],
    "hexahedron": [(Z, 0), (Z, 1), (Y, 0), (X, 1), (Y, 1), (X, 0)],
}


@pytest.mark.parametrize(
    ("kind", "number"), [(kind, number) for kind, faces in LIES.items() for number in range(1, len(faces) + 1)]
)
@pytest.mark.parametrize("order", ["", "20"])
def test_faces_of_solids_have_all_corners_on_their_side_and_go_round(kind, number, order):
    direction, value = LIES[kind][number - 1]
    found = face_corners(kind + order, f"S{number}")
    assert sorted(found) == np.flatnonzero(PLACES[kind] @ direction == value).tolist()
    if len(found) == 4:
        a, b, c, d = PLACES[kind][list(found)]
        assert (a + c).tolist() == (b + d).tolist()


@pytest.mark.parametrize(
    ("kind", "face"),
    [("tetra", "S0"), ("tetra", "S5"), ("wedge15", "S0"), ("wedge15", "S6"), ("hexahedron", "S0"), ("hexahedron", "S7"),
     ("hexahedron", "E1"), ("tetra", "SPOS"), ("wedge", "SNEG"), ("quad", "S7"), ("quad", "S0"), ("quad", "E0"),
     ("quad8", "E5"), ("triangle", "E4"), ("triangle6", "S6"), ("quad", "S12"), ("quad", "X1"), ("quad", "SPOS1"),
     ("line", "E1"), ("polygon", "E1")],
)  # fmt: skip
def test_names_that_no_face_has_give_no_corners(kind, face):
    assert face_corners(kind, face) == ()


@pytest.mark.parametrize(("kind", "count"), [("triangle", 3), ("triangle6", 3), ("quad", 4), ("quad9", 4)])
def test_sides_of_shells_are_all_corners_and_edges_follow_one_another(kind, count):
    around = [(k, (k + 1) % count) for k in range(count)]
    for side in ("SPOS", "SNEG", "S1", "S2"):
        assert face_corners(kind, side) == tuple(range(count))
    assert [face_corners(kind, f"E{k + 1}") for k in range(count)] == around
    assert [face_corners(kind, f"S{k + 3}") for k in range(count)] == around


def test_in_a_plane_all_numbered_faces_are_edges():
    assert [face_corners("quad8", f"S{k}", plane=True) for k in range(6)] == [
        (), (0, 1), (1, 2), (2, 3), (3, 0), ()
    ]  # fmt: skip
    assert face_corners("triangle", "E3", plane=True) == (2, 0)
    assert face_corners("triangle", "SPOS", plane=True) == (0, 1, 2)
