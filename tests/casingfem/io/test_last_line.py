"""Last lines without an end: whole by what they belong to, by their columns, or by the line above; or cut short."""

import pytest

import casingfem as cf
from casingfem.io.included import check_last_line, fields, full, owner

NODES = "*NODE\n1, 0.25, 1.50\n"
GRIDS = "GRID    1               0.5     1.0     2.0\n"

WHOLE = {
    "a keyword that is not read": (True, NODES + "*BOUNDARY\n3, 1, 3"),
    "the end of a step": (True, NODES + "*END STEP"),
    "blank": (True, NODES + "   "),
    "followed by a blank": (True, NODES + "2, 0.5, 1.5 "),
    "followed by a comma": (True, NODES + "2, 0.5, 1.,"),
    "as wide as above": (True, NODES + "2, 0.5, 1.75"),
    "a card that is not read": (False, GRIDS + "PSHELL,1,1,.05,1,,1"),
    "its continuation": (False, GRIDS + "MAT1,1,2.+11\n,7800."),
    "beyond the end": (False, GRIDS + "ENDDATA\nD"),
    "a full field": (False, GRIDS + "GRID    2               0.5     1.0     -1.23456"),
    "all columns": (False, f"$\nGRID    {1:8d}{'':8s}{0.5:8.3f}{1.0:8.3f}{2.0:8.3f}{'':24s}"),
    "as wide as above in columns": (False, GRIDS + "GRID    2               0.5     1.0     3.0"),
    "as wide as above, free": (False, "GRID,1,,0.5,1.,2.5\nGRID,2,,0.5,1.,2.7"),
}
DIGITS = {
    "a shorter decimal": (True, NODES + "2, 0.5, 1.5"),
    "in columns": (False, GRIDS + "GRID    2               0.5     1.0     3."),
    "free": (False, "GRID,1,,0.5,1.,2.5\nGRID,2,,0.5,1.,2."),
}
CUT = {
    "fewer fields": (True, NODES + "2, 0.5"),
    "a shorter whole number": (True, "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 14\n2, 1, 2, 3, 1"),
    "a longer whole number": (True, "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n2, 1, 2, 3, 14"),
    "an exponent that may go on": (True, "*NODE\n1, 0., 1.5E+01\n2, 0., 1.5E+0"),
    "a decimal without its point": (True, NODES + "2, 0.5, 1"),
    "a word": (True, "*NSET, NSET=A\nBody\nTips"),
    "the first line of its keyword": (True, "*NODE\n1, 0.25, 1.50"),
    "a name that may go on": (False, GRIDS + "GRI"),
    "a keyword that may go on": (True, NODES + "*NOD"),
    "another card above": (False, "GRID,1,,0.5,1.,2.5\nCTETRA,7,1,1,2,3"),
}
READ = {"NODE", "ELEMENT", "NSET", "GRID", "CTETRA"}


@pytest.mark.parametrize("case", WHOLE)
def test_whole_lines_pass(case):
    abaqus, text = WHOLE[case]
    check_last_line(text, "a", abaqus=abaqus, read=READ)


@pytest.mark.parametrize("case", DIGITS)
def test_where_digits_may_lack_a_warning_names_the_line(case):
    abaqus, text = DIGITS[case]
    with pytest.warns(cf.errors.ModelWarning, match=r"a: found the last line, .* without an end.*mesh-last-line"):
        check_last_line(text, "a", abaqus=abaqus, read=READ)


@pytest.mark.parametrize("case", CUT)
def test_lines_that_may_be_cut_are_refused(case):
    abaqus, text = CUT[case]
    with pytest.raises(cf.errors.ModelError, match=r"a: the last line, .* has no end: cut short\?"):
        check_last_line(text, "a", abaqus=abaqus, read=READ)
    check_last_line(text + "\n", "a", abaqus=abaqus, read=READ)


def test_where_all_is_read_no_card_excuses_a_line():
    with pytest.raises(cf.errors.ModelError, match="cut short"):
        check_last_line("MAT1,1,2.+11", "a", abaqus=False, read=None)


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("1, 0.5,2.,, \t", ["1", " 0.5", "2."]),
        ("GRID,1,,0.5,", ["GRID", "1", "", "0.5"]),
        ("GRID    1               0.5     ", ["GRID", "1       ", "        ", "0.5     "]),
        ("GRID\t12\t\t0.5", ["GRID", "12      ", "        ", "0.5"]),
        ("GRID*   1                               0.5     ", ["GRID*", "1".ljust(16), " " * 16, "0.5     "]),
        ("MAT1    *       0.5", ["MAT1", "*       ", "0.5"]),
    ],
)
def test_fields_stand_between_commas_or_in_eight_or_sixteen_columns(line, found):
    assert fields(line, abaqus=False) == found
    assert fields("1, 0.5,2.,", abaqus=True) == ["1", " 0.5", "2."]


@pytest.mark.parametrize(
    ("line", "abaqus", "whole"),
    [
        ("GRID    1       -1.23456", False, True),
        ("GRID    1       -1.2345", False, False),
        ("GRID*   1               -1.234567890123", False, False),
        ("GRID*   1               -1.2345678901234", False, True),
        ("GRID*   1               -1.23456", False, False),
        ("MAT1    *       -1.23456", False, True),
        ("GRID\t1\t-1.23456", False, True),
        ("GRID,1, ", False, True),
        ("GRID,1\t", False, True),
        ("GRID,1,", False, True),
        ("GRID,1,2.", False, False),
        ("GRID,1,2.345678,-1.23456", False, False),
        ("1, 2.,-1.23456, 1.23456", True, False),
        ("12345678", True, False),
        ("1, 2.,", True, True),
    ],
)
def test_a_last_number_is_whole_where_it_fills_its_columns_or_something_follows(line, abaqus, whole):
    assert full(line, abaqus) == whole


@pytest.mark.parametrize(
    ("lines", "abaqus", "name"),
    [
        (["*Node,  NSET=a", "1, 2."], True, "NODE"),
        (["*ELEMENT  OUTPUT", "1"], True, "ELEMENT OUTPUT"),
        (["*NODE", "** *ELSET", "1"], True, "NODE"),
        (["*NODE", "*ELSE"], True, ""),
        (["*NODE", "*ELSET, A"], True, "ELSET"),
        (["1, 2."], True, ""),
        (["grid*   1", "+       2"], False, "GRID"),
        (["GRID,1", "MAT1,1"], False, "MAT1"),
        (["GRID,1", "MAT1"], False, ""),
        (["GRID,1", "MAT1    "], False, "MAT1"),
        (["ENDDATA", "GRID,1"], False, "ENDDATA"),
        (["1", "+"], False, ""),
        ([" *NODE", "1"], True, "NODE"),
    ],
)
def test_a_last_line_belongs_to_the_keyword_or_card_above_unless_that_may_be_cut(lines, abaqus, name):
    assert owner(lines, abaqus) == name


@pytest.mark.parametrize(("columns", "whole"), [(72, True), (71, False)])
def test_a_card_that_reaches_column_72_is_whole(columns, whole):
    text = "$\n" + "GRID    1".ljust(columns - 2) + "x2"
    if whole:
        check_last_line(text, "a", abaqus=False, read=READ)
        return
    with pytest.raises(cf.errors.ModelError, match="cut short"):
        check_last_line(text, "a", abaqus=False, read=READ)
