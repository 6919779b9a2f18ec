"""OP4 files of text number by number: every layout, both sides of each bound."""

import re

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.matrix.op4 import read_op4
from casingfem.structure.imported.matrix.op4_entries import Entries, begun, split_word
from casingfem.structure.imported.matrix.op4_text import check_column, integers

A = np.array([[0.0, 2.5, 0.0], [1.5, 0.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 4.0, 7.0]])  # not square


def header(name="K", *, long=False, kind=2, rows=4, columns=3):
    return f"{columns:8d}{-rows if long else rows:8d}{2:8d}{kind:8d}{name:8}1P,3E23.16\n"


def values(*numbers):
    lines = [numbers[k : k + 3] for k in range(0, len(numbers), 3)]
    return "".join("".join(f"{x:23.16E}" for x in line) + "\n" for line in lines)


END = f"{4:8d}{1:8d}{1:8d}\n" + values(1.0)
DENSE = f"{1:8d}{2:8d}{4:8d}\n{values(1.5, -3.0)}{2:8d}{1:8d}{8:8d}\n{values(2.5, 0, 0, 4.0)}"
DENSE += f"{3:8d}{4:8d}{2:8d}\n{values(7.0)}"
SHORT = (
    f"{1:8d}{0:8d}{5:8d}\n{2 + 65536 * 5:8d}\n{values(1.5, -3.0)}{2:8d}{0:8d}{6:8d}\n{1 + 65536 * 3:8d}\n{values(2.5)}"
)
SHORT += f"{4 + 65536 * 3:8d}\n{values(4.0)}{3:8d}{0:8d}{3:8d}\n{4 + 65536 * 3:8d}\n{values(7.0)}"
LONG = f"{1:8d}{0:8d}{6:8d}\n{5:8d}{2:8d}\n{values(1.5, -3.0)}{2:8d}{0:8d}{8:8d}\n{3:8d}{1:8d}\n{values(2.5)}"
LONG += f"{3:8d}{4:8d}\n{values(4.0)}{3:8d}{0:8d}{4:8d}\n{3:8d}{4:8d}\n{values(7.0)}"


def read(folder, content):
    (folder / "a.op4").write_text(content)
    return read_op4(folder / "a.op4")


@pytest.mark.parametrize("body", [DENSE, SHORT, LONG], ids=["dense", "short", "long"])
def test_a_text_file_in_three_layouts(body, tmp_path):
    found = read(tmp_path, header(" k2 ", long=body is LONG) + body + END)
    assert list(found) == ["k2"]
    np.testing.assert_array_equal(found["k2"].toarray(), A)


def test_matrices_follow_one_another_with_blank_lines_between(tmp_path):
    found = read(
        tmp_path, "\n" + header("A") + DENSE + END + " \n\n" + header("B", long=True) + LONG + END + header("C") + END
    )
    assert list(found) == ["A", "B", "C"]
    assert [abs(one.toarray() - A).max() for one in (found["A"], found["B"])] == [0.0, 0.0]
    assert (found["C"].shape, found["C"].nnz) == ((4, 3), 0)


def test_a_matrix_may_end_without_values_behind_its_last_column(tmp_path):
    found = read(tmp_path, header() + DENSE + f"{4:8d}{1:8d}{0:8d}\n")
    np.testing.assert_array_equal(found["K"].toarray(), A)


@pytest.mark.parametrize("letter", ["D", "E"])
def test_numbers_are_as_wide_as_the_header_says(letter, tmp_path):
    text = f"{1:8d}{2:8d}{2:8d}{2:8d}{'E1.5':8}E9.2\n{1:8d}{1:8d}{2:8d}\n 1.25{letter}+00-2.50{letter}-01\n"
    text += f"{2:8d}{1:8d}{1:8d}\n 1.00{letter}+00\n"
    assert read(tmp_path, text)["E1.5"].toarray().tolist() == [[1.25], [-0.25]]


def test_complex_matrices_are_passed_over_but_those_of_a_set(tmp_path):
    """Of single words, two numbers each; names of Nastran's sets are refused."""
    both = f"{1:8d}{2:8d}{4:8d}\n{values(1.5, -3.0)}" + END
    found = read(tmp_path, header("V", kind=3) + both + header("V", kind=4) + both + header("K") + DENSE + END)
    assert list(found) == ["K"]
    for kind in (3, 4):
        with pytest.raises(
            cf.errors.ModelError, match=f"a.op4: MAA: found type {kind}, 4 rows, 3 columns, expected a real matrix"
        ):
            read(tmp_path, header("MAA", kind=kind) + both)


@pytest.mark.parametrize(
    ("name", "kind", "words", "real"), [("K", 1, 1, True), ("KAA", 2, 2, True), ("V", 3, 1, False), ("V", 4, 2, False)]
)
@pytest.mark.parametrize("rows", [5, -5])
def test_what_a_header_says(name, kind, words, real, rows):
    found = begun("a.op4", name, 7, rows, kind)
    assert (found.name, found.rows, found.columns, found.long) == (name, 5, 7, rows < 0)
    assert (found.words, found.parts, found.real) == (words, [], real)


