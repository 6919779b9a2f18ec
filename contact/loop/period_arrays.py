"""Arrays of a passage through a period: plant, phases, drive, work space, and their making."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.loop.phase import PhaseArrays, PhaseWork, phase_work


class PlantArrays(NamedTuple):
    """Arrays that all phases of a plant share."""

    push: Array  # (n, k)
    shift: Array  # (watched, k)
    gaps: Array  # (k, n)
    rigid: Indices  # (k,)
    slips: Indices  # (slips, 2): contact, row of its slip among the outputs
    coupled: Indices  # (1,): whether the compliances of contacts are coupled


class PhaseTable(NamedTuple):
    """Plant and known phases. Complex numbers have their real part at [0], of phases at [phase, 0]."""

    known: Indices  # (1,) number of phases
    closed: Indices  # (phases, k) 1 where closed
    lam: Array  # (phases, 2, m)
    V: Array  # (phases, 2, n, m)
    U: Array  # (phases, 2, m, n)
    rows: Array  # (phases, watched, n)
    seen: Array  # (phases, 2, watched, m): rows V
    solve: Array  # (phases, k, k): L^-1 on the closed contacts, zero elsewhere
    plant: PlantArrays


class DriveTable(NamedTuple):
    """Forcing of a drive, and of each phase under it once `made`."""

    harmonic: Array  # (h,) [rad/s]
    base: Array  # (1,) [rad/s]
    b_rest: Array  # (n,)
    b_wave: Array  # (2, n, h)
    pull_rest: Array  # (k,): of the contacts' equations
    pull_wave: Array  # (2, k, h)
    reach: Array  # (k,): displacement of a free gap by the drive alone, its acceleration over w^2
    watched_rest: Array  # (watched,)
    watched_wave: Array  # (2, watched, h)
    made: Indices  # (phases,)
    beta: Array  # (phases, 2, m)
    rest: Array  # (phases, watched)
    wave: Array  # (phases, 2, watched, h): without the forced vibration
    drive_rest: Array  # (phases, n)
    drive_wave: Array  # (phases, 2, n, h)
    X: Array  # (phases, 2, n, h)


class PeriodWork(NamedTuple):
    """State, events and work space; `at` is the time, `where` the phase, the contact met, events, stretches."""

    x: Array  # (n,)
    M: Array  # (n, n)
    half: Array  # (2, m, n)
    first: Indices  # (k,) closed at the start
    closed: Indices  # (k,)
    gap: Array  # (k,)
    force: Array  # (k,)
    most: Array  # (outputs,)
    least: Array  # (outputs,)
    event_time: Array  # (events,)
    event: Indices  # (events,): contact, -1 - contact where it opens
    stretch_time: Array  # (stretches,)
    stretch: Indices  # (stretches,): phase
    at: Array  # (1,)
    where: Indices  # (4,)
    sides: Array  # (2, 2, m): forced vibration, ahead and back


class Period(NamedTuple):
    """All arrays of a passage."""

    phases: PhaseTable
    drive: DriveTable
    now: PhaseArrays
    moving: PhaseWork
    work: PeriodWork


def phase_table(k: int, n: int, watched: int, room: int, m: int, plant: PlantArrays) -> PhaseTable:
    """An empty table with space for phases of `m` numbers."""
    return PhaseTable(
        known=np.zeros(1, int), closed=np.full((room, k), -1), lam=np.zeros((room, 2, m)), V=np.zeros((room, 2, n, m)),
        U=np.zeros((room, 2, m, n)), rows=np.zeros((room, watched, n)), seen=np.zeros((room, 2, watched, m)),
        solve=np.zeros((room, k, k)), plant=plant,
    )  # fmt: skip


def drive_table(phases: PhaseTable, h: int) -> DriveTable:
    """An empty table for a drive of h harmonics."""
    (room, k), (watched, n), m = phases.closed.shape, phases.rows.shape[1:], phases.lam.shape[2]
    return DriveTable(
        harmonic=np.zeros(h), base=np.zeros(1), b_rest=np.zeros(n), b_wave=np.zeros((2, n, h)), pull_rest=np.zeros(k),
        pull_wave=np.zeros((2, k, h)), reach=np.zeros(k), watched_rest=np.zeros(watched),
        watched_wave=np.zeros((2, watched, h)), made=np.zeros(room, int), beta=np.zeros((room, 2, m)),
        rest=np.zeros((room, watched)), wave=np.zeros((room, 2, watched, h)), drive_rest=np.zeros((room, n)),
        drive_wave=np.zeros((room, 2, n, h)), X=np.zeros((room, 2, n, h)),
    )  # fmt: skip


def period_of(phases: PhaseTable, h: int, events: int) -> Period:
    """All arrays of a passage, and their work space."""
    (_, k), (watched, n), m = phases.closed.shape, phases.rows.shape[1:], phases.lam.shape[2]
    now = PhaseArrays(
        lam=np.zeros((2, m)), beta=np.zeros((2, m)), rows=np.zeros((2, watched, m)), rest=np.zeros(watched),
        wave=np.zeros((2, watched, h)), harmonic=np.zeros(h),
    )  # fmt: skip
    work = PeriodWork(
        x=np.zeros(n), M=np.zeros((n, n)), half=np.zeros((2, m, n)), first=np.zeros(k, int), closed=np.zeros(k, int),
        gap=np.zeros(k), force=np.zeros(k), most=np.zeros(watched - k), least=np.zeros(watched - k),
        event_time=np.zeros(events), event=np.zeros(events, int), stretch_time=np.zeros(2 * events + 2),
        stretch=np.zeros(2 * events + 2, int), at=np.zeros(1), where=np.zeros(4, int), sides=np.zeros((2, 2, m)),
    )  # fmt: skip
    return Period(phases, drive_table(phases, h), now, phase_work(now), work)
