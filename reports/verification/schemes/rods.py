"""Two identical rods: contact force and displacement by Lagrange multipliers and by penalty, and the exact solution.

`python -m reports.verification.schemes.rods [--quick] [--out DIR]` prints the table, writes rods.csv and draws
rods.png. The scene is the classical one (Carpenter, Taylor, Katona 1991); the penalty has several parameters, with the
best one among them.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

import contact as ct
from casingfem.plot.style import png
from contact.io.outfiles import write_atomic
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import Case, Method, errors, run, two_rods_case

PENALTIES = (2e7, 2e8, 2e9, 2e10)  # N/m
PICTURED = ("forward Lagrange", "massless boundary", "penalty 2e+08", "penalty 2e+09")


def lagrange() -> list[Method]:
    """Schemes with multipliers among which a user would choose."""
    return [
        Method(name="forward Lagrange", scheme=ct.CentralDifference()),
        Method(name="massless boundary", scheme=ct.scheme.MasslessBoundary()),
        Method(name="Moreau-Jean", scheme=ct.MoreauJean()),
        Method(name="Newmark (.5, .55)", scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55)),
    ]


def soft(stiffness: float) -> Method:
    """Penalty of this stiffness: explicit."""
    return Method(
        name=f"penalty {stiffness:.0e}", scheme=ct.scheme.PenaltyDifference(), law=ct.Penalty(stiffness=stiffness)
    )


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table, write it, draw the picture."""
    case, rows, drawn = two_rods_case(), [], {}
    for elements in (20,) if quick else (20, 100):
        for method in [*lagrange(), *map(soft, PENALTIES)]:
            for courant in (0.5,) if quick else (0.9, 0.5, 0.1):
                row: Row = {"method": method.name, "elements": elements, "courant": courant}
                try:
                    result = run(case, method, elements, courant)
                except ct.LimitError as error:
                    rows.append({**row, "note": str(error).split(": ")[-1]})
                    continue
                drawn[method.name] = result
                found = errors(case, result)
                rows.append({**row, **found, "penetration": float(result.max_penetration[0]), "note": ""})
    columns = list(rows[0])
    show("Two rods: relative errors; peak over the exact force; energy over that of the motion", rows)
    write(out / "rods.csv", [{name: row.get(name) for name in columns} for row in rows])
    picture(case, drawn, out / "rods.png")
    return rows


def picture(case: Case, drawn: dict[str, ct.Result], path: Path) -> None:
    """Force and end displacement over time, each with the exact one."""
    figure, axes = plt.subplots(2, 1, sharex=True, figsize=(7.0, 6.0), layout="constrained")
    exact = drawn["forward Lagrange"].time
    for name in PICTURED:
        result = drawn[name]
        last = result.blocks[0][2] - 1
        axes[0].plot(1e6 * result.time, result.force[:, 0] / case.plateau, lw=0.9, label=name)
        axes[1].plot(1e6 * result.state_time, result.state[:, last], lw=0.9, label=name)
    axes[0].plot(1e6 * exact, case.force(exact) / case.plateau, "k--", lw=1.2, label="exact")
    axes[0].set(ylabel="force / exact force", ylim=(-0.1, 2.2))
    axes[1].set(ylabel="end of the first rod [m]", xlabel="time [µs]")
    axes[0].legend(fontsize=8)
    write_atomic(path, png(figure))
    plt.close(figure)


if __name__ == "__main__":
    command_line(__doc__, main)
