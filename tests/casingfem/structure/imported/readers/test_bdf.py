"""Grids, elements and constraints of Nastran's bulk data: which field is what, groups by set, what is refused."""

import re

import numpy as np
import pytest

import casingfem as cf

TETRA = """GRID,11,,0.,0.,0.
GRID,12,,1.,0.,0.
GRID,13,,0.,1.,0.
GRID,14,,0.,0.,1.
GRID,15,,2.,2.,2.
CTETRA,7,5,11,12,13,14
"""


def read(folder, text):
    (folder / "a.bdf").write_text(text + "ENDDATA\n")
    return cf.read_mesh(folder / "a.bdf")


def members(mesh):
    groups = {name: group for name, group in mesh.groups.items() if name.startswith("SPC")}
    return {name: mesh.node_numbers[group.nodes].tolist() for name, group in groups.items()}


def lines(card):
    """A card of free fields, eight of them a line behind its name."""
    fields = card.split(",")
    return ",".join(fields[:9]) + "".join("\n," + ",".join(fields[k : k + 8]) for k in range(9, len(fields), 8)) + "\n"


def edge(*corners):
    return np.array(corners, dtype=float).mean(axis=0)


CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
PRISM = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
PYRAMID = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
# middle nodes by the corners G1, G2, ... that they are between, as the Quick Reference Guide draws them
MIDDLES = {
    "CTETRA": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], ["12", "23", "31", "14", "24", "34"], "tetra10"),
    "CHEXA": (CUBE, ["12", "23", "34", "41", "15", "26", "37", "48", "56", "67", "78", "85"], "hexahedron20"),
    "CPENTA": (PRISM, ["12", "23", "31", "14", "25", "36", "45", "56", "64"], "wedge15"),
    "CPYRAM": (PYRAMID, ["12", "23", "34", "41", "15", "25", "35", "45"], "pyramid13"),
    "CQUAD8": ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], ["12", "23", "34", "41"], "quad8"),
    "CTRIA6": ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], ["12", "23", "31"], "triangle6"),
}
VOLUMES = {"CTETRA": 1 / 6, "CHEXA": 1.0, "CPENTA": 1 / 2, "CPYRAM": 1 / 3}
READ_AS = {"wedge15": "hexahedron20", "pyramid13": "hexahedron20", "triangle6": "quad8"}  # with some edges collapsed
LINEAR = {"wedge": "hexahedron", "pyramid": "hexahedron", "triangle": "quad"}


@pytest.mark.parametrize("left_handed", [False, True])
@pytest.mark.parametrize("name", MIDDLES)
def test_nodes_of_quadratic_elements_are_where_the_guide_draws_them(name, left_handed, tmp_path):
    corners, pairs, kind = MIDDLES[name]
    x = np.array(corners, dtype=float)
    x = np.vstack([x, [edge(*(corners[int(k) - 1] for k in pair)) for pair in pairs]])
    if left_handed:
        x[:, 0] *= -1.0
    grids = "".join(f"GRID,{k},,{p},{q},{r}\n" for k, (p, q, r) in enumerate(x.tolist(), 1))
    mesh = read(tmp_path, grids + lines(f"{name},3,4," + ",".join(str(k) for k in range(1, len(x) + 1))))
    assert mesh.kind == READ_AS.get(kind, kind)
    found = x[mesh.cells[0]]
    stands = mesh.cell_kind.supports_of_nodes
    np.testing.assert_array_equal(found, [found[list(nodes)].mean(axis=0) for nodes in stands])
    assert set(mesh.cells[0].tolist()) == set(range(len(x)))
    if name in VOLUMES:  # right-handed, which Nastran does not ask for
        system = cf.Solid(mesh=mesh, material=cf.Material(E=210e9, nu=0.3, rho=7800.0)).assembled()
        assert system.M.sum() == pytest.approx(3 * 7800.0 * VOLUMES[name], rel=1e-12)


