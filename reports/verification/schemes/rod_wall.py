"""A bar thrown at a rigid wall: Newmark's pairs, explicit Lagrange and penalty, by mesh.

`python -m reports.verification.schemes.rod_wall [--quick] [--out DIR]` prints and writes rod_wall.csv: force errors,
peak and energy for four meshes, and the rate at which the force error falls with the mesh (positive: it converges).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import contact as ct
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import Method, errors, rod_wall_case, run

PAIRS = ((0.25, 0.5), (0.25, 0.55), (0.25, 0.6), (0.5, 0.5), (0.5, 0.55), (0.5, 0.6))


def compared() -> list[Method]:
    """Newmark's pairs, then the schemes with which they are compared."""
    newmark = [Method(name=f"Newmark ({b:g}, {c:g})", scheme=ct.scheme.Newmark(beta=b, gamma=c)) for b, c in PAIRS]
    return [
        *newmark,
        Method(name="forward Lagrange", scheme=ct.CentralDifference()),
        Method(name="massless boundary", scheme=ct.scheme.MasslessBoundary()),
        Method(name="explicit penalty 1e4", scheme=ct.scheme.PenaltyDifference(), law=ct.Penalty(stiffness=1e4)),
    ]


def rate(sizes: list[int], found: list[float]) -> float:
    """Slope at which an error falls with the number of elements, by least squares of logarithms."""
    return -float(np.polyfit(np.log(sizes), np.log(found), 1)[0])


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    case, rows = rod_wall_case(), []
    sizes = [20, 50] if quick else [20, 50, 100, 200]
    for method in compared():
        found = {n: errors(case, run(case, method, n, 0.5)) for n in sizes}
        last = found[sizes[-1]]
        row: Row = {"method": method.name}
        row |= {f"L1, {n} elements": found[n]["force L1"] for n in sizes}
        row |= {"rate": rate(sizes, [float(str(found[n]["force L1"])) for n in sizes])}
        rows.append(row | {name: last[name] for name in ("force L2", "windowed L1", "peak/exact", "impulse", "energy")})
    show("Rod on a wall, Courant .5: force L1 by mesh and its rate; the other columns for the finest mesh", rows)
    write(out / "rod_wall.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
