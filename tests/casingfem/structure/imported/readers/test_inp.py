"""Abaqus input files: sets, surfaces, elements and ties by their words; each refusal with its line."""

import re
import warnings

import numpy as np
import pytest

import casingfem as cf

PLACES = ["0, 0, 0", "1, 0, 0", "1, 1, 0", "0, 1, 0", "0, 0, 1", "1, 0, 1", "1, 1, 1", "0, 1, 1", "2, 0, 0", "2, 1, 0"]
NODE = "*NODE\n" + "".join(f"{10 + k}, {place}\n" for k, place in enumerate(PLACES))
SHELLS = f"{NODE}*ELEMENT, TYPE=S4, ELSET=All\n31, 10, 11, 12, 13\n32, 11, 18, 19, 12\n"
BRICK = f"{NODE}*ELEMENT, TYPE=C3D8, ELSET=All\n31, 10, 11, 12, 13, 14, 15, 16, 17\n"


def read(folder, text):
    (folder / "a.inp").write_text(text)
    return cf.read_mesh(folder / "a.inp")


def sets(mesh):
    """Node numbers of the groups without cells."""
    groups = {name: group for name, group in mesh.groups.items() if not len(group.cells) and group.facets is None}
    return {name: mesh.node_numbers[group.nodes].tolist() for name, group in groups.items()}


def cell_sets(mesh):
    return {name: mesh.cell_numbers[group.cells].tolist() for name, group in mesh.groups.items() if len(group.cells)}


def facets(mesh, name):
    return [sorted(mesh.node_numbers[mesh.facets[tuple(facet)]].tolist()) for facet in mesh.groups[name].facets]


SOLIDS = {"C3D4": "tetra", "C3D10": "tetra10", "C3D8": "hexahedron", "C3D20": "hexahedron20", "C3D6": "hexahedron",
          "C3D15": "hexahedron20"}  # fmt: skip
SURFACES = {
    **dict.fromkeys(["S4", "S3", "CPS3", "CPS4", "CPE3", "CPE4", "M3D3", "M3D4", "SFM3D3", "SFM3D4"], "quad"),
    **dict.fromkeys(
        ["S8", "S6", "STRI65", "CPS6", "CPS8", "CPE6", "CPE8", "M3D6", "M3D8", "SFM3D6", "SFM3D8"], "quad8"
    ),
    **dict.fromkeys(["S9", "M3D9"], "quad9"),
}
LINES = {"T3D2": 2, "T3D3": 3, "B31": 2, "B32": 3}


def one_element(family, count):
    """Over two lines, so that the count tells where an element ends."""
    row = [str(1 + k) for k in range(count)]
    nodes = "".join(f"{node}, {np.cos(k)}, {np.sin(2 * k)}, {0.1 * k}\n" for k, node in enumerate(row))
    return f"*NODE\n{nodes}*ELEMENT, TYPE={family}\n31, {row[0]},\n{', '.join(row[1:])}\n"


@pytest.mark.parametrize("family", [*SOLIDS, *SURFACES])
@pytest.mark.parametrize("ending", ["", "R", "E"])
def test_types_of_elements_take_as_many_nodes_as_they_have(family, ending, tmp_path):
    count = {"STRI65": 6}.get(family) or int(re.search(r"\d+$", family)[0])
    mesh = read(tmp_path, one_element(family.lower() + ending, count))
    assert (mesh.kind, mesh.cell_numbers.tolist()) == ((SOLIDS | SURFACES)[family], [31])
    assert set(mesh.cells[0].tolist()) == set(range(count))
    with pytest.raises(cf.errors.ModelError, match=f"found an element of {count + 2} numbers, expected {count + 1}"):
        read(tmp_path, one_element(family + ending, count + 1))


@pytest.mark.parametrize("family", LINES)
def test_lines_alone_are_no_mesh_and_beams_are_left_out(family, tmp_path):
    found = "1 line" + "3" * (LINES[family] == 3)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with pytest.raises(cf.errors.ModelError, match=f"found {found}; .*mesh-no-cells"):
            read(tmp_path, one_element(family, LINES[family]))
    assert [f"*ELEMENT of type {family}" in str(w.message) for w in caught] == [True] * family.startswith("B")


