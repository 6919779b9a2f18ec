"""Stored result of a run in a sweep: one row of numbers or an error, in a file named by the hash of its input.

A file has its own checksum and is written under a temporary name, then moved into place, so that a killed process
leaves only complete files. Files are not flushed to the disk: after a power failure one may be damaged. Its checksum
shows that, and its run is repeated. There is no index, since reading and checking a file takes 40 microseconds, and a
run takes milliseconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import DivergedError, InputError
from contact.io.outfiles import finite, read_checked, write_checked
from contact.io.trust import Flag
from contact.model.bodies.patch import Patch
from contact.model.gaps.gap import PointGap, RotatingRim
from contact.model.gaps.limits import FAR
from contact.model.gaps.rub import Rub
from contact.prepared import Scene
from contact.problem import What
from contact.record.record import Record, prime_stride
from contact.result import Result
from contact.run_many import Outcome
from contact.sweep.columns import COLUMNS

STATES = 256  # approximate number of states stored for the amplitudes
FORMAT = "contact-run-3"
Row = dict[str, Any]


@cache
def sweep_record(steps: int) -> Record:
    """Record every p-th step, p the largest prime that gives STATES states: no multiple of a turn or period.

    >>> sweep_record(20_000).every, sweep_record(100).every
    (73, 1)
    """
    stride = prime_stride(steps, STATES)
    return Record(every=stride, state_every=stride)


def row_of(scene: Scene | None, outcome: Outcome) -> dict[str, Any]:
    """One row; a refused, failed or diverged run has the reason, the last two also their results so far."""
    return dict.fromkeys(COLUMNS) | _ended(outcome, scene)


def _ended(outcome: Outcome, scene: Scene | None) -> dict[str, Any]:
    if isinstance(outcome, InputError):
        return {"status": "refused", "flags": "", "why": str(outcome)}
    if isinstance(outcome, Result):
        return _of_result(outcome, scene)
    result = outcome.result
    if isinstance(outcome, DivergedError) and result is not None:
        return _of_result(result, scene)
    flags = "" if result is None else codes(result.flags)
    return {"status": "failed", "flags": flags, "why": str(outcome)} | _reached(scene, result)


def _of_result(outcome: Result, scene: Scene | None) -> dict[str, Any]:
    rim, ended = _rim(scene), outcome.divergence
    radial = _radial(rim, outcome)
    flags = _flags(outcome, rim, radial)
    status = "failed" if any(flag.failed for flag in flags) else "done"
    said: dict[str, Any] = {"status": status, "flags": codes(flags), "why": " ".join(flags)}
    if ended is not None:
        said |= {"status": "diverged", "diverged_at_s": ended.time}
    return said | _numbers(_what(scene), rim, outcome, radial)


def codes(flags: Iterable[Flag]) -> str:
    """Codes of flags, each once.

    >>> codes([Flag("deep", "penetration"), Flag("deeper", "penetration"), Flag("reversed", "slip-reverses")])
    'penetration; slip-reverses'
    """
    return "; ".join(dict.fromkeys(flag.code for flag in flags))


def _reached(scene: Scene | None, result: Result | None) -> dict[str, Any]:
    rim = _rim(scene)
    return {} if result is None else _numbers(_what(scene), rim, result, _radial(rim, result))


def _radial(rim: RotatingRim | Rub | None, result: Result) -> Array:
    """Amplitudes of the rim's radial motion, (states, 2 N + 1); none without a rim."""
    if rim is None:
        return np.zeros((0, 0))
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(result.state_of("casing") @ rim.casing.rows[: 2 * rim.casing.n_max + 1].T)


def _numbers(what: What | None, rim: RotatingRim | Rub | None, result: Result, radial: Array) -> dict[str, Any]:
    energy = result.energy
    found: dict[str, Any] = {
        "steps": result.steps, "closings": sum(len(part) for part in result.intervals),
        "contact_fraction": float(np.max(result.contact_steps, initial=0)) / result.steps if result.steps else 0.0,
        "impulse_N_s": float(np.sum(result.impulse)), "peak_force_N": float(np.max(result.peak_force, initial=0.0)),
        "max_penetration_m": float(np.max(result.max_penetration, initial=0.0)),
        "residual_m": float(np.max(result.residual, initial=0.0)), "lost_in_contact_J": energy.lost_in_contact,
        "friction_J": energy.friction, "damping_J": energy.damping, "rotation_J": energy.rotation,
        "worn_J": None if result.wear is None else result.wear.dissipated,
        "unaccounted_rel": energy.unaccounted / energy.scale if energy.scale > 0.0 else 0.0,
    }  # fmt: skip
    if len(result.state):
        found |= _motion(what, rim, result, radial)
    grown = result.growth
    if grown is not None:
        found |= {
            "motion": grown.outcome, "growth_1_s": grown.rate,
            "growth_low_1_s": grown.low, "growth_high_1_s": grown.high,
            "growth_check": grown.check or None, "half_wall_at_s": grown.time_to_half_wall,
            "body": grown.body or None, "n": grown.nodal_diameters,
            "source": None if grown.cause is None else grown.cause.source or None,
        }  # fmt: skip
    plain: dict[str, Any] = finite(found)  # JSON and CSV have no word for nan and inf
    return plain


