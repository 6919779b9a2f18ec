"""What an update may vary: a named number of a structure, its bounds and its prior.

Names are paths: material.E | nu | rho, shell.thickness, chart.<field>; radius.p8.cos, thickness.p2.sin,
modulus.p4.cos, density.p2.sin (relative harmonics); strip.2.thickness, strip.2.material.E (the second strip; one
without a material of its own follows the wall's); support.<edge>.k_face | k_r | k_theta | k_z | k_rot;
support.<edge>.k_face.p4.cos (how that spring varies along its edge, relative) and support.<edge>.around.p4.cos
(all springs of the edge together). Bolts have support.<edge>.k | k_rot | bolts.3.k, where k is the largest of a
bolt's three stiffnesses and the others keep their ratios; bolts.3.k alone where one edge has bolts.
chart.chord.2, taper.along.1: a station of a law, the root's first. mass.top.1.mass | angle: the first mass on an edge.
Under a ring the same names are those of the ring's own support; the ring itself has support.<edge>.section.width |
depth | diameter | area | I_r | I_z | J and, if it has one, support.<edge>.material.E | nu | rho.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge, outer_support
from casingfem.structure.field.fourier import Field, FourierField
from casingfem.structure.shell.parts import DEFECTS
from casingfem.structure.shell.shell import Shell

HARMONIC = re.compile(r"p(\d+)$")
NUMBERS = (int, float, complex, np.number, tuple)  # what may be varied; a law has one a station
SHARED = "around"  # in the place of a spring: all springs of an edge


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number an update may vary.

    Parameters
    ----------
    name
        Path of the number (module docstring); `updating.parameters.get_value` reads it.
    lower, upper
        Bounds, in the parameter's own unit.
    sigma
        Prior standard deviation about the start value; in decades for a log parameter; None for no prior.
    log
        Vary the decimal logarithm; bounds and values stay as they are.

    >>> Parameter(name="material.E", lower=150e9, upper=250e9, sigma=10e9).lower
    150000000000.0
    """

    name: str
    lower: float
    upper: float
    sigma: float | None = None
    log: bool = False

    def __post_init__(self) -> None:
        if not (np.isfinite(self.lower) and np.isfinite(self.upper) and self.lower < self.upper):
            raise InputError(
                f"{self.name}: bounds must be finite with lower < upper, found {self.lower!r}, {self.upper!r}"
            )
        if self.log and self.lower <= 0.0:
            raise InputError(f"{self.name}: a log parameter needs lower > 0, found {self.lower!r}")
        if self.sigma is not None and not self.sigma > 0.0:
            raise InputError(f"{self.name}: sigma must be positive, found {self.sigma!r}")

    def to_internal(self, value: Any) -> Any:
        """Value -> the number the solver sees (log10 for a log parameter)."""
        return np.log10(value) if self.log else value

    def from_internal(self, x: Any) -> Any:
        """The solver's number -> value."""
        return 10.0**x if self.log else x


def _split(name: str) -> list[str]:
    parts = name.split(".")
    if len(parts) < 2:
        raise InputError(f"{name!r} is no parameter name; expected a path such as material.E")
    return parts


def _path(shell: Shell, name: str) -> list[str]:
    """The parts of a name; bolts.3.k is that of the one edge with bolts."""
    parts = _split(name)
    if parts[0] != "bolts":
        return parts
    bolted = [edge for edge, support in shell.supports.items() if isinstance(outer_support(support), Bolts)]
    if len(bolted) != 1:
        raise InputError(f"{name!r}: {len(bolted)} edges have bolts; name one as support.<edge>.{name}")
    return ["support", bolted[0], *parts]


def _numbered(shell: Shell, parts: list[str]) -> Bolts | Ring | None:
    """The support that a name leads into, if it knows its own numbers."""
    support = shell.supports.get(parts[1]) if parts[0] == "support" and len(parts) > 2 else None
    return support if isinstance(support, Bolts | Ring) else None


def _number(support: Bolts | Ring, name: str, parts: list[str]) -> Any:
    try:
        return support.number(tuple(parts[2:]))
    except KeyError as error:
        raise InputError(f"{name!r}: {error.args[0]}") from None


def _harmonic(name: str, parts: list[str]) -> tuple[int, str]:
    match = HARMONIC.match(parts[0]) if len(parts) == 2 else None
    if match is None or parts[1] not in ("cos", "sin"):
        raise InputError(f"{name!r}: expected a harmonic such as p8.cos, found {'.'.join(parts)!r}")
    return int(match[1]), parts[1]


def _edge(shell: Shell, name: str, parts: list[str]) -> tuple[str, ElasticEdge]:
    support = shell.supports.get(parts[1])
    if not isinstance(support, ElasticEdge):
        found = "no support" if support is None else type(support).__name__
        raise InputError(f"{name!r}: edge {parts[1]!r} has {found}; only elastic edges have stiffnesses")
    known = ElasticEdge.stiffness_names + ((SHARED,) if len(parts) == 5 else ())
    if len(parts) not in (3, 5) or parts[2] not in known:
        raise InputError(f"{name!r}: an elastic edge has {', '.join(known)}")
    return parts[1], support


