"""JSON schema of scene files."""

from __future__ import annotations

from typing import Any

from contact.scene.cycles import CyclesFile, RimCyclesFile
from contact.scene.tables import FILES


def scene_schema() -> dict[str, Any]:
    """JSON schema of every kind of scene files, by kind; "cycles" and "cycles-rim" as `casingfem cycles` takes them."""
    files = {**FILES, "cycles": CyclesFile, "cycles-rim": RimCyclesFile}
    return {kind: model.model_json_schema() for kind, model in files.items()}
