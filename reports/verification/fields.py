"""Fields against known results: pairs that two harmonics split together.

The slopes of thin rings, forbidden splits and turned fields are in `reports.verification.splitting`.
"""

from dataclasses import replace

import numpy as np

from casingfem.modal.modes import modes
from casingfem.structure.field.fourier import FourierField
from reports.tables import Row, check
from reports.verification.modes.frustum import reference_frustum
from reports.verification.splitting import DOUBLE, ODD

WAVES = (10, 4)  # of modulus and density: together they split 2n = 10 +- 4, alone neither
PARTED = (7, 3)


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
    allowed = 0.22 if sign == "+" else 0.64
    return [
        check(
            f"modulus {p} waves or density {q} waves alone, n = {n} (both: {100 * both:.2g} %)",
            rule,
            0.0,
            alone,
            DOUBLE,
        ),
        check(f"both, n = {n}: order in one of them", rule, 1.0, float(np.log2(both / half)), allowed),
    ]


def rows(quick: bool) -> list[Row]:
    """All rows; they take seconds, so the quick ones are none."""
    return [] if quick else [row for n in PARTED for row in second_order(n)]
