"""Sets of functions and their channels: abscissas, units, places, forms, each refusal in words."""

from dataclasses import replace

import numpy as np
import pytest
from openpyxl import Workbook

import casingfem as cf


def frfs(**changes):
    given = {"kind": "frf", "x": [10.0, 20.0, 40.0], "responses": [[1.0, 2.0, 3.0j]], "unit": "m/N"}
    return cf.frf.FrfSet.from_arrays(**given | changes)


def test_places_of_one_number_are_those_of_every_channel_and_0_if_nothing_is_stated():
    found = frfs(responses=np.ones((2, 3)), response_point=7, reference_direction=[1, -2])
    assert found.response_point.tolist() == [7, 7]
    assert found.reference_direction.tolist() == [1, -2]
    assert found.response_direction.tolist() == found.reference_point.tolist() == [0, 0]
    assert (found.card, found.path, len(found)) == ((), "functions", 2)
    assert found.responses.dtype == complex
    assert frfs(kind="time", responses=[1, 2, 3]).responses.dtype == float
    assert not found.x.flags.writeable


@pytest.mark.parametrize(("value", "whole"), [(3.0, True), (3.5, False), (9e14, True), (1e15, False), (np.nan, False)])
def test_places_are_whole_numbers(value, whole):
    if whole:
        assert frfs(response_point=np.array([value])).response_point.tolist() == [int(value)]
        return
    with pytest.raises(
        cf.errors.InputError, match="found response_point that are not whole numbers; expected those of points"
    ):
        frfs(response_point=np.array([value]))


def test_which_numbers_are_none_is_counted():
    bad = np.ones((3, 3))
    bad[0, 1] = bad[2, 1] = bad[2, 2] = np.inf
    with pytest.raises(
        cf.errors.InputError, match="infinity in 2 of 3 channels, on 2 of 3 lines, first at 20; expected finite"
    ):
        frfs(responses=bad)


@pytest.mark.parametrize(
    ("x", "step"),
    [
        ([10.0, 10.5, 11.0], 0.5), ([10.0, 20.0, 40.0], 0.0), ([10.0], 0.0),
        (0.25 * np.array([0, 1, 2 + 0.9e-9]), 0.25),
        (0.25 * np.array([0, 1, 2 + 1.1e-9]), 0.0), (40.0 * np.array([0, 1, 2 + 1.1e-9]), 0.0),
    ],
)  # fmt: skip
def test_an_abscissa_is_even_where_its_steps_are_to_a_billionth(x, step):
    (found,) = frfs(x=x, responses=np.ones((1, len(x)))).functions()
    assert found.step == pytest.approx(step, rel=1e-8)
    assert found.double
    assert not frfs(x=x, responses=np.ones((1, len(x)))).functions(double=False)[0].double


@pytest.mark.parametrize(
    ("kind", "number", "axis"),
    [("frf", 4, (18, "frequency", "Hz")), ("spectrum", 12, (18, "frequency", "Hz")), ("time", 1, (17, "time", "s"))],
)
def test_functions_state_their_kind_their_places_and_their_axes(kind, number, axis):
    first, second = frfs(
        kind=kind, responses=[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], response_point=[3, 4], response_direction=[-1, 2],
        reference_point=[5, 6], reference_direction=[3, -3],
    ).functions()  # fmt: skip
    assert (first.kind, second.kind) == (number, number)
    assert (first.response, first.reference) == (("", 3, -1), ("", 5, 3))
    assert (second.response, second.reference) == (("", 4, 2), ("", 6, -3))
    for each, values in ((first, [1.0, 2.0, 3.0]), (second, [4.0, 5.0, 6.0])):
        assert (each.axes.abscissa.kind, each.axes.abscissa.label, each.axes.abscissa.unit) == axis
        assert each.axes.ordinate == cf.uff.Axis(label="response", unit="m/N")
        assert (each.x.tolist(), each.values.tolist()) == ([10.0, 20.0, 40.0], values)


