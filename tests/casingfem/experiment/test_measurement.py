"""The frequency table: reads what is right, refuses the rest by line and column, writes bit for bit."""

from pathlib import Path

import numpy as np
import pytest

import casingfem as cf

DATA = Path(__file__).resolve().parents[3] / "data"

GOOD = """\
# SYNTHETIC: made for a test
# sensor: laser
mode,n,freq_hz,sigma_hz,angle_deg,zeta
1,8,371.2,0.4,12.0,0.0021
2,8,373.9,0.4,,
3,,402.5,0.5,,0.001
"""


def test_reads_the_format_of_the_documentation(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(GOOD)
    table = cf.FrequencyTable.from_csv(path)
    assert len(table) == 3
    assert table.synthetic
    assert table.card == ("SYNTHETIC: made for a test", "sensor: laser")
    assert table.n.tolist() == [8, 8, -1]
    assert table.freq_hz.tolist() == [371.2, 373.9, 402.5]
    np.testing.assert_array_equal(table.angle_deg, [12.0, np.nan, np.nan])
    np.testing.assert_array_equal(table.zeta, [0.0021, np.nan, 0.001])
    assert repr(table).splitlines()[0] == "FrequencyTable(3 modes, SYNTHETIC, 1 doublet)"
    assert repr(table).splitlines()[4].split() == ["3", "-", "402.5000", "0.5000", "-", "0.00100"]


def test_optional_columns_may_be_absent_and_in_any_order(tmp_path):
    path = tmp_path / "short.csv"
    path.write_text("freq_hz,mode,sigma_hz\n20,2,0.1\n10,1,0.1\n")
    table = cf.FrequencyTable.from_csv(path)
    assert table.mode.tolist() == [2, 1]
    assert table.n.tolist() == [-1, -1]
    assert not table.synthetic
    assert np.isnan(table.zeta).all()


HEAD = "mode,n,freq_hz,sigma_hz,angle_deg,zeta\n"
ROW = "1,8,371.2,0.4,12.0,0.0021\n"
BAD = {
    "empty": ("", "no header row"),
    "header only": (HEAD, "line 1: found no rows"),
    "freq without unit": (
        "mode,freq,sigma_hz\n1,2,1\n",
        "line 1, column 'freq': found a column without a unit in its name; expected freq_hz, or freq .hz., .khz",
    ),
    "frequency in eV": (HEAD.replace("freq_hz", "freq [eV]") + ROW, "an unknown unit in its name, 'ev'; expected freq"),
    "sigma without unit": (HEAD.replace("sigma_hz", "sigma") + ROW, "column 'sigma': .* expected sigma_hz"),
    "angle without unit": (HEAD.replace("angle_deg", "angle") + ROW, "expected angle_deg"),
    "no sigma": ("mode,freq_hz\n1,2\n", "column 'sigma_hz': found no such column; .* add a column sigma_hz"),
    "no frequencies": ("mode,sigma_hz\n1,2\n", "column 'freq_hz': found no such column"),
    "no mode": ("freq_hz,sigma_hz\n2,1\n", "column 'mode': found no such column"),
    "misspelt column": (HEAD.replace("zeta", "zeta_pc") + ROW, "column 'zeta_pc': found an unknown column; .* zeta"),
    "column twice": (HEAD.replace("zeta", "n") + ROW, "line 1, column 'n': found this column twice"),
    "unnamed column": (HEAD.strip() + ",\n" + ROW.strip() + ",3\n", "no name for column 7"),
    "no header": (ROW, "line 1: found numbers"),
    "frequency 0": (HEAD + "1,8,0,0.4,,\n", "line 2, column 'freq_hz': found 0; expected a frequency > 0"),
    "frequency < 0": (HEAD + ROW + "2,8,-371.2,0.4,,\n", "line 3, column 'freq_hz': found -371.2"),
    "sigma 0": (HEAD + "1,8,371.2,0,,\n", "line 2, column 'sigma_hz': found 0; expected 0 < sigma_hz"),
    "sigma < 0": (HEAD + "1,8,371.2,-0.4,,\n", "column 'sigma_hz': found -0.4"),
    "columns swapped": (HEAD + "1,8,0.4,371.2,,\n", "column 'sigma_hz': found 371.2; .* < freq_hz"),
    "NaN": (HEAD + "1,8,nan,0.4,,\n", r"line 2, column 'freq_hz': found 'nan'; .* 3\.712e2$"),
    "NaN angle": (HEAD + "1,8,371.2,0.4,NaN,\n", "line 2, column 'angle_deg': found 'NaN'; .* or an empty cell"),
    "infinite": (HEAD + "1,8,inf,0.4,,\n", "column 'freq_hz': found 'inf'"),
    "overflow": (HEAD + "1,8,1e400,0.4,,\n", "column 'freq_hz': found '1e400'"),
    "blank frequency": (HEAD + "1,8,,0.4,,\n", "column 'freq_hz': found an empty cell"),
    "blank sigma": (HEAD + "1,8,371.2,,,\n", "column 'sigma_hz': found an empty cell"),
    "blank mode": (HEAD + ",8,371.2,0.4,,\n", "column 'mode': found an empty cell"),
    "text after number": (HEAD + "1,8,371.2 Hz,0.4,,\n", "column 'freq_hz': found '371.2 Hz'"),
    "thousands": (HEAD + "1,8,1_371.2,0.4,,\n", "column 'freq_hz': found '1_371.2'"),
    "Fortran exponent": (HEAD + "1,8,3.712D2,0.4,,\n", "column 'freq_hz': found '3.712D2'"),
    "hexadecimal": (HEAD + "1,8,0x17,0.4,,\n", "column 'freq_hz': found '0x17'"),
    "foreign digits": (HEAD + "1,8,٣٧١,0.4,,\n", "column 'freq_hz'"),
    "decimal comma": (HEAD + "1,8,371,2,0.4,,\n", "line 2: found 7 cells .* decimal point"),
    "quoted decimal comma": (HEAD + '1,8,"371,2",0.4,,\n', "column 'freq_hz': found '371,2'"),
    "semicolons and commas": (
        HEAD.replace(",", ";", 2) + "1;8;371.2,0.4,,\n",
        "column .mode;n;freq_hz.: found an unknown column",
    ),
    "two decimal marks": (HEAD.replace(",", ";") + "1;8;371,2;0.4;;\n", "line 2: found '0.4' below .* decimal comma"),
    "thousands and a comma": (HEAD.replace(",", ";") + "1;8;1.371,2;0,4;;\n", "column 'freq_hz': found '1.371,2'"),
    "short row": (HEAD + ROW + "2,8,373.9\n", "line 3: found 3 cells in '2,8,373.9'; expected 6"),
    "mode twice": (HEAD + ROW + ROW, "line 3, column 'mode': found 1 again; expected .* each once"),
    "mode 0": (HEAD + "0,8,371.2,0.4,,\n", "column 'mode': found 0"),
    "mode 1.0": (HEAD + "1.0,8,371.2,0.4,,\n", "column 'mode': found '1.0'; expected a whole number$"),
    "n fractional": (HEAD + "1,8.5,371.2,0.4,,\n", "column 'n': found '8.5'; .* or an empty cell"),
    "n negative": (HEAD + "1,-1,371.2,0.4,,\n", "column 'n': found -1"),
    "n with m": (HEAD + '1,"8,1",371.2,0.4,,\n', "column 'n': found '8,1'"),
    "angle 360": (HEAD + "1,8,371.2,0.4,360,\n", "column 'angle_deg': found 360; expected 0 <= angle_deg"),
    "angle < 0": (HEAD + "1,8,371.2,0.4,-5,\n", "column 'angle_deg': found -5"),
    "zeta in per cent": (HEAD + "1,8,371.2,0.4,,2.1\n", "column 'zeta': found 2.1; .* not per cent"),
    "zeta negative": (HEAD + "1,8,371.2,0.4,,-0.1\n", "column 'zeta': found -0.1"),
    "open quote": (HEAD + '1,8,"371.2,0.4,,\n', "line 2: found quotes"),
    "control character": (HEAD + "1,8,371.2\x0b,0.4,,\n", "line 2: found the character"),
    "no-break space": (HEAD + "1,8,\u00a0371.2,0.4,,\n", "column 'freq_hz'"),
}


@pytest.mark.parametrize("name", BAD)
def test_malformed_tables_are_refused_with_their_place(tmp_path, name):
    text, message = BAD[name]
    path = tmp_path / "bad.csv"
    path.write_bytes(text.encode())
    with pytest.raises(cf.errors.InputError, match=message) as caught:
        cf.FrequencyTable.from_csv(path)
    assert "bad.csv" in str(caught.value)
    assert caught.value.expected


@pytest.mark.parametrize("mark", [";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_tables_of_spreadsheets_with_decimal_commas(tmp_path, mark, encoding):
    rows = HEAD + "1,8,371.2,0.4,7.5,\n2,8,373.9,4e-1,18,1e-3\n"
    path, same = tmp_path / "excel.csv", tmp_path / "same.csv"
    path.write_bytes(rows.replace(",", mark).replace(".", ",").replace("\n", "\r\n").encode(encoding))
    same.write_text(rows)
    found, expected = cf.FrequencyTable.from_csv(path), cf.FrequencyTable.from_csv(same)
    assert found.card == expected.card
    assert (found.to_dataframe().fillna(-1) == expected.to_dataframe().fillna(-1)).all(axis=None)
    path.write_bytes(rows.replace(",", mark).encode(encoding))
    assert (cf.FrequencyTable.from_csv(path).freq_hz == [371.2, 373.9]).all()


def test_bytes_that_are_not_utf8_name_their_line(tmp_path):
    path = tmp_path / "latin.csv"
    path.write_bytes(b"# ok\n# mesur\xe9\n" + (HEAD + ROW).encode())
    with pytest.raises(cf.errors.InputError, match=r"line 2: found byte 0xe9"):
        cf.FrequencyTable.from_csv(path)
    path.write_bytes(b"\xef\xbb\xbf" + (HEAD + ROW).replace("\n", "\r\n").encode())
    assert len(cf.FrequencyTable.from_csv(path)) == 1


@pytest.mark.parametrize("space", ["\u00a0", "\u1680", "\u2009", "\u3000"])
def test_spaces_of_other_scripts_are_in_a_card(tmp_path, space):
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0], sigma_hz=0.1, card=[f"5{space}mm wall"])
    table.to_csv(tmp_path / "a.csv")
    assert cf.FrequencyTable.from_csv(tmp_path / "a.csv").card == table.card


def test_writing_leaves_the_old_file_or_the_new_one(tmp_path, monkeypatch):
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0, 200.0], sigma_hz=0.1)
    table.to_csv(tmp_path / "t.csv")
    before = (tmp_path / "t.csv").read_bytes()

    def fails(*_):
        raise OSError("no space")

    monkeypatch.setattr("os.replace", fails)
    with pytest.raises(OSError, match="no space"):
        table.without(1).to_csv(tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["t.csv"]


def test_without_leaves_out_and_names_what_is_missing():
    table = cf.FrequencyTable.from_arrays(freq_hz=[1.0, 2.0, 3.0], sigma_hz=0.1, card=["lab"])
    assert table.without(2).mode.tolist() == [1, 3]
    assert table.without(1, 3).freq_hz.tolist() == [2.0]
    assert table.without(2).card == ("lab",)
    with pytest.raises(ValueError, match="has no mode 7"):
        table.without(7)
    with pytest.raises(cf.errors.InputError, match="length >= 1"):
        table.without(1, 2, 3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"freq_hz": [1.0, -2.0]}, r"freq_hz = -2.0 in row 2; expected a frequency > 0"),
        ({"freq_hz": [1.0, np.nan]}, "freq_hz = nan in row 2"),
        ({"sigma_hz": [0.1]}, "one common length"),
        ({"sigma_hz": np.nan}, "sigma_hz = nan"),
        ({"mode": [1, 1]}, "each once"),
        ({"n": [2, 2.5]}, "whole numbers"),
        ({"n": -2}, "n = -2"),
        ({"zeta": 1.0}, "not per cent"),
        ({"freq_hz": []}, "one common length"),
    ],
)
def test_arrays_are_checked_like_files(arguments, message):
    with pytest.raises(cf.errors.InputError, match=message):
        cf.FrequencyTable.from_arrays(**({"freq_hz": [1.0, 2.0], "sigma_hz": 0.1} | arguments))


