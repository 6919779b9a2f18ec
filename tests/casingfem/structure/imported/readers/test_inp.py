"""Abaqus input files: sets, surfaces, elements and ties by their words; each refusal with its line."""

import re

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.inp import FAMILIES, read_inp, stacked

PLACES = ["0, 0, 0", "1, 0, 0", "1, 1, 0", "0, 1, 0", "0, 0, 1", "1, 0, 1", "1, 1, 1", "0, 1, 1", "2, 0, 0", "2, 1, 0"]
NODE = "*NODE\n" + "".join(f"{10 + k}, {place}\n" for k, place in enumerate(PLACES))
SHELLS = f"{NODE}*ELEMENT, TYPE=S4, ELSET=All\n31, 10, 11, 12, 13\n32, 11, 18, 19, 12\n"
BRICK = f"{NODE}*ELEMENT, TYPE=C3D8, ELSET=All\n31, 10, 11, 12, 13, 14, 15, 16, 17\n"


def read(folder, text):
    (folder / "a.inp").write_text(text)
    return read_inp(folder / "a.inp")


def sets(draft):
    return {name: draft.node_numbers[nodes].tolist() for name, nodes in draft.node_sets.items()}


def cell_sets(draft):
    return {
        name: [(draft.blocks[k].numbers[rows]).tolist() for k, rows in parts] for name, parts in draft.cell_sets.items()
    }


def facets(draft, name):
    return draft.node_numbers[draft.facet_sets[name]].tolist()


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("ending", ["", "R", "E"])
def test_types_of_elements_take_as_many_nodes_as_they_have(family, ending, tmp_path):
    """Written over two lines, so that the count tells where an element ends."""
    kind = FAMILIES[family]
    count = {"STRI65": 6, "B31": 2, "B32": 3}.get(family) or int(re.search(r"\d+$", family)[0])
    row = [str(10 + k % 10) for k in range(count)]
    text = f"{NODE}*ELEMENT, TYPE={family.lower()}{ending}\n31, {row[0]},\n{', '.join(row[1:])}\n"
    if family.startswith("B3"):
        with pytest.warns(cf.errors.ModelWarning, match=rf"a.inp: \*ELEMENT of type {family}{ending} \(line 12\)"):
            draft = read(tmp_path, text)
    else:
        draft = read(tmp_path, text)
    (block,) = draft.blocks
    assert (block.kind, block.numbers.tolist()) == (kind, [31])
    assert draft.node_numbers[block.cells].tolist() == [[int(node) for node in row]]


