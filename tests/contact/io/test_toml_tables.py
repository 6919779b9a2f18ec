"""Words on tables, files and values, each rule once: what a message says, what a line of a TOML file should be."""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from pydantic import BaseModel, Field

from contact.io import tables
from contact.io.brief import brief
from contact.io.names import hint, names_fault
from contact.io.outfiles import read_checked, write_checked
from contact.io.tables import keys, type_words
from contact.io.toml import entries, read_toml, spelling, written
from contact.io.units import units_of


class Bolt(BaseModel):
    kind: Literal["bolt"]
    torque: float = Field(ge=0.0, le=1e20)
    start: float = Field(alias="from", default=0.0)


class Weld(BaseModel):
    kind: Literal["weld", "glue"]
    length: float = 1.0
    seam: Bolt | None = None


class Flange(BaseModel):
    joints: list[Annotated[Bolt | Weld, Field(discriminator="kind")]]
    name: str = "top"
    by_name: dict[str, Weld] = {}


def test_the_models_of_a_table_are_found_by_path_and_kind():
    data = {"joints": [{"kind": "bolt"}, {"kind": "glue", "seam": {}}, {"kind": "none"}, 3.0]}
    assert list(keys(Bolt)) == ["kind", "torque", "from"]
    assert tables.members(list[Bolt | Weld] | None) == [Bolt, Weld]
    assert tables.members(dict[str, int]) == []
    assert (tables.kinds(Weld), tables.kinds(Flange)) == (("weld", "glue"), ())
    for path, found in {
        (): [Flange], ("joints",): [Bolt, Weld], ("joints", 0): [Bolt], ("joints", 1): [Weld],
        ("joints", 1, "seam"): [Bolt], ("joints", 2): [Bolt, Weld], ("joints", 3): [Bolt, Weld],
    }.items():  # fmt: skip
        assert tables.models_at([Flange], path, data) == found


def test_the_path_of_an_error_has_no_tags_of_unions():
    data = {"joints": [{"kind": "bolt", "torque": -1.0}]}
    assert tables.resolved(("joints", 0, "bolt", "torque"), "greater_than", data) == ("joints", 0, "torque")
    assert tables.resolved(("joints", 0, "bolt", "from"), "missing", data) == ("joints", 0, "from")
    assert tables.resolved(("joints", 0, "bolt", "from"), "other", data) == ("joints", 0)
    assert tables.resolved(("joints", 5, "bolt"), "missing", data) == ("joints", "bolt")


def test_an_unknown_key_is_told_what_the_tables_have():
    words = tables.unknown("torqe", [Bolt, Weld])
    assert words == "expected one of kind, torque, from, length, seam (did you mean torque?)"


class Sizes(BaseModel):
    a: Annotated[list[int], Field(min_length=1)]
    b: list[int] = Field(min_length=3)
    c: list[int] = Field(min_length=3, max_length=3)
    d: str = Field(max_length=7)
    e: Annotated[float, Field(gt=0.5, lt=2.0)]
    f: int = Field(ge=-3, le=9)
    g: float = Field(ge=-1e20, le=0.99e20)
    h: bool | str | None = None
    i: Literal["in", 3] = 3
    j: dict[str, float] = {}
    k: list[Bolt] = []
    m: list[Annotated[float, Field(gt=0)]] = []
    n: complex = 0j
    o: list[Annotated[float, "note"]] = []


def test_what_a_key_may_hold_in_words():
    assert {name: type_words(info) for name, info in keys(Sizes).items()} == {
        "a": "list of whole number (not empty)", "b": "list of whole number (3 or more)",
        "c": "list of whole number (3)", "d": "text (0 to 7)", "e": "number > 0.5 < 2",
        "f": "whole number >= -3 <= 9", "g": "number <= 9.9e+19", "h": "true or false or text", "i": '"in", 3',
        "j": "table of names -> number", "k": "list of table", "m": "list of number > 0", "n": "<class 'complex'>",
        "o": "list of number",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("line", "way"),
    [
        ("x = .5", "a number has digits on both sides of its point: 0.5, 100.0"),
        ("x = 100.", "a number has digits on both sides of its point: 0.5, 100.0"),
        ("x = [1.5, -.5]", "a number has digits on both sides of its point: 0.5, 100.0"),
        ("x = 0,5", "decimals stand behind a point: 0.5"), ("x = [False]", "true and false are small letters"),
        ("x = casing", "text stands in quotes"), ("x = ./casing", ""), ("x = 1.5", ""),
    ],
)  # fmt: skip
def test_a_habit_is_told_with_its_line(line, way):
    text = f"[table]\n  {line}  \nlast = 2"
    assert spelling("Invalid (at line 2, column 3)", text) == f": {line}{f'; {way}' if way else ''}"
    assert spelling("Invalid (at end of document)", text) == ""


def test_long_lines_are_cut_at_sixty_letters():
    said = "Invalid (at line 1, column 1)"
    assert spelling(said, f'"{"x" * 58}"') == f': "{"x" * 58}"'
    assert spelling(said, f'"{"x" * 59}"') == f': "{"x" * 59} ...'


@pytest.mark.parametrize("text", ["{} = 1", "[{}]", "b = 1\n[[{}]]", "x = {{{} = 1}}", "x = {{y = 2, {} = 1}}"])
@pytest.mark.parametrize("word", ["a", '"a"', " a-1 ", "'a'"])
def test_a_key_of_very_many_parts_is_refused_at_once(tmp_path, text, word):
    path = tmp_path / "scene.toml"
    path.write_text(text.format(".".join([word] * 20_000)))
    with pytest.raises(ValueError, match=r"^not TOML: found a key of 20000 parts at line [12], expected at most 100$"):
        read_toml(path)