def _coefficient(name: str, field: Field | None, p: int, part: str) -> Any:
    """One Fourier coefficient of a field, 0 where there is none."""
    return _series(name, field).coefficients(p)[part == "sin"]


def _with_coefficient(name: str, field: Field | None, p: int, part: str, value: Any) -> FourierField:
    return _series(name, field).with_harmonic(p, **{part: value})


def _series(name: str, field: Field | None) -> FourierField:
    """The Fourier series behind a field; an empty one without a field."""
    series = FourierField.of({}) if field is None else getattr(field, "fit", field)
    if not isinstance(series, FourierField):
        raise InputError(f"{name!r}: the field is no Fourier series but {type(field).__name__}")
    return series


def _springs(parts: list[str]) -> tuple[str, ...]:
    """The springs whose pattern a name of five parts addresses."""
    return ElasticEdge.stiffness_names if parts[2] == SHARED else (parts[2],)


def _pattern_value(support: ElasticEdge, name: str, parts: list[str]) -> Any:
    values = [_coefficient(name, support.pattern(spring), *_harmonic(name, parts[3:])) for spring in _springs(parts)]
    if any(value != values[0] for value in values):
        raise InputError(f"{name!r}: the springs of this edge differ there; name one of them")
    return values[0]


def _with_pattern(support: ElasticEdge, name: str, parts: list[str], value: Any) -> ElasticEdge:
    p, part = _harmonic(name, parts[3:])
    if parts[2] == SHARED and not isinstance(support.around, Mapping):
        return replace(support, around=_with_coefficient(name, support.around, p, part, value))
    changed = {spring: _with_coefficient(name, support.pattern(spring), p, part, value) for spring in _springs(parts)}
    return replace(support, around=support.patterns | changed)


def _strip(shell: Shell, name: str, parts: list[str]) -> tuple[int, Any, str]:
    """Index of the strip, the value that owns the number (the strip or its material), and the number's name."""
    place = int(parts[1]) if parts[1].isdecimal() else 0
    if not 1 <= place <= len(shell.strips):
        raise InputError(f"{name!r}: found strip {parts[1]!r}; this shell has {len(shell.strips)}, counted from 1")
    strip = shell.strips[place - 1]
    if parts[2:] == ["thickness"]:
        return place - 1, strip, "thickness"
    if len(parts) != 4 or parts[2] != "material" or parts[3] not in ("E", "nu", "rho"):
        raise InputError(f"{name!r}: a strip has thickness, material.E, material.nu, material.rho")
    if strip.material is None:
        raise InputError(f"{name!r}: strip {place} has no material of its own; vary material.{parts[3]}")
    return place - 1, strip.material, parts[3]


def _mass(shell: Shell, name: str, parts: list[str]) -> tuple[str, int]:
    """Edge of a point mass, and its index there."""
    known = shell.masses.get(parts[1], ()) if len(parts) == 4 and parts[3] in ("mass", "angle") else ()
    place = int(parts[2]) if known and parts[2].isdecimal() else 0
    if not 1 <= place <= len(known):
        has = ", ".join(f"{len(masses)} on {edge!r}" for edge, masses in shell.masses.items()) or "none"
        raise InputError(f"{name!r}: expected mass.<edge>.<number>.mass or .angle; this shell has masses: {has}")
    return parts[1], place - 1


def _plain(shell: Shell, name: str, parts: list[str]) -> tuple[Any, str]:
    owners = {"material": shell.material, "chart": shell.chart, "taper": shell.taper, "shell": shell}
    owners = {word: owner for word, owner in owners.items() if owner is not None}
    owner = owners.get(parts[0])
    if owner is None or len(parts) not in (2, 3):
        starts = ", ".join([*owners, *DEFECTS])
        raise InputError(f"{name!r}: a parameter starts with {starts}, strip, mass or support")
    known = [f.name for f in fields(owner)] if is_dataclass(owner) else []
    numbers = ["thickness"] if owner is shell else [k for k in known if isinstance(getattr(owner, k), NUMBERS)]
    if parts[1] not in numbers:
        raise InputError(f"{name!r}: {parts[0]} has {', '.join(numbers) or 'no numbers'}, not {parts[1]!r}")
    return owner, parts[1]


def _station(name: str, law: Any, parts: list[str]) -> int | None:
    """The place in a law of several stations that a name ends with; None for a plain number."""
    count = len(law) if isinstance(law, tuple) else 0
    if count == 0 and not parts:
        return None
    place = int(parts[0]) if len(parts) == 1 and parts[0].isdecimal() else 0
    if not 1 <= place <= count:
        wanted = f"the number of a station, 1 to {count}, after it" if count else "nothing after it: it is one number"
        raise InputError(f"{name!r}: expected {wanted}")
    return place - 1


