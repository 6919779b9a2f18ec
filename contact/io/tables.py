"""The tables of TOML files from their pydantic models: keys of a table, and the table at a path of keys."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import AfterValidator, BaseModel, Field, FiniteFloat, create_model
from pydantic.fields import FieldInfo

from contact.io.keys import Keyed, keyed, required
from contact.io.names import hint
from contact.io.plausible import CHECKS, FROM_ZERO, REACH
from contact.io.toml import entries

Model = type[BaseModel]
WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false"}
BOUNDS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
ANY = 1e20  # a larger bound means only that a number is finite


def at_least(least: float, *, zero: bool = False) -> AfterValidator:
    """Refuse positive numbers that are implausibly small; 0 is allowed where the key allows it."""

    def check(value: float) -> float:
        if value < least and not (zero and value == 0.0):
            raise ValueError(f"found {value!r}, expected {'0 or ' if zero else ''}at least {least:g}")
        return value

    return AfterValidator(check)


Number = Annotated[FiniteFloat, Field(ge=-1e25, le=1e25)]
Positive = Annotated[FiniteFloat, Field(gt=0, le=1e25), at_least(1e-25)]
NotNegative = Annotated[FiniteFloat, Field(ge=0, le=1e25), at_least(1e-25, zero=True)]
Angle = Annotated[FiniteFloat, Field(ge=-360, le=360)]
Length = Annotated[FiniteFloat, Field(gt=0, le=1e3), at_least(1e-7)]  # more than a kilometre is meant in mm
RANGES: dict[str, Any] = {
    "any": Number,
    "positive": Positive,
    "not negative": NotNegative,
    "turn": Angle,
    "below a turn": Annotated[Positive, Field(lt=6.283185307179586)],
    "lean": Annotated[FiniteFloat, Field(gt=-90, lt=90)],
    "ratio": Annotated[FiniteFloat, Field(ge=0, lt=1)],
    "length": Length,
    "place": Annotated[FiniteFloat, Field(ge=-1e3, le=1e3)],
    "poisson": Annotated[FiniteFloat, Field(gt=-1, lt=0.5)],
}
PLAUSIBLE = {
    **CHECKS, "reach": REACH, **{f"{name} or 0": check for name, check in FROM_ZERO.items()},
    "springs around": replace(FROM_ZERO["stiffness"], unit="N/m^2"),
}  # fmt: skip
Value = TypeVar("Value")
Derived = TypeVar("Derived", bound=BaseModel)


def table_of(kind: Any, *names: str, optional: Collection[str] = ()) -> Callable[[type[Derived]], type[Derived]]:
    """Give a table the keys of a dataclass: types, ranges, defaults and meanings of its fields.

    `names` are the fields that the file may state, by default all with a `Key`. A file may leave out the `optional`
    fields, which then come from another source. The table's class defines only keys that are not fields.

    >>> from contact import Wall
    >>> @table_of(Wall)
    ... class WallTable(BaseModel):
    ...     pass
    >>> [(name, info.description, type_words(info)) for name, info in keys(WallTable).items()]
    [('x', 'position of the wall [m]', 'number')]
    """
    stated = [one for one in keyed(kind) if not names or one.name in names]
    chosen = [one._replace(optional=True, default=None) if one.name in optional else one for one in stated]
    found: Any = {one.file: (_annotation(one), _info(one)) for one in chosen}

    def derived(table: type[Derived]) -> type[Derived]:
        made = create_model(table.__name__, __base__=table, __module__=table.__module__, __doc__=table.__doc__, **found)
        order = dict.fromkeys(["kind"] * ("kind" in made.model_fields) + [*found, *made.model_fields])
        made.__pydantic_fields__ = {name: made.model_fields[name] for name in order}  # those of the value first
        made.model_rebuild(force=True)
        return made

    return derived


def _annotation(one: Keyed) -> Any:
    """The type of a field as files state it."""
    key, found = one.key, _bare(one)
    if key.stations:
        found = found | Annotated[list.__class_getitem__(found), Field(min_length=1, max_length=key.stations)]
    found = Annotated[found, PLAUSIBLE[key.check]] if key.check else found
    return found | None if one.optional else found


def _bare(one: Keyed) -> Any:
    """The type of one number, whole number or text of a field, with its bounds."""
    key = one.key
    bounds: dict[str, Any] = {name: end for name, end in (("ge", key.least), ("le", key.most)) if end is not None}
    if one.type is float:
        return (
            Annotated[FiniteFloat if key.range == "any" else RANGES[key.range], Field(**bounds)]
            if bounds
            else (RANGES[key.range])
        )
    if one.type is int:
        return Annotated[int, Field(**({"ge": 1} | bounds))]
    return Annotated[str, Field(min_length=1)] if one.type is str else one.type


def _info(one: Keyed) -> Any:
    """Meaning, name in the file and default of a field."""
    given: dict[str, Any] = {"description": one.key.text, "alias": one.key.alias or None}
    if required(one):
        return Field(**given)
    return Field(
        default=math.degrees(one.default) if one.key.degrees and one.default is not None else one.default, **given
    )


def value_of(table: BaseModel, kind: Callable[..., Value], **more: Any) -> Value:
    """The value that a table states, from its keyed fields; `more` gives further fields."""
    stated = [one for one in keyed(kind) if one.file in type(table).model_fields and one.name not in more]
    return kind(**{one.name: one.of_file(getattr(table, one.file)) for one in stated}, **more)


def keys(model: Model) -> dict[str, FieldInfo]:
    """The keys of a table as files write them; a field has an alias where Python reserves the word, such as `from`."""
    return {info.alias or name: info for name, info in model.model_fields.items()}


def members(annotation: Any) -> list[Model]:
    """All table models inside a type."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in members(part)]