@pytest.mark.parametrize("name", ["C3D", "C3D80", "S40", "XS4", ""])
def test_types_that_nobody_knows_are_refused(name, tmp_path):
    with pytest.raises(
        cf.errors.ModelError, match=rf"a\.inp: line 12: found \*ELEMENT of type '{name}'.*mesh-unsupported-cell"
    ):
        read(tmp_path, f"{NODE}*ELEMENT, TYPE={name}\n31, 10, 11, 12, 13\n")


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("31, 10, 11, 12, 13, 14\n", "line 13: found an element of 6 numbers, expected 5"),
        ("31, 10, 11\n12, 13, 32\n", "line 14: found an element of 6 numbers, expected 5"),
        (
            "31, 10, 11, 12, 13\n32, 10, 11, 12\n",
            r"line 12: \*ELEMENT S4: found 9 numbers, expected a multiple of 5: element",
        ),
    ],
)
def test_elements_of_other_than_their_nodes_are_refused(rows, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        read(tmp_path, f"{NODE}*ELEMENT, TYPE=S4\n{rows}")


def test_numbers_go_up_to_fifteen_digits(tmp_path):
    most = 10**15 - 1
    mesh = read(tmp_path, NODE + f"{most}, 1., -9e14, 3.\n*ELEMENT, TYPE=S3\n{most}, 10, 11, {most}\n")
    assert (mesh.node_numbers[-1], mesh.points[-1].tolist()) == (most, [1.0, -9e14, 3.0])
    assert mesh.cell_numbers.tolist() == [most]
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
    mesh = read(tmp_path, text)
    assert sets(mesh) == {"one": [10, 11, 12, 13, 14, 17, 19, 99], "Two": [11, 13, 14, 17], "none": []}
    assert cell_sets(mesh) == {"All": [31, 32], "both": [31, 32]}


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("*NSET, NSET=a, GENERATE\n10\n", "line 16: found '10', expected first, last, step"),
        ("*NSET, NSET=a, GENERATE\n10, 12, 0\n", "line 16: found '10, 12, 0', expected first, last, step"),
        ("*NSET, NSET=a, GENERATE\n10, x\n", "line 16: found '10, x', expected first, last, step"),
        (f"*NSET, NSET=a, GENERATE\n{10**15}, 3\n", r"line 16: found '10+, 3', expected numbers below 1e\+15"),
        (f"*NSET, NSET=a, GENERATE\n-{10**15}, 3\n", r"line 16: found '-10+, 3', expected numbers below 1e\+15"),
        (f"*NSET, NSET=a, GENERATE\n3, {10**15}, {10**14}\n", r"line 16: found '3, 10+, 10+', expected numbers below"),
        ("*NSET, NSET=a\n10, b\n", "line 16: found no set 'b' above"),
        ("*NSET, NSET=a\nall\n", "line 16: found no set 'all' above"),
        ("*ELSET, NSET=a\n31\n", r"line 15: found \*ELSET without a name"),
        ("*NODE\n20.5, 1., 2., 3.\n", "line 16: found the node 20.5, expected a whole number"),
        ("*NODE\n20, 1., 2., 3., 4.\n", "line 16: found '20, 1., 2., 3., 4.', expected a node number and x, y, z"),
        ("*NODE\n20, 1., 2., x\n", "line 16: found '20, 1., 2., x', expected numbers"),
        ("*SURFACE, NAME=s\n31\n", "line 16: found '31', expected an element or set and a face such as S1"),
        ("*SURFACE, NAME=s\n31,\n", "line 16: found '31,', expected an element or set and a face such as S1"),
        ("*SURFACE, NAME=s\n", r"line 15: \*SURFACE s: found no"),
        ("*SYSTEM\n", r"line 15: found \*SYSTEM, a local coordinate system, expected nodes and elements written out"),
        ("*NCOPY\n", r"line 15: found \*NCOPY, nodes or elements that the solver generates"),
        ("*TIE, NAME=t\ns\n", r"line 16: \*TIE: found 's', expected two surfaces"),
        ("*TIE, NAME=t\ns, t\n", r"line 16: \*TIE: found no surface 's'"),
        ("*SURFACE, NAME=s\nall, SPOS\n*TIE, NAME=t\ns, t\n", r"line 18: \*TIE: found no surface 't'"),
        (
            "*SURFACE, NAME=s\nall, SPOS\n*SURFACE, NAME=n, TYPE=NODE\n10\n*TIE, NAME=t\ns, n\n",
            r"line 20: \*TIE: found the surface 'n' of nodes, expected one of element faces",
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
    with pytest.raises(cf.errors.ModelError, match=r"node \d+, although it is used"):  # read, and then searched for
        read(tmp_path, whole)
    with pytest.raises(
        cf.errors.ModelError, match=f"line 16: found '10,{10 + size}', {size + 1} numbers, more than the file can"
    ):
        read(tmp_path, f"{text}10,{10 + size}\n")


def test_surfaces_of_bricks_and_shells(tmp_path):
    text = f"{BRICK}*SURFACE, NAME=Six\nALL, s2\n31, S4\n*SURFACE, NAME=six, TYPE=ELEMENT\n31, S6\n"
    text += "*SURFACE, NAME=o, TYPE=CUTTING\nx\n"
    mesh = read(tmp_path, text)
    assert facets(mesh, "Six") == [[14, 15, 16, 17], [11, 12, 15, 16], [10, 13, 14, 17]]
    mesh = read(tmp_path, f"{SHELLS}*SURFACE, NAME=s\nall, SPOS\n32, E2\n31, SNEG\n*SURFACE, NAME=e\n31, S3\n")
    assert cell_sets(mesh) == {"All": [31, 32], "s": [31, 32]}
    assert facets(mesh, "s") == [[18, 19]]
    assert facets(mesh, "e") == [[10, 11]]


def test_a_surface_may_be_called_as_a_set_of_elements(tmp_path):
    mesh = read(tmp_path, f"{SHELLS}*SURFACE, NAME=all\n32, SPOS\n")
    assert cell_sets(mesh) == {"All": [31, 32]}


def test_numbered_faces_of_elements_in_a_plane_are_edges_and_of_others_sides(tmp_path):
    text = SHELLS.replace("S4", "CPS4") + "*ELEMENT, TYPE=S4, ELSET=Skin\n33, 10, 11, 15, 14\n"
    mesh = read(tmp_path, f"{text}*SURFACE, NAME=p\nall, S1\n*SURFACE, NAME=s\nskin, S1\n")
    assert facets(mesh, "p") == [[10, 11], [11, 18]]
    assert cell_sets(mesh)["s"] == [33]
    assert mesh.groups["s"].facets is None


def test_ties_name_their_surfaces_as_they_are_written(tmp_path):
    """Nodes 40 and 41 lie in the first square, 41 a little above it."""
    text = f"""{SHELLS}*NODE
40, .25, .5, 0.
41, .5, .125, 2.e-3
*SURFACE, NAME=Master
31, SPOS
*NSET, NSET=All2
41
*SURFACE, NAME=Nodes, TYPE=NODE
40, x
All2
*TIE, NAME=t, POSITION TOLERANCE={{tolerance}}
nodes, MASTER,
"""
    mesh = read(tmp_path, text.format(tolerance="2.5e-3"))
    (tie,) = mesh.attachments.glued
    assert mesh.node_numbers[tie.nodes].tolist() == [40, 41]
    followed = np.einsum("nk,nkx->nx", tie.weights, mesh.points[tie.others])
    np.testing.assert_allclose(followed, [[0.25, 0.5, 0.0], [0.5, 0.125, 0.0]], atol=1e-9)
    assert sets(mesh) == {"All2": [41], "Nodes": [40, 41]}
    with pytest.warns(
        cf.errors.ModelWarning, match=r"a\.inp: \*TIE \(line 26\): found 1 node \(41\) of 'Nodes' beyond"
    ):
        read(tmp_path, text.format(tolerance="1.5e-3"))


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
def test_what_is_left_out_is_reported_with_its_line(card, told, tmp_path):
    with pytest.warns(cf.errors.ModelWarning, match=rf"a\.inp: {told}; .*mesh-left-out"):
        read(tmp_path, SHELLS + card)


def test_sections_without_offset_and_materials_are_passed_over(tmp_path):
    mesh = read(tmp_path, f"{SHELLS}*SHELL SECTION, ELSET=all\n1.\n*MATERIAL, NAME=m\n*ELASTIC\n1., .3\n*STEP\n")
    assert cell_sets(mesh) == {"All": [31, 32]}


@pytest.mark.parametrize(
    ("text", "told"),
    [(NODE, "10 nodes and no elements"), ("*ELEMENT, TYPE=S4\n31, 1, 2, 3, 4\n", "0 nodes and no elements"),
     (f"{NODE}*ELEMENT, TYPE=S4\n", "10 nodes and no elements")],
)  # fmt: skip
def test_files_without_nodes_or_elements_are_refused(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.inp: found {told}; .*mesh-no-cells"):
        read(tmp_path, text)


def test_a_number_is_that_of_one_element(tmp_path):
    with pytest.raises(cf.errors.ModelError, match="element 31 twice"):
        read(tmp_path, SHELLS.replace("\n32,", "\n31,"))
    more = "*ELEMENT, TYPE=S3, ELSET=t\n31, 10, 11, 12\n"
    with pytest.raises(cf.errors.ModelError, match="element 31 twice"):
        read(tmp_path, SHELLS + more)
    mesh = read(tmp_path, SHELLS + more.replace("31,", "33,") + "*ELSET, ELSET=mixed\n33, 32\n")
    assert cell_sets(mesh) == {"All": [31, 32], "t": [33], "mixed": [32, 33]}
