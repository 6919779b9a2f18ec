"""One sector of a wheel: the blade of `section_mesh` on a disk ring, in bricks of 20 nodes.

The root section of a staggered blade can be wider around than the pitch 2 pi/N, so plane faces through the axis would
cut it. Here the faces follow the camber of the root: a point of its mean line at the angle theta(z) has the faces
theta(z) - pi/N and theta(z) + pi/N at the same z and r, so a rotation by the pitch maps one face onto the other. In
front of the blade and behind it the mean line goes on along its tangent.

    angle:   low face  <- around cells -> surface 1 <- blade -> surface 2 <- around cells -> high face
    axis:    front <- axial[0] -> leading edge <- chord -> trailing edge <- axial[1] -> rear
    radius:  bore <- radial cells -> hub <- span -> tip

The hub is the root section; from there every line goes to the bore along the radius. Nodes between
a face and the blade lie on straight lines over r, theta and z, with a bend halfway, at a line beside the blade. The
joint of blade and disk has no fillet.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.grid import end_group, grid_mesh
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.section_mesh import KIND, MOST, Sections, checked, half_turn, lattice_of
from contact.io.keys import Key

TANGENT = 4  # half cells of the chord at each edge whose secant is the tangent of the mean line


@dataclass(frozen=True, slots=True, kw_only=True)
class DiskRing:
    """The ring of a disk under a blade: radius of its bore, length before and behind the blade, numbers of cells.

    Raises
    ------
    ModelError
        `sections-disk` for a length that is not above 0, or numbers of cells that are out of range.

    >>> DiskRing(bore=0.12, front=0.004, rear=0.004).cells
    (3, 1, 1, 3)
    """

    bore: Annotated[float, Key("radius of the bore [m], below the root section", "length")]
    front: Annotated[float, Key("length of the ring along the axis before the leading edge [m]", "length")]
    rear: Annotated[float, Key("length of the ring along the axis behind the trailing edge [m]", "length")]
    cells_around: Annotated[
        int, Key("number of cells between the blade and each face of the sector", least=2, most=MOST)
    ] = 3
    cells_front: Annotated[int, Key("number of cells before the leading edge", most=MOST)] = 1
    cells_rear: Annotated[int, Key("number of cells behind the trailing edge", most=MOST)] = 1
    cells_radial: Annotated[int, Key("number of cells from the bore to the root section", most=MOST)] = 3

    def __post_init__(self) -> None:
        for name in ("bore", "front", "rear"):
            if not 0.0 < (value := getattr(self, name)) < np.inf:
                raise ModelError("sections-disk", f"disk.{name}: found {value!r} m, expected a length above 0")
        least = {"cells_around": 2, "cells_front": 1, "cells_rear": 1, "cells_radial": 1}
        for name, low in least.items():
            value = getattr(self, name)
            if not isinstance(value, int | np.integer) or not low <= value <= MOST:
                found = f"disk.{name}: found {value!r}"
                raise ModelError("sections-disk", f"{found}, expected a whole number of {low} to {MOST}")

    @property
    def cells(self) -> tuple[int, int, int, int]:
        """Numbers of cells around, front, rear and radial."""
        return self.cells_around, self.cells_front, self.cells_rear, self.cells_radial


def sector_mesh(sections: Sections, cells: Sequence[int], sectors: int, disk: DiskRing) -> MeshData:
    """The mesh of `BladeSections.sector`."""
    chord, span, through = checked(cells)
    if not all(sections.closed):
        raise ModelError("sections-disk", f"{sections.source}: found an open edge, expected both edges closed")
    lattice = lattice_of(sections, chord, span)
    hub = hub_nodes(lattice[0], sectors, through, disk, sections.source)
    around, front, rear, radial = disk.cells
    counts = 2 * around + through, front + chord + rear, radial + span
    unit = grid_mesh(KIND, counts, lambda at: at)
    at = np.rint(unit.points * 2 * np.array(counts)).astype(int)  # half cells around, along the axis, along the radius
    leading, trailing = 2 * front, 2 * (front + chord)

    t, s, k = at[unit.cells].mean(axis=1).T  # the middle of each cell
    inside = abs(t - 2 * around - through) < through
    blade = inside & (leading < s) & (s < trailing)
    kept = blade | (~inside & (k < 2 * radial))
    wedge = blade & (s < leading + 2)  # its line belongs at the end of the brick's second axis
    whole = np.where(wedge[:, None], unit.cells[:, half_turn()], unit.cells)
    outside = (at[:, 1] <= leading) | (at[:, 1] >= trailing)
    meets = outside & (abs(at[:, 0] - 2 * around - through) <= through)  # both surfaces of the blade meet here
    key = np.where(meets[:, None], [2 * around, 0, 0] + at * [0, 1, 1], at)
    at, number = np.unique(key[whole[kept]].reshape(-1, 3), axis=0, return_inverse=True)
    whole = number.reshape(-1, whole.shape[1])

    up, along = np.maximum(at[:, 2] - 2 * radial, 0), np.clip(at[:, 1] - leading, 0, 2 * chord)
    share = np.clip((at[:, [0]] - 2 * around) / (2 * through), 0.0, 1.0)
    first, second = np.moveaxis(lattice[up, along], 1, 0)
    points = first + (second - first) * share
    ring, top = at[:, 2] <= 2 * radial, at[:, 2] == 2 * radial
    nodes = np.where(top[:, None], hub[at[:, 0], at[:, 1]], straight(hub)[at[:, 0], at[:, 1]])
    points[ring] = below(nodes[ring], at[ring, 2] / (2 * radial), disk.bore)
    mesh = MeshData(kind=KIND, points=points, cells=whole, source=sections.source)
    last = 2 * np.array(counts)
    ends = {
        "low": at[:, 0] == 0, "high": at[:, 0] == last[0], "front": at[:, 1] == 0, "rear": at[:, 1] == last[1],
        "bore": at[:, 2] == 0, "tip": at[:, 2] == last[2],
    }  # fmt: skip
    groups = {name: end_group(mesh, inside) for name, inside in ends.items()}
    own = np.flatnonzero(k[kept] > 2 * radial)
    groups["blade"] = Group(nodes=whole[own], cells=own)
    return replace(mesh, groups=groups)


def hub_nodes(root: FloatArray, sectors: int, through: int, disk: DiskRing, source: str) -> FloatArray:
    """Radius, angle and z of the nodes at the hub, (around, along the axis, 3).

    `root` are the nodes on both surfaces of the root section, (along the chord, 2, 3).
    """
    around, front, rear, _ = disk.cells
    blade = np.linspace(root[:, 0], root[:, 1], 2 * through + 1)
    blade = np.stack([np.hypot(blade[..., 0], blade[..., 1]), angles(blade), blade[..., 2]], axis=-1)
    mean = 0.5 * (blade[0] + blade[-1])
    pitch = 2.0 * np.pi / sectors
    thick = float(np.abs(blade[[0, -1], :, 1] - mean[:, 1]).max())
    if not 2.0 * thick < pitch:
        found = f"found a root that is {np.degrees(2.0 * thick):.3g} degrees thick around"
        raise ModelError("sections-disk", f"{source}: {found}, expected less than the pitch, {np.degrees(pitch):.3g}")
    if not disk.bore < (least := float(blade[..., 0].min())):
        raise ModelError(
            "sections-disk", f"disk.bore: found {disk.bore:g} m, expected less than the hub's {least:.4g} m"
        )
    before = beyond(mean[0], mean[TANGENT], disk.front, front)[::-1]
    behind = beyond(mean[-1], mean[-1 - TANGENT], disk.rear, rear)
    line, *surfaces = (np.concatenate([before, part, behind]) for part in (mean, *blade))
    away = beside_blade(mean, thick, pitch, min(disk.front, disk.rear)) * line_weight(
        len(before), len(mean), len(behind)
    )
    away[:, 1] /= line[:, 0]
    half = np.array([0.0, 0.5 * pitch, 0.0])
    outer = around // 2
    low = between(line - half, line - away, surfaces[0], outer, around - outer)
    high = between(line + half, line + away, surfaces[-1], outer, around - outer)[::-1]
    return np.concatenate([low, surfaces[1:-1], high])


def between(face: FloatArray, layer: FloatArray, surface: FloatArray, outer: int, inner: int) -> FloatArray:
    """Nodes from a face over a line beside the blade to the blade's surface, (half cells, along the axis, 3)."""
    first = np.linspace(face, layer, 2 * outer + 1)[:-1]
    return np.concatenate([first, np.linspace(layer, surface, 2 * inner + 1)])


