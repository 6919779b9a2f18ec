"""Time records in plain arrays of .mat and .npz files.

The layout: `fs` [Hz] or `time` [s] (samples,); `force` (samples,) or (hits, samples), none if there are only responses;
`response` (channels, samples), (samples,) or (hits, channels, samples); optional `points`, `directions` (channels,),
`force_point`, `force_direction` (a number, or one for each hit), `unit`, `force_unit`. Samples may also be the first
axis of a matrix.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.loose_arrays import by_meaning
from casingfem.experiment.frf.records.take import RecordBlock, RecordChannel
from casingfem.io.arrays import Array, FloatArray, IntArray

NAMES = {
    "fs": ("fs", "rate", "sampling_rate", "sample_rate", "fs_hz"),
    "time": ("time", "t", "time_s"),
    "force": ("force", "forces", "f", "hammer"),
    "response": ("response", "responses", "acceleration", "a", "x"),
    "points": ("points", "point", "nodes"),
    "directions": ("directions", "direction"),
    "force_point": ("force_point", "reference", "reference_point"),
    "force_direction": ("force_direction", "reference_direction"),
    "unit": ("unit", "response_unit", "units"),
    "force_unit": ("force_unit",),
}
EXPECTED = "fs or time (samples,), force (samples,) and response (channels, samples), or with hits as the first axis"


def blocks_of_arrays(stored: Mapping[str, Array], path: str) -> list[RecordBlock]:
    """The records in named arrays, one block for each hit.

    Raises
    ------
    InputError
        Arrays are missing (the message lists the names found), two have the same meaning, or shapes do not fit.
    """
    arrays = by_meaning(stored, NAMES, path)
    if "response" not in arrays or not {"fs", "time"} & arrays.keys():
        raise InputError(path, found="arrays " + (", ".join(sorted(stored)) or "none"), expected=EXPECTED)
    response = _numbers(arrays["response"], "response", path)
    force = _force(arrays, response, path)
    hits, samples = force.shape
    response = _arranged(response, hits, samples, path)
    fs = _rate(arrays, samples, path)
    channels = response.shape[1]
    points = _whole(arrays, "points", channels, np.arange(1, channels + 1), path)
    directions = _whole(arrays, "directions", channels, np.zeros(channels, np.int64), path)
    at = _whole(arrays, "force_point", hits, np.zeros(hits, np.int64), path)
    along = _whole(arrays, "force_direction", hits, np.zeros(hits, np.int64), path)
    unit, force_unit = _text(arrays, "unit", "", path), _text(arrays, "force_unit", "N", path)
    own = tuple(
        RecordChannel(f"response {k + 1}", "response", p, d, unit)
        for k, (p, d) in enumerate(zip(points.tolist(), directions.tolist(), strict=True))
    )
    if "force" not in arrays:
        return [RecordBlock(path, fs, response[0], own)]
    return [
        RecordBlock(
            f"{path}, hit {k + 1}" if hits > 1 else path, fs, np.vstack([force[k], response[k]]),
            (RecordChannel("force", "force", int(at[k]), int(along[k]), force_unit), *own),
        )
        for k in range(hits)
    ]  # fmt: skip


def _force(arrays: Mapping[str, Array], response: FloatArray, path: str) -> FloatArray:
    """Forces (hits, samples); without forces, zeros over the longest axis of the responses."""
    if "force" not in arrays:
        return np.zeros((1, max(response.shape, default=0)))
    force = np.atleast_2d(np.squeeze(_numbers(arrays["force"], "force", path)))
    if "time" in arrays and force.shape[1] != np.size(arrays["time"]) == force.shape[0]:
        force = force.T
    return force


def _arranged(values: FloatArray, hits: int, samples: int, path: str) -> FloatArray:
    """Responses as (hits, channels, samples)."""
    given = values.shape
    if values.ndim == 2 and values.shape[1] != samples and values.shape[0] == samples:
        values = values.T
    if values.ndim == 1:
        values = values[None, None]
    elif values.ndim == 2:
        values = values[None] if hits == 1 else values[:, None]
    if values.ndim != 3 or values.shape[0] != hits or values.shape[2] != samples:
        found = f"response {given} for {hits} hit{'s' * (hits > 1)} of {samples} samples"
        raise InputError(path, found=found, expected=EXPECTED)
    return values


def _rate(arrays: Mapping[str, Array], samples: int, path: str) -> float:
    """Samples per second: as given, or from the times."""
    if "fs" in arrays:
        fs = float(np.ravel(_numbers(arrays["fs"], "fs", path))[0])
    else:
        time = np.ravel(_numbers(arrays["time"], "time", path))
        steps = np.diff(time)
        if len(time) != samples or len(time) < 2 or np.ptp(steps) > 0.1 * abs(float(steps.mean())):
            found = f"{len(time)} times for {samples} samples" if len(time) != samples else "uneven times"
            raise InputError(path, found=found, expected="one time for each sample, evenly spaced")
        fs = float((samples - 1) / (time[-1] - time[0]))
    if not (np.isfinite(fs) and fs > 0.0):
        raise InputError(path, found=f"{fs:g} samples a second", expected="a number above 0")
    return fs


def _numbers(array: Array, name: str, path: str) -> FloatArray:
    if array.dtype.kind not in "biuf":
        raise InputError(path, found=f"{name} of type {array.dtype}", expected="real numbers")
    return array.astype(np.float64)


def _whole(arrays: Mapping[str, Array], name: str, count: int, usual: IntArray, path: str) -> IntArray:
    if name not in arrays:
        return usual
    given = np.ravel(_numbers(arrays[name], name, path))
    if given.size not in (1, count) or np.any(given % 1 != 0):
        found = f"{given.size} numbers in {name}"
        raise InputError(path, found=found, expected=f"whole numbers, as many as there are channels or hits: {count}")
    return np.broadcast_to(given, (count,)).astype(np.int64)


def _text(arrays: Mapping[str, Array], name: str, usual: str, path: str) -> str:
    if name not in arrays:
        return usual
    given = np.ravel(arrays[name])
    if given.size != 1:
        raise InputError(path, found=f"{given.size} entries in {name}", expected="one unit for all channels")
    return str(given[0]).strip()
