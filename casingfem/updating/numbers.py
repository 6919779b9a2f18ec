"""The numbers that an update may vary: their kinds, with functions to read and replace them, and a list.

Numbers of an imported part: material.E | nu | rho; shell.thickness; solid.material.<group>.E,
shell.material.<group>.rho (groups of cells with a material of their own); shell.thicknesses.<group>;
support.<group>.k_face.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from casingfem.errors import ModelError
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.field.field import Field
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.shell.parts import ShellParts

SHARED = "around"  # in the place of a spring: all springs of an edge
CONSTANTS = ("E", "nu", "rho")
UNITS = {
    "E": "Pa", "nu": "-", "rho": "kg/m^3", "k_r": "N/m^2", "k_theta": "N/m^2", "k_z": "N/m^2", "k_rot": "N/rad",
    "k_face": "N/m^3", "k": "N/m", "mass": "kg", "angle": "rad", "camber": "rad", "twist": "rad", "start": "rad",
    "end": "rad", "area": "m^2", "I_r": "m^4", "I_z": "m^4", "J": "m^4", "along": "-", "across": "-",
    "cos": "-", "sin": "-",
}  # by the last word of an address; all others are lengths  # fmt: skip
NUMBERS = (int, float, complex, np.number, tuple)  # what may be varied; a law has one a station


@dataclass(frozen=True, slots=True)
class Plain:
    """A number given by the fields, keys and indices that lead to it from the structure."""

    path: tuple[str | int, ...]

    def value(self, shell: Any) -> Any:
        """The number."""
        found: Any = shell
        for step in self.path:
            found = getattr(found, str(step)) if is_dataclass(found) else found[step]
        return found

    def renewed(self, shell: Any, value: Any) -> Any:
        """The structure with this number replaced."""
        return put_in(shell, self.path, value)


@dataclass(frozen=True, slots=True)
class FieldHarmonic:
    """A coefficient of an imperfection field, such as the radius: its cos or sin p theta, 0 if absent."""

    of: str
    p: int
    part: str

    def value(self, shell: Any) -> Any:
        """The coefficient."""
        return series(shell.defects.get(self.of)).coefficients(self.p)[self.part == "sin"]

    def renewed(self, shell: Any, value: Any) -> Any:
        """The shell with this coefficient replaced; a survey's field becomes its Fourier series."""
        field = series(shell.defects.get(self.of)).with_harmonic(self.p, **{self.part: value})
        return Plain((f"{self.of}_defect",)).renewed(shell, field)


@dataclass(frozen=True, slots=True)
class SpringHarmonic:
    """One harmonic of the variation of one spring, or of all together ("around"), along an elastic edge."""

    edge: str
    spring: str
    p: int
    part: str

    @property
    def each(self) -> tuple["SpringHarmonic", ...]:
        """The same number for every single spring that it changes."""
        names = ElasticEdge.stiffness_names if self.spring == SHARED else (self.spring,)
        return tuple(replace(self, spring=name) for name in names)

    def values(self, shell: Any) -> list[Any]:
        """The coefficient of every spring that it changes."""
        held: Any = shell.supports[self.edge]
        return [series(held.pattern(one.spring)).coefficients(self.p)[self.part == "sin"] for one in self.each]

    def value(self, shell: Any) -> Any:
        """The coefficient, which all springs of "around" share."""
        return self.values(shell)[0]

    def renewed(self, shell: Any, value: Any) -> Any:
        """The shell with another coefficient."""
        held: Any = shell.supports[self.edge]
        change = {self.part: value}
        if self.spring == SHARED and not isinstance(held.around, Mapping):
            around = series(held.around).with_harmonic(self.p, **change)
        else:
            springs = [one.spring for one in self.each]
            around = held.patterns | {k: series(held.pattern(k)).with_harmonic(self.p, **change) for k in springs}
        return Plain(("supports", self.edge, "around")).renewed(shell, around)


@dataclass(frozen=True, slots=True)
class HeldNumber:
    """A number inside bolts or a ring, by its own path."""

    edge: str
    path: tuple[str, ...]

    def value(self, shell: Any) -> Any:
        """The number; raises KeyError if the support has none of this name."""
        held: Any = shell.supports[self.edge]
        return held.number(self.path)

    def renewed(self, shell: Any, value: Any) -> Any:
        """The shell with this number replaced; raises KeyError if it cannot be changed."""
        held: Any = shell.supports[self.edge]
        return Plain(("supports", self.edge)).renewed(shell, held.with_number(self.path, value))


Address: TypeAlias = Plain | FieldHarmonic | SpringHarmonic | HeldNumber


def series(field: Field | None) -> Any:
    """Fourier series of a field, empty if there is none; other objects unchanged."""
    return FourierField.of({}) if field is None else getattr(field, "fit", field)


