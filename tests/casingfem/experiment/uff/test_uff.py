"""Universal files: what is written comes back, damage is refused with set and line, another reader agrees."""

import math
import re
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from reports.verification.robustness import uff_mutations
from reports.verification.robustness.uff_mutations import content
from reports.verification.robustness.uff_samples import function, nodes, samples, shape

pyuff = pytest.importorskip("pyuff")

SAMPLES = samples()


def written(tmp_path: Path, **parts) -> bytes:
    return cf.uff.write_uff(tmp_path / "file.uff", **parts).read_bytes()


def parse_uff(data: bytes, name: str, **options) -> cf.uff.UniversalFile:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / name).write_bytes(data)
        return cf.uff.read_uff(Path(folder) / name, **options)


def rounded(values: np.ndarray, digits: int) -> np.ndarray:
    """Values as a text set keeps them."""
    if np.iscomplexobj(values):
        return rounded(values.real, digits) + 1j * rounded(values.imag, digits)
    return np.array([float(f"{value:.{digits - 1}e}") for value in values.ravel()]).reshape(values.shape)


@pytest.mark.parametrize("name", SAMPLES)
def test_what_was_read_comes_back_bit_for_bit(name, tmp_path):
    parts = SAMPLES[name].parts
    first = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "first.uff", **parts))
    kept = {
        "header": first.header, "units": first.units, "nodes": first.nodes, "lines": first.lines,
        "elements": first.elements, "shapes": first.shapes, "functions": first.functions,
    }  # fmt: skip
    options = {key: parts[key] for key in ("binary", "nodes_set") if key in parts}
    again = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "again.uff", **kept, **options))
    assert content(again, text=True) == content(first, text=True)
    assert (tmp_path / "again.uff").read_bytes() == (tmp_path / "first.uff").read_bytes()


@pytest.mark.parametrize("double", [True, False])
@pytest.mark.parametrize("is_complex", [True, False])
@pytest.mark.parametrize("even", [True, False])
def test_functions_keep_the_digits_of_their_format(even, is_complex, double, tmp_path):
    given = function(even=even, is_complex=is_complex, double=double)
    (text,) = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "text.uff", functions=[given])).functions
    (binary,) = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "binary.uff", functions=[given], binary=True)).functions
    assert np.array_equal(text.values, rounded(given.values, 13 if double else 6))
    form = (np.complex128 if double else np.complex64) if is_complex else (np.float64 if double else np.float32)
    assert np.array_equal(binary.values, given.values.astype(form))
    for found in (text, binary):
        assert (found.kind, found.response, found.reference, found.axes) == (
            given.kind, given.response, given.reference, given.axes,
        )  # fmt: skip
        assert found.text == given.text
    assert np.array_equal(text.x, given.x if even else rounded(given.x, 6))


def test_an_axis_of_which_nothing_is_stated_is_unknown(tmp_path):
    """Kind 0, exponents 0 and NONE are the format's words for it."""
    given = function(even=True, is_complex=False, double=True)
    bare = replace(given, axes=cf.uff.Axes(abscissa=given.axes.abscissa, ordinate=cf.uff.Axis()))
    (line,) = (text for text in written(tmp_path, functions=[bare]).decode().splitlines()[10:11])
    assert line.split() == ["0", "0", "0", "0", "NONE", "NONE"]
    (found,) = cf.uff.read_uff(tmp_path / "file.uff").functions
    assert found.axes.denominator == found.axes.z == found.axes.ordinate == cf.uff.Axis(0, (0, 0, 0), "NONE", "NONE")


