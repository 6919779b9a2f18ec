"""Time records from files of all supported kinds."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from casingfem.errors import InputError
from casingfem.experiment.frf.files import UNIVERSAL
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.loose_arrays import read_mat
from casingfem.experiment.frf.records.channels import ChannelTable, described, read_channels
from casingfem.experiment.frf.records.loose import blocks_of_arrays
from casingfem.experiment.frf.records.table import read_table
from casingfem.experiment.frf.records.take import RecordBlock, Take, responses_of, take_of, with_card
from casingfem.experiment.frf.records.universal import read_universal
from casingfem.experiment.frf.records.wav import read_wav
from casingfem.experiment.uff.nodes import Nodes, TraceLine
from casingfem.io.npz import read_npz

MOST = 5e8  # bytes of a file of records
KINDS = ", ".join((*UNIVERSAL, ".wav", ".mat", ".npz", ".csv"))


class RecordFile(NamedTuple):
    """Contents of a file of time records, with the geometry if it is a universal file."""

    takes: tuple[Take, ...]
    nodes: Nodes | None = None
    lines: tuple[TraceLine, ...] = ()


def read_records(
    path: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    channels: str | os.PathLike[str] | None = None,
) -> tuple[Take, ...]:
    r"""Forces and responses of universal files, .wav, .mat, .npz or .csv, in sets that were sampled together.

    Parameters
    ----------
    path
        A file, or several of one test.
    channels
        A table of channels (`channels.read_channels`) with kind, place and unit of each channel. Sound files need one.

    Raises
    ------
    InputError
        The ending is unknown, the file is larger than 500 MB, the reader refuses it, or channels have no force.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> rows = [f"{k / 256},{float(k == 9)},{2.0 * (k == 9)}" for k in range(64)]
    >>> text = "\n".join(["time [s],force 1 z [N],rim 2 z [m/s^2]", *rows])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "hit.csv")
    ...     _ = file.write_text(text, encoding="utf-8")
    ...     (take,) = read_records(file)
    >>> take.force.unit, len(take.response)
    ('N', 1)
    """
    paths = [path] if isinstance(path, str | os.PathLike) else list(path)
    table = None if channels is None else read_channels(channels)
    return tuple(take for each in paths for take in read_record_file(each, table).takes)


def read_responses(path: str | os.PathLike[str], *, channels: str | os.PathLike[str] | None = None) -> FrfSet:
    r"""Responses of one long record without forces, for output-only identification.

    Raises
    ------
    InputError
        The errors of `read_records`; or the file has several records, responses in several units, or no response.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> text = "time [s],rim 2 z [m/s^2]\n" + "".join(f"{k / 256},{(-1.0) ** k}\n" for k in range(64))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "run.csv")
    ...     _ = file.write_text(text, encoding="utf-8")
    ...     found = read_responses(file)
    >>> len(found), found.unit
    (1, 'm/s^2')
    """
    table = None if channels is None else read_channels(channels)
    blocks, beside = _blocks(path, table)
    if len(blocks) > 1:
        expected = "one record: join the records, or give the longest"
        raise InputError(str(path), found=f"{len(blocks)} records", expected=expected)
    responses = responses_of(blocks[0])
    return replace(responses, card=beside.card, path=str(path))


class _Beside(NamedTuple):
    """Geometry and card of a file."""

    nodes: Nodes | None = None
    lines: tuple[TraceLine, ...] = ()
    card: tuple[str, ...] = ()


def read_record_file(path: str | os.PathLike[str], table: ChannelTable | None) -> RecordFile:
    """One file, with the geometry of a universal one."""
    blocks, beside = _blocks(path, table)
    takes = tuple(with_card(take_of(block), beside.card) for block in blocks)
    return RecordFile(takes, beside.nodes, beside.lines)


def _blocks(path: str | os.PathLike[str], table: ChannelTable | None) -> tuple[list[RecordBlock], _Beside]:
    """Blocks of a file as the channel table describes them."""
    name, ending = str(path), Path(path).suffix.lower()
    _bounded(Path(path))
    beside = _Beside()
    if ending in UNIVERSAL:
        blocks, file = read_universal(path)
        beside = _Beside(file.nodes, file.lines, tuple(line for line in file.header if line))
    elif ending == ".wav":
        blocks = read_wav(path, MOST)
        if table is None:
            found = f"{len(blocks[0].channels)} channels of a sound file without units"
            raise InputError(name, found=found, expected="a table of channels: --channels, with kind, unit and factor")
    elif ending in (".mat", ".npz"):
        blocks = blocks_of_arrays(read_mat(path) if ending == ".mat" else read_npz(path), name)
    elif ending == ".csv":
        blocks = read_table(path, by_names=table is None)
    else:
        raise InputError(name, found=f"ending {ending!r}", expected=f"one of {KINDS}")
    return [_sampled(described(block, table)) for block in blocks], beside


def _bounded(path: Path) -> None:
    """Refuse an excessively long record (of a day) before it is read."""
    if path.is_file() and path.stat().st_size > MOST:
        found = f"{path.stat().st_size / 1e6:.6g} MB"
        raise InputError(str(path), found=found, expected=f"at most {MOST / 1e6:g} MB: cut the record to the test")


def _sampled(block: RecordBlock) -> RecordBlock:
    """The block; one without samples is refused."""
    if block.values.shape[1] == 0:
        raise InputError(block.name, found="no samples", expected="a record")
    return block
