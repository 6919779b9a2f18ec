"""Results as lines, tables and pages, and what plain files keep: each rule on values small enough to write out."""

import math
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csc_array

import contact as ct
from contact.io import npz, outfiles
from contact.io.npz import compliance_fault, require_kinds, save_npz, whole, write_npz
from contact.io.reported import Reported, cell, lines_of, names_in, restored
from contact.io.stored import Packing, StoredError, Unpacking, load_value, read_only, save_value
from contact.record.wear import Wear


@dataclass(frozen=True, eq=False, repr=False)
class Rows(Reported):
    """As many rows as it is told, beside an array."""

    count: int
    array: Any = None

    def records(self):
        """Their number, and a word in every other."""
        return [{"row": k, "size_m": k / 3.0} | ({"word": "<b>"} if k % 2 else {}) for k in range(self.count)]


def test_a_result_prints_its_first_forty_rows():
    whole_text, cut = repr(Rows(40)).splitlines(), repr(Rows(41)).splitlines()
    assert (whole_text[0], cut[0]) == ("Rows, 40 rows", "Rows, 41 rows")
    assert (len(whole_text), len(cut)) == (42, 43)
    assert cut[-1] == "... 1 more"
    assert whole_text[1:4] == ["row    size_m  word", "  0         0", "  1  0.333333  <b>"]
    assert cut[1:-1] == whole_text[1:]


def test_a_page_has_forty_rows_and_escapes_what_they_say():
    page, cut = Rows(40)._repr_html_(), Rows(42)._repr_html_()
    assert page.startswith(
        "<table><caption>Rows</caption><thead><tr><th>row</th><th>size_m</th><th>word</th></tr></thead>"
    )
    assert "<tbody><tr><td>0</td><td>0</td><td></td></tr><tr><td>1</td><td>0.333333</td><td>&lt;b&gt;</td></tr>" in page
    assert (page.count("<tr>"), cut.count("<tr>")) == (41, 41)
    assert "rows</p>" not in page
    assert "</table><p>40 of 42 rows</p><details>" in cut
    assert "<pre>Rows, 40 rows\n" in page


def test_rows_become_columns_and_columns_rows():
    assert Rows(3).columns() == {"row": [0, 1, 2], "size_m": [0.0, 1 / 3, 2 / 3], "word": [None, "<b>", None]}
    none = np.zeros(2)
    wear = Wear(angle=[1.0, 2.0], made=[3.0, 4.0], cut=none, worn=none, map_time=none, map=none, volume=0.0, stated=0.0,
                dissipated=0.0, bare=0)  # fmt: skip
    assert wear.records() == [
        {"angle_rad": 1.0, "made_m": 3.0, "cut_m": 0.0, "worn_m": 0.0},
        {"angle_rad": 2.0, "made_m": 4.0, "cut_m": 0.0, "worn_m": 0.0},
    ]  # fmt: skip
    assert wear.residual == 0.0
    assert names_in([{"b": 1}, {"a": 2, "b": 3}]) == ["b", "a"]


def test_arrays_of_a_result_are_copies_that_cannot_be_written():
    given, frozen = np.arange(3.0), read_only(np.arange(2.0))
    found = Rows(1, given)
    given[0] = 9.0
    assert found.array.tolist() == [0.0, 1.0, 2.0]
    assert not found.array.flags.writeable
    assert Rows(1, frozen).array is frozen
    again = restored(Rows, {"count": 2, "array": np.arange(3.0)})
    assert (again.count, again.array.flags.writeable) == (2, False)