def test_geometry_and_shapes_come_back(tmp_path):
    parts = {key: value for name in ("82", "2412") for key, value in SAMPLES[name].parts.items()}
    wide = replace_labels(nodes(), 20)
    shapes = (shape(1), shape(2, is_complex=True, values=6))
    found = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "all.uff", nodes=wide, shapes=shapes, **parts))
    assert np.array_equal(found.nodes.points, wide.points)
    for given, back in zip(shapes, found.shapes, strict=True):
        assert np.array_equal(back.values, rounded(given.values, 6))
        assert back.reals == pytest.approx(given.reals, rel=1e-5)
    assert found.shapes[0].freq_hz == 367.9
    assert found.shapes[1].freq_hz == pytest.approx(np.hypot(3.1, 4623.0) / (2 * np.pi), rel=1e-6)
    assert [row.tolist() for row in found.elements.nodes] == [list(row) for row in parts["elements"].nodes]
    assert found.elements.beams[3].tolist() == [0, 1, 1]
    assert found.lines[0].nodes.tolist() == parts["lines"][0].nodes.tolist()


def replace_labels(some: cf.uff.Nodes, count: int) -> cf.uff.Nodes:
    """As many nodes as the sample elements name."""
    points = np.random.default_rng(77).normal(size=(count, 3))
    return cf.uff.Nodes(labels=np.arange(1, count + 1), points=points, systems=np.zeros(count), motions=np.zeros(count))


def test_millimetres_become_metres(tmp_path):
    units = cf.uff.Units(5, "mm (newton)", 1000.0)
    path = cf.uff.write_uff(tmp_path / "mm.uff", units=units, nodes=nodes(), nodes_set="15")
    assert b"  4.50000E+02" in path.read_bytes()
    assert cf.uff.read_uff(path).nodes.points[0] == pytest.approx([0.45, 0.0, 0.25], abs=1e-15)


@pytest.mark.parametrize("name", [name for name in SAMPLES if name[:2] in ("58", "15") and name != "151"])
def test_another_reader_finds_the_same(name, tmp_path):
    path = cf.uff.write_uff(tmp_path / "file.uff", **SAMPLES[name].parts)
    ours, theirs = cf.uff.read_uff(path), pyuff.UFF(str(path)).read_sets()
    if name == "15":
        assert np.array_equal(np.column_stack([theirs[axis] for axis in "xyz"]), ours.nodes.points)
        return
    (found,) = ours.functions
    assert np.array_equal(theirs["data"], found.values)
    assert theirs["x"] == pytest.approx(found.x, rel=1e-12)
    assert (theirs["rsp_node"], theirs["rsp_dir"], theirs["ref_node"]) == (12, -3, 1)


def test_what_another_program_writes_is_read(tmp_path):
    path = tmp_path / "theirs.uff"
    values = np.random.default_rng(78).normal(size=25) + 1j * np.arange(25)
    x = 10.0 + 0.5 * np.arange(25)
    one = pyuff.prepare_58(
        binary=0, func_type=4, rsp_node=3, rsp_dir=-2, ref_node=1, ref_dir=3, data=values, x=x, id1="id1",
        rsp_ent_name="rsp", ref_ent_name="ref", abscissa_spacing=1, abscissa_min=10.0, abscissa_inc=0.5,
        abscissa_spec_data_type=18, ordinate_spec_data_type=8, orddenom_spec_data_type=13, z_axis_value=0.0,
        load_case_id=0,
    )  # fmt: skip
    pyuff.UFF(str(path)).write_sets(one, "overwrite")
    (found,) = cf.uff.read_uff(path).functions
    assert np.array_equal(found.x, x)
    assert found.values == pytest.approx(values, rel=1e-11)
    assert (found.response.node, found.response.direction, found.reference.direction) == (3, -2, 3)


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLES)
def test_damage_is_never_silent(name, tmp_path):
    total, _ = uff_mutations.damaged(name, SAMPLES[name], uff_mutations.QUICK, tmp_path)
    assert total["SILENT"] == total["BAD MESSAGE"] == total["SLOW"] == 0
    assert total["refused"] >= 25
    assert total["same"] >= 6


