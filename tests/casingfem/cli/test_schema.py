"""`casingfem schema KEY`: one table on a screen; every key of every file says what it is, and its unit."""

import json

import pytest
from click.testing import CliRunner
from pydantic import BaseModel, Field

from casingfem.cli import main
from casingfem.cli.schema import roots
from contact.io.tables import keys, members, type_words, words


def all_tables():
    """Every table of every kind of file."""
    found = []
    waiting = list(roots().values())
    while waiting:
        model = waiting.pop()
        if model not in found:
            found.append(model)
            waiting += [below for info in keys(model).values() for below in members(info.annotation)]
    return found


def asked(*args):
    return CliRunner().invoke(main, ["schema", *args])


def test_every_key_says_what_it_is_and_every_number_its_unit():
    known = [(model.__name__, key, info) for model in all_tables() for key, info in keys(model).items()]
    assert len(known) > 500
    assert [(model, key) for model, key, info in known if not info.description] == []
    bare = [
        (model, key)
        for model, key, info in known
        if "number" in words(info.annotation).replace("whole number", "") and not members(info.annotation)
        and "[" not in info.description
    ]  # fmt: skip
    assert bare == []


@pytest.mark.parametrize(
    ("key", "lines"),
    [
        ("shell", ["thickness    nominal wall thickness [m]", "number > 0 <= 1000; must be given"]),
        ("chart", ["frustum", "a circular meridian"]),
        ("chart.frustum", ["r_base  mean radius at z = 0 [m]"]),
        ("support.base.elastic", ["k_face   foundation modulus of the end face [N/m^3]"]),
        ("update.parameter", ["lower bound [unit of the parameter]"]),
        ("rub.closing", ["time_constant  of an exponential closing [s]"]),
        (
            "coating",
            [
                "coating (rim, rub, disk, rotor, cycles-rim, cycles-rub, cycles-disk)",
                "whole number >= 1 <= 10000; 6 if left out",
            ],
        ),
        ("contact", ["differs by the kind of file", "rub.contact: clearance [m]"]),
        ("material.E", ["Young's modulus [Pa]"]),
        ("sweep.vary", ["log     whether steps", "false if left out"]),
        ("scene", ["rods: A scene of rods", "patch: A modal body"]),
    ],
)
def test_a_key_is_explained_on_a_screen(key, lines):
    result = asked(key)
    assert result.exit_code == 0, result.output
    assert all(line in result.stdout for line in lines), result.stdout
    assert "None" not in result.stdout
    assert len(result.stdout.splitlines()) < (40 if key != "scene" else 260)
    assert json.loads(asked(key, "--json").stdout)["tables"][0]["text"] in result.stdout


@pytest.mark.parametrize(("key", "near"), [("shel", "shell"), ("coatng", "coating"), ("material.F", "material")])
def test_a_mistyped_key_is_offered(key, near):
    result = asked(key)
    assert result.exit_code == 2
    assert near in result.stderr.partition("did you mean")[2]


def test_bounds_that_only_ask_for_a_finite_number_are_not_told():
    class Table(BaseModel):
        low: float = Field(ge=-1e25, le=1e19)
        high: float = Field(le=1e25, ge=-1e19)
        names: list[str] = Field(min_length=1)
        pair: list[float] = Field(min_length=2, max_length=2)
        few: list[int] = Field(max_length=3)

    assert [type_words(info) for info in keys(Table).values()] == [
        "number <= 1e+19", "number >= -1e+19", "list of text (not empty)", "list of number (2)",
        "list of whole number (0 to 3)",
    ]  # fmt: skip
