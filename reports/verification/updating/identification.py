"""Identification judged on synthetic responses whose modes are known.

`python -m reports.verification.updating.identification [--quick] [--seed N --sets M] [--sensors S] [--out DIR]` makes
the sets of `reports.verification.updating.identification_sets`, half with one reference and half with two, identifies
each with default options, and prints one row a set, the failures, the errors by size of the split, and the share of
truths within the 95 % intervals of frequency, damping and orientation. It writes identification.csv and
identification_intervals.csv.

A mode counts as found if a mode of the same n lies within its half-power bandwidth and within 45/n deg. If the
imperfections mix two n, either n with a quarter of its energy counts, and the angle is not judged. One found mode
represents both members if it is marked as an unresolved pair, or if it has no partner and its bound on a hidden split
is above the true one. All further modes are spurious; sure and doubtful ones are counted separately.
"""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from casingfem.experiment.identify.identification import identify
from casingfem.experiment.identify.identified import Identified
from casingfem.io.arrays import FloatArray
from reports.tables import Row, command_line, show, write
from reports.verification.updating.identification_sets import SENSORS, SNR_DB, TestSet, make_set

SEEDS = range(13101, 13121)
FREQ_PERCENT, ANGLE_DEG = 0.05, 3.0  # required of pairs half a bandwidth apart or more
RESOLVED = 0.5  # splits in half-power bandwidths from which pairs must be distinguished
NORMAL = 1.96
FAR = 1e6  # Hz: cost of a mode that is not the true one
SHARE = 0.25  # of a mode's energy, of an n that may be its label
CLASSES = (0.0, 0.1, 0.2, 0.5, 1.0, np.inf)


class Judged(NamedTuple):
    """One true mode: its pair's split in bandwidths (inf without partner), its outcome, errors over sigma."""

    seed: int
    references: int
    n: int
    freq: float
    split: float
    outcome: str  # found | one of a pair | missed
    freq_percent: float
    angle_deg: float
    freq_sigmas: float
    zeta_sigmas: float
    angle_sigmas: float


def judge(data: TestSet, found: Identified, seed: int, references: int) -> tuple[list[Judged], list[int]]:
    """Outcome of each true mode, and the spurious modes found."""
    truth = data.modes
    assert truth.rings is not None
    shares = truth.rings.shares()
    gap = np.abs(found.freq[None] - truth.freq[: data.count, None])
    turn = truth.nodal_diameters[: data.count, None] * np.radians(
        found.angle_deg[None] - data.angle_deg[: data.count, None]
    )
    alike = (found.n >= 0) & (shares[found.n, : data.count].T > SHARE)
    near = alike & (gap < (2.0 * data.zeta * truth.freq)[: data.count, None])
    other = found.n[None] != truth.nodal_diameters[: data.count, None]
    told = near & ((np.abs(np.sin(turn)) < np.sqrt(0.5)) | other | np.isnan(turn))
    wholes = list[list[int]]()
    for k in range(data.count):
        pair = truth.doublet_of(k)
        part = float(truth.splits[pair]) if pair >= 0 else np.inf
        alone = [j for j in np.flatnonzero(near[k]).tolist() if found.doublet_of(j) < 0]
        wholes.append([j for j in alone if j in found.unresolved or found.split_bound[j] > part])
        told[k, wholes[k]] = False
    told[:, list(found.unresolved)] = False
    rows, columns = linear_sum_assignment(np.where(told, gap, FAR))
    match = {k: j for k, j in zip(rows.tolist(), columns.tolist(), strict=True) if told[k, j]}
    judged = []
    stands = {j for j in found.unresolved if (np.abs(found.freq[j] / truth.freq - 1) < 2 * found.zeta[j]).any()}
    for k in range(data.count):
        n, freq, zeta = int(truth.nodal_diameters[k]), float(truth.freq[k]), float(data.zeta[k])
        pair = truth.doublet_of(k)
        split = float(truth.splits[pair] / (2.0 * zeta)) if pair >= 0 else np.inf
        nothing = (seed, references, n, freq, split)
        if k in match:
            j = match[k]
            labelled = n > 0 and found.n[j] == n
            error = float(np.degrees(np.arcsin(np.sin(turn[k, j]))) / n) if labelled else np.nan
            by_freq = float((found.freq[j] - freq) / found.sigma_freq[j])
            by_zeta = float((found.zeta[j] - zeta) / found.sigma_zeta[j])
            errors = 100.0 * float(gap[k, j]) / freq, abs(error)
            judged.append(Judged(*nothing, "found", *errors, by_freq, by_zeta, float(error / found.sigma_angle[j])))
        elif wholes[k]:
            j = min(wholes[k], key=lambda j: float(gap[k, j]))
            stands.add(j)
            by_freq = float(gap[k, j] / found.sigma_freq[j])
            judged.append(
                Judged(*nothing, "one of a pair", 100.0 * float(gap[k, j]) / freq, np.nan, by_freq, np.nan, np.nan)
            )
        else:
            judged.append(Judged(*nothing, "missed", np.nan, np.nan, np.nan, np.nan, np.nan))
    return judged, sorted(set(range(len(found))) - set(match.values()) - stands)


def must(judged: Sequence[Judged]) -> list[Judged]:
    """Modes whose pair is half a bandwidth apart, or more."""
    return [mode for mode in judged if mode.split >= RESOLVED]


