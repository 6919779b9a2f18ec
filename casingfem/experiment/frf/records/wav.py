"""Sound files (RIFF WAVE) as records: whole numbers of 16, 24 or 32 bits over full scale, or floating point.

The layout is that of the Multimedia Programming Interface and Data Specifications 1.0 (IBM and Microsoft, 1991).
"""

from __future__ import annotations

import os
import struct

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.records.take import RecordBlock, RecordChannel
from casingfem.io.arrays import FloatArray
from contact.io.infiles import read_bytes

PCM, FLOAT, EXTENSIBLE = 1, 3, 0xFFFE
EXPECTED = "a WAVE file of 16, 24 or 32 bits, or of floating point"


def read_wav(path: str | os.PathLike[str], most: float) -> list[RecordBlock]:
    """The channels of a sound file, as fractions of full scale (whole numbers) or as stored (floating point).

    Raises
    ------
    InputError
        The file or its coding is of another kind, or the data are shorter than the file states.
    """
    name = str(path)
    data = read_bytes(path, most=most)
    if data[:4] != b"RIFF" or data[8:12] != b"WAVE":
        raise InputError(name, found=f"a file that begins with {data[:4]!r}", expected=EXPECTED)
    chunks = _chunks(data, name)
    for wanted in (b"fmt ", b"data"):
        if wanted not in chunks:
            raise InputError(name, found=f"no part {wanted.decode().strip()!r}", expected=EXPECTED)
    head = chunks[b"fmt "]
    if len(head) < 16:
        raise InputError(name, found=f"{len(head)} bytes of format", expected="16 or more")
    code, channels, fs, _, step, bits = struct.unpack("<HHIIHH", head[:16])
    if code == EXTENSIBLE and len(head) >= 26:
        code = struct.unpack("<H", head[24:26])[0]
    if channels < 1 or fs < 1 or step != channels * bits // 8:
        found = f"{channels} channels, {fs} Hz, {step} bytes a sample of {bits} bits"
        raise InputError(name, found=found, expected="consistent numbers in the header")
    body = chunks[b"data"]
    values = _values(body[: len(body) // step * step], code, bits, name).reshape(-1, channels).T
    names = tuple(RecordChannel(f"channel {k + 1}") for k in range(channels))
    return [RecordBlock(name, float(fs), values, names)]


def _chunks(data: bytes, name: str) -> dict[bytes, bytes]:
    """The chunks of a file by name, each complete."""
    found, at = dict[bytes, bytes](), 12
    while at + 8 <= len(data):
        key, size = data[at : at + 4], struct.unpack("<I", data[at + 4 : at + 8])[0]
        part = data[at + 8 : at + 8 + size]
        if len(part) < size:
            found_words = f"{len(part)} bytes in the part {key.decode('latin-1').strip()!r}"
            raise InputError(name, found=found_words, expected=f"{size}, as the file states: it is cut short")
        found.setdefault(key, part)
        at += 8 + size + size % 2
    return found


def _values(body: bytes, code: int, bits: int, name: str) -> FloatArray:
    """Samples of all channels in turn."""
    if code == FLOAT and bits in (32, 64):
        return np.frombuffer(body, f"<f{bits // 8}").astype(np.float64)
    if code == PCM and bits in (16, 32):
        return np.frombuffer(body, f"<i{bits // 8}") / 2.0 ** (bits - 1)
    if code == PCM and bits == 24:
        parts = np.frombuffer(body, np.uint8).reshape(-1, 3).astype(np.int32)
        whole = parts[:, 0] | (parts[:, 1] << 8) | (parts[:, 2] << 16)
        return np.asarray((whole - ((whole & 0x800000) << 1)) / 2.0**23)
    raise InputError(name, found=f"coding {code} of {bits} bits", expected=EXPECTED)