def test_the_mutation_report_sees_a_reader_that_loses_points(tmp_path, monkeypatch):
    def careless(data: bytes, path: str):
        found = parse_uff(data, path)
        return replace(found, functions=tuple(replace(f, values=f.values[:-1], x=f.x[:-1]) for f in found.functions))

    monkeypatch.setattr(uff_mutations, "parse_uff", careless)
    data = written(tmp_path, **SAMPLES["58 real single even"].parts)
    assert uff_mutations.judged(data, parse_uff(data, "whole")) == "SILENT"


DAMAGED = (  # sample, what becomes what, line and finding of the error
    ("58 real single even", b"        41", b"        42", 20, "nothing in columns 66 to 78"),
    ("58 real single even", b"        41", b"        40", 20, "expected only 4 numbers on the last line of 40 points"),
    ("58 real single even", b"-8.66749E+06", b"         NaN", 14, "'NaN' in columns 1 to 13"),
    ("58 real single even", b"-8.66749E+06", b"-8.667E+9999", 14, "'-8.667E+9999'"),
    ("58 real single even", b"  2.50000E-01", b" -2.50000E-01", 9, "the step -0.25"),
    ("58 real single uneven", b"        41", b"        42", 27, "nothing in columns"),
    ("58b real double even", b"        41", b"        40", 2, "328 bytes of data; expected 320 for the 40 points"),
    ("58b real double even", b"     2          11", b"     1          11", 2, "floating format 1"),
    ("82", b"        15         8", b"        25         8", 7, "2 lines"),
    ("2412", b"         7         4", b"         7         5", 3, "5 nodes"),
    ("15", b"         2         0", b"         1         0", 4, "label 1 again"),
    ("15", b"    15\n", b"    15 nodes\n", 2, "'15 nodes'"),
    ("55", b"         8         2         3", b"         8         2         4", 8, "4 values"),
    ("164", b" 1.0000000000000000E+03", b"-1.0000000000000000E+03", 4, "the factors -1000"),
)


@pytest.mark.parametrize("case", DAMAGED)
def test_errors_name_set_line_and_what_was_found(case, tmp_path):
    name, old, new, line, found = case
    data = written(tmp_path, **SAMPLES[name].parts)
    assert old in data
    with pytest.raises(cf.errors.InputError) as caught:
        parse_uff(data.replace(old, new, 1), "rig.uff")
    assert f"rig.uff, line {line}, " in str(caught.value)
    assert found in str(caught.value)
    assert "set" in caught.value.where


def test_one_point_too_many_on_the_last_line_of_two_each(tmp_path):
    whole = function(even=False, is_complex=False, double=True)
    data = written(tmp_path, functions=[replace(whole, x=whole.x[:-1], values=whole.values[:-1])])
    assert b"        40" in data
    with pytest.raises(cf.errors.InputError, match="more than one point"):
        parse_uff(data.replace(b"        40", b"        39", 1), "rig.uff")


def test_marks_and_minus_ones_in_headers_are_text(tmp_path):
    plain = function(even=True, is_complex=True, double=False)
    odd = replace(
        plain,
        text=("    -1", "NONE    -1", "", "    -1", "x"),
        response=plain.response._replace(node=-1, direction=0),
    )
    (found,) = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "odd.uff", functions=[odd])).functions
    assert found.text == odd.text
    assert found.response == odd.response
    assert np.array_equal(found.values, rounded(odd.values, 6))


def test_minus_one_in_place_of_the_sixth_line_of_a_function_is_a_mark(tmp_path):
    """Only five lines may hold any text; the sixth holds numbers."""
    given = function(even=True, is_complex=False, double=False)
    lines = written(tmp_path, functions=[given]).split(b"\n")
    lines[7] = b"    -1"
    with pytest.raises(
        cf.errors.InputError, match=r"line 8, set 58 \(functions\).*neither another -1 nor the end of the file"
    ):
        parse_uff(b"\n".join(lines), "rig.uff")


