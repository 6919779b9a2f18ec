"""Where sets of universal files begin and end, what two sets of one kind make together, what is written."""

import re
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf

MARK = "    -1"


def text(*lines):
    return "\n".join([*lines, ""]).encode()


def parse_uff(data, name="f.uff", **options):
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / name).write_bytes(data)
        return cf.uff.read_uff(Path(folder) / name, **options)


@pytest.mark.parametrize("mark", ["    -1", "-1", "    -1  "])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_sets_end_at_a_mark_in_the_first_six_columns(mark, end):
    header = ["a", " b ", *"cdefg"]
    given = text("", mark, "   151", *header, mark, "", mark, "    18", "     -1", "   -1 2", mark) + b"\n"
    for data in (given.replace(b"\n", end), given.replace(b"\n", end).rstrip()):
        found = parse_uff(data)
        assert (found.header, [one.line for one in found.skipped]) == (("a", " b", *"cdefg"), [14])


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["", " "], "line 1, before the first set: found nothing; expected a universal file"),
        (["x"], "line 1, before the first set: found 'x'; expected -1 in columns 5 and 6, which opens a set"),
        (
            [MARK, "    18", "c", MARK, "y"],
            "line 4, set 18 (coordinate systems): found -1, and neither another -1 nor the",
        ),
        (
            [MARK, "  1234567", MARK],
            "line 2, before the first set: found '1234567'; expected the number of a set in colu",
        ),
        (
            [MARK, "    151", "a", MARK],
            "line 2, before the first set: found '151'; expected the number of a set in columns",
        ),
        (
            [MARK, "  2411", "c"],
            "line 3, set 2411 (nodes, double precision): found the end of the file; expected -1, the set's",
        ),
        ([MARK, "   151", *"abcdefg", MARK, "x"], "line 10, set 151 (header): found -1, and neither"),
    ],
)
def test_a_file_that_is_no_series_of_sets_is_refused_with_its_line(lines, words):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        parse_uff(text(*lines))


def test_a_mark_among_the_seven_lines_of_a_header_is_text():
    assert parse_uff(text(MARK, "   151", *"abcde", MARK, "x", MARK)).header == (*"abcde", MARK, "x")


def binary(order=1, form=2, lines=11, size=4, payload=b"abcd", behind=b"\n    -1\n", header=11):
    first = f"    58b{order:6d}{form:6d}{lines:12d}{size:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    return text(MARK, first, *["x"] * header) + payload + behind


@pytest.mark.parametrize("behind", [b"\n    -1\n", b"\r\n    -1\r\n", b"    -1\n", b"    -1"])
def test_bytes_end_at_their_mark_with_or_without_an_end_of_line(behind, tmp_path):
    values = np.array([1.0, -2.0, 3.5])
    data = cf.uff.write_uff(tmp_path / "f.uff", functions=[of_three(values)], binary=True).read_bytes()
    assert data.endswith(values.tobytes() + b"    -1\n")
    (found,) = parse_uff(data.removesuffix(b"    -1\n") + behind).functions
    assert found.values.tolist() == values.tolist()
    swapped = data.replace(values.tobytes(), values.byteswap().tobytes()).replace(b"    58b     1", b"    58b     2")
    (found,) = parse_uff(swapped.removesuffix(b"    -1\n") + behind).functions
    assert found.values.tolist() == values.tolist()


def of_three(values):
    axes = cf.uff.Axes(cf.uff.Axis(17), cf.uff.Axis())
    points = {"kind": 1, "text": (), "x": np.arange(3.0), "step": 1.0, "values": values, "double": True, "axes": axes}
    return cf.uff.Function(response=cf.uff.Channel("", 1, 1), reference=cf.uff.Channel("", 0, 0), **points)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"order": 3}, "found byte order 3; expected 1 (little endian), 2 (big end"),
        ({"form": 1}, "found floating format 1; expected 2 (IEEE 754"),
        ({"lines": 12}, "found lines of header 12; expe"),
        ({"size": 9}, "found no closing -1 behind 9 bytes of data; expected it t"),
        ({"size": 99}, "found 12 bytes of data; expected 99, as line 2 states"),
        ({"header": 10, "payload": b"", "behind": b""}, "found the end of the fil"),
        ({"payload": b"abc\n", "behind": b"    -1\n"}, "found no closing -1 behin"),
        ({"size": 3}, "found no closing -1 behind 3 bytes"),
        ({"behind": b"\n    -1\nx\n"}, "found no closing -1 behind"),
        ({"behind": b"\n  -1\n"}, "found no closing -1 behind"),
    ],
)
def test_a_binary_function_is_as_its_first_line_states(given, words):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)) as caught:
        parse_uff(binary(**given))
    assert caught.value.where == "set 58b (functions, binary)"
    assert caught.value.line == (2 if {"order", "form", "lines"} & set(given) else 13 if "header" in given else 14)


