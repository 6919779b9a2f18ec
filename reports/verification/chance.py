"""Chances of a family of casings: splits against full solutions, and estimates against a known distribution.

`python -m reports.verification.chance [--quick] [--out DIR]` prints four tables and writes them as CSV.

- Splits and orientations of the casing of data/studies/mistuning.toml by the map of its family, against full solutions
  of the shell; the time of 100,000 casings.
- Probability of a dangerous speed of data/scenes/chance at 100 speeds, each with its interval of 95 %.
- The casing of the first table with a thousandth of its imperfections: first-order theory gives the split of a pair of
  n diameters as a constant times the amplitude of harmonic 2n, whose distribution is known. Quantiles of the draws, how
  often their intervals have the true probability in 200 repetitions, and an event of 1e-5 by importance sampling after
  subsets.
"""

import shutil
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr

import casingfem as cf
from casingfem.chance.casings import Casings
from casingfem.chance.evaluate import Drawing, dangerous
from casingfem.chance.fields import RandomSeries
from casingfem.chance.load import load_chance
from casingfem.chance.replaced import IN_FULL, PURE, replaced
from casingfem.io.arrays import FloatArray
from casingfem.modal.mistuning import redrawn_shell
from casingfem.structure.field.random import RandomField
from reports.tables import DATA, Row, check, command_line, show, write
from reports.verification.robustness.chance_kills import prepared

COUNT = 24
SPEEDS = 100
SMALL = 1e-3  # of the imperfections: to first order alone
N = 5  # nodal diameters of the pair of the second and third table
RARE = 1e-5
LOT = 4096  # casings drawn at once


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the tables."""
    casing = cf.load_study(DATA / "studies" / "mistuning.toml").structure
    assert isinstance(casing, cf.Shell)
    family = [full_row(casing, 1 if quick else 500), time_row(casing, 256 if quick else 100_000)]
    speeds, summary = speed_rows(out, quick)
    own = Linear(casing)
    linear = linear_rows(own, 512 if quick else 16_384)
    repeated = repeated_rows(own, 4 if quick else 200, 1 if quick else 50)
    write(out / "chance_speeds.csv", speeds)
    for title, name, rows in (
        ("Splits and orientations of the family", "chance_family", columned(family)),
        ("Probability of a dangerous speed", "chance_dangerous", [summary]),
        ("Quantiles of a split that is linear in the imperfection", "chance_quantiles", linear),
        ("Intervals and a rare event", "chance_repeated", columned(repeated)),
    ):
        show(title, rows)
        write(out / f"{name}.csv", rows)
    return [*family, summary, *linear, *repeated]


def columned(rows: list[Row]) -> list[Row]:
    """Rows with the columns of all."""
    names = dict.fromkeys(name for row in rows for name in row)
    return [{name: row.get(name) for name in names} for row in rows]


def verdict(good: bool) -> str:
    """The word for a row."""
    return "pass" if good else "FAIL"


# --- the family -----------------------------------------------------------------------------------------------


def full_row(casing: cf.Shell, full: int) -> Row:
    """Differences to full solutions; 99 % of the splits and orientations have to be within 2 %."""
    pairs = map_of(casing)
    found = [differences(pairs, casing, draw) for draw in range(full)]
    split, angle, largest, mixed = (np.concatenate([each[k] for each in found]) for k in range(4))
    clear = ~mixed.astype(bool)
    within, turned = float(np.mean(split[clear] <= 0.02)), float(np.mean(angle[clear] <= 0.02))
    return {
        "against": "full solutions", "casings": full, "pairs": len(split), "mixed": int(mixed.sum()),
        "split: median %": 100.0 * float(np.median(split[clear])),
        "99 % of pairs %": 100.0 * float(np.quantile(split[clear], 0.99)),
        "within 2 %": within,
        "mixed pairs too, within 2 %": float(np.mean(split <= 0.02)),
        "of the largest split, within 2 %": float(np.mean(largest <= 0.02)),
        "orientation within 2 % of its period": turned,
        "mixed pairs too, orientation": float(np.mean(angle <= 0.02)),
        "verdict": verdict(min(within, turned) >= 0.99),
    }  # fmt: skip


def time_row(casing: cf.Shell, many: int) -> Row:
    """The time of many casings, with those that are solved in full; 60 s of a core are allowed for 100,000."""
    own = Casings.of(casing, cf.Rim("top"), COUNT, 0.0)
    began, wall, by = time.process_time(), time.perf_counter(), np.zeros(2, dtype=int)
    for first in range(0, many, LOT):
        lot = range(first, min(first + LOT, many))
        series = own.random.series(cf.chance.points(7, lot, own.random.dimension))
        by += np.bincount(replaced(own, series, own.pairs.splits(series)).by, minlength=2)
    spent = time.process_time() - began
    return {
        "against": "time", "casings": many, "pairs": many * len(own.pairs.n),
        "in full": int(by[IN_FULL]),
        "processor ms a casing": 1e3 * spent / many,
        "processor s": spent,
        "seconds": time.perf_counter() - wall,
        "verdict": verdict(spent <= 60.0),
    }  # fmt: skip


def map_of(casing: cf.Shell) -> Any:
    """The map of the casing's pairs."""
    found = cf.modal.SplitMap.of(casing, COUNT)
    assert found is not None
    return found


