"""Fields and tables with their keys refuse what they do not allow, and numbers that are not plausible."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest
from pydantic import BaseModel, ValidationError
from scipy import constants

import casingfem as cf
import contact as ct
from contact.base.keyed import require_keyed
from contact.io.keys import Key, keyed
from contact.io.plausible import CHECKS, fastest_hz, speed_fault
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


PAGE = (Path(__file__).parents[3] / "docs" / "limits.md").read_text(encoding="utf-8")
LISTED = re.findall(r"^\| ([a-zA-Z]+) \| ([^|]+) \| ([-+.e\d]+) \| ([-+.e\d]+) \| ([^|]+) \|$", PAGE, re.MULTILINE)
UNITS = {
    "GPa": 1e9, "MPa": 1e6, "psi": constants.psi, "g/cm^3": 1e-3 / 1e-6, "t/mm^3": 1e3 / 1e-9, "kg/mm^3": 1.0 / 1e-9,
    "lb/in^3": constants.lb / constants.inch**3, "lbf s^2/in^4": constants.lbf / constants.inch**4,
    "m/s, with E in psi": constants.psi**0.5, "percent": 0.01, "mm": 1e-3, "inches": constants.inch, "um": 1e-6,
    "mm/s^2": 1e-3, "mm/s": 1e-3, "g": 1e-3, "t": 1e3, "g mm": 1e-3 * 1e-3, "kg mm": 1e-3,
}  # fmt: skip
TYPICAL = {  # of the thing that is meant, in each unit that people use for it
    "E": ((210.0, "GPa"), (70e3, "MPa")),
    "rho": ((7.8, "g/cm^3"), (7.8e-9, "t/mm^3"), (2.7e-6, "kg/mm^3"), (0.284, "lb/in^3"), (7.34e-4, "lbf s^2/in^4")),
    "nu": ((30.0, "percent"),), "size": ((400.0, "mm"), (8000.0, "mm"), (40.0, "inches")),
    "thickness": ((3.0, "mm"), (80.0, "mm"), (2.0, "inches")), "zeta": ((0.5, "percent"), (5.0, "percent")),
    "clearance": ((0.3, "mm"), (-2.0, "mm"), (500.0, "um")), "roundness": ((0.5, "mm"), (300.0, "um")),
    "friction": ((15.0, "percent"), (80.0, "percent")), "gravity": ((9810.0, "mm/s^2"),), "mass": ((5e7, "g"),),
    "velocity": ((50e3, "mm/s"), (-50e3, "mm/s")), "unbalance": ((5e3, "g mm"), (2e4, "kg mm")),
    "sound": ((61.6, "m/s, with E in psi"),),
}  # fmt: skip


@pytest.mark.parametrize(("name", "quantity", "low", "high", "reason"), LISTED)
def test_a_number_is_taken_at_the_ends_that_the_page_of_limits_states_and_refused_beyond(
    name, quantity, low, high, reason
):
    check, unit = CHECKS[name], quantity.partition("[")[2].rstrip("] ")
    for end, beyond in ((float(low), -np.inf), (float(high), np.inf)):
        assert check.fault(end) is None
        said = check.fault(float(np.nextafter(end, beyond)))
        assert f"expected {float(low):g} to {float(high):g}{f' {unit}' if unit else ''} ({reason})" in said
    assert quantity.startswith(check.quantity)


def test_every_check_is_on_the_page():
    assert [row[0] for row in LISTED] == list(CHECKS)


@pytest.mark.parametrize(
    ("name", "value", "unit"), [(name, *case) for name, cases in TYPICAL.items() for case in cases]
)
def test_a_usual_number_in_another_unit_is_asked_for_with_its_value_in_si(name, value, unit):
    check = CHECKS[name]
    si = f" {check.unit}" if check.unit else ""
    assert f"in {unit}? {value:g} {unit} are {value * UNITS[unit]:.4g}{si}" in check.question(value)


@pytest.mark.parametrize("name", list(CHECKS))
def test_a_unit_is_asked_for_between_the_usual_ends_only_and_has_its_factor(name):
    check = CHECKS[name]
    assert {slip.unit for slip in check.slips} <= UNITS.keys()
    for slip in check.slips:
        assert slip.factor == pytest.approx(UNITS[slip.unit], rel=1e-5)
        for end, inside in zip(check.usual, (1.001, 0.999), strict=True):
            words = f"in {slip.unit}? "
            others = [one for one in check.slips if one is not slip]
            if not any(check.usual[0] <= end / slip.factor * one.factor <= check.usual[1] for one in others):
                assert words in check.question(end / slip.factor * inside)
            outside = check.question(end / slip.factor / inside)
            assert words not in outside
            assert outside == "" or len(check.slips) > 1


@pytest.mark.parametrize(("name", "value"), [("friction", -15.0), ("mass", -5.0), ("zeta", -1e-300)])
def test_no_unit_is_asked_for_a_number_below_0_that_no_unit_makes_positive(name, value):
    assert CHECKS[name].question(value) == ""


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("E", (5e8, 1.2e12)), ("rho", (500.0, 22_590.0)), ("nu", (0.05, 0.5)), ("size", (0.01, 10.0)),
        ("thickness", (1e-4, 0.1)), ("zeta", (1e-5, 0.1)), ("clearance", (1e-7, 5e-3)), ("roundness", (1e-7, 5e-3)),
        ("friction", (0.02, 1.0)), ("gravity", (1.0, 1000.0)), ("mass", (1e-4, 1e5)), ("velocity", (1e-6, 1e3)),
        ("unbalance", (1e-9, 100.0)), ("sound", (1000.0, 20_000.0)),
    ],
)  # fmt: skip
def test_usual_numbers_of_machines_are_those_that_a_unit_may_lead_to(name, values):
    """Timber to diamond, timber to osmium, a pen to a large casing, a foil to the wall of a pressure vessel."""
    check = CHECKS[name]
    factor = UNITS[check.slips[0].unit]
    for value, outside in zip(values, (0.4, 1.2), strict=True):
        assert f"in {check.slips[0].unit}? " in check.question(
            value * 1.0000001 ** (1 if outside < 1.0 else -1) / factor
        )
        assert f"in {check.slips[0].unit}? " not in check.question(value * outside / factor)


@pytest.mark.parametrize(
    ("hz", "radius", "words"),
    [
        (600.0 / np.pi, 0.5, ""),
        (600.1 / np.pi, 0.5, "at the radius 0.5 m; is this rpm? "),
        (-600.1 / np.pi, 0.5, "m/s, expected at most 600 m/s (tips of fans reach 500 m/s) at the radius 0.5 m"),
        (3599.0 / np.pi, 0.5, "rad/s? "),
        (3601.0 / np.pi, 0.5, "is this rpm? "),
        (35_999.0 / np.pi, 0.5, "is this rpm? "),
        (36_001.0 / np.pi, 0.5, "at the radius 0.5 m"),
        (4774.6, 0.0, ""),
        (4775.0, 0.0, "even at a radius of 0.02 m"),
    ],
)
def test_a_rim_is_no_faster_than_600_m_s_and_rpm_or_rad_s_are_asked_for(hz, radius, words):
    said = speed_fault(hz, radius)
    if not words:
        assert said is None
        return
    assert words in said
    surface = 2.0 * np.pi * abs(hz) * (radius or 0.02)
    assert said.startswith(f"found {hz:g} Hz = {60.0 * hz:,.0f} rpm, a surface speed of {surface:,.0f} m/s")
    assert (f"is this rpm? {hz:g} rpm are {hz / 60.0:.4g} Hz" in said) == (surface <= 36_000.0)
    assert (f"rad/s? {hz:g} rad/s are {hz / 2.0 / np.pi:.4g} Hz" in said) == (surface <= 3600.0)
    assert fastest_hz(radius) == pytest.approx(600.0 / (2.0 * np.pi * (radius or 0.02)))
