"""Frequency tables at their bounds: values out of range, doublets just close or alike enough, units just seen."""

import re

import numpy as np
import pytest

import casingfem as cf


def table(freq, **more):
    return cf.FrequencyTable.from_arrays(freq_hz=freq, **{"sigma_hz": 0.1} | more)


ENDS = {  # column: the last values that are taken, the first that are not
    "mode": ((1,), (0, -1)), "n": ((-1, 0), (-2,)), "freq_hz": ((0.2, 1e300), (np.inf, 0.0)),
    "sigma_hz": ((1e-9, 6.999), (0.0, 7.0, np.nan)), "angle_deg": ((0.0, 359.9, np.nan), (360.0, -0.1)),
    "zeta": ((0.0, 0.999, np.nan), (1.0, -1e-9)),
}  # fmt: skip


@pytest.mark.parametrize("column", ENDS)
def test_values_are_taken_up_to_their_ends(column):
    given = {"freq_hz": [50.0, 7.0], "mode": [3, 4], "sigma_hz": [0.1, 0.1], "n": [1, 2], "angle_deg": [1.0, 2.0],
             "zeta": [0.1, 0.2]}  # fmt: skip
    taken, refused = ENDS[column]
    for value in taken:
        found = cf.FrequencyTable.from_arrays(**given | {column: [given[column][0], value]})
        np.testing.assert_array_equal(getattr(found, column), [given[column][0], value])
    for value in refused:
        with pytest.raises(cf.errors.InputError, match=f"{column} = {value} in row 2; expected "):
            cf.FrequencyTable.from_arrays(**given | {column: [given[column][0], value]})


def test_arrays_are_read_only_and_modes_counted_from_1():
    found = table([3.0, 4.0])
    assert found.mode.tolist() == [1, 2]
    assert found.n.tolist() == [-1, -1]
    assert np.isnan(found.angle_deg).all()
    assert np.isnan(found.zeta).all()
    assert not any(getattr(found, name).flags.writeable for name in ("mode", "n", "freq_hz", "sigma_hz", "zeta"))


def test_what_nobody_measured_states_so_once():
    assert not table([3.0]).synthetic
    assert not table([3.0], card=["rig", "SYNTHETIC"]).synthetic
    assert not table([3.0], card=["SYNTHETICS"]).synthetic
    assert table([3.0], card=["made SYNTHETIC"], synthetic=True).card == ("made SYNTHETIC",)
    for card in ((), ("rig",)):
        found = table([3.0], card=card, synthetic=True)
        assert found.synthetic
        assert found.card == ("SYNTHETIC: made by a program, not measured", *card)


def test_the_split_of_an_order_is_that_of_its_lowest_doublet_over_its_mean():
    found = table([100.0, 102.0, 50.0, 300.0, 301.0, 70.0, 71.0], n=[4, 4, 4, 4, 4, 7, 7])
    assert found.splits() == {4: pytest.approx(2.0 / 101.0, rel=1e-14), 7: pytest.approx(1.0 / 70.5, rel=1e-14)}


@pytest.mark.parametrize(("freq", "angles", "one"), [
    ([100.0, 116.2], None, True), ([100.0, 116.3], None, False), ([116.2, 100.0], None, True),
    ([100.0, 101.0], [3.0, 14.2], False), ([100.0, 101.0], [3.0, 14.3], True), ([100.0, 101.0], [3.0, 36.7], True),
    ([100.0, 101.0], [3.0, 36.8], False), ([100.0, 101.0], [40.0, 48.2], False),
    ([100.0, 101.0], [3.0, np.nan], True),
    ([100.0, 101.0], [np.nan, 3.0], True),
])  # fmt: skip
def test_two_rows_of_n_4_are_a_doublet_within_15_per_cent_and_an_eighth_of_a_period_of_90_over_n(freq, angles, one):
    found = table(freq, n=4, angle_deg=np.nan if angles is None else angles)
    assert len(found.groups()) == 2 - one


def test_the_distance_of_two_rows_is_over_their_own_mean_whatever_lies_below():
    assert [group.rows for group in table([50.0, 100.0, 116.2], n=4).groups()] == [(0,), (1, 2)]
    assert [group.rows for group in table([100.0, 116.3, 900.0], n=4).groups()] == [(0,), (1,), (2,)]


