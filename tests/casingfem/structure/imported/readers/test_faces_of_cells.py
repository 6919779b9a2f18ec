"""Faces by the names of Abaqus and CalculiX: where they lie on cells of unit size, and names that no face has."""

import numpy as np
import pytest

import casingfem as cf

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
X, Y, Z, SLANTED = [1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [1.0, 1.0, 0]


def flat(corners, z=0.0):
    return np.insert(corners, 2, z, axis=1)


PLACES = {
    "C3D4": np.vstack([np.zeros(3), np.eye(3)]),
    "C3D6": np.vstack([flat(TRIANGLE), flat(TRIANGLE, 1.0)]),
    "C3D8": np.vstack([flat(SQUARE), flat(SQUARE, 1.0)]),
    "S4": flat(SQUARE),
    "S3": flat(TRIANGLE),
    "CPS4": flat(SQUARE),
    "CPE3": flat(TRIANGLE),
}
# along which direction the places of a face's corners have which value (Abaqus Analysis User's Guide, 28.1.4)
LIES = {
    "C3D4": [(Z, 0), (Y, 0), ([1.0, 1.0, 1.0], 1), (X, 0)],
    "C3D6": [(Z, 0), (Z, 1), (Y, 0), (SLANTED, 1), (X, 0)],
    "C3D8": [(Z, 0), (Z, 1), (Y, 0), (X, 1), (Y, 1), (X, 0)],
}


def read(folder, family, *faces):
    """One element and a surface F1, F2, ... of each face."""
    x = PLACES[family]
    nodes = "".join(f"{k + 1}, {p}, {q}, {r}\n" for k, (p, q, r) in enumerate(x.tolist()))
    text = f"*NODE\n{nodes}*ELEMENT, TYPE={family}\n1, {', '.join(str(k + 1) for k in range(len(x)))}\n"
    text += "".join(f"*SURFACE, NAME=F{k + 1}\n1, {face}\n" for k, face in enumerate(faces))
    (folder / "a.inp").write_text(text)
    return cf.read_mesh(folder / "a.inp")


@pytest.mark.parametrize("family", LIES)
def test_faces_of_solids_have_all_corners_on_their_side(family, tmp_path):
    mesh = read(tmp_path, family, *(f"S{k + 1}" for k in range(len(LIES[family]))))
    for k, (direction, value) in enumerate(LIES[family]):
        (facet,) = mesh.groups[f"F{k + 1}"].facets
        corners = set(mesh.facets[tuple(facet)].tolist())
        assert corners == set(np.flatnonzero(PLACES[family] @ direction == value).tolist())


@pytest.mark.parametrize(("family", "count"), [("S3", 3), ("S4", 4), ("CPS4", 4), ("CPE3", 3)])
def test_edges_follow_one_another_from_the_first_corner(family, count, tmp_path):
    """E1, E2, ... of shells, which are S3, S4, ... too; S1, S2, ... of elements in a plane."""
    plane = family.startswith("C")
    names = [f"S{k + 1}" for k in range(count)] if plane else [f"E{k + 1}" for k in range(count)]
    names = names if plane else names + [f"S{k + 3}" for k in range(count)]
    mesh = read(tmp_path, family, *names)
    for k in range(len(names)):
        (facet,) = mesh.groups[f"F{k + 1}"].facets
        assert set(mesh.facets[tuple(facet)].tolist()) == {k % count, (k + 1) % count}


@pytest.mark.parametrize("face", ["SPOS", "SNEG", "S1", "S2"])
def test_sides_of_shells_are_cells(face, tmp_path):
    group = read(tmp_path, "S4", face).groups["F1"]
    assert (group.cells.tolist(), group.facets) == ([0], None)


@pytest.mark.parametrize(
    ("family", "face"),
    [("C3D4", "S0"), ("C3D4", "S5"), ("C3D6", "S6"), ("C3D8", "S7"), ("C3D8", "E1"), ("C3D4", "SPOS"), ("S4", "S7"),
     ("S4", "S0"), ("S4", "E0"), ("S4", "E5"), ("S3", "E4"), ("S3", "S6"), ("S4", "S12"), ("S4", "X1"), ("S4", "SPOS1"),
     ("CPS4", "S0"), ("CPS4", "S5"), ("CPE3", "S4")],
)  # fmt: skip
def test_names_that_no_face_has_are_refused(family, face, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.inp: .*'{face}'"):
        read(tmp_path, family, face)