def test_latin_and_utf_8_headers(tmp_path):
    given = function(even=True, is_complex=False, double=False)
    data = written(tmp_path, functions=[given])
    latin = data.decode("utf-8").encode("latin-1")
    assert latin != data
    for each in (data, latin):
        assert parse_uff(each, "f").functions[0].axes.ordinate.unit == "m/s²"


def test_sets_that_are_not_read_are_listed_or_refused(tmp_path):
    data = b"    -1\n    18\nanything\n    -1\n" + written(tmp_path, nodes=nodes())
    found = parse_uff(data, "rig.uff")
    assert [tuple(one) for one in found.skipped] == [("18", "coordinate systems", 2)]
    assert "1 set 18 (coordinate systems) skipped" in repr(found)
    with pytest.raises(cf.errors.InputError, match=r"line 2, set 18 \(coordinate systems\)"):
        parse_uff(data, "rig.uff", strict=True)
    with pytest.warns(cf.errors.ModelWarning, match="set 5.*uff-unknown"):
        parse_uff(data.replace(b"    18", b"     5", 1), "rig.uff")


def test_what_appears_incomplete_is_doubted(tmp_path):
    data = written(tmp_path, nodes=nodes(), nodes_set="15")
    lines = data.split(b"\n")
    with pytest.warns(cf.errors.ModelWarning, match=r"nodes 7 missing.*uff-gap"):
        parse_uff(b"\n".join(lines[:8] + lines[9:]), "f")
    shapes = written(tmp_path, shapes=(shape(1), shape(2))).split(b"\n")
    with pytest.warns(cf.errors.ModelWarning, match="uff-shapes"):
        parse_uff(b"\n".join(shapes[:-4] + shapes[-2:]), "f")
    local = data.replace(b"         1         0", b"         1         3", 1)
    with pytest.warns(cf.errors.ModelWarning, match="uff-local"):
        parse_uff(b"    -1\n    18\nanything\n    -1\n" + local, "f")


def test_references_to_missing_nodes_are_refused(tmp_path):
    with pytest.raises(cf.errors.InputError, match=r"set 2412 .*node 13 and 7 more, not among"):
        cf.uff.read_uff(cf.uff.write_uff(tmp_path / "f.uff", nodes=nodes(), **SAMPLES["2412"].parts))


def test_one_node_in_two_sets_must_lie_at_one_place(tmp_path):
    coarse, fine = written(tmp_path, nodes=nodes(), nodes_set="15"), written(tmp_path, nodes=nodes())
    assert np.array_equal(parse_uff(coarse + fine, "f").nodes.points, nodes().points)
    moved = replace(nodes(), points=nodes().points + 1e-3)
    with pytest.raises(cf.errors.InputError, match="node 1 at another place"):
        parse_uff(fine + written(tmp_path, nodes=moved, nodes_set="15"), "f")


def test_bytes_in_the_other_order_are_seen(tmp_path):
    data = written(tmp_path, functions=[function(even=True, is_complex=False, double=True)], binary=True)
    with pytest.raises(cf.errors.InputError, match="byte order"):
        parse_uff(data.replace(b"    58b     1", b"    58b     2"), "f")
    given = function(even=True, is_complex=False, double=True)
    swapped = data.replace(given.values.tobytes(), given.values.byteswap().tobytes())
    assert np.array_equal(
        parse_uff(swapped.replace(b"    58b     1", b"    58b     2"), "f").functions[0].values, given.values
    )


def test_bytes_that_would_be_nan_in_the_other_order_are_read(tmp_path):
    plain = function(even=True, is_complex=False, double=False)
    values = np.frombuffer(bytes([0x7F, 0x80, 0x01, 0x3F] * len(plain.x)), "<f4").astype(float)
    given = replace(plain, values=values)
    assert np.array_equal(
        cf.uff.read_uff(cf.uff.write_uff(tmp_path / "f.uff", functions=[given], binary=True)).functions[0].values,
        values,
    )


