"""Fields with their keys: a value refuses what they do not allow, and the table of a file has the same keys."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, ValidationError

import casingfem as cf
import contact as ct
from contact.base.keyed import require_keyed
from contact.io.keys import Key, keyed
from contact.io.tables import keys, table_of, type_words, value_of

CANDIDATES = (-400.0, -1.0, 0.0, 1e-30, 1e-20, 1.0, 400.0, 1e24, 1e26, float("inf"), float("nan"))
SECTION = {"length": 1.0, "width": 0.1, "height": 0.1, "E": 1e9, "rho": 1e3}
GIVEN = {
    ct.Rod: {"length": 1.0, "area": 1.0, "E": 1.0, "rho": 1.0},
    ct.PointMass: {"mass": 1.0},
    ct.Wall: {},
    ct.bodies.HingedBeam: SECTION,
    ct.gaps.Cantilever: SECTION,
    cf.Material: {"E": 2e11, "nu": 0.3, "rho": 7800.0},
    cf.Frustum: {"r_base": 0.5, "r_top": 0.4, "height": 0.2},
    cf.Cylinder: {"radius": 0.5, "height": 0.2},
    cf.Panel: {"radius": 0.5, "length": 0.2, "angle": 1.0},
    cf.Plate: {"length": 0.2, "width": 0.1},
}


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A value with one field of each sort, and one that no file states."""

    stiffness: Annotated[float, Key("stiffness [N/m]", "positive", "stiffness")]
    coils: Annotated[int, Key("number of coils")] = 3
    rest: Annotated[float | None, Key("length at rest [m]", "not negative")] = None
    end: Annotated[Literal["open", "closed"], Key("form of its ends")] = "open"
    label: str = ""

    def __post_init__(self):
        require_keyed(self)


@table_of(Spring)
class SpringTable(BaseModel):
    """[spring]"""

    kind: Literal["spring"]


def test_a_table_has_the_types_ranges_defaults_and_meanings_of_the_fields():
    found = {name: (info.description, type_words(info), info.is_required()) for name, info in keys(SpringTable).items()}
    assert found == {
        "kind": (None, '"spring"', True),
        "stiffness": ("stiffness [N/m]", "number > 0", True),
        "coils": ("number of coils", "whole number >= 1", False),
        "rest": ("length at rest [m]", "number >= 0", False),
        "end": ("form of its ends", '"open", "closed"', False),
    }
    assert SpringTable.__doc__ == "[spring]"
    assert SpringTable(kind="spring", stiffness=2.0).model_dump(exclude={"kind"}) == {
        "stiffness": 2.0, "coils": 3, "rest": None, "end": "open"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"stiffness": 0.0}, "stiffness: found 0.0, expected a finite number > 0"),
        ({"coils": 0}, "coils: found 0, expected a whole number >= 1"),
        ({"rest": -1.0}, "rest: found -1.0, expected a finite number >= 0"),
        ({"end": "bent"}, "end: found 'bent', expected 'open' or 'closed'"),
    ],
)
def test_a_value_refuses_what_its_key_does_not_allow(wrong, words):
    with pytest.raises(ct.InputError) as raised:
        Spring(**{"stiffness": 1.0, **wrong})
    assert str(raised.value) == words


@pytest.mark.parametrize("kind", GIVEN, ids=lambda kind: kind.__name__)
def test_a_value_takes_every_number_that_its_table_takes(kind):
    @table_of(kind)
    class Stated(BaseModel):
        pass

    for one in keyed(kind):
        for number in CANDIDATES if one.type is float else ():
            given = {**GIVEN[kind], one.name: number}
            try:
                table = Stated.model_validate(given)
            except ValidationError:
                continue
            assert getattr(value_of(table, kind), one.name) == number


@dataclass(frozen=True, kw_only=True)
class Hook:
    """A value in radians, with stations, under other names in a file."""

    opening: Annotated[float, Key("opening [degrees]", "turn", degrees=True)] = 0.0
    width: Annotated[float | tuple[float, ...], Key("width [m]", "length", stations=3)]
    start: Annotated[float, Key("where it begins [m]", "place", alias="from")]
    turns: Annotated[int, Key("number of turns", least=0, most=9)] = 2


@table_of(Hook)
class HookTable(BaseModel):
    """[hook]"""

    note: str = "none"


def test_a_file_states_degrees_lists_of_stations_and_other_names():
    found = {name: type_words(info) for name, info in keys(HookTable).items()}
    assert found == {
        "opening_deg": "number >= -360 <= 360", "width": "number > 0 <= 1000 or list of number > 0 <= 1000 (1 to 3)",
        "from": "number >= -1000 <= 1000", "turns": "whole number >= 0 <= 9", "note": "text",
    }  # fmt: skip
    table = HookTable.model_validate({"opening_deg": 90.0, "width": [0.1, 0.2], "from": -1.5})
    assert value_of(table, Hook) == Hook(opening=math.pi / 2.0, width=(0.1, 0.2), start=-1.5)
    assert value_of(table, Hook, turns=7).turns == 7


@pytest.mark.parametrize("wrong", [{"width": []}, {"width": [1.0] * 4}, {"turns": 10}, {"turns": -1}, {"from": 2e3}])
def test_a_file_refuses_what_the_bounds_of_a_key_do_not_allow(wrong):
    with pytest.raises(ValidationError):
        HookTable.model_validate({"width": 0.1, "from": 0.0} | wrong)
