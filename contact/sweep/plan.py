"""Runs of a sweep: [sweep] of a scene file expanded into runs with their hashes, before computation."""

from __future__ import annotations

import copy
import hashlib
import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.io.brief import brief
from contact.io.infiles import pipes_read_once, read_bytes
from contact.io.publication.digests import digest_of
from contact.io.toml import entries
from contact.scene.load import scene_data, scene_of
from contact.scene.problems import SceneError, validated
from contact.version import versions

if TYPE_CHECKING:
    from contact.sweep.tables import SweepTable, VaryTable

Value = float | str | int
COUNTS = ("seed", "draw", "elements", "modes", "count", "blades", "line", "bars", "updates", "p", "n", "n_max")
PART = re.compile(r"^(\w+)(?:\[(\d+)\])?$")
MEASURES = 5  # version of the definition of a run's results: a new version changes every hash


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepRun:
    """One run: the values of the varied keys, and the hash of its complete input."""

    values: tuple[Value, ...]
    digest: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepPlan:
    """A sweep: the scene's own tables, the varied keys, and the runs in the order of the table.

    `source` names file, hash, versions and seed for the head of the table.
    """

    file: Path
    base: dict[str, Any]
    keys: tuple[str, ...]
    runs: tuple[SweepRun, ...]
    source: dict[str, str]

    __repr__ = brief

    @property
    def labels(self) -> tuple[str, ...]:
        """The varied keys with their units, as axis labels."""
        return tuple(f"{key} [{unit}]" if (unit := unit_of(self.base, key)) else key for key in self.keys)

    def data(self, run: SweepRun) -> dict[str, Any]:
        """Tables of one run's scene."""
        return changed(self.base, self.keys, run.values)


@pipes_read_once()
def load_sweep(path: str | Path) -> SweepPlan:
    """Read a scene file with [sweep], and expand it into runs.

    Raises SceneError with file and key: for the table itself, for unknown keys of the scene, and if the first run is
    invalid. Later invalid runs become rows of the table.
    """
    file = Path(path)
    base, text = scene_data(file)
    table = _table(base.pop("sweep", None), file)
    keys = tuple(vary.key for vary in table.vary)
    whole = [_whole(base, key, file) for key in keys]
    values = [
        tuple(_as_in_scene(value, w) for value, w in zip(row, whole, strict=True)) for row in _combinations(table, file)
    ]
    first = changed(base, keys, values[0], file=file)
    try:
        scene_of(first, file)
    except SceneError as error:
        raise SceneError([_of_vary(problem, table, file) for problem in error.problems]) from error
    run_on, contents = versions(), dict[Path, str]()
    runs = tuple(
        SweepRun(values=row, digest=digest_of(_definition(changed(base, keys, row), file, run_on, contents)))
        for row in values
    )
    source = {"scene": file.name, "sha256": hashlib.sha256(text).hexdigest(), **run_on}
    if table.seed is not None:
        source["seed"] = str(table.seed)
    return SweepPlan(file=file, base=base, keys=keys, runs=runs, source=source)


def _of_vary(problem: str, table: SweepTable, file: Path) -> str:
    """A problem of the first run; if its key is varied, the text begins with the place of the value in [sweep]."""
    for k, vary in enumerate(table.vary, 1):
        if problem.startswith(f"{file}: {vary.key}: "):
            place = "key" if ": unknown key" in problem else "from" if vary.values is None else "values"
            return f"{file}: sweep.vary[{k}].{place}: {problem.removeprefix(f'{file}: ')}"
    return problem


def _table(data: object, file: Path) -> SweepTable:
    from contact.sweep.tables import SweepTable

    if entries(data) is not data:  # no table
        raise SceneError([f"{file}: sweep: missing, expected [sweep] with [[sweep.vary]]"])
    return validated(SweepTable, data, file, "sweep")


def _combinations(table: SweepTable, file: Path) -> Iterator[tuple[Value, ...]]:
    """Values of the keys, run by run."""
    from contact.sweep.tables import MOST_RUNS

    if table.kind == "random":
        assert table.draws is not None
        assert table.seed is not None
        for draw in range(table.draws):
            rng = np.random.default_rng([table.seed, draw])  # a draw depends on its number alone
            yield tuple(_drawn(vary, rng) for vary in table.vary)
        return
    columns = [_values(vary) for vary in table.vary]
    if table.kind == "list":
        sizes = {len(column) for column in columns}
        if len(sizes) > 1:
            raise SceneError(
                [f"{file}: sweep.vary: found lists of {sorted(sizes)} values, expected lists of equal length"]
            )
        yield from zip(*columns, strict=True)
    else:
        if (runs := math.prod(map(len, columns))) > MOST_RUNS:
            raise SceneError(
                [f"{file}: sweep.vary: found {runs} combinations, expected at most {MOST_RUNS}: use fewer values"]
            )
        yield from itertools.product(*columns)


