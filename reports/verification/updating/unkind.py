"""Identification of difficult tests, with all disturbances of a real test at once.

`python -m reports.verification.updating.unkind [--quick] [--seed N --sets M] [--times] [--out DIR]` makes tests of rims
with 30 modes, all in pairs, and every disturbance of `casingfem.experiment.rig.troubles`. It identifies each with
default options, and prints the outcome of the modes whose peaks are above the noise, spurious sure modes, errors,
intervals, pairs and times. The truth of a mode is the mean of its set-ups. `--seed` makes tests of some seeds only,
without times; `--times` only the times, of 12 and 120 channels. It writes unkind.csv, unkind_modes.csv,
unkind_summary.csv and unkind_times.csv.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from casingfem.experiment.identify.identification import identify
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.rig.files import rig_angles
from casingfem.experiment.rig.rig import Probe, Rig
from casingfem.experiment.rig.troubles import TroubledTruth, Troubles, troubled_frfs
from casingfem.io.arrays import BoolArray, FloatArray
from casingfem.io.side_by_side import side_by_side, usable_cores
from reports.tables import Row, command_line, show, write

SEEDS = range(13001, 13041)
PAIRS, SENSORS, STEP_HZ = 15, 24, 0.125
SPLIT, DAMPING = (5e-4, 1e-2), (1e-3, 5e-3)  # log-uniform
GAPS = 0.008, 0.05  # between pairs, relative
LINES = 15_000  # of the tests that are timed
ABOVE = 1.0  # peak over the noise of a line
NORMAL = 1.96
TROUBLES = Troubles(
    snr_db=40.0, colour=0.5, coherent=0.3, setups=3, shift=2e-3, half_rim=True, dead=1, noisy=1, swapped=1, flipped=1,
    double_hit=0.4, exponential=2.0, leakage=True, fixture=1, phase_deg=5.0,
)  # fmt: skip


class Judged(NamedTuple):
    """One true mode and its outcome; errors relative in frequency and damping, and over sigma."""

    seed: int
    freq: float
    split: float  # of its pair, in bandwidths
    above: bool
    outcome: str  # sure | doubtful | one of a pair | missed
    freq_error: float = np.nan
    zeta_error: float = np.nan
    freq_sigmas: float = np.nan
    zeta_sigmas: float = np.nan
    reason: str = ""


def rim(seed: int, sensors: int = SENSORS) -> Rig:
    """A rim of uneven sensors and one drive, with pairs of seeded n, split, damping and orientation."""
    rng = np.random.default_rng(seed)
    around = 2 * np.pi * np.arange(sensors) / sensors + np.radians(rng.uniform(-4.0, 4.0, sensors))
    at = np.r_[around, rng.uniform(0, 2 * np.pi)]
    modes: list[tuple[float, float, FloatArray]] = []
    for freq in (300.0 * np.cumprod(1.0 + rng.uniform(*GAPS, PAIRS))).tolist():
        n, turn = int(rng.integers(2, 10)), rng.uniform(0.0, 2.0 * np.pi)
        split, zeta = (np.exp(rng.uniform(*np.log(limits))) for limits in (SPLIT, DAMPING))
        for k, side in enumerate((-0.5, 0.5)):
            own = freq * (1.0 + side * split), zeta * rng.uniform(0.9, 1.1)
            modes.append((*own, np.cos(n * at - turn - k * np.pi / 2)))
    modes.sort(key=lambda mode: mode[0])
    freq, zeta, rows = (np.array(column) for column in zip(*modes, strict=True))
    probes = [Probe(k + 1, 1, (0.0, 0.0, 0.0), float(angle)) for k, angle in enumerate(at)]
    return Rig.of(omega=2 * np.pi * freq, zeta=zeta, rows=rows.T, probes=probes)


def matched(gap: FloatArray, sure: BoolArray) -> dict[int, int]:
    """The true mode (rows) of each found mode (columns), by gaps below 1; sure modes first.

    A sure mode is assigned to the nearest true one, independent of doubtful modes beside it.
    """
    match: dict[int, int] = {}
    for some in (np.flatnonzero(sure), np.flatnonzero(~sure)):
        left = np.setdiff1d(np.arange(len(gap)), list(match))
        part = gap[np.ix_(left, some)]
        true, taken = linear_sum_assignment(np.where(part < 1.0, part, 1e3))
        match |= {int(left[k]): int(some[j]) for k, j in zip(true, taken, strict=True) if part[k, j] < 1.0}
    return match


def judge(seed: int, truth: TroubledTruth, found: Identified) -> tuple[list[Judged], Row]:
    """Outcome of each true mode, and the spurious modes found."""
    freq, zeta = truth.freq.mean(axis=0), truth.zeta.mean(axis=0)
    reach = np.ptp(truth.freq, axis=0) + 2.0 * zeta * freq
    gap = np.abs(found.freq[None] - freq[:, None]) / reach[:, None]
    match = matched(gap, found.sure)
    partner = np.abs(freq[:, None] - freq[None]) + 1e9 * np.eye(len(freq))
    split = partner.min(axis=1) / (2.0 * zeta * freq)
    judged = []
    for k in range(len(freq)):
        own = seed, float(freq[k]), float(split[k]), bool(truth.peak[k] > ABOVE)
        whole = [j for j in found.unresolved if gap[k, j] < 1.0]
        if k not in match:
            judged.append(Judged(*own, "one of a pair" if whole else "missed"))
            continue
        j = match[k]
        errors = float(found.freq[j] / freq[k] - 1.0), float(found.zeta[j] / zeta[k] - 1.0)
        sigmas = (
            float((found.freq[j] - freq[k]) / found.sigma_freq[j]),
            float((found.zeta[j] - zeta[k]) / found.sigma_zeta[j]),
        )
        why = found.reasons[j] if found.reasons else ""
        judged.append(Judged(*own, "sure" if found.sure[j] else "doubtful", *errors, *sigmas, why))
    fixture = np.any(np.abs(found.freq[None] - truth.fixture_hz[:, None]) < 0.01 * found.freq, axis=0)
    free = found.sure & ~np.isin(np.arange(len(found)), list(match.values())) & ~fixture
    twice = free & (gap < 1.0).any(axis=0)
    return judged, {
        "seed": seed,
        "found": len(found),
        "sure": int(found.sure.sum()),
        "spurious": int(np.sum(free & ~twice)),
        "twice": int(np.sum(twice)),
        "fixture sure": int(np.sum(found.sure & fixture & ~np.isin(np.arange(len(found)), list(match.values())))),
    }


def set_row(judged: Sequence[Judged], beside: Row, seconds: float) -> Row:
    """One test in a line."""
    above = [mode for mode in judged if mode.above]
    counts = {word: sum(mode.outcome == word for mode in above) for word in ("sure", "doubtful", "one of a pair")}
    return {
        **{key: beside[key] for key in ("seed", "found", "sure", "spurious", "twice", "fixture sure")},
        "modes": len(above),
        **{f"modes {word}": count for word, count in counts.items()},
        "missed": len(above) - sum(counts.values()),
        "seconds": seconds,
    }


def summary(judged: Sequence[Judged], rows: Sequence[Row]) -> Row:
    """All tests in a line, with the goals of the project."""
    above = [mode for mode in judged if mode.above]
    sure = [mode for mode in above if mode.outcome == "sure"]
    freq, zeta = (100.0 * np.abs([getattr(mode, name) for mode in sure]) for name in ("freq_error", "zeta_error"))
    held = [
        100.0 * float(np.mean(np.abs([getattr(mode, name) for mode in sure]) < NORMAL))
        for name in ("freq_sigmas", "zeta_sigmas")
    ]
    total = sum(int(str(row["sure"])) for row in rows)
    return {
        "tests": len(rows),
        "modes above noise": len(above),
        "found sure %": 100.0 * len(sure) / len(above),
        "doubtful %": 100.0 * sum(mode.outcome == "doubtful" for mode in above) / len(above),
        "spurious among sure %": 100.0 * sum(int(str(row["spurious"])) for row in rows) / max(total, 1),
        "counted twice": sum(int(str(row["twice"])) for row in rows),
        "freq median %": float(np.median(freq)),
        "freq worst %": float(freq.max()),
        "zeta median %": float(np.median(zeta)),
        "zeta worst %": float(zeta.max()),
        "freq holds %": held[0],
        "zeta holds %": held[1],
        "longest s": max(float(str(row["seconds"])) for row in rows),
    }


def pairs(judged: Sequence[Judged]) -> list[Row]:
    """Members of pairs by the size of their split."""
    rows: list[Row] = []
    for low, high in ((0.0, 0.5), (0.5, 1.0), (1.0, np.inf)):
        members = [mode for mode in judged if mode.above and low <= mode.split < high]
        count = {word: sum(mode.outcome == word for mode in members) for word in ("sure", "doubtful", "one of a pair")}
        rows.append({"split / bandwidth": f"{low:g} to {high:g}", "modes": len(members), **count,
                     "missed": len(members) - sum(count.values())})  # fmt: skip
    return rows


def duration(channels: int) -> Row:
    """Wall-clock time for a test with a number of channels over 15,000 lines, and the outcome of its modes."""
    rig = rim(SEEDS[0], channels)
    lines = np.linspace(0.9 * rig.freq[0], 1.05 * rig.freq[-1], LINES)
    what = replace(TROUBLES, half_rim=False, shift=3e-4)
    test = troubled_frfs(rig, lines, what, sensors=range(channels), drives=[channels], seed=SEEDS[0])
    started = time.perf_counter()
    found = identify(test.frfs, angles=rig_angles(rig))
    seconds = time.perf_counter() - started
    row = set_row(*judge(SEEDS[0], test.truth, found), seconds)
    kept = (
        "found",
        "sure",
        "spurious",
        "twice",
        "modes",
        "modes sure",
        "modes doubtful",
        "modes one of a pair",
        "missed",
    )
    beside = {key: row[key] for key in kept}
    return {"channels": channels, "lines": LINES, **beside, "cores": usable_cores(), "seconds": seconds}


def main(out: Path, quick: bool = False, seed: int = 0, sets: int = 1, times: bool = False) -> list[Row]:
    """Make, identify and judge the tests; returns their rows."""
    rows = [] if times else _tests(out, range(seed, seed + sets) if seed else SEEDS[:2] if quick else SEEDS)
    if times or not seed:
        durations = [duration(channels) for channels in ((12,) if quick else (12, 120))]
        show("Times", durations)
        write(out / "unkind_times.csv", durations)
    return rows


def _test(seed: int) -> tuple[Row, list[Judged]]:
    """A test of a seed, identified and judged."""
    rig = rim(seed)
    lines = np.arange(0.97 * rig.freq[0], 1.03 * rig.freq[-1], STEP_HZ)
    test = troubled_frfs(rig, lines, TROUBLES, sensors=range(SENSORS), drives=[SENSORS], seed=seed)
    started = time.process_time()
    found = identify(test.frfs, angles=rig_angles(rig))
    judged, beside = judge(seed, test.truth, found)
    return set_row(judged, beside, time.process_time() - started), judged


def _tests(out: Path, seeds: Sequence[int]) -> list[Row]:
    """Tests of some seeds, identified and judged: rows are printed and written."""
    rows, everything = [], list[Judged]()
    with side_by_side(min(usable_cores(), len(seeds))) as each:
        for row, judged in each(_test, seeds):
            rows.append(row)
            everything += judged
            print(f"{row['seed']}: {row['modes sure']} of {row['modes']} modes sure", flush=True)
    show("Tests, SYNTHETIC, with everything switched on", rows)
    show("Members of pairs", pairs(everything))
    show("In one line", [summary(everything, rows)])
    write(out / "unkind.csv", rows)
    write(out / "unkind_modes.csv", [mode._asdict() for mode in everything])
    write(out / "unkind_summary.csv", [summary(everything, rows)])
    return rows


if __name__ == "__main__":
    command_line(
        __doc__,
        main,
        seed=(0, "seed of the first test, of which --sets are made; 0 for the usual forty"),
        sets=(1, "tests from that seed on"),
        times="only the times",
    )
