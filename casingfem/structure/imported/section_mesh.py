"""Bricks of 20 nodes between the surfaces of blade sections, and wedges at edges where the surfaces meet.

A structured grid along thickness, chord and span. Each surface of a section is a cubic spline over its arc length.
Nodes are at the same fractions of both surfaces, s = (1 - cos pi w)/2 for equal steps of w, so cells are small at the
edges. Splines from section to section give the nodes along the span. The root and tip sections are the ends of the
mesh, so a fillet at the root is not part of it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.mesh_data import MeshData

KIND = "hexahedron20"
MOST = 400  # cells along one direction
DEGREE = 3


class Sections(Protocol):
    """Sections to be meshed: both surfaces of each, which of their edges are closed, and the name of their source."""

    @property
    def surfaces(self) -> tuple[FloatArray, ...]:
        """Points of both surfaces of each section."""

    @property
    def closed(self) -> tuple[bool, bool]:
        """Whether the surfaces meet at the leading and at the trailing edge."""

    @property
    def source(self) -> str:
        """Name in messages."""


def section_mesh(sections: Sections, cells: Sequence[int]) -> MeshData:
    """The mesh of `BladeSections.mesh`."""
    chord, span, through = checked(cells)
    lattice = lattice_of(sections, chord, span)

    unit = grid_mesh(KIND, (through, chord, span), lambda at: at, groups={"root": (2, 0.0), "tip": (2, 1.0)})
    unit = with_wedges(unit, sections.closed, chord)
    i = np.rint(unit.points[:, 1:] * [2 * chord, 2 * span]).astype(int)
    first, second = np.moveaxis(lattice[i[:, 1], i[:, 0]], 1, 0)
    return replace(unit, points=first + (second - first) * unit.points[:, :1], source=sections.source)


def checked(cells: Sequence[int]) -> tuple[int, int, int]:
    """Numbers of cells along chord, span and thickness; ModelError if they are out of range."""
    numbers = list(cells)
    whole = len(numbers) == 3 and all(isinstance(n, int | np.integer) and 1 <= n <= MOST for n in numbers)
    if not whole or numbers[0] < 2:
        expected = f"three whole numbers of 1 to {MOST}, at least 2 along the chord"
        raise ModelError(
            "sections-cells", f"found {numbers} cells along chord, span and thickness, expected {expected}"
        )
    chord, span, through = (int(n) for n in numbers)
    return chord, span, through


def lattice_of(sections: Sections, chord: int, span: int) -> FloatArray:
    """Nodes on both surfaces at half steps along span and chord, (2 span + 1, 2 chord + 1, 2, 3)."""
    from scipy.interpolate import make_interp_spline

    ends = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, chord + 1))) / 2.0
    at = np.empty(2 * chord + 1)
    at[::2], at[1::2] = ends, (ends[1:] + ends[:-1]) / 2.0
    curves = np.array([curves_of(surfaces, sections.closed, at) for surfaces in sections.surfaces])
    step = np.linalg.norm(np.diff(curves.mean(axis=2), axis=0), axis=2).mean(axis=1)
    height = np.concatenate([[0.0], np.cumsum(step)]) / step.sum()
    spline = make_interp_spline(height, curves, k=min(DEGREE, len(height) - 1))
    return np.asarray(spline(np.linspace(0.0, 1.0, 2 * span + 1)))


def curves_of(surfaces: FloatArray, closed: tuple[bool, bool], at: FloatArray) -> FloatArray:
    """Points of both surfaces of a section at fractions of their arc length, (points, 2, 3)."""
    return np.stack([along(curve, at) for curve in nose_to_nose(surfaces, closed)], axis=1)


def along(curve: FloatArray, at: FloatArray) -> FloatArray:
    """Points of a curve (stations, 3) at fractions of its arc length, by a cubic spline over it."""
    from scipy.interpolate import make_interp_spline

    step = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    kept = np.concatenate([[True], step > 1e-9 * step.sum()])
    length = np.concatenate([[0.0], np.cumsum(step)])[kept]
    return np.asarray(make_interp_spline(length / length[-1], curve[kept], k=min(DEGREE, kept.sum() - 1))(at))


def nose_to_nose(surfaces: FloatArray, closed: tuple[bool, bool]) -> tuple[FloatArray, FloatArray]:
    """Both surfaces of a section; if both edges are closed, each between the two points with the largest distance."""
    first, second = surfaces
    if not all(closed):
        return first, second
    contour = np.concatenate([first, second[-2:0:-1]])
    last = len(first) - 1
    start = int(np.linalg.norm(contour - contour[last], axis=1).argmax())
    last = int(np.linalg.norm(contour - contour[start], axis=1).argmax())
    contour = np.roll(contour, -start, axis=0)
    last = (last - start) % len(contour)
    return contour[: last + 1], np.concatenate([contour[last:], contour[:1]])[::-1]


def with_wedges(unit: MeshData, closed: tuple[bool, bool], chord: int) -> MeshData:
    """The unit grid with one node through the thickness at closed edges; its bricks collapse to wedges there."""
    through, along, up = unit.points.T
    edge = (closed[0] & (along == 0.0)) | (closed[1] & (along == 1.0))
    _, new = np.unique(np.stack([np.where(edge, 0.0, through), along, up]), axis=1, return_inverse=True)
    new = new.ravel()
    points = np.empty((new.max() + 1, 3))
    points[new] = unit.points
    cells = new[unit.cells]
    if closed[0]:  # the line of a wedge is at the end of the brick's second axis
        column = unit.points[unit.cells, 1].min(axis=1) == 0.0
        cells[column] = cells[column][:, half_turn()]
    groups = {name: replace(group, nodes=new[group.nodes]) for name, group in unit.groups.items()}
    return MeshData(kind=unit.kind, points=points, cells=cells, groups=groups)


def half_turn() -> list[int]:
    """Nodes of a brick after half a turn about its third axis; its lower and upper facets keep their positions."""
    places = KINDS[KIND].places
    return [int(np.abs(places - place).sum(axis=1).argmin()) for place in places * [-1, -1, 1] + [1, 1, 0]]