def groups_of(n, freq, angle=np.nan):
    return [g.rows for g in cf.FrequencyTable.from_arrays(n=n, freq_hz=freq, sigma_hz=0.1, angle_deg=angle).groups()]


def test_the_closest_neighbours_pair_first():
    assert groups_of([4, 4, 4], [100.0, 110.0, 111.0]) == [(0,), (1, 2)]
    assert groups_of([4, 4, 4], [100.0, 101.0, 110.0]) == [(0, 1), (2,)]


def test_orientations_decide_where_they_are_known():
    assert groups_of([4, 4], [100.0, 101.0], [10.0, 32.0]) == [(0, 1)]  # 22.5 deg apart, within reason
    assert groups_of([4, 4], [100.0, 101.0], [10.0, 57.0]) == [(0,), (1,)]  # alike modulo 45 deg
    assert groups_of([4, 4], [100.0, 101.0], [2.0, 340.0]) == [(0, 1)]  # across zero
    assert groups_of([1, 1], [100.0, 101.0], [5.0, 275.0]) == [(0, 1)]


def test_the_measured_blade_reads():
    table = cf.FrequencyTable.from_csv(DATA / "experiments/olson_lindberg.csv")
    assert table.freq_hz.tolist() == [86.6, 135.5, 258.9, 350.6, 395.2, 531.1, 743.2]
    assert set(table.sigma_hz) == {1.0}
    assert not table.synthetic
    assert table.card[0].startswith("MEASURED")
    assert any("AFFDL-TR-68-150" in line for line in table.card)


