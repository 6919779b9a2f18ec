"""The file of identified modes: an npz of plain arrays; names of the arrays of sensors and diagram contain a dot."""

import os
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.io.arrays import Array
from casingfem.io.npz import read_npz
from contact.io.npz import ArrayKind, require_kinds, write_npz

WANTED = "a file that Identified.save or `casingfem identify --out` wrote"
PARTS: dict[str, Any] = {"sensors": SensorGrid, "diagram": Stabilisation}
TEXTS = ("reasons", "notes", "card")
COMPLEX = ("shapes", "sigma_shapes", "residues", "fitted", "measured")
DIMS = {"seconds": 0, "shift": 0, "reasons": 1, "notes": 1, "card": 1, "unresolved": 1, "doublets": 2}
BY_MODE = ("freq", "sigma_freq", "zeta", "sigma_zeta", "n", "purity", "angle_deg", "sigma_angle", "residue_scale",
           "collinearity", "signal", "split_bound")  # fmt: skip


def write_fields(path: str | os.PathLike[str], values: Mapping[str, Any]) -> Path:
    """Write the fields of an `Identified`, complete or not at all."""
    arrays: dict[str, Array] = {}
    for name, value in values.items():
        if name in PARTS:
            arrays |= {f"{name}.{field.name}": getattr(value, field.name) for field in fields(value)}
        else:
            arrays[name] = np.asarray(value, dtype=np.str_) if name in TEXTS else np.asarray(value)
    return write_npz(path, arrays, compressed=True)


def read_fields(path: str | os.PathLike[str], names: set[str]) -> dict[str, Any]:
    """The fields of an `Identified` from a file.

    Raises
    ------
    InputError
        Another file, arrays that are missing or do not belong together, numbers that are not finite.
    OSError
        No such file.
    """
    inner = {f"{name}.{field.name}" for name, part in PARTS.items() for field in fields(part)}
    Path(path).stat()  # OSError without a file, as every other reader of shapes
    stored = read_npz(path, (names - PARTS.keys()) | inner, WANTED)
    check(stored, str(path))
    values: dict[str, Any] = {name: stored[name] for name in names - PARTS.keys()}
    for name, part in PARTS.items():
        values[name] = part(**{field.name: stored[f"{name}.{field.name}"] for field in fields(part)})
    pairs = stored["doublets"].astype(int).reshape(-1, 2).tolist()
    return values | {
        "doublets": tuple((low, high) for low, high in pairs),
        "unresolved": tuple(stored["unresolved"].astype(int).tolist()),
        **{name: tuple(stored[name].tolist()) for name in TEXTS},
        **{name: float(stored[name]) for name in ("seconds", "shift")},
    }


def check(stored: Mapping[str, Array], path: str) -> None:
    """Refuse arrays of inconsistent shapes, and values that no identification can give."""
    kinds: dict[str, ArrayKind] = {**dict.fromkeys(TEXTS, "text"), **dict.fromkeys(COMPLEX, "complex")}
    try:
        require_kinds({name: array for name, array in stored.items() if name != "diagram.stable"}, kinds)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    for name, dims in DIMS.items():
        if stored[name].ndim != dims and (dims == 0 or stored[name].size):
            found = f"{name} of shape {stored[name].shape}"
            raise InputError(path, found=found, expected="one number" if dims == 0 else f"{dims} dimensions")
    modes, sensors = stored["freq"].size, stored["sensors.points"].size
    shapes: dict[str, tuple[int, ...]] = {name: (modes,) for name in BY_MODE}
    shapes |= {name: (sensors, modes) for name in ("shapes", "sigma_shapes")} | {"sensors.places": (sensors, 3)}
    shapes |= {f"sensors.{name}": (sensors,) for name in ("points", "theta", "directions")}
    for name, shape in shapes.items():
        if stored[name].shape != shape:
            expected = f"{shape} for {modes} modes at {sensors} sensors"
            raise InputError(path, found=f"{name} of shape {stored[name].shape}", expected=expected)
    if stored["reasons"].size not in (0, modes):
        raise InputError(path, found=f"{stored['reasons'].size} reasons", expected=f"one for each of {modes} modes")
    for name in ("freq", "sigma_freq", "zeta", "shapes", "sigma_shapes"):
        if not np.all(np.isfinite(stored[name])):
            raise InputError(path, found=f"{name} with nan or infinity", expected="finite numbers")
    at = np.concatenate([stored["doublets"].ravel(), stored["unresolved"].ravel()])
    there, pairs = np.isin(at, np.arange(modes)), stored["doublets"]
    if not there.all() or (pairs.size and pairs.shape[1] != 2):
        wrong = [*at[~there].tolist(), 0][0]
        raise InputError(path, found=f"mode {wrong + 1:g} in a pair", expected=f"modes 1 to {modes}, two in each pair")