def beside_blade(mean: FloatArray, thick: float, pitch: float, room: float) -> FloatArray:
    """Vector (r, r theta, z) from the mean line to the lines beside the blade [m], across the chord.

    Its length is midway between half the thickness and half the distance of two blades, at most half of `room` along
    the axis. A line there has no blunt nose, so the cells beside the edges do not fold.
    """
    r = float(mean[:, 0].mean())
    chord = np.array([r * (mean[-1, 1] - mean[0, 1]), mean[-1, 2] - mean[0, 2]])
    around, along = chord / np.linalg.norm(chord)
    slope = (mean[-1, 0] - mean[0, 0]) / (mean[-1, 2] - mean[0, 2])
    distance = 0.5 * (r * thick + 0.5 * r * pitch) * abs(along)
    distance = min(distance, 0.5 * room / max(abs(around), np.finfo(float).tiny))
    return np.asarray(distance * np.sign(along) * np.array([-slope * around, along, -around]))


def line_weight(before: int, blade: int, behind: int) -> FloatArray:
    """Factors of that vector, (along the axis, 3): 1 beside the blade; to the ends of the ring r and z fall to 0."""
    falls = np.concatenate(
        [np.arange(before) / max(before, 1), np.ones(blade), np.arange(behind)[::-1] / max(behind, 1)]
    )
    return np.stack([falls, np.ones_like(falls), falls], axis=1)


def angles(points: FloatArray) -> FloatArray:
    """Angles about z without a jump across the section [rad]."""
    across = points[..., 0] + 1j * points[..., 1]
    middle = across.mean()
    return np.asarray(np.angle(middle) + np.angle(across / middle))


def beyond(edge: FloatArray, inner: FloatArray, length: float, cells: int) -> FloatArray:
    """Nodes of the mean line beyond an edge, `length` along z on the line from `inner` through the edge."""
    slope = (edge - inner) / abs(edge[2] - inner[2])
    return np.asarray(edge + slope * length * np.linspace(0.0, 1.0, 2 * cells + 1)[1:, None])


def below(hub: FloatArray, share: FloatArray, bore: float) -> FloatArray:
    """Points (n, 3) at a share of the way from the bore to nodes of the hub (n, 3), along the radius."""
    radius = bore + (hub[:, 0] - bore) * share
    return np.stack([radius * np.cos(hub[:, 1]), radius * np.sin(hub[:, 1]), hub[:, 2]], axis=1)


def straight(hub: FloatArray) -> FloatArray:
    """The nodes of the hub with middle nodes midway between corners: below the hub, round edges would fold cells."""
    found = hub.copy()
    found[1::2] = 0.5 * (hub[:-1:2] + hub[2::2])
    found[:, 1::2] = 0.5 * (hub[:, :-1:2] + hub[:, 2::2])
    return found
