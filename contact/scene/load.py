"""Scene files: scene.toml -> Scene, with every problem of the file reported at once."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact.io.infiles import pipes_read_once, read_bytes
from contact.io.toml import entries, read_toml
from contact.prepared import Scene
from contact.scene.kinds import KINDS, file_of
from contact.scene.problems import Problems, SceneError, validated

if TYPE_CHECKING:
    from contact.scene.kinds import File

SIDES = ("rim", "rub", "disk")  # kinds of scenes of which one side turns
ASIDE = ("sweep", "chance")  # tables of a scene file that say how often and around what it is run
GIVEN = (
    "t_end",
    "gravity",
    "on_limit",
    "dt",
    "courant",
    "most_steps",
)  # keys of [scene] and [scheme] that `Scene` has too


def load_scene(path: str | Path) -> Scene:
    """Read a scene file of any kind but "pair"; basis files are found relative to it.

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.

    >>> import contact as ct
    >>> scene = ct.load_scene("data/scenes/two_rods.toml")
    >>> len(scene.what), scene.t_end, type(scene.scheme).__name__
    (2, 0.00025, 'CentralDifference')
    """
    file = Path(path)
    with pipes_read_once():
        table, text = read_scene(file)
        return _built(table, file, text)


def scene_of(data: dict[str, Any], file: Path) -> Scene:
    """Build a scene from the tables of a file, changed or not; `file` locates basis files and appears in messages.

    Its source names the file without a hash, since the tables may differ from the file.

    Raises SceneError.
    """
    return _built(_validated(data, file), file, None)


def _built(table: File, file: Path, text: bytes | None) -> Scene:
    from contact.scene.plausible import refusals  # pydantic is loaded when a file is read, not with the package

    if table.scene.kind == "pair":
        expected = "expected a scene with a time simulation: use casingfem interactions or stability"
        raise SceneError([f"{file}: scene.kind: found 'pair', {expected}"])
    problems = Problems(file)
    problems.extend(refusals(table, file))
    what, law, scheme = table.built(file.parent, problems)
    with problems.at("record"):
        record = None if table.record is None else table.record.record(file.parent)
    problems.check()
    if table.scene.kind in SIDES:
        _warn_of_turning(table, what, file)
    source = {"scene": file.name}
    if text is not None:
        contents = [text, *(read_bytes(file.parent / name) for name in table.files())]
        source["sha256"] = hashlib.sha256(b"\0".join(contents)).hexdigest()
    heads = table.scene, table.scheme
    given = {name: getattr(part, name) for part in heads for name in GIVEN if name in type(part).model_fields}
    return Scene(what=what, law=law, scheme=scheme, record=record, source=source, **given)


def _warn_of_turning(table: Any, what: object, file: Path) -> None:
    from contact.model.gaps.rub import rub_of
    from contact.scene.turns import warn_of_turning

    warn_of_turning(table.speed.turning, rub_of(what), file)


def read_scene(file: Path) -> tuple[File, bytes]:
    """Read and validate a scene file except [sweep] and [chance]; returns tables and text. Raises SceneError."""
    data, text = scene_data(file)
    return _validated({key: part for key, part in data.items() if key not in ASIDE}, file), text


def scene_data(file: Path) -> tuple[dict[str, Any], bytes]:
    """Read a scene file without validation; returns its tables and its text. Raises SceneError."""
    try:
        text, data = read_toml(file)
        return data, text
    except OSError as error:
        raise SceneError([f"{file}: {error.strerror}"]) from error
    except ValueError as error:
        raise SceneError([f"{file}: {error}"]) from error


def _validated(data: dict[str, Any], file: Path) -> File:
    kind = entries(data.get("scene")).get("kind")
    if str(kind) not in KINDS:
        found = "nothing" if kind is None else repr(kind)
        raise SceneError([f"{file}: scene.kind: found {found}, expected one of {', '.join(map(repr, KINDS))}"])
    return validated(file_of(str(kind)), data, file)