def test_cells_and_columns_of_text():
    values = (
        1234567.0,
        0.1 + 0.2,
        np.float32(0.5),
        np.bool_(False),
        True,
        12,
        np.nan,
        None,
        [1.0, None],
        np.arange(2),
        "x",
    )
    assert [cell(value) for value in values] == [
        "1.23457e+06", "0.3", "0.5", "no", "yes", "12", "", "", "1, ", "0, 1", "x",
    ]  # fmt: skip
    lines = lines_of([{"n": 1, "name": "longer", "x": 2.5}, {"n": 100, "name": "b"}])
    assert lines == ["  n  name      x", "  1  longer  2.5", "100  b"]
    assert lines_of([{"quite_long": 1}]) == ["quite_long", "         1"]


def kept(value):
    """The same after writing and reading, without a file."""
    packing = Packing()
    document = packing.packed(value, "")
    return Unpacking(packing.arrays).unpacked(document), document, packing.arrays


@pytest.mark.parametrize(
    "value",
    [
        None, True, 3, 2.5, "text", -math.inf, math.inf, 1.5 - 2.5j, complex(math.inf, 2.0), (1, (2.0, "x"), [3, None]),
        {"a": 1, 2: (3.0,)}, MappingProxyType({"b": {"c": 4}}), frozenset({1, 2}), Path("some") / "file.toml",
        ct.record.Stored(kinetic=1.0, strain=2.0, potential=3.0, residual=4.0, discrete=math.inf),
    ],
)  # fmt: skip
def test_plain_values_are_read_as_they_were(value):
    found, _, arrays = kept(value)
    assert found == value
    assert type(found) is type(value)
    assert arrays == {}


def test_numbers_without_a_word_in_json_and_arrays_by_their_paths():
    assert math.isnan(kept(math.nan)[0])
    assert kept(np.float64(2.5))[:2] == (2.5, 2.5)
    array = np.arange(3)
    found, document, arrays = kept((array, [array, {"x": np.zeros(2)}], np.ones(1)))
    assert list(arrays) == ["1", "2.2.x", "3"]
    assert found[1][0] is found[0]
    assert found[0].tolist() == [0, 1, 2]
    assert not found[1][1]["x"].flags.writeable
    assert document["tuple"][1]["list"][0] == {"same": 0}
    assert [part["number_of"] for part in (document["tuple"][0], document["tuple"][2])] == [0, 2]
    assert list(kept(np.ones(1))[2]) == ["value"]
    assert list(kept({"document": np.ones(1), "format": np.ones(1)})[2]) == ["document_", "format_"]
    matrix = csc_array(np.array([[0.0, 2.0, 0.0], [3.0, 0.0, 0.0]]))
    found, _, arrays = kept({"K": matrix})
    np.testing.assert_array_equal(found["K"].toarray(), matrix.toarray())
    assert sorted(arrays) == ["K.data", "K.indices", "K.indptr"]


def test_what_is_neither_plain_nor_of_the_packages_is_refused_by_its_path(tmp_path):
    for value, words in (
        ({"a": (1, print)}, "a.2: found builtins.builtin_function_or_method"),
        ({"b": object()}, "b: found builtins.object"),
        ({"c": np.array([None])}, "c: found an array of object, expected one of numbers or text"),
    ):  # fmt: skip
        with pytest.raises(StoredError, match=words):
            save_value(tmp_path / "value.npz", value)
    path = save_value(tmp_path / "value.npz", (1, 2), {"beside": np.arange(2)})
    assert load_value(path, tuple) == (1, 2)
    assert npz.load_npz(path)["beside"].tolist() == [0, 1]
    with pytest.raises(StoredError, match=r"value\.npz: found a tuple, expected a Wear"):
        load_value(path, Wear)
    write_npz(path, {"x": np.zeros(1)})
    with pytest.raises(StoredError, match="found a NoneType, expected a Wear"):
        load_value(path, Wear)


def test_arrays_inside_of_values_become_read_only():
    arrays = [np.zeros(1) for _ in range(5)]
    value = ({"a": arrays[0]}, [arrays[1]], MappingProxyType({"b": (arrays[2],)}), Rows(1, None), arrays[3])
    assert read_only(value) is value
    assert [array.flags.writeable for array in arrays] == [False] * 4 + [True]


