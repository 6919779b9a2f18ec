"""Error against run time of every method on every scene, over meshes and over steps.

`python -m reports.benchmarks.work_precision [--quick] [--out DIR]` prints and writes work_precision.csv (every run),
work_precision_winners.csv (the quickest method within an error) and one picture a scene. Scenes: six impacts of rods
and masses with exact solutions, a rub of NASA rotor 37 against its finest step, and repeated impacts of a ball and of a
beam. Meshes at Courant 0.5, where steps
grow with the mesh; steps on one mesh. Exact modal steps have as many modes as a rod has elements, and Courant number
omega_max dt/2. Penalty springs are as stiff as one element. Run times are of the step loop that stores one step in
1000, the least of 2 to 12 runs.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import contact as ct
from casingfem.plot.style import png
from contact.io.outfiles import write_atomic
from reports.benchmarks import work_precision_events, work_precision_rubs
from reports.benchmarks.work_precision_rubs import loop_seconds
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import Case, Method, cases, errors, methods, run, spring

SIZES = (25, 50, 100, 200)
MIDDLE, COURANT = 100, 0.5  # the mesh of the steps, the step of the meshes
COURANTS = (0.9, 0.25, 0.1)
SHOWN = ("force L1", "force L2", "impulse", "gap", "energy", "unaccounted", "us/step")
WITHIN = {"force L1": (0.1, 0.03, 0.01), "impulse": (0.03, 0.01, 0.003), "gap": (1e-2, 1e-4, 1e-6)}
MARKS = "os^v<>DdphH*PX8+x1234|_"


def every_method(case: Case, elements: int) -> list[Method]:
    """All schemes on elements, and exact modal steps and event-driven runs of as many modes."""
    modal = [
        Method(name=f"exact modal, {law}", scheme=ct.ExactModal(law=law, modes=elements, omega_h_limit=3.05))
        for law in ("forward", "averaged", "energy")
    ]  # fmt: skip
    events = Method(name="event-driven", scheme=ct.scheme.EventDriven(modes=elements))
    return [*methods(spring(case, elements)), *modal, events]


def measured(case: Case, elements: int, courant: float) -> list[Row]:
    """One row a method, with the run time of its step loop."""
    rows: list[Row] = []
    for method in every_method(case, elements):
        row: Row = {"scene": case.name, "method": method.name, "elements": elements, "courant": courant}
        try:
            found = errors(case, run(case, method, elements, courant))
            spent = loop_seconds(partial(run, case, method, elements, courant, every=1000))
        except ct.InputError as error:
            rows.append({**row, "note": str(error).split(",")[0]})
            continue
        if isinstance(method.scheme, ct.ExactModal | ct.scheme.EventDriven):
            found["gap"] = None  # its state is modal coordinates
        found["us/step"] = 1e6 * spent / int(str(found["steps"]))
        rows.append({**row, "steps": found["steps"], "seconds": spent} | {name: found[name] for name in SHOWN})
    return rows


def of_scene(case: Case, quick: bool) -> list[Row]:
    """Every method over meshes, then over steps."""
    runs = [(SIZES[0], COURANT)] if quick else [(n, COURANT) for n in SIZES] + [(MIDDLE, c) for c in COURANTS]
    return [row for elements, courant in runs for row in measured(case, elements, courant)]


def winners(rows: list[Row]) -> list[Row]:
    """The quickest run of each scene within an error, the next quickest method, and how much longer it takes."""
    result: list[Row] = []
    for scene in dict.fromkeys(str(row["scene"]) for row in rows):
        for quantity in quantities([row for row in rows if row["scene"] == scene]):
            for limit in WITHIN[quantity]:
                best: dict[str, Row] = {}
                for row in rows:
                    if row["scene"] == scene and row.get("seconds") and within(row.get(quantity), limit):
                        name = str(row["method"])
                        best[name] = min(best.get(name, row), row, key=seconds)
                first, *others = sorted(best.values(), key=seconds) or [{}]
                second = others[0] if others else {}
                result.append({
                    "scene": scene, "error of": quantity, "within %": 100.0 * limit, "quickest": first.get("method"),
                    "elements": first.get("elements"), "courant": first.get("courant"), "ms": milliseconds(first),
                    "next": second.get("method"), "next, ms": milliseconds(second),
                })  # fmt: skip
    return result


def quantities(rows: list[Row]) -> list[str]:
    """The two quantities by which the methods of a scene are compared."""
    known = [name for name in WITHIN if any(row.get(name) is not None for row in rows)]
    return [name for name in known if name != "gap" or "force L1" not in known]


def within(value: object, limit: float) -> bool:
    """Whether an error is known and small enough."""
    return value is not None and abs(float(str(value))) <= limit


def seconds(row: Row) -> float:
    """Run time of a row [s]."""
    return float(str(row["seconds"]))


def milliseconds(row: Row) -> float | None:
    """Run time of a row [ms]."""
    return 1e3 * seconds(row) if row else None


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the finest mesh of each scene and the winners, write all, draw a picture of each scene."""
    chosen = cases()[:2] if quick else cases()
    rows = [row for case in chosen for row in of_scene(case, quick)]
    rows += work_precision_rubs.rows(quick) + work_precision_events.rows(quick)
    columns = ["scene", "method", "elements", "courant", "steps", "seconds", *SHOWN, "note"]
    rows = [{name: row.get(name) for name in columns} for row in rows]
    for scene in dict.fromkeys(str(row["scene"]) for row in rows):
        part = [row for row in rows if row["scene"] == scene]
        finest = [row for row in part if row["elements"] == part[0]["elements"] or row["courant"] == COURANT]
        largest = max(int(str(row["elements"])) for row in finest)
        table = [row for row in finest if row["elements"] == largest]
        show(
            f"{scene}: relative errors; energy over that of the motion", [dict(list(row.items())[1:]) for row in table]
        )
        picture(part, scene, out / f"work_precision_{scene.partition(',')[0].replace(' ', '_')}.png")
    won = winners(rows)
    show("The quickest method within an error", won)
    write(out / "work_precision.csv", rows)
    write(out / "work_precision_winners.csv", won)
    return rows