@pytest.mark.parametrize("name", MIDDLES)
def test_an_element_without_middles_is_linear_and_single_ones_may_lack(name, tmp_path):
    """The middle that is given stands off its edge, which shows on which it is; others are half way."""
    corners, pairs, kind = MIDDLES[name]
    count = len(corners)
    x = np.vstack([corners, [edge(*(corners[int(k) - 1] for k in pair)) for pair in pairs]])
    x[count:] += 0.01
    grids = "".join(f"GRID,{k},,{p},{q},{r}\n" for k, (p, q, r) in enumerate(x.tolist(), 1))
    given = ",".join(str(k) for k in range(1, count + 1))
    linear = kind.rstrip("0123456789")
    for tail in ("", ",0", ",0" * len(pairs)):
        mesh = read(tmp_path, grids + lines(f"{name},3,4,{given}{tail}"))
        assert (mesh.kind, set(mesh.cells[0].tolist())) == (LINEAR.get(linear, linear), set(range(count)))
    for k in (0, 1, len(pairs) - 1):
        mesh = read(tmp_path, grids + lines(f"{name},3,4,{given}" + ",0" * k + f",{count + k + 1}"))
        assert mesh.kind == READ_AS.get(kind, kind)
        found, stands = mesh.points[mesh.cells[0]], mesh.cell_kind.supports_of_nodes
        off = [s for s, on in enumerate(stands) if np.abs(found[s] - found[list(on)].mean(axis=0)).max() > 1e-6]
        (edges,) = {frozenset(mesh.cells[0, list(stands[s])].tolist()) for s in off}
        assert edges == {int(digit) - 1 for digit in pairs[k]}
        assert (mesh.node_numbers == 0).sum() == len(pairs) - 1


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("CTETRA,7,5,11,12,13", "found element 7 with 3 nodes, expected 4 corners, then middle"),
        ("CTETRA,7,5,11,,13,14", "found element 7 with 3 nodes, expected 4 corners, then middle"),
        ("CTETRA,7,5,11,0,13,14", "found element 7 with 3 nodes, expected 4 corners, then middle"),
        ("CTETRA,7,5,11,12,13,14,11,12,13,14,11,12,15", "found element 7 with 11 nodes, expected 4 corners"),
        ("CTRIA3,7,5,11,12", "found element 7 with 2 nodes, expected 3 corners"),
        ("CQUAD4,7,5,11,12,13", "found element 7 with 3 nodes, expected 4 corners"),
        ("CTETRA,7", "found 1 fields, expected a number, a property and nodes"),
        ("CTETRA,7,5", "found 2 fields, expected a number, a property and nodes"),
    ],
)
def test_elements_without_their_corners_are_refused(card, told, tmp_path):
    name = card.partition(",")[0]
    with pytest.raises(cf.errors.ModelError, match=f"line 7: {name}: {told}"):
        read(tmp_path, TETRA + lines(card))


def test_blanks_and_zeros_beyond_the_nodes_of_an_element_are_none(tmp_path):
    assert read(tmp_path, TETRA.replace("11,12,13,14\n", "11,12,13,14,,,\n,,,,0,\n")).kind == "tetra"


def test_elements_are_groups_by_their_property_which_is_their_number_where_it_is_blank(tmp_path):
    more = "CTETRA,9,,11,12,13,15\nCTETRA,8,5,11,12,14,15\nCTRIA3,3,5,11,12,13\n"
    mesh = read(tmp_path, TETRA + more)
    assert (mesh.kind, mesh.cell_numbers.tolist()) == ("tetra", [7, 9, 8])
    assert {name: group.cells.tolist() for name, group in mesh.groups.items()} == {"PID 5": [0, 2], "PID 9": [1]}
    assert len(mesh.groups["PID 5"].facets) == 1
    with pytest.raises(cf.errors.ModelError, match="element 7 twice"):
        read(tmp_path, TETRA + "CTRIA3,7,5,11,12,13\n")


@pytest.mark.parametrize(("field", "count"), [("CQUAD4", 4), ("CQUADR", 4), ("CTRIA3", 3), ("CTRIAR", 3)])
def test_an_offset_of_zero_is_none(field, count, tmp_path):
    grids, nodes = TETRA.partition("CTETRA")[0], ",".join(str(11 + k) for k in range(count))
    other = "CQUAD4,9,5,12,13,14,15\n"
    assert len(read(tmp_path, grids + other + lines(f"{field},3,5,{nodes},30.,0.")).cells) == 2
    with pytest.warns(cf.errors.ModelWarning, match=rf"1 offset \(ZOFFS\) of {field} \(from line 7\)"):
        read(tmp_path, grids + other + lines(f"{field},3,5,{nodes},30.,-1.-9"))


def test_the_field_of_an_offset_is_no_offset_of_a_solid(tmp_path):
    """Elements of quadratic solids have nodes in all these fields."""
    x = np.array(CUBE, dtype=float)
    grids = "".join(f"GRID,{k},,{p},{q},{r}\n" for k, (p, q, r) in enumerate(x.tolist(), 1))
    assert read(tmp_path, grids + lines("CHEXA,3,4,1,2,3,4,5,6,7,8")).cells.tolist() == [list(range(8))]


@pytest.mark.parametrize(
    ("cards", "groups"),
    [
        ("SPC,3,12,135,0.,14,2,0.", {"SPC 3 135": [12], "SPC 3 2": [14], "SPC 3": [12, 14]}),
        ("SPC,3,12,135", {"SPC 3 135": [12], "SPC 3": [12]}),
        ("SPC,3,,,,14,2", {"SPC 3 2": [14], "SPC 3": [14]}),
        ("SPC1,3,135,12,,14", {"SPC 3 135": [12, 14], "SPC 3": [12, 14]}),
        ("SPC1,3,135,12,THRU,14", {"SPC 3 135": [12, 13, 14], "SPC 3": [12, 13, 14]}),
        ("SPC1,3,135,12,thru,99", {"SPC 3 135": [12, 13, 14, 15], "SPC 3": [12, 13, 14, 15]}),
        ("SPC1,3,135,1,THRU,11", {"SPC 3 135": [11], "SPC 3": [11]}),
        ("SPC1,3,1,12\nSPC1,4,1,13\nSPC1,33,1,14\nSPCADD,9,4,3",
         {"SPC 3 1": [12], "SPC 3": [12], "SPC 4 1": [13], "SPC 4": [13], "SPC 33 1": [14], "SPC 33": [14],
          "SPC 9 1": [12, 13], "SPC 9": [12, 13]}),
    ],
)  # fmt: skip
def test_grids_that_are_fixed_are_groups_by_set_and_components(cards, groups, tmp_path):
    assert members(read(tmp_path, f"{TETRA}{cards}\n")) == groups


