"""Imported meshes against references: bricks, twisted solids, a shell of quadrilaterals."""

import warnings

import numpy as np

from casingfem.modal.modes import modes
from reports.tables import Row, check
from reports.verification.modes.frustum import exact_frequencies
from reports.verification.modes.imported import (
    axisymmetric,
    plate_factors,
    reference,
    skin,
    thick_cylinder,
    thick_plate,
    twisted,
)


def rows(quick: bool) -> list[Row]:
    """Rows of the verification; --quick leaves out the twisted solids and the frustum."""
    nafems = reference("nafems_free_vibration.csv").set_index(["case", "mode"])
    found = modes(thick_plate("hexahedron20", (4, 4, 1)), 10).freq
    case = "A5 FV52 thick plate, 4 x 4 x 1 bricks, held along the lower edges, mode"
    table = [
        check(f"{case} {k}", "NAFEMS", float(nafems.loc[("FV52", k), "frequency_hz"]), float(found[place]), 0.12)
        for k, place in (("4", 3), ("5-6", 4), ("7", 6), ("8", 7), ("9-10", 8))
    ]
    with warnings.catch_warnings():  # coarse around on purpose: only n = 0 is wanted, which does not bend the cells
        warnings.filterwarnings("ignore", ".*mesh-thin-curved")
        values = axisymmetric(modes(thick_cylinder("hexahedron27", (1, 12, 12)), band=(200.0, 410.0)))
    for k, value in enumerate(values[:5].tolist(), 2):
        exact = float(nafems.loc[("FV41", str(k)), "check_hz"])
        table.append(
            check(f"A5 FV41 free thick cylinder, 27-node bricks, mode {k}", "3-D, Fourier", exact, value, 0.12)
        )
    return table if quick else [*table, *slow_rows()]


def slow_rows() -> list[Row]:
    """The worst mode of twisted cantilevers, thick and thin, and of the frustum's forty."""
    table, result = reference("twisted_plate_3d.csv"), []
    # thin ones too: where the twist is large, a shell with walls along its normal is another body than the reference
    for thin, twist, division in ((5, 0, (8, 8, 2)), (5, 60, (8, 8, 2)), *((20, t, (20, 20, 1)) for t in (30, 45, 60))):
        part = table[(table.a_over_b == 1) & (table.b_over_h == thin) & (table.twist_deg == twist)]
        exact = part["lambda"].to_numpy()
        values = plate_factors(modes(twisted("hexahedron27", division, float(thin), twist), len(exact)), float(thin))
        k = int(np.abs(values / exact - 1.0).argmax())
        case = f"A4 solid of 27-node bricks, a/b 1, b/h {thin}, {twist} deg, worst of {len(exact)}: mode {k + 1}"
        result.append(check(case, "3-D, spectral", float(exact[k]), float(values[k]), 0.5))
    exact = exact_frequencies()
    values = modes(skin("quad9", (121, 16)), 40).freq
    k = int(np.abs(values / exact - 1.0).argmax())
    case = f"A0 frustum on 121 x 16 quadrilaterals of nine nodes, worst of 40: mode {k + 1}"
    reason = "seven quadratic cells a wave at n = 16"
    return [*result, check(case, "3-D elasticity", float(exact[k]), float(values[k]), 0.1, gap=0.15, reason=reason)]