def differences(pairs: Any, casing: cf.Shell, draw: int) -> tuple[FloatArray, ...]:
    """Of each pair of a draw: relative error of the split, of the angle by its period, of the largest split; mixed."""
    shell = redrawn_shell(casing, draw)
    found = pairs.splits(pairs.series([dict(shell.defects)]))
    truth = cf.modes(shell, COUNT, method="shell")
    rows = []
    for (low, _), split in zip(truth.doublets, truth.splits, strict=True):
        j = np.flatnonzero((pairs.n == truth.nodal_diameters[low]) & (pairs.rank == truth.meridional[low]))
        if len(j):
            k, period = int(j[0]), 180.0 / int(truth.nodal_diameters[low])
            turned = abs((found.angle_deg[0, k] - truth.angle_deg[low] + 0.5 * period) % period - 0.5 * period)
            off = abs(found.split[0, k] - split)
            rows.append((off / split, turned / period, off / truth.splits.max(), float(found.share[0, k] < PURE)))
    return tuple(np.array(part) for part in zip(*rows, strict=True))


# --- dangerous speeds -----------------------------------------------------------------------------------------


def speed_rows(out: Path, quick: bool) -> tuple[list[Row], Row]:
    """Probability of each speed with its interval; a summary of them."""
    folder, draws = (out / "chance_scene").resolve(), 64 if quick else 2_048
    shutil.rmtree(folder, ignore_errors=True)
    prepared(folder, draws, quick)
    scene = folder / "scene.toml"
    scene.write_text(scene.read_text(encoding="utf-8").replace("steps = 83", f"steps = {SPEEDS}"), encoding="utf-8")
    own = Drawing.of(load_chance(scene))
    began = time.process_time()
    lot = own.lot(cf.chance.points(own.given.table.seed, range(draws), own.dimension))
    spent, hit = time.process_time() - began, dangerous(lot, own.floor)
    found = [cf.chance.probability(column) for column in hit.T]
    rows: list[Row] = [
        {"speed [Hz]": float(hz), "probability": one.value, "low": one.low, "high": one.high}
        for hz, one in zip(own.given.speed_hz, found, strict=True)
    ]
    some, most = cf.chance.probability(hit.any(axis=1)), int(np.argmax([one.value for one in found]))
    summary: Row = {
        "speeds": len(rows), "casings": draws, "some speed": some.value, "low": some.low, "high": some.high,
        "most likely [Hz]": float(own.given.speed_hz[most]), "its probability": found[most].value,
        "its low": found[most].low, "its high": found[most].high, "processor ms a casing": 1e3 * spent / draws,
    }  # fmt: skip
    return rows, summary


