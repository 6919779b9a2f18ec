"""The kinds of numbers that an update may vary, each of which is read from a shell and replaced in it."""

from collections.abc import Mapping
from dataclasses import dataclass, is_dataclass, replace
from typing import Any, TypeAlias

from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.field.field import Field
from casingfem.structure.field.fourier import FourierField

SHARED = "around"  # in the place of a spring: all springs of an edge


@dataclass(frozen=True, slots=True)
class Plain:
    """A number by the names of fields, keys and places that lead to it from the shell."""

    path: tuple[str | int, ...]

    def value(self, shell: Any) -> Any:
        """The number."""
        found: Any = shell
        for step in self.path:
            is_field = is_dataclass(found)
            found = getattr(found, str(step)) if is_field else found[step]
        return found

    def renewed(self, shell: Any, value: Any) -> Any:
        """The structure with another number there."""
        return put_in(shell, self.path, value)


@dataclass(frozen=True, slots=True)
class FieldHarmonic:
    """A coefficient of an imperfection field, of the radius say: its cos or sin p theta, 0 where it has none."""

    of: str
    p: int
    part: str

    def value(self, shell: Any) -> Any:
        """The coefficient."""
        return series(shell.defects.get(self.of)).coefficients(self.p)[self.part == "sin"]

    def renewed(self, shell: Any, value: Any) -> Any:
        """The shell with another coefficient; a survey's field becomes its Fourier series."""
        field = series(shell.defects.get(self.of)).with_harmonic(self.p, **{self.part: value})
        return Plain((f"{self.of}_defect",)).renewed(shell, field)


@dataclass(frozen=True, slots=True)
class SpringHarmonic:
    """How one spring of an elastic edge, or all of them together ("around"), vary along it: cos or sin p theta."""

    edge: str
    spring: str
    p: int
    part: str

    @property
    def each(self) -> tuple["SpringHarmonic", ...]:
        """The same of every single spring that it moves."""
        names = ElasticEdge.stiffness_names if self.spring == SHARED else (self.spring,)
        return tuple(replace(self, spring=name) for name in names)

    def values(self, shell: Any) -> list[Any]:
        """The coefficient of every spring that it moves."""
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
    """A number that bolts or a ring know by a path of their own."""

    edge: str
    path: tuple[str, ...]

    def value(self, shell: Any) -> Any:
        """The number; KeyError where the support has none of this name."""
        held: Any = shell.supports[self.edge]
        return held.number(self.path)

    def renewed(self, shell: Any, value: Any) -> Any:
        """The shell with another number; KeyError where it cannot be changed."""
        held: Any = shell.supports[self.edge]
        return Plain(("supports", self.edge)).renewed(shell, held.with_number(self.path, value))


Address: TypeAlias = Plain | FieldHarmonic | SpringHarmonic | HeldNumber


def series(field: Field | None) -> Any:
    """The Fourier series behind a field, an empty one without; what is none, as it is."""
    return FourierField.of({}) if field is None else getattr(field, "fit", field)


def put_in(owner: Any, path: tuple[str | int, ...], value: Any) -> Any:
    """The same value, mapping or tuple with what stands at a path replaced."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(owner, Mapping):
        return {**owner, step: put_in(owner[step], rest, value)}
    if isinstance(owner, tuple):
        return tuple(put_in(entry, rest, value) if k == step else entry for k, entry in enumerate(owner))
    return replace(owner, **{str(step): put_in(getattr(owner, str(step)), rest, value)})