def _values(vary: VaryTable) -> Sequence[Value]:
    if vary.values is not None:
        return vary.values
    assert vary.from_ is not None
    assert vary.to is not None
    spaced = np.geomspace if vary.log else np.linspace
    return [float(value) for value in spaced(vary.from_, vary.to, vary.steps or 1)]


def _drawn(vary: VaryTable, rng: np.random.Generator) -> Value:
    if vary.values is not None:
        return vary.values[int(rng.integers(len(vary.values)))]
    assert vary.from_ is not None
    assert vary.to is not None
    if vary.key.rpartition(".")[2] in COUNTS:
        return int(rng.integers(int(vary.from_), int(vary.to) + 1))
    if vary.log:
        return float(np.exp(rng.uniform(np.log(vary.from_), np.log(vary.to))))
    return float(rng.uniform(vary.from_, vary.to))


def changed(
    base: dict[str, Any], keys: Sequence[str], values: Sequence[Value], *, file: Path | None = None
) -> dict[str, Any]:
    """The tables with other values; `contact.out_of_roundness[1].cos` is the first term's.

    Raises SceneError for an unknown place.

    >>> changed({"speed": {"hz": 5.0}, "rod": [{"x": 0.0}]}, ["speed.hz", "rod[1].x"], [6.0, 0.5])
    {'speed': {'hz': 6.0}, 'rod': [{'x': 0.5}]}
    """
    touched = {re.split(r"[.\[]", key)[0] for key in keys}
    data = {name: copy.deepcopy(part) if name in touched else part for name, part in base.items()}
    for key, value in zip(keys, values, strict=True):
        at, last = _place(data, key, file)
        at[last] = value
    return data


def _place(data: dict[str, Any], key: str, file: Path | None) -> tuple[dict[str, Any], str]:
    """The table that contains a key, and the key's name in it."""
    *path, last = key.split(".")
    at: Any = data
    for part in path:
        match = PART.fullmatch(part)
        at = entries(at).get(match[1]) if match else None
        if match and match[2]:
            at = entries(at).get(int(match[2]) - 1)
        if entries(at) is not at:  # no table
            raise SceneError([f"{file or 'sweep'}: sweep.vary.key: found {key!r}, but the scene has no table {part!r}"])
    if not path or re.fullmatch(r"\w+", last) is None:
        raise SceneError(
            [f"{file or 'sweep'}: sweep.vary.key: found {key!r}, expected a key of the scene, such as speed.hz"]
        )
    return at, last


def unit_of(base: dict[str, Any], key: str) -> str:
    """The unit of a key of a scene, by its table; empty where the table names none.

    >>> unit_of({"scene": {"kind": "rim"}, "speed": {"hz": 5.0}}, "speed.hz")
    'turns/s'
    """
    from contact.io.tables import keys, models_at
    from contact.scene.kinds import KINDS, file_of

    kind = entries(base.get("scene")).get("kind")
    root = file_of(kind) if kind in KINDS else None
    path: list[str | int] = []
    for part in key.split("."):
        if match := PART.fullmatch(part):
            path += [match[1], *([int(match[2]) - 1] if match[2] else [])]
    if root is None or not path:
        return ""
    infos = (keys(model).get(str(path[-1])) for model in models_at([root], path[:-1], base))
    meaning = next((info.description or "" for info in infos if info is not None), "")
    found = re.findall(r"\[([^\]]+)\]", meaning)
    return found[-1] if found else ""


def _whole(base: dict[str, Any], key: str, file: Path) -> bool:
    """Whether a key is a whole number in the scene, or counts something."""
    at, last = _place(base, key, file)
    return type(at.get(last)) is int or last in COUNTS


def _as_in_scene(value: Value, whole: bool) -> Value:
    """A number in the type of the scene: 50.0 elements become 50."""
    return int(value) if whole and isinstance(value, float) and value.is_integer() else value


def _definition(data: dict[str, Any], file: Path, run_on: dict[str, str], contents: dict[Path, str]) -> dict[str, Any]:
    """All inputs of a run: its tables, the contents of its files, the versions, the requested outputs.

    `contents` caches the hashes of files.
    """
    files = {}
    for name in sorted(set(_words(data))):
        path = file.parent / name
        if path not in contents:
            contents[path] = hashlib.sha256(read_bytes(path)).hexdigest() if path.is_file() else "none"
        if contents[path] != "none":
            files[name] = contents[path]
    return {"scene": data, "files": files, "versions": run_on, "measures": MEASURES}


def _words(part: Any) -> Iterator[str]:
    """All texts in the tables of a scene; each may be the name of a file, such as a basis or a profile."""
    if isinstance(part, str):
        yield part
    for inner in entries(part).values():
        yield from _words(inner)
