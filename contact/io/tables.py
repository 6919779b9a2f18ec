"""The tables of TOML files by their pydantic models: the keys of a table, the table that a path of keys leads to."""

from __future__ import annotations

from collections.abc import Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import AfterValidator, BaseModel
from pydantic.fields import FieldInfo

from contact.io.names import hint
from contact.io.toml import entries

Model = type[BaseModel]
WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false"}
BOUNDS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
ANY = 1e20  # a bound beyond says no more than that a number is finite


def at_least(least: float, *, zero: bool = False) -> AfterValidator:
    """Refuse positive numbers too small to be meant; 0 is none of them where the key may be 0."""

    def check(value: float) -> float:
        if value < least and not (zero and value == 0.0):
            raise ValueError(f"found {value!r}, expected {'0 or ' if zero else ''}at least {least:g}")
        return value

    return AfterValidator(check)


def keys(model: Model) -> dict[str, FieldInfo]:
    """The keys of a table as the file writes them: `from`, which Python reserves, is the alias of a field."""
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
    """The table models that a path of keys leads to, from `models`, by the kinds that the file names."""
    found, here = list(models), data
    for part in path:
        here = here[part]
        found = [model for m in found if part in keys(m) for model in members(keys(m)[str(part)].annotation)] or found
        named = entries(here).get("kind")
        found = [m for m in found if named in kinds(m)] or found
    return found


def resolved(loc: Sequence[str | int], kind: str, data: Any) -> tuple[str | int, ...]:
    """The path of keys of a pydantic error of a kind without the tags that it puts in for the members of a union."""
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
    """What is expected where a table has no such key, with the nearest that it has."""
    known = list(dict.fromkeys(key for m in models for key in keys(m)))
    return f"expected one of {', '.join(known)}{hint(name, known)}"


def type_words(info: FieldInfo) -> str:
    """What a key may hold, in words and bounds.

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
    """How many a list or a text may have, in words; empty where nothing is said."""
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
