"""A free barrel with two T stiffeners, a lip at each end and two caps: a shell of eight-noded cells with joints.

The geometry is that of the mesh of `barrel_w_stiffeners_examples` in FinEtoolsFlexStructures.jl (P. Krysl, MIT), read
from its 122,781 nodes: radius 500 mm, length 1400 mm, walls of 2 mm; webs 30 mm high with flanges of 50 mm at 416.2 and
983.8 mm; lips of 22.5 mm at both ends; caps inside, turned arcs of radius 1487.16 mm that meet the wall 97 mm from the
ends. It has joints of three walls, folds of a right angle, and six rigid motions.
"""

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.material import Material
from reports.verification.modes.branching import grid, joined, sheet

STEEL = Material(E=200e9, nu=0.3, rho=7850.0)
RADIUS, LENGTH, WALL = 0.5, 1.4, 2e-3
WEBS, HEIGHT, FLANGE, LIP = (0.4162, 0.9838), 0.03, 0.05, 0.0225
JOIN, ARC, OFF_AXIS = 0.097, 1.48716, -5.3933e-3  # a cap: where it meets the wall, its arc's radius and centre
ABAQUS = np.array([231.48, 238.19, 250.09, 252.19, 260.12])  # Hz, STRI3, as the example quotes them
RIGID = 6
CORE, BULGE = 0.35, 0.35  # the square in the middle of a cap over its radius, and how round its sides are


def turned(cells: FloatArray) -> FloatArray:
    """Radius, angle and height as Cartesian coordinates."""
    r, angle, z = np.moveaxis(cells, -1, 0)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)


def stations(*stops: float) -> FloatArray:
    """Places from alternating stops and numbers of cells between them."""
    parts = [np.linspace(a, b, int(n) + 1)[1:] for a, n, b in zip(stops[::2], stops[1::2], stops[2::2], strict=False)]
    return np.concatenate([[stops[0]], *parts])


def rounded(square: FloatArray) -> FloatArray:
    """The square of side 2 with round sides, in the middle of the unit disk."""
    return np.asarray(CORE * square / np.sqrt(1.0 + BULGE * square[..., ::-1] ** 2))


def disk(kind: str, around: int, rings: int) -> FloatArray:
    """The unit disk: a square of around/4 cells a side, and rings about it, (cells, nodes, 2)."""
    side = np.linspace(-1.0, 1.0, around // 4 + 1)
    outward, quarter = np.moveaxis(
        grid(kind, np.linspace(0.0, 1.0, rings + 1), np.linspace(0.0, 4.0, around + 1)), 2, 0
    )
    turns = np.minimum(np.floor(quarter.mean(axis=1)), 3.0)[:, None]
    along = 2.0 * (quarter - turns) - 1.0
    cos, sin = np.cos(0.5 * np.pi * turns).round(), np.sin(0.5 * np.pi * turns).round()
    inner = rounded(np.stack([cos - sin * along, sin + cos * along], axis=-1))
    angle = 0.25 * np.pi * (2.0 * quarter - 1.0)
    outer = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.concatenate([rounded(grid(kind, side, side)), inner + outward[..., None] * (outer - inner)])


def cap(kind: str, around: int, rings: int) -> tuple[FloatArray, FloatArray]:
    """Places in the plane of a cap, and how far each is from the plane of its edge, towards the end."""
    plane = RADIUS * disk(kind, around, rings)
    r = np.hypot(plane[..., 0], plane[..., 1])
    rise = np.sqrt(ARC**2 - (r - OFF_AXIS) ** 2) - np.sqrt(ARC**2 - (RADIUS - OFF_AXIS) ** 2)
    return plane, rise


def barrel(around: int = 64, along: int = 4, rings: int = 5, kind: str = "quad8") -> MeshShell:
    """The barrel: cells around (a multiple of 4), along each bay, and along the radius of a cap outside its square."""
    half, first, second = 0.5 * FLANGE, *WEBS
    angle = np.linspace(0.0, 2.0 * np.pi, around + 1) - 0.25 * np.pi
    end = max(along // 3, 1)
    z = stations(
        0.0, end, JOIN, along, first - half, 1, first, 1, first + half, 2 * along, second - half, 1, second, 1,
        second + half, along, LENGTH - JOIN, end, LENGTH,
    )  # fmt: skip
    parts = [turned(sheet(kind, 0, RADIUS, angle, z))]
    for at in WEBS:
        parts.append(turned(sheet(kind, 2, at, np.array([RADIUS, RADIUS + HEIGHT]), angle)))
        parts.append(turned(sheet(kind, 0, RADIUS + HEIGHT, angle, np.array([at - half, at, at + half]))))
    parts += [turned(sheet(kind, 2, at, np.array([RADIUS - LIP, RADIUS]), angle)) for at in (0.0, LENGTH)]
    plane, rise = cap(kind, around, rings)
    parts += [np.concatenate([plane, h[..., None]], axis=2) for h in (JOIN - rise, LENGTH - JOIN + rise)]
    return MeshShell(mesh=joined(kind, parts, 2), thickness=WALL, material=STEEL)
