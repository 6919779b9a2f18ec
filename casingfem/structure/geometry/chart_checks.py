"""Checks of a chart on a few points: finite, smooth, not folded, and closed and round if it claims so.

In a chart of your own, a wrong derivative gives plausible but wrong frequencies. The derivatives are compared
with differences of the surface itself.
"""

from collections.abc import Hashable
from functools import lru_cache
from typing import Any, TypeGuard

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.geometry.chart import Chart, Surface, is_axisymmetric

STEP = 1e-5  # of the differences, as a part of each parameter's range
ALIKE = 1e-4  # differences and derivatives agree to this part of the largest derivative
SLANT = 1e-6  # directions across an edge of symmetry agree to this [rad]
ROUND = 1e-8  # surface and derivatives at b are those at the first b, turned, to this part of the largest
TURN = 1e-9  # a closed chart's second parameter runs over 2 pi to this part of it
FLAT = 1e-9  # tangents that span less than this part of the largest area do not span a plane


def check_chart(chart: Chart) -> None:
    """Refuse a chart that is not finite, folded, open at its seam, or with wrong derivatives.

    A frozen dataclass of numbers is checked once: most shells are copies of another one with the same chart.
    """
    if _is_value(chart):
        _check_once(chart)
    else:
        _check(chart)


def _is_value(chart: Chart) -> TypeGuard[Hashable]:
    """Whether a chart is a frozen dataclass that can be hashed; one that holds arrays cannot."""
    dataclass: Any = getattr(chart, "__dataclass_params__", None)
    if dataclass is None or not dataclass.frozen:
        return False
    try:
        hash(chart)
    except TypeError:
        return False
    return True


@lru_cache(maxsize=32)
def _check_once(chart: Any) -> None:
    _check(chart)


def _check(chart: Chart) -> None:
    (a0, a1), (b0, b1) = bounds = np.real(np.array(chart.bounds, dtype=complex))
    if not (np.all(np.isfinite(bounds)) and a0 < a1 and b0 < b1):
        raise ModelError("chart-bounds", f"chart.bounds: found {chart.bounds}")
    for name, edge in chart.edges.items():
        if tuple(edge) not in ((0, 0), (0, 1), (1, 0), (1, 1)):
            raise ModelError("chart-edge", f"chart.edges: {name!r} is {edge!r}")
    a, b = (part.ravel() for part in np.meshgrid(np.linspace(a0, a1, 9), np.linspace(b0, b1, 17), indexing="ij"))
    surface = real(chart.surface(a, b, None))
    if not all(np.all(np.isfinite(part)) for part in surface):
        raise ModelError("chart-not-finite", "the chart's surface or its derivatives are not finite somewhere")
    area = np.linalg.norm(np.cross(surface.x1, surface.x2, axis=0), axis=0)
    if area.min() <= FLAT * max(float(area.max()), np.finfo(float).tiny):
        where = int(area.argmin())
        raise ModelError("chart-fold", f"the chart's tangents are parallel or zero at ({a[where]:.4g}, {b[where]:.4g})")
    check_derivatives(chart, surface, (a, b), np.array([a1 - a0, b1 - b0]))
    if chart.periodic:
        if abs(b1 - b0 - 2.0 * np.pi) > TURN * 2.0 * np.pi:
            found = f"chart.bounds: found a second parameter from {b0:.6g} to {b1:.6g} on a closed chart"
            raise ModelError("chart-turn", f"{found}, expected a range of 2 pi = 6.28319")
        ends = [real(chart.surface(a, 0.0 * a + b, None)).x for b in (b0, b1)]
        gap = float(np.linalg.norm(ends[1] - ends[0], axis=0).max())
        if gap > FLAT * float(np.linalg.norm(np.ptp(surface.x, axis=1))):
            raise ModelError("chart-open-seam", f"the chart is declared periodic, but its ends are {gap:.3g} m apart")
    if is_axisymmetric(chart):
        check_axisymmetry(chart, surface, (a, b))


