"""Last lines without an end: whole by what they belong to, by their columns, or by the line above; or cut short."""

import pytest

from casingfem.errors import ModelError, ModelWarning
from casingfem.io.last_line import check_last_line

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
    with pytest.warns(ModelWarning, match=r"a: found the last line, .* without an end.*mesh-last-line"):
        check_last_line(text, "a", abaqus=abaqus, read=READ)


@pytest.mark.parametrize("case", CUT)
def test_lines_that_may_be_cut_are_refused(case):
    abaqus, text = CUT[case]
    with pytest.raises(ModelError, match=r"a: the last line, .* has no end: cut short\?"):
        check_last_line(text, "a", abaqus=abaqus, read=READ)
    check_last_line(text + "\n", "a", abaqus=abaqus, read=READ)


def test_where_all_is_read_no_card_excuses_a_line():
    with pytest.raises(ModelError, match="cut short"):
        check_last_line("MAT1,1,2.+11", "a", abaqus=False, read=None)
