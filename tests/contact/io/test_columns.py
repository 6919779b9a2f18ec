"""A result's columns: the same values in records, printed tables and notebooks, and tables that fit a terminal."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

import casingfem as cf
import contact as ct


@dataclass(frozen=True, eq=False, repr=False)
class Pairs(ct.io.Reported):
    """A result with one column that tables leave out, and one of words."""

    COLUMNS: ClassVar = (
        ct.io.Column("n", "Nodal <diameters>.", lambda found: np.arange(2, 2 + len(found.split)), format="d"),
        ct.io.Column(
            "split_rel", "Split.", lambda found: found.split, head="split", unit="%", format=".2f", scale=100.0
        ),
        ct.io.Column("doublet", "Number.", lambda found: range(len(found.split)), where="files"),
        ct.io.Column(
            "wide",
            "Whether the split exceeds 1 %.",
            lambda found: found.split > 0.01,
            format=lambda wide: "wide" if wide else "",
        ),
    )
    split: np.ndarray


FOUND = Pairs(np.array([0.0125, np.nan, 0.002]))


def test_records_are_plain_and_in_si_units():
    first = FOUND.records()[0]
    assert first == {"n": 2, "split_rel": 0.0125, "doublet": 0, "wide": True}
    assert {type(value) for value in first.values()} == {int, float, bool}
    assert FOUND.to_dataframe()["split_rel"].iloc[2] == 0.002


def test_print_shows_the_same_values_in_the_units_of_the_header():
    assert repr(FOUND).splitlines()[1:] == [
        "n  split [%]  wide",
        "2       1.25  wide",
        "3          -",
        "4       0.20",
    ]


def test_a_column_of_words_that_is_empty_everywhere_is_left_out():
    assert repr(Pairs(np.array([0.002]))).splitlines()[1:] == ["n  split [%]", "2       0.20"]


def test_a_notebook_shows_the_same_cells_and_what_each_column_means():
    html = FOUND._repr_html_()
    assert '<th title="Nodal &lt;diameters&gt;.">n</th>' in html
    assert "<tr><td>2</td><td>1.25</td><td>wide</td></tr>" in html
    assert "doublet" not in html


def test_a_wide_table_goes_on_below_after_its_first_column_and_loses_no_cell():
    @dataclass(frozen=True, eq=False, repr=False)
    class Wide(ct.io.Reported):
        values: np.ndarray

        def described(self):
            return [ct.io.Column(f"column{k:02d}", "Value.", lambda found, k=k: found.values[:, k]) for k in range(30)]

    found = Wide(np.arange(60.0).reshape(2, 30))
    lines = repr(found).splitlines()[1:]
    assert max(map(len, lines)) <= 80
    assert [line.split()[0] for line in lines[::3]] == ["column00"] * (len(lines) // 3)
    cells = [cell for k, line in enumerate(lines) for cell in line.split()[1:] if k % 3 == 1]
    assert list(map(float, cells)) == list(range(1, 30))


def test_a_data_frame_keeps_whole_numbers_whole_where_some_are_missing():
    table = cf.FrequencyTable.from_arrays(freq_hz=[367.9, 410.2], sigma_hz=0.2, n=[8, -1]).to_dataframe()
    assert str(table["n"].dtype) == "Int64"
    assert table["n"].isna().tolist() == [False, True]
    assert table["n"][0] == 8