def test_rows_without_diameters_are_single_and_groups_ascend():
    found = table([30.0, 10.0, 10.1, 20.0, 20.1, 5.0], n=[3, 0, 0, 2, 2, -1])
    assert [group.rows for group in found.groups()] == [(5,), (1,), (2,), (3, 4), (0,)]
    assert [group.n for group in found.groups()] == [-1, 0, 0, 2, 3]


def test_leaving_out_rows_keeps_what_belongs_to_the_others(tmp_path):
    (tmp_path / "t.csv").write_text(
        '# lab\nmode,freq_hz,sigma_hz,zeta,remark\n4,1.5,0.1,0.01,one\n7,2.5,0.2,0.02,"a, b"\n'
    )
    with pytest.warns(cf.errors.ModelWarning, match="remark.*table-columns"):
        whole = cf.FrequencyTable.from_csv(tmp_path / "t.csv")
    found = whole.without(4)
    assert (found.mode.tolist(), found.freq_hz.tolist(), found.sigma_hz.tolist(), found.zeta.tolist()) == (
        [7],
        [2.5],
        [0.2],
        [0.02],
    )
    assert found.extra == {"remark": ("a, b",)}
    assert found.columns()["remark"] == ("a, b",)
    assert (found.card, found.path) == (("lab",), str(tmp_path / "t.csv"))
    whole.to_csv(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == (
        '# lab\nmode,n,freq_hz,sigma_hz,angle_deg,zeta,remark\n4,,1.5,0.1,,0.01,one\n7,,2.5,0.2,,0.02,"a, b"\n'
    )


@pytest.mark.parametrize(("header", "words"), [
    ("mode,freq,sigma_hz", "column 'freq': found a column without a unit in its name; expected freq_hz, or freq [hz]"),
    ("mode,Frequency [eV],sigma_hz", "column 'Frequency [eV]': found an unknown unit in its name, 'ev'; expected freq"),
    ("mode,freq_hz,sigma", "column 'sigma': found a column without a unit in its name; expected sigma_hz"),
    ("mode,freq_hz,sig(Hz)", "column 'sig(Hz)': found an unknown column; expected sigma_hz, unit and all"),
    ("mode,freq_hz,sigma_hz,angle", "column 'angle': found a column without a unit in its name; expected angle_deg"),
    ("mode,freq_hz,sigma_hz,damping", "column 'damping': found a column without a unit in its name; expected zeta"),
    ("mode,freq_hz,sigma_hz,zetas", "column 'zetas': found an unknown column; expected zeta, unit and all"),
    ("mode,f [Hz],fn [Hz],sigma_hz", "'f [Hz]' and 'fn [Hz]' for the same quantity; expected one column, freq_hz, or"),
])  # fmt: skip
def test_a_column_without_its_unit_or_misspelt_is_refused(header, words, tmp_path):
    (tmp_path / "t.csv").write_text(header + "\n" + ",".join(["1"] * header.count(",")) + ",1\n")
    with pytest.raises(cf.errors.InputError, match="line 1, .*" + re.escape(words)):
        cf.FrequencyTable.from_csv(tmp_path / "t.csv")


@pytest.mark.parametrize(
    ("freq", "factor"),
    [("Frequency [Hz]", 1.0), ("freq (Hz)", 1.0), ("f/Hz", 1.0), ("FREQ_HZ", 1), ("Eigenfrequenz, Hz", 1),
     ("f_Hz", 1), ("Natural frequency [kHz]", 1e3),
     ("f [rpm]", 1 / 60), ("f [rad/s]", 0.5 / np.pi), ("f [1/min]", 1 / 60)],
)  # fmt: skip
def test_columns_are_found_by_words_and_units_are_converted(freq, factor, tmp_path):
    rows = [f"Mode;Nodal diameter;{freq};Sigma [Hz];Damping [%];Angle [rad]", "# lower pair", "1;8;2,5;0,001;0,2;0,5"]
    (tmp_path / "t.csv").write_bytes("\r\n".join([*rows, ""]).encode("utf-8-sig"))
    found = cf.FrequencyTable.from_csv(tmp_path / "t.csv")
    np.testing.assert_allclose(found.freq_hz, [2.5 * factor], rtol=1e-14)
    np.testing.assert_allclose([found.zeta[0], found.angle_deg[0]], [0.002, np.degrees(0.5)], rtol=1e-14)
    assert (found.mode.tolist(), found.n.tolist(), found.card) == ([1], [8], ("lower pair",))


def test_a_table_of_a_laboratory_keeps_its_remarks(tmp_path):
    """Byte-order mark, semicolons, decimal commas, `Mode` in capitals, a remark, a row without n."""
    text = "Mode;n;freq_hz;Bemerkung;;\r\n1;3;107,9;;;\r\n7;;231,6;unsauber;;\r\n"
    (tmp_path / "t.csv").write_bytes(text.encode("utf-8-sig"))
    with pytest.warns(cf.errors.ModelWarning, match="Bemerkung.*table-columns"):
        found = cf.FrequencyTable.from_csv(tmp_path / "t.csv", sigma=0.003)
    assert (found.freq_hz.tolist(), found.n.tolist()) == ([107.9, 231.6], [3, -1])
    assert found.extra == {"Bemerkung": ("", "unsauber")}


def test_all_problems_of_a_table_are_named_at_once_up_to_a_bound(tmp_path):
    rows = ["1,107.9,0.1", "x,1o9.2,0.1", "3,159.7,-1", "3,0,0.1"]
    (tmp_path / "t.csv").write_text("\n".join(["mode,freq_hz,sigma_hz", *rows, ""]))
    with pytest.raises(cf.errors.InputError) as caught:
        cf.FrequencyTable.from_csv(tmp_path / "t.csv")
    assert [line.split(": ")[0].split(", ", 1)[1] for line in str(caught.value).splitlines()] == [
        "line 3, column 'mode'", "line 3, column 'freq_hz'", "line 4, column 'sigma_hz'",
    ]  # fmt: skip
    (tmp_path / "t.csv").write_text("\n".join(["mode,freq_hz,sigma_hz", rows[0], *rows[2:], ""]))
    with pytest.raises(cf.errors.InputError) as caught:
        cf.FrequencyTable.from_csv(tmp_path / "t.csv")
    assert len(str(caught.value).splitlines()) == 4
    (tmp_path / "t.csv").write_text("\n".join(["mode,freq_hz,sigma_hz", *["1,x,0.1"] * 50, ""]))
    with pytest.raises(cf.errors.InputError, match="30 further problems of this kind"):
        cf.FrequencyTable.from_csv(tmp_path / "t.csv")


@pytest.mark.parametrize(("name", "expected"), [("zeta", None), ("zeta [%]", 0.008), ("zeta [-]", 0.8)])
def test_damping_ratios_that_resemble_per_cent_need_a_unit(name, expected, tmp_path):
    (tmp_path / "t.csv").write_text(f"mode,freq_hz,sigma_hz,{name}\n1,100,0.1,0.8\n2,120,0.1,0.7\n")
    if expected is None:
        with pytest.raises(
            cf.errors.InputError, match=r"median damping ratio of 0\.75, as in per cent; expected a ratio; name"
        ):
            cf.FrequencyTable.from_csv(tmp_path / "t.csv")
        return
    found = cf.FrequencyTable.from_csv(tmp_path / "t.csv")
    assert found.zeta[0] == pytest.approx(expected, rel=1e-15)
    found.to_csv(tmp_path / "again.csv")
    assert cf.FrequencyTable.from_csv(tmp_path / "again.csv").zeta.tolist() == found.zeta.tolist()


@pytest.mark.parametrize("name", ["f", "sigma_rel", "Bemerkung", "(x)"])
def test_another_column_beside_the_right_ones_is_kept(name, tmp_path):
    (tmp_path / "t.csv").write_text(f"mode,freq_hz,sigma_hz,{name}\n1,3.5,0.1,7\n")
    with pytest.warns(cf.errors.ModelWarning, match="table-columns"):
        assert cf.FrequencyTable.from_csv(tmp_path / "t.csv").extra == {name: ("7",)}
