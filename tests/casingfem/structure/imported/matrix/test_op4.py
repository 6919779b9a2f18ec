"""OP4 files of text number by number: every layout, both sides of each bound."""

import numpy as np
import pytest

import casingfem as cf

A = np.array([[0.0, 2.5, 0.0, 0.0], [1.5, 0.0, 0.0, 0.0], [-3.0, 0.0, 0.0, 0.0], [0.0, 4.0, 7.0, 0.0]])


def header(name="K", *, long=False, kind=2, rows=4, columns=4):
    return f"{columns:8d}{-rows if long else rows:8d}{2:8d}{kind:8d}{name:8}1P,3E23.16\n"


def values(*numbers):
    lines = [numbers[k : k + 3] for k in range(0, len(numbers), 3)]
    return "".join("".join(f"{x:23.16E}" for x in line) + "\n" for line in lines)


END = f"{5:8d}{1:8d}{1:8d}\n" + values(1.0)
DENSE = f"{1:8d}{2:8d}{4:8d}\n{values(1.5, -3.0)}{2:8d}{1:8d}{8:8d}\n{values(2.5, 0, 0, 4.0)}"
DENSE += f"{3:8d}{4:8d}{2:8d}\n{values(7.0)}"
SHORT = (
    f"{1:8d}{0:8d}{5:8d}\n{2 + 65536 * 5:8d}\n{values(1.5, -3.0)}{2:8d}{0:8d}{6:8d}\n{1 + 65536 * 3:8d}\n{values(2.5)}"
)
SHORT += f"{4 + 65536 * 3:8d}\n{values(4.0)}{3:8d}{0:8d}{3:8d}\n{4 + 65536 * 3:8d}\n{values(7.0)}"
LONG = f"{1:8d}{0:8d}{6:8d}\n{5:8d}{2:8d}\n{values(1.5, -3.0)}{2:8d}{0:8d}{8:8d}\n{3:8d}{1:8d}\n{values(2.5)}"
LONG += f"{3:8d}{4:8d}\n{values(4.0)}{3:8d}{0:8d}{4:8d}\n{3:8d}{4:8d}\n{values(7.0)}"


def read(folder, content):
    """A set of four dofs from a file that has M too, unless the text has it."""
    (folder / "a.op4").write_text(content)
    (folder / "dofs.csv").write_text("node,direction\n1,x\n2,x\n3,x\n4,x\n")
    return cf.imported.read_matrices(folder / "a.op4", dofs=folder / "dofs.csv")


MASS = header("M") + DENSE + END


@pytest.mark.parametrize("body", [DENSE, SHORT, LONG], ids=["dense", "short", "long"])
def test_a_text_file_in_three_layouts(body, tmp_path):
    found = read(tmp_path, header(" k2 ", long=body is LONG) + body + END + MASS)
    np.testing.assert_array_equal(found.K.toarray(), A)
    np.testing.assert_array_equal(found.M.toarray(), A)


def test_matrices_follow_one_another_with_blank_lines_between(tmp_path):
    text = "\n" + header("K") + DENSE + END + " \n\n" + header("M", long=True) + LONG + END + header("C") + END
    found = read(tmp_path, text)
    assert [abs(one.toarray() - A).max() for one in (found.K, found.M)] == [0.0, 0.0]
    assert (found.C.shape, found.C.nnz) == ((4, 4), 0)


def test_a_matrix_may_end_without_values_behind_its_last_column(tmp_path):
    found = read(tmp_path, MASS + header() + DENSE + f"{5:8d}{1:8d}{0:8d}\n")
    np.testing.assert_array_equal(found.K.toarray(), A)


@pytest.mark.parametrize("letter", ["D", "E"])
def test_numbers_are_as_wide_as_the_header_states(letter, tmp_path):
    text = f"{4:8d}{4:8d}{2:8d}{2:8d}{'K':8}E9.2\n{1:8d}{1:8d}{2:8d}\n 1.25{letter}+00-2.50{letter}-01\n"
    text += f"{5:8d}{1:8d}{1:8d}\n 1.00{letter}+00\n"
    assert read(tmp_path, text + MASS).K.toarray()[:, 0].tolist() == [1.25, -0.25, 0.0, 0.0]


def test_complex_matrices_are_passed_over_but_those_of_a_set(tmp_path):
    """Of single words, two numbers each; names of Nastran's sets are refused."""
    both = f"{1:8d}{2:8d}{4:8d}\n{values(1.5, -3.0)}" + END
    text = header("V", kind=3) + both + header("V", kind=4) + both + header("K") + DENSE + END + MASS
    np.testing.assert_array_equal(read(tmp_path, text).K.toarray(), A)
    for kind in (3, 4):
        with pytest.raises(
            cf.errors.ModelError, match=f"a.op4: MAA: found type {kind}, 4 rows, 4 columns, expected a real matrix"
        ):
            read(tmp_path, header("MAA", kind=kind) + both)


@pytest.mark.parametrize("row", [0, 1, 3, 4])
def test_entries_up_to_the_edges_of_their_matrix_are_taken_and_none_beyond(row, tmp_path):
    """Two values of column 4, from each row; the last matrix rows are 3 and 4."""
    text = MASS + header() + f"{4:8d}{row:8d}{4:8d}\n{values(1.5, -3.0)}" + END
    if row in (1, 3):
        found = read(tmp_path, text).K.toarray()
        assert found[row - 1 : row + 1, 3].tolist() == [1.5, -3.0]
        assert np.abs(found).sum() == 4.5
    elif row == 4:
        with pytest.raises(
            cf.errors.ModelError, match=r"a\.op4: K: found rows 4 to 5 of column 4 in a matrix of 4 x 4"
        ):
            read(tmp_path, text)
    else:  # a string, whose head is missing
        with pytest.raises(cf.errors.ModelError, match=r"a\.op4: line 13: found .*, expected whole numbers"):
            read(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x", "line 1: found 'x', expected the header of a matrix: columns, rows, form, type, name"),
        (
            header() + DENSE + END + "x\n",
            "line 11: found 'x', expected the header of a matrix: columns, rows, form, type, name",
        ),
        (header().replace("1P,3E23.16", "") + DENSE, "line 3: found .*, expected numbers of 16 characters"),
        (
            header() + DENSE.replace(f"{2:8d}{1:8d}{8:8d}", f"{2:8d}{1:8d}{9:8d}{9:8d}"),
            "line 4: .*expected column, row, words",
        ),
        (header() + f"{7:8d}\n", "line 2: found '       7', expected column, row, words"),
        (
            header() + f"{1:8d}{0:8d}{2:8d}\n{1:8d}{1:8d}\n",
            r"line 3: found '       1       1', expected column, row, words",
        ),
        (header(long=True) + f"{1:8d}{0:8d}{2:8d}\n{1:8d}\n", "line 3: found '       1', expected column, row, words"),
        (header() + DENSE, r"K: the file ends in column 3 of 4: cut short\?"),
        (header(), r"K: the file ends in column 0 of 4: cut short\?"),
        (
            header() + DENSE.replace(f"{8:8d}\n", f"{3:8d}\n") + END,
            "line 6: K: found 4 values in column 2, expected 3 words as announced",
        ),
        (
            header() + DENSE.replace(f"{4:8d}{2:8d}\n", f"{4:8d}{9:8d}\n") + END,
            "line 8: K: found 1 values in column 3, expected",
        ),
    ],
)
def test_text_that_is_damaged_is_named_with_its_line(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.op4: {told}"):
        read(tmp_path, text)
