"""Files of plain arrays (npz): no pickle, written whole or not at all, each member checked before reading."""

from __future__ import annotations

import os
import zlib
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any, Literal
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.io.infiles import open_file
from contact.io.outfiles import write_atomic

ArrayKind = Literal["text", "complex", "real"]
KINDS: dict[ArrayKind, tuple[str, str]] = {
    "text": ("U", "text"),
    "complex": ("iufc", "numbers"),
    "real": ("iuf", "real numbers"),
}
ROOM, PACKED = 64e6, 100.0  # bytes that any file may unpack to; beyond, how many times its own size
LAST = 0x10FFFF  # character of Unicode; numpy makes strings of larger numbers, which no program can print
HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
DAMAGE = (
    OSError, ValueError, EOFError, SyntaxError, TokenError, RecursionError, MemoryError, NotImplementedError,
    RuntimeError, BadZipFile, zlib.error,
)  # fmt: skip


def write_npz(path: str | os.PathLike[str], arrays: Mapping[str, ArrayLike], *, compressed: bool = False) -> Path:
    """Write arrays by name; returns the path."""

    def store(part: Path) -> None:
        with part.open("wb") as stream:
            save_npz(stream, arrays, compressed=compressed)

    return write_atomic(Path(path), store)


def save_npz(stream: IO[bytes], arrays: Mapping[str, ArrayLike], *, compressed: bool = False) -> None:
    """Write arrays by name to a stream; raises ValueError for objects, which numpy would pickle."""
    given: dict[str, Any] = {name: np.asanyarray(array) for name, array in arrays.items()}
    for name, array in given.items():
        if array.dtype.hasobject:  # numpy 2.0 has no option to refuse them
            raise ValueError(f"member {name!r}: found {array.dtype}, expected numbers or text")
    (np.savez_compressed if compressed else np.savez)(stream, **given)


def load_npz(path: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """All arrays of a file by name.

    Raises
    ------
    ValueError
        The file does not exist or is of another kind, or a member is damaged, encrypted, compressed too strongly, or
        not plain numbers or text. The message names the member.
    """
    name = ""
    try:
        arrays = {}
        with open_file(path) as stream, ZipFile(stream) as archive:
            _check(archive, stream.seek(0, os.SEEK_END))
            for info in archive.infolist():
                name = f"member {info.filename.removesuffix('.npy')!r}: "
                arrays[info.filename.removesuffix(".npy")] = _member(archive, info)
    except DAMAGE as error:
        reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
        raise ValueError(f"{name}{reason}") from error
    return arrays


def require_kinds(arrays: Mapping[str, NDArray[Any]], kinds: Mapping[str, ArrayKind]) -> None:
    """Raise ValueError for the first array of a wrong kind; arrays that `kinds` does not name must be real numbers."""
    for name, array in arrays.items():
        letters, expected = KINDS[kinds.get(name, "real")]
        if array.dtype.kind not in letters:
            raise ValueError(f"member {name!r}: found {array.dtype}, expected {expected}")


def _check(archive: ZipFile, size: int) -> None:
    """Refuse, before unpacking, a file that is not npz or that was made to exhaust memory."""
    members = archive.infolist()
    largest = max(members, key=lambda info: info.file_size, default=None)
    unpacked = sum(info.file_size for info in members)
    if largest is not None and unpacked > max(ROOM, PACKED * size):
        found = f"{size / 1e6:.3g} MB that unpack to {unpacked / 1e6:.3g} MB (largest member: {largest.filename!r})"
        raise ValueError(f"found {found}, expected at most {PACKED:g} times the size of the file")
    for name, times in Counter(info.filename for info in members).items():
        if times > 1 or not name.endswith(".npy"):
            raise ValueError(f"found {name!r}{f' {times} times' if times > 1 else ''}, expected .npy arrays, each once")


def _member(archive: ZipFile, info: ZipInfo) -> NDArray[Any]:
    """One array; its header is compared with its size before memory is allocated."""
    if info.flag_bits & 1 or info.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        how = "encrypted" if info.flag_bits & 1 else f"packed by method {info.compress_type}"
        raise ValueError(f"found it {how}, expected a stored or deflated member")
    with archive.open(info) as stream:
        version = np.lib.format.read_magic(stream)
        if version not in HEADERS:
            raise ValueError(f"found version {version} of the npy format, expected 1.0 or 2.0")
        shape, _, dtype = HEADERS[version](stream)
        if dtype.kind not in "biufcU":
            raise ValueError(f"found {dtype}, expected numbers or text")
        size = int(np.prod([*map(float, shape), dtype.itemsize]))
        if size != info.file_size - stream.tell() or (not dtype.itemsize and 0 not in shape and shape):
            raise ValueError(f"found {info.file_size} bytes, expected those of an array of {dtype} of shape {shape}")
        stream.seek(0)
        array: NDArray[Any] = np.lib.format.read_array(stream, allow_pickle=False)
    text = array.astype(dtype.newbyteorder("=")).ravel() if dtype.kind == "U" and array.size else np.array("0")
    if text.view(np.uint32).max() > LAST:
        raise ValueError("found codes that are not Unicode characters, expected text")
    return array


def whole(arrays: Mapping[str, NDArray[Any]], name: str) -> int:
    """A nonnegative whole number; 0 if it is missing.

    >>> whole({"n_max": np.array(8)}, "n_max")
    8
    """
    value = arrays.get(name, np.array(0))
    if value.ndim or not float(value).is_integer() or not 0 <= float(value) <= 1_000_000:
        raise ValueError(f"{name}: found {value.tolist()!r}, expected a whole number from 0 to 1,000,000")
    return int(value)


def compliance_fault(S: NDArray[Any]) -> str:
    """Fault of a static compliance matrix, which must be symmetric and positive semidefinite; empty if there is none.

    >>> compliance_fault(np.diag([1e-8, 0.0])), compliance_fault(np.array([[1e-8, 0.0], [1e-8, 0.0]]))
    ('', 'asymmetry 1.00e+00 of its scale, expected a symmetric matrix')
    """
    scale = float(np.abs(S).max(initial=0.0))
    skew = float(np.abs(S - S.T).max(initial=0.0))
    if skew > 1e-8 * scale:
        return f"asymmetry {skew / scale:.2e} of its scale, expected a symmetric matrix"
    try:
        np.linalg.cholesky(S / (scale or 1.0) + 1e-6 * np.eye(len(S)))  # a fifth of the time of eigenvalues
    except np.linalg.LinAlgError:
        least = float(np.linalg.eigvalsh(S)[0])
        return f"the eigenvalue {least:.3g} m/N, expected eigenvalues >= 0"
    return ""