def test_numbers_texts_and_comments_with_many_points_are_no_keys(tmp_path):
    path = tmp_path / "scene.toml"
    numbers = ", ".join(["1.5"] * 200)
    path.write_text(f'# {"." * 200}\na = [{numbers}]\nb = "{"A sentence. " * 200}"\nc.d = 1.5 # {"a.b " * 200}\n')
    assert read_toml(path)[1]["a"] == [1.5] * 200


def test_a_file_that_is_no_toml_is_told_where(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"a = 1\nb = 2\n# \xe9\n")
    with pytest.raises(
        ValueError, match=r"^line 3: found byte 0xe9, which is not UTF-8 \('é' in Latin-1\), expected UTF-8 text: "
    ):
        read_toml(path)
    path.write_text("a = 1\nb = .5\n")
    with pytest.raises(ValueError, match=r"^not TOML: .*: b = \.5; a number has digits on both sides of its point"):
        read_toml(path)
    path.write_text("a = " + "[" * 5000 + "]" * 5000)
    with pytest.raises(ValueError, match=r"^not TOML: found values nested some hundred deep"):
        read_toml(path)
    path.write_text("a = 1\n")
    assert read_toml(path) == (b"a = 1\n", {"a": 1})
    assert written(("a", "b", 1, 0, "c")) == "a.b[2][1].c"
    assert entries(("a",)) == {}


@pytest.mark.parametrize(
    ("words", "length", "mass", "time"),
    [
        ("m-kg-s", 1.0, 1.0, 1.0), ("mm-kg-ms", 1e-3, 1.0, 1e-3), ("cm-g-s", 1e-2, 1e-3, 1.0),
        ("ft-lb-s", 0.3048, 0.45359237, 1.0), ("in-lbf-ms", 0.0254, 4.4482216152605e-6 / 0.0254, 1e-3),
    ],
)  # fmt: skip
def test_units_are_what_their_words_say_in_si(words, length, mass, time):
    units = units_of(words)
    assert tuple(units) == pytest.approx((length, mass, time), rel=1e-14)
    assert units.stiffness == pytest.approx(mass / time**2, rel=1e-14)
    assert units.damping == pytest.approx(mass / time, rel=1e-14)


@pytest.mark.parametrize("words", ["m-kg", "m-kg-s-s", "kg-kg-s", "m-m-s", "m-kg-kg"])
def test_words_that_are_no_units_are_refused(words):
    with pytest.raises(ValueError, match=rf"units: found '{words}', expected length \(m, cm, mm, in, ft\), mass"):
        units_of(words)


@dataclass(frozen=True)
class Shown:
    size: Any
    rows: Any = None
    more: Any = field(default_factory=list)
    hidden: int = field(default=1, repr=False)


def test_a_value_on_one_line():
    """What is at its default, or hidden, is left out; arrays by shape, long lists by their first four."""
    assert brief(Shown(0.1 + 0.2, hidden=7)) == "Shown(size=0.3)"
    assert brief(Shown(np.float64(2.5), rows=np.zeros((2, 3)))) == "Shown(size=2.5, rows=array(2 x 3))"
    assert brief(Shown([1, 2, 3, 4])) == "Shown(size=[1, 2, 3, 4])"
    assert brief(Shown((1, 2, 3, 4, 5))) == "Shown(size=[1, 2, 3, 4, ... 5])"
    assert brief(Shown({"a": 1.0, "b": [2]}, more=[])) == "Shown(size={a: 1, b: [2]})"
    assert brief(Shown("x\ny", more=[0])) == "Shown(size='x\\ny', more=[0])"
    assert brief(Shown(10**89)) == f"Shown(size={10**89})"
    assert brief(Shown(10**90)) == "Shown(size=int(...))"


@dataclass(frozen=True, eq=False)
class Field0:
    values: Any = (0.0, 0.0)
    array: Any = field(default_factory=lambda: np.zeros(2))


def test_an_array_at_its_default_is_left_out():
    assert brief(Field0()) == "Field0()"
    assert brief(Field0(array=np.array([0.0, 1.0]))) == "Field0(array=array(2))"
    assert brief(Field0(array=np.zeros(3))) == "Field0(array=array(3))"
    assert brief(Field0(array=None)) == "Field0(array=None)"


def test_names_print_on_one_line_and_near_ones_are_hinted_at():
    assert names_fault(["", "x"]) == "'', expected a name that prints on one line"
    assert names_fault(["a", "b", "a\u202e"]) == "'a\\u202e', expected a name that prints on one line"
    assert names_fault(["a", "b", "a"]) == "'a' twice, expected each name once"
    known = ["thickness", "thickened", "mesh"]
    assert hint("thicknes", known) == " (did you mean thickness?)"
    assert hint("thicknes", known, 2) == " (did you mean thickness or thickened?)"
    assert hint("thi", known) == ""
    assert hint("thi", known, cutoff=0.3) != ""


def test_json_with_a_checksum_is_read_by_whom_it_is_for(tmp_path):
    path = tmp_path / "kept.json"
    write_checked(path, "row", {"x": [1.5, None]}, format="kept-1", hash="abc")
    assert read_checked(path, "row", format="kept-1", hash="abc") == {"x": [1.5, None]}
    assert read_checked(path, "row") == {"x": [1.5, None]}
    for head in ({"format": "kept-2", "hash": "abc"}, {"format": "kept-1", "hash": "abd"}, {"other": 1}):
        assert read_checked(path, "row", **head) is None
    assert read_checked(path, "hash") is None
    assert read_checked(tmp_path / "none.json", "row") is None
    with pytest.raises(ValueError, match="Out of range"):
        write_checked(path, "row", float("nan"))