def put_in(owner: Any, path: tuple[str | int, ...], value: Any) -> Any:
    """The same object, mapping or tuple with the entry at a path replaced."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(owner, Mapping):
        return {**owner, step: put_in(owner[step], rest, value)}
    if isinstance(owner, tuple):
        return tuple(put_in(entry, rest, value) if k == step else entry for k, entry in enumerate(owner))
    return replace(owner, **{str(step): put_in(getattr(owner, str(step)), rest, value)})


Numbers = Iterator[tuple[str, str]]  # address, unit


def named_numbers(structure: ShellParts | MeshStructure) -> dict[str, str]:
    """Unit of every number of a structure, by its address; only existing harmonics are listed."""
    if isinstance(structure, ShellParts):
        return dict(_of_shell(structure))
    return {name: unit_of(name) for name in mesh_numbers(structure)}


def unit_of(name: str) -> str:
    """Unit of an address, from its last word.

    >>> names = "material.E", "chart.height", "chart.twist.2", "support.base.k_face", "support.base.k_face.p8.cos"
    >>> [unit_of(name) for name in names]
    ['Pa', 'm', 'rad', 'N/m^3', '-']
    """
    return UNITS.get(next(word for word in reversed(name.split(".")) if not word.isdecimal()), "m")


def _of_shell(shell: ShellParts) -> Numbers:
    yield from _named(f"material.{name}" for name in CONSTANTS)
    yield "shell.thickness", "m"
    for word, owner in (("chart", shell.chart), ("taper", shell.taper)):
        yield from _of_part(word, owner)
    for quantity, field in shell.defects.items():
        yield from _of_series(quantity, field)
    for k, strip in enumerate(shell.strips, 1):
        yield f"strip.{k}.thickness", "m"
        yield from _named(f"strip.{k}.material.{name}" for name in CONSTANTS if strip.material is not None)
    for edge, support in shell.supports.items():
        yield from ((f"support.{edge}.{name}", unit) for name, unit in _of_support(support))
    along = "rad" if shell.chart.periodic else "rad or m"
    for edge, masses in shell.masses.items():
        for k in range(1, len(masses) + 1):
            yield from ((f"mass.{edge}.{k}.mass", "kg"), (f"mass.{edge}.{k}.angle", along))


def _named(names: Iterable[str]) -> Numbers:
    yield from ((name, unit_of(name)) for name in names)


def numbers_of(owner: Any) -> list[str]:
    """Names of the fields of a chart or taper that contain numbers."""
    known = [field.name for field in fields(owner)] if is_dataclass(owner) else []
    return [name for name in known if isinstance(getattr(owner, name), NUMBERS)]


def _of_part(word: str, owner: Any) -> Numbers:
    for name in numbers_of(owner):
        law = getattr(owner, name)
        stations = [f".{k}" for k in range(1, len(law) + 1)] if isinstance(law, tuple) else [""]
        yield from _named(f"{word}.{name}{station}" for station in stations)


def _of_series(word: str, field: Any) -> Numbers:
    known = series(field)
    if isinstance(known, FourierField):
        yield from ((f"{word}.p{p}.{part}", "-") for p in known.harmonics for part in ("cos", "sin")[: 2 if p else 1])


def _of_support(support: Any) -> Numbers:
    if isinstance(support, ElasticEdge):
        yield from _named(support.stiffness_names)
        shared = not isinstance(support.around, Mapping)
        for spring in (SHARED,) if shared else support.patterns:
            yield from _of_series(spring, support.around if shared else support.pattern(spring))
    elif isinstance(support, Bolts):
        yield from (("k", "N/m"), ("k_rot", "N m/rad"), *((f"bolts.{k}.k", "N/m") for k in range(1, support.count + 1)))
    elif isinstance(support, Ring):
        yield from _named(f"section.{name}" for name in ("width", "depth", "area", "I_r", "I_z", "J"))
        yield from _named(f"material.{name}" for name in CONSTANTS if support.material is not None)
        own = support.support
        yield from _named(own.stiffness_names) if isinstance(own, ElasticEdge) else _of_support(own)


def mesh_numbers(structure: MeshStructure) -> dict[str, Plain]:
    """Addresses and units of the numbers of an imported part that may be varied."""
    if not isinstance(structure, Solid | MeshShell):
        raise ModelError("structure-chart", f"update: found {type(structure).__name__}, expected a Solid or MeshShell")
    word = "solid" if isinstance(structure, Solid) else "shell"
    found = {f"material.{name}": Plain(("material", name)) for name in CONSTANTS}
    for group in structure.materials:
        found |= {f"{word}.material.{group}.{name}": Plain(("materials", group, name)) for name in CONSTANTS}
    if isinstance(structure, MeshShell):
        found["shell.thickness"] = Plain(("thickness",))
        found |= {f"shell.thicknesses.{group}": Plain(("thicknesses", group)) for group in structure.thicknesses}
    for group, support in structure.supports.items():
        if isinstance(support, ElasticEdge):
            found[f"support.{group}.k_face"] = Plain(("supports", group, "k_face"))
    return found
