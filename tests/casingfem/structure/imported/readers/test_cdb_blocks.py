"""Blocks of Ansys archives line by line, and what an element is by its name and its nodes."""

import warnings

import pytest

import casingfem as cf
from tests.casingfem.structure.imported.archives import BRICK, PART, PLACES, elements_block, nodes_block, read, row


def test_numbers_and_materials_of_an_archive(tmp_path):
    more = [row(5, 7, 310, range(28, 20, -1)), row(4, 8, 305, (21, 22, 23, 24)), row(6, 7, 320, range(21, 29))]
    mesh = read(tmp_path, [*PART[:2], "et,8,SHELL181", *nodes_block(), *elements_block(BRICK, *more)])
    assert mesh.node_numbers.tolist() == list(range(21, 29))
    assert mesh.points.tolist() == [list(map(float, place)) for place in PLACES]
    assert (mesh.kind, mesh.cell_numbers.tolist()) == ("hexahedron", [300, 310, 320])
    assert mesh.cells.tolist() == [list(range(8)), list(range(7, -1, -1)), list(range(8))]
    assert {name: group.cells.tolist() for name, group in mesh.groups.items()} == {
        "MAT 4": [0], "MAT 5": [1], "MAT 6": [2]
    }  # fmt: skip
    (facet, *_) = mesh.groups["MAT 4"].facets  # the shell of material 4
    assert set(mesh.facets[tuple(facet)].tolist()) == {0, 1, 2, 3}


def test_components_name_nodes_and_elements_with_ranges(tmp_path):
    more = ["CMBLOCK,Held  ,NODE,       5  ! a comment", "(3i6)", f"{21:6d}{23:6d}{-25:6d}", f"{27:6d}{-28:6d}"]
    more += ["cmblock,some,elem,       2", "(8i10)", f"{300:10d}{305:10d}"]
    more += ["CMBLOCK,all,ELEMENT,1", "(8i10)", f"{-400:10d}"]
    two = elements_block(BRICK, row(4, 8, 305, (21, 22, 23, 24)))
    mesh = read(tmp_path, [*PART[:2], "ET,8,181", *nodes_block(), *two, *more])
    assert mesh.node_numbers[mesh.groups["Held"].nodes].tolist() == [21, 23, 24, 25, 27, 28]
    for name in ("some", "all"):
        assert (mesh.groups[name].cells.tolist(), len(mesh.groups[name].facets)) == ([0], 1)


def test_a_range_begins_with_one_where_nothing_is_before_it(tmp_path):
    first = [*PART[:2], *nodes_block(1), *elements_block(row(4, 7, 300, range(1, 9)))]
    mesh = read(tmp_path, [*first, "CMBLOCK,a,NODE,1", "(8i10)", f"{-3:10d}"])
    assert mesh.groups["a"].nodes.tolist() == [0, 1, 2]


def test_a_number_of_zero_in_a_component_is_none(tmp_path):
    mesh = read(tmp_path, [*PART, "CMBLOCK,a,NODE,3", "(8i10)", f"{21:10d}{0:10d}{22:10d}"])
    assert mesh.groups["a"].nodes.tolist() == [0, 1]


def test_a_range_has_no_more_numbers_than_the_file_has_characters(tmp_path):
    lines = [*PART, "CMBLOCK,a,NODE,1", "(8i10)"]
    size = sum(map(len, lines)) + 10
    with pytest.raises(cf.errors.ModelError, match=r"node \d+, although it is used"):  # read, and then searched for
        read(tmp_path, [*lines, f"{-size:10d}"])
    with pytest.raises(cf.errors.ModelError, match=f"line 18: found a range up to {size + 1}, expected at most"):
        read(tmp_path, [*lines, f"{-size - 1:10d}"])


@pytest.mark.parametrize("block", range(2))
@pytest.mark.parametrize("by", [-1, 1])
def test_a_block_has_as_many_items_as_it_states(block, by, tmp_path):
    lines = [*PART[:2], *nodes_block(), *elements_block(BRICK, row(4, 7, 301, range(21, 29)))]
    (at,) = [k for k, line in enumerate(lines) if line.startswith(("NBLOCK", "EBLOCK")[block])]
    count = 8 if block == 0 else 2
    lines[at] = lines[at].rpartition(",")[0] + f",{count + by:8d}"
    short = ": cut short" if by > 0 else "; export"
    told = f"line {at + 1}: found {count} items, expected {count + by}{short}"
    with pytest.raises(cf.errors.ModelError, match=told):
        read(tmp_path, lines)


@pytest.mark.parametrize("head", ["NBLOCK", "NBLOCK,6", "NBLOCK,6,SOLID", "NBLOCK,6,SOLID,9,x", "NBLOCK,6,SOLID,0,0"])
def test_blocks_that_state_no_number_may_have_any(head, tmp_path):
    lines = [head if line.startswith("NBLOCK") else line for line in PART]
    assert len(read(tmp_path, lines).points) == 8


@pytest.mark.parametrize(
    "line", ["(0i9)", "(9i0)", "(100i9)", "(9i100)", "(2i9,0i9)", "", "19i9", "(19)", "(19i9) x", "(e21.13)"]
)
def test_blocks_without_columns_or_of_too_many_characters_are_refused(line, tmp_path):
    lines = [line if row == "(19i9)" else row for row in PART]
    with pytest.raises(cf.errors.ModelError, match=r"a\.cdb: line 15: .*expected .*columns.* such as \(19i9\)"):
        read(tmp_path, lines)


