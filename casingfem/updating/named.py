"""Every number of a structure by its address, with its unit: those of `addresses.py` that are there to be varied."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.shell.parts import ShellParts
from casingfem.updating.mesh_numbers import mesh_numbers
from casingfem.updating.numbers import SHARED, series

UNITS = {
    "E": "Pa", "nu": "-", "rho": "kg/m^3", "k_r": "N/m^2", "k_theta": "N/m^2", "k_z": "N/m^2", "k_rot": "N/rad",
    "k_face": "N/m^3", "k": "N/m", "mass": "kg", "angle": "rad", "camber": "rad", "twist": "rad", "start": "rad",
    "end": "rad", "area": "m^2", "I_r": "m^4", "I_z": "m^4", "J": "m^4", "along": "-", "across": "-",
}  # by the last word of an address; all others are lengths  # fmt: skip
NUMBERS = (int, float, complex, np.number, tuple)  # what may be varied; a law has one a station
CONSTANTS = ("E", "nu", "rho")


Numbers = Iterator[tuple[str, str]]  # address, unit


def named_numbers(structure: ShellParts | MeshStructure) -> dict[str, str]:
    """The unit of every number that a structure has, by its address; harmonics are those that are there."""
    if isinstance(structure, ShellParts):
        return dict(_of_shell(structure))
    return {name: unit_of(name) for name in mesh_numbers(structure)}


def unit_of(name: str) -> str:
    """The unit of an address by its last word.

    >>> [unit_of(name) for name in ("material.E", "chart.height", "chart.twist.2", "support.base.k_face")]
    ['Pa', 'm', 'rad', 'N/m^3']
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
    along = "rad" if shell.chart.periodic else "of the edge"
    for edge, masses in shell.masses.items():
        for k in range(1, len(masses) + 1):
            yield from ((f"mass.{edge}.{k}.mass", "kg"), (f"mass.{edge}.{k}.angle", along))


def _named(names: Iterable[str]) -> Numbers:
    yield from ((name, unit_of(name)) for name in names)


def numbers_of(owner: Any) -> list[str]:
    """Names of the fields of a chart or taper that hold numbers."""
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