@pytest.mark.parametrize(
    ("above", "below", "unit"),
    [("m/s^2", "N", "(m/s^2)/(N)"), ("m", "NONE", "m"), ("None", "N", "(1)/(N)"), ("NONE", "none", ""), ("", "", "")],
)
def test_a_unit_is_that_of_the_ordinate_over_its_denominator(above, below, unit):
    (function,) = frfs().functions()
    axes = function.axes._replace(ordinate=cf.uff.Axis(unit=above), denominator=cf.uff.Axis(unit=below))
    assert cf.frf.FrfSet.from_functions([replace(function, axes=axes)], "frf").unit == unit


CODES = {
    2: "stress", 3: "strain", 5: "temperature", 6: "heat flux", 8: "displacement", 9: "reaction force", 11: "velocity",
    12: "acceleration", 13: "excitation force", 15: "pressure", 16: "mass", 17: "time", 18: "frequency", 19: "rpm",
    20: "order", 21: "sound pressure", 22: "sound intensity", 23: "sound power", 99: "code 99", 1: "unknown",
}  # fmt: skip


@pytest.mark.parametrize("code", CODES)
def test_a_function_without_a_unit_states_its_quantities_by_the_codes_of_data_set_58(code):
    (function,) = frfs().functions()
    for above, below, unit in (
        (code, 3, f"{CODES[code]}/strain"), (3, code, f"strain/{CODES[code]}" if code != 1 else "strain"),
    ):  # fmt: skip
        axes = function.axes._replace(ordinate=cf.uff.Axis(above), denominator=cf.uff.Axis(below))
        found = cf.frf.FrfSet.from_functions([replace(function, axes=axes)], "frf")
        told = "" if found.form else unit
        assert (found.unit, found.kind) == (told, "frf")


@pytest.mark.parametrize(
    ("kind", "axis", "taken"),
    [
        ("frf", (18, "Hz"), True), ("frf", (0, "HZ"), True), ("frf", (18, "NONE"), True), ("frf", (18, ""), True),
        ("frf", (17, "Hz"), False), ("frf", (18, "s"), False), ("frf", (18, "rpm"), False),
        ("time", (17, "sec"), True), ("time", (0, "s"), True), ("time", (18, "s"), False), ("time", (17, "Hz"), False),
    ],
)  # fmt: skip
def test_functions_are_over_hertz_or_seconds(kind, axis, taken):
    (function,) = frfs(kind=kind, responses=[[1.0, 2.0, 3.0]]).functions()
    axis = cf.uff.Axis(axis[0], unit=axis[1])
    given = replace(function, axes=cf.uff.Axes(axis, function.axes.ordinate))
    if taken:
        assert len(cf.frf.FrfSet.from_functions([given], kind)) == 1
        return
    words = "frequency in Hz" if kind == "frf" else "time in s"
    with pytest.raises(
        cf.errors.InputError, match=rf"function 1 over 'NONE' in '{axis.unit}' \(kind {axis.kind}\); expected {words}"
    ):
        cf.frf.FrfSet.from_functions([given], kind)


def test_kinds_of_functions_are_chosen_by_their_numbers(tmp_path):
    """2, 3 auto and cross spectrum, 9, 10 power and energy density, 12 spectrum; 6, 26 ordinary, multiple coherence."""
    (one,) = frfs(kind="spectrum", responses=[[1.0, 2.0, 3.0]]).functions()
    every = [replace(one, kind=k, response=one.response._replace(node=k), values=one.values.real) for k in range(28)]
    path = cf.uff.write_uff(tmp_path / "f.uff", functions=every)
    assert cf.frf.FrfSet.from_uff(path, "spectrum").response_point.tolist() == [2, 3, 9, 10, 12]
    assert cf.frf.FrfSet.from_uff(path).response_point.tolist() == [4]
    assert cf.frf.read_coherence(path).response_point.tolist() == [6, 26]


