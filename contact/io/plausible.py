"""Plausible numbers: for each quantity of an input file a range, its reason, and common mistakes of units.

A key of a table declares its check by its type, `Annotated[float, CHECKS["E"]]`. `implausible` walks a table and
yields what lies outside, with a question that names the slip. `[checks] allow = ["E"]` in the file lets a check pass.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, NamedTuple, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from contact.io.toml import written

CheckName = Literal[
    "E", "rho", "sound", "nu", "size", "thickness", "zeta", "speed", "lean", "clearance", "roundness", "friction",
    "gravity", "frequency", "mass", "stiffness", "compliance", "velocity", "force", "stress", "time", "unbalance",
]  # fmt: skip
Path = tuple[str | int, ...]


class Slip(NamedTuple):
    """A unit that is often used by mistake, and the factor from it to SI."""

    unit: str
    factor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """Range of a quantity: from `lower` to `upper` [unit], for a `reason`.

    A slip is named if it leads to a number from the first to the second of `usual`.

    >>> CHECKS["E"].fault(210.0)
    'found 210 Pa, expected 1e+06 to 1.3e+12 Pa (rubber to diamond); in GPa? 210 GPa are 2.1e+11 Pa'
    >>> CHECKS["E"].fault(210e9)
    """

    name: CheckName
    quantity: str
    unit: str
    lower: float
    upper: float
    reason: str
    usual: tuple[float, ...] = ()
    slips: tuple[Slip, ...] = ()

    def fault(self, value: float) -> str | None:
        """Fault of a value, with the mistake of units that would explain it; None if the value is plausible."""
        if self.lower <= value <= self.upper:
            return None
        unit = f" {self.unit}" if self.unit else ""
        expected = f"{self.lower:g} to {self.upper:g}{unit} ({self.reason})"
        return f"found {value:g}{unit}, expected {expected}{self.question(value)}"

    def question(self, value: float) -> str:
        """Question that names the units which would make a value usual; empty if there are none."""
        if value < 0.0 <= self.lower:  # no unit makes it positive
            return ""
        unit = f" {self.unit}" if self.unit else ""
        fitting = [s for s in self.slips if self.usual[0] <= abs(value * s.factor) <= self.usual[1]]
        asked = [f"in {s.unit}? {value:g} {s.unit} are {value * s.factor:.4g}{unit}" for s in fitting[:2]]
        return f"; {', or '.join(asked)}" if asked else ""


PERCENT = Slip("percent", 1e-2)
LENGTHS = (Slip("mm", 1e-3), Slip("inches", 0.0254))
GAPS = (Slip("mm", 1e-3), Slip("um", 1e-6))
TIP_SPEED = 600.0  # m/s: tips of fans reach 500 m/s, and the strongest disks burst near 600 m/s
SMALLEST_WHEEL = 0.02  # m: radius of the smallest turbocharger wheels, for scenes that give no radius
ALL = (
    Check(
        name="E", quantity="Young's modulus", unit="Pa", lower=1e6, upper=1.3e12, reason="rubber to diamond",
        usual=(5e8, 1.3e12), slips=(Slip("GPa", 1e9), Slip("MPa", 1e6), Slip("psi", 6894.757)),
    ),
    Check(
        name="rho", quantity="density", unit="kg/m^3", lower=20.0, upper=25_000.0, reason="foam to osmium",
        usual=(500.0, 25_000.0),
        slips=(
            Slip("g/cm^3", 1e3), Slip("t/mm^3", 1e12), Slip("kg/mm^3", 1e9), Slip("lb/in^3", 27_679.9),
            Slip("lbf s^2/in^4", 1.068688e7),
        ),
    ),
    Check(
        name="sound", quantity="speed of sound sqrt(E/rho)", unit="m/s", lower=200.0, upper=20_000.0,
        reason="hard rubber to diamond", usual=(1000.0, 20_000.0),
        slips=(Slip("m/s, with E in psi", math.sqrt(6894.757)),),
    ),
    Check(
        name="nu", quantity="Poisson's ratio", unit="", lower=0.0, upper=0.5, reason="cork to rubber",
        usual=(0.05, 0.5), slips=(PERCENT,),
    ),
    Check(
        name="size", quantity="length of a structure", unit="m", lower=1e-3, upper=25.0,
        reason="a chip to the casing of the largest turbine", usual=(1e-2, 10.0), slips=LENGTHS,
    ),
    Check(
        name="thickness", quantity="thickness of a wall", unit="m", lower=1e-5, upper=0.5,
        reason="a foil to the wall of a pressure vessel", usual=(1e-4, 0.1), slips=LENGTHS,
    ),
    Check(
        name="zeta", quantity="damping ratio", unit="", lower=0.0, upper=0.2,
        reason="bolted parts reach 0.05, damping layers 0.2", usual=(1e-5, 0.1), slips=(PERCENT,),
    ),
    Check(
        name="speed", quantity="speed of a rim", unit="m/s", lower=-TIP_SPEED, upper=TIP_SPEED,
        reason="tips of fans reach 500 m/s",
    ),
    Check(
        name="lean", quantity="lean of a blade", unit="degrees", lower=-75.0, upper=75.0,
        reason="a blade that leans more does not reach the rim",
    ),
    Check(
        name="clearance", quantity="gap", unit="m", lower=-0.01, upper=0.01,
        reason="the largest turbines have some millimetres", usual=(1e-7, 5e-3), slips=GAPS,
    ),
    Check(
        name="roundness", quantity="deviation of a radius", unit="m", lower=-0.01, upper=0.01,
        reason="the largest casings deviate by some millimetres", usual=(1e-7, 5e-3), slips=GAPS,
    ),
    Check(
        name="friction", quantity="coefficient of friction", unit="", lower=0.0, upper=2.0,
        reason="steel on steel 0.1 to 0.8, rubber 1", usual=(0.02, 1.0), slips=(PERCENT,),
    ),
    Check(
        name="gravity", quantity="acceleration", unit="m/s^2", lower=0.0, upper=1000.0, reason="100 times gravity",
        usual=(1.0, 1000.0), slips=(Slip("mm/s^2", 1e-3),),
    ),
    Check(
        name="frequency", quantity="frequency", unit="Hz", lower=0.0, upper=1e8, reason="ultrasound ends below 100 MHz",
    ),
    Check(
        name="mass", quantity="mass", unit="kg", lower=1e-12, upper=1e7, reason="dust to the largest machine",
        usual=(1e-4, 1e5), slips=(Slip("g", 1e-3), Slip("t", 1e3)),
    ),
    Check(
        name="stiffness", quantity="stiffness", unit="N/m", lower=1e-9, upper=1e15,
        reason="a thread to a cube of steel a kilometre wide",
    ),
    Check(
        name="compliance", quantity="compliance", unit="m/N", lower=1e-15, upper=1e9,
        reason="a cube of steel a kilometre wide to a thread",
    ),
    Check(
        name="velocity", quantity="velocity", unit="m/s", lower=-1e4, upper=1e4, reason="the fastest projectiles",
        usual=(1e-6, 1e3), slips=(Slip("mm/s", 1e-3),),
    ),
    Check(
        name="force", quantity="force", unit="N", lower=-1e9, upper=1e9, reason="the strongest presses",
    ),
    Check(
        name="stress", quantity="stress", unit="Pa", lower=0.0, upper=1e12, reason="no solid is stronger than diamond",
    ),
    Check(
        name="time", quantity="time", unit="s", lower=1e-12, upper=1e7, reason="a wave through an atom to a season",
    ),
    Check(
        name="unbalance", quantity="mass times eccentricity", unit="kg m", lower=0.0, upper=1000.0,
        reason="a lost blade of the largest turbine causes 100 kg m", usual=(1e-9, 100.0),
        slips=(Slip("g mm", 1e-6), Slip("kg mm", 1e-3)),
    ),
)  # fmt: skip
CHECKS: dict[str, Check] = {check.name: check for check in ALL}
REACH = replace(CHECKS["size"], lower=-CHECKS["size"].upper)  # of coordinates and of single sides, which may be small
FROM_ZERO = {name: replace(CHECKS[name], lower=0.0) for name in ("mass", "stiffness", "compliance", "time")}
ALLOW = "[checks] allow"


class Implausible(NamedTuple):
    """A key, the name of its check, and its fault."""

    key: str
    name: CheckName
    text: str


def advice(name: CheckName) -> str:
    """Text that tells the user how to keep an intended value."""
    return f'if the value is intended, write {ALLOW} = ["{name}"]'


def implausible(table: BaseModel, *, radius: float = 0.0, path: Path = ()) -> Iterator[Implausible]:
    """All values of a table and its subtables that are outside the checks which their keys declare.

    `radius` [m] is that of the rim which rotates at the speeds of the table; 0 if unknown.
    """
    named: dict[str, Any] = {}
    odd: set[str] = set()
    for field, name, checks in declared_by(type(table)):
        value, here = getattr(table, field), (*path, name)
        for check in checks:
            named[check.name] = value
            for place, number in numbers(value, here):
                if text := speed_fault(number, radius) if check.name == "speed" else check.fault(number):
                    odd.add(check.name)
                    yield Implausible(written(place), check.name, text)
        yield from inside(value, radius, here)
    if isinstance(E := named.get("E"), float) and isinstance(rho := named.get("rho"), float) and not odd & {"E", "rho"}:
        if text := CHECKS["sound"].fault(math.sqrt(E / rho)):
            yield Implausible(written((*path, "E")), "sound", f"{E:g} Pa, rho {rho:g} kg/m^3: sound {text}")


def inside(value: Any, radius: float, path: Path) -> Iterator[Implausible]:
    """The same for a nested value, list or table of a key."""
    if isinstance(value, BaseModel):
        yield from implausible(value, radius=radius, path=path)
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from inside(part, radius, (*path, name))
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from inside(part, radius, (*path, k))


def numbers(value: Any, path: Path) -> Iterator[tuple[Path, float]]:
    """The numbers of a key, each with its place: a single one, or those of a list or of a table of names."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        yield path, float(value)
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from numbers(part, (*path, k))
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from numbers(part, (*path, name))


