"""Sets of universal files line by line: how many nodes, values, numbers each may have, and where they are."""

import re
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf


def raw(number, lines):
    """A file of one set, whose first line is line 3."""
    return "\n".join(["    -1", f"{number:>6}", *lines, "    -1", ""])


def read(given):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "f.uff"
        path.write_bytes(given if isinstance(given, bytes) else given.encode())
        return cf.uff.read_uff(path)


def read_elements(given):
    return read(given).elements


def read_trace_line(given):
    return read(given).lines[0]


def read_shape(given):
    return read(given).shapes[0]


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


def test_elements_have_nodes_from_1_and_end_where_they_state():
    lines = [*element(94, 4, 6), *element(94, 4)]
    zero = [*lines[:3], whole(11, 12, 0, 14)]
    refused(read_elements, raw("2412", zero), "line 6, set 2412 (elements): found node 0; expected nodes from 1")
    refused(read_elements, raw("2412", [*lines[:2], lines[0], lines[3]]), "line 5, set 2412 (elements): found label 6")
    assert read_elements(raw("2412", [*lines, "", " "])).labels.tolist() == [6, 7]


def test_nodes_of_both_sets_have_labels_systems_and_points():
    points = np.array([[1.5, -2.0, 3.0], [0.25, 0.5, -0.125]])
    heads = [whole(4, 1, 2, 8), whole(9, 0, 3, 8)]
    single = [head + "".join(f"{v:13.5E}" for v in point) for head, point in zip(heads, points, strict=True)]
    double = [line for head, point in zip(heads, points, strict=True)
              for line in (head, "".join(f"{v:25.16E}" for v in point))]  # fmt: skip
    units = raw("164", [whole(5) + f"{'mm':20}" + whole(2), "".join(f"{v:25.16E}" for v in (2.0, 3.0, 4.0)),
                        f"{273.0:25.16E}"])  # fmt: skip
    assert read(units).units == (5, "mm", 2.0, 3.0, 4.0, 273.0)
    for found in (read(units + raw("15", single)).nodes, read(units + raw("2411", [*double, ""])).nodes):
        assert found.points.tolist() == (points / 2.0).tolist()
        assert (found.labels.tolist(), found.systems.tolist(), found.motions.tolist()) == ([4, 9], [1, 0], [2, 3])
    refused(read, raw("2411", double[:3]), "line 6, set 2411 (nodes, double precision): found a node without coordin")
    refused(read, raw("15", single[:1] * 2), "line 4, set 15 (nodes): found label 4 a")


@pytest.mark.parametrize("k", range(3))
def test_each_factor_of_the_units_is_above_0(k):
    factors = [1.0, 2.0, 3.0]
    factors[k] = 0.0
    lines = [whole(1) + "SI", "".join(f"{v:25.16E}" for v in factors), f"{0.0:25.16E}"]
    refused(read, raw("164", lines), "line 4, set 164 (units): found the factors")


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
    return lines


def of_shape(*args, **options):
    return raw("55", shape(*args, **options))


@pytest.mark.parametrize(("characteristic", "count"), [(1, 1), (2, 3), (3, 6), (4, 6), (5, 9), (0, 7), (6, 2)])
@pytest.mark.parametrize("form", [2, 5])
def test_a_shape_has_as_many_values_a_node_as_its_characteristic(characteristic, count, form):
    found = read_shape(of_shape(characteristic=characteristic, count=count, form=form))
    plain = np.arange(count * (2 if form == 5 else 1))[None] + np.array([[0.0], [100.0]])
    exact = plain[:, ::2] + 1j * plain[:, 1::2] if form == 5 else plain
    np.testing.assert_array_equal(found.values, exact)
    assert found.nodes.tolist() == [3, 8]
    assert (found.model, found.analysis, found.characteristic, found.quantity) == (1, 2, characteristic, 8)
    assert (found.text, found.integers, found.reals) == (("a", "b", "", "d", "e"), (1, 4), (9.5, 1.0, 0.5, 0.25))
    if characteristic in range(1, 6):
        wrong = shape(characteristic=characteristic, count=count + 1, form=form)
        refused(
            read_shape, raw("55", wrong), f"found {count + 1} values a node; expected {count}, by data characteristic"
        )


