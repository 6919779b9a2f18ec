"""What accuracy costs: every scheme on every scene with an exact solution, over meshes.

`python -m reports.benchmarks.work_precision [--quick] [--out DIR]` prints and writes work_precision.csv and draws
work_precision.png, force errors against run time. Courant .5 throughout, so that steps grow with the mesh; penalty
springs are as stiff as one element. Run times are of the step loop that stores one step in 1000, best of two.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import contact as ct
from casingfem.plot.style import png
from contact.io.outfiles import write_atomic
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import Case, cases, errors, methods, run, spring

SIZES = (25, 50, 100, 200)
SHOWN = ("force L1", "force L2", "impulse", "gap", "energy", "unaccounted", "us/step")


def measured(case: Case, elements: int) -> list[Row]:
    """One row a method, with the seconds of the faster of two runs."""
    rows: list[Row] = []
    for method in methods(spring(case, elements)):
        row: Row = {"scene": case.name, "method": method.name, "elements": elements}
        try:
            found = errors(case, run(case, method, elements, 0.5))
            seconds = min(run(case, method, elements, 0.5, every=1000).seconds for _ in range(2))
        except ct.InputError as error:
            rows.append({**row, "note": str(error).split(",")[0]})
            continue
        found["us/step"] = 1e6 * seconds / int(str(found["steps"]))
        rows.append({**row, "steps": found["steps"], "seconds": seconds} | {name: found[name] for name in SHOWN})
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the finest mesh of each scene, write all, draw the picture."""
    sizes = SIZES[:1] if quick else SIZES
    chosen = cases()[:2] if quick else cases()
    rows = [row for case in chosen for n in sizes for row in measured(case, n)]
    columns = ["scene", "method", "elements", "steps", "seconds", *SHOWN, "note"]
    rows = [{name: row.get(name) for name in columns} for row in rows]
    for case in chosen:
        table = [row for row in rows if row["scene"] == case.name and row["elements"] == sizes[-1]]
        show(
            f"{case.name}: relative errors; energy over that of the motion",
            [dict(list(row.items())[1:]) for row in table],
        )
    write(out / "work_precision.csv", rows)
    picture(rows, [case.name for case in chosen], out / "work_precision.png")
    return rows


def picture(rows: list[Row], scenes: list[str], path: Path) -> None:
    """Force L1 against seconds, one panel a scene."""
    figure, axes = plt.subplots(
        -(-len(scenes) // 2), 2, figsize=(9.0, 3.0 * -(-len(scenes) // 2)), layout="constrained"
    )
    for axis, scene in zip(np.ravel(axes), scenes, strict=False):
        for name in dict.fromkeys(row["method"] for row in rows):
            line = [row for row in rows if row["scene"] == scene and row["method"] == name and row["seconds"]]
            axis.loglog([row["seconds"] for row in line], [row["force L1"] for row in line], "o-", ms=3, label=name)
        axis.set(title=scene, xlabel="seconds", ylabel="force L1 error")
    np.ravel(axes)[0].legend(fontsize=5, ncols=2)
    write_atomic(path, png(figure))
    plt.close(figure)


if __name__ == "__main__":
    command_line(__doc__, main)