@pytest.mark.parametrize(("value", "number"), [(0, 0), (8.0, 8), (1_000_000, 1_000_000)])
def test_a_number_that_counts_is_whole(value, number):
    assert whole({"n": np.array(value)}, "n") == number
    assert whole({"n": np.array(value)}, "m") == 0


@pytest.mark.parametrize("value", [-1, 1_000_001, 2.5, [3], math.nan])
def test_a_number_that_does_not_count_is_refused(value):
    with pytest.raises(ValueError, match=r"n: found .*, expected a whole number from 0 to 1,000,000"):
        whole({"n": np.array(value)}, "n")


def test_a_compliance_is_symmetric_and_pulls_nothing_away():
    def matrix(skew, least):
        return 1e-7 * np.array([[1.0, skew], [0.0, least]])

    assert compliance_fault(matrix(0.9e-8, 0.5)) == ""
    assert compliance_fault(matrix(1.1e-8, 0.5)) == "asymmetry 1.10e-08 of its scale, expected a symmetric matrix"
    assert compliance_fault(matrix(0.0, -0.9e-6)) == ""
    assert compliance_fault(matrix(0.0, -1.1e-6)).startswith("the eigenvalue -1.1e-13 m/N, expected none below 0")
    assert compliance_fault(np.zeros((3, 3))) == compliance_fault(np.zeros((0, 0))) == ""


def test_arrays_are_of_their_kind(tmp_path):
    given = {"a": np.array("x"), "b": np.array([1j]), "c": np.array([2]), "d": np.array([True])}
    for kind, letters in {"text": "a", "complex": "bc", "real": "c"}.items():
        for name, array in given.items():
            if name in letters:
                require_kinds({name: array}, {name: kind})
                continue
            with pytest.raises(
                ValueError, match=rf"member '{name}': found .*, expected {'text' if kind == 'text' else ''}"
            ):
                require_kinds({name: array}, {name: kind})
    with pytest.raises(ValueError, match="member 'a': found <U1, expected real numbers"):
        require_kinds(given, {})
    with (tmp_path / "x").open("wb") as stream, pytest.raises(ValueError, match="member 'a': found object"):
        save_npz(stream, {"a": np.array([None])})
    sizes = [
        write_npz(tmp_path / f"{packed}.npz", {"x": np.zeros(10_000)}, compressed=packed).stat().st_size
        for packed in (False, True)
    ]
    assert sizes[0] > 80_000 > 2_000 > sizes[1]
    assert write_npz(tmp_path / "plain.npz", {"x": np.zeros(10_000)}).stat().st_size == sizes[0]


def test_what_an_archive_may_unpack_to(tmp_path, monkeypatch):
    """64 MB, or a hundred times its own size."""
    path = write_npz(tmp_path / "x.npz", {"x": np.zeros(4000)}, compressed=True)
    size, unpacked = path.stat().st_size, 8 * 4000 + 128
    for room, ratio, fits in (
        (unpacked, 0.0, True),
        (unpacked - 1, 0.0, False),
        (0.0, unpacked / size, True),
        (0.0, 9.0, False),
    ):
        monkeypatch.setattr(npz, "ROOM", room)
        monkeypatch.setattr(npz, "PACKED", ratio)
        if fits:
            assert npz.load_npz(path)["x"].size == 4000
        else:
            with pytest.raises(ValueError, match=r"found member 'x\.npy' that helps to unpack .* MB to 0\.0321 MB"):
                npz.load_npz(path)


def test_json_has_no_word_for_what_is_not_finite():
    value = {"a": [1.5, math.inf, (math.nan, "x")], "b": np.float64(-math.inf), "c": True}
    assert outfiles.finite(value) == {"a": [1.5, None, [None, "x"]], "b": None, "c": True}
    assert outfiles.json_text({"ä": [1]}) == '{"ä": [1]}\n'