def test_a_line_of_nodes_may_end_between_its_columns(tmp_path):
    lines = list(PART)
    at = lines.index("(2i8,6e10.3)") + 1
    lines[at + 1] = lines[at + 1][:26]  # x alone
    lines[at + 2] = lines[at + 2][:8]
    lines[at + 3] = f"{24:8d}{0:8d}{'':10}{2.5:10.3f}"  # x left blank
    lines[at + 4] = f"{25:8d}{0:8d}" + "".join(f"{x:10.3f}" for x in (1, 2, 3, 90, 80, 70))  # with angles
    mesh = read(tmp_path, lines)
    assert mesh.points[1:5].tolist() == [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 2.5, 0.0], [1.0, 2.0, 3.0]]
    lines[at + 1] += " 0.1"
    with pytest.raises(
        cf.errors.ModelError, match=f"line {at + 2}: found a line of 30 characters, expected columns of 8 and 10"
    ):
        read(tmp_path, lines)


@pytest.mark.parametrize("end", ["N,R5.3,LOC,       -1,", "n,r5.3,LOC,-1", "-1", "       -1 "])
def test_blocks_of_nodes_end_in_two_ways(end, tmp_path):
    lines = [end if line.startswith("N,R5") else line for line in PART]
    assert len(read(tmp_path, lines).points) == 8


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        (PART[:-1], r"line 14: found EBLOCK without its end: cut short\?"),
        (PART[:8], r"line 3: found NBLOCK without its end: cut short\?"),
        ([line.replace("19,SOLID", "10,") for line in PART], "line 14: found an EBLOCK that is not SOLID"),
        ([*PART[:-2], "        3" * 11, PART[-1]], "line 16: found 11 numbers, expected 11 and the"),
        ([*PART[:-2], *row(4, 7, 300, range(21, 31)), "        9", "       -1"], "line 18: found 1 numbers, exp"),
        ([*PART, "CMBLOCK,a,NODE"], "line 18: found 'CMBLOCK,a,NODE', expected CMBLOCK, name, NODE or ELEM, number"),
        ([*PART, "CMBLOCK,a,LINE,2"], "line 18: found 'CMBLOCK,a,LINE,2', expected CMBLOCK, name"),
        ([*PART, "CMBLOCK,a,NODE,x", "(8i10)"], "line 18: found 'X', expected a whole number"),
        ([*PART, "CMBLOCK,a,NODE,3", "(8i10)", f"{21:10d}{22:10d}"], "line 18: found 2 numbers, expected 3"),
        ([*PART, "CMBLOCK,a,NODE,1", "(8i10)", f"{21:10d}{22:10d}"], "line 18: found 2 numbers, expected 1"),
        ([*PART, "N,9,1.,2.,3."], "line 18: found the command N for a single node or element, expected blocks"),
        ([*PART, "N,9,1."], "line 18: found the command N for a single node or element"),
        ([*PART, "E,1,2,3,4"], "line 18: found the command E for a single node or element"),
        ([*PART, "en,9,1,2,3,4"], "line 18: found the command EN for a single node or element"),
        ([*PART, "ET,x,185"], "line 18: found 'X', expected a whole number"),
        ([line.replace(",185", ",") for line in PART], "found element 300 of type 7, expected a command ET"),
        ([PART[0], *PART[2:]], "found element 300 of type 7, expected a command ET"),
        (PART[:2], r"found 0 nodes and 0 elements in blocks \(NBLOCK, EBLOCK\)"),
        (PART[:13], r"found 8 nodes and 0 elements in blocks \(NBLOCK, EBLOCK\)"),
    ],
)  # fmt: skip
def test_archives_that_are_not_whole_are_refused(lines, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.cdb: {told}"):
        read(tmp_path, lines)


def test_numbers_are_those_of_one_node_or_element(tmp_path):
    with pytest.raises(cf.errors.ModelError, match="node 22 twice"):
        read(tmp_path, [line.replace("      23       0", "      22       0") for line in PART])
    with pytest.raises(cf.errors.ModelError, match="element 300 twice"):
        read(
            tmp_path, [*PART[:2], "ET,8,181", *nodes_block(), *elements_block(BRICK, row(4, 8, 300, (21, 22, 23, 24)))]
        )


def test_lines_of_other_commands_are_passed_over(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = read(
            tmp_path,
            [*PART, "N", "E", "N,R5.3,LOC", "ET", "ET,9", "EN,3", "/CE,1", "!CP,1", "/CERIG,2", "MP,EX,1,2e11", "RBE"],
        )
    assert mesh.cell_numbers.tolist() == [300]


@pytest.mark.parametrize("head", ["CE", "CP", "CERIG", "RBE3", "ce"])
def test_constraints_are_counted_and_left_out(head, tmp_path):
    with pytest.warns(cf.errors.ModelWarning, match=rf"a\.cdb: 2 constraints \({head.upper()}\); .*mesh-left-out"):
        read(tmp_path, [*PART, f"{head},1,2", f"{head},2,3"])


def test_elements_that_are_no_solids_or_shells_are_counted(tmp_path):
    more = [row(1, 9, 301, [21]), row(1, 9, 302, [22])]
    lines = [*PART[:2], "ET,9,MASS21", *nodes_block(), *elements_block(BRICK, *more)]
    with pytest.warns(cf.errors.ModelWarning, match=r"a\.cdb: 2 elements of type MASS21; .*mesh-left-out"):
        assert read(tmp_path, lines).cell_numbers.tolist() == [300]
