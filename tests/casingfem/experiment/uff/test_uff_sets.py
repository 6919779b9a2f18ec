"""Sets of universal files line by line: how many nodes, values, numbers each may have, and where they stand."""

import re

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.uff.nodes import read_elements, read_nodes, read_trace_line, read_units
from casingfem.experiment.uff.numbers import Columns, integers, reals, series
from casingfem.experiment.uff.read import few_gaps
from casingfem.experiment.uff.set_55 import read_shape
from casingfem.experiment.uff.split import RawSet


def raw(number, lines, **more):
    """A set whose first line is line 3 of its file."""
    return RawSet(path="f.uff", number=number, lines=tuple(lines), first=3, **more)


def whole(*values, width=10):
    return "".join(f"{value:{width}d}" for value in values)


def rows(values, each, form="10d"):
    cells = [f"{value:{form}}" for value in values]
    return ["".join(cells[k : k + each]) for k in range(0, len(cells), each)]


def refused(call, given, words):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        call(given)


NODES = {  # beams; plane stress, plane strain, thin shells; solids (SDRC's format 2412)
    11: 2, 21: 2, 22: 2, 41: 3, 42: 6, 44: 4, 45: 8, 51: 3, 52: 6, 54: 4, 55: 8, 91: 3, 92: 6, 94: 4, 95: 8,
    111: 4, 112: 6, 113: 15, 115: 8, 116: 20, 118: 10,
}  # fmt: skip


def element(kind, count, label=7):
    beam = [whole(5, 6, 4)] if kind in (11, 21, 22, 23, 24) else []
    return [whole(label, kind, 1, 2, 3, count), *beam, *rows(range(11, 11 + count), 8)]


@pytest.mark.parametrize("kind", [*NODES, 23, 24, 25, 43])
def test_an_element_has_the_nodes_of_its_kind_and_a_beam_a_line_more(kind):
    count = NODES.get(kind, 9)
    found = read_elements(raw("2412", [*element(kind, count), *element(94, 4, 8)]))
    assert found.labels.tolist() == [7, 8]
    assert found.kinds.tolist() == [kind, 94]
    assert found.properties[0].tolist() == [1, 2, 3]
    assert [row.tolist() for row in found.nodes] == [list(range(11, 11 + count)), [11, 12, 13, 14]]
    assert not any(row.flags.writeable for row in found.nodes)
    beam = kind in (11, 21, 22, 23, 24)
    assert found.beams.tolist() == [[5, 6, 4] if beam else [0, 0, 0], [0, 0, 0]]
    if kind in NODES:
        for other in (count - 1, count + 1):
            words = f"line 3, set 2412 (elements): found {other} nodes; expected {count} for descriptor {kind}"
            refused(read_elements, raw("2412", element(kind, other)), words)


def test_elements_have_nodes_from_1_and_end_where_they_say():
    lines = [*element(94, 4, 6), *element(94, 4)]
    zero = [*lines[:3], whole(11, 12, 0, 14)]
    refused(read_elements, raw("2412", zero), "line 6, set 2412 (elements): found node 0; expected nodes from 1")
    refused(read_elements, raw("2412", [*lines[:2], lines[0], lines[3]]), "line 5, set 2412 (elements): found label 6")
    refused(read_elements, raw("2412", ["", " "]), "line 3, set 2412 (elements): found an empty set")
    assert read_elements(raw("2412", [*lines, "", " "])).labels.tolist() == [6, 7]


def test_nodes_of_both_sets_have_labels_systems_and_points():
    points = np.array([[1.5, -2.0, 3.0], [0.25, 0.5, -0.125]])
    heads = [whole(4, 1, 2, 8), whole(9, 0, 3, 8)]
    single = [head + "".join(f"{v:13.5E}" for v in point) for head, point in zip(heads, points, strict=True)]
    double = [line for head, point in zip(heads, points, strict=True)
              for line in (head, "".join(f"{v:25.16E}" for v in point))]  # fmt: skip
    units = read_units(raw("164", [whole(5) + f"{'mm':20}" + whole(2), "".join(f"{v:25.16E}" for v in (2.0, 3.0, 4.0)),
                                   f"{273.0:25.16E}"]))  # fmt: skip
    assert units == (5, "mm", 2.0, 3.0, 4.0, 273.0)
    for found in (read_nodes(raw("15", single), units), read_nodes(raw("2411", [*double, ""]), units)):
        assert found.points.tolist() == (points / 2.0).tolist()
        assert (found.labels.tolist(), found.systems.tolist(), found.motions.tolist()) == ([4, 9], [1, 0], [2, 3])
    refused(lambda given: read_nodes(given, units), raw("2411", double[:3]), "line 6, set 2411 (nodes, double precision"
            "): found a node without coordinates")  # fmt: skip
    refused(
        lambda given: read_nodes(given, units), raw("15", single[:1] * 2), "line 4, set 15 (nodes): found label 4 a"
    )


