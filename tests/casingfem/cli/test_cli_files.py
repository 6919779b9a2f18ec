"""What commands write and find: files of examples and new folders, tables of a key, errors."""

import pytest

import casingfem as cf


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "a.csv"),
        ({"found": "1"}, "a.csv: found 1; expected "),
        ({"expected": "2"}, "a.csv: found ; expected 2"),
        ({"line": 7, "column": "n", "where": "set 3"}, "a.csv, line 7, column 'n', set 3"),
        ({"column": "", "found": "1", "expected": "2"}, "a.csv, column '': found 1; expected 2"),
    ],
)
def test_an_error_states_only_what_is_known(given, text):
    error = cf.errors.InputError("a.csv", **given)
    assert str(error) == text
    assert {name: getattr(error, name) for name in given} == given


@pytest.mark.parametrize(
    ("message", "code"),
    [("a [study-value]", "study-value"), ("a [no-such-code]", ""), ("[study-value] a", ""), ("a", "")],
)
def test_a_code_is_at_the_end_and_in_the_catalogue(message, code):
    assert cf.errors.code_of(message) == code
    assert cf.errors.with_code("mesh-order", message) == (message if code else f"{message} [mesh-order]")


# --- watch ----------------------------------------------------------------------------------------------------


# --- schema ---------------------------------------------------------------------------------------------------