def test_a_table_states_which_of_its_columns_lack_or_are_unknown(tmp_path):
    head = "# unit: m/N\nfreq_hz,response_point,response_direction,reference_point,reference_direction,real"
    for header, words in (
        (head, r"column 'imag': found no such column; expected freq_hz,response_point,"),
        (head + ",imag,phase", "column 'phase': found an unknown column; expected freq_hz,"),
        (head.replace("freq_hz", "time_s") + ",imag", "column 'imag': found an unknown column"),
    ):
        (tmp_path / "t.csv").write_text(header + "\n" + ",".join(["1"] * (header.count(",") + 1)) + "\n")
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.read_frfs(tmp_path / "t.csv")
    (tmp_path / "t.csv").write_text(head + ",imag\n10,4,1,5,-3,,\n20,4,1,5,-3,1.5,-2\n")
    found = cf.frf.read_frfs(tmp_path / "t.csv")
    np.testing.assert_array_equal(found.responses, [[np.nan, 1.5 - 2.0j]])
    assert (found.kind, found.response_point.tolist(), found.reference_direction.tolist()) == ("frf", [4], [-3])


def test_points_have_one_angle_each_and_picks_a_column(tmp_path):
    file = tmp_path / "p.csv"
    file.write_text("point,angle_deg\n4,90\n7,30\n")
    assert cf.frf.read_places(file) == ({4: 90.0, 7: 30.0}, None)
    file.write_text("point,angle_deg\n4,90\n7,30\n4,91\n")
    with pytest.raises(
        cf.errors.InputError, match=r"p\.csv, line 4, column 'point': found 4 again; expected each point once"
    ):
        cf.frf.read_places(file)
    file.write_text("point,angle_deg,z_m\n4,90,1\n")
    with pytest.raises(
        cf.errors.InputError, match="line 1: found point,angle_deg,z_m; expected point,angle_deg, or point,angle_de"
    ):
        cf.frf.read_places(file)
    file.write_text("mode,freq_hz\n4,90.5\n5,91\n")
    assert cf.frf.read_picks(file).tolist() == [90.5, 91.0]
    file.write_text("mode,tone\n4,90.5\n")
    with pytest.raises(cf.errors.InputError, match="line 1: found mode,tone; expected a column freq_hz"):
        cf.frf.read_picks(file)
    with pytest.raises(cf.errors.InputError, match=r"found ending '\.txt'; expected one of \.uff, "):
        cf.frf.read_frfs(tmp_path / "f.txt")


@pytest.mark.parametrize("ending", [".uff", ".UNV", ".uf", ".ufb", ".npz", ".csv"])
def test_responses_are_read_by_the_ending_of_their_file(ending, tmp_path):
    path, given = tmp_path / f"f{ending}", frfs()
    if ending == ".npz":
        given.save(path)
    elif ending == ".csv":
        given.to_csv(path)
    else:
        cf.uff.write_uff(path, functions=given.functions(), binary=True)
    np.testing.assert_array_equal(cf.frf.read_frfs(path).responses, given.responses)


def test_a_workbook_has_the_rows_of_a_csv_table(tmp_path):
    given, book = frfs(), Workbook()
    for line in given.to_csv(tmp_path / "f.csv").read_text(encoding="utf-8").splitlines():
        cells = [line] if line.startswith("#") else line.split(",")
        book.active.append([cell if cell.startswith("#") or cell.isidentifier() else float(cell) for cell in cells])
    book.save(tmp_path / "f.xlsx")
    read = cf.frf.read_frfs(tmp_path / "f.xlsx")
    np.testing.assert_allclose(read.responses, given.responses, rtol=1e-14)
    assert (read.unit, read.x.tolist()) == (given.unit, given.x.tolist())


def test_a_device_is_named_before_its_ending():
    with pytest.raises(cf.errors.InputError, match="/dev/null: found a device, expected a file or a pipe"):
        cf.frf.read_frfs("/dev/null")