# --- a distribution that is known -----------------------------------------------------------------------------


class Linear:
    """The split of one pair, of casings with a thousandth of the imperfection of the radius alone."""

    def __init__(self, casing: cf.Shell) -> None:
        radius = casing.defects["radius"]
        assert isinstance(radius, RandomField)
        small = replace(radius, spectrum=radius.spectrum.scaled(SMALL))
        self.casing = replace(casing, radius_defect=small, thickness_defect=None)
        self.series = RandomSeries.of(self.casing)
        self.pairs = map_of(self.casing)
        self.place = int(np.flatnonzero((self.pairs.n == N) & (self.pairs.rank == 1))[0])
        self.spectrum, self.dimension = small.spectrum, self.series.dimension
        self.line = int(np.flatnonzero(self.spectrum.p == 2 * N)[0])
        self.slope = float(self.splits(np.full((1, self.dimension), 0.5))[0] / self.spectrum.median[self.line])

    def splits(self, u: FloatArray) -> FloatArray:
        """Splits of points in the unit cube, (points,)."""
        return np.asarray(self.pairs.splits(self.series.series(u)).split[:, self.place])

    def quantile(self, at: float) -> float:
        """What first-order theory gives."""
        return self.slope * float(self.spectrum.amplitudes(np.full(len(self.spectrum.p), at))[self.line])


def linear_rows(own: Linear, draws: int) -> list[Row]:
    """Quantiles of the draws against those of the amplitude."""
    splits = own.splits(cf.chance.points(11, range(draws), own.dimension))
    rows = []
    for at in (0.05, 0.5, 0.9, 0.99):
        found, exact = cf.chance.quantile(splits, at), own.quantile(at)
        allowed = 100.0 * max(found.high / exact - 1.0, 1.0 - found.low / exact)
        rows.append(check(f"{100 * at:g} % quantile, {draws} draws", "first order", exact, found.value, allowed))
    return rows


def repeated_rows(own: Linear, repetitions: int, rare: int) -> list[Row]:
    """How often intervals contain the true probability; an event of 1e-5 by subset simulation."""
    rows: list[Row] = []
    levels = {
        **{f"interval of a probability of {1.0 - at:.2g}": np.full(repetitions, at) for at in (0.52, 0.9, 0.98)},
        "interval of another probability each time": np.random.default_rng(1).uniform(0.02, 0.98, repetitions),
    }
    splits = [own.splits(cf.chance.points(seed, range(512), own.dimension)) for seed in range(repetitions)]
    for what, ats in levels.items():
        inside = 0
        for at, part in zip(ats.tolist(), splits, strict=True):
            found = cf.chance.probability(part > own.quantile(at))
            inside += found.low <= 1.0 - at <= found.high
        share = inside / repetitions
        rows.append({
            "what": what, "repetitions": repetitions, "has the truth": share,
            "verdict": verdict(0.93 <= share <= 0.97) if repetitions >= 200 else "too few",
        })  # fmt: skip
    limit = own.quantile(1.0 - RARE)

    def response(x: FloatArray) -> FloatArray:
        return own.splits(np.clip(ndtr(x), 1e-300, 1.0 - 2.0**-53))

    events = [cf.chance.subset_simulation(response, own.dimension, limit, seed=seed) for seed in range(rare)]
    chances = np.array([each.probability for each in events]) / RARE
    near = float(np.mean(np.abs(chances - 1.0) <= 0.2))
    rows.append({
        "what": f"subset simulation of {RARE:g}", "repetitions": rare, "mean over truth": float(chances.mean()),
        "variation": float(chances.std()), "its own estimate": float(np.mean([each.variation for each in events])),
        "subsets alone": float(np.std([each.subset for each in events]) / RARE),
        "within 20 %": near, "runs": float(np.mean([each.runs for each in events])),
        "verdict": verdict(near >= 0.95),
    })  # fmt: skip
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