def test_what_a_set_has_no_room_for_is_not_written(tmp_path):
    plain = function(even=True, is_complex=False, double=False)
    long = replace(plain, step=1.0 / 3.0, x=np.arange(2.0e6) / 3.0, values=np.zeros(2_000_000))
    for bad, words in (
        (replace(plain, response=plain.response._replace(name="a name too long")), "does not fit into 10"),
        (replace(plain, response=plain.response._replace(node=10**10)), "does not fit into 10"),
        (long, "more digits than set 58 keeps"),
    ):
        with pytest.raises(ValueError, match=words):
            cf.uff.write_uff(tmp_path / "f.uff", functions=[bad])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.campaign
def test_the_report_counts_every_file(tmp_path, capsys):
    rows = uff_mutations.main(tmp_path, quick=True)
    assert {row["files"] for row in rows} == {uff_mutations.QUICK}
    assert f"{60 * len(SAMPLES)} damaged files: 0 lost data in silence" in capsys.readouterr().out
    assert (tmp_path / "uff_mutations.csv").exists()


def test_headers_are_read_where_the_numbers_are_cut_short(tmp_path):
    """A throughput file cut by its exporter: what it was is said, and why it is not read."""
    given = function(even=True, is_complex=False, double=False)
    text = written(tmp_path, functions=[given, replace(given, kind=1)]).decode()
    lines = text.splitlines(keepends=True)
    last = max(k for k, line in enumerate(lines) if line.strip() == "-1")
    (tmp_path / "cut.uff").write_text("".join(lines[: last - 1] + lines[last:]))
    whole, cut = cf.uff.read_headers(tmp_path / "cut.uff")
    assert (whole.fault, whole.points, whole.response) == ("", len(given.x), given.response)
    assert (cut.word, cut.points, cut.axes) == ("time response", len(given.x), given.axes)
    assert "found" in cut.fault
    assert f"{len(given.x)} points" in repr(cut)
    assert "not whole" in repr(cut)
    with pytest.raises(cf.errors.InputError, match=rf"points; expected .* lines|expected .*{len(given.x)} points"):
        cf.uff.read_uff(tmp_path / "cut.uff")
    (tmp_path / "bad.uff").write_text(text.replace(f"{len(given.x):10d}", f"{'x':>10}", 1))
    with pytest.raises(cf.errors.InputError, match="set 58"):
        cf.uff.read_headers(tmp_path / "bad.uff")


@pytest.mark.parametrize(
    ("analysis", "reals", "freq"),
    [
        (2, (367.9, 1.0), 367.9), (5, (41.0,), 41.0), (3, (-3.0, 4.0, 9.0), 2.5 / math.pi),
        (7, (6.0, 8.0), 5.0 / math.pi), (2, (), math.nan), (3, (4.0,), math.nan), (1, (3.0, 4.0), math.nan),
        (4, (3.0, 4.0), math.nan),
    ],
)  # fmt: skip
def test_a_shape_has_a_frequency_where_its_analysis_states_one(analysis, reals, freq):
    shape = cf.uff.Shape(
        text=("",) * 5, model=1, analysis=analysis, characteristic=3, quantity=8, integers=(), reals=reals,
        nodes=np.array([1]), values=np.zeros((1, 3)),
    )  # fmt: skip
    assert shape.freq_hz == pytest.approx(freq, rel=1e-14, nan_ok=True)


