"""Interactive shapes to rotate: geometry once, every shape in 16 bits, drawn by `scripts/shapes.js`."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.plot.body.shapes import EXAGGERATION, VIEWS, moving_shapes
from casingfem.plot.body.surface import Surface, surface_of
from casingfem.plot.modes import title
from casingfem.plot.page import Picture, coded, island, packed
from casingfem.structure.field.survey.survey import SurveyField
from casingfem.structure.shell.shell import Shell

FALLBACK = 3  # shapes of the moving pictures that show without WebGL and on paper
FAR = 2.5  # times the largest deviation: limit at which an outlier further away is drawn
NAMED = 12  # stray points with a label, the worst


def turning_shapes(modes: ModeSet, which: Sequence[int], caption: str) -> Picture:
    """Modes (indices) and imperfections of their shell on an interactive surface; pictures without WebGL."""
    surface = surface_of(modes)
    shapes = [mode_shape(modes, mode, surface) for mode in which]
    if isinstance(modes, Modes):
        shapes += imperfections(modes.shell, modes, surface)
    centre = 0.5 * (surface.points.min(axis=0) + surface.points.max(axis=0))
    from_centre = surface.points - centre
    reach = float(np.linalg.norm(from_centre, axis=1).max())
    data = {
        "points": packed(from_centre / reach, most=1.0)["data"],
        "out": packed(surface.out, most=1.0, bits=8)["data"],
        "faces": coded(surface.triangles.astype("<u2")),
        "reach": reach,
        "swing": EXAGGERATION * surface.size / reach,
        "share": EXAGGERATION,
        "view": VIEWS[surface.closed],
        "shapes": [centred(shape, centre, reach) for shape in shapes],
    }
    still = moving_shapes(modes, list(which)[:FALLBACK], caption)
    return Picture(island("shapes", data, still.html), caption, ("shapes",))


def mode_shape(modes: ModeSet, mode: int, surface: Surface) -> dict[str, Any]:
    """One mode: its name, and displacements scaled to 1."""
    u = modes.fields[surface.nodes, :3, mode]
    largest = float(np.linalg.norm(u, axis=1).max())
    radial = float(np.abs(np.sum(u * surface.out, axis=1)).max())
    return {"name": title(modes, mode), "move": packed(u, most=largest)["data"], "tint": largest / max(radial, 1e-300)}


def imperfections(shell: Shell, modes: Modes, surface: Surface) -> list[dict[str, Any]]:
    """Differences of a shell from the perfect one, field by field, with the outliers of its survey."""
    a, b = modes.grid.nodes[:, surface.nodes]
    found = []
    for quantity, field in shell.defects.items():
        if quantity == "radius":
            move = np.real(shell.chart.surface(a, b, field.derivatives(a, b)).x).T - surface.points
            value, unit, scale = np.sum(move * surface.out, axis=1), "µm", 1e6
        else:
            value, unit, scale = np.real(field.derivatives(a, b).value), "%", 100.0
            move = value[:, None] * surface.out
        largest = float(np.abs(value).max())
        if not largest > 0.0:
            continue
        name = f"{quantity} {'as surveyed' if isinstance(field, SurveyField) else 'imperfection'}"
        found.append(
            {
                "name": name, "move": packed(move, most=largest)["data"], "tint": 1.0, "still": True,
                "flat": quantity != "radius", "least": scale * float(value.min()), "most": scale * float(value.max()),
                "unit": unit, "metres": largest,
                "strays": strays(shell, field, largest) if quantity == "radius" else [],
            }
        )  # fmt: skip
    return found


def strays(shell: Shell, field: object, largest: float) -> list[dict[str, Any]]:
    """Outliers of a survey: their points, and their deviations relative to the largest of the others."""
    if not isinstance(field, SurveyField):
        return []
    worst = sorted((*field.set_aside, *field.doubted), key=lambda point: -abs(point[2]))
    rows = []
    for k, (degrees, z, residual) in enumerate(worst):
        a, b = np.array([z]), np.radians([degrees])
        point = np.real(shell.chart.surface(a, b, None).x)[:, 0]
        surveyed = np.real(shell.chart.surface(a, b, field.derivatives(a, b)).x)[:, 0]
        out = np.asarray(shell.chart.directions(a, b)[0])[:, 0]
        off = residual * float(np.hypot(point[0], point[1]))
        move = (surveyed - point) / largest + out * float(np.clip(off / largest, -FAR, FAR))
        label = f"{degrees:.4g}°, z {z:.4g} m: {1e6 * off:+.3g} µm" if k < NAMED else ""
        rows.append({"at": point.tolist(), "move": move.round(4).tolist(), "label": label})
    return rows


def centred(shape: dict[str, Any], centre: FloatArray, reach: float) -> dict[str, Any]:
    """A shape with its outliers, about the centre and scaled by its size."""
    moved = [
        {**one, "at": ((np.array(one["at"]) - centre) / reach).round(5).tolist()} for one in shape.get("strays", ())
    ]
    return {**shape, "strays": moved}