@pytest.mark.parametrize(("analysis", "least"), [(2, (2, 4)), (3, (2, 6)), (5, (2, 1)), (7, (2, 6)), (1, (0, 0))])
def test_an_analysis_has_its_numbers_at_least(analysis, least):
    many, count = least
    found = read_shape(of_shape(analysis, whole_numbers=range(many), numbers=np.arange(count)))
    assert (found.integers, found.reals) == (tuple(range(many)), tuple(range(count)))
    words = (
        f"line 9, set 55 (shapes at nodes): found {{}} integers and {{}} reals; expected at least {many} and {count} f"
    )
    if many:
        wrong = shape(analysis, whole_numbers=range(many - 1), numbers=np.arange(count))
        refused(read_shape, raw("55", wrong), words.format(many - 1, count))
    if count:
        wrong = shape(analysis, whole_numbers=range(many), numbers=np.arange(count - 1))
        refused(read_shape, raw("55", wrong), words.format(many, count - 1))


def test_a_shape_may_have_six_integers_and_twelve_reals():
    found = read_shape(of_shape(whole_numbers=range(6), numbers=np.arange(12.0)))
    assert (found.integers, found.reals) == (tuple(range(6)), tuple(range(12)))
    assert found.values.shape == (2, 6)


def test_nodes_of_a_shape_are_once_and_whole():
    refused(
        read_shape,
        of_shape(nodes=(3, 8, 3)),
        "line 15, set 55 (shapes at nodes): found node 3; expected nodes from 1, e",
    )
    refused(
        read_shape,
        of_shape(nodes=(3, 0)),
        "line 13, set 55 (shapes at nodes): found node 0; expected nodes from 1, each",
    )
    refused(read_shape, of_shape(nodes=()), "line 11, set 55 (shapes at nodes): found no values")
    cut = shape()
    refused(read_shape, raw("55", cut[:-1]), "line 13, set 55 (shapes at nodes): found 3 lines of values; expected 2")
    assert read_shape(raw("55", [*cut, "  "])).nodes.tolist() == [3, 8]


@pytest.mark.parametrize(
    ("labels", "gaps"),
    [
        ([*range(1, 9), 11], [9, 10]), ([*range(1, 8), 10], []), ([*range(3, 12)], [1, 2]), ([*range(3, 11)], []),
        ([1, 2, 3, 4, 6], [5]), ([1, 2, 3, 5], []),
    ],
)  # fmt: skip
def test_numbers_are_left_out_where_they_are_fewer_than_a_quarter_of_those_there(labels, gaps):
    nodes = [whole(label, 0, 0, 8) + "".join(f"{label + v:13.5E}" for v in (0.5, 0.25, 0.0)) for label in labels]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert read(raw("15", nodes)).nodes.labels.tolist() == labels
    found = [str(w.message) for w in caught]
    assert len(found) == (len(gaps) > 0)
    assert all(f"nodes {', '.join(map(str, gaps))} missing" in words for words in found)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"{1:10d} 3         {3:9d}", "line 3, set 82 (trace lines): found '3' in columns 11 to 20; expected a whole"),
        (f"{1:10d}{1.5:10}{3:10d}", "found '1.5' in columns 11 to 20"),
        (f"{1:10d}{3:10d}", "found nothing in columns 21 to 30"),
        (f"{1:10d}{3:10d}{3:10d} x", "found 'x'; expected no text beyond column 30"),
    ],
)
def test_whole_numbers_are_flush_right_in_their_columns(line, words):
    refused(read, raw("82", [line, "rim", whole(1, 2, 3)]), words)
