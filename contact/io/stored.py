"""Frozen values of both packages as npz files: plain arrays by their paths, and a JSON text for the rest.

A value is a tree of dataclasses, named tuples, tuples, mappings, arrays, numbers and words. Each array is a member of
its own, under the path that leads to it (`freq`, `grid.nodes`), so that any program reads it; `document` states the
structure of the tree. An object that occurs twice is written once. A file can only create values of the two packages,
which pass their own checks; there is no pickle.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from contact.io.npz import DAMAGE, load_npz, write_npz

FORMAT = "casingfem-value-1"
OWN = ("casingfem.", "contact.")
WORDS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}  # numbers that JSON has no word for
MANY: dict[str, Callable[..., Any]] = {"tuple": tuple, "list": list, "set": frozenset}
MAPS: dict[str, Callable[..., Any]] = {"dict": dict, "mapping": lambda pairs: MappingProxyType(dict(pairs))}


class StoredError(ValueError):
    """A value that cannot be stored, or a file without a value: name, finding, expectation."""


def below(name: str, part: object) -> str:
    """The name of a part below this name; the root has an empty name."""
    return f"{name}.{part}" if name else f"{part}"


def read_only(value: Any) -> Any:
    """The same value with all its arrays read-only, also inside tuples, mappings and frozen values."""
    if isinstance(value, np.ndarray):
        value.setflags(write=False)
    for entry in parts_of(value):
        read_only(entry)
    return value


def parts_of(value: Any) -> Iterable[Any]:
    """Entries of a collection or fields of a dataclass; empty for other values."""
    if isinstance(value, tuple | list | frozenset):
        return value
    if isinstance(value, Mapping):
        return value.values()
    return [getattr(value, field.name, None) for field in fields(value)] if is_dataclass(value) else ()


def save_value(path: str | os.PathLike[str], value: Any, beside: Mapping[str, Any] | None = None) -> Path:
    """Write a frozen value, whole or not at all; `beside` are additional arrays for other programs.

    Raises
    ------
    StoredError
        For a part that is neither plain data nor a value of the two packages, such as a function.
    """
    packing = Packing()
    document = packing.packed(value, "")
    arrays = {"format": np.array(FORMAT), "document": np.array(json.dumps(document)), **packing.arrays}
    return write_npz(path, arrays | dict(beside or {}))


def load_value(path: str | os.PathLike[str], kind: type) -> Any:
    """Read a value of a kind from a file that `save_value` wrote.

    Raises
    ------
    StoredError
        For another kind of file, a value of another class, or one that its own checks refuse.
    """
    try:
        arrays = load_npz(path)
        document = json.loads(str(arrays["document"])) if "document" in arrays else None
        found = Unpacking(arrays).unpacked(document)
    except (*DAMAGE, AttributeError, ImportError, KeyError, TypeError) as error:
        raise StoredError(f"{path}: found no value that can be read ({error}), expected a {kind.__name__}") from error
    if not isinstance(found, kind):
        raise StoredError(f"{path}: found a {type(found).__name__}, expected a {kind.__name__}")
    return found


class Packing:
    """State of packing: arrays by name, and the objects met so far."""

    def __init__(self) -> None:
        self.arrays: dict[str, Any] = {}
        self._met: dict[int, tuple[int, Any]] = {}  # by identity: number, and the part itself, which so stays alive

    def packed(self, part: Any, name: str) -> Any:
        """The JSON form of a part."""
        return {"same": self._met[id(part)][0]} if id(part) in self._met else written(part, name, self)

    def values(self, part: Any, values: Mapping[str, Any], name: str) -> dict[str, Any]:
        """JSON forms of named parts, by the class of the value."""
        kind = f"{type(part).__module__}:{type(part).__qualname__}"
        return self.numbered(part, {"value": kind, "fields": self.inside(values, name)})

    def inside(self, values: Mapping[str, Any], name: str) -> dict[str, Any]:
        """JSON forms of parts by their names."""
        return {key: self.packed(value, below(name, key)) for key, value in values.items()}

    def entries(self, part: Iterable[Any], name: str) -> list[Any]:
        """JSON forms of parts by their positions."""
        return [self.packed(entry, below(name, k + 1)) for k, entry in enumerate(part)]

    def pairs(self, part: Mapping[Any, Any], name: str) -> list[Any]:
        """JSON forms of keys with their values."""
        return [[self.packed(key, name), self.packed(entry, below(name, key))] for key, entry in part.items()]

    def numbered(self, part: Any, document: dict[str, Any]) -> dict[str, Any]:
        """The JSON form of a part that is written once, although the tree may contain it several times."""
        number = len(self._met)
        self._met[id(part)] = number, part
        return document | {"number_of": number}

    def array(self, part: Any, name: str) -> str:
        """The name under which an array is stored."""
        while name in self.arrays or name in ("format", "document"):
            name += "_"
        self.arrays[name] = part
        return name


def written(part: Any, name: str, packing: Packing) -> Any:
    """JSON form of a part by its class; of a sparse matrix or dataclass by its fields."""
    if isinstance(part, np.generic):
        return packing.packed(part.item(), name)
    if part is None or isinstance(part, bool | str | int):
        return part
    if isinstance(part, float):
        return part if math.isfinite(part) else {"number": str(part)}
    if isinstance(part, complex):
        return {"complex": [packing.packed(part.real, name), packing.packed(part.imag, name)]}
    if isinstance(part, np.ndarray):
        if part.dtype.kind not in "biufcU":
            raise StoredError(f"{name}: found an array of {part.dtype}, expected one of numbers or text")
        return packing.numbered(part, {"array": packing.array(part, name or "value")})
    if isinstance(part, os.PathLike):
        return {"path": os.fspath(part)}
    found = collection(part, name, packing)
    return value(part, name, packing) if found is None else found


def collection(part: Any, name: str, packing: Packing) -> Any:
    """JSON form of a tuple, list, set or mapping; None for other parts."""
    if isinstance(part, tuple):
        if names := getattr(part, "_fields", ()):
            return packing.values(part, dict(zip(names, part, strict=True)), name)
        return {"tuple": packing.entries(part, name)}
    if isinstance(part, list | frozenset):
        return {"list" if isinstance(part, list) else "set": packing.entries(part, name)}
    if isinstance(part, Mapping):
        return {"dict" if isinstance(part, dict) else "mapping": packing.pairs(part, name)}
    return None


def value(part: Any, name: str, packing: Packing) -> Any:
    """JSON form of a sparse matrix or a dataclass of the two packages."""
    if getattr(part, "format", "") == "csc" and hasattr(part, "indptr"):
        arrays = {key: getattr(part, key) for key in ("data", "indices", "indptr")}
        return packing.numbered(part, {"sparse": list(part.shape), "fields": packing.inside(arrays, name)})
    if is_dataclass(part) and type(part).__module__.startswith(OWN):
        return packing.values(part, {f.name: getattr(part, f.name) for f in fields(part) if f.init}, name)
    found = f"{type(part).__module__}.{type(part).__qualname__}"
    raise StoredError(f"{name or 'value'}: found {found}, expected numbers, text, or values of casingfem and contact")


class Unpacking:
    """State of unpacking a file into a value."""

    def __init__(self, arrays: Mapping[str, Any]) -> None:
        self._arrays = arrays
        self._met: dict[int, Any] = {}

    def unpacked(self, part: Any) -> Any:
        """The value of a JSON form; raises KeyError, TypeError or ValueError if it is invalid."""
        if not isinstance(part, dict):
            return part
        if "same" in part:
            return self._met[part["same"]]
        if "number_of" in part:
            found = read_only(self._arrays[part["array"]]) if "array" in part else self._whole(part)
            self._met[part["number_of"]] = found
            return found
        ((word, inside),) = part.items()
        if word in MANY:
            return MANY[word](self.unpacked(entry) for entry in inside)
        if word in MAPS:
            return MAPS[word]((self.unpacked(key), self.unpacked(entry)) for key, entry in inside)
        if word == "complex":
            return complex(*(self.unpacked(entry) for entry in inside))
        return Path(inside) if word == "path" else WORDS[inside]

    def _whole(self, part: Mapping[str, Any]) -> Any:
        if "sparse" not in part:
            return self._value(part)
        from scipy.sparse import csc_array

        data, indices, indptr = (self.unpacked(part["fields"][key]) for key in ("data", "indices", "indptr"))
        return csc_array((data, indices, indptr), shape=tuple(part["sparse"]))

    def _value(self, part: Mapping[str, Any]) -> Any:
        module, _, name = part["value"].partition(":")
        if not module.startswith(OWN):
            raise ValueError(f"found {part['value']!r}, expected a value of casingfem or contact")
        kind: Any = import_module(module)
        for step in name.split("."):
            kind = getattr(kind, step)
        if not (isinstance(kind, type) and (is_dataclass(kind) or issubclass(kind, tuple))):
            raise ValueError(f"found {part['value']!r}, expected a dataclass or a named tuple")
        return kind(**{key: self.unpacked(value) for key, value in part["fields"].items()})
