"""Many draws of a study's random fields on several cores, kept chunk by chunk: a run that was killed goes on.

Each chunk of draws is one JSON file, written under a temporary name and moved into place. A draw depends on its
number alone, each process has one BLAS thread, and floats are written with all their digits: whatever the number of
processes, their order, or how often the run was broken off, the tables are the same to the last bit.
"""

import json
import math
from collections.abc import Callable
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from casingfem.io.side_by_side import one_thread, usable_cores
from casingfem.modal.mistuning import (
    Mistuning,
    Pair,
    drawn_modes,
    mean_modes,
    pairs_of,
    perfect_pairs,
    require_pairs,
    restart_error,
)
from casingfem.modal.mode_set import Modes
from casingfem.study.load import Study, load_shell_study
from casingfem.study.problems import StudyError
from contact.io.infiles import read_bytes
from contact.io.outfiles import json_text, read_checked, write_atomic, write_checked
from contact.io.workers import worker_pool

CHUNK = 5  # draws a file: what a killed run loses at most, for each process
CHECKED = 50  # every so many draws one is also solved from nothing, and the difference reported


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MistuneRun:
    """What a run found: the doublets; how far restarts were from solutions from nothing; which draws needed one.

    `errors` is draw -> largest relative difference of a frequency; `resumed` counts the draws that were there already.
    """

    found: Mistuning
    errors: dict[int, float]
    from_nothing: tuple[int, ...]
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
        Where chunks are kept and looked for; without it nothing is kept.
    progress
        Called with the number of draws done.

    Raises
    ------
    StudyError
        If nothing of the study is random, its chart is open, or the folder holds draws of another study.
    NumericsError
        If the modes of a draw cannot be computed.
    """
    try:
        require_pairs(study.shell)
    except ValueError as error:
        raise StudyError([f"{study.path}: imperfection: {error}"]) from error
    store = None if folder is None else open_store(study, folder)
    chunks = [range(first, min(first + CHUNK, draws)) for first in range(0, draws, CHUNK)]
    kept = {} if store is None else {chunk.start: content for chunk in chunks if (content := read(store, chunk))}
    resumed = sum(len(chunk) for chunk in chunks if chunk.start in kept)
    missing = [chunk for chunk in chunks if chunk.start not in kept]
    workers = min(processes or usable_cores(), max(len(missing), 1))
    with one_thread(), worker_pool(workers, set_up, str(study.path), study.source["sha256"]) as executor:
        perfect = executor.submit(mean_pairs)
        waiting = {executor.submit(compute_chunk, chunk): chunk for chunk in missing}
        done = resumed
        for future in as_completed(waiting):
            content, chunk = json.loads(json_text(result_of(future, executor))), waiting[future]
            if store is not None:
                write_checked(store / chunk_name(chunk), "draws", content, first=chunk.start)
            kept[chunk.start] = content
            done += len(chunk)
            if progress is not None:
                progress(done)
        rows = [pair_of(row) for chunk in chunks for row in kept[chunk.start]["pairs"]]
        found = Mistuning.of(rows, perfect.result())
    errors = {int(draw): error for chunk in chunks for draw, error in kept[chunk.start]["errors"].items()}
    slow = tuple(draw for chunk in chunks for draw in kept[chunk.start]["from_nothing"])
    return MistuneRun(found=found, errors=errors, from_nothing=slow, resumed=resumed)


def result_of(future: Future[dict[str, Any]], executor: Executor) -> dict[str, Any]:
    """A chunk's content; where it failed, the rest is called off first."""
    try:
        return future.result()
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        raise


def pair_of(row: list[Any]) -> Pair:
    """A row of a chunk's file; JSON has no word for nan."""
    return Pair._make(math.nan if cell is None else cell for cell in row)


# --- the store ------------------------------------------------------------------------------------------------


def open_store(study: Study, folder: Path) -> Path:
    """The folder of the chunks, marked with what they belong to.

    Raises
    ------
    StudyError
        If it holds draws of another study, or of other versions.
    """
    key = json_text({"source": study.source, "count": study.file.modes.count})
    mark = folder / "study.json"
    if mark.exists() and read_bytes(mark) != key.encode("utf-8"):
        raise StudyError([f"{study.path}: {folder} holds draws of another study or version: give another --out DIR"])
    write_atomic(mark, key)
    return folder


def chunk_name(chunk: range) -> str:
    """The file of a chunk.

    >>> chunk_name(range(5, 10))
    'draws_000005_000009.json'
    """
    return f"draws_{chunk.start:06d}_{chunk.stop - 1:06d}.json"


def read(store: Path, chunk: range) -> dict[str, Any] | None:
    """A chunk's content, None where it is not there or not whole."""
    return cast("dict[str, Any] | None", read_checked(store / chunk_name(chunk), "draws", first=chunk.start))


# --- in the worker processes ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class WorkerState:
    """What a worker keeps from chunk to chunk."""

    study: Study
    mean: Modes


_worker: list[WorkerState] = []  # of this process, filled once by `set_up`


def set_up(path: str, digest: str) -> None:
    """Load the study and solve its mean shell."""
    study = load_shell_study(path)
    if study.source["sha256"] != digest:
        raise RuntimeError(f"{path} changed while its draws were computed")
    _worker.append(WorkerState(study, mean_modes(study.shell, study.file.modes.count)))


def mean_pairs() -> list[Pair]:
    """The doublets of the mean shell."""
    bench = _worker[-1]
    return perfect_pairs(bench.mean, bench.study.file.modes.count)


def compute_chunk(chunk: range) -> dict[str, Any]:
    """The doublets of some draws, the errors of those also solved from nothing, and those that had to be."""
    bench = _worker[-1]
    shell, count = bench.study.shell, bench.study.file.modes.count
    content: dict[str, Any] = {"pairs": [], "errors": {}, "from_nothing": []}
    for draw in chunk:
        found, restarted = drawn_modes(shell, bench.mean, count, draw)
        content["pairs"] += pairs_of(found, draw)
        if not restarted:
            content["from_nothing"].append(draw)
        elif draw % CHECKED == 0:
            content["errors"][str(draw)] = restart_error(found)
    return content
