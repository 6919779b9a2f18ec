"""Meaning and range of a field, stated beside it; checks of values, input files and docs use them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

Range = Literal[
    "any", "positive", "not negative", "turn", "below a turn", "lean", "ratio", "length", "place", "poisson"
]


@dataclass(frozen=True, slots=True)
class Key:
    """Metadata of a dataclass's field: `length: Annotated[float, Key("length [m]", "positive")]`.

    Attributes
    ----------
    text
        Meaning, with the unit in brackets.
    range
        Range of a number; the ranges in files are `RANGES` of `contact.io.tables`. In a file a "length" and a "place"
        of a structure are at most a kilometre, a "turn" lies from -360 to 360 degrees, a "lean" between -90 and 90
        degrees, an angle "below a turn" between 0 and 2 pi.
    check
        Name of the check of plausibility that a file's number must pass (`contact.io.plausible`); none if empty.
    least, most
        Bounds of a number, the ends included; they do not apply to texts and lists of stations.
    degrees
        Whether the value is an angle in radians that a file states in degrees, under the name that ends in `_deg`.
    stations
        Number of values that a file may state in a list in place of one number; 0 for a single number.
    alias
        Name in a file where it differs, such as `from`, which Python reserves; the field's name if empty.
    """

    text: str
    range: Range = "any"
    check: str = ""
    least: float | None = None
    most: float | None = None
    degrees: bool = False
    stations: int = 0
    alias: str = ""


class Keyed(NamedTuple):
    """A field with its key: name, type without metadata and None, whether it may be None, default or MISSING."""

    name: str
    key: Key
    type: Any
    optional: bool
    default: Any

    @property
    def file(self) -> str:
        """Name of the key in a file."""
        return f"{self.name}_deg" if self.key.degrees else self.name

    def of_file(self, stated: Any) -> Any:
        """The value that a file states: degrees become radians, a list of stations a tuple."""
        if isinstance(stated, list):
            return tuple(map(self.of_file, stated))
        return math.radians(stated) if self.key.degrees and stated is not None else stated


@cache
def keyed(kind: Any) -> tuple[Keyed, ...]:
    """The fields of a dataclass that have a key, in its order.

    >>> @dataclass
    ... class Wall:
    ...     x: Annotated[float, Key("place [m]")] = 0.0
    >>> [(one.name, one.key.text, one.type, one.default) for one in keyed(Wall)]
    [('x', 'place [m]', <class 'float'>, 0.0)]
    """
    return tuple(_found(kind))


def _found(kind: Any) -> Iterator[Keyed]:
    hints = get_type_hints(kind, include_extras=True)
    for field in fields(kind):
        if get_origin(hints[field.name]) is not Annotated:
            continue
        inside, *metadata = get_args(hints[field.name])
        key = next((part for part in metadata if isinstance(part, Key)), None)
        if key is None:
            continue
        parts = get_args(inside) if get_origin(inside) in (Union, UnionType) else (inside,)
        bare = [part for part in parts if part is not NoneType]
        yield Keyed(field.name, key, bare[0], len(bare) < len(parts), field.default)


def required(one: Keyed) -> bool:
    """Whether a field has no default."""
    return one.default is MISSING
