"""All draws of a scene on several cores or a cluster, stored lot by lot, so that a stopped run can continue.

A lot depends only on its number, each process has one BLAS thread, and arrays are stored with all digits. So the
results are bit-identical for any number and order of processes, and after any number of stops.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from casingfem.chance.evaluate import RESULTS, Drawing, Lot
from casingfem.chance.importance import Importance, indices, mixed_designs
from casingfem.chance.load import ChanceScene, load_chance
from casingfem.chance.replaced import FLAG
from casingfem.io.arrays import FloatArray
from casingfem.io.side_by_side import one_thread_for_children, usable_cores
from contact.base.errors import InputError
from contact.io.infiles import read_bytes
from contact.io.npz import load_npz, write_npz
from contact.io.outfiles import json_text, write_atomic
from contact.io.workers import forks
from contact.scene.problems import SceneError
from contact.sweep.spread import on_workers

LOT = 512  # draws of a file: what a stopped run loses at most, for each process
DESIGN = "design"
PAIRS = "pairs"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drawn:
    """All draws of a scene.

    Attributes
    ----------
    given : the scene
    lot : arrays of all draws
    n, rank, freq : the pairs, and their frequencies [Hz] in the perfect casing
    floor : growth [1/s] below which it is only round-off
    importance : for each of `RESULTS`, Sobol indices by input
    resumed : number of draws that were stored before
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
    scheduler: str | None = None,
    folder: Path | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Drawn:
    """Results of all draws of a scene.

    Parameters
    ----------
    processes
        Worker processes; by default one for each core.
    scheduler
        Address of a Dask scheduler whose workers are used instead of processes. They need access to the same files.
    folder
        Folder in which finished draws are stored and sought; without it nothing is stored.
    progress
        Called with a text and the finished share.

    Raises
    ------
    SceneError
        If the folder has draws of another scene.
    InputError
        If the scheduler cannot be reached, or workers are killed repeatedly.
    """
    store = None if folder is None else open_store(given, folder)
    names = list(parts_of(given))
    kept = {} if store is None else {name: found for name in names if (found := read_lot(store, name)) is not None}
    resumed = sum(len(range(*lot_of(name, given))) for name in kept if not name.startswith(DESIGN))
    missing = [name for name in names if name not in kept]
    parts = [Part(str(given.path), json_text(given.source), name) for name in (PAIRS, *missing)]
    if missing and scheduler is None and forks():
        drawing_of(parts[0].path, parts[0].source)  # workers start with the perfect casing instead of solving it
    with one_thread_for_children():
        for name, found in on_workers(parts, compute, processes or usable_cores(), scheduler):
            if store is not None and name != PAIRS:
                write_npz(store / f"{name}.npz", found)
            kept[name] = found
            if progress is not None:
                progress(f"{len(kept)} of {len(names) + 1} parts", len(kept) / (len(names) + 1))
    about = kept[PAIRS]
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
    """First draw of a lot, and the draw after its last."""
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


# --- the store ------------------------------------------------------------------------------------------------


def open_store(given: ChanceScene, folder: Path) -> Path:
    """Folder of the stored draws, marked with the scene it belongs to; raises SceneError for another scene."""
    known = {name: part for name, part in given.source.items() if name != "sha256"}  # draws may be added
    key = json_text({**known, "solved_in_full_above": FLAG})
    mark = folder / "chance.json"
    if mark.exists() and read_bytes(mark) != key.encode("utf-8"):
        found = f"found draws of another scene, study or version in {folder}"
        raise SceneError([f"{given.path}: {found}, expected none: give another folder with --out"])
    write_atomic(mark, key)
    return folder


def read_lot(store: Path, name: str) -> Lot | None:
    """The arrays of a lot; None if they are missing or incomplete."""
    path = store / f"{name}.npz"
    if not path.is_file():
        return None
    try:
        found: Lot = load_npz(path)
        return found if name.startswith(DESIGN) or "by" in found else None
    except ValueError:
        return None


# --- in the worker processes ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Part:
    """A task of a worker: scene file, its expected content (`ChanceScene.source` as text), name of the part."""

    path: str
    source: str
    name: str


def compute(part: Part) -> tuple[str, Lot]:
    """Name and arrays of one part: a lot of draws, a part of the design, or the pairs of the perfect casing."""
    own = drawing_of(part.path, part.source)
    if part.name == PAIRS:
        return part.name, about_pairs(own)
    if part.name.startswith(DESIGN):
        _, size, number = part.name.split("_")
        designs = mixed_designs(own.groups, own.dimension, seed=own.given.table.seed, size=int(size))
        return part.name, {"results": own.results(designs[int(number)])}
    return part.name, own.drawn(range(*lot_of(part.name, own.given)))


@lru_cache(maxsize=1)
def drawing_of(path: str, source: str) -> Drawing:
    """The scene with its perfect casing; a process that `forks` has it from its parent."""
    given = load_chance(path)
    if json_text(given.source) != source:
        found = "found a scene, study or version in a worker process that differs from that of the command"
        raise InputError(f"{path}: {found}, expected the same: restore the files, and install the same versions")
    return Drawing.of(given)


def about_pairs(own: Drawing) -> Lot:
    """The pairs of the perfect casing, the inputs by name."""
    pairs = own.casings.pairs
    return {
        "n": pairs.n, "rank": pairs.rank, "freq": pairs.freq, "floor": np.array([own.floor]),
        "groups": np.array(list(own.groups)),
    }  # fmt: skip