@pytest.mark.parametrize(
    ("columns", "rows", "taken"),
    [
        (1, 1, True),
        (0, 1, False),
        (1, 0, False),
        (-1, 1, False),
        (2**31 - 1, -(2**31) + 1, True),
        (2**31, 1, False),
        (1, 2**31, False),
    ],
)
def test_rows_and_columns_are_numbers_of_a_binary_file(columns, rows, taken):
    if taken:
        assert begun("a.op4", "K", columns, rows, 2).columns == columns
        return
    told = f"a.op4: K: found {abs(rows)} rows, {columns} columns, expected 1 to 2147483647 of each"
    with pytest.raises(cf.errors.ModelError, match=told):
        begun("a.op4", "K", columns, rows, 2)


@pytest.mark.parametrize(
    ("word", "length", "row"), [(65536 * 3 + 7, 2, 7), (65536 * 2, 1, 0), (65536 * 5 + 65535, 4, 65535)]
)
def test_one_word_has_a_length_and_a_row(word, length, row):
    assert split_word(word) == (length, row)


def part(column, row, count):
    return column, row, np.arange(1.0, 1.0 + count)


@pytest.mark.parametrize("parts", [[part(1, 1, 4)], [part(3, 2, 3)], [part(2, 4, 1), part(2, 1, 3)]])
def test_entries_up_to_the_edges_of_their_matrix_are_taken(parts):
    found = Entries("K", 4, 3, False, 2, parts).matrix("a.op4").toarray()
    wanted = np.zeros((4, 3))
    for column, row, numbers in parts:
        wanted[row - 1 : row - 1 + len(numbers), column - 1] = numbers
    np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize(
    ("outside", "told"),
    [
        (part(0, 1, 2), "rows 1 to 2 of column 0"),
        (part(4, 1, 2), "rows 1 to 2 of column 4"),
        (part(1, 0, 2), "rows 0 to 1 of column 1"),
        (part(1, 4, 2), "rows 4 to 5 of column 1"),
    ],
)
def test_entries_beyond_the_edges_of_their_matrix_are_refused(outside, told):
    with pytest.raises(cf.errors.ModelError, match=f"a.op4: K: found {told} in a matrix of 4 x 3"):
        Entries("K", 4, 3, False, 2, [part(2, 2, 1), outside]).matrix("a.op4")


def test_the_first_entry_that_is_given_again_is_named():
    again = [part(3, 1, 2), part(2, 2, 3), part(3, 2, 1), part(2, 4, 1)]
    with pytest.raises(cf.errors.ModelError, match=r"a\.op4: K: found row 4 of column 2 again, expected it once"):
        Entries("K", 4, 3, False, 2, again).matrix("a.op4")


@pytest.mark.parametrize(
    ("words", "parts", "taken", "refused"),
    [
        (2, [part(1, 1, 3)], (3, 6, 10), (2, 11)),
        (1, [part(1, 1, 3)], (3, 7), (2, 8)),
        (2, [part(2, 1, 9), part(1, 1, 2), part(1, 4, 1)], (3, 14), (2, 15)),  # of this column alone
        (2, [part(2, 1, 3)], (0,), (1,)),  # nothing of it
    ],
)
def test_a_column_has_the_words_that_it_says(words, parts, taken, refused):
    entries = Entries("K", 9, 3, True, words, parts)
    for wanted in taken:
        check_column("a.op4", 5, entries, 1, wanted)
    found = sum(len(numbers) for column, _, numbers in parts if column == 1)
    for wanted in refused:
        short = ": cut short" if wanted > found else ": write"
        told = rf"a\.op4: line 5: K: found {found} values in column 1, announced {wanted} words{short}"
        with pytest.raises(cf.errors.ModelError, match=told):
            check_column("a.op4", 5, entries, 1, wanted)
    check_column("a.op4", 5, entries, 0, 99)  # before the first


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x", "line 1: found 'x', expected columns, rows, form, type, name"),
        (header() + DENSE + END + "x\n", "line 11: found 'x', expected columns, rows, form, type, name"),
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
        (header() + DENSE, "K: the file ends in column 3 of 3: cut short"),
        (header(), "K: the file ends in column 0 of 3: cut short"),
        (
            header() + DENSE.replace(f"{8:8d}\n", f"{3:8d}\n") + END,
            "line 6: K: found 4 values in column 2, announced 3 words",
        ),
        (
            header() + DENSE.replace(f"{4:8d}{2:8d}\n", f"{4:8d}{9:8d}\n") + END,
            "line 8: K: found 1 values in column 3, ann",
        ),
    ],
)
def test_text_that_is_damaged_is_named_with_its_line(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.op4: {told}"):
        read(tmp_path, text)


def test_whole_numbers_of_a_line():
    assert integers(" 7 -8   9", 4, "a.op4") == [7, -8, 9]
    with pytest.raises(cf.errors.ModelError, match=re.escape("a.op4: line 5: found '7 8.', expected whole numbers")):
        integers("7 8.", 4, "a.op4")
