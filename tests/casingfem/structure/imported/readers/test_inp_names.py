"""Names and numbers of an assembly of two instances: whose set, whose node, on which cells."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.inp import read_inp
from casingfem.structure.imported.readers.inp_cards import Card, Frame
from casingfem.structure.imported.readers.inp_names import Names

PART = """*PART, NAME=P
*NODE, NSET=Own
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
*ELEMENT, TYPE=S4, ELSET=Cells
25, 1, 2, 3, 4
*NSET, NSET=Two
2, Own
*SURFACE, NAME=Up
Cells, SPOS
*SURFACE, NAME=Points, TYPE=NODE
Two
1
*ELEMENT, TYPE=MASS, ELSET=m
26, 3
*MASS, ELSET=m
2.5
*MPC
PIN, 1, 2
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=One, PART=P
*TIE, NAME=inner
Points, Up
*END INSTANCE
*INSTANCE, NAME=Two, PART=P
0., 0., 5.
*END INSTANCE
*NSET, NSET=first, INSTANCE=One
3
*NSET, NSET=second, INSTANCE=Two
3, own
*NSET, NSET=both
One.two, TWO.OWN, first
*ELSET, ELSET=top, INSTANCE=two
25
*SURFACE, NAME=Whole
One.Cells, SNEG
top, E2
*TIE, NAME=outer
Two.Points, whole
*RIGID BODY, REF NODE=first, NSET=second
*END ASSEMBLY
"""


def read(folder, text):
    (folder / "a.inp").write_text(text)
    return read_inp(folder / "a.inp")


def test_names_and_numbers_of_two_instances(tmp_path):
    draft = read(tmp_path, PART)
    numbers = draft.node_numbers
    assert numbers.tolist() == [1, 2, 3, 4, 101, 102, 103, 104]
    np.testing.assert_array_equal(draft.points[4:], draft.points[:4] + np.array([0.0, 0.0, 5.0]))
    assert {name: numbers[nodes].tolist() for name, nodes in draft.node_sets.items()} == {
        "One.Own": [1, 2, 3, 4], "One.Two": [2, 1, 2, 3, 4], "One.Points": [2, 1, 2, 3, 4, 1],
        "Two.Own": [101, 102, 103, 104], "Two.Two": [102, 101, 102, 103, 104],
        "Two.Points": [102, 101, 102, 103, 104, 101],
        "first": [3], "second": [103, 101, 102, 103, 104], "both": [2, 1, 2, 3, 4, 101, 102, 103, 104, 3],
    }  # fmt: skip
    own = {
        name: [draft.blocks[k].numbers[rows].tolist() for k, rows in parts] for name, parts in draft.cell_sets.items()
    }
    assert {name: members for name, members in own.items() if any(members)} == {
        "One.Cells": [[25]], "Two.Cells": [[125]], "top": [[125]], "One.Up": [[25]], "Two.Up": [[125]], "Whole": [[25]],
    }  # fmt: skip
    assert numbers[draft.facet_sets["Whole"]].tolist() == [[102, 103]]
    assert [(g.follower, g.master) for g in draft.gluings] == [("One.Points", "One.Up"), ("Two.Points", "Whole")]
    attached = draft.attachments
    assert [int(numbers[mass.node]) for mass in attached.masses] == [3, 103]
    assert [[int(numbers[n]) for n in equation.nodes] for equation in attached.equations[::3]] == [[1, 2], [101, 102]]
    (rigid,) = attached.rigids
    assert (int(numbers[rigid.reference]), numbers[rigid.nodes].tolist()) == (3, [101, 102, 103, 104])


def test_a_name_within_an_instance_is_its_own_before_that_of_the_assembly():
    names = Names("a.inp")
    names.add(names.node_sets, "Set", np.array([7]))
    names.frame = Frame(offset=100, prefix="I.")
    names.add(names.node_sets, "set", np.array([8]))
    assert names.nodes_of("SET", "3").tolist() == [8]
    assert names.nodes_of("5", "3").tolist() == [105]
    names.frame = Frame(offset=100, prefix="J.", owns=False)
    assert names.nodes_of("set", "3").tolist() == [7]
    names.add(names.node_sets, "more", np.array([9]))
    assert names.spelling == {"SET": "Set", "I.SET": "I.set", "MORE": "more"}
    with pytest.raises(cf.errors.ModelError, match=r"a\.inp: line 3: no set 'none' up to here"):
        names.nodes_of("none", "3")


def test_numbers_have_fifteen_digits_at_most():
    names = Names("a.inp")
    assert names.nodes_of("9" * 15, "3").tolist() == [10**15 - 1]
    with pytest.raises(cf.errors.ModelError, match=r"no set '9{16}' up to here"):
        names.nodes_of("9" * 16, "3")
    card = Card("2", "NODE", {}, [("3", "1, 2.5,"), ("4", "-9.9e14")])
    assert names.values(card, float) == [[1.0, 2.5], [-9.9e14]]
    for text in ("1e15", "-1e15", "nan"):
        with pytest.raises(cf.errors.ModelError, match=rf"line 3: found '1, {text}', expected numbers below 1e\+15"):
            names.values(Card("2", "NODE", {}, [("3", f"1, {text}")]), float)
    with pytest.raises(cf.errors.ModelError, match=r"line 3: found '1, 2\.5', expected numbers"):
        names.values(Card("2", "ELEMENT", {}, [("3", "1, 2.5")]), int)


def test_nodes_of_a_surface_are_those_of_its_faces_on_cells_of_every_kind():
    names = Names("a.inp")
    names.elements = [
        ("hexahedron20", np.array([4, 5]), np.arange(100, 140).reshape(2, 20)),
        ("wedge15", np.array([6]), 200 + np.arange(15)[None]),
        ("line", np.array([9]), np.array([[1, 2]])),
    ]
    names.surfaces = {"A": [(np.array([5, 6]), "S2"), (np.array([4]), "S1")], "B": [(np.array([7]), "S1")]}
    # VTK's order of middles: a brick's lower edges 8 to 11, upper 12 to 15; a wedge's lower 6 to 8, upper 9 to 11
    upper = [124, 125, 126, 127, 132, 133, 134, 135]
    lower = [100, 101, 102, 103, 108, 109, 110, 111]
    assert names.surface_nodes("a", "3").tolist() == sorted([*lower, *upper, 203, 204, 205, 209, 210, 211])
    assert names.surface_nodes("B", "3").tolist() == []
    names.on_nodes["C"] = [np.array([9, 3]), np.array([3])]
    assert names.surface_nodes("c", "3").tolist() == [3, 9]
    assert names.node_surface("A") is None
    with pytest.raises(cf.errors.ModelError, match=r"a\.inp: line 3: no surface 'D'"):
        names.surface_nodes("D", "3")


def test_a_numbered_face_is_an_edge_where_all_cells_are_in_a_plane():
    names = Names("a.inp")
    names.plane = {4, 5}
    assert names.local_corners("quad", np.array([4, 5]), "S1") == (0, 1)
    for ids in ([4, 6], [6], []):
        assert names.local_corners("quad", np.array(ids, dtype=int), "S1") == (0, 1, 2, 3)
    with pytest.raises(cf.errors.ModelError, match=r"a\.inp: a surface on face 'S7' of quad elements"):
        names.local_corners("quad", np.array([6]), "S7")