def test_further_columns_are_kept_and_stated_to_be_used_by_nobody(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(HEAD.strip() + ",remark,n_share\n" + ROW.strip() + ',"loud, twice",0.9\n')
    with pytest.warns(
        cf.errors.ModelWarning, match=r"table.csv: found columns that .*: remark, n_share.*table-columns"
    ):
        table = cf.FrequencyTable.from_csv(path)
    assert dict(table.extra) == {"remark": ("loud, twice",), "n_share": ("0.9",)}
    table.to_csv(tmp_path / "again.csv")
    with pytest.warns(cf.errors.ModelWarning, match="remark, n_share"):
        assert cf.FrequencyTable.from_csv(tmp_path / "again.csv").extra == table.extra


def test_a_default_sigma_is_where_a_row_or_the_file_states_nothing(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("mode,freq_hz\n1,100.0\n2,200.0\n")
    assert cf.FrequencyTable.from_csv(path, sigma=1e-3).sigma_hz.tolist() == [0.1, 0.2]
    path.write_text("mode,freq_hz,sigma_hz\n1,100.0,\n2,200.0,0.5\n")
    assert cf.FrequencyTable.from_csv(path, sigma=1e-3).sigma_hz.tolist() == [0.1, 0.5]
    with pytest.raises(cf.errors.InputError, match="column 'sigma_hz': found an empty cell"):
        cf.FrequencyTable.from_csv(path)
    path.write_text("mode,freq_hz\n1,100.0\n")
    with pytest.raises(cf.errors.InputError, match="column 'sigma_hz': found 200 by default"):
        cf.FrequencyTable.from_csv(path, sigma=2.0)
