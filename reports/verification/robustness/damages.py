"""Damages of files: those of `uff_mutations`, numbers and values swapped, bytes and arrays changed."""

import re
from collections.abc import Callable, Sequence
from io import BytesIO
from zipfile import ZipFile

import h5py
import numpy as np

from reports.verification.robustness.uff_mutations import DAMAGES as OF_TEXT

Random = np.random.Generator
Damage = Callable[[bytes, Random], bytes]
NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
NUMBERS = (
    *b"0 -1 7 7.5 1e9 999999999 2147483648 9223372036854775808 1e300 -1e300 1e-300 1e999 nan inf 0x10 1e24 1,5".split(),
    *(b"", b"1_000", b"1" + b"0" * 40),
)
VALUE = re.compile(rb"(?<== )[^\n#]+|(?<=,)[^,\n]+")
VALUES = (
    *b'true "" "x" [] {} [[1.0]] "5.0" 2001-01-01 "a\\u0000b" -0.0 inf "../../x" 1e9 1e-300 100000'.split(),
    *(b"[" * 2000, b"'\xe2\x80\xae'", b'"' + b"x" * 5000 + b'"'),
)


def swapped(pattern: re.Pattern[bytes], others: Sequence[bytes]) -> Damage:
    """One match of a pattern replaced by another content."""

    def damage(data: bytes, rng: Random) -> bytes:
        places = list(pattern.finditer(data))
        if not places:
            return flipped(data, rng)
        place = places[int(rng.integers(len(places)))]
        return data[: place.start()] + others[int(rng.integers(len(others)))] + data[place.end() :]

    return damage


def flipped(data: bytes, rng: Random) -> bytes:
    """One bit changed."""
    place = int(rng.integers(len(data)))
    return data[:place] + bytes([data[place] ^ 1 << int(rng.integers(8))]) + data[place + 1 :]


def overwritten(data: bytes, rng: Random) -> bytes:
    """Up to eight bytes replaced by zeros, ones or random values."""
    place, count = int(rng.integers(len(data))), int(rng.integers(1, 9))
    new = (b"\x00" * count, b"\xff" * count, rng.bytes(count))[int(rng.integers(3))]
    return data[:place] + new + data[place + count :]


def doubled(data: bytes, rng: Random) -> bytes:
    """A part of the file repeated."""
    place, count = int(rng.integers(len(data))), int(rng.integers(1, 200))
    return data[: place + count] + data[place:]


@np.errstate(all="ignore")
def other_array(array: np.ndarray, rng: Random) -> np.ndarray:
    """An array of another shape, kind or content."""
    numbers = array.dtype.kind in "iufc"
    odd = float(rng.choice([0.0, -1.0, 1e9, 1e300, 1e-300, -1e-9, np.nan, np.inf, 1e12]))
    changed = array.copy()
    if numbers and array.size:
        changed.flat[int(rng.integers(array.size))] = np.array(odd).astype(array.dtype)
    choices = (
        changed, changed, array[..., None], np.atleast_1d(array)[::-1], array.ravel()[:-1], np.zeros(0), np.array(odd),
        np.array("text"), array + 0.5j if numbers else array, np.asarray(array, dtype=str), np.zeros((3, 0, 2)),
        array != 0 if numbers else array, np.repeat(array[None], 2, axis=0),
        array.real.astype("float16") if numbers else array, np.array([["2001-01-01"]], dtype="datetime64[D]"),
    )  # fmt: skip
    return np.asarray(choices[int(rng.integers(len(choices)))])


def array_changed(data: bytes, rng: Random) -> bytes:
    """One array of an npz replaced, removed or renamed."""
    with np.load(BytesIO(data)) as stored:
        arrays = dict(stored)
    name = list(arrays)[int(rng.integers(len(arrays)))]
    how = int(rng.integers(8))
    if how == 0:
        arrays.pop(name)
    elif how == 1:
        arrays[f"{name}x"] = arrays.pop(name)
    else:
        arrays[name] = other_array(arrays[name], rng)
    out = BytesIO()
    np.savez(out, **arrays)
    return out.getvalue()


def member_damaged(data: bytes, rng: Random) -> bytes:
    """The bytes of one member of an npz are damaged, its checksum is that of the damage."""
    out = BytesIO()
    with ZipFile(BytesIO(data)) as stored, ZipFile(out, "w") as archive:
        names = stored.namelist()
        chosen = names[int(rng.integers(len(names)))]
        for name in names:
            content = stored.read(name)
            archive.writestr(
                name, (flipped, overwritten)[int(rng.integers(2))](content, rng) if name == chosen else content
            )
    return out.getvalue()


def dataset_changed(data: bytes, rng: Random) -> bytes:
    """One data set of an HDF5 file replaced or removed."""
    stream = BytesIO(data)
    with h5py.File(stream, "r+") as file:
        names: list[str] = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        name = names[int(rng.integers(len(names)))]
        old = np.asarray(file[name])
        del file[name]
        if int(rng.integers(6)):
            new = other_array(old, rng) if old.dtype.kind in "biufc" else np.array(1.0)
            file[name] = new.astype("S") if new.dtype.kind in "UM" else new
    return stream.getvalue()


BYTES: dict[str, Damage] = {
    "bit flipped": flipped, "bytes overwritten": overwritten, "part doubled": doubled,
    "cut off": lambda data, rng: OF_TEXT["cut off"](data, rng, ()),
    "part dropped": lambda data, rng: OF_TEXT["part dropped"](data, rng, ()),
}  # fmt: skip
TEXT: dict[str, Damage] = {
    name: lambda data, rng, damage=damage: damage(data, rng, ())  # type: ignore[misc]
    for name, damage in OF_TEXT.items() if name not in ("wrong count", "D exponents")
} | {
    "number swapped": swapped(NUMBER, NUMBERS), "another number swapped": swapped(NUMBER, NUMBERS),
    "value swapped": swapped(VALUE, VALUES), "bit flipped": flipped, "bytes overwritten": overwritten,
}  # fmt: skip


def suited(data: bytes) -> dict[str, Damage]:
    """The damages that apply to a file of a kind."""
    if data.startswith(b"PK"):
        return BYTES | {name: array_changed for name in ("array changed", "array changed again")} | {
            "member damaged": member_damaged
        }  # fmt: skip
    if data.startswith(b"\x89HDF"):
        return BYTES | {"data set changed": dataset_changed}
    if b"\x00" in data:
        return BYTES | TEXT if b"\n" in data[:80] else BYTES
    return TEXT