@pytest.mark.parametrize("k", range(3))
def test_each_factor_of_the_units_is_above_0(k):
    factors = [1.0, 2.0, 3.0]
    factors[k] = 0.0
    lines = [whole(1) + "SI", "".join(f"{v:25.16E}" for v in factors), f"{0.0:25.16E}"]
    refused(read_units, raw("164", lines), "line 4, set 164 (units): found the factors")


@pytest.mark.parametrize("count", [7, 8, 9, 17])
def test_zeros_may_fill_the_last_line_of_a_trace_line_and_nothing_else(count):
    nodes = [*range(1, count), 0]
    full = -(-count // 8) * 8
    for zeros in range(full - count + 1):
        found = read_trace_line(raw("82", [whole(1, count, 3), "rim", *rows([*nodes, *[0] * zeros], 8)]))
        assert found.nodes.tolist() == nodes
        assert (found.number, found.name, found.color) == (1, "rim", 3)
    if full > count:
        lines = [whole(1, count, 3), "rim", *rows([*nodes, 5], 8)]
        refused(read_trace_line, raw("82", lines), f"line {len(lines) + 2}, set 82 (trace lines): found nodes beyond")
    lines = [whole(1, count, 3), "rim", *rows([*nodes[:-1], -4], 8)]
    refused(read_trace_line, raw("82", lines), f"line {len(lines) + 2}, set 82 (trace lines): found node -4")


def shape(
    analysis=2, characteristic=3, form=2, count=6, whole_numbers=(1, 4), numbers=(9.5, 1.0, 0.5, 0.25), nodes=(3, 8)
):
    each = count * (2 if form == 5 else 1)
    lines = ["a", "b", "", "d", "e", whole(1, analysis, characteristic, 8, form, count)]
    lines += [whole(len(whole_numbers), len(numbers), *whole_numbers), *(rows(numbers, 6, "13.5E") or [""])]
    for k, node in enumerate(nodes):
        lines += [whole(node), *rows(np.arange(each) + 100.0 * k, 6, "13.5E")]
    return raw("55", lines)


@pytest.mark.parametrize(("characteristic", "count"), [(1, 1), (2, 3), (3, 6), (4, 6), (5, 9), (0, 7), (6, 2)])
@pytest.mark.parametrize("form", [2, 5])
def test_a_shape_has_as_many_values_a_node_as_its_characteristic(characteristic, count, form):
    found = read_shape(shape(characteristic=characteristic, count=count, form=form))
    plain = np.arange(count * (2 if form == 5 else 1))[None] + np.array([[0.0], [100.0]])
    exact = plain[:, ::2] + 1j * plain[:, 1::2] if form == 5 else plain
    np.testing.assert_array_equal(found.values, exact)
    assert found.nodes.tolist() == [3, 8]
    assert (found.model, found.analysis, found.characteristic, found.quantity) == (1, 2, characteristic, 8)
    assert (found.text, found.integers, found.reals) == (("a", "b", "", "d", "e"), (1, 4), (9.5, 1.0, 0.5, 0.25))
    if characteristic in range(1, 6):
        wrong = shape(characteristic=characteristic, count=count + 1, form=form)
        refused(read_shape, wrong, f"found {count + 1} values a node; expected {count}, by data characteristic")


@pytest.mark.parametrize(("analysis", "least"), [(2, (2, 4)), (3, (2, 6)), (5, (2, 1)), (7, (2, 6)), (1, (0, 0))])
def test_an_analysis_has_its_numbers_at_least(analysis, least):
    many, count = least
    found = read_shape(shape(analysis, whole_numbers=range(many), numbers=np.arange(count)))
    assert (found.integers, found.reals) == (tuple(range(many)), tuple(range(count)))
    words = (
        f"line 9, set 55 (shapes at nodes): found {{}} integers and {{}} reals; expected at least {many} and {count} f"
    )
    if many:
        wrong = shape(analysis, whole_numbers=range(many - 1), numbers=np.arange(count))
        refused(read_shape, wrong, words.format(many - 1, count))
    if count:
        wrong = shape(analysis, whole_numbers=range(many), numbers=np.arange(count - 1))
        refused(read_shape, wrong, words.format(many, count - 1))


def test_a_shape_may_have_six_integers_and_twelve_reals():
    found = read_shape(shape(whole_numbers=range(6), numbers=np.arange(12.0)))
    assert (found.integers, found.reals) == (tuple(range(6)), tuple(range(12)))
    assert found.values.shape == (2, 6)


def test_nodes_of_a_shape_stand_once_and_whole():
    refused(
        read_shape, shape(nodes=(3, 8, 3)), "line 15, set 55 (shapes at nodes): found node 3; expected nodes from 1, e"
    )
    refused(
        read_shape, shape(nodes=(3, 0)), "line 13, set 55 (shapes at nodes): found node 0; expected nodes from 1, each"
    )
    refused(read_shape, shape(nodes=()), "line 11, set 55 (shapes at nodes): found no values")
    cut = shape()
    refused(
        read_shape, raw("55", cut.lines[:-1]), "line 13, set 55 (shapes at nodes): found 3 lines of values; expected 2"
    )
    assert read_shape(raw("55", [*cut.lines, "  "])).nodes.tolist() == [3, 8]


def test_whole_numbers_stand_flush_right_in_their_columns():
    columns = Columns(2, 4, 3)
    assert integers(raw("82", ["ab  12  +3  -4"]), [0], columns).tolist() == [[12, 3, -4]]
    assert integers(raw("82", ["ab  12  +3  -4 "]), [0], columns).tolist() == [[12, 3, -4]]
    assert integers(raw("82", ["ab  12   3   4x"]), [0], columns, last=False).tolist() == [[12, 3, 4]]
    for line, words in (
        ("ab  12 3   -4", "line 3, set 82 (trace lines): found '3' in columns 7 to 10; expected a whole number, flush"),
        ("ab  12 1.5  -4", "found '1.5' in columns 7 to 10"), ("ab  12", "found nothing in columns 7 to 10"),
        ("ab  12   3   4 x", "found ' x'; expected nothing beyond column 14".replace("' x'", "'x'")),
    ):  # fmt: skip
        refused(lambda given: integers(given, [0], columns), raw("82", [line]), words)
    long = Columns(0, 25, 1)
    assert integers(raw("82", [f"{2**63 - 1:25d}"]), [0], long).tolist() == [[2**63 - 1]]
    refused(lambda given: integers(given, [0], long), raw("82", [f"{2**63:25d}"]), "found a number that is too large")


@pytest.mark.parametrize("count", [4, 5, 7, 8])
def test_a_series_takes_as_many_numbers_as_are_asked_for_and_no_others(count):
    columns, values = Columns(0, 10, 4), np.arange(5, 5 + count)
    lines = ["above", *rows(values, 4)]
    assert series(raw("82", lines), 1, count, columns, integers, "nodes").tolist() == values.tolist()
    refused(
        lambda given: series(given, 1, count + 4, columns, integers, "nodes"),
        raw("82", lines),
        f"line {3 + len(lines)}, set 82 (trace lines): found {len(lines) - 1} lines of nodes; expected {len(lines)} l",
    )
    if count % 4:
        more = [*lines[:-1], lines[-1] + whole(99)]
        words = "found '99'; expected " + (
            f"{count % 4} numbers on the last line of nodes" if count > 4 else "nothing be"
        )
        refused(lambda given: series(given, 1, count, columns, integers, "nodes"), raw("82", more), words)


def test_a_single_short_line_is_a_series_too():
    assert series(raw("82", [whole(7, 9)]), 0, 2, Columns(0, 10, 8), integers, "nodes").tolist() == [7, 9]
    refused(lambda given: series(given, 0, 2, Columns(0, 10, 8), integers, "nodes"), raw("82", [whole(7, 9, 1)]),
            "found '1'; expected nothing beyond column 20")  # fmt: skip


def test_reals_are_finite_and_end_in_one_column():
    columns = Columns(0, 13, 2)
    assert reals(raw("55", ["  1.50000E+00 -2.50000D-01"]), [0], columns).tolist() == [[1.5, -0.25]]
    for line, words in (
        ("  1.50000E+00  9.9E+99999", "expected a finite number"),
        ("  1.50000E+00", "found nothing in columns 14 to 26"),
        ("  1.50000E+00 -2.50000E-0 ", "numbers that end in one column of their fields, with as many digits each"),
        ("  1.50000E+00          NaN", "found 'NaN' in columns 14 to 26"),
    ):  # fmt: skip
        refused(lambda given: reals(given, [0], columns), raw("55", [line]), words)


@pytest.mark.parametrize(
    ("labels", "gaps"),
    [
        ([*range(1, 9), 11], [9, 10]), ([*range(1, 8), 10], []), ([*range(3, 12)], [1, 2]), ([*range(3, 11)], []),
        ([1, 2, 3, 4, 6], [5]), ([1, 2, 3, 5], []),
    ],
)  # fmt: skip
def test_numbers_are_left_out_where_they_are_fewer_than_a_quarter_of_those_there(labels, gaps):
    assert few_gaps(np.array(labels)).tolist() == gaps