def check_axisymmetry(chart: Chart, surface: Surface, points: tuple[Array, Array]) -> None:
    """Refuse `axisymmetric` for a chart whose surface at b is not that at b = 0 rotated about z by b.

    The first and second derivatives rotate with the surface, so that metric and curvature are constant around, as do
    the directions of springs.
    """
    if not chart.periodic:
        raise ModelError("chart-axisymmetric", "the chart states axisymmetric and periodic = False, expected both True")
    a, b = points
    zero, one, c, s = np.zeros_like(b), np.ones_like(b), np.cos(b), np.sin(b)
    turn = np.array([[c, -s, zero], [s, c, zero], [zero, zero, one]])
    first = real(chart.surface(a, zero, None))
    named = [*zip(Surface._fields, surface, first, strict=True)]
    ways = np.real(chart.directions(a, b)), np.real(chart.directions(a, zero))
    named += [(f"direction {k + 1}", *pair) for k, pair in enumerate(zip(*ways, strict=True))]
    for name, there, at_zero in named:
        off = np.abs(there - np.einsum("ij...,j...->i...", turn, at_zero)).max(axis=0)
        part = off / max(float(np.abs(there).max()), np.finfo(float).tiny)
        if part.max() > ROUND:
            k = int(part.argmax())
            found = f"its {name} at (a, b) = ({a[k]:.4g}, {b[k]:.4g}) differs by {part[k]:.2g}"
            raise ModelError(
                "chart-axisymmetric",
                f"the chart states axisymmetric = True, but {found} from {name} at (a, 0) rotated about z by b",
            )


def check_derivatives(chart: Chart, surface: Surface, points: tuple[Array, Array], spans: FloatArray) -> None:
    """Compare first and second derivatives with central differences inside the rectangle."""
    names = (("x1", "x2"), ("x11", "x12"), ("x12", "x22"))
    a, b = (
        np.clip(p, p.min() + STEP * span, p.max() - STEP * span)[5:-5:7] for p, span in zip(points, spans, strict=True)
    )
    inner = real(chart.surface(a, b, None))
    for k, (step, span) in enumerate(zip(STEP * spans, spans, strict=True)):
        shift = (step * (k == 0), step * (k == 1))
        up = real(chart.surface(a + shift[0], b + shift[1], None))
        down = real(chart.surface(a - shift[0], b - shift[1], None))
        for source, name in zip(("x", "x1", "x2"), (row[k] for row in names), strict=True):
            difference = (getattr(up, source) - getattr(down, source)) / (2.0 * step)
            scale = np.abs(getattr(surface, source)).max() / span + np.abs(getattr(surface, name)).max()
            error = float(np.abs(difference - getattr(inner, name)).max() / scale)
            if error > ALIKE:
                found = f"the chart's {name} is not the derivative of its {source} ({error:.1%} off)"
                raise ModelError("chart-derivatives", found)


def real(surface: Surface) -> Surface:
    """The surface without the imaginary parts of a complex step."""
    return Surface(*(np.asarray(np.real(part), dtype=float) for part in surface))


def check_symmetry(chart: Chart, edge: str) -> None:
    """Refuse a symmetry edge where the surface is not normal to a single plane.

    Fields are ignored, since small ones change the surface only slightly.
    """
    held, end = chart.edges[edge]
    low, high = np.real(chart.bounds[1 - held])
    along, fixed = np.linspace(low, high, 17), np.full(17, np.real(chart.bounds[held][end]))
    a, b = (fixed, along) if held == 0 else (along, fixed)
    surface = real(chart.surface(a, b, None))
    across = np.cross(surface.x2 if held == 0 else surface.x1, np.cross(surface.x1, surface.x2, axis=0), axis=0)
    across = across / np.linalg.norm(across, axis=0)
    lean = float(np.abs(across - across[:, :1]).max())
    if lean > SLANT:
        found = f"found normals of this edge, in the surface, that differ along it by up to {lean:.2g} rad"
        raise ModelError("symmetry-slanted", f"support.{edge}: {found}, expected one direction")
