"""Limits of each scheme: stiffness and mass ratios, time step, gaps, rest and grazing.

`python -m reports.verification.schemes.stability [--quick] [--out DIR]` prints and writes stability.csv. "refused": an
error with numbers before the first step; "degraded": contact or scheme added more than 1 % of the run's largest energy,
or the complementarity residual exceeds 1e-10 of the scene's length; the table states which, and by how much. "stopped":
the run ended with an error whose code names the reason, such as energy that contact added; "failed": with any other
error. "NaN" and "failed" must never occur. A penetration of penalty runs is part of their law.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import contact as ct
from contact.model.bodies.body import Body
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import BAR, UNIT, Method, methods

Scene = tuple[list[Body], dict[str, float]]
RESIDUAL, GAIN = 1e-10, 0.01


def pair(stiff: float = 1.0, gap: float = 0.0) -> list[Body]:
    """Two rods of 50 elements, the second `stiff` times as stiff, thrown at each other over `gap`."""
    left = ct.Rod(**UNIT, elements=50, x=-1.0 - gap, velocity=1.0)
    return [left, ct.Rod(**{**UNIT, "E": stiff}, elements=50)]


def heavy(ratio: float) -> list[Body]:
    """A point mass `ratio` times as heavy as the fixed rod it strikes."""
    return [ct.PointMass(mass=ratio, velocity=1.0), ct.Rod(**UNIT, elements=50, fixed="right")]


def scenes(quick: bool) -> Iterator[tuple[str, Callable[[], Scene]]]:
    """Name, and bodies with the run's options; courant is that of the stiffest rod unless dt is given."""
    for ratio in (1.0, 1e4, 1e10):
        soft = 0.5 / 50.0
        yield (
            f"stiffness ratio {ratio:.0e}, dt of the stiff rod",
            lambda ratio=ratio, soft=soft: (pair(ratio), {"courant": 0.5, "t_end": 4000 * soft / ratio**0.5}),
        )
        yield (
            f"stiffness ratio {ratio:.0e}, dt of the soft rod",
            lambda ratio=ratio, soft=soft: (pair(ratio), {"dt": soft, "t_end": 5.0}),
        )
    for ratio in (1e-8, 1e8):
        yield f"mass ratio {ratio:.0e}", lambda ratio=ratio: (heavy(ratio), {"courant": 0.5, "t_end": 4.0})
    for courant in (0.5, 1.0, 1.01, 3.0, 30.0):
        yield f"Courant {courant:g}", lambda courant=courant: (pair(gap=0.1), {"courant": courant, "t_end": 5.0})
    for gap in (0.0, 1e-12):
        yield f"gap {gap:g}", lambda gap=gap: (pair(gap=gap), {"courant": 0.5, "t_end": 5.0})
    rest = ct.Rod(**{**BAR, "x": 0.0}, elements=10, damping=1.0)
    count = 20_000 if quick else 1_000_000
    yield (
        f"at rest, {count:.0e} steps",
        lambda: ([rest, ct.Wall()], {"courant": 0.5, "t_end": count * 0.5 / 30.0, "gravity": 10.0}),
    )
    bar = ct.Rod(**UNIT, elements=50, fixed="left", velocity=1.0)
    yield "grazing, 25 periods", lambda: ([bar, ct.Wall(x=2.0)], {"courant": 0.5, "t_end": 100.0})


def tried(scene: Scene, method: Method) -> tuple[str, ct.Result | None]:
    """Run a scene; returns the verdict in a word, and the result if there is one."""
    bodies, options = scene
    try:
        result = ct.run(bodies, law=method.law, scheme=method.scheme, record=ct.Record(every=100), **options)
    except ct.InputError:
        return "refused", None
    except ct.NumericsError as error:
        code = re.search(r" \[([a-z-]+)\]$", str(error))
        return (f"stopped: {code[1]}" if code else f"failed: {str(error)[:40]}"), None
    energy = result.energy
    if not (np.isfinite(result.force).all() and np.isfinite(energy.end.total)):
        return "NaN", result
    gain = (energy.end.total - energy.start.total - energy.load_step) / max(energy.scale, 1e-300)
    length = float(np.abs(result.gap).max(initial=1.0))
    violation = 0.0 if isinstance(method.law, ct.Penalty) else float(result.residual[0]) / length
    words = [f"gains {gain:.0%}"] * (gain > GAIN) + [f"law violated by {violation:.0e}"] * (violation > RESIDUAL)
    return (f"degraded: {', '.join(words)}" if words else "survived"), result


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table of verdicts, then the count of each word."""
    rows: list[Row] = []
    tested = [*methods(50.0), Method(name="event-driven", scheme=ct.scheme.EventDriven())]
    for name, scene in scenes(quick):
        row: Row = {"scene": name}
        for method in tested:
            row[method.name] = tried(scene(), method)[0]
        rows.append(row)
    short = [{"scene": row["scene"], **{f"{k}": v for k, v in row.items() if k != "scene"}} for row in rows]
    names = [name for name in short[0] if name != "scene"]
    for part in (names[:8], names[8:]):
        show("Pushed to the limits", [{"scene": row["scene"], **{name: row[name] for name in part}} for row in short])
    words = [str(row[name]).partition(":")[0] for row in rows for name in names]
    print(f"\n{len(words)} runs: " + ", ".join(f"{words.count(word)} {word}" for word in dict.fromkeys(words)))
    write(out / "stability.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
