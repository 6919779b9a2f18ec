"""The picture of the architecture page: packages as boxes, imports as arrows, read from the sources.

`.venv/bin/python -m docs.architecture [CHECKOUT [PICTURE]]` writes docs/architecture.svg, or draws another checkout. A
package is above all that it imports. Arrows that follow from others are left out; the width of an arrow grows with the
number of modules that import. An arrow within a circle of packages is red.
"""

import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from reports.tools.structure import Structure, circles

ROOT = Path(__file__).parents[1]
COLORS = {"casingfem": "#d6e6f2", "contact": "#f3e2cf"}
CORE = "runs"  # modules at the top of contact
Arrows = Counter[tuple[str, str]]


def box_of(module: str) -> str:
    """The package that a module belongs to, by two names of its address; modules at the top of contact are one box."""
    top, *inside = module.split(".")
    return f"{top}.{inside[0] if inside and (top == 'casingfem' or len(inside) > 1) else CORE}"


def arrows_of(structure: Structure) -> Arrows:
    """How many modules of a box import from another; the ways in and the versions are left out."""
    packages = {name for name in structure.files if any(other.startswith(f"{name}.") for other in structure.files)}
    box = {
        name: box_of(f"{name}." if name in packages and name.count(".") == 1 else name)
        for name in structure.files
        if "." in name and not name.endswith(("__main__", ".version"))
    }
    found: Arrows = Counter()
    for name in box:
        for target in {box[target] for target in structure.imports[name] if target in box} - {box[name]}:
            found[box[name], target] += 1
    return found


def needed(arrows: Arrows) -> Arrows:
    """The arrows that do not follow from others: none where a longer way leads from one box to the other."""
    graph: dict[str, set[str]] = {}
    for a, b in arrows:
        graph.setdefault(a, set()).add(b)

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        waiting = [start]
        while waiting:
            new = graph.get(waiting.pop(), set()) - seen
            seen |= new
            waiting += new
        return seen

    behind = {box: reached(box) for box in graph}
    return Counter({
        (a, b): count for (a, b), count in arrows.items()
        if not any(b in behind.get(other, set()) and a not in behind.get(other, set()) for other in graph[a] - {b})
    })  # fmt: skip


def floors(arrows: Arrows) -> dict[str, int]:
    """The floor of each box: one above the highest that it imports; boxes that import each other share one."""
    boxes = sorted({box for pair in arrows for box in pair})
    graph = {box: frozenset(b for a, b in arrows if a == box) for box in boxes}
    together = {box: min(circle) for circle in circles(graph) for box in circle}
    below: dict[str, set[str]] = {}
    for a, b in arrows:
        one, other = together.get(a, a), together.get(b, b)
        below.setdefault(one, set()).update({other} - {one})
        below.setdefault(other, set())
    found: dict[str, int] = {}

    def floor(box: str) -> int:
        if box not in found:
            found[box] = 1 + max((floor(other) for other in below[box]), default=-1)
        return found[box]

    return {box: floor(together.get(box, box)) for box in boxes}


def places(level: Mapping[str, int]) -> dict[str, tuple[float, float]]:
    """Centres of the boxes: casingfem on the left, contact on the right, a row for each floor."""
    found: dict[str, tuple[float, float]] = {}
    for package, side in (("casingfem", 0.0), ("contact", 1.0)):
        rows: dict[int, list[str]] = {}
        for box in sorted(level):
            if box.startswith(package):
                rows.setdefault(level[box], []).append(box)
        for row, boxes in rows.items():
            for k, box in enumerate(boxes):
                found[box] = (side + (k + 0.5) / len(boxes) * 0.86 + 0.07, float(row))
    return found


def drawn(arrows: Arrows) -> Figure:
    """The figure: boxes by floors, arrows downwards; an arrow within a circle of boxes is red."""
    level = floors(arrows)
    at = places(level)
    figure = Figure(figsize=(10.0, 7.5), layout="constrained")
    axes = figure.add_subplot()
    patches = {}
    for box, (x, y) in at.items():
        package, name = box.split(".")
        style = {"boxstyle": "round,pad=0.35", "facecolor": COLORS[package], "edgecolor": "#34495e", "linewidth": 0.7}
        text = axes.text(x, y, name, ha="center", va="center", fontsize=9, bbox=style, zorder=3)
        patches[box] = text.get_bbox_patch()
    for (a, b), count in sorted(needed(arrows).items()):
        color = "#c0392b" if level[a] <= level[b] else "#5d6d7e"
        arrow = {"arrowstyle": "-|>", "color": color, "linewidth": 0.6 + 0.06 * count, "shrinkA": 2, "shrinkB": 2}
        axes.annotate("", xy=at[b], xytext=at[a], arrowprops=arrow | {"patchA": patches[a], "patchB": patches[b]})
    top = max(level.values()) + 0.7
    axes.text(0.5, top, "casingfem", ha="center", fontsize=12)
    axes.text(1.5, top, "contact", ha="center", fontsize=12)
    axes.set(xlim=(0.0, 2.0), ylim=(-0.6, top + 0.4))
    axes.set_axis_off()
    return figure


def main(checkout: Path = ROOT, picture: Path = ROOT / "docs" / "architecture.svg") -> None:
    """Read a checkout and draw it."""
    arrows = arrows_of(Structure(checkout))
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "architecture", "font.family": "sans-serif"}):
        drawn(arrows).savefig(picture, metadata={"Date": None} if picture.suffix == ".svg" else None)
    print(f"wrote {picture}: {len({box for pair in arrows for box in pair})} packages, {len(arrows)} arrows")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:3]))
