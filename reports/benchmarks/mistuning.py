"""Draws near a perfect casing against their full solutions: remaining error, and time.

`python -m reports.benchmarks.mistuning [--quick] [--out DIR]`. The casing of data/studies/mistuning.toml with its
random radius and wall, 24 modes, at several sizes of the imperfections. Errors are those of draws that count as near,
against the full solution on the default mesh: of a frequency the worst, of a split its 99 % quantile relative to the
split itself. "bound" is the largest estimated error. Times are processor seconds for one draw.
"""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.modal.family.splits import Near
from casingfem.modal.mistuning import LIMIT, chunks_of, drawn_fields, pairs_map, pairs_of, redrawn_shell
from casingfem.structure.shell.shell import Shell
from reports.tables import ROOT, Row, command_line, show, write

SIZES = (0.35, 0.7, 1.4)  # of the example spectrum: the study's own, twice and four times as large


def casing(size: float) -> Shell:
    """The study's casing with radius defects of another size."""
    shell = cf.load_study(ROOT / "data" / "studies" / "mistuning.toml").shell
    field = cf.field.RandomField.example(thickness=3e-3, radius=0.475, seed=7, scale=size, p_max=24)
    return replace(shell, radius_defect=field)


def row_of(size: float, draws: int, count: int) -> Row:
    """One size: the number of draws that count as near, their errors and times."""
    shell = casing(size)
    started = time.process_time()
    pairs = pairs_map(shell, count)
    made = time.process_time() - started
    assert pairs is not None
    started = time.process_time()
    found = [near for chunk in chunks_of(draws) for near in lowest_of(shell, pairs, count, chunk)]
    seconds = time.process_time() - started
    freq, split, bound, share = [], [], [], []
    started = time.process_time()
    exact = [cf.modes(redrawn_shell(shell, draw), count, method="shell") for draw in range(draws)]
    full = time.process_time() - started
    for draw, (near, whole) in enumerate(zip(found, exact, strict=True)):
        error = np.abs(near.modes.freq / whole.freq - 1.0).max()
        if near.complete:
            share.append(error / near.estimate)
        if not near.complete or near.estimate > LIMIT:
            continue
        bound.append(near.estimate)
        freq.append(error)
        mine, theirs = ({(p.n, p.m): p.split_rel for p in pairs_of(each, draw)} for each in (near.modes, whole))
        split += [abs(mine[key] / theirs[key] - 1.0) for key in mine.keys() & theirs.keys()]
    return {
        "size": size,
        "draws": draws,
        "near": len(freq),
        "worst frequency": max(freq, default=np.nan),
        "bound": max(bound, default=np.nan),
        "error/estimate, all draws": max(share, default=np.nan),
        "split, 99 %": float(np.quantile(split, 0.99)) if split else np.nan,
        "map [s]": made,
        "near [ms]": 1e3 * seconds / draws,
        "in full [ms]": 1e3 * full / draws,
        "near/full": seconds / full,
    }


def lowest_of(shell: Shell, pairs: cf.modal.SplitMap, count: int, draws: range) -> list[Near]:
    """The lowest modes of some draws by the map."""
    return pairs.near(pairs.series([drawn_fields(shell, draw) for draw in draws]), count)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the rows and write them."""
    rows = [row_of(size, 3 if quick else 50, 12 if quick else 24) for size in (SIZES[:1] if quick else SIZES)]
    show("Draws near the perfect casing", rows)
    write(out / "mistuning.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
