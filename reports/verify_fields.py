"""Fields against what is known of them: a measured bowl's splits, and pairs that two harmonics split together.

The slopes of thin rings, forbidden splits and turned fields stand in `reports.splitting`.
"""

from dataclasses import replace

import numpy as np
import pandas as pd

from casingfem.experiment.measurement import FrequencyTable
from casingfem.modal.modes import modes
from casingfem.structure.chart import Cylinder
from casingfem.structure.field import FourierField
from casingfem.structure.shell import Shell
from reports.frustum_convergence import reference_frustum
from reports.splitting import DOUBLE, ODD, RING, SLOPES, STEEL, in_plane
from reports.tables import DATA, Row, check

SOURCE = "measured, prayer bowl"
WAVES = (10, 4)  # of modulus and density: together they split 2n = 10 +- 4, alone neither
PARTED = (7, 3)


def bowl() -> pd.DataFrame:
    """The doublets of the bowl that were measured as two."""
    table = pd.read_csv(DATA / "reference" / "prayer_bowl.csv", comment="#")
    return table[table.ratio_2.notna()]


def published_splits() -> list[Row]:
    """A7: the splits that a frequency table finds in the bowl's ratios."""
    table = bowl()
    n, freq = np.repeat(table.n.to_numpy(), 2), table[["ratio_1", "ratio_2"]].to_numpy().ravel()
    found = FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq, n=n).splits()
    percent = {2: 0.78, 3: 0.47, 4: 0.0, 5: 0.19, 6: 0.20}  # as published, two digits
    return [check(f"A7 bowl, n = {k}: split [%]", SOURCE, percent[k], 100.0 * found[k], 1.5) for k in percent]


def ring_like_the_bowl() -> list[Row]:
    """A7: a thin ring whose wall holds 2n waves, each as large as the bowl's split over the theory's slope."""
    table = bowl().set_index("n").split_rel
    waves = {2 * int(n): float(split) / SLOPES["thickness"](int(n)) for n, split in table.items()}
    ring = Shell(
        chart=Cylinder(radius=1.0, height=0.02), thickness=0.01, material=STEEL, mesh=RING,
        thickness_defect=FourierField.of(waves),
    )  # fmt: skip
    found = modes(ring, 30)
    rows = []
    for n, split in table.items():
        cosine, sine = in_plane(found, int(n))
        measured = abs(cosine - sine) / (0.5 * (cosine + sine))
        case = f"A7 ring with the bowl's splits in its wall, n = {n}"
        reason = "first-order slopes: 4 and 6 waves together split n = 5 at second order"
        gap = 3.0 if n == 5 else 0.0
        rows.append(check(case, SOURCE, float(split), measured, 2.0 if split else 0.01, gap=gap, reason=reason))
    return rows


def split_of(n: int, modulus: float, density: float) -> float:
    """Split of the lowest doublet of n on the frustum with WAVES in its modulus and its density."""
    fields = {
        "modulus_defect": FourierField.of({WAVES[0]: modulus}),
        "density_defect": FourierField.of({WAVES[1]: density}),
    }
    found = modes(replace(reference_frustum(ODD), **fields), 28)
    lows = found.nodal_diameters[[low for low, _ in found.doublets]]
    return float(found.splits[np.flatnonzero(lows == n)[0]])


def second_order(n: int) -> list[Row]:
    """Two harmonics split 2n = p1 +- p2 by their product: not at all alone, linearly in each."""
    p, q = WAVES
    alone = max(split_of(n, 0.04, 0.0), split_of(n, 0.0, 0.04))
    both, half = split_of(n, 0.04, 0.04), split_of(n, 0.02, 0.04)
    sign = "+" if 2 * n == p + q else "-"
    rule = f"rule: 2n = {p} {sign} {q}, second order"
    return [
        check(
            f"modulus {p} waves or density {q} waves alone, n = {n} (both: {100 * both:.2g} %)",
            rule,
            0.0,
            alone,
            DOUBLE,
        ),
        check(f"both, n = {n}: order in one of them", rule, 1.0, float(np.log2(both / half)), 1.0),
    ]


def rows(quick: bool) -> list[Row]:
    """All rows; the quick ones leave out what takes seconds."""
    found = published_splits()
    if not quick:
        found += ring_like_the_bowl() + [row for n in PARTED for row in second_order(n)]
    return found