@pytest.mark.parametrize("name", ["C3D", "C3D80", "S40", "XS4", ""])
def test_types_that_nobody_knows_are_refused(name, tmp_path):
    with pytest.raises(
        cf.errors.ModelError, match=rf"a.inp: line 12: \*ELEMENT of type '{name}'.*mesh-unsupported-cell"
    ):
        read(tmp_path, f"{NODE}*ELEMENT, TYPE={name}\n31, 10, 11, 12, 13\n")


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("31, 10, 11, 12, 13, 14\n", "line 13: found 6 numbers, expected 5 an element"),
        ("31, 10, 11\n12, 13, 32\n", "line 14: found 6 numbers, expected 5 an element"),
        ("31, 10, 11, 12, 13\n32, 10, 11, 12\n", r"line 12: \*ELEMENT S4: 9 numbers, expected 5 an element"),
    ],
)
def test_elements_of_other_than_their_nodes_are_refused(rows, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        read(tmp_path, f"{NODE}*ELEMENT, TYPE=S4\n{rows}")


def test_numbers_go_up_to_fifteen_digits(tmp_path):
    most = 10**15 - 1
    draft = read(tmp_path, f"*NODE, NSET=n\n{most}, 1., -9e14, 3.\n*ELEMENT, TYPE=T3D2\n{most}, {most}, {most}\n")
    assert (draft.node_numbers.tolist(), draft.points.tolist()) == ([most], [[1.0, -9e14, 3.0]])
    for text in (f"*NODE\n{10**15}, 1., 2., 3.\n", "*NODE\n1, 1., 2., -1e15\n", "*NODE\n1, 1., nan, 1.\n"):
        with pytest.raises(cf.errors.ModelError, match=r"line 2: found '.*', expected numbers below 1e\+15"):
            read(tmp_path, text)


def test_sets_of_numbers_ranges_and_sets(tmp_path):
    text = f"""{SHELLS}*NSET, NSET=one
10, 12,
*NSET, NSET=Two, GENERATE
11, 17, 3
13, 14
*NSET, NSET=ONE
two, 19
*NSET, NSET=none, GENERATE
14, 13
*ELSET, ELSET=both
32
all
*NODE, NSET=one
99, 0., 0., 9.
"""
    draft = read(tmp_path, text)
    assert sets(draft) == {"one": [10, 12, 11, 14, 17, 13, 14, 19, 99], "Two": [11, 14, 17, 13, 14], "none": []}
    assert cell_sets(draft) == {"All": [[31, 32]], "both": [[32, 31, 32]]}


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("*NSET, NSET=a, GENERATE\n10\n", "line 16: found '10', expected first, last, step"),
        ("*NSET, NSET=a, GENERATE\n10, 12, 0\n", "line 16: found '10, 12, 0', expected first, last, step"),
        ("*NSET, NSET=a, GENERATE\n10, x\n", "line 16: found '10, x', expected first, last, step"),
        (f"*NSET, NSET=a, GENERATE\n{10**15}, 3\n", r"line 16: found '10+, 3', expected numbers below 1e\+15"),
        (f"*NSET, NSET=a, GENERATE\n-{10**15}, 3\n", r"line 16: found '-10+, 3', expected numbers below 1e\+15"),
        (f"*NSET, NSET=a, GENERATE\n3, {10**15}, {10**14}\n", r"line 16: found '3, 10+, 10+', expected numbers below"),
        ("*NSET, NSET=a\n10, b\n", "line 16: no set 'b' up to here"),
        ("*NSET, NSET=a\nall\n", "line 16: no set 'all' up to here"),
        ("*ELSET, NSET=a\n31\n", r"line 15: \*ELSET without a name"),
        ("*NODE\n20.5, 1., 2., 3.\n", "line 16: found the node 20.5, expected a whole number"),
        ("*NODE\n20, 1., 2., 3., 4.\n", "line 16: found '20, 1., 2., 3., 4.', expected a node number and x, y, z"),
        ("*NODE\n20, 1., 2., x\n", "line 16: found '20, 1., 2., x', expected numbers"),
        ("*SURFACE, NAME=s\n31\n", "line 16: found '31', expected an element or set and a face such as S1"),
        ("*SURFACE, NAME=s\n31,\n", "line 16: found '31,', expected an element or set and a face such as S1"),
        ("*SURFACE, NAME=s\n", r"line 15: \*SURFACE s: found nothing that belongs to it"),
        ("*SYSTEM\n", r"line 15: \*SYSTEM refers to a local coordinate system, expected a flat mesh"),
        ("*NCOPY\n", r"line 15: \*NCOPY refers to nodes or elements that are not written out, expected a flat mesh"),
        ("*TIE, NAME=t\ns\n", r"line 16: \*TIE: found 's', expected two surfaces"),
        ("*TIE, NAME=t\ns, t\n", r"line 16: \*TIE: no surface 's'"),
        ("*SURFACE, NAME=s\nall, SPOS\n*TIE, NAME=t\ns, t\n", r"line 18: \*TIE: no surface 't'"),
        (
            "*SURFACE, NAME=s\nall, SPOS\n*SURFACE, NAME=n, TYPE=NODE\n10\n*TIE, NAME=t\ns, n\n",
            r"line 20: \*TIE: found the surface 'n' of nodes, expected one of faces",
        ),
        (
            "*SURFACE, NAME=s\nall, SPOS\n*TIE, NAME=t, POSITION TOLERANCE=x\ns, s\n",
            "line 17: found 'x', expected a number",
        ),
    ],
)
def test_what_is_not_understood_is_refused_with_its_line(card, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.inp: {told}"):
        read(tmp_path, SHELLS + card)


def test_a_range_has_no_more_numbers_than_the_text_has_characters(tmp_path):
    text = f"{SHELLS}*NSET, NSET=a, GENERATE\n"
    size = len(text) + len("10,999\n")
    whole = f"{text}10,{10 + size - 1}\n"
    assert len(whole) == size
    with pytest.raises(cf.errors.ModelError, match=r"node \d+ is named but not given"):  # read, and then looked for
        read(tmp_path, whole)
    with pytest.raises(
        cf.errors.ModelError, match=f"line 16: found '10,{10 + size}', {size + 1} numbers, more than the file can"
    ):
        read(tmp_path, f"{text}10,{10 + size}\n")


def test_surfaces_of_bricks_and_shells(tmp_path):
    text = f"{BRICK}*SURFACE, NAME=Six\nALL, s2\n31, S4\n*SURFACE, NAME=six, TYPE=ELEMENT\n31, S6\n"
    text += "*SURFACE, NAME=o, TYPE=CUTTING\nx\n"
    draft = read(tmp_path, text)
    assert [sorted(face) for face in facets(draft, "Six")] == [[14, 15, 16, 17], [11, 12, 15, 16], [10, 13, 14, 17]]
    draft = read(tmp_path, f"{SHELLS}*SURFACE, NAME=s\nall, SPOS\n32, E2\n31, SNEG\n*SURFACE, NAME=e\n31, S3\n")
    assert cell_sets(draft) == {"All": [[31, 32]], "s": [[31, 32], [31]]}
    assert facets(draft, "s") == [[18, 19]]
    assert facets(draft, "e") == [[10, 11]]


def test_a_surface_may_be_called_as_a_set_of_elements(tmp_path):
    draft = read(tmp_path, f"{SHELLS}*SURFACE, NAME=all\n32, SPOS\n")
    assert cell_sets(draft) == {"All": [[31, 32], [32]]}


def test_numbered_faces_of_elements_in_a_plane_are_edges_and_of_others_sides(tmp_path):
    text = SHELLS.replace("S4", "CPS4") + "*ELEMENT, TYPE=S4, ELSET=Skin\n33, 10, 11, 15, 14\n"
    draft = read(tmp_path, f"{text}*SURFACE, NAME=p\nall, S1\n*SURFACE, NAME=s\nskin, S1\n")
    assert facets(draft, "p") == [[10, 11], [11, 18]]
    assert cell_sets(draft)["s"] == [[33]]
    assert "s" not in draft.facet_sets


def test_triangles_beside_squares_have_their_last_corner_twice():
    found = stacked([np.array([[1, 2, 3]]), np.array([[4, 5, 6, 7]]), np.array([[8, 9, 10]])])
    assert found.tolist() == [[1, 2, 3, 3], [4, 5, 6, 7], [8, 9, 10, 10]]
    assert stacked([np.array([[1, 2, 3]])]).tolist() == [[1, 2, 3]]


def test_ties_name_their_surfaces_as_they_are_written(tmp_path):
    text = f"""{SHELLS}*SURFACE, NAME=Master
31, SPOS
*SURFACE, NAME=Nodes, TYPE=NODE
12, x
All2
*TIE, NAME=t
nodes, MASTER,
*TIE, NAME=u, POSITION TOLERANCE=2.5e-3
master, Master
""".replace("*SURFACE, NAME=Nodes", "*NSET, NSET=All2\n18, 19\n*SURFACE, NAME=Nodes")
    draft = read(tmp_path, text)
    assert [(g.follower, g.master, g.tolerance, g.where) for g in draft.gluings] == [
        ("Nodes", "Master", None, "*TIE (line 23)"), ("Master", "Master", 2.5e-3, "*TIE (line 25)")
    ]  # fmt: skip
    assert sets(draft) == {"All2": [18, 19], "Nodes": [12, 18, 19]}


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("*TIE, NAME=t, CYCLIC SYMMETRY\nx, y\n", r"\*TIE of cyclic symmetry \(line 15\)"),
        ("*TIE, NAME=t, MULTISTAGE\nx, y\n", r"\*TIE of multistage \(line 15\)"),
        ("*SHELL SECTION, ELSET=all, OFFSET=SPOS\n", r"\*SHELL SECTION \(line 15\)"),
        ("*EMBEDDED ELEMENT\n*MATRIX INPUT\n", r"\*EMBEDDED ELEMENT \(line 15\), \*MATRIX INPUT \(line 16\)"),
        ("*TRANSFORM, NSET=x\n1.,0.,0.,0.,1.,0.\n", r"\*TRANSFORM \(line 15\)"),
    ],
)
def test_what_is_left_out_is_said_with_its_line(card, told, tmp_path):
    with pytest.warns(cf.errors.ModelWarning, match=rf"a\.inp: {told}: .*mesh-left-out"):
        read(tmp_path, SHELLS + card)


