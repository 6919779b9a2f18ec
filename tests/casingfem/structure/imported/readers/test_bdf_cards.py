"""Fields of Nastran's cards in three widths, continuations, and the bounds of their numbers."""

import re

import pytest

import casingfem as cf

BODY = "GRID,91,,0.,0.,0.\nGRID,92,,1.,0.,0.\nGRID,93,,0.,1.,0.\nGRID,94,,0.,0.,1.\nCTETRA,1,1,91,92,93,94\n"


def read(folder, text):
    (folder / "a.bdf").write_text(text)
    return cf.read_mesh(folder / "a.bdf")


@pytest.mark.parametrize(
    "lines",
    [
        "GRID,7,,1.5,2.5,3.5",
        "grid, 7 ,, 1.5 ,2.5,3.5",
        "GRID    7               1.5     2.5     3.5",
        "GRID           7             1.5     2.5     3.5",
        "GRID\t7\t\t1.5\t2.5\t3.5",
        "GRID*   7                               1.5             2.5\n*       3.5",
        "GRID*,7,,1.5,2.5\n*,3.5",
        "GRID*,7,,1.5,2.5\n+A,3.5",
        "GRID*,7,,1.5,2.5,*M\n*M,3.5",
        "GRID,7,,1.5,2.5,3.5$,9.",
        "$GRID,7,,9.,9.,9.\n\n   $\nGRID,7,,1.5,2.5,3.5",
    ],
)
def test_a_grid_is_read_in_every_width(lines, tmp_path):
    mesh = read(tmp_path, f"BEGIN BULK\n{lines}\n{BODY}ENDDATA\n")
    assert (mesh.node_numbers[0], mesh.points[0].tolist()) == (7, [1.5, 2.5, 3.5])


def test_fields_that_a_line_leaves_blank_at_its_end_count(tmp_path):
    """The continuation of a short line begins with the ninth field: nodes 6 and on of a brick."""
    corners = "".join(f"GRID,{k},,{x}.,{y}.,{z}.\n" for k, (x, y, z) in enumerate(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], 1))  # fmt: skip
    whole = "CHEXA   5       4       1       2       3       4       5       6\n+       7       8\n"
    assert read(tmp_path, corners + whole).cells.tolist() == [list(range(8))]
    with pytest.raises(cf.errors.ModelError, match="CHEXA: found element 5 with 7 nodes, expected 8 corners"):
        read(tmp_path, corners + whole.replace("       6\n", "\n"))


def test_bulk_data_are_between_their_words(tmp_path):
    text = f"GRID,5,,9.,9.,9.\n begin  bulk\n{BODY}Enddata x\nGRID,6,,9.,9.,9.\n"
    assert read(tmp_path, text).node_numbers.tolist() == [91, 92, 93, 94]
    assert len(read(tmp_path, "GRID,5,,9.,9.,9.\n" + BODY).points) == 5
    for nothing in ("BEGIN BULK\n", "ENDDATA\n" + BODY):
        with pytest.raises(cf.errors.ModelError, match="found 0 grids and no elements"):
            read(tmp_path, nothing)


REALS = {
    "": 0.0, "1.5": 1.5, "1.5-3": 1.5e-3, "1.5+3": 1500.0, "-1.5-3": -1.5e-3, "1.5D-3": 1.5e-3, "1.5d-3": 1.5e-3,
    "1.5e2": 150.0, "1.5E2": 150.0, "2": 2.0, ".5+1": 5.0, "9.9e99": 9.9e99, "-9.9+99": -9.9e99,
}  # fmt: skip


def test_real_numbers_in_nastrans_ways(tmp_path):
    grids = "".join(f"GRID,{k},,1.,{text},2.\n" for k, text in enumerate(REALS, 1))
    assert read(tmp_path, grids + BODY).points[: len(REALS), 1].tolist() == list(REALS.values())


@pytest.mark.parametrize("text", ["x", "1e100", "-1e100", "nan", "inf", "1.5-3-3", "1.+", "--1"])
def test_what_is_no_real_number_is_refused(text, tmp_path):
    found = re.escape(f"a.bdf: line 6: GRID: found '{text}', expected a real number")
    with pytest.raises(cf.errors.ModelError, match=found):
        read(tmp_path, f"{BODY}GRID,7,,1.,{text},2.\n")


def test_whole_numbers_have_eight_digits(tmp_path):
    assert read(tmp_path, f"{BODY}GRID,99999999,,1.\n").node_numbers[-1] == 99999999
    for text, expected in (("100000000", "at most eight digits"), ("1.", "a whole number"), ("x", "a whole number")):
        with pytest.raises(cf.errors.ModelError, match=f"line 6: GRID: found '{text}', expected .*{expected}"):
            read(tmp_path, f"{BODY}GRID,{text},,1.\n")


def test_names_of_cells_as_meshio_writes_them_are_those_of_nastran(tmp_path):
    """The writer of meshio 5.3 calls a tetrahedron of ten nodes CTETRA_."""
    assert read(tmp_path, BODY.replace("CTETRA", "CTETRA_")).cells.tolist() == read(tmp_path, BODY).cells.tolist()
