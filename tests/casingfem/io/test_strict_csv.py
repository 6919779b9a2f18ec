"""Small tables read strictly: separators, decimal marks, headers, cells, each refusal with its line and column."""

import re

import pytest

import casingfem as cf
from casingfem.io.strict_csv import parse, read


def refused(text, words):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        parse(text, "t.csv")


def test_a_table_has_a_card_a_header_and_rows_with_their_lines():
    found = parse('\n# rig, 2024\n  #  second \n\na,b\n1,2.5\n\n-3,"x, y"\n', "t.csv")
    assert (found.card, found.header, found.header_line) == (("rig, 2024", "second"), ("a", "b"), 5)
    assert found.lines.tolist() == [6, 8]
    assert found.cells == {"a": ("1", "-3"), "b": ("2.5", "x, y")}
    assert found.decimal == "."
    assert parse("a,b\r\n1, 2\r3,4", "t.csv").cells == {"a": ("1", "3"), "b": ("2", "4")}


def test_numbers_may_be_blank_where_something_stands_for_them():
    found = parse("a,b,c\n1e3,,\n+.5,2,7\n", "t.csv")
    assert found.numbers("a").tolist() == [1000.0, 0.5]
    assert found.numbers("b", blank=-1.5).tolist() == [-1.5, 2.0]
    assert found.integers("c", blank=0).tolist() == [0, 7]
    assert found.numbers("c", blank=0.0).tolist() == [0.0, 7.0]
    for call, words in (
        (lambda: found.numbers("b"), "t.csv, line 2, column 'b': found an empty cell; expected a number"),
        (lambda: found.integers("c"), "t.csv, line 2, column 'c': found an empty cell; expected a whole number"),
        (
            lambda: found.integers("a", blank=0),
            "line 2, column 'a': found '1e3'; expected a whole number, or an empty cell",
        ),
    ):
        with pytest.raises(cf.errors.InputError, match=re.escape(words)):
            call()


@pytest.mark.parametrize("cell", ["1.", ".5", "-2", "+3e-4", "1E5", "00.10"])
def test_numbers_are_written_with_digits_a_point_and_an_exponent(cell):
    assert parse(f"a,b\n{cell},0\n", "t.csv").numbers("a").tolist() == [float(cell)]


@pytest.mark.parametrize("cell", [".", "1e", "e5", "1e5.0", "--1", "1 2", "0x1", "1e999", "1,5"])
def test_what_is_no_finite_number_is_refused(cell):
    found = parse(f'a,b\n"{cell}",0\n', "t.csv")
    with pytest.raises(
        cf.errors.InputError, match=r"line 2, column 'a': found .*; expected a finite number such as 371\.2 or 3\.7"
    ):
        found.numbers("a")


@pytest.mark.parametrize(
    ("cell", "whole"), [("123456789012345", True), ("1234567890123456", False), ("-7", True), ("+7", True)]
)
def test_whole_numbers_have_fifteen_digits_at_most(cell, whole):
    found = parse(f"a,b\n{cell},0\n", "t.csv")
    if whole:
        assert found.integers("a").tolist() == [int(cell)]
        return
    with pytest.raises(cf.errors.InputError, match=f"found '{cell}'; expected a whole number$"):
        found.integers("a")


@pytest.mark.parametrize("mark", [";", "\t"])
def test_semicolons_or_tabs_leave_the_comma_to_decimals(mark):
    lines = ["a;b;c", "1,5;-,5e2;x", "2;3;0,25"]
    found = parse("\n".join(lines).replace(";", mark), "t.csv")
    assert found.decimal == ","
    assert found.numbers("a").tolist() == [1.5, 2.0]
    assert found.numbers("b").tolist() == [-50.0, 3.0]
    points = parse("\n".join(lines).replace(";", mark).replace(",", "."), "t.csv")
    assert points.decimal == "."
    assert points.numbers("a").tolist() == [1.5, 2.0]
    assert parse(f"a{mark}b\n1{mark}2\n", "t.csv").decimal == "."
    assert parse("a\tb\n\t2\n", "t.csv").cells == {"a": ("",), "b": ("2",)}


def test_a_number_with_a_comma_has_no_second_mark():
    found = parse("a;b\n1,5;1,2,5\n", "t.csv")
    with pytest.raises(cf.errors.InputError, match="line 2, column 'b': found '1,2,5'"):
        found.numbers("b")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a;b\n1,5;2\n3.5;4\n", "line 3: found '3.5' below numbers with a decimal comma; expected one"),
        ("a;b\n1.5;2\n3,5;4\n", "line 3: found '3,5' below numbers with a decimal point; expected one"),
        ("Survey of part 7;;\na;b;c\n1;2;3\n", "line 1: found 'Survey of part 7' above the names of the columns"),
        ("Survey\na,b\n1,2\n", "line 1: found 'Survey' above the names of the columns; expected a header: put # b"),
        ("a,b\n1,2,3\n", "found 3 cells in '1,2,3'; expected 2, one for each of a,b (numbers take a decimal point"),
        ("a,b\n1\n", "line 2: found 1 cells in '1'; expected 2, one for each of a,b"),
        ("# only\n", "found no header row"),
        ("a,b\n", "line 1: found no rows below the header"),
        ("1,b\n2,3\n", "line 1: found numbers (1) in the first row"),
        ("a,,c\n1,2,3\n", "line 1: found no name for column 2"),
        ("a,b,a\n1,2,3\n", "line 1, column 'a': found this column"),
        ('a,b\n"1,2\n', "line 2: found quotes that do not pair"),
        ("a,b\n1,\x002\n", "line 2: found the character '\\x00'"),
    ],
)  # fmt: skip
def test_a_table_that_does_not_fit_is_refused_with_its_line(text, words):
    refused(text, words)


def test_a_hint_of_decimal_points_stands_where_commas_separate_too_many_cells():
    for text in ("a;b\n1;2;3\n", "a,b\n1\n"):
        with pytest.raises(cf.errors.InputError) as caught:
            parse(text, "t.csv")
        assert "decimal point" not in str(caught.value)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"PK\x03\x04rest", "found no readable workbook (File is not a zip file); expected a workbook .xlsx"),
        (b"a,b\n1,2\n3,\xff\n", "line 3: found byte 0xff, which is not UTF-8 ('ÿ' in Latin-1); expected UTF-8 text"),
        (b"\xff\xfea\x00,\x00\x00\xdc", "line 1: found bytes that are not UTF-16"),
    ],
)
def test_files_of_another_kind_are_refused(data, words, tmp_path):
    (tmp_path / "t.csv").write_bytes(data)
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        read(tmp_path / "t.csv")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_files_of_each_encoding_are_read(encoding, tmp_path):
    (tmp_path / "t.csv").write_bytes("a,b\n1,ä\n".encode(encoding))
    assert read(tmp_path / "t.csv").cells == {"a": ("1",), "b": ("ä",)}
    with pytest.raises(cf.errors.InputError, match="found a name with a zero byte; expected a file"):
        read("a\0.csv")