def get_value(shell: Shell, name: str) -> Any:
    """The present value of a named number of a shell.

    Raises
    ------
    InputError
        If the structure has no such number.
    """
    parts = _path(shell, name)
    if parts[0] in DEFECTS and len(parts) == 3:
        return _coefficient(name, shell.defects.get(parts[0]), *_harmonic(name, parts[1:]))
    numbered = _numbered(shell, parts)
    if numbered is not None:
        return _number(numbered, name, parts)
    if parts[0] == "support" and len(parts) > 2:
        _, support = _edge(shell, name, parts)
        return _pattern_value(support, name, parts) if parts[3:] else getattr(support, parts[2])
    if parts[0] == "strip":
        _, owner, attribute = _strip(shell, name, parts)
        return getattr(owner, attribute)
    if parts[0] == "mass":
        edge, at = _mass(shell, name, parts)
        return getattr(shell.masses[edge][at], parts[3])
    owner, attribute = _plain(shell, name, parts)
    value = getattr(owner, attribute)
    place = _station(name, value, parts[2:])
    return value if place is None else value[place]


def with_value(shell: Shell, name: str, value: Any) -> Shell:
    """The same shell with one named number replaced; its mesh is kept.

    >>> from casingfem.structure.geometry.chart import Plate
    >>> from casingfem.structure.material import Material
    >>> plate = Shell(chart=Plate(length=1.0, width=0.5), thickness=0.01,
    ...               material=Material(E=210e9, nu=0.3, rho=7800.0))
    >>> with_value(plate, "material.E", 200e9).material.E
    200000000000.0
    """
    get_value(shell, name)  # raises where there is no such number
    parts = _path(shell, name)
    if parts[0] in DEFECTS and len(parts) == 3:
        series = _with_coefficient(name, shell.defects.get(parts[0]), *_harmonic(name, parts[1:]), value)
        defects: dict[str, Any] = {f"{parts[0]}_defect": series}
        return replace(shell, **defects)
    numbered = _numbered(shell, parts)
    if numbered is not None:
        try:
            renewed = numbered.with_number(tuple(parts[2:]), value)
        except KeyError as error:
            raise InputError(f"{name!r}: {error.args[0]}") from None
        return replace(shell, supports={**shell.supports, parts[1]: renewed})
    if parts[0] == "support" and len(parts) > 2:
        edge, support = _edge(shell, name, parts)
        own: dict[str, Any] = {parts[2]: value}
        changed = _with_pattern(support, name, parts, value) if parts[3:] else replace(support, **own)
        return replace(shell, supports={**shell.supports, edge: changed})
    if parts[0] == "strip":
        place, owner, attribute = _strip(shell, name, parts)
        strip = shell.strips[place]
        new = replace(owner, **{attribute: value})
        new = new if owner is strip else replace(strip, material=new)
        return replace(shell, strips=(*shell.strips[:place], new, *shell.strips[place + 1 :]))
    if parts[0] == "mass":
        edge, number = _mass(shell, name, parts)
        own = {parts[3]: value}
        masses = [replace(mass, **own) if k == number else mass for k, mass in enumerate(shell.masses[edge])]
        return replace(shell, masses={**shell.masses, edge: masses})
    owner, attribute = _plain(shell, name, parts)
    law = getattr(owner, attribute)
    at = _station(name, law, parts[2:])
    changes: dict[str, Any] = {attribute: value if at is None else (*law[:at], value, *law[at + 1 :])}
    if owner is not shell:
        changes = {parts[0]: replace(owner, **changes)}
    return replace(shell, **changes)


def check_parameters(shell: Shell, vary: Sequence[Parameter]) -> None:
    """Refuse parameters that address one number twice, start outside their bounds, or may leave the possible.

    Raises
    ------
    InputError
        Naming the parameter.
    """
    seen: dict[str, str] = {}
    for parameter in vary:
        parts = _path(shell, parameter.name)
        numbers = [".".join(parts)]
        if len(parts) == 5 and not _numbered(shell, parts):
            numbers = [".".join([*parts[:2], spring, *parts[3:]]) for spring in _springs(parts)]
        for other in {seen[number] for number in numbers if number in seen}:
            alias = "" if other == parameter.name else f": {other} moves the same number"
            raise InputError(f"{parameter.name} is varied twice{alias}")
        seen |= dict.fromkeys(numbers, parameter.name)
        start = get_value(shell, parameter.name)
        if not parameter.lower <= start <= parameter.upper:
            raise InputError(
                f"{parameter.name}: the start {start:.6g} lies outside [{parameter.lower:.6g}, {parameter.upper:.6g}]"
            )
        for side in ("lower", "upper"):
            try:
                with_value(shell, parameter.name, getattr(parameter, side))
            except ValueError as error:
                raise InputError(f"{parameter.name}: its {side} bound is no possible value: {error}") from error