def _displacements(what: What | None, result: Result) -> Array | None:
    """Displacements [m] of a run without a rim, (states, places); None if its states are only angles or modes."""
    if isinstance(what, Patch):
        return np.asarray(result.state @ what.body.rows.T)
    if isinstance(what, PointGap) and len(what.sides) == 1:
        return np.asarray(result.state @ what.sides[0].body.rows.T)
    return result.state if isinstance(what, Sequence) and "modal" not in result.scheme else None


def _motion(what: What | None, rim: RotatingRim | Rub | None, result: Result, radial: Array) -> dict[str, Any]:
    """Amplitudes over the last quarter."""
    late = slice(3 * len(result.state) // 4, None)
    with np.errstate(over="ignore", invalid="ignore"):
        if rim is None:
            moved = _displacements(what, result)
            return {} if moved is None else {"amplitude_m": float(np.abs(moved).max())}
        name, normal = rim.blade_normal()
        blade = result.state_of(name) @ normal
        levels = _levels(radial[late], rim.casing.n_max)
        n = int(levels.argmax())
        return {
            "amplitude_m": float(np.sqrt(np.sum(levels**2))), "blade_rms_m": float(np.std(blade[late])),
            "dominant_n": n, "dominant_rms_m": float(levels[n]),
        }  # fmt: skip


def _what(scene: Scene | None) -> What | None:
    return None if scene is None else scene.what


def _rim(scene: Scene | None) -> RotatingRim | Rub | None:
    what = None if scene is None else scene.what
    return what if isinstance(what, RotatingRim | Rub) else None


def _levels(radial: Array, N: int) -> Array:
    """RMS radial vibration about its mean around the rim, by nodal diameters [m], (N + 1,)."""
    centred = radial - radial.mean(axis=0)
    power = np.mean(centred * centred, axis=0)
    levels = power[: N + 1].copy()
    levels[1:] = 0.5 * (levels[1:] + power[N + 1 :])
    return np.asarray(np.sqrt(levels))


def _flags(result: Result, rim: RotatingRim | Rub | None, radial: Array) -> list[Flag]:
    """Flags of the run, and a flag on the stored states."""
    found = list(result.flags)
    largest = max(float(radial.max(initial=0.0)), -float(radial.min(initial=0.0)))
    if rim is not None and largest > FAR * rim.casing.line_radius(0):
        found.append(Flag("the rim moved by more than a tenth of its radius", "motion-radius"))
    return found


def run_path(folder: Path, digest: str) -> Path:
    """File of a run, in one of 256 folders."""
    return folder / "runs" / digest[:2] / f"{digest}.json"


def write_run(folder: Path, digest: str, row: Row) -> None:
    """Write the row of a run, whole or not at all; any process may."""
    write_checked(run_path(folder, digest), "row", row, format=FORMAT, hash=digest)


def read_run(path: Path) -> Row | None:
    """Row of a run file; None if there is no complete run file of this name."""
    return cast("Row | None", read_checked(path, "row", format=FORMAT, hash=path.stem))


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """A folder of runs, which any number of processes may write and read."""

    folder: Path

    @staticmethod
    def open(folder: Path) -> Store:
        """Open or make a store."""
        (folder / "runs").mkdir(parents=True, exist_ok=True)
        return Store(folder=folder)

    def rows(self, digests: Iterable[str]) -> dict[str, Row]:
        """Rows of those runs that are stored, by hash."""
        found = {digest: read_run(run_path(self.folder, digest)) for digest in digests}
        return {digest: row for digest, row in found.items() if row is not None}

    def note(self, rows: Mapping[str, Row]) -> None:
        """Write a row that no worker has written, because it does not share the disk."""
        for digest, row in rows.items():
            if read_run(run_path(self.folder, digest)) is None:
                write_run(self.folder, digest, row)

    def files(self) -> list[Path]:
        """All run files, by name."""
        return sorted((self.folder / "runs").glob("??/*.json"), key=lambda path: path.name)

    def unreadable(self) -> list[Path]:
        """Run files that are incomplete; there are none, even after a kill."""
        return [path for path in self.files() if read_run(path) is None]
