"""Tables of text read strictly: separators, decimal marks, encodings, each refusal with its line and column."""

import re

import numpy as np
import pytest

import casingfem as cf

HEADER = "mode,freq_hz,sigma_hz"


def read(folder, text, encoding="utf-8"):
    path = folder / "t.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
    return cf.FrequencyTable.from_csv(path)


def test_a_table_has_a_card_a_header_and_rows(tmp_path):
    found = read(tmp_path, f"\n# rig, 2024\n  #  second \n\n{HEADER}\r\n1, 2.5,1\n\n3,+4e1,.5\n")
    assert found.card == ("rig, 2024", "second")
    assert (found.mode.tolist(), found.freq_hz.tolist(), found.sigma_hz.tolist()) == ([1, 3], [2.5, 40.0], [1.0, 0.5])


@pytest.mark.parametrize("cell", ["1.", ".5", "+3e-4", "1E5", "00.10"])
def test_numbers_are_written_with_digits_a_point_and_an_exponent(tmp_path, cell):
    assert read(tmp_path, f"{HEADER}\n1,{cell},1e-9\n").freq_hz.tolist() == [float(cell)]


@pytest.mark.parametrize("cell", [".", "1e", "e5", "1e5.0", "--1", "1 2", "0x1", "1e999", "1,5", "nan", "inf"])
def test_what_is_no_finite_number_is_refused(tmp_path, cell):
    with pytest.raises(cf.errors.InputError, match=r"line 2, column 'freq_hz': found .*; expected a finite number"):
        read(tmp_path, f'{HEADER}\n1,"{cell}",1\n')


@pytest.mark.parametrize(("cell", "whole"), [("123456789012345", True), ("1234567890123456", False), ("1.5", False)])
def test_whole_numbers_have_fifteen_digits_at_most(tmp_path, cell, whole):
    text = f"{HEADER}\n{cell},5,1\n"
    if whole:
        assert read(tmp_path, text).mode.tolist() == [int(cell)]
        return
    with pytest.raises(cf.errors.InputError, match=f"column 'mode': found '{cell}'; expected a whole number"):
        read(tmp_path, text)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_semicolons_or_tabs_leave_the_comma_to_decimals(tmp_path, mark):
    lines = "mode;freq_hz;sigma_hz\n1;1,5;,5e0\n2;3;0,25\n".replace(";", mark)
    for text in (lines, lines.replace(",", ".")):
        found = read(tmp_path, text)
        np.testing.assert_array_equal([found.freq_hz, found.sigma_hz], [[1.5, 3.0], [0.5, 0.25]])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mode;freq_hz;sigma_hz\n1;1,5;2\n2;3.5;4\n", "found '3.5' below numbers with a decimal comma; expected one"),
        ("mode;freq_hz;sigma_hz\n1;1.5;2\n2;3,5;4\n", "found '3,5' below numbers with a decimal point; expected one"),
        ("mode;freq_hz;sigma_hz\n1;1,5;1,2,5\n", "line 2, column 'sigma_hz': found '1,2,5'"),
        (f"Survey\n{HEADER}\n1,2,1\n", "line 1: found 'Survey' above the names of the columns"),
        (f"{HEADER}\n1,2,3,4\n", "found 4 cells in '1,2,3,4'; expected 3"),
        (f"{HEADER}\n1\n", "line 2: found 1 cells in '1'; expected 3, one for each of mode,freq_hz,sigma_hz"),
        ("# only\n", "found no header row"),
        (f"{HEADER}\n", "line 1: found no rows below the header"),
        ("1,freq_hz,sigma_hz\n2,3,4\n", "line 1: found numbers (1) in the first row"),
        ("mode,,sigma_hz\n1,2,3\n", "line 1: found no name for column 2"),
        ("mode,freq_hz,mode\n1,2,3\n", "line 1, column 'mode': found this column"),
        (f'{HEADER}\n1,"2,3\n', "line 2: found quotes that do not pair"),
        (f"{HEADER}\n1,\x002,3\n", "line 2: found a zero byte"),
        (f"{HEADER}\n1,2,3\n".encode() + b"3,\xff,1\n", "line 3: found byte 0xff, which is not UTF-8"),
        (b"PK\x03\x04rest", "found no readable workbook (File is not a zip file); expected a workbook .xlsx"),
        (b"\xff\xfea\x00,\x00\x00\xdc", "line 1: found bytes that are not UTF-16"),
    ],
)  # fmt: skip
def test_a_table_that_does_not_fit_is_refused_with_its_line(tmp_path, text, words):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        read(tmp_path, text)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_files_of_each_encoding_are_read(tmp_path, encoding):
    found = read(tmp_path, f"# Gehäuse\n{HEADER}\n1,2,1\n", encoding)
    assert (found.card, found.freq_hz.tolist()) == (("Gehäuse",), [2.0])
    with pytest.raises(cf.errors.InputError, match="found a name with a zero byte; expected a file"):
        cf.FrequencyTable.from_csv("a\0.csv")