def test_exponents_without_their_letter_are_read_as_fortran_writes_them(tmp_path):
    """Three digits of an exponent take the letter's place: 1.50000+102; the sign may be left out after a letter."""
    given = function(even=True, is_complex=False, double=False)
    data = written(tmp_path, functions=[given])
    plain = parse_uff(data, "file.uff").functions[0].values
    shorter, count = re.subn(rb"(\.\d{5})E([+-])(?=\d\d)", rb"\g<1>\g<2>0", data)
    assert count >= len(plain)
    np.testing.assert_array_equal(parse_uff(shorter, "file.uff").functions[0].values, plain)
    row = b"  1.50000E+00" * 6
    mixed = written(tmp_path, functions=[replace(given, x=given.x[:6], values=np.full(6, 1.5))])
    assert row in mixed
    forms = b"  1.50000+102  1.50000-102 1.500000E002  1.50000D-02 -1.50000d+02  1.50000E+02"
    found = parse_uff(mixed.replace(row, forms), "file.uff").functions[0].values.tolist()
    assert found == [1.5e102, 1.5e-102, 150.0, 0.015, -150.0, 150.0]


def test_numbers_that_leave_a_column_free_may_have_exponents_of_three_digits(tmp_path):
    """As C's %12.5e and a blank write them; a digit that is lost before such an exponent is still seen."""
    given = replace(function(even=True, is_complex=False, double=False, points=6), values=np.full(6, 1.5))
    data = written(tmp_path, functions=[given])
    row = b"  1.50000E+00" * 6
    assert row in data
    free = data.replace(row, b" 1.50000E+00 " * 5 + b"1.50000E-100 ")
    assert parse_uff(free, "file.uff").functions[0].values.tolist() == [1.5] * 5 + [1.5e-100]
    with pytest.raises(cf.errors.InputError, match=r"' 1\.5000E-100 '.*with equal numbers of digits"):
        parse_uff(free.replace(b"1.50000E-100", b" 1.5000E-100"), "file.uff")


def test_names_and_nodes_as_wide_as_their_columns_are_side_by_side(tmp_path):
    one = replace(
        function(even=True, is_complex=True, double=True),
        response=cf.uff.Channel("ABCDEFGHIJ", 1234567890, -3), reference=cf.uff.Channel("0123456789", 2147483647, 6),
    )  # fmt: skip
    (found,) = parse_uff(written(tmp_path, functions=[one]), "file.uff").functions
    assert (found.response, found.reference) == (one.response, one.reference)


@pytest.mark.parametrize("column", [31, 56])
def test_text_between_names_and_numbers_is_refused(column, tmp_path):
    """A name that begins one column early would lose a letter."""
    data = written(tmp_path, functions=[function(even=True, is_complex=True, double=False)])
    lines = data.decode().splitlines()
    lines[7] = f"{lines[7].ljust(80)[: column - 1]}X{lines[7].ljust(80)[column:]}"
    words = rf"file\.uff, line 8.*found 'X' in column {column}; expected a blank between names and numbers"
    with pytest.raises(cf.errors.InputError, match=words):
        parse_uff("\n".join([*lines, ""]).encode(), "file.uff")


@pytest.mark.parametrize(
    ("step", "text"),
    [
        (0.25, "  2.50000E-01"),
        (0.123456789, " 1.234568E-01"),
        (2e100, " 2.00000E+100"),
    ],
)
def test_a_step_has_as_many_digits_as_leave_a_blank_before_it(step, text, tmp_path):
    given = function(even=True, is_complex=False, double=False, points=6)
    lines = written(tmp_path, functions=[replace(given, step=step, x=step * np.arange(6))]).decode().splitlines()
    assert lines[8][43:56] == text


@pytest.mark.parametrize("kept", [4, 10])
@pytest.mark.parametrize("read", [cf.uff.read_headers, cf.uff.read_uff])
def test_a_header_that_ends_early_states_how_many_lines_it_has(read, kept, tmp_path):
    path = tmp_path / "cut.uff"
    cf.uff.write_uff(path, functions=[function(even=True, is_complex=True, double=False)])
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[: 2 + kept], "    -1", ""]))
    words = rf"cut.uff, line {kept + 3}, set 58 \(functions\): found {kept} lines of header; expected 11 lines"
    with pytest.raises(cf.errors.InputError, match=words):
        read(path)
