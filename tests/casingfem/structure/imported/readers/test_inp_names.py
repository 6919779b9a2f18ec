"""Names and numbers of an assembly of two instances: whose set, whose node, on which cells."""

import numpy as np
import pytest

import casingfem as cf

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
*RIGID BODY, REF NODE=first, NSET=second
*END ASSEMBLY
"""


def read(folder, text):
    (folder / "a.inp").write_text(text)
    return cf.read_mesh(folder / "a.inp")


def test_names_and_numbers_of_two_instances(tmp_path):
    """Sets of the second instance are called Two.x; its numbers begin at 100."""
    mesh = read(tmp_path, PART)
    numbers = mesh.node_numbers
    assert numbers.tolist() == [1, 2, 3, 4, 101, 102, 103, 104]
    np.testing.assert_array_equal(mesh.points[4:], mesh.points[:4] + np.array([0.0, 0.0, 5.0]))
    one, two = [1, 2, 3, 4], [101, 102, 103, 104]
    groups = {
        name: numbers[group.nodes].tolist()
        for name, group in mesh.groups.items()
        if not len(group.cells) and group.facets is None and len(group.nodes)
    }
    assert groups == {
        "One.Own": one, "One.Two": one, "One.Points": one, "Two.Own": two, "Two.Two": two,
        "first": [3], "second": two, "both": [1, 2, 3, 4, *two],
    }  # fmt: skip
    assert {name: mesh.cell_numbers[g.cells].tolist() for name, g in mesh.groups.items() if len(g.cells)} == {
        "One.Cells": [25], "Two.Cells": [125], "top": [125], "One.Up": [25], "Two.Up": [125], "Whole": [25],
    }  # fmt: skip
    (facet,) = mesh.groups["Whole"].facets
    assert set(numbers[mesh.facets[tuple(facet)]].tolist()) == {102, 103}
    attached = mesh.attachments
    assert [int(numbers[mass.node]) for mass in attached.masses] == [3, 103]
    assert [[int(numbers[n]) for n in equation.nodes] for equation in attached.equations[::3]] == [[1, 2], [101, 102]]
    (rigid,) = attached.rigids
    assert (int(numbers[rigid.reference]), numbers[rigid.nodes].tolist()) == (3, two)


def test_a_name_within_an_instance_is_its_own_before_that_of_the_assembly(tmp_path):
    text = PART.partition("*NSET, NSET=first")[0] + "*NSET, NSET=Own\n{}\n*NSET, NSET=within, INSTANCE=Two\n{}\n"
    mesh = read(tmp_path, text.format("first", "own").replace("first", "One.own"))
    assert mesh.node_numbers[mesh.groups["within"].nodes].tolist() == [101, 102, 103, 104]
    assert mesh.node_numbers[mesh.groups["Own"].nodes].tolist() == [1, 2, 3, 4]
    with pytest.raises(cf.errors.ModelError, match=r"a\.inp: line \d+: found no set 'none' above this line"):
        read(tmp_path, text.format("One.own", "none"))