def set_row(found: Identified, judged: list[Judged], extra: list[int]) -> Row:
    """One line of the table of sets; `extra` are the spurious modes."""
    clear = must(judged)
    sure = sum(bool(found.sure[k]) for k in extra)
    met = [mode for mode in clear if mode.outcome == "found"]
    return {
        "seed": judged[0].seed,
        "references": judged[0].references,
        "modes": len(judged),
        "clear": len(clear),
        "clear found": len(met),
        "closer": len(judged) - len(clear),
        "distinguished": sum(mode.outcome == "found" for mode in judged) - len(met),
        "as one": sum(mode.outcome == "one of a pair" for mode in judged),
        "missed": sum(mode.outcome == "missed" for mode in judged),
        "spurious": len(extra),
        "spurious sure": sure,
        "freq error %": max(mode.freq_percent for mode in met),
        "angle error deg": max(mode.angle_deg for mode in met if np.isfinite(mode.angle_deg)),
        "seconds": found.seconds,
    }


def by_split(judged: Sequence[Judged]) -> list[Row]:
    """Outcomes and worst errors by size of the split."""
    rows: list[Row] = []
    for low, high in pairwise(CLASSES):
        members = [mode for mode in judged if low <= mode.split < high or (high == np.inf and mode.split == np.inf)]
        met = [mode for mode in members if mode.outcome == "found"]
        rows.append(
            {
                "split / bandwidth": f"{low:g} to {high:g}" if high < np.inf else f"{low:g} and more, or no partner",
                "modes": len(members),
                "found": len(met),
                "as one": sum(mode.outcome == "one of a pair" for mode in members),
                "missed": sum(mode.outcome == "missed" for mode in members),
                "worst freq %": max((mode.freq_percent for mode in met), default=None),
                "worst angle deg": max((mode.angle_deg for mode in met if np.isfinite(mode.angle_deg)), default=None),
            }
        )
    return rows


def intervals(judged: Sequence[Judged]) -> list[Row]:
    """Number of 95 % intervals that contain the truth, by size of the split, for found members only."""
    classes = [*pairwise(CLASSES), (RESOLVED, np.inf)]
    rows: list[Row] = []
    for low, high in classes:
        met = [mode for mode in judged if mode.outcome == "found" and low <= mode.split]
        met = [mode for mode in met if mode.split < high or high == np.inf]
        row: Row = {
            "split / bandwidth": f"{low:g} to {high:g}" if high < np.inf else f"{low:g} and more, or no partner"
        }
        for name in ("freq", "zeta", "angle"):
            sigmas = np.array([getattr(mode, f"{name}_sigmas") for mode in met], float)
            sigmas = sigmas[np.isfinite(sigmas)]
            row |= {f"{name}s": len(sigmas), f"{name} holds %": coverage(sigmas)}
        rows.append(row)
    return rows


def coverage(sigmas: FloatArray) -> float | None:
    """Share [%] of errors within the 95 % interval."""
    return 100.0 * float(np.mean(np.abs(sigmas) < NORMAL)) if len(sigmas) else None


def failures(judged: Sequence[Judged]) -> list[Row]:
    """Modes that were missed, or found with more than the allowed error."""
    return [
        {
            "seed": mode.seed,
            "references": mode.references,
            "n": mode.n,
            "freq Hz": mode.freq,
            "split / bandwidth": mode.split,
            "outcome": mode.outcome,
            "freq error %": mode.freq_percent,
            "angle error deg": mode.angle_deg,
        }
        for mode in judged
        if mode.outcome == "missed"
        or (mode.split >= RESOLVED and mode.outcome != "found")
        or mode.freq_percent > FREQ_PERCENT
        or mode.angle_deg > ANGLE_DEG
    ]


def main(out: Path, quick: bool = False, seed: int = 0, sets: int = 20, sensors: int = SENSORS) -> list[Row]:
    """Identify the sets, print the tables, write the rows of the sets."""
    rows, everything = [], list[Judged]()
    seeds = range(seed, seed + sets) if seed else SEEDS[:2] if quick else SEEDS
    for k, number in enumerate(seeds):
        references = 1 + k % 2
        data = make_set(number, references, sensors)
        found = identify(data.frfs, angles=data.angles)
        judged, extra = judge(data, found, number, references)
        rows.append(set_row(found, judged, extra))
        everything += judged
    show(f"Sets: {sensors} sensors, signal over noise {SNR_DB:g} dB; clear: split of half a bandwidth or more", rows)
    splits = by_split(everything)
    show("By split", splits)
    write(out / "identification_splits.csv", splits)
    held = intervals(everything)
    show("95 % intervals that hold the truth", held)
    write(out / "identification_intervals.csv", held)
    bad = failures(everything)
    if bad:
        show(f"Missed, or off by more than {FREQ_PERCENT:g} % or {ANGLE_DEG:g} deg", bad)
    write(out / "identification.csv", rows)
    words = ("modes", "clear", "clear found", "spurious", "spurious sure")
    total: Row = {"sets": len(rows)} | {word: sum(int(str(row[word])) for row in rows) for word in words}
    write(out / "identification_summary.csv", [total])
    return rows


if __name__ == "__main__":
    command_line(
        __doc__,
        main,
        seed=(0, "seed of the first set, of which --sets are made; 0 for the usual twenty"),
        sets=(20, "sets from that seed on"),
        sensors=(SENSORS, "sensors on the rim"),
    )
