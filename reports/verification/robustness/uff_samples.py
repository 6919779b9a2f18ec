"""Small universal files, one for each kind of set, made by the program, with the places of their counts."""

from typing import NamedTuple

import numpy as np

from casingfem.experiment.uff.nodes import Elements, Nodes, TraceLine, Units
from casingfem.experiment.uff.set_55 import Shape
from casingfem.experiment.uff.set_58 import Axes, Axis, Channel, Function


class Count(NamedTuple):
    """A number in a file that says how many follow, or in what form: line from 0, first column, width."""

    line: int
    column: int
    width: int


class Sample(NamedTuple):
    """Arguments of `write_uff`, positions of its counts, and lines with text (from 0)."""

    parts: dict[str, object]
    counts: tuple[Count, ...] = ()


RNG_SEED = 20_243


def function(*, even: bool, is_complex: bool, double: bool, points: int = 41) -> Function:
    """A function with numbers of all sizes."""
    rng = np.random.default_rng(RNG_SEED)
    values = rng.normal(size=points) * 10.0 ** rng.integers(-9, 9, size=points)
    if is_complex:
        values = values + 1j * rng.normal(size=points)
    x = np.arange(points) * 0.25 + 10.0 if even else np.cumsum(rng.uniform(0.1, 2.0, points)).round(4)
    return Function(
        kind=4 if is_complex else 1,
        text=("sample 1", "made by a program", "23-Mar-17 19:02:23", "", "H1: 2/1"),
        numbers=(3, 1, 0),
        response=Channel("rim", 12, -3),
        reference=Channel("hammer", 1, 1),
        x=x,
        values=values,
        step=0.25 if even else 0.0,
        double=double,
        axes=Axes(Axis(18, label="frequency", unit="Hz"), Axis(12, (1, 0, 0), "response", "m/s²"), Axis(13, unit="N")),
    )


def nodes() -> Nodes:
    """Twelve nodes on a ring."""
    angle = 2.0 * np.pi * np.arange(12) / 12
    points = np.column_stack([0.45 * np.cos(angle), 0.45 * np.sin(angle), np.full(12, 0.25)])
    return Nodes(labels=np.arange(1, 13), points=points, systems=np.zeros(12), motions=np.zeros(12))


def shape(mode: int, *, is_complex: bool = False, values: int = 3) -> Shape:
    """A shape on the ring."""
    rng = np.random.default_rng(RNG_SEED + mode)
    table = rng.normal(size=(12, values))
    return Shape(
        text=(f"mode {mode}", "made by a program", "", "", ""),
        model=1,
        analysis=3 if is_complex else 2,
        characteristic=2 if values == 3 else 3,
        quantity=8,
        integers=(1, mode),
        reals=(-3.1, 2311.5 * mode, 0.0, 1.0, 0.0, 0.0) if is_complex else (367.9 * mode, 1.0, 0.002, 0.0),
        nodes=np.arange(1, 13),
        values=table + 1j * table[::-1] if is_complex else table,
    )


def elements() -> Elements:
    """Shells, a beam and a brick of twenty nodes."""
    return Elements(
        labels=np.arange(1, 7),
        kinds=np.array([94, 94, 91, 21, 116, 94]),
        properties=np.tile([1, 1, 7], (6, 1)),
        beams=np.array([[0, 0, 0]] * 3 + [[0, 1, 1]] + [[0, 0, 0]] * 2),
        nodes=tuple(
            np.array(row) for row in ([1, 2, 3, 4], [4, 3, 6, 5], [5, 6, 7], [7, 8], range(1, 21), [8, 9, 10, 11])
        ),
    )


def samples() -> dict[str, Sample]:
    """All of them, by set."""
    line = TraceLine(number=1, name="rim", color=8, nodes=np.array([*range(1, 13), 0, 1, 7]))
    text_counts = (Count(8, 0, 10), Count(8, 10, 10), Count(8, 20, 10))
    binary_counts = (*text_counts[1:], Count(1, 31, 12), Count(1, 7, 6), Count(1, 13, 6), Count(1, 19, 12))
    shape_counts = (Count(7, 40, 10), Count(7, 50, 10), Count(8, 0, 10), Count(8, 10, 10))
    units = Units(5, "mm (newton)", 1000.0, 1.0, 1.0, 273.15)
    found = {
        "15": Sample({"nodes": nodes(), "nodes_set": "15"}),
        "2411": Sample({"nodes": nodes()}),
        "151": Sample({"header": ("rig", "", "a program", "1", "2", "3", "4")}),
        "164": Sample({"units": units}),
        "82": Sample({"lines": (line,)}, (Count(2, 10, 10),)),
        "2412": Sample({"elements": elements()}, (Count(2, 50, 10), Count(11, 50, 10))),
        "55": Sample({"shapes": tuple(shape(k) for k in (1, 2, 3))}, shape_counts),
        "55 complex, 6 values": Sample({"shapes": (shape(1, is_complex=True, values=6),)}, shape_counts),
    }
    for is_complex in (False, True):
        for double in (False, True):
            for even in (True, False):
                words = (
                    "complex" if is_complex else "real",
                    "double" if double else "single",
                    "even" if even else "uneven",
                )
                one = {"functions": (function(even=even, is_complex=is_complex, double=double),)}
                found[f"58 {' '.join(words)}"] = Sample(one, text_counts)
                if even or double:
                    found[f"58b {' '.join(words)}"] = Sample(one | {"binary": True}, binary_counts)
    return found