def some(labels, shift=0.0):
    labels = np.asarray(labels)
    points = np.column_stack([labels + shift, 0.5 * labels, 0.0 * labels])
    return cf.uff.Nodes(labels=labels, points=points, systems=0 * labels, motions=labels + 10)


def parsed(tmp_path, *parts, **more):
    data = b"".join(cf.uff.write_uff(tmp_path / "part.uff", **part).read_bytes() for part in parts)
    return parse_uff(data, "f.uff", **more)


def test_nodes_of_several_sets_are_all_there_once_in_their_order(tmp_path):
    found = parsed(tmp_path, {"nodes": some([4, 2])}, {"nodes": some([2, 3, 1])})
    assert found.nodes.labels.tolist() == [4, 2, 3, 1]
    assert found.nodes.motions.tolist() == [14, 12, 13, 11]
    assert found.nodes.points[:, 0].tolist() == [4.0, 2.0, 3.0, 1.0]


@pytest.mark.parametrize(("shift", "one"), [(2.9e-5, True), (3.1e-5, False)])
def test_a_node_of_two_sets_may_lie_apart_by_a_hundred_thousandth_of_the_size(shift, one, tmp_path):
    """Of 3 m, from 1 to 4."""
    parts = {"nodes": some([1, 2, 3, 4])}, {"nodes": replace(some([2]), points=np.array([[2.0 + shift, 1.0, 0.0]]))}
    if one:
        assert parsed(tmp_path, *parts).nodes.points[1].tolist() == [2.0, 1.0, 0.0]
        return
    with pytest.raises(
        cf.errors.InputError, match=r"line 14, set 2411 .*: found node 2 at another place than in the set before"
    ):
        parsed(tmp_path, *parts)


def element(label, nodes=(1, 2, 3)):
    more = {"kinds": np.array([91]), "properties": np.array([[1, 2, 7]]), "beams": np.zeros((1, 3))}
    return {"elements": cf.uff.Elements(labels=np.array([label]), nodes=(np.array(nodes),), **more)}


def test_elements_of_several_sets_are_all_there_and_none_twice(tmp_path):
    found = parsed(tmp_path, element(5), element(6, (2, 3, 1)))
    assert found.elements.labels.tolist() == [5, 6]
    assert [row.tolist() for row in found.elements.nodes] == [[1, 2, 3], [2, 3, 1]]
    with pytest.raises(
        cf.errors.InputError, match=r"line 8, set 2412 \(elements\): found element 5 again; expected labels that"
    ):
        parsed(tmp_path, element(5), element(5))


def test_a_user_of_nodes_that_are_not_there_is_named(tmp_path):
    line = {"lines": [cf.uff.TraceLine(number=1, name="rim", color=3, nodes=np.array([1, 0, 9]))]}
    assert parsed(tmp_path, line).lines[0].nodes.tolist() == [1, 0, 9]
    with pytest.raises(
        cf.errors.InputError, match=r"set 82 \(trace lines\): found node 9, not among the nodes of the file"
    ):
        parsed(tmp_path, line, {"nodes": some([1, 2, 3])})
    with pytest.raises(cf.errors.InputError, match="found node 1, not among"):
        parsed(tmp_path, line, {"nodes": some([2, 3, 9])})
    with pytest.raises(cf.errors.InputError, match="found node 8 and 1 more, not among"):
        parsed(tmp_path, element(5, (1, 9, 8)), {"nodes": some([1, 2, 3])})


def shape(nodes):
    return cf.uff.Shape(text=("a",), model=1, analysis=2, characteristic=2, quantity=8, integers=(1, 1),
                 reals=(9.0, 1.0, 0.0, 0.0), nodes=np.array(nodes), values=np.ones((len(nodes), 3)))  # fmt: skip


