"""Set 58 line by line: where a function was measured, over what, and how its numbers stand."""

import tempfile
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.uff.test_uff_sets import raw, read, refused, whole

NOTHING = f"{whole(0)}{whole(0, 0, 0, width=5)}"  # stated of an axis
VALUES = "  1.00000E+00  2.00000E+00  3.00000E+00"


def read_function(given):
    return read(given).functions[0]


def read_function_header(given):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "f.uff"
        path.write_bytes(given if isinstance(given, bytes) else given.encode())
        return cf.uff.read_headers(path)[0]


def of_bytes(lines, payload):
    """A file of one binary function, least byte first."""
    head = f"    58b{1:6d}{2:6d}{11:12d}{len(payload):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    return "\n".join(["    -1", head, *lines, ""]).encode() + payload + b"\n    -1\n"


def function(kind=4, points=3, spacing=1, step=0.5, form=2, axis="", values=VALUES):
    record6 = (
        f"{kind:5d}{whole(7)}{whole(2, width=5)}{whole(9)} {'rim':10}{whole(12)}{whole(-3, width=4)} {'hammer':10}"
    )
    return [*"abcde", record6 + whole(1) + whole(2, width=4),
            whole(form, points, spacing) + "".join(f"{v:13.5E}" for v in (10.0, step, 4.5)),
            axis or f"{whole(18)}{whole(1, 2, 3, width=5)} {'frequency':20} Hz", *[NOTHING] * 3,
            *([values] if values else [])]  # fmt: skip


def test_a_function_states_where_it_was_measured_and_what_its_axes_show():
    found = read_function(raw("58", function()))
    assert (found.kind, found.word, found.numbers, found.z) == (4, "frequency response", (7, 2, 9), 4.5)
    assert (found.response, found.reference) == (("rim", 12, -3), ("hammer", 1, 2))
    assert found.axes.abscissa == (18, (1, 2, 3), "frequency", "Hz")
    assert (found.x.tolist(), found.values.tolist(), found.step) == ([10.0, 10.5, 11.0], [1.0, 2.0, 3.0], 0.5)
    assert found.double is False


def test_a_header_states_what_is_below_it_and_where():
    found = read_function_header(raw("58", function()))
    assert (found.kind, found.points, found.start, found.step, found.binary) == (4, 3, 10.0, 0.5, False)
    assert (found.line, found.fault) == (2, "")
    values = np.ones(3, "<f4")
    lines = function(values="", spacing=1)
    for size, whole_ in ((12, True), (8, False)):
        given = of_bytes(lines, values.tobytes()[:size])
        found = read_function_header(given)
        assert (found.points, found.binary, not found.fault) == (3, True, whole_)


def test_nothing_follows_the_direction_of_the_reference_on_its_line():
    lines = function()
    lines[5] += "   7"
    refused(read_function, raw("58", lines), "line 8, set 58 (functions): found '")


@pytest.mark.parametrize("points", [2, 3])
def test_two_points_or_more_need_a_step(points):
    wrong = raw("58", function(points=points, step=0.0))
    refused(
        read_function, wrong, "line 9, set 58 (functions): found the step 0 of an even abscissa; expected a step above"
    )


@pytest.mark.parametrize("kind", [0, 27])
def test_kinds_of_functions_go_from_0_to_27(kind):
    assert read_function(raw("58", function(kind))).kind == kind
    outside = -1 if kind == 0 else 28
    refused(
        read_function, raw("58", function(outside)), f"line 8, set 58 (functions): found function type {outside}; e"
    )


def test_a_single_point_needs_no_step_and_uneven_ones_ascend():
    one = read_function(raw("58", function(points=1, step=0.0, values="  1.00000E+00")))
    assert (one.x.tolist(), one.step) == ([10.0], 0.0)
    pairs = ["".join(f"{v:13.5E}" for v in (1.0, 7.0, x, 8.0, 2.0, 9.0)) for x in (1.5, 2.0)]
    uneven = read_function(raw("58", function(spacing=0, values=pairs[0])))
    assert (uneven.x.tolist(), uneven.values.tolist(), uneven.step) == ([1.0, 1.5, 2.0], [7.0, 8.0, 9.0], 0.0)
    words = "line 14, set 58 (functions): found 2 after 2 at point 3; expected an abscissa that ascends"
    refused(read_function, raw("58", function(spacing=0, values=pairs[1])), words)


@pytest.mark.parametrize("column", [26, 47])
def test_text_between_the_fields_of_an_axis_is_refused(column):
    axis = f"{whole(18)}{whole(1, 2, 3, width=5)} {'frequency':20} Hz"
    words = f"line 10, set 58 (functions): found 'X' in column {column}; expected a blank between names and numbers"
    refused(read_function, raw("58", function(axis=f"{axis[: column - 1]}X{axis[column:]}")), words)


@pytest.mark.parametrize(
    ("form", "kind", "bad", "point"), [(2, "<f4", np.nan, 2), (5, "<f4", np.inf, 1), (4, "<f8", np.inf, 2)]
)
def test_bytes_that_are_no_number_are_named_by_their_point(form, kind, bad, point):
    """Of three reals the second, of complex numbers the first; nan represents a complex number that is missing."""
    values = np.array([1.0, bad, 3.0, 4.0, 5.0, 6.0][: 6 if form == 5 else 3], kind)
    lines = function(form=form, values="")
    given = of_bytes(lines, values.tobytes())
    refused(read_function, given, f"found nan or infinity at point {point}; expected finite")
    if form == 5:
        values[1] = np.nan
        given = of_bytes(lines, values.tobytes())
        assert np.isnan(read_function(given).values).tolist() == [True, False, False]
