"""Many draws of a study's random fields on several cores, stored chunk by chunk, so that a killed run can continue.

Each chunk of draws is one JSON file, written under a temporary name and moved into place. A draw depends only on its
number, each process has one BLAS thread, and floats are written with all digits. So the tables are identical for any
number and order of processes, and after any number of interruptions.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, cast

from casingfem.errors import InputError
from casingfem.io.side_by_side import one_thread_for_children, usable_cores
from casingfem.modal.family.splits import SplitMap
from casingfem.modal.mistuning import (
    Difference,
    Mistuning,
    Pair,
    chunks_of,
    difference,
    drawn_modes,
    mean_pairs,
    pairs_map,
    pairs_of,
    require_pairs,
)
from casingfem.study.load import Study, load_shell_study
from casingfem.study.problems import StudyError
from contact.io.infiles import read_bytes
from contact.io.outfiles import json_text, read_checked, write_atomic, write_checked
from contact.io.workers import KilledWorkersError, forks, in_processes

PERFECT = range(0)  # in place of draws: the casing without random fields
CHECKED = 50  # draws 0, 50, 100, 200, 400 and so on are also solved in full, and the difference reported


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MistuneRun:
    """Result of a mistuning run.

    Attributes
    ----------
    found : the doublets
    checked : for each checked draw its difference from the full solution
    in_full : the draws that were solved in full
    estimate : largest estimated relative frequency error among the others; None without others
    resumed : number of draws that were stored before
    """

    found: Mistuning
    checked: dict[int, Difference]
    in_full: tuple[int, ...]
    estimate: float | None
    resumed: int


def run_mistune(
    study: Study,
    draws: int,
    *,
    processes: int | None = None,
    folder: Path | None = None,
    progress: Callable[[int], None] | None = None,
) -> MistuneRun:
    """Doublets of a study's casing over draws 0 to draws - 1 of its random fields.

    Parameters
    ----------
    processes
        Worker processes; by default one for each core.
    folder
        Folder in which chunks are stored and sought; without it nothing is stored.
    progress
        Called with the number of finished draws.

    Raises
    ------
    StudyError
        If nothing of the study is random, its chart is open, or the folder contains draws of another study.
    NumericsError
        If the modes of a draw cannot be computed.
    """
    try:
        require_pairs(study.shell)
    except ValueError as error:
        raise StudyError([f"{study.path}: imperfection: {error}"]) from error
    store = None if folder is None else open_store(study, folder)
    chunks = chunks_of(draws)
    kept = {} if store is None else {chunk.start: content for chunk in chunks if (content := read(store, chunk))}
    resumed = sum(len(chunk) for chunk in chunks if chunk.start in kept)
    missing = [chunk for chunk in chunks if chunk.start not in kept]
    parts = [Part(str(study.path), study.source["sha256"], chunk) for chunk in (PERFECT, *missing)]
    done, perfect = resumed, list[Pair]()
    if missing and forks():
        worker_of(str(study.path), study.source["sha256"])  # workers start with the map instead of making their own
    try:
        with one_thread_for_children():
            for chunk, found in in_processes(parts, compute, processes or usable_cores()):
                content = json.loads(json_text(found))
                if chunk == PERFECT:
                    perfect = [pair_of(row) for row in content["pairs"]]
                    continue
                if store is not None:
                    write_checked(store / chunk_name(chunk), "draws", content, first=chunk.start)
                kept[chunk.start] = content
                done += len(chunk)
                if progress is not None:
                    progress(done)
    except KilledWorkersError as error:
        raise StudyError([f"{study.path}: {error}"]) from error
    rows = [pair_of(row) for chunk in chunks for row in kept[chunk.start]["pairs"]]
    mistuning = Mistuning.of(rows, perfect)
    contents = [kept[chunk.start] for chunk in chunks]
    checked = {int(draw): difference_of(cells) for content in contents for draw, cells in content["checked"].items()}
    in_full = tuple(draw for content in contents for draw in content["in_full"])
    estimate = max((content["estimate"] for content in contents if content["estimate"] is not None), default=None)
    return MistuneRun(found=mistuning, checked=checked, in_full=in_full, estimate=estimate, resumed=resumed)


def pair_of(row: list[Any]) -> Pair:
    """A pair from a row of a chunk's file, where null means nan."""
    return Pair._make(math.nan if cell is None else cell for cell in row)