@pytest.mark.parametrize("components", ["12", "1", "1234"])
def test_single_components_in_a_grids_own_system_are_groups_of_their_own(components, tmp_path):
    text = TETRA.replace("GRID,12,,1.,0.,0.", "GRID,12,,1.,0.,0.,6").replace("GRID,13,,0.,1.,0.", "GRID,13,,0.,1.,0.,0")
    groups = members(read(tmp_path, f"{text}SPC1,3,{components},12,13\n"))
    assert groups == {f"SPC 3 {components} CD 6": [12], f"SPC 3 {components}": [13], "SPC 3": [12, 13]}


@pytest.mark.parametrize("components", ["123", "456", "123456", "321"])
def test_all_displacements_or_turns_are_the_same_in_every_system(components, tmp_path):
    text = TETRA.replace("GRID,12,,1.,0.,0.", "GRID,12,,1.,0.,0.,6")
    assert members(read(tmp_path, f"{text}SPC1,3,{components},12,13\n")) == {
        f"SPC 3 {components}": [12, 13],
        "SPC 3": [12, 13],
    }


@pytest.mark.parametrize(
    ("card", "found"),
    [
        ("SPC1,3,1", "3, 1"),
        ("SPC1,,1,12", ", 1, 12"),
        ("SPC1,3,,12", "3, , 12"),
        ("SPC,,12,1", ", 12, 1"),
        ("SPC", "none"),
    ],
)
def test_constraints_that_lack_a_field_are_refused(card, found, tmp_path):
    name = card.partition(",")[0]
    with pytest.raises(
        cf.errors.ModelError,
        match=f"line 7: {name}: found the fields {found}, expected the number of a set, components and grids",
    ):
        read(tmp_path, f"{TETRA}{card}\n")


def test_a_grid_has_a_field_for_each_fact_and_grdset_those_it_leaves_blank(tmp_path):
    """Set 7 as the system of the place and 8 as that of the motions, constraints 45; a 0 is not blank."""
    text = TETRA + "CORD2R,7,,1.,2.,3.,1.,2.,4.,+\n+,2.,2.,3.\nCORD2R,8,,0.,0.,0.,0.,0.,1.,+\n+,1.\n"
    text = text.replace("GRID,12,,1.,0.,0.", "GRID,12,0,1.,0.,0.,0,6")
    plain = read(tmp_path, text)
    assert members(plain) == {"SPC PS 6": [12], "SPC PS": [12]}
    assert plain.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 2, 2]]
    found = read(tmp_path, text + "grdset,,7,,,,8,45\n")
    np.testing.assert_allclose(found.points, [[1, 2, 3], [1, 0, 0], [1, 3, 3], [1, 2, 4], [3, 4, 5]], atol=1e-12)
    assert members(found) == {
        "SPC PS 45 CD 8": [11, 13, 14, 15], "SPC PS": [11, 12, 13, 14, 15], "SPC PS 6": [12]
    }  # fmt: skip


def test_a_grid_in_one_line_of_large_fields_ends_before_z(tmp_path):
    with pytest.raises(
        cf.errors.ModelError, match="line 7: GRID: found grid 16 without z, expected it on a second line"
    ):
        read(tmp_path, TETRA + "GRID*,16,,1.,2.\n")
    assert read(tmp_path, TETRA + "GRID*,16,,1.,2.\n*,3.\n").points[5].tolist() == [1.0, 2.0, 3.0]
    assert read(tmp_path, TETRA + "GRID,16,,1.,2.\n").points[5].tolist() == [1.0, 2.0, 0.0]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("CTETRA,7,5,11,12,13,14\n", "0 grids and no elements"),
        (TETRA.partition("CTETRA")[0], "5 grids and no elements"),
    ],
)
def test_files_without_grids_or_elements_are_refused(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.bdf: found {re.escape(told)}; .*mesh-no-cells"):
        read(tmp_path, text)


def test_cards_that_are_left_out_are_counted_from_their_first_line(tmp_path):
    with pytest.warns(
        cf.errors.ModelWarning, match=r"a\.bdf: 2 CGAP \(from line 7\), 1 RROD \(from line 8\); .*mesh-left-out"
    ):
        read(tmp_path, TETRA + "CGAP,1\nRROD,3\nCGAP,2\nCORD3G,3\nCSET,1\nMAT1,1\nPARAM,POST,-1\n")
