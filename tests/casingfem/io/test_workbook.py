"""Tables from Excel workbooks: equal to the CSV of the same table, refused with sheet and row."""

import json
import re
from zipfile import ZipFile

import pytest
from click.testing import CliRunner
from openpyxl import Workbook

import casingfem as cf
from casingfem.cli import main

TABLE = [
    ["# SYNTHETIC rig"],
    ["Mode", "n", "Frequency [kHz]", "sigma_hz", "note"],
    [],
    [1, 8, 0.36725, 0.2, "a"],
    ["# a comment between"],
    [2, 8, 0.3684, 0.25, None],
    [3, None, 0.4, 1, "1,5"],
]


def saved(path, **sheets):
    book = Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def csv_of(path, rows):
    quoted = [",".join("" if c is None else f'"{c}"' if "," in str(c) else str(c) for c in row) for row in rows]
    width = max(map(len, rows))
    lines = [q if not r or len(r) == 1 else q + "," * (width - len(r)) for q, r in zip(quoted, rows, strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def refused(path, words, read=cf.FrequencyTable.from_csv):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        read(path)


@pytest.mark.filterwarnings("ignore:.*table-columns")
def test_a_workbook_gives_the_table_of_the_csv_with_the_same_cells(tmp_path):
    text = cf.FrequencyTable.from_csv(csv_of(tmp_path / "t.csv", TABLE))
    book = saved(tmp_path / "t.xlsx", first=TABLE, second=[TABLE[1], [7, 2, 0.5, 0.1, "b"]])
    table = cf.FrequencyTable.from_csv(book)
    assert repr(table) == repr(text)
    assert (table.card, table.extra) == (text.card, text.extra)
    assert table.freq_hz.tolist() == text.freq_hz.tolist() == [367.25, 368.4, 400.0]
    assert cf.FrequencyTable.from_csv(f"{book}#second").mode.tolist() == [7]
    refused(f"{book}#third", f"{book}: found no sheet 'third'; expected one of 'first', 'second'")


def test_angles_and_picks_are_read_from_workbooks(tmp_path):
    book = saved(
        tmp_path / "m.xlsx",
        angles=[["point", "angle [rad]"], [1, 0.5], [2, 1.5]],
        picks=[["f [rpm]"], [6000], [6060.0]],
    )
    assert cf.frf.read_places(f"{book}#angles")[0] == pytest.approx({1: 28.64788975654116, 2: 85.94366926962348})
    assert cf.frf.read_picks(f"{book}#picks").tolist() == pytest.approx([100.0, 101.0])


def test_cells_that_do_not_fit_are_refused_with_sheet_row_and_column(tmp_path):
    head = ["mode", "freq_hz", "sigma_hz"]
    book = saved(
        tmp_path / "t.xlsx",
        comma=[head, [], [1, "371,2", 0.1], [2.5, 300, True]],
        twice=[["mode", "mode"], [1, 2]],
        title=[["Modal test"], head, [1, 300, 1]],
        empty=[[]],
        unnamed=[head, [1, 300, 1, "x"]],
        broken=[head, [1, 300, "two\nlines"]],
        unit=[["mode", "f", "sigma_hz"], [1, 300, 1]],
    )
    refused(f"{book}#comma", f"{book}, sheet 'comma', row 4, column 'mode': found '2.5'; expected a whole number")
    refused(f"{book}#comma", "sheet 'comma', row 3, column 'freq_hz': found '371,2'; expected a finite number")
    refused(f"{book}#comma", "sheet 'comma', row 4, column 'sigma_hz': found 'TRUE'; expected a finite number")
    refused(f"{book}#twice", "sheet 'twice', row 1, column 'mode': found this column twice")
    refused(f"{book}#title", "sheet 'title', row 1: found 'Modal test' above the names of the columns")
    refused(f"{book}#empty", "sheet 'empty': found no header row")
    refused(f"{book}#unnamed", "sheet 'unnamed', row 1: found no name for column 4")
    refused(f"{book}#broken", "sheet 'broken', row 2: found the character '\\n'; expected printable text")
    refused(f"{book}#unit", "sheet 'unit', row 1, column 'f': found a column without a unit in its name")


def test_formulas_without_stored_values_are_refused_with_their_cells(tmp_path):
    book = saved(tmp_path / "t.xlsx", s=[["mode", "freq_hz", "sigma_hz"], [1, "=2*150", 1], [2, 300, "=B3/300"]])
    refused(book, f"{book}, sheet 's': found formulas without stored values in B2, C3; expected numbers: open")


def test_per_cent_formats_below_a_name_with_per_cent_are_refused(tmp_path):
    book, path = Workbook(), tmp_path / "t.xlsx"
    for row in (["mode", "freq_hz", "sigma_hz", "Damping [%]"], [1, 300, 1, 0.005]):
        book.active.append(row)
    book.active["D2"].number_format = "0.00%"
    book.save(path)
    refused(path, "row 2, column 'Damping [%]': found a number in Excel's per cent format, stored as 0.005")


def test_what_is_no_workbook_is_refused(tmp_path):
    path = tmp_path / "t.xlsx"
    for data, words in (
        (b"mode,freq_hz,sigma_hz\n1,2,1\n", "found no workbook: the file begins with b'mode', not with b'PK'"),
        (b"PK\x03\x04 and then nothing", "found no readable workbook (File is not a zip file)"),
        (b"\xd0\xcf\x11\xe0old", "found a workbook of Excel 97 to 2003, or one with a password"),
    ):
        path.write_bytes(data)
        refused(path, f"{path}: {words}")
    with ZipFile(path, "w") as archive:
        archive.writestr("other.txt", "x")
    refused(path, "found no readable workbook (")


BARE = [[cell for cell in row[:4]] for row in TABLE]


def with_part(path, part, old, new):
    """Change the text of one part of a workbook."""
    with ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    assert old in parts[part]
    parts[part] = parts[part].replace(old, new)
    with ZipFile(path, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)


@pytest.mark.parametrize(
    ("part", "old", "new", "words"),
    [
        ("xl/workbook.xml", b'state="visible"', b'state="hidden"', "found no visible sheet; expected a sheet with a"),
        ("xl/worksheets/sheet1.xml", b'<row r="7"', b'<row r="1048577"', "found row 1048577; expected at most 1048576"),
        (
            "xl/worksheets/sheet1.xml", b"<worksheet", b"<!DOCTYPE a><worksheet",
            "found a document type or UTF-16 in its part 'xl/worksheets/sheet1.xml'",
        ),
        ("xl/worksheets/sheet1.xml", b"<worksheet", b"\0<worksheet", "found a document type or UTF-16 in its part"),
    ],
)  # fmt: skip
def test_workbooks_that_no_program_writes_are_refused(tmp_path, part, old, new, words):
    path = saved(tmp_path / "t.xlsx", table=BARE)
    assert len(cf.FrequencyTable.from_csv(path)) == 3
    with_part(path, part, old, new)
    refused(path, words)


def test_a_workbook_that_unpacks_to_more_than_256_mb_is_refused_before_it_is_unpacked(tmp_path):
    path = saved(tmp_path / "t.xlsx", table=BARE)
    data = bytearray(path.read_bytes())
    at = data.index(b"PK\x01\x02") + 24  # of the first entry of the directory: its size when unpacked
    data[at : at + 4] = (300_000_000).to_bytes(4, "little")
    path.write_bytes(data)
    refused(path, "found a workbook that unpacks to 300.0")
    data[at : at + 4] = (255_000_000).to_bytes(4, "little")
    path.write_bytes(data)
    assert len(cf.FrequencyTable.from_csv(path)) == 3


STUDY = """
material = { E = 210e9, nu = 0.3, rho = 7800.0 }
chart = { kind = "frustum", r_base = 0.5, r_top = 0.5, height = 0.2 }
shell = { thickness = 3e-3 }
imperfection = [{ of = "radius", survey = "NAME", n_max = 2, degree = 0 }]
mesh = { around = 24, rows = 2 }
modes = { count = 8 }
support = { base = { kind = "clamped" } }
"""


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*mesh-coarse")
def test_the_command_line_takes_the_survey_of_a_study_from_a_sheet(tmp_path):
    points = [[t, z, 500.5 + 0.1 * (t % 90)] for z in (0, 200) for t in range(0, 360, 30)]
    ring = [["theta_deg", "z_mm", "radius_mm"], *points]
    csv_of(tmp_path / "wall.csv", ring)
    saved(tmp_path / "wall.xlsx", other=[["a"], [1]], ring=ring)

    def run(name):
        (tmp_path / "s.toml").write_text(STUDY.replace("NAME", name), encoding="utf-8")
        return CliRunner().invoke(main, ["modes", str(tmp_path / "s.toml"), "--json"])

    text, book, none = run("wall.csv"), run("wall.xlsx#ring"), run("wall.xlsx#rings")
    assert text.exit_code == book.exit_code == 0, book.output
    documents = [json.loads(found.stdout) for found in (text, book)]
    assert documents[0]["modes"] == documents[1]["modes"]
    assert none.exit_code == 2
    assert "found no sheet 'rings'; expected one of 'other', 'ring'" in none.output
