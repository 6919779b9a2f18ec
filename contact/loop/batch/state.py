"""What the compiled loop of eight rims works on: (m, 8) and (8,) arrays, lanes as innermost index."""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array, Indices


class BatchTerms(NamedTuple):
    """Sums of waves: block b of rows has those at wave[start[b]] .. wave[start[b + 1] - 1]; all count single numbers.

    Where all lanes have the same coefficients a block is four rows with most of their waves in common, so that a wave
    is read once for them, and coefficient 4 j + r is that of wave j in row[4 b + r]; else it is one row.
    """

    row: Indices
    start: Indices
    wave: Indices
    value: Array  # (terms, 8)
    alike: Array  # (terms,), empty where lanes differ: an eighth of the memory


class BatchFreeFlight(NamedTuple):
    """The fields of `FreeFlight`, one row a lane; `powers` (1, bits, 4, m) where all lanes have the same."""

    powers: Array
    fade: Array
    cos: Array
    sin: Array
    start: Indices
    wave: Indices
    row: Array
    floor: Array
    reach: Array
    taken: Indices
    open: Indices  # (8,): steps whose gap is surely open, up to this one


class BatchSamples(NamedTuple):
    """What lanes store: samples (8, rows), states (8, states, m); `due` (2, 8) the next steps that are stored."""

    time: Array
    force: Array
    gap: Array
    impulse: Array
    state_time: Array
    state: Array
    due: Indices
    every: Indices  # (2, 8)
    filled: Indices  # (2, 8)


class BatchState(NamedTuple):
    """State and coefficients of eight runs (m, 8), what differs between them (8,), and work space."""

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    weight: Array
    alike: Array  # (4, m): al, be, c, weight where all runs have the same, else empty
    normal: BatchTerms  # rows of the modes, then clearance, S_nn, S_nt, S_tt
    tangent: BatchTerms
    angle: Array
    speed: Array
    surface: Array
    mu: Array
    h: Array
    averaged: Array  # 1, or 0 for the forward law
    turns: Array  # 1 where S depends on the angle, else 0
    away: Array  # 0, or a gap that never closes where no run is
    live: Indices
    step: Indices
    end: Indices
    retry: Indices
    failed: Indices  # 1 no force was found, 2 the motion passed a limit
    reach: Array  # (m, 8), as `RimRows.reach`
    limits: Array  # (4, 8), of `motion_limits`
    memory: Array  # (10, 8), as on a rim alone
    Q: Array  # (m + 5, 8): the rows of `normal`, then one that nothing reads
    Q_next: Array
    T: Array  # (m + 1, 8)
    waves: Array  # (harmonics, 2, 8): cos n phi, sin n phi
    waves_next: Array
    work: Array  # (18, 8)


FREE, TEST, FORCE, PULL, DRAG, H_, SCALE, NORMAL, TANGENT, DAMPING, SLIDE, ANGLE, N_T, BEFORE, GAP = range(15)
T_N, T_T, SLIP = 15, 16, 17
STRAIN, HEAT, DRIVE = 7, 8, 9  # rows of `memory`; 4 .. 6 are S_nn, S_nt, S_tt
