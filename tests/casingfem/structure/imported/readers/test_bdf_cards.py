"""Fields of Nastran's cards in three widths, continuations, and the bounds of their numbers."""

import pytest

import casingfem as cf
from casingfem.structure.imported.readers.bdf_cards import Card, Numbers, cards, split_line

CARD = Card("7", "GRID", [])


def numbered(text):
    return [(str(k), line) for k, line in enumerate(text.splitlines(), 1)]


def taken(text):
    return [(card.line, card.name, card.fields, card.room) for card in cards(numbered(text))]


@pytest.mark.parametrize(
    ("line", "head", "fields"),
    [
        ("AB,1,2,3,4,5,6,7,8,9", "AB", list("12345678")),
        ("AB*, 1,2 ,3,4,5", "AB*", list("1234")),
        ("*,1,2,3,4,5", "*", list("1234")),
        ("ABCDEFGH1       2       3       4       5       6       7       8       9", "ABCDEFGH", list("12345678")),
        ("AB*     1               2               3               4               5", "AB*", list("1234")),
        ("AB      1      *2", "AB", ["1      *", "2"]),  # no large fields: the star is no part of the name
        ("AB\t1\t\t3", "AB", ["1", "", "3"]),
        ("AB      1", "AB", ["1"]),
        ("AB", "AB", []),
        ("AB,,,", "AB", ["", "", ""]),
        ("        12345678ABCDEFGH", "", ["12345678", "ABCDEFGH"]),
        ("        1234567890ABCDEFX", "", ["12345678", "90ABCDEF", "X"]),
        ("*       1234567890ABCDEFX", "*", ["1234567890ABCDEF", "X"]),
    ],
)
def test_fields_of_a_line(line, head, fields):
    found, data = split_line(line)
    assert (found, data) == (head, [field.strip() for field in fields])


def test_cards_go_on_in_fields_of_their_lines():
    """Fields that a line leaves blank at its end stand between those before and those after."""
    text = "AB      1       2\n+       9\nCD*     1\n*       5               6\nEF,1\n,2\n+A,3\n*B,4"
    assert taken(text) == [
        ("1", "AB", ["1", "2", *[""] * 6, "9"], 16),
        ("3", "CD", ["1", "", "", "", "5", "6"], 8),
        ("5", "EF", ["1", *[""] * 7, "2", *[""] * 7, "3", *[""] * 7, "4"], 28),
    ]


def test_bulk_data_stand_between_their_words_and_comments_are_none():
    text = "ZZ,1\n begin  bulk\n$AB,7\nAB,1$,2\n\n   $\n ab,3\nEnddata x\nAB,9"
    assert taken(text) == [("4", "AB", ["1"], 8), ("7", "AB", ["3"], 8)]


def test_without_a_word_all_lines_are_bulk_data_and_none_may_be_there():
    assert taken("AB,1\nAB,2") == [("1", "AB", ["1"], 8), ("2", "AB", ["2"], 8)]
    assert taken("") == taken("BEGIN BULK") == taken("ENDDATA\nAB,1") == []


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("", 0.0), ("1.5", 1.5), ("1.5-3", 1.5e-3), ("1.5+3", 1500.0), ("-1.5-3", -1.5e-3), ("1.5D-3", 1.5e-3),
        ("1.5d-3", 1.5e-3), ("1.5e2", 150.0), ("1.5E2", 150.0), ("2", 2.0), (".5+1", 5.0), ("9.9e99", 9.9e99),
        ("-9.9+99", -9.9e99),
    ],
)  # fmt: skip
def test_real_numbers_in_nastrans_ways(text, value):
    assert Numbers("a.bdf").real(CARD, text) == value


@pytest.mark.parametrize("text", ["x", "1e100", "-1e100", "nan", "inf", "1.5-3-3", "1.+", "--1"])
def test_what_is_no_real_number_is_refused(text):
    with pytest.raises(
        cf.errors.ModelError, match=rf"a.bdf: line 7: GRID: found '{text}', expected a real number".replace("+", r"\+")
    ):
        Numbers("a.bdf").real(CARD, text)


def test_whole_numbers_have_eight_digits():
    numbers = Numbers("a.bdf")
    assert [numbers.integer(CARD, text) for text in ("99999999", "-99999999", " 7 ")] == [99999999, -99999999, 7]
    for text in ("100000000", "-100000000"):
        with pytest.raises(
            cf.errors.ModelError, match=f"line 7: GRID: found '{text}', expected a number of at most eight digits"
        ):
            numbers.integer(CARD, text)
    for text in ("", "1.", "x"):
        with pytest.raises(cf.errors.ModelError, match=f"line 7: GRID: found '{text}', expected a whole number"):
            numbers.integer(CARD, text)


def test_what_is_left_out_is_kept_with_its_lines():
    numbers = Numbers("a.bdf")
    for line, what in (("3", "CGAP"), ("5", "MPC"), ("9", "CGAP")):
        numbers.leave_out(Card(line, what, []), what)
    assert numbers.left_out == {"CGAP": ["3", "9"], "MPC": ["5"]}
