"""All draws of a scene on several cores, kept lot by lot: a run that was stopped goes on where it was.

A lot depends on its number alone, each process has one BLAS thread, and arrays are kept with all their digits. Whatever
the number of processes, their order, or how often the run was broken off, the results are the same to the last bit.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.chance.evaluate import RESULTS, Drawing, Lot
from casingfem.chance.importance import Importance, indices, mixed_designs
from casingfem.chance.load import ChanceScene, load_chance
from casingfem.io.arrays import FloatArray
from casingfem.io.side_by_side import one_thread, usable_cores
from contact.io.infiles import read_bytes
from contact.io.npz import load_npz, write_npz
from contact.io.outfiles import json_text, write_atomic
from contact.io.workers import worker_pool
from contact.scene.problems import SceneError

LOT = 512  # draws of a file: what a stopped run loses at most, for each process
DESIGN = "design"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drawn:
    """All draws of a scene.

    Attributes
    ----------
    given : the scene
    lot : arrays of all draws
    n, rank, freq : the pairs, and their frequencies [Hz] in the perfect casing
    floor : growth [1/s] that is round-off
    importance : for each of `RESULTS`, Sobol indices by input
    resumed : draws that were there already
    """

    given: ChanceScene
    lot: Lot
    n: FloatArray
    rank: FloatArray
    freq: FloatArray
    floor: float
    importance: dict[str, list[Importance]]
    resumed: int


def run_draws(
    given: ChanceScene,
    *,
    processes: int | None = None,
    folder: Path | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Drawn:
    """Results of all draws of a scene.

    Parameters
    ----------
    processes
        Worker processes; by default one for each core.
    folder
        Where finished draws are kept and searched for; without it nothing is kept.
    progress
        Called with words and the share that is done.

    Raises
    ------
    SceneError
        If the folder has draws of another scene.
    """
    store = None if folder is None else open_store(given, folder)
    names = list(parts_of(given))
    kept = {} if store is None else {name: found for name in names if (found := read_lot(store, name)) is not None}
    resumed = sum(len(range(*lot_of(name, given))) for name in kept if not name.startswith(DESIGN))
    missing = [name for name in names if name not in kept]
    workers = min(processes or usable_cores(), max(len(missing), 1))
    with one_thread(), worker_pool(workers, set_up, str(given.path), given.source["sha256"]) as executor:
        pairs = executor.submit(about_pairs)
        waiting = {executor.submit(compute, name): name for name in missing}
        for future in as_completed(waiting):
            name = waiting[future]
            found = result_of(future, executor)
            if store is not None:
                write_npz(store / f"{name}.npz", found)
            kept[name] = found
            if progress is not None:
                progress(f"{len(kept)} of {len(names)} parts", len(kept) / len(names))
        about = result_of(pairs, executor)
    lots = [kept[name] for name in names if not name.startswith(DESIGN)]
    return Drawn(
        given=given,
        lot={name: np.concatenate([lot[name] for lot in lots]) for name in lots[0]},
        n=about["n"],
        rank=about["rank"],
        freq=about["freq"],
        floor=float(about["floor"][0]),
        importance=importance_of(given, kept, [str(group) for group in about["groups"]]),
        resumed=resumed,
    )


def parts_of(given: ChanceScene) -> Iterator[str]:
    """Names of all lots, then of the parts of the design for Sobol indices."""
    for first in range(0, given.table.draws, LOT):
        yield f"draws_{first:07d}_{min(first + LOT, given.table.draws) - 1:07d}"
    if given.table.importance:
        for part in range(given.groups + 2):
            yield f"{DESIGN}_{given.table.importance}_{part:02d}"


def lot_of(name: str, given: ChanceScene) -> tuple[int, int]:
    """First draw of a lot, and the one after its last."""
    first, last = name.split("_")[1:]
    return int(first), int(last) + 1


def importance_of(given: ChanceScene, kept: dict[str, Lot], groups: list[str]) -> dict[str, list[Importance]]:
    """Sobol indices by result, from the parts of the design."""
    size = given.table.importance
    if not size:
        return {}
    parts = [kept[f"{DESIGN}_{size}_{part:02d}"]["results"] for part in range(len(groups) + 2)]
    return {
        name: indices(tuple(groups), [part[:, k] for part in parts], given.table.seed) for k, name in enumerate(RESULTS)
    }


def result_of(future: Future[Any], executor: Executor) -> Any:
    """A future's result; where it failed, the rest is called off first."""
    try:
        return future.result()
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        raise


# --- the store ------------------------------------------------------------------------------------------------


def open_store(given: ChanceScene, folder: Path) -> Path:
    """Folder of the stored draws, marked with the scene it belongs to; raises SceneError for another scene."""
    key = json_text({name: part for name, part in given.source.items() if name != "sha256"})  # draws may be added
    mark = folder / "chance.json"
    if mark.exists() and read_bytes(mark) != key.encode("utf-8"):
        found = f"found draws of another scene, study or version in {folder}"
        raise SceneError([f"{given.path}: {found}, expected none: give another --out DIR"])
    write_atomic(mark, key)
    return folder


def read_lot(store: Path, name: str) -> Lot | None:
    """The arrays of a lot, None where they are not there or not whole."""
    path = store / f"{name}.npz"
    if not path.is_file():
        return None
    try:
        found: Lot = load_npz(path)
        return found if name.startswith(DESIGN) or "by" in found else None
    except ValueError:
        return None


# --- in the worker processes ----------------------------------------------------------------------------------

_worker: list[Drawing] = []  # of this process, filled once by `set_up`


def set_up(path: str, digest: str) -> None:
    """Load the scene and solve its perfect casing."""
    given = load_chance(path)
    if given.source["sha256"] != digest:
        raise RuntimeError(f"{path} changed while its draws were computed")
    _worker.append(Drawing.of(given))


def about_pairs() -> Lot:
    """The pairs of the perfect casing, the inputs by name."""
    own = _worker[-1]
    pairs = own.casings.pairs
    return {
        "n": pairs.n, "rank": pairs.rank, "freq": pairs.freq, "floor": np.array([own.floor]),
        "groups": np.array(list(own.groups)),
    }  # fmt: skip


def compute(name: str) -> Lot:
    """One lot of draws, or one part of the design."""
    own = _worker[-1]
    if name.startswith(DESIGN):
        _, size, part = name.split("_")
        designs = mixed_designs(own.groups, own.dimension, seed=own.given.table.seed, size=int(size))
        return {"results": own.results(designs[int(part)])}
    return own.drawn(range(*lot_of(name, own.given)))
