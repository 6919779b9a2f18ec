"""Result of a run: forces, intervals, impulses, energy budget, and the largest penetration."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.io.columns import WIDE, Column, table_lines
from contact.io.names import hint
from contact.io.outfiles import finite
from contact.io.reported import Reported
from contact.io.trust import Flag
from contact.model.law import pressure
from contact.record.energy import Divergence, EnergyBudget
from contact.record.growth import RunGrowth
from contact.record.record import MOST_SAMPLES
from contact.record.wear import Wear, joined
from contact.result_file import read_result, write_result
from contact.scheme.protocol import Block, Motion, Notes

LONGEST = 8  # numbers in a line that lists tips
TIPS = "tips"  # block of a stepper's coordinates that contains forces on tips: `Result.tip_force`

Intervals = tuple[tuple[float, float], ...]


CONTACTS = (
    Column("contact", "Number of the contact, from 1.", lambda run: range(1, run.impulse.size + 1), format="d"),
    Column("closings", "Number of closings of the contact.", lambda run: [len(closed) for closed in run.intervals],
           format="d"),
    Column("closed_s", "Total time with the contact closed.", lambda run: run.contact_steps * run.dt,
           head="closed", unit="s", format=".4g"),
    Column("impulse_N_s", "Impulse of the contact.", lambda run: run.impulse, head="impulse", unit="N s",
           format=".6g"),
    Column("peak_force_N", "Largest force of a step, which depends on the step.", lambda run: run.peak_force,
           head="peak", unit="N", format=".4g"),
    Column("windowed_force_N", "Largest force averaged over the period of the highest mode.",
           lambda run: run.windowed_force().max(axis=0, initial=0.0), head="averaged", unit="N", format=".4g"),
    Column("max_penetration_m", "Deepest penetration.", lambda run: run.max_penetration, head="depth", unit="m",
           format=".3g"),
    Column("residual_m", "Largest violation of the contact law.", lambda run: run.residual, head="residual",
           unit="m", format=".3g"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Result(Reported):
    """One run with n samples and K contacts. Forces are compressive >= 0 [N]; `lam` = -force is the public sign.

    `time` (n,) [s]; `force`, `gap` (n, K); `impulse_history` (n, K): impulse up to time + dt/2 [N s]; `intervals` of
    contact per contact [s], `sticking` those without slip, both located within their steps (on a `Rub`: to a step);
    `impulse`, `peak_force`, `max_penetration` [m], `residual` = max|min(-lam W_ii, g)| [m], `contact_steps` and
    `reversals` (steps in which the slip changed sign) (K,), all over every step whatever was stored. `state` (ns, N)
    displacements or modal coordinates u at `state_time`; `tip_force` (ns, K d): forces [N] on the tips of a rim or a
    rub at the same times, the d components of each tip together, no columns in other problems. Where `channels` = R is
    not empty, `state` is R (u, tip_force), (ns, c), and `tip_force` has no columns. `every`: number of steps between
    stored samples, 0 if the record states times. `tracks`: wear of each track of an abradable coating. `divergence`:
    why the run ended early, None if it did not. `growth` of the motion of a rim, a rub or a disk whose states are
    stored (`ct.stability.of_run`), None for other runs.

    The raw peak force does not converge with the step; `windowed_force` does. The same input gives identical bits.

    >>> import contact as ct
    >>> ball = ct.PointMass(mass=2.0, x=0.01, velocity=-1.0)
    >>> result = ct.run([ct.Wall(), ball], scheme=ct.MoreauJean(), t_end=0.02, dt=1e-4)
    >>> round(float(result.impulse[0]), 6), result.steps  # thrown back: 2 m v
    (2.0, 200)
    """

    COLUMNS: ClassVar = CONTACTS

    time: Array
    force: Array
    gap: Array
    impulse_history: Array
    intervals: tuple[Intervals, ...]
    impulse: Array
    peak_force: Array
    max_penetration: Array
    residual: Array
    contact_steps: Array
    reversals: Array
    state_time: Array
    state: Array
    energy: EnergyBudget
    motions: tuple[Motion, ...]
    blocks: tuple[Block, ...]
    steps: int
    dt: float
    window: float
    seconds: float
    scheme: str
    source: dict[str, str]
    channels: Array
    tip_force: Array = field(default_factory=lambda: np.zeros((0, 0)))
    every: int = 1
    sticking: tuple[Intervals, ...] = ()
    tracks: tuple[Wear, ...] = ()
    notes: Notes = field(default_factory=Notes)
    divergence: Divergence | None = None
    growth: RunGrowth | None = None

    @property
    def wear(self) -> Wear | None:
        """Wear of an abradable coating, all tracks together; None without a coating."""
        return joined(self.tracks)

    @property
    def flags(self) -> tuple[Flag, ...]:
        """Warnings about the numbers: texts that end with a code of `contact.io.trust.TROUBLES`.

        `flag.code` is that code; `flag.failed` is true if the numbers are wrong, false for a warning.
        """
        return self.notes.flags

    @property
    def lam(self) -> Array:
        """Contact pressure in the public sign, <= 0, (n, K)."""
        return pressure(self.force)

    @property
    def least_gap(self) -> Array:
        """Smallest gap of the stored samples, (K,) [m]; NaN without samples."""
        return np.asarray(self.gap.min(axis=0)) if len(self.gap) else np.full(self.impulse.shape, np.nan)

    def state_of(self, name: str) -> Array:
        """Columns of `state` that belong to one body, (ns, its coordinates).

        Raises InputError that lists the names, or if channels were stored instead.
        """
        if self.channels.size:
            raise InputError(
                f"state: found {len(self.channels)} channels of all bodies, expected a record without channels"
            )
        found = [slice(start, end) for body, start, end in self.blocks if body == name]
        if not found:
            known = [body for body, _, _ in self.blocks]
            raise InputError(f"name: found {name!r}, expected one of {', '.join(known)}{hint(name, known)}")
        return self.state[:, found[0]]

    def windowed_force(self, window: float | None = None) -> Array:
        """Force averaged over `window` [s] centred on each sample, (n, K); default 1/f_max of the model."""
        width = max(self.window if window is None else window, self.dt)
        ends = self.time + 0.5 * self.dt
        grid = np.concatenate(([-0.5 * self.dt], ends))
        early, late = self.time - 0.5 * width, self.time + 0.5 * width
        columns = []
        for k in range(self.force.shape[1]):
            history = np.concatenate(([0.0], self.impulse_history[:, k]))
            columns.append((np.interp(late, grid, history) - np.interp(early, grid, history)) / width)
        return np.stack(columns, axis=1) if columns else np.zeros_like(self.force)

    def merged_intervals(self, pause: float | None = None) -> tuple[Intervals, ...]:
        """Intervals of contact, joined across openings shorter than `pause` [s] (default: the window)."""
        limit = self.window if pause is None else pause
        merged = []
        for intervals in self.intervals:
            joined: list[tuple[float, float]] = []
            for start, end in intervals:
                if joined and start - joined[-1][1] < limit:
                    joined[-1] = (joined[-1][0], end)
                else:
                    joined.append((start, end))
            merged.append(tuple(joined))
        return tuple(merged)

    def __repr__(self) -> str:
        energy, scale = self.energy, max(self.energy.scale, math.ulp(0.0))
        span = self.steps * self.dt
        lines = [
            f"{self.steps} steps of {self.dt:.4g} s to {span:.6g} s in {self.seconds:.3g} s: {self.scheme}",
            *(table_lines(self.COLUMNS, self.records(), width=WIDE) if self.impulse.size else ()),
        ]
        if self.notes.orbit is not None:
            lines.append(f"orbit: {self.notes.orbit.words}")
        if self.notes.spin is not None:
            lines.append(f"energy of the rotor's spin: {self.notes.spin.words}")
        if self.gap.size and not any(self.intervals):
            row, k = divmod(int(self.gap.argmin()), self.gap.shape[1])
            lines.append(f"no contact closed: the smallest gap was {self.gap[row, k]:.4g} m, at contact {k + 1} and "
                         f"{self.time[row]:.6g} s")  # fmt: skip
        lines.append(
            f"energy [J]: start {energy.start.total:.6g}, end {energy.end.total:.6g}, lost in contact "
            f"{energy.lost_in_contact:.4g}, rotation {energy.rotation:.4g}, friction {energy.friction:.4g}, "
            f"{f'gravity and whirl {energy.body_force:.4g}, ' if energy.body_force else ''}"
            f"damping {energy.damping:.4g}, numerical {energy.numerical:.3g}, "
            f"unaccounted {energy.unaccounted / scale:.1e} of the largest"
        )
        if self.notes.heat.size:
            heat, drive = float(self.notes.heat.sum()), float(self.notes.drive.sum())
            lines.append(f"friction [J]: {heat:.4g} dissipated, {drive:.4g} supplied by the drive of the rim")
        if self.growth is not None:
            lines.append(f"motion: {self.growth.words}")
        lines.extend(f"{'FAILED' if flag.failed else 'FLAG'}: {flag}" for flag in self.flags)
        if self.wear is not None:
            lines.append(f"coating: {self.wear!r}")
        if len(self.tracks) > 1:
            lines.extend(f"  track {k} (tips {_listed(t.tips)}): {t!r}" for k, t in enumerate(self.tracks, 1))
        if self.every != 1:
            which = f"one of every {self.every} steps (at most {MOST_SAMPLES:,} samples unless a Record is given)"
            lines.append(
                f"stored: {self.time.size:,} samples, {which if self.every else 'at the steps nearest to the instants'}"
                "; sums, intervals, impulse and energy use every step"
            )
        return "\n".join(lines)

    def columns(self) -> dict[str, Array]:
        """One row for each sample: time, and force, window-averaged force, gap and impulse so far of each contact."""
        found, windowed = {"time_s": self.time}, self.windowed_force()
        for k in range(self.force.shape[1]):
            found |= {
                f"force{k + 1}_N": self.force[:, k], f"windowed_force{k + 1}_N": windowed[:, k],
                f"gap{k + 1}_m": self.gap[:, k], f"impulse{k + 1}_N_s": self.impulse_history[:, k],
            }  # fmt: skip
        return found

    @property
    def impact_energy(self) -> float:
        """Mean impulse of an impact times approach speed / 4 [J]: the kinetic energy of an impact without loss."""
        if self.time.size < 2:
            return 0.0
        speed = np.max(np.abs(np.diff(self.gap, axis=0)) / np.diff(self.time)[:, None], axis=0)
        closings = np.array([max(len(intervals), 1) for intervals in self.intervals])
        return float(np.max(0.25 * self.impulse / closings * speed, initial=0.0))

    def to_dict(self, *, most: int | None = None) -> dict[str, object]:
        """The document of `casingfem contact --json`: contacts, bodies, energy, steps, seconds.

        Histories (time, force, gap, windowed force of all contacts; intervals of all contacts) of more than `most`
        numbers are left out; `left_out` names them with their count. None keeps all.
        """
        histories = {name: self.time.size * self.impulse.size for name in ("time", "force", "gap", "windowed_force")}
        closings = 2 * sum(map(len, self.intervals))
        long = most is not None and sum(histories.values()) > most
        left_out = histories if long else {}
        left_out |= {"intervals": closings} if most is not None and closings > most else {}
        contacts: list[dict[str, object]] = []
        windowed = self.windowed_force() if not long else self.force
        for k in range(self.impulse.size):
            drawn: dict[str, object] = {} if long else {
                "time": self.time.tolist(), "force": self.force[:, k].tolist(), "gap": self.gap[:, k].tolist(),
                "windowed_force": windowed[:, k].tolist(),
            }  # fmt: skip
            closed = {} if "intervals" in left_out else {"intervals": [list(pair) for pair in self.intervals[k]]}
            contacts.append({
                **drawn, **closed,
                "impulse": float(self.impulse[k]), "max_penetration": float(self.max_penetration[k]),
                "residual": float(self.residual[k]), "peak_force": float(self.peak_force[k]),
                "reversals": int(self.reversals[k]),
            })  # fmt: skip
        return {
            "contacts": contacts, "left_out": left_out,
            "bodies": [finite(asdict(motion)) for motion in self.motions],
            "energy": self.energy.to_dict(), "steps": self.steps, "dt": self.dt, "window": self.window,
            "every": self.every, "scheme": self.scheme, "source": self.source, "seconds": self.seconds,
            "flags": [flag.to_dict() for flag in self.flags],
            "divergence": None if self.divergence is None else self.divergence.to_dict(),
            "growth": None if self.growth is None else self.growth.to_dict(),
            **({} if self.notes.orbit is None else {"rotor": self.notes.orbit.to_dict()}),
            **({} if self.notes.spin is None else {"spin": self.notes.spin.to_dict()}),
            "coating": [track.to_dict() for track in self.tracks],
        }  # fmt: skip

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write npz without pickle, complete or not at all."""
        return write_result(path, self)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Result:
        """Read a saved result; raises InputError with file and key."""
        return cls(**read_result(path))


def coordinates_and_forces(stored: Array, blocks: Sequence[Block], *, whole: bool) -> dict[str, Any]:
    """Split the samples of a stepper (ns, N) into the fields `state`, `tip_force` and `blocks` of a result.

    `whole` is False where channels R (u, tip_force) were stored: they are not split.
    """
    bodies = tuple(block for block in blocks if block[0] != TIPS)
    end = max((stop for _, _, stop in bodies), default=0) if whole and len(bodies) < len(blocks) else stored.shape[1]
    return {"state": readonly(stored[:, :end]), "tip_force": readonly(stored[:, end:]), "blocks": bodies}


def _listed(tips: tuple[int, ...]) -> str:
    """Numbers from 1, with the middle of a long list left out."""
    numbers = [str(j + 1) for j in tips]
    return ", ".join(numbers if len(numbers) <= LONGEST else [*numbers[: LONGEST - 2], "...", numbers[-1]])