def picture(rows: list[Row], scene: str, path: Path) -> None:
    """Two errors against seconds: lines over meshes, dotted over steps; the front is grey."""
    names = list(dict.fromkeys(str(row["method"]) for row in rows if row["seconds"]))
    shown = quantities(rows)
    least = 1e-17 if "gap" in shown else 1e-5
    size = 2.0 + 4.5 * len(shown), 4.8
    figure, axes = plt.subplots(1, len(shown), figsize=size, layout="constrained", squeeze=False)
    for axis, quantity in zip(axes[0], shown, strict=True):
        for k, name in enumerate(names):
            mine = [row for row in rows if row["method"] == name and row["seconds"]]
            style = {"marker": MARKS[k % len(MARKS)], "color": colour(k), "ms": 5, "lw": 0.9}
            label: str | None = name
            for line, kind in ((lines(mine, "elements"), "-"), (lines(mine, "courant"), ":")):
                known = [row for row in line if row[quantity] is not None]
                if known:
                    drawn = [(seconds(row), max(abs(float(str(row[quantity]))), least)) for row in known]
                    axis.plot(*zip(*sorted(drawn), strict=True), kind, label=label, **style)
                    label = None
        front(axis, rows, quantity)
        axis.set(xscale="log", yscale="log", xlabel="run time [s]", ylabel=f"error of {quantity}", ylim=(least, 3.0))
    figure.suptitle(scene)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right center", fontsize=7)
    write_atomic(path, png(figure))
    plt.close(figure)


def colour(k: int) -> tuple[float, float, float, float] | str:
    """The k-th colour: no grey, which is that of the front."""
    places = [place for place in range(20) if place not in (14, 15)]
    return plt.get_cmap("tab20")(places[k]) if k < len(places) else "black"


def lines(rows: list[Row], along: str) -> list[Row]:
    """Runs over meshes at the middle step, or over steps on the middle mesh."""
    sizes = sorted({int(str(row["elements"])) for row in rows})
    middle = MIDDLE if MIDDLE in sizes else sizes[-1]
    if along == "elements":
        return [row for row in rows if row["courant"] == COURANT]
    return [row for row in rows if row["elements"] == middle]


def front(axis: Axes, rows: list[Row], quantity: str) -> None:
    """Least error within each run time, in grey."""
    points = sorted((seconds(row), abs(float(str(row[quantity])))) for row in rows if row["seconds"] and row[quantity])
    least = np.minimum.accumulate([error for _, error in points])
    axis.step([time for time, _ in points], least, where="post", color="0.75", lw=5, zorder=0)


if __name__ == "__main__":
    command_line(__doc__, main)