def test_what_appears_incomplete_is_reported(tmp_path):
    with pytest.warns(cf.errors.ModelWarning, match="f.uff: shapes at 2 to 3 nodes, expected the same.*uff-shapes"):
        parsed(tmp_path, {"shapes": [shape([1, 2]), shape([3, 1, 2])]})
    assert len(parsed(tmp_path, {"shapes": [shape([1, 2, 3]), shape([3, 1, 2])]}).shapes) == 2
    labels = [k for k in range(1, 41) if k not in (3, 5, 7, 9, 11, 13)]
    with pytest.warns(cf.errors.ModelWarning, match="f.uff: nodes 3, 5, 7, 9, 11 and 1 more missing"):
        parsed(tmp_path, {"nodes": some(labels)})
    with pytest.warns(cf.errors.ModelWarning, match="f.uff: elements 6 missing.*uff-gap"):
        parsed(tmp_path, *(element(k) for k in (4, 5, 7, 8, 9)))


def test_a_file_shows_what_it_contains(tmp_path):
    found = parsed(tmp_path, {"nodes": some([1, 2, 3])}, element(1), {"shapes": [shape([1, 2])]})
    assert found.contents == "3 nodes, 1 elements, 1 shapes"
    skipped = text(*[MARK, "    18", "c", MARK] * 2, MARK, "   757", MARK)
    found = parse_uff(skipped, "f.uff")
    assert found.contents == "2 sets 18 (coordinate systems) skipped, 1 set 757 (constraints) skipped"
    assert [each.line for each in found.skipped] == [2, 6, 10]


def test_text_is_filled_up_with_none_and_a_header_with_blank_lines(tmp_path):
    lines = cf.uff.write_uff(tmp_path / "f.uff", shapes=[shape([1])]).read_text().splitlines()
    assert lines[2:7] == ["a", "NONE", "NONE", "NONE", "NONE"]
    assert lines[7:9] == [f"{1:10d}{2:10d}{2:10d}{8:10d}{2:10d}{3:10d}", f"{2:10d}{4:10d}{1:10d}{1:10d}"]
    lines = cf.uff.write_uff(tmp_path / "f.uff", header=["x", "y"]).read_text().splitlines()
    assert lines == [MARK, "   151", "x", "y", "", "", "", "", "", MARK]
    with pytest.raises(ValueError, match="found no data"):
        cf.uff.write_uff(tmp_path / "f.uff")
    lines = (
        cf.uff.write_uff(tmp_path / "f.uff", nodes=some([7]), nodes_set="15", units=cf.uff.Units(length=2.0))
        .read_text()
        .splitlines()
    )
    assert lines[8] == f"{7:10d}{0:10d}{17:10d}{8:10d}  1.40000E+01  7.00000E+00  0.00000E+00"


@pytest.mark.parametrize(("line", "fits"), [("x" * 80, True), ("x" * 81, False), ("a\tb", False)])
def test_lines_of_text_have_80_printable_characters(line, fits, tmp_path):
    if fits:
        assert parse_uff(cf.uff.write_uff(tmp_path / "f.uff", header=[line]).read_bytes(), "f").header[0] == line
        return
    with pytest.raises(ValueError, match="does not fit into 80 columns of a universal file"):
        cf.uff.write_uff(tmp_path / "f.uff", header=[line])


@pytest.mark.parametrize(("points", "fits"), [(90_000, True), (110_000, False)])
def test_a_step_may_put_the_last_point_off_by_a_hundredth_of_itself(points, fits, tmp_path):
    """1/3 with seven digits is 1e-7 of itself off: a hundredth after 1e5 steps."""
    given = cf.uff.Function(
        kind=1, text=(), response=cf.uff.Channel("", 1, 1), reference=cf.uff.Channel("", 0, 0),
        x=np.arange(points) / 3.0,
        step=1.0 / 3.0, values=np.ones(points), double=False, axes=cf.uff.Axes(cf.uff.Axis(17), cf.uff.Axis()),
    )  # fmt: skip
    if fits:
        assert cf.uff.write_uff(tmp_path / "f.uff", functions=[given], binary=True).stat().st_size > 4 * points
        return
    with pytest.raises(ValueError, match=r"its last point would be off by 0\.011 steps"):
        cf.uff.write_uff(tmp_path / "f.uff", functions=[given], binary=True)