def kinds(model: Model) -> tuple[Any, ...]:
    """The values a table's `kind` may have; empty for a table without."""
    return get_args(model.model_fields["kind"].annotation) if "kind" in model.model_fields else ()


def models_at(models: Sequence[Model], path: Sequence[str | int], data: Any) -> list[Model]:
    """The table models to which a path of keys leads from `models`, by the `kind` values in the file."""
    found, here = list(models), data
    for part in path:
        here = here[part]
        found = [model for m in found if part in keys(m) for model in members(keys(m)[str(part)].annotation)] or found
        named = entries(here).get("kind")
        found = [m for m in found if named in kinds(m)] or found
    return found


def resolved(loc: Sequence[str | int], kind: str, data: Any) -> tuple[str | int, ...]:
    """The path of keys of a pydantic error, without the tags that pydantic inserts for members of a union."""
    path: list[str | int] = []
    here = data
    for k, part in enumerate(loc):
        inside = entries(here)
        if part in inside:
            here = inside[part]
            path.append(part)
        elif k == len(loc) - 1 and kind == "missing":
            path.append(part)
    return tuple(path)


def unknown(name: str, models: Sequence[Model]) -> str:
    """Text that names the expected keys of a table for an unknown key, the most similar one first."""
    known = list(dict.fromkeys(key for m in models for key in keys(m)))
    return f"expected one of {', '.join(known)}{hint(name, known)}"


def wanted(name: str, models: Sequence[Model]) -> str:
    """Text for a missing key: the values of a choice with the meaning in parentheses, otherwise the meaning.

    >>> from pydantic import Field
    >>> class Wall(BaseModel):
    ...     side: Literal["in", "out", "both"] = Field(description="side of the layer")
    ...     thickness: float = Field(description="thickness [m]")
    >>> wanted("side", [Wall]), wanted("thickness", [Wall])
    ('"in", "out" or "both" (side of the layer)', 'thickness [m]')
    """
    info = next((keys(m)[name] for m in models if name in keys(m)), None)
    if info is None:
        return ""
    meaning = info.description or ""
    if get_origin(info.annotation) is not Literal:
        return meaning
    choice = " or ".join(words(info.annotation).rsplit(", ", 1))
    return f"{choice} ({meaning})" if meaning else choice


def type_words(info: FieldInfo) -> str:
    """Types and bounds of a key's values, in words.

    >>> from pydantic import Field
    >>> class Wall(BaseModel):
    ...     thickness: float = Field(gt=0)
    ...     sides: list[Literal["in", "out"]] | None = Field(default=None, min_length=1, max_length=2)
    >>> [type_words(info) for info in keys(Wall).values()]
    ['number > 0', 'list of "in", "out" (1 to 2)']
    """
    limits = [(sign, getattr(m, name, None)) for name, sign in BOUNDS.items() for m in info.metadata]
    told = [f"{sign} {limit:g}" for sign, limit in limits if limit is not None and abs(limit) < ANY]
    return " ".join([words(info.annotation), *told, *length(info.metadata)])


def length(metadata: Sequence[Any]) -> list[str]:
    """Allowed length of a list or a text, in words; empty if it has no limit."""
    least, most = (
        next((found for m in metadata if (found := getattr(m, name, None)) is not None), None)
        for name in ("min_length", "max_length")
    )
    if most is None:
        return [] if least is None else ["(not empty)" if least == 1 else f"({least} or more)"]
    return [f"({most})" if least == most else f"({least or 0} to {most})"]


def words(annotation: Any) -> str:
    """A type in words."""
    origin, inside = get_origin(annotation), get_args(annotation)
    if annotation in WORDS:
        return WORDS[annotation]
    if origin is Annotated:
        known = FieldInfo.from_annotation(annotation)
        return type_words(known) if known.annotation is not annotation else words(inside[0])
    if origin is Literal:
        return ", ".join(f'"{one}"' if isinstance(one, str) else str(one) for one in inside)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(words(part) for part in inside if part is not NoneType))
    if origin is list:
        return f"list of {words(inside[0])}"
    if origin is dict:
        return f"table of names -> {words(inside[1])}"
    return "table" if members(annotation) else str(annotation)
