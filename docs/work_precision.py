"""The page of error against run time: `.venv/bin/python docs/work_precision.py` writes docs/work_precision.md."""

import csv
from pathlib import Path

HERE = Path(__file__).parent
PAGE, TABLE = HERE / "work_precision.md", HERE / "work_precision_winners.csv"
HEAD = """# Error against run time

Made by `.venv/bin/python docs/work_precision.py` from [a table](work_precision_winners.csv) that `python -m
reports.benchmarks.work_precision` computes. Six impacts of rods and masses have exact solutions. The rub is the blade
of NASA rotor 37 before a steel cylinder for two turns, eight touches. Its errors are against an eighth of the shortest
step. A ball with a coefficient of restitution has seven impacts in 7 s and a closed form. A cantilever of five modes
meets its stop about ten times in 0.05 s; its errors are against the passage of the limit cycles.

Every method runs on meshes of 25, 50, 100 and 200 elements a rod at Courant 0.5, and on 100 elements at Courant 0.1,
0.25 and 0.9. Exact modal steps and event-driven runs have as many modes as a rod has elements. In the last three scenes
the column "courant" has the step [s]. Run time is that of the step loop on one core,
the least of 4 to 24 runs; 15 other processes shared the machine. The rub was timed on another day, with less load.

## Which method is quickest within an error

A dash means that no run is accurate enough. The error of the force is its L1 norm, that of the gap the error of the
position at the end of the run over the height of the fall or the clearance.
"""
TAIL = """
## Conclusions

- A single impact of rods: take exact modal steps with the forward law. The energy law has the best impulse, but its
  force rings.
- Repeated impacts of a bar: no method has the force within 3 % over six impacts, because the error of a rebound shifts
  the next one. The massless boundary and exact modal steps reach 10 %.
- Repeated impacts of a few modes, or of a mass with a coefficient of restitution: to 1 % take time steps. For 0.01 %
  or less take event-driven runs. Their error is that of double precision, and no step of the other methods reaches it.
- Event-driven runs of rods: the force rings, because the massless end vibrates on the residual compliance and no step
  damps it. Its L1 error is 15 to 83 %. The impulse converges as the number of modes grows.
- Rods of unequal length: CD-Lagrange and Paoli-Schatzman on elements reach 3 % before modes do.
- A rub: take the rigid contact with exact modal steps. A spring of 1e9 N/m costs more.
- An error of the impulse may change its sign between two meshes or steps. A small error is then a coincidence.

Periodic motions have a comparison of their own: [shooting and harmonic balance](cycles.md).

## Pictures

A mark is a method. Solid lines go over meshes, dotted lines over steps. The grey line is the least error within a run
time.
"""


def cell(text: str) -> str:
    """A value of the table: three digits of a number, a dash of none."""
    try:
        return f"{float(text):.3g}"
    except ValueError:
        return text or "-"


def page() -> str:
    """The page as text."""
    with TABLE.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    lines = [HEAD, "| " + " | ".join(rows[0]) + " |", "|" + "---|" * len(rows[0])]
    lines += ["| " + " | ".join(cell(value) for value in row.values()) + " |" for row in rows]
    names = [f"screens/work_precision_{scene.partition(',')[0].replace(' ', '_')}.png" for scene in scenes]
    shown = [f"\n![{scene}: error against run time]({name})" for scene, name in zip(scenes, names, strict=True)]
    return "\n".join([*lines, TAIL.rstrip(), *shown]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
