"""The file of a run: arrays under their names, everything else as JSON in `document`."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

from contact.base.arrays import read_npz, readonly
from contact.base.errors import InputError
from contact.io.npz import write_npz
from contact.io.trust import Flag
from contact.record.energy import Divergence, EnergyBudget, Stored
from contact.record.growth import Cause, RunGrowth
from contact.record.orbit import Orbit
from contact.record.spin import SpinBudget
from contact.record.wear import WEAR_ARRAYS, WEAR_NUMBERS, Wear
from contact.scheme.protocol import Motion, Notes

FORMAT = "contact-result-1"
ARRAYS = (
    "time", "force", "gap", "impulse_history", "impulse", "peak_force", "max_penetration", "residual",
    "contact_steps", "reversals", "state_time", "state", "channels", "tip_force",
)  # fmt: skip
PLAIN = ("intervals", "sticking", "blocks", "steps", "dt", "window", "seconds", "scheme", "source", "every")


def write_result(path: str | os.PathLike[str], result: Any) -> Path:
    """Write npz without pickle, complete or not at all."""
    document = {name: getattr(result, name) for name in PLAIN} | {
        "energy": asdict(result.energy),
        "motions": [asdict(motion) for motion in result.motions],
        "notes": {
            "flags": [flag.to_dict() for flag in result.notes.flags], "heat": result.notes.heat.tolist(),
            "drive": result.notes.drive.tolist(), "deflection": result.notes.deflection,
            "orbit": None if result.notes.orbit is None else asdict(result.notes.orbit),
            "spin": None if result.notes.spin is None else asdict(result.notes.spin),
        },
        "divergence": None if result.divergence is None else asdict(result.divergence),
        "growth": None if result.growth is None else asdict(result.growth),
        "tracks": [{name: getattr(track, name) for name in (*WEAR_NUMBERS, "tips")} for track in result.tracks],
    }  # fmt: skip
    arrays = {name: getattr(result, name) for name in ARRAYS}
    for k, track in enumerate(result.tracks):
        arrays |= {f"wear{k}_{name}": getattr(track, name) for name in WEAR_ARRAYS}
    return write_npz(path, {"format": FORMAT, "document": json.dumps(document), **arrays})


def read_result(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The fields of a result that `write_result` wrote; raises InputError with file and key."""
    data = read_npz(Path(path), FORMAT, ("document", *ARRAYS), ("format", "document"), "`Result.save` writes one")
    if data["state"].ndim != 2:
        found = data["state"].shape
        raise InputError(
            f"{path}: key 'state': found shape {found}, expected (samples, coordinates): run the scene again"
        )
    try:
        return _fields(json.loads(str(data["document"])), data)
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: key 'document': found a missing or wrong entry {error}") from error


def _fields(document: dict[str, Any], data: dict[str, Any]) -> dict[str, Any]:
    """Fields of a result, of a document and the arrays beside it."""
    energy, notes, ended, growth = (document.pop(name) for name in ("energy", "notes", "divergence", "growth"))
    energy |= {name: Stored(**energy[name]) for name in ("start", "end")}
    for name in ("intervals", "sticking"):
        document[name] = tuple(tuple((a, b) for a, b in pairs) for pairs in document[name])
    if growth is not None:
        growth = RunGrowth(**growth | {"cause": None if growth["cause"] is None else Cause(**growth["cause"])})
    document["blocks"] = tuple((name, start, end) for name, start, end in document["blocks"])
    document["motions"] = tuple(Motion(**motion) for motion in document["motions"])
    document["tracks"] = tuple(
        Wear(**track | {"tips": tuple(track["tips"])}, **{name: data[f"wear{k}_{name}"] for name in WEAR_ARRAYS})
        for k, track in enumerate(document["tracks"])
    )
    kept = Notes(
        flags=tuple(map(Flag.of, notes["flags"])),
        heat=readonly(notes["heat"]),
        drive=readonly(notes["drive"]),
        orbit=None if (orbit := notes.get("orbit")) is None else Orbit(**orbit),
        deflection=float(notes.get("deflection", 0.0)),
        spin=None if (spin := notes.get("spin")) is None else SpinBudget(**spin),
    )
    return document | {name: readonly(data[name]) for name in ARRAYS} | {
        "energy": EnergyBudget(**energy), "notes": kept, "growth": growth,
        "divergence": None if ended is None else Divergence(**ended),
    }  # fmt: skip
