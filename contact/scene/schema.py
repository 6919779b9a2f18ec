"""JSON schema of scene files."""

from __future__ import annotations

from typing import Any

from contact.scene.cycles import CyclesFile
from contact.scene.kinds import KINDS, file_of
from contact.scene.scheme import Table
from contact.scene.turning import TURNING


def scene_models() -> dict[str, type[Table]]:
    """All kinds of scene files; "cycles", "cycles-rim", ... are those of `casingfem cycles`."""
    return {
        **{kind: file_of(kind) for kind in KINDS},
        "cycles": CyclesFile,
        **{f"cycles-{kind}": model for kind, model in TURNING.items()},
    }


def scene_schema() -> dict[str, Any]:
    """JSON schema of every kind of scene files, by kind.

    >>> found = scene_schema()
    >>> "rub" in found, sorted(found["rods"]["properties"])
    (True, ['checks', 'mass', 'record', 'rod', 'scene', 'scheme', 'wall'])
    """
    return {kind: model.model_json_schema() for kind, model in scene_models().items()}