@cache
def declared_by(table: type[BaseModel]) -> list[tuple[str, str, list[Check]]]:
    """Each field of a table, its key in the file, and the checks that it declares."""
    return [(field, info.alias or field, declared(info)) for field, info in table.model_fields.items()]


def declared(info: FieldInfo) -> list[Check]:
    """The checks that a key declares by its type."""
    return [mark for mark in (*info.metadata, *marks(info.annotation)) if isinstance(mark, Check)]


def marks(annotation: Any) -> Iterator[Any]:
    """All metadata inside a type, without tables, which declare their own."""
    if not (isinstance(annotation, type) and issubclass(annotation, BaseModel)):
        yield from getattr(annotation, "__metadata__", ())
        for part in get_args(annotation):
            yield from marks(part)


def question(infos: Sequence[FieldInfo], value: object) -> str:
    """Question that names the units which would make a refused value of a key usual; empty if there are none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    return next((asked for info in infos for check in declared(info) if (asked := check.question(value))), "")


def fastest_hz(radius: float) -> float:
    """Highest plausible speed [turns/s] of a rim of this radius [m]; a radius of 0 means unknown.

    >>> round(fastest_hz(0.6), 2)
    159.15
    """
    return TIP_SPEED / (2.0 * math.pi * (radius if radius > 0.0 else SMALLEST_WHEEL))


def speed_fault(hz: float, radius: float) -> str | None:
    """Fault of a speed [turns/s] of a rim of this radius [m]; a radius of 0 means unknown.

    >>> speed_fault(4800.0, 0.545)[:59]
    'found 4800 Hz = 288,000 rpm, a surface speed of 16,437 m/s,'
    """
    assumed = radius if radius > 0.0 else SMALLEST_WHEEL
    surface = 2.0 * math.pi * abs(hz) * assumed
    if abs(hz) <= fastest_hz(radius):
        return None
    found = f"found {hz:g} Hz = {60.0 * hz:,.0f} rpm, a surface speed of {surface:,.0f} m/s"
    of = f"at the radius {radius:.4g} m" if radius > 0.0 else f"even at a radius of {SMALLEST_WHEEL:g} m"
    expected = f"expected at most {TIP_SPEED:g} m/s ({CHECKS['speed'].reason}) {of}"
    slips = [f"is this rpm? {hz:g} rpm are {hz / 60.0:.4g} Hz" if surface / 60.0 <= TIP_SPEED else ""]
    slips.append(f"rad/s? {hz:g} rad/s are {hz / 2.0 / math.pi:.4g} Hz" if surface <= 6.0 * TIP_SPEED else "")
    asked = ", or ".join(filter(None, slips))
    return f"{found}, {expected}{f'; {asked}' if asked else ''}"


def refused(found: Sequence[Implausible], allow: Sequence[str]) -> list[str]:
    """Lines `key: found X, expected Y; remedy` for all refused values of a file."""
    return [f"{key}: {text}; {advice(name)}" for key, name, text in found if name not in allow]
