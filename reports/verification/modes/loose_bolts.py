"""Two loose bolts of 24.

Modes and purities, converged frequencies, and the effect of meshes that do not follow the bolts.

`python -m reports.verification.modes.loose_bolts [--quick] [--out DIR]`. The casing: frustum R .50 -> .45 m, height .25
m, 3 mm steel, 24 bolts of 2e8 N/m and 1e3 N m/rad at its base, bolt 3 at 30 % and bolt 7 missing.

loose_bolts.csv: the first modes of the tight and the loose casing, n, purity and split. loose_bolts_mesh.csv: the
frequencies of the loose casing on meshes that follow the bolts, against coupled harmonics. bolt_meshes.csv: on meshes
that do not, the largest split that the mesh alone makes, computed with equal bolts, and the estimate of the warning.
bolt_defaults.csv: the default mesh with other bolts, one of them loose, against coupled harmonics.
"""

import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.errors import ModelWarning
from casingfem.modal.modes import Modes, modes
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.variation import springs_per_wave, spurious_split
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import reference_frustum

TIGHT = Bolts(count=24, k=2e8, k_rot=1e3)
LOOSE = replace(TIGHT, loose={3: 0.3, 7: 0.0})
ROWS = (0.0, 0.03, 0.97, 1.0)  # a layer at the bolted base and at the free top
FINE = ShellMesh(order=8, rows=(0.0, 0.02, 0.1, 0.4, 0.97, 1.0), around=48)
MESHES = (  # order, rows, around
    ShellMesh(order=5, rows=1, around=24),
    ShellMesh(order=7, rows=1, around=24),
    ShellMesh(order=6, rows=ROWS, around=24),
    ShellMesh(order=7, rows=ROWS, around=24),
    ShellMesh(order=9, rows=ROWS, around=24),
    ShellMesh(order=6, rows=ROWS, around=48),
)
ASTRAY = (  # bolts, elements around, order, width of a patch [deg]
    (24, 21, 7, 5.0), (24, 21, 8, 5.0), (24, 25, 7, 5.0), (24, 30, 5, 5.0), (24, 40, 5, 5.0), (24, 21, 7, 11.5),
    (24, 21, 7, 2.9), (24, 31, 7, 8.6), (16, 24, 7, 7.5), (12, 21, 7, 10.0), (12, 21, 7, 17.2), (8, 21, 7, 15.0),
)  # fmt: skip
OTHERS = tuple(  # bolts, k [N/m], k_rot [N m/rad]
    (count, k, k_rot) for k, k_rot in ((2e8, 1e3), (2e9, 1e4)) for count in (8, 12, 24, 48, 100)
)


def bolted(bolts: Bolts, mesh: ShellMesh | None) -> Shell:
    """The casing on bolts; the mesh need not follow them, since its effect is the subject of a table."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        return replace(reference_frustum(), supports={"base": bolts}, mesh=mesh)


def side_by_side(tight: Modes, loose: Modes) -> list[Row]:
    """The modes of both casings, in order."""
    return [
        {
            "mode": k + 1,
            "tight Hz": float(tight.freq[k]),
            "n": int(tight.nodal_diameters[k]),
            "loose Hz": float(loose.freq[k]),
            "shift %": 100.0 * float(loose.freq[k] / tight.freq[k] - 1.0),
            "n loose": int(loose.nodal_diameters[k]),
            "purity": float(loose.purity[k]),
            "split %": 100.0 * float(loose.splits[pair]) if (pair := loose.doublet_of(k)) >= 0 else None,
        }
        for k in range(len(loose))
    ]


def settled(meshes: tuple[ShellMesh, ...], count: int) -> list[Row]:
    """Each mesh against coupled harmonics: worst and RMS relative difference over the first modes."""
    best = modes(bolted(LOOSE, None), count, method="bolts")
    rows: list[Row] = []
    for mesh in meshes:
        started = time.perf_counter()
        found = modes(bolted(LOOSE, mesh), count, method="shell")
        error = found.freq / best.freq - 1.0
        rows.append(
            {
                "order": mesh.order,
                "rows": len(mesh.breaks) - 1,
                "around": mesh.around,
                "unknowns": found.dofs,
                "f1 Hz": float(found.freq[0]),
                f"f{count} Hz": float(found.freq[-1]),
                "worst": float(np.abs(error).max()),
                "rms": float(np.sqrt(np.mean(error**2))),
                "same n": int(np.count_nonzero(found.nodal_diameters == best.nodal_diameters)),
                "seconds": time.perf_counter() - started,
            }
        )
    return rows


def astray(count: int, around: int, order: int, width_deg: float) -> Row:
    """The largest split, on a mesh that does not follow the bolts, of a pair that equal bolts do not split."""
    bolts = replace(TIGHT, count=count, width=float(np.radians(width_deg)))
    mesh = ShellMesh(order=order, rows=1, around=around)
    shell = bolted(bolts, mesh)
    found = modes(shell, 30, method="shell")
    n = np.array([found.nodal_diameters[low] for low, _ in found.doublets])
    computed = float(found.splits[2 * n % count != 0].max())
    steel = shell.material
    estimate = spurious_split(bolts, mesh, springs_per_wave(bolts, steel.E, steel.nu, shell.thickness))
    return {
        "bolts": count,
        "around": around,
        "order": order,
        "width deg": width_deg,
        "computed": computed,
        "estimate": estimate,
        "estimate/computed": estimate / computed,
    }


def default(count: int, k: float, k_rot: float, modes_count: int) -> Row:
    """The default mesh with bolts of which one has 30 % of its stiffness, against coupled harmonics."""
    shell = bolted(Bolts(count=count, k=k, k_rot=k_rot, loose={2: 0.3}), None)
    exact, found = (modes(shell, modes_count, method=method) for method in ("bolts", "shell"))
    return {
        "bolts": count,
        "k [N/m]": k,
        "around": shell.mesh.columns,
        "unknowns": found.dofs,
        "worst": float(np.abs(found.freq / exact.freq - 1.0).max()),
    }


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the four tables; returns the rows of the second."""
    count = 12 if quick else 24
    tight, loose = (modes(bolted(bolts, ShellMesh(order=6, rows=ROWS, around=24) if quick else None), count)
                    for bolts in (TIGHT, LOOSE))  # fmt: skip
    first = side_by_side(tight, loose)
    show("24 bolts, all tight and two loose", first)
    write(out / "loose_bolts.csv", first)
    second = settled(MESHES[:2] if quick else (*MESHES, bolted(LOOSE, None).mesh, FINE), count)
    show(f"Two loose bolts: {count} modes on meshes against coupled harmonics", second)
    write(out / "loose_bolts_mesh.csv", second)
    third = [astray(*case) for case in (ASTRAY[:2] if quick else ASTRAY)]
    show("Splits made by meshes that do not follow equal bolts", third)
    write(out / "bolt_meshes.csv", third)
    fourth = [default(*case, 40) for case in OTHERS[: 1 if quick else None]]
    show("Default meshes: 40 modes against coupled harmonics", fourth)
    write(out / "bolt_defaults.csv", fourth)
    return second


if __name__ == "__main__":
    command_line(__doc__, main)