def difference_of(cells: list[Any]) -> Difference:
    """A checked draw of a chunk's file."""
    return Difference._make(math.nan if cell is None else cell for cell in cells)


def is_checked(draw: int) -> bool:
    """Whether a draw is also solved in full: draw 0, and CHECKED times the powers of 2.

    >>> [draw for draw in range(1000) if is_checked(draw)]
    [0, 50, 100, 200, 400, 800]
    """
    times, rest = divmod(draw, CHECKED)
    return rest == 0 and times & (times - 1) == 0


# --- the store ------------------------------------------------------------------------------------------------


def open_store(study: Study, folder: Path) -> Path:
    """The folder of the chunks, marked with its study and versions.

    Raises
    ------
    StudyError
        If it contains draws of another study, or of other versions.
    """
    key = json_text({"source": study.source, "count": study.file.modes.count})
    mark = folder / "study.json"
    if mark.exists() and read_bytes(mark) != key.encode("utf-8"):
        raise StudyError([f"{study.path}: {folder} contains draws of another study or version: give another --out DIR"])
    write_atomic(mark, key)
    return folder


def chunk_name(chunk: range) -> str:
    """The file of a chunk.

    >>> chunk_name(range(5, 10))
    'draws_000005_000009.json'
    """
    return f"draws_{chunk.start:06d}_{chunk.stop - 1:06d}.json"


def read(store: Path, chunk: range) -> dict[str, Any] | None:
    """A chunk's content; None if it is missing or incomplete."""
    return cast("dict[str, Any] | None", read_checked(store / chunk_name(chunk), "draws", first=chunk.start))


# --- in the worker processes ----------------------------------------------------------------------------------


class Part(NamedTuple):
    """A task of a worker: study file, its digest, and draws; `PERFECT` for the casing without random fields."""

    path: str
    digest: str
    draws: range


@dataclass(frozen=True, slots=True, eq=False)
class WorkerState:
    """State that a worker keeps from chunk to chunk."""

    study: Study
    pairs: SplitMap | None

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.study.file.modes.count


def compute(part: Part) -> tuple[range, dict[str, Any]]:
    """The draws of a part, and the content of their file."""
    worker = worker_of(part.path, part.digest)
    if part.draws == PERFECT:
        return part.draws, {"pairs": mean_pairs(worker.study.shell, worker.count)}
    return part.draws, content_of(worker, part.draws)


@lru_cache(maxsize=1)
def worker_of(path: str, digest: str) -> WorkerState:
    """The study, and the map from its draws to their modes; a process that `forks` has it from its parent."""
    study = load_shell_study(path)
    if study.source["sha256"] != digest:
        found = "found another study in a worker process than in the command"
        raise InputError(f"{path}: {found}, expected no change: do not edit the file before the command ends")
    return WorkerState(study, pairs_map(study.shell, study.file.modes.count))


def content_of(worker: WorkerState, chunk: range) -> dict[str, Any]:
    """The doublets of some draws, which were solved in full, the others' largest estimate, and checks."""
    content: dict[str, Any] = {"pairs": [], "checked": {}, "in_full": [], "estimate": None}
    for draw, (found, estimate) in zip(
        chunk, drawn_modes(worker.study.shell, worker.pairs, worker.count, chunk), strict=True
    ):
        content["pairs"] += pairs_of(found, draw)
        if estimate is None:
            content["in_full"].append(draw)
            continue
        content["estimate"] = max(estimate, content["estimate"] or 0.0)
        if is_checked(draw):
            content["checked"][str(draw)] = difference(worker.study.shell, found, worker.count, draw)
    return content