def test_sections_without_offset_and_materials_are_passed_over(tmp_path):
    draft = read(tmp_path, f"{SHELLS}*SHELL SECTION, ELSET=all\n1.\n*MATERIAL, NAME=m\n*ELASTIC\n1., .3\n*STEP\n")
    assert cell_sets(draft) == {"All": [[31, 32]]}


@pytest.mark.parametrize(
    ("text", "told"),
    [(NODE, "10 nodes and no elements"), ("*ELEMENT, TYPE=S4\n31, 1, 2, 3, 4\n", "0 nodes and no elements"),
     (f"{NODE}*ELEMENT, TYPE=S4\n", "10 nodes and no elements")],
)  # fmt: skip
def test_files_without_nodes_or_elements_are_refused(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.inp: found {told}: .*mesh-no-cells"):
        read(tmp_path, text)


def test_a_number_is_that_of_one_element(tmp_path):
    with pytest.raises(cf.errors.ModelError, match="element 31 is given twice"):
        read(tmp_path, SHELLS.replace("\n32,", "\n31,"))
    more = "*ELEMENT, TYPE=S3, ELSET=t\n31, 10, 11, 12\n"
    with pytest.raises(cf.errors.ModelError, match="element 31 is given twice"):
        read(tmp_path, SHELLS + more)
    draft = read(tmp_path, SHELLS + more.replace("31,", "33,") + "*ELSET, ELSET=mixed\n33, 32\n")
    assert cell_sets(draft) == {"All": [[31, 32]], "t": [[33]], "mixed": [[32], [33]]}
